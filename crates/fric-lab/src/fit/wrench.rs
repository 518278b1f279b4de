//! Identification of all cables at once from the wrench on the platform, without a force sensor there.
//!
//! With a known external wrench `w`, `A^T f(p) + w = 0` (\[P\] 3) holds for the true parameters: six equations per sample for the parameters of all
//! cables. The fit needs neither force sensors at the platform nor a change of the robot.
//!
//! **Limits.** Forces in mutual balance (`A^T f = 0`, inner tension) do not change the wrench. A robot of m cables has m − 6 such combinations in
//! each pose. They turn during a run through the workspace, so the friction of a cable still shows. A constant offset hardly turns: ε of the cables
//! is often determined only in combinations. So friction is fitted first with the offsets held, and then the offsets that the samples determine are
//! added.
//!
//! The six deviations are weighted by the inverse of their covariance, estimated from the first fit. The standard errors do not rely on it.

use fric_core::parameters::{OFFSET, Values};
use fric_core::{Pose, Wrench};
use nalgebra::{Matrix6, Vector6};

use super::balance;
use super::cables::{cable_fits, leave_out_warm_up, used};
use super::error::FitError;
use super::report::WrenchFit;
use super::{FitOptions, Progress, start};
use crate::candidates::newcomers::with_newcomers;
use crate::certainty::undetermined::{reported_covariance, solve, vagueness};
use crate::replay::{WrenchErrors, WrenchReference};
use crate::samples::cable::CableRecord;
use crate::samples::interpolated::measured_wrenches;
use crate::samples::noise::white_noise;
use crate::samples::record::Measurements;
use crate::samples::selection;
use crate::samples::selection::Standing;
use crate::samples::split::split;
use crate::search::problem::{Comparison, Loss, Member, Problem};
use crate::search::solve::{OpenCombination, Solution, Unknown, contradicts, search, settle};
use crate::search::vector::Parameter;
use crate::weight::{self, Body, Motion};

/// A sample between two measurements counts if the connecting line is off by less than this fraction of the noise, which is at most 6 % of its
/// variance.
const STRAIGHT_RATIO: f64 = 0.25;

/// Fits all cables to the external wrench. Every cable of the robot needs an attachment, and the [`Measurements`] need
/// [`Reference::Wrench`](super::Reference::Wrench).
///
/// The parameters come from all samples. Their error on unseen samples is computed beforehand: parameters from every other block of the log are
/// applied to the blocks between.
///
/// # Errors
/// Returns a [`FitError`] if the wrench does not determine the forces of the cables.
pub fn fit_wrench(
    measurements: &Measurements<'_>,
    options: &FitOptions,
    progress: &Progress,
) -> Result<WrenchFit, FitError> {
    let references = ReferenceWrenches::of(measurements)?;
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    let structure = measurements.platform().structure.as_slice();
    let case = Case { records, structure, references: &references, options, progress };
    progress.begin(4);
    let held_out = case.held_out();
    let Found { problem, mut solution, standings } = case.identified(&|_| true);
    if !solution.unknowns.is_empty() {
        solution.covariance = reported_covariance(&problem, &solution.values, &solution.undetermined);
    }
    let cables = cable_fits(&problem, &case.given(), &solution, &standings);
    let [before, after] = case.errors(&problem, &solution.values, &|_| true);
    Ok(WrenchFit { cables, reference: references.kind, before, after, held_out })
}

/// The wrenches that the forces of the cables are compared with.
#[derive(Debug)]
pub struct ReferenceWrenches {
    /// Whether the wrench is from the log or from the mass.
    pub kind: WrenchReference,
    /// The motion of the platform in each sample, if the wrench is from the mass; else empty.
    pub motions: Vec<Option<Motion>>,
    /// The external wrench of each sample; NaN if there is none.
    pub outside: Vec<Vector6<f64>>,
    /// Which samples are measured rather than interpolated between two measured wrenches.
    pub measured: Vec<bool>,
    /// Which samples are interpolated with an error too small to matter.
    straight: Vec<bool>,
}

impl ReferenceWrenches {
    /// # Errors
    /// Returns a [`FitError`] if the wrenches do not determine the forces of the cables.
    pub fn of(measurements: &Measurements<'_>) -> Result<Self, FitError> {
        let is_measured = measurements.platform().wrenches.iter().any(Option::is_some);
        let kind = if is_measured { WrenchReference::Measured } else { WrenchReference::Mass };
        let motions = if is_measured { Vec::new() } else { motions(measurements) };
        let outside = outside_wrenches(measurements, kind, &motions);
        balance::check(&measurements.platform().structure, &outside, measurements.robot().cables().len())?;
        let measured = measured_wrenches(measurements);
        let mut references = Self { kind, motions, straight: vec![false; outside.len()], outside, measured };
        references.find_straight(measurements);
        Ok(references)
    }

