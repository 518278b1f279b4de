//! The least-squares problem of \[P\] 18, and the same with the platform's wrench in place of force sensors.
//!
//! - Cable forces: one residual a sample, `f(p) − f_ref`, for one cable.
//! - Wrench: six residuals a sample, `w + A^T f(p)` (\[P\] 3), for all cables together; forces and torques are brought to
//!   one scale by a [`whitening`](Comparison::Wrench) matrix.

use std::sync::atomic::{AtomicBool, Ordering};

use fric_core::cable::CableForces;
use fric_core::parameters::{SIGMA, Values};
use fric_core::scalar::Scalar;
use fric_core::{LANES, Lanes, SingleCable};
use nalgebra::{Matrix6, Vector6};
use rayon::prelude::*;

use super::dual::Dual;
use super::gram::Gram;
use super::pass::{differentiated, run, with_room_for};
use super::record::{CableRecord, Row};
use super::scores::Scores;
use super::vector::Parameter;

/// Samples that are evaluated before they are assembled.
const CHUNK: usize = 2048;

/// A cable of the problem.
#[derive(Clone, Debug)]
pub struct Member<'a> {
    pub record: CableRecord<'a>,
    /// The parameters that vary.
    pub free: Vec<Parameter>,
}

/// What the model is compared with.
#[derive(Clone, Debug)]
pub enum Comparison<'a> {
    /// The cable force at the platform, of a single cable.
    Forces,
    /// The outside wrench.
    Wrench {
        /// Columns of the structure matrix, all cables of a sample one after the other.
        structure: &'a [Vector6<f64>],
        /// The wrench of each sample; NaN where there is none.
        outside: &'a [Vector6<f64>],
        /// Turns deviations into numbers of variance 1 that do not depend on each other.
        whitening: Box<Matrix6<f64>>,
    },
}

/// How deviations are weighed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Loss {
    /// By their square.
    Squares,
    /// By their square up to a bound, linearly beyond (Huber), in the unit of the residuals.
    Huber(f64),
}

impl Loss {
    /// The number whose square is the loss, and its slope: `r`, or `±√(2b|r| − b²)` beyond the bound `b`.
    fn root(self, residual: f64) -> (f64, f64) {
        match self {
            Self::Huber(bound) if residual.abs() > bound => {
                let root = (2.0 * bound * residual.abs() - bound * bound).sqrt();
                (root.copysign(residual), bound / root)
            }
            _ => (residual, 1.0),
        }
    }
}

/// Samples, model, comparison.
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    pub members: Vec<Member<'a>>,
    pub comparison: Comparison<'a>,
    pub loss: Loss,
    /// Which samples count.
    pub used: Vec<bool>,
    /// Set from outside to end every evaluation.
    pub stop: &'a AtomicBool,
}

/// The rows of a sample: derivatives by every free parameter, then the residual.
type Rows<'a> = std::slice::ChunksExact<'a, f64>;

