//! The least-squares problem of \[P\] 18, and its variant with the platform's wrench instead of force sensors.
//!
//! - Cable forces: one residual per sample, `f(p) − f_ref`, for one cable.
//! - Wrench: six residuals per sample, `w + A^T f(p)` (\[P\] 3), for all cables together. A [`whitening`](Comparison::Wrench) matrix brings forces
//!   and torques to one scale.

use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fric_core::parameters::{SIGMA, Values};
use fric_core::scalar::Scalar;
use fric_core::{LANES, Lanes};
use nalgebra::{DMatrix, Matrix6, Vector6};
use rayon::prelude::*;

use super::gang::{Seat, all_forces, forces_of};
use super::gram::Gram;
use super::pass::{CandidatePass, Forces, Part};
use super::stream::Stream;
use super::vector::Parameter;
use super::zeros::Zeros;
use crate::certainty::groups::Groups;
use crate::certainty::scores::Scores;
use crate::samples::cable::CableRecord;
use crate::samples::record::{LogZero, PerLog};

/// Number of samples that are evaluated before they are assembled.
const CHUNK: usize = 2048;

/// A cable of the problem.
#[derive(Clone, Debug)]
pub struct Member<'a> {
    pub record: CableRecord<'a>,
    /// The free parameters.
    pub free: Vec<Parameter>,
}

impl<'a> Member<'a> {
    /// Returns the cable's part in a pass. The derivative with respect to a sensor's zero per log comes behind those of the free parameters.
    pub fn part(&self, values: &Values, derivatives: bool) -> Part<'a> {
        let mut free = if derivatives { self.free.clone() } else { Vec::new() };
        if derivatives && self.record.per_log.is_some_and(|per_log| per_log.zero == LogZero::Sensor) {
            free.extend(Parameter::all().filter(|parameter| parameter.place() == LogZero::Sensor.place()));
        }
        Part { record: self.record, values: *values, free }
    }
}

/// What the model is compared with.
#[derive(Clone, Debug)]
pub enum Comparison<'a> {
    /// The cable force at the platform, for a single cable.
    Forces,
    /// The external wrench.
    Wrench {
        /// Columns of the structure matrix: all cables of a sample, one sample after the other.
        structure: &'a [Vector6<f64>],
        /// The wrench of each sample; NaN if there is none.
        outside: &'a [Vector6<f64>],
        /// Transforms deviations into independent numbers of variance 1.
        whitening: Box<Matrix6<f64>>,
    },
}

/// The loss function for deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Loss {
    /// Squared deviation.
    Squares,
    /// Squared deviation up to a bound, linear beyond it (Huber). The bound is in the unit of the residuals.
    Huber(f64),
}

impl Loss {
    /// Returns the number whose square is the loss, and its slope: `r`, or `±√(2b|r| − b²)` beyond the bound `b`.
    fn root(self, residual: f64) -> (f64, f64) {
        match self {
            Self::Huber(bound) if residual.abs() > bound => {
                let root = (2.0 * bound * residual.abs() - bound * bound).sqrt();
                (root.copysign(residual), bound / root)
            }
            _ => (residual, 1.0),
        }
    }