    /// Returns whether each sample can be compared.
    fn counts(&self) -> Vec<bool> {
        self.measured.iter().zip(&self.straight).map(|(measured, straight)| *measured || *straight).collect()
    }

    /// Marks the interpolated samples with a small error. Between two measurements at a distance `h`, where the adjacent lines change their slope by
    /// `j` and `k`, the wrench differs from the line by at most `h·(|j| + |k|)/4`, for a single corner or a steady curvature. This must be small
    /// beside the noise.
    fn find_straight(&mut self, measurements: &Measurements<'_>) {
        let Some(record) = measurements.cables().next().filter(|_| self.measured.contains(&false)) else { return };
        let Some(noise) = self.white_noise(measurements) else { return };
        for (start, rows) in record.logs() {
            let knots: Vec<usize> = (start..start + rows.len()).filter(|place| self.measured[*place]).collect();
            let slope = |from: usize, to: usize| {
                (self.outside[to] - self.outside[from]) / (record.time_s(to) - record.time_s(from))
            };
            let between_s = |knots: &[usize]| {
                knots.first().zip(knots.last()).map(|(from, to)| record.time_s(*to) - record.time_s(*from))
            };
            let mut intervals_s: Vec<f64> = knots.windows(2).filter_map(between_s).collect();
            if intervals_s.is_empty() {
                continue;
            }
            // A measurement that happens to lie on a line is not detected, so no interval is longer than usual.
            let middle = intervals_s.len() / 2;
            let usual_s = *intervals_s.select_nth_unstable_by(middle, f64::total_cmp).1;
            let mut straight = Vec::new();
            for around in knots.windows(4) {
                let [before, from, to, after] = *around else { continue };
                let line = slope(from, to);
                let turns = (line - slope(before, from)).abs() + (slope(to, after) - line).abs();
                let most = turns * (0.25 * usual_s.min(record.time_s(to) - record.time_s(from)));
                if most.iter().zip(noise.iter()).all(|(most, noise)| *most <= STRAIGHT_RATIO * noise) {
                    straight.push(from + 1..to);
                }
            }
            for place in straight.into_iter().flatten() {
                self.straight[place] = true;
            }
        }
    }

    /// Returns the standard deviation of the white noise in the sum of forces and wrench, at measured samples; `None` if there are too few.
    fn white_noise(&self, measurements: &Measurements<'_>) -> Option<Vector6<f64>> {
        let records: Vec<CableRecord<'_>> = measurements.cables().collect();
        let structure = measurements.platform().structure.as_slice();
        let mut sums = self.outside.clone();
        for (place, sum) in sums.iter_mut().enumerate() {
            let columns = structure.iter().skip(place * records.len());
            for (record, column) in records.iter().zip(columns) {
                *sum += column * record.frictionless_n(place);
            }
        }
        let of_component = |component: usize| {
            let measured = sums.iter().zip(&self.measured).filter(|(_, measured)| **measured);
            white_noise(&measured.map(|(sum, _)| sum[component]).collect::<Vec<f64>>())
        };
        let noise: Option<Vec<f64>> = (0..6).map(of_component).collect();
        Some(Vector6::from_row_slice(&noise?))
    }
}

/// The given model of all cables, fitted to all samples.
#[derive(Debug)]
pub struct FirstModel {
    /// Values of each cable.
    pub values: Vec<Values>,
    /// The free parameters of each cable: those that act.
    pub free: Vec<Vec<Parameter>>,
    /// The standing of each sample for all cables together.
    pub standings: Vec<Standing>,
}

/// Fits what acts in the given model to the samples that count; offsets stay as given, for they are seen in combinations only. What the samples determine is not
/// asked: a model that lacks something does not know.
pub fn first_model(
    measurements: &Measurements<'_>,
    references: &ReferenceWrenches,
    counts: &dyn Fn(usize) -> bool,
    acts: impl Fn(&Parameter, &Values) -> bool,
    progress: &Progress,
) -> FirstModel {
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    let structure = measurements.platform().structure.as_slice();
    let options = FitOptions::default();
    let case = Case { records, structure, references, options: &options, progress };
    let is_wanted =
        |record: &CableRecord<'_>, of: &Parameter| of.place() != OFFSET && acts(of, &record.params.values());
    let Prepared { mut problem, starts, mut standings } = case.prepared(counts, &is_wanted);
    let solution = settle(&mut problem, starts, &case.given(), case.cycle_s(), options.weighing, &mut standings);
    let free = problem.members.into_iter().map(|member| member.free).collect();
    FirstModel { values: solution.values, free, standings }
}