impl Problem<'_> {
    /// How many parameters vary, of all cables.
    pub fn parameter_count(&self) -> usize {
        self.members.iter().map(|member| member.free.len()).sum()
    }

    /// Residuals and Jacobian at the values of each cable, reduced; `None` when stopped.
    pub fn gram(&self, values: &[Values]) -> Option<Gram> {
        let mut gram = Gram::new(self.parameter_count());
        self.visit(values, |_, rows| rows.for_each(|row| gram.add(row))).then_some(gram)
    }

    /// The same with the samples' scores.
    pub fn gram_and_scores(&self, values: &[Values]) -> Option<(Gram, Scores)> {
        let count = self.parameter_count();
        let (mut gram, mut scores) = (Gram::new(count), Scores::new(count));
        let mut score = vec![0.0; count];
        let completed = self.visit(values, |_, rows| {
            score.fill(0.0);
            for row in rows {
                gram.add(row);
                let Some((residual, derivatives)) = row.split_last() else { continue };
                for (sum, derivative) in score.iter_mut().zip(derivatives) {
                    *sum += derivative * residual;
                }
            }
            scores.add(&score);
        });
        completed.then_some((gram, scores))
    }

    /// Residuals of every sample that counts, with the sample's place: one, or six whitened.
    pub fn residuals(&self, values: &[Values], mut visit: impl FnMut(usize, &[f64])) {
        let mut residuals = Vec::new();
        visit_with::<0>(self, values, |place, rows| {
            residuals.clear();
            residuals.extend(rows.filter_map(|row| row.last()));
            visit(place, &residuals);
        });
    }

    /// Every row: derivatives by the free parameters, then the residual.
    pub fn rows(&self, values: &[Values], mut visit: impl FnMut(&[f64])) {
        self.visit(values, |_, rows| rows.for_each(&mut visit));
    }

    fn visit(&self, values: &[Values], visit: impl FnMut(usize, Rows<'_>)) -> bool {
        let most = self.members.iter().map(|member| member.free.len()).max().unwrap_or(0);
        with_room_for!(most, visit_with(self, values, visit))
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Sum of the losses for several σ at once, of all cables: `sigmas_n_per_m[candidate][cable]`.
    pub fn losses_by_sigma(&self, values: &[Values], sigmas_n_per_m: &[Vec<f64>; LANES]) -> [f64; LANES] {
        let first_of = |lanes: Lanes| lanes.to_array()[0];
        let cables = self.members.iter().zip(values).enumerate().map(|(index, (member, values))| {
            let mut lanes = values.map(Lanes::splat);
            let of_cable = |candidate: &Vec<f64>| candidate.get(index).copied().unwrap_or(values[SIGMA]);
            lanes[SIGMA] = Lanes::new(sigmas_n_per_m.each_ref().map(of_cable));
            (member.record, SingleCable::new(member.record.params, &lanes, member.record.cycle_s, first_of, |_| false))
        });
        let cables: Vec<_> = cables.collect();
        let forces: Vec<Vec<[f64; LANES]>> = cables
            .par_iter()
            .map(|(record, at_rest)| {
                let mut forces_n = Vec::with_capacity(record.rows.len());
                let keep = |_, _: &Row, forces: &CableForces<Lanes>| forces_n.push(forces.platform_force_n.to_array());
                run(record, || at_rest.clone(), keep);
                forces_n
            })
            .collect();
        let mut sums = [0.0; LANES];
        let mut of_sample = vec![0.0; self.members.len()];
        let mut residuals = Vec::new();
        for (place, _) in self.used.iter().enumerate().filter(|(_, used)| **used) {
            for (candidate, sum) in sums.iter_mut().enumerate() {
                for (force_n, of_cable) in of_sample.iter_mut().zip(&forces) {
                    *force_n = of_cable.get(place).map_or(f64::NAN, |lanes| lanes[candidate]);
                }
                self.compare(place, &of_sample, &mut residuals);
                *sum += residuals.iter().map(|residual| self.loss.root(*residual).0.powi(2)).sum::<f64>();
            }
        }
        sums
    }

    /// Residuals of a sample from the forces of all cables.
    fn compare(&self, place: usize, forces_n: &[f64], residuals: &mut Vec<f64>) {
        residuals.clear();
        match &self.comparison {
            Comparison::Forces => {
                let rows = self.members.first().and_then(|member| member.record.rows.get(place));
                residuals.extend(rows.zip(forces_n.first()).map(|(row, force_n)| force_n - row.reference_n));
            }
            Comparison::Wrench { structure, outside, whitening } => {
                let count = self.members.len();
                let columns = structure.iter().skip(place * count).zip(forces_n);
                let start = outside.get(place).copied().unwrap_or_else(|| Vector6::repeat(f64::NAN));
                let balance = columns.fold(start, |sum, (column, force_n)| sum + column * *force_n);
                residuals.extend((**whitening * balance).iter());
            }
        }
    }

    /// Derivatives of a sample's residuals by the force of each cable: one column a cable.
    fn levers(&self, place: usize, levers: &mut Vec<Vector6<f64>>) {
        levers.clear();
        match &self.comparison {
            Comparison::Forces => levers.push(Vector6::repeat(1.0)),
            Comparison::Wrench { structure, whitening, .. } => {
                let count = self.members.len();
                levers.extend(structure.iter().skip(place * count).take(count).map(|column| **whitening * column));
            }
        }
    }
}

/// Room for what is made of each sample.
#[derive(Default)]
struct Assembly {
    forces_n: Vec<f64>,
    residuals: Vec<f64>,
    levers: Vec<Vector6<f64>>,
    rows: Vec<f64>,
}

impl Assembly {
    /// Rows of a sample from the forces of all cables with their derivatives.
    fn assemble<const N: usize>(&mut self, problem: &Problem<'_>, place: usize, runs: &[Run<'_, N>], offset: usize) {
        let Self { forces_n, residuals, levers, rows } = self;
        forces_n.clear();
        forces_n.extend(runs.iter().filter_map(|run| run.forces.get(offset)).map(|force| force.value));
        problem.compare(place, forces_n, residuals);
        problem.levers(place, levers);
        rows.clear();
        for (component, residual) in residuals.iter().enumerate() {
            let (root, slope) = problem.loss.root(*residual);
            for (run, lever) in runs.iter().zip(&*levers) {
                let factor = slope * lever[component];
                let gradient = run.forces.get(offset).map_or([f64::NAN; N], |force| force.gradient);
                rows.extend(gradient.iter().take(run.member.free.len()).map(|part| factor * part));
            }
            rows.push(root);
        }
    }
}

/// A cable on its way through a log.
struct Run<'a, const N: usize> {
    member: &'a Member<'a>,
    cable: SingleCable<Dual<N>>,
    forces: Vec<Dual<N>>,
}

impl<const N: usize> Run<'_, N> {
    fn advance(&mut self, from: usize, to: usize) {
        let Self { member, cable, forces } = self;
        forces.clear();
        let rows = member.record.rows.get(from..to).unwrap_or_default();
        forces.extend(rows.iter().map(|row| cable.step(&row.signals, row.pose_wrap).platform_force_n));
    }
}

/// Evaluates all samples, with the derivatives by the first `N` free parameters of each cable; false when stopped.
fn visit_with<const N: usize>(
    problem: &Problem<'_>,
    values: &[Values],
    mut visit: impl FnMut(usize, Rows<'_>),
) -> bool {
    let Some(first) = problem.members.first() else { return true };
    let width = problem.members.iter().map(|member| member.free.len().min(N)).sum::<usize>() + 1;
    let mut assembly = Assembly::default();
    for (start, log) in first.record.logs() {
        let mut runs: Vec<Run<'_, N>> = Vec::with_capacity(problem.members.len());
        for (member, values) in problem.members.iter().zip(values) {
            let cable = differentiated::<N>(&member.record, values, &member.free);
            runs.push(Run { member, cable, forces: Vec::with_capacity(CHUNK) });
        }
        let end = start + log.len();
        for from in (start..end).step_by(CHUNK) {
            if problem.stopped() {
                return false;
            }
            let to = (from + CHUNK).min(end);
            if let [only] = runs.as_mut_slice() {
                only.advance(from, to);
            } else {
                runs.par_iter_mut().for_each(|run| run.advance(from, to));
            }
            for (offset, place) in (from..to).enumerate() {
                if problem.used.get(place).copied().unwrap_or(false) {
                    assembly.assemble(problem, place, &runs, offset);
                    visit(place, assembly.rows.chunks_exact(width));
                }
            }
        }
    }
    true
}
