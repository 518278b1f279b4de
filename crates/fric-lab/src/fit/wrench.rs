//! Identification of all cables at once from the wrench on the platform, without a force sensor there.
//!
//! With the outside wrench `w` known, `A^T f(p) + w = 0` (\[P\] 3) holds for the true parameters: six equations a sample for
//! the parameters of all cables. Neither force sensors at the platform nor a change of the robot are needed.
//!
//! **What it cannot see.** Forces that hold each other in balance (`A^T f = 0`: inner tension) change no wrench. A robot of
//! m cables has m − 6 such combinations in each pose; over a run through the workspace they turn, so that what friction
//! does to a cable still shows. A constant offset hardly turns: ε of the cables is often seen in combinations only. So friction is
//! fitted first with the offsets held; then those join in that the samples turn out to determine.
//!
//! The six deviations are weighed by the inverse of their covariance, found from the first fit; the standard errors do not
//! rely on it.

use fric_core::Wrench;
use fric_core::parameters::{OFFSET, Values};
use nalgebra::{Matrix6, Vector6};

use super::cables::{cable_fits, leave_out_warm_up, used};
use super::problem::{Comparison, Loss, Member, Problem};
use super::record::{CableRecord, Measurements};
use super::report::WrenchFit;
use super::selection::{self, Standing};
use super::solve::{Solution, Unknown, contradicts, search, solve, vagueness};
use super::{FitOptions, Progress, start};
use crate::replay::{WrenchErrors, WrenchReference};
use crate::weight;

/// Fits all cables to the outside wrench. Only for a robot of which every cable has an attachment, and for
/// [`Measurements`] with [`Reference::Wrench`](super::Reference::Wrench).
#[must_use]
pub fn fit_wrench(measurements: &Measurements<'_>, options: &FitOptions, progress: &Progress) -> WrenchFit {
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    let given: Vec<Values> = records.iter().map(|record| record.params.values()).collect();
    let platform = measurements.platform();
    let is_measured = platform.wrenches.iter().any(Option::is_some);
    let reference = if is_measured { WrenchReference::Measured } else { WrenchReference::Mass };
    let outside = outside_wrenches(measurements, reference);
    let has_wrench = |place: usize| outside.get(place).is_some_and(|wrench| wrench.iter().all(|part| part.is_finite()));
    let reaches = |place: usize| {
        let mut columns = platform.structure.iter().skip(place * records.len()).take(records.len());
        columns.all(|column| column.x.is_finite())
    };
    let mut of_cables: Vec<Vec<Standing>> = records
        .iter()
        .map(|record| selection::first_look(record, |place, _| has_wrench(place) && reaches(place)))
        .collect();
    progress.begin(2);
    let mut problem = Problem {
        members: without_offsets(&records, options),
        comparison: Comparison::Wrench {
            structure: &platform.structure,
            outside: &outside,
            whitening: Box::new(by_moment_arm(&platform.structure)),
        },
        loss: Loss::Squares,
        used: used(&together(&of_cables)),
        stop: progress.stop_flag(),
        seat: None,
    };
    let cycle_s = measurements.robot().cycle_s();
    let starts = start::starts(&problem, &given, cycle_s);
    for standings in &mut of_cables {
        leave_out_warm_up(&problem, &starts, standings);
    }
    let mut standings = together(&of_cables);
    problem.used = used(&standings);
    // Friction first, then the offsets with it; all once to learn how the six deviations scatter, and once with that.
    let mut solution = solve(&mut problem, starts, &given, cycle_s, options.weighing, &mut standings, &[]);
    let (mut undetermined, mut evaluation_count) =
        (std::mem::take(&mut solution.undetermined), solution.evaluation_count);
    let (determined, vague, kept) = offsets(&problem, &records, options, &solution, cycle_s);
    undetermined.extend(vague);
    let with_offsets = !determined.is_empty();
    for offset in determined {
        if let Some(member) = problem.members.get_mut(offset.member) {
            member.free.push(offset.parameter);
        }
    }
    if with_offsets {
        solution = solve(&mut problem, vec![solution.values], &given, cycle_s, options.weighing, &mut standings, &kept);
        undetermined.append(&mut solution.undetermined);
        evaluation_count += solution.evaluation_count;
    }
    progress.finish_one();
    let scatter = scatter(&problem, &solution.values);
    if let (Comparison::Wrench { whitening, .. }, Some(turn)) = (&mut problem.comparison, scatter) {
        **whitening = turn * **whitening;
    }
    problem.loss = Loss::Squares;
    solution = solve(&mut problem, vec![solution.values], &given, cycle_s, options.weighing, &mut standings, &kept);
    solution.undetermined.extend(undetermined);
    solution.evaluation_count += evaluation_count;
    progress.finish_one();
    let cables = cable_fits(&problem, &given, &solution, &standings);
    let [before, after] = wrench_errors(&problem, &solution.values, &platform.structure, &outside);
    WrenchFit { cables, reference, before, after }
}