/// The data of a fit.
struct Case<'a> {
    records: Vec<CableRecord<'a>>,
    /// Columns of the structure matrix: all cables of a sample, one sample after the other.
    structure: &'a [Vector6<f64>],
    references: &'a ReferenceWrenches,
    options: &'a FitOptions,
    progress: &'a Progress,
}

/// A problem ready for the search.
struct Prepared<'a> {
    problem: Problem<'a>,
    starts: Vec<Vec<Values>>,
    standings: Vec<Standing>,
}

/// The outcome of a search.
struct Found<'a> {
    problem: Problem<'a>,
    solution: Solution,
    standings: Vec<Standing>,
}

impl<'a> Case<'a> {
    fn given(&self) -> Vec<Values> {
        self.records.iter().map(|record| record.params.values()).collect()
    }

    /// Returns the errors on held-out blocks from a fit to the others; empty if the log is too short.
    fn held_out(&self) -> WrenchErrors {
        let blocks = self.records.first().map(split).unwrap_or_default();
        let mut is_held_out = vec![false; self.references.outside.len()];
        for block in blocks.iter().filter(|block| block.held_out) {
            is_held_out
                .iter_mut()
                .skip(block.cycles.start)
                .take(block.cycles.len())
                .for_each(|held_out| *held_out = true);
        }
        let held_out = |place: usize| is_held_out.get(place).copied().unwrap_or(false);
        let Found { problem, solution, .. } = self.identified(&|place| !held_out(place));
        if !problem.used.contains(&true) {
            return WrenchErrors::default();
        }
        let [_, after] = self.errors(&problem, &solution.values, &held_out);
        after
    }

    fn cycle_s(&self) -> f64 {
        self.records.first().map_or(f64::NAN, |record| record.cycle_s)
    }