    /// Returns the slope for a value of the root.
    fn slope_at(self, root: f64) -> f64 {
        match self {
            Self::Huber(bound) if root.abs() > bound => bound / root.abs(),
            _ => 1.0,
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
    /// Flag that ends every evaluation when set from outside.
    pub stop: &'a AtomicBool,
    /// The gang seat through which a single cable runs its passes beside others.
    pub seat: Option<Rc<Seat<'a>>>,
}

/// The rows of a sample: derivatives with respect to every free parameter, then the residual.
pub type Rows<'a> = std::slice::ChunksExact<'a, f64>;

impl Problem<'_> {
    /// Returns the number of columns of the Jacobian: the free parameters of all cables, and a zero of each log if these have columns.
    pub fn parameter_count(&self) -> usize {
        let zeros = self.per_log().filter(|(_, per_log)| per_log.in_columns);
        let zero_count = zeros.map_or(0, |(member, _)| member.record.logs().count());
        self.members.iter().map(|member| member.free.len()).sum::<usize>() + zero_count
    }

    /// Returns the number of residuals that count.
    pub fn residual_count(&self) -> usize {
        let of_sample = match self.comparison {
            Comparison::Forces => 1,
            Comparison::Wrench { .. } => 6,
        };
        self.used.iter().filter(|used| **used).count() * of_sample
    }

    /// Returns residuals and Jacobian at the values of each cable, in reduced form; `None` if stopped.
    pub fn gram(&self, values: &[Values]) -> Option<Gram> {
        let mut gram = Gram::new(self.parameter_count());
        self.visit(values, true, |_, rows| rows.for_each(|row| gram.add(row))).then_some(gram)
    }

    /// Returns the same with the samples' scores, which are also summed up per group if `groups` is given.
    pub fn gram_and_scores(&self, values: &[Values], groups: Option<Groups>) -> Option<(Gram, Scores)> {
        let count = self.parameter_count();
        let mut gram = Gram::new(count);
        let mut scores = groups.map_or_else(|| Scores::new(count), |groups| Scores::grouped(count, groups));
        let mut score = vec![0.0; count];
        let completed = self.visit(values, true, |place, rows| {
            score.fill(0.0);
            for row in rows {
                gram.add(row);
                let Some((residual, derivatives)) = row.split_last() else { continue };
                for (sum, derivative) in score.iter_mut().zip(derivatives) {
                    *sum += derivative * residual;
                }
            }
            scores.add_of(place, &score);
        });
        completed.then_some((gram, scores))
    }

    /// Visits the residuals of every sample that counts, with the sample's index: one residual, or six whitened ones.
    pub fn residuals(&self, values: &[Values], mut visit: impl FnMut(usize, &[f64])) {
        let mut residuals = Vec::new();
        self.visit(values, false, |place, rows| {
            residuals.clear();
            residuals.extend(rows.filter_map(|row| row.last()));
            visit(place, &residuals);
        });
    }

    /// Visits every row: derivatives with respect to the free parameters, then the residual.
    pub fn rows(&self, values: &[Values], mut visit: impl FnMut(&[f64])) {
        self.visit(values, true, |_, rows| rows.for_each(&mut visit));
    }

    /// Returns `Jᵀd` for several changes `d` of the force of one member, as one column per change. `changes_n` holds the changes side by side for
    /// every cycle.
    pub fn projected(&self, values: &[Values], member: usize, changes_n: &[f64], count: usize) -> DMatrix<f64> {
        let mut sums = DMatrix::zeros(self.parameter_count(), count);
        let mut levers = Vec::new();
        self.visit(values, true, |place, rows| {
            let changes_n = changes_n.get(place * count..(place + 1) * count).unwrap_or_default();
            self.levers(place, &mut levers);
            let Some(lever) = levers.get(member) else { return };
            for ((root, derivatives), lever) in rows.filter_map(<[f64]>::split_last).zip(lever.iter()) {
                let factor = self.loss.slope_at(*root) * lever;
                for (mut column, change_n) in sums.column_iter_mut().zip(changes_n) {
                    column.iter_mut().zip(derivatives).for_each(|(sum, part)| *sum += part * factor * change_n);
                }
            }
        });
        sums
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Returns the sum of the losses of all cables for several σ at once: `sigmas_n_per_m[candidate][cable]`. The cycles must be consecutive cycles
    /// of a log; the first eighth only lets the friction settle after the start at rest. If stopped, the sum covers the cycles up to then.
    pub fn losses_by_sigma(&self, values: &[Values], sigmas_n_per_m: &[Vec<f64>], cycles: &Range<usize>) -> Vec<f64> {
        let count = sigmas_n_per_m.len();
        let pass_of = |(index, (member, values)): (usize, (&Member<'_>, &Values))| {
            let of_candidates = |candidates: &[Vec<f64>]| {
                let mut lanes = values.map(Lanes::splat);
                let of = |lane: usize| candidates.get(lane).and_then(|sigmas| sigmas.get(index));
                lanes[SIGMA] = Lanes::from_lanes(|lane| of(lane).copied().unwrap_or(values[SIGMA]));
                lanes
            };
            let candidates: Vec<Values<Lanes>> = sigmas_n_per_m.chunks(LANES).map(of_candidates).collect();
            CandidatePass::new(&member.record, &candidates)
        };
        let mut passes: Vec<CandidatePass> = self.members.iter().zip(values).enumerate().map(pass_of).collect();
        let mut forces = vec![Vec::new(); passes.len()];
        let width = count.next_multiple_of(LANES);
        let counted_from = cycles.start + cycles.len() / 8;
        let mut sums = vec![0.0; count];
        let (mut totals, mut count_of_samples) = (vec![0.0; count], 0.0);
        let mut of_sample = vec![0.0; self.members.len()];
        let mut residuals = Vec::new();
        for from in cycles.clone().step_by(CHUNK) {
            if self.stopped() {
                break;
            }
            let chunk = from..(from + CHUNK).min(cycles.end);
            for ((pass, member), forces) in passes.iter_mut().zip(&self.members).zip(&mut forces) {
                pass.advance(member.record.rows.get(chunk.clone()).unwrap_or_default(), forces);
            }
            for (offset, place) in chunk.enumerate() {
                if place < counted_from || !self.used.get(place).copied().unwrap_or(false) {
                    continue;
                }
                for (candidate, sum) in sums.iter_mut().enumerate() {
                    for (force_n, of_cable) in of_sample.iter_mut().zip(&forces) {
                        *force_n = of_cable.get(offset * width + candidate).copied().unwrap_or(f64::NAN);
                    }
                    self.compare(place, &of_sample, &mut residuals);
                    *sum += residuals.iter().map(|residual| self.loss.root(*residual).0.powi(2)).sum::<f64>();
                    if let (Some(total), Some(residual)) = (totals.get_mut(candidate), residuals.first()) {
                        *total += residual;
                    }
                }
                count_of_samples += 1.0;
            }
        }
        // A zero of this log takes up the mean of its residuals.
        if self.per_log().is_some() && count_of_samples > 0.0 {
            sums.iter_mut().zip(&totals).for_each(|(sum, total)| *sum -= total * total / count_of_samples);
        }
        sums
    }

    /// Computes the residuals of a sample from the forces of all cables.
    fn compare(&self, place: usize, forces_n: &[f64], residuals: &mut Vec<f64>) {
        residuals.clear();
        match &self.comparison {
            Comparison::Forces => {
                let reference_n = self.members.first().and_then(|member| member.record.references_n.get(place));
                residuals.extend(reference_n.zip(forces_n.first()).map(|(reference_n, force_n)| force_n - reference_n));
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

    /// Computes the derivatives of a sample's residuals with respect to the force of each cable: one column per cable.
    pub fn levers(&self, place: usize, levers: &mut Vec<Vector6<f64>>) {
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

/// Buffers for the rows of a sample.
#[derive(Default)]
struct Assembly {
    forces_n: Vec<f64>,
    residuals: Vec<f64>,
    levers: Vec<Vector6<f64>>,
    rows: Vec<f64>,
}

impl Assembly {
    /// Computes the rows of a sample from the forces of all cables and their derivatives; without derivatives, only the residuals.
    fn assemble(&mut self, problem: &Problem<'_>, stream: &Stream<'_>, place: usize, derivatives: bool) {
        let Self { forces_n, residuals, levers, rows } = self;
        forces_n.clear();
        forces_n.extend((0..problem.members.len()).map(|member| stream.at(member, place).0));
        problem.compare(place, forces_n, residuals);
        problem.levers(place, levers);
        rows.clear();
        for (component, residual) in residuals.iter().enumerate() {
            let (root, slope) = problem.loss.root(*residual);
            if derivatives {
                for ((member, of), lever) in problem.members.iter().enumerate().zip(&*levers) {
                    let factor = slope * lever[component];
                    let derivatives = stream.at(member, place).1;
                    rows.extend(derivatives.iter().take(of.free.len()).map(|part| factor * part));
                }
            }
            rows.push(root);
        }
    }
}

impl<'a> Problem<'a> {
    /// Returns the forces of every cable in every cycle, without derivatives; `None` if stopped.
    pub fn forces(&self, values: &[Values]) -> Option<Vec<Arc<Forces>>> {
        let parts: Vec<Part<'_>> =
            self.members.iter().zip(values).map(|(member, values)| member.part(values, false)).collect();
        if let (Some(seat), [part]) = (&self.seat, parts.as_slice()) {
            return seat.forces(part).map(|forces| vec![forces]);
        }
        let of_parts = |parts: &[Part<'_>]| all_forces::<0>(parts, vec![Forces::default(); parts.len()], self.stop);
        let of_lanes: Option<Vec<Vec<Forces>>> = parts.par_chunks(LANES).map(of_parts).collect();
        of_lanes.map(|forces| forces.into_iter().flatten().map(Arc::new).collect())
    }

    /// Makes the next forces come from a pass again after [`step`](Self::step).
    pub fn forget_step(&self) {
        self.seat.iter().for_each(|seat| seat.forget_moved());
    }

    /// Extrapolates from the values evaluated last to other values by the derivatives.
    pub fn step(&self, at: &[Values], to: &[Values]) {
        if let (Some(seat), [member], [at], [to]) = (&self.seat, self.members.as_slice(), at, to) {
            seat.step(&member.part(at, true), to);
        }
    }

    /// Evaluates all samples that count, with or without derivatives with respect to the free parameters. Returns false if stopped.
    pub fn visit(&self, values: &[Values], derivatives: bool, visit: impl FnMut(usize, Rows<'_>)) -> bool {
        if let (Some((member, per_log)), [values]) = (self.per_log(), values) {
            return self.visit_logs((member, per_log), values, derivatives, visit);
        }
        let parts: Vec<Part<'a>> =
            self.members.iter().zip(values).map(|(member, values)| member.part(values, derivatives)).collect();
        if let (Some(seat), [part]) = (&self.seat, parts.as_slice()) {
            let Some(forces) = seat.forces(part) else { return false };
            self.visit_single(part, &forces, visit);
            return true;
        }
        self.visit_stream(parts, derivatives, visit)
    }

    /// Evaluates chunk by chunk, so that memory does not grow with the log.
    fn visit_stream(&self, parts: Vec<Part<'a>>, derivatives: bool, mut visit: impl FnMut(usize, Rows<'_>)) -> bool {
        let width = parts.iter().map(|part| part.free.len()).sum::<usize>() + 1;
        let mut assembly = Assembly::default();
        let mut stream = Stream::new(parts);
        for (place, _) in self.used.iter().enumerate().filter(|(_, used)| **used) {
            if stream.advance_to(place) && self.stopped() {
                return false;
            }
            assembly.assemble(self, &stream, place, derivatives);
            visit(place, assembly.rows.chunks_exact(width));
        }
        true
    }
}

/// A cable whose logs have zeros of their own.
impl<'a> Problem<'a> {
    /// Returns the single cable and the zero that each of its logs has of its own; `None` if all logs have the same.
    pub fn per_log(&self) -> Option<(&Member<'a>, PerLog)> {
        let (Comparison::Forces, [member]) = (&self.comparison, self.members.as_slice()) else { return None };
        member.record.per_log.map(|per_log| (member, per_log))
    }

    /// Returns the zeros of the logs that are best at some values, and the forces that they result from; `None` if stopped.
    fn zeros(
        &self,
        (member, per_log): (&Member<'a>, PerLog),
        values: &Values,
        derivatives: bool,
    ) -> Option<(Zeros, Arc<Forces>)> {
        let part = member.part(values, derivatives || per_log.zero == LogZero::Sensor);
        let forces = match &self.seat {
            Some(seat) => seat.forces(&part)?,
            None => forces_of(std::slice::from_ref(&part), self.stop)?.pop().map(Arc::new)?,
        };
        let free_count = if part.free.is_empty() { 0 } else { member.free.len() };
        Some((Zeros::new((&member.record, per_log.zero), &forces, free_count, (&self.used, self.loss)), forces))
    }

    /// Returns what the zeros of the logs change in every cycle, N, beyond the common zero in `values`; `None` if all logs have the same. The samples
    /// that count determine them, and they hold for all.
    pub fn zero_shifts_n(&self, values: &Values) -> Option<Vec<f64>> {
        let (zeros, forces) = self.zeros(self.per_log()?, values, false)?;
        let of_log = |of: &super::zeros::Zero| -> Vec<f64> {
            of.cycles.clone().map(|cycle| zeros.lever(forces.at(cycle).1) * of.change_n).collect()
        };
        Some(zeros.logs.iter().flat_map(of_log).collect())
    }

    /// Returns by how much the zero of each log differs from the common zero in `values`, N; `None` for a log without a sample that counts.
    pub fn zero_changes_n(&self, values: &Values) -> Vec<Option<f64>> {
        let found = self.per_log().and_then(|per_log| self.zeros(per_log, values, false));
        let of = |zero: &super::zeros::Zero| zero.is_known.then_some(zero.change_n);
        found.map_or_else(Vec::new, |(zeros, _)| zeros.logs.iter().map(of).collect())
    }

    /// Evaluates the samples log by log, each log with its best zero.
    fn visit_logs(
        &self,
        (member, per_log): (&Member<'a>, PerLog),
        values: &Values,
        derivatives: bool,
        mut visit: impl FnMut(usize, Rows<'_>),
    ) -> bool {
        let Some((zeros, forces)) = self.zeros((member, per_log), values, derivatives) else { return false };
        let free_count = if derivatives { member.free.len() } else { 0 };
        let mut row = vec![0.0; if derivatives { self.parameter_count() } else { 0 } + 1];
        for (log, of_log) in zeros.logs.iter().enumerate() {
            for place in of_log.cycles.clone().filter(|place| self.used.get(*place).copied().unwrap_or(false)) {
                let (force_n, gradient) = forces.at(place);
                let Some(reference_n) = member.record.references_n.get(place) else { continue };
                let lever = zeros.lever(gradient);
                let (root, slope) = self.loss.root(force_n + lever * of_log.change_n - reference_n);
                row.fill(0.0);
                for ((entry, part), by_free) in
                    row.iter_mut().zip(gradient.iter().take(free_count)).zip(&of_log.by_free)
                {
                    let eliminated = if per_log.in_columns { 0.0 } else { lever * by_free };
                    *entry = slope * (part - eliminated);
                }
                if let Some(entry) = row.get_mut(free_count + log).filter(|_| derivatives && per_log.in_columns) {
                    *entry = slope * lever;
                }
                row.last_mut().into_iter().for_each(|entry| *entry = root);
                visit(place, row.chunks_exact(row.len()));
            }
        }
        true
    }

    /// Returns by how much the force changes in every cycle with the zero of its log; `None` if all logs have the same.
    pub fn zero_levers(&self, values: &Values) -> Option<ZeroLevers> {
        let (zeros, forces) = self.zeros(self.per_log()?, values, false)?;
        Some(ZeroLevers { zeros, forces })
    }
}

/// By how much the force changes in every cycle with the zero of its log.
pub struct ZeroLevers {
    zeros: Zeros,
    forces: Arc<Forces>,
}

impl ZeroLevers {
    /// Returns the cycles of each log.
    pub fn logs(&self) -> impl Iterator<Item = Range<usize>> {
        self.zeros.logs.iter().map(|of_log| of_log.cycles.clone())
    }

    /// Returns the lever in a cycle.
    pub fn at(&self, cycle: usize) -> f64 {
        self.zeros.lever(self.forces.at(cycle).1)
    }
}

impl Problem<'_> {
    /// Evaluates a single cable from available forces, which already form nearly complete rows.
    fn visit_single(&self, part: &Part<'_>, forces: &Forces, mut visit: impl FnMut(usize, Rows<'_>)) {
        let mut of_sample = vec![0.0; part.free.len() + 1];
        let references_n = part.record.references_n.iter().zip(&self.used).enumerate();
        for (place, (reference_n, _)) in references_n.filter(|(_, (_, used))| **used) {
            let (force_n, gradient) = forces.at(place);
            let (root, slope) = self.loss.root(force_n - reference_n);
            for (entry, part) in of_sample.iter_mut().zip(gradient) {
                *entry = slope * part;
            }
            of_sample.last_mut().into_iter().for_each(|entry| *entry = root);
            visit(place, of_sample.chunks_exact(of_sample.len()));
        }
    }
}