/// Deviation of the wrench by the cable forces from the one outside, with frictionless and with compensated forces.
fn wrench_errors(
    problem: &Problem<'_>,
    values: &[Values],
    structure: &[Vector6<f64>],
    outside: &[Vector6<f64>],
) -> [WrenchErrors; 2] {
    let forces = problem.forces(values).unwrap_or_default();
    let count = problem.members.len();
    let mut errors = [WrenchErrors::default(), WrenchErrors::default()];
    for (cycle, outside) in outside.iter().enumerate() {
        let mut sums = [*outside, *outside];
        let columns = structure.iter().skip(cycle * count).take(count);
        for ((member, forces), column) in problem.members.iter().zip(&forces).zip(columns) {
            let sensor_n = member.record.rows.get(cycle).map_or(f64::NAN, |row| row.signals.sensor_force_n);
            let frictionless_n = sensor_n * member.record.params.frictionless_gain();
            sums[0] += column * frictionless_n;
            sums[1] += column * forces.at(cycle).0;
        }
        for (errors, sum) in errors.iter_mut().zip(sums) {
            errors.add(&Wrench { force_n: sum.fixed_rows::<3>(0).into(), torque_nm: sum.fixed_rows::<3>(3).into() });
        }
    }
    errors
}

/// All cables with what is to be varied of them, but for the offsets.
fn without_offsets<'a>(records: &[CableRecord<'a>], options: &FitOptions) -> Vec<Member<'a>> {
    let member = |record: &CableRecord<'a>| {
        let mut free = options.free(record.params);
        free.retain(|parameter| parameter.place() != OFFSET);
        Member { record: *record, free }
    };
    records.iter().map(member).collect()
}

/// The offsets that are to be varied, those that the samples determine or that they contradict to be as given, those to be
/// held, and which of the first are to be varied in any case.
fn offsets(
    problem: &Problem<'_>,
    records: &[CableRecord<'_>],
    options: &FitOptions,
    solution: &Solution,
    cycle_s: f64,
) -> (Vec<Unknown>, Vec<Unknown>, Vec<Unknown>) {
    let mut trial = problem.clone();
    for (member, record) in trial.members.iter_mut().zip(records) {
        member.free.extend(options.free(record.params).into_iter().filter(|parameter| parameter.place() == OFFSET));
    }
    if trial.parameter_count() == problem.parameter_count() || !problem.used.contains(&true) {
        return Default::default();
    }
    let (values, _) = search(&trial, &solution.values, cycle_s);
    let (_, all) = vagueness(&trial, &values);
    let offsets = all.into_iter().filter(|(_, unknown)| unknown.parameter.place() == OFFSET);
    if contradicts(problem, &solution.values, &trial, &values) {
        // Together they matter, whatever is known of each: a wrong mass, a payload.
        let offsets: Vec<Unknown> = offsets.map(|(_, unknown)| unknown).collect();
        return (offsets.clone(), Vec::new(), offsets);
    }
    let (determined, vague): (Vec<_>, Vec<_>) = offsets.partition(|(vagueness, _)| *vagueness <= 1.0);
    let unknowns = |all: Vec<(f64, Unknown)>| all.into_iter().map(|(_, unknown)| unknown).collect();
    (unknowns(determined), unknowns(vague), Vec::new())
}

/// The outside wrench of each sample; NaN where there is none.
fn outside_wrenches(measurements: &Measurements<'_>, reference: WrenchReference) -> Vec<Vector6<f64>> {
    let platform = measurements.platform();
    let vector = |wrench: &Option<Wrench>| wrench.as_ref().map_or_else(|| Vector6::repeat(f64::NAN), Wrench::to_vector);
    if reference == WrenchReference::Measured {
        return platform.wrenches.iter().map(vector).collect();
    }
    let ends = measurements.starts().iter().skip(1).copied().chain([platform.poses.len()]);
    let logs = measurements.starts().iter().zip(ends).filter_map(|(start, end)| platform.poses.get(*start..end));
    logs.flat_map(|poses| weight::wrenches(measurements.robot(), poses)).map(|wrench| vector(&wrench)).collect()
}

/// Standing of each sample for all cables together: what is the matter with the first that it cannot be used for.
fn together(of_cables: &[Vec<Standing>]) -> Vec<Standing> {
    let count = of_cables.first().map_or(0, Vec::len);
    let of_sample = |place: usize| {
        let mut standings = of_cables.iter().filter_map(|standings| standings.get(place));
        standings.find(|standing| **standing != Standing::Used).copied().unwrap_or(Standing::Used)
    };
    (0..count).map(of_sample).collect()
}

/// Brings torques to the scale of forces, by the mean moment arm.
fn by_moment_arm(structure: &[Vector6<f64>]) -> Matrix6<f64> {
    let all_m = structure.iter().map(|column| column.fixed_rows::<3>(3).norm()).filter(|arm_m| arm_m.is_finite());
    let (sum_m, count) = all_m.fold((0.0, 0.0), |(sum, count), arm_m| (sum + arm_m, count + 1.0));
    // Cables that all meet in the platform's origin exert no torque: there is nothing to scale.
    let arm_m = if sum_m > 0.0 { sum_m / count } else { 1.0 };
    Matrix6::from_diagonal(&Vector6::new(1.0, 1.0, 1.0, 1.0 / arm_m, 1.0 / arm_m, 1.0 / arm_m))
}

/// What turns the deviations at `values` into independent ones of variance 1; `None` where they span fewer than six
/// directions.
fn scatter(problem: &Problem<'_>, values: &[Values]) -> Option<Matrix6<f64>> {
    let mut squares = Matrix6::zeros();
    let mut count = 0.0;
    problem.residuals(values, |_, residuals| {
        if residuals.len() == 6 {
            let deviation = Vector6::from_row_slice(residuals);
            squares += deviation * deviation.transpose();
            count += 1.0;
        }
    });
    let covariance = squares / count;
    let factor = covariance.cholesky()?.l();
    let least = factor.diagonal().min() / factor.diagonal().max();
    if least > 1e-6 { factor.try_inverse() } else { None }
}