    /// Returns the problem of the samples that count and the wanted parameters, with its starts.
    fn prepared(
        &self,
        counts: &dyn Fn(usize) -> bool,
        is_wanted: &dyn Fn(&CableRecord<'_>, &Parameter) -> bool,
    ) -> Prepared<'a> {
        let Self { structure, references, progress, .. } = *self;
        let outside = references.outside.as_slice();
        let given = self.given();
        let has_wrench =
            |place: usize| outside.get(place).is_some_and(|wrench| wrench.iter().all(|part| part.is_finite()));
        let reaches = |place: usize| {
            let mut columns = structure.iter().skip(place * self.records.len()).take(self.records.len());
            columns.all(|column| column.x.is_finite())
        };
        let counted = references.counts();
        let of_cable = |record: &CableRecord<'_>| {
            let mut standings =
                selection::first_look(record, |place| has_wrench(place) && reaches(place) && counts(place));
            selection::leave_out_interpolated(&counted, &mut standings);
            standings
        };
        let mut of_cables: Vec<Vec<Standing>> = self.records.iter().map(of_cable).collect();
        let mut problem = Problem {
            members: self.members(is_wanted),
            comparison: Comparison::Wrench {
                structure,
                outside,
                whitening: Box::new(balance::by_moment_arm(structure)),
            },
            loss: Loss::Squares,
            used: used(&together(&of_cables)),
            stop: progress.stop_flag(),
            seat: None,
        };
        // The forces of the cables show in combinations only, so that a search from the data may end in a false minimum. The given friction may be
        // nearer to the true one.
        let mut starts = start::starts(&problem, &given, self.cycle_s());
        starts.push(given.clone());
        for standings in &mut of_cables {
            leave_out_warm_up(&problem, &starts, standings);
        }
        let standings = together(&of_cables);
        problem.used = used(&standings);
        let starts = with_newcomers(&problem, starts, &given, self.cycle_s());
        Prepared { problem, starts, standings }
    }

    /// Identifies the parameters from the samples that count.
    fn identified(&self, counts: &dyn Fn(usize) -> bool) -> Found<'a> {
        let Self { options, progress, .. } = *self;
        let (given, cycle_s) = (self.given(), self.cycle_s());
        // Fits friction first, then the offsets too: once to estimate the scatter of the six deviations, and once weighted with it.
        let Prepared { mut problem, starts, mut standings } =
            self.prepared(counts, &|_, parameter| parameter.place() != OFFSET);
        let mut solution = solve(&mut problem, starts, &given, cycle_s, options.weighing, &mut standings);
        let mut earlier = Earlier::default();
        match self.offsets(&problem, &solution, cycle_s) {
            Offsets::Contradicted => {
                // Friction parameters that seemed undetermined beside wrong offsets are tried again, from all starts: offsets that look wrong may
                // also mean that the first search ended in a local minimum.
                problem.members = self.members(&|_, _| true);
                earlier.evaluation_count += solution.evaluation_count;
                let mut starts = vec![solution.values, given.clone()];
                starts.extend(start::starts(&problem, &given, cycle_s));
                let starts = with_newcomers(&problem, starts, &given, cycle_s);
                solution = solve(&mut problem, starts, &given, cycle_s, options.weighing, &mut standings);
            }
            Offsets::Apart { determined, vague } => {
                earlier.take(&mut solution);
                earlier.undetermined.extend(vague);
                for offset in &determined {
                    if let Some(member) = problem.members.get_mut(offset.member) {
                        member.free.push(offset.parameter);
                    }
                }
                if !determined.is_empty() {
                    solution =
                        solve(&mut problem, vec![solution.values], &given, cycle_s, options.weighing, &mut standings);
                }
            }
        }
        earlier.take(&mut solution);
        progress.finish_one();
        let scatter = scatter(&problem, &solution.values);
        if let (Comparison::Wrench { whitening, .. }, Some(turn)) = (&mut problem.comparison, scatter) {
            **whitening = turn * **whitening;
        }
        problem.loss = Loss::Squares;
        solution = solve(&mut problem, vec![solution.values], &given, cycle_s, options.weighing, &mut standings);
        earlier.give(&mut solution);
        progress.finish_one();
        Found { problem, solution, standings }
    }

    /// Returns all cables with their free parameters that are wanted.
    fn members(&self, is_wanted: &dyn Fn(&CableRecord<'_>, &Parameter) -> bool) -> Vec<Member<'a>> {
        let member = |record: &CableRecord<'a>| {
            let mut free = self.options.free(record.params);
            free.retain(|parameter| is_wanted(record, parameter));
            Member { record: *record, free }
        };
        self.records.iter().map(member).collect()
    }

    /// Returns what the samples say about the offsets, given the friction found without them.
    fn offsets(&self, problem: &Problem<'_>, solution: &Solution, cycle_s: f64) -> Offsets {
        let mut trial = problem.clone();
        for (member, offset) in trial.members.iter_mut().zip(self.members(&|_, parameter| parameter.place() == OFFSET))
        {
            member.free.extend(offset.free);
        }
        if trial.parameter_count() == problem.parameter_count() || !problem.used.contains(&true) {
            return Offsets::Apart { determined: Vec::new(), vague: Vec::new() };
        }
        let (values, _) = search(&trial, &solution.values, cycle_s);
        if contradicts(problem, &solution.values, &trial, &values) {
            return Offsets::Contradicted;
        }
        let (_, all) = vagueness(&trial, &values);
        let offsets = all.into_iter().filter(|(_, unknown)| unknown.parameter.place() == OFFSET);
        let (determined, vague): (Vec<_>, Vec<_>) = offsets.partition(|(vagueness, _)| *vagueness <= 1.0);
        let unknowns = |all: Vec<(f64, Unknown)>| all.into_iter().map(|(_, unknown)| unknown).collect();
        Offsets::Apart { determined: unknowns(determined), vague: unknowns(vague) }
    }

    /// Returns the wrench of the cable forces minus the external one, with frictionless and with compensated forces, over the samples that count.
    /// Interpolated samples are included, because a replay with the fitted parameters reports these errors.
    fn errors(&self, problem: &Problem<'_>, values: &[Values], counts: &dyn Fn(usize) -> bool) -> [WrenchErrors; 2] {
        let forces = problem.forces(values).unwrap_or_default();
        let count = problem.members.len();
        let mut errors = [WrenchErrors::default(), WrenchErrors::default()];
        for (cycle, outside) in self.references.outside.iter().enumerate().filter(|(cycle, _)| counts(*cycle)) {
            let mut sums = [*outside, *outside];
            let columns = self.structure.iter().skip(cycle * count).take(count);
            for ((member, forces), column) in problem.members.iter().zip(&forces).zip(columns) {
                sums[0] += column * member.record.frictionless_n(cycle);
                sums[1] += column * forces.at(cycle).0;
            }
            for (errors, sum) in errors.iter_mut().zip(sums) {
                errors
                    .add(&Wrench { force_n: sum.fixed_rows::<3>(0).into(), torque_nm: sum.fixed_rows::<3>(3).into() });
            }
        }
        errors
    }
}

