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
        whitening: Matrix6<f64>,
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
struct Rows {
    numbers: Vec<f64>,
    width: usize,
}

impl Rows {
    fn iter(&self) -> impl Iterator<Item = &[f64]> {
        self.numbers.chunks_exact(self.width)
    }
}

impl Problem<'_> {
    /// How many parameters vary, of all cables.
    pub fn parameter_count(&self) -> usize {
        self.members.iter().map(|member| member.free.len()).sum()
    }

    /// Residuals and Jacobian at the values of each cable, reduced; `None` when stopped.
    pub fn gram(&self, values: &[Values]) -> Option<Gram> {
        let mut gram = Gram::new(self.parameter_count());
        let completed = self.visit(values, |_, rows| {
            for row in rows.iter() {
                gram.add(row);
            }
        });
        completed.then_some(gram)
    }

    /// The samples' scores at the values of each cable.
    pub fn scores(&self, values: &[Values]) -> Scores {
        let count = self.parameter_count();
        let mut scores = Scores::new(count);
        let mut score = vec![0.0; count];
        self.visit(values, |_, rows| {
            score.fill(0.0);
            for row in rows.iter() {
                let Some((residual, derivatives)) = row.split_last() else { continue };
                for (sum, derivative) in score.iter_mut().zip(derivatives) {
                    *sum += derivative * residual;
                }
            }
            scores.add(&score);
        });
        scores
    }

    /// Residuals of every sample that counts, with the sample's place: one, or six whitened.
    pub fn residuals(&self, values: &[Values], mut visit: impl FnMut(usize, &[f64])) {
        let mut residuals = Vec::new();
        self.visit(values, |place, rows| {
            residuals.clear();
            residuals.extend(rows.iter().filter_map(|row| row.last()));
            visit(place, &residuals);
        });
    }

    fn visit(&self, values: &[Values], visit: impl FnMut(usize, &Rows)) -> bool {
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
                residuals.clear();
                self.compare(place, &of_sample, &mut residuals);
                *sum += residuals.iter().map(|residual| self.loss.root(*residual).0.powi(2)).sum::<f64>();
            }
        }
        sums
    }

    /// Residuals of a sample from the forces of all cables.
    fn compare(&self, place: usize, forces_n: &[f64], residuals: &mut Vec<f64>) {
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
                residuals.extend((whitening * balance).iter());
            }
        }
    }

    /// Rows of a sample from the forces of all cables with their derivatives.
    fn assemble<const N: usize>(&self, place: usize, forces: &[&Dual<N>], plain_n: &mut Vec<f64>, rows: &mut Rows) {
        plain_n.clear();
        plain_n.extend(forces.iter().map(|force| force.value));
        let mut residuals = Vec::with_capacity(6);
        self.compare(place, plain_n, &mut residuals);
        rows.numbers.clear();
        for (component, residual) in residuals.into_iter().enumerate() {
            let (root, slope) = self.loss.root(residual);
            for (index, (member, force)) in self.members.iter().zip(forces).enumerate() {
                let factor = slope * self.lever(place, index, component);
                rows.numbers.extend(force.gradient.iter().take(member.free.len()).map(|part| factor * part));
            }
            rows.numbers.push(root);
        }
    }

    /// Derivative of a residual by a cable's force.
    fn lever(&self, place: usize, cable: usize, component: usize) -> f64 {
        match &self.comparison {
            Comparison::Forces => 1.0,
            Comparison::Wrench { structure, whitening, .. } => structure
                .get(place * self.members.len() + cable)
                .map_or(f64::NAN, |column| (whitening.row(component) * column).x),
        }
    }
}

/// Evaluates all samples; false when stopped.
fn visit_with<const N: usize>(problem: &Problem<'_>, values: &[Values], mut visit: impl FnMut(usize, &Rows)) -> bool {
    let members = || problem.members.iter().zip(values);
    let mut rows = Rows { numbers: Vec::new(), width: problem.parameter_count() + 1 };
    let mut plain_n = Vec::new();
    let Some(first) = problem.members.first() else { return true };
    for (start, log) in first.record.logs() {
        let mut cables: Vec<_> = members()
            .map(|(member, values)| (member, differentiated::<N>(&member.record, values, &member.free), Vec::new()))
            .collect();
        let end = start + log.len();
        for from in (start..end).step_by(CHUNK) {
            if problem.stopped() {
                return false;
            }
            let to = (from + CHUNK).min(end);
            let run = |(member, cable, forces): &mut (&Member<'_>, SingleCable<Dual<N>>, Vec<Dual<N>>)| {
                forces.clear();
                let chunk = member.record.rows.get(from..to).unwrap_or_default();
                forces.extend(chunk.iter().map(|row| cable.step(&row.signals, row.pose_wrap).platform_force_n));
            };
            if let [only] = cables.as_mut_slice() {
                run(only);
            } else {
                cables.par_iter_mut().for_each(run);
            }
            for (offset, place) in (from..to).enumerate() {
                if problem.used.get(place).copied().unwrap_or(false) {
                    let forces: Vec<&Dual<N>> = cables.iter().filter_map(|(_, _, forces)| forces.get(offset)).collect();
                    problem.assemble(place, &forces, &mut plain_n, &mut rows);
                    visit(place, &rows);
                }
            }
        }
    }
    true
}