/// What the samples say about the offsets.
enum Offsets {
    /// The given offsets are wrong, although the single ones may be uncertain: a wrong mass, a payload, a sensor's gain.
    Contradicted,
    /// The determined offsets are varied, the vague ones are held.
    Apart { determined: Vec<Unknown>, vague: Vec<Unknown> },
}

/// The results of earlier searches.
#[derive(Default)]
struct Earlier {
    undetermined: Vec<Unknown>,
    open: Vec<OpenCombination>,
    evaluation_count: usize,
}

impl Earlier {
    fn take(&mut self, solution: &mut Solution) {
        self.undetermined.append(&mut solution.undetermined);
        self.open.append(&mut solution.open);
        self.evaluation_count += std::mem::take(&mut solution.evaluation_count);
    }

    fn give(mut self, solution: &mut Solution) {
        self.take(solution);
        let Self { undetermined, open, evaluation_count } = self;
        *solution = Solution { undetermined, open, evaluation_count, ..solution.clone() };
    }
}

/// Returns the external wrench of each sample; NaN if there is none.
fn outside_wrenches(
    measurements: &Measurements<'_>,
    reference: WrenchReference,
    motions: &[Option<Motion>],
) -> Vec<Vector6<f64>> {
    let platform = measurements.platform();
    let vector = |wrench: Option<Wrench>| wrench.map_or_else(|| Vector6::repeat(f64::NAN), |wrench| wrench.to_vector());
    if reference == WrenchReference::Measured {
        return platform.wrenches.iter().copied().map(vector).collect();
    }
    let body = Body::of(measurements.robot());
    let of_sample = |(pose, motion): (&Option<Pose>, &Option<Motion>)| {
        pose.zip(*motion).map(|(pose, motion)| body.wrench(&pose.orientation, &motion))
    };
    platform.poses.iter().zip(motions).map(of_sample).map(vector).collect()
}

/// Returns the motion of the platform in each sample.
fn motions(measurements: &Measurements<'_>) -> Vec<Option<Motion>> {
    let poses = &measurements.platform().poses;
    let Some(record) = measurements.cables().next() else { return vec![None; poses.len()] };
    let of_log = |(start, count): (usize, usize)| {
        #[expect(clippy::cast_possible_truncation, reason = "a time of a log")]
        let stamp_nanos = |place: usize| (record.time_s(place) * 1e9).round() as i64;
        let stamped = (start..start + count).map(|place| (stamp_nanos(place), poses.get(place).copied().flatten()));
        weight::motions(measurements.robot(), stamped)
    };
    record.logs().map(|(start, rows)| (start, rows.len())).flat_map(of_log).collect()
}

/// Returns the standing of each sample for all cables together: that of the first cable for which it cannot be used.
fn together(of_cables: &[Vec<Standing>]) -> Vec<Standing> {
    let count = of_cables.first().map_or(0, Vec::len);
    let of_sample = |place: usize| {
        let mut standings = of_cables.iter().filter_map(|standings| standings.get(place));
        standings.find(|standing| **standing != Standing::Used).copied().unwrap_or(Standing::Used)
    };
    (0..count).map(of_sample).collect()
}

/// Returns the matrix that transforms the deviations at `values` into independent ones of variance 1; `None` if they span fewer than six directions.
fn scatter(problem: &Problem<'_>, values: &[Values]) -> Option<Matrix6<f64>> {
    let mut deviations = Vec::new();
    problem.residuals(values, |_, residuals| {
        if residuals.len() == 6 {
            deviations.push(Vector6::from_row_slice(residuals));
        }
    });
    let squares: Matrix6<f64> = deviations.iter().map(|deviation| deviation * deviation.transpose()).sum();
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let covariance = squares / deviations.len() as f64;
    let factor = covariance.cholesky()?.l();
    let least = factor.diagonal().min() / factor.diagonal().max();
    if least > 1e-6 { factor.try_inverse() } else { None }
}
