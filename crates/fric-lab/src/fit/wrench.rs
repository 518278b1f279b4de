//! Identification of all cables at once from the wrench on the platform, without a force sensor there.
//!
//! With the outside wrench `w` known, `A^T f(p) + w = 0` (\[P\] 3) holds for the true parameters: six equations a sample for
//! the parameters of all cables. Neither force sensors at the platform nor a change of the robot are needed.
//!
//! **What it cannot see.** Forces that hold each other in balance (`A^T f = 0`: inner tension) change no wrench. A robot of
//! m cables has m − 6 such combinations in each pose; over a run through the workspace they turn, so that what friction
//! does to a cable still shows. A constant offset does not turn enough: ε of the cables is seen in combinations only, and
//! is held where it is not determined.
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
use super::solve::{Solution, Unknown, solve};
use super::vector::Parameter;
use super::{FitOptions, Progress, start, weight};
use crate::replay::{Deviation, WrenchErrors};

/// Fits all cables to the outside wrench. Only for a robot of which every cable has an attachment, and for
/// [`Measurements`] with [`Reference::Wrench`](super::Reference::Wrench).
#[must_use]
pub fn fit_wrench(measurements: &Measurements<'_>, options: &FitOptions, progress: &Progress) -> WrenchFit {
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    let given: Vec<Values> = records.iter().map(|record| record.params.values()).collect();
    let platform = measurements.platform();
    let measured = platform.wrenches.iter().flatten().next().is_some();
    let outside = outside_wrenches(measurements, measured);
    let has_wrench = |place: usize| outside.get(place).is_some_and(|wrench| wrench.iter().all(|part| part.is_finite()));
    let reaches = |place: usize| {
        let mut columns = platform.structure.iter().skip(place * records.len()).take(records.len());
        columns.all(|column| column.x.is_finite())
    };
    let of_cables: Vec<Vec<Standing>> = records
        .iter()
        .map(|record| selection::first_look(record, |place, _| has_wrench(place) && reaches(place)))
        .collect();
    progress.begin(2);
    let comparison = Comparison::Wrench {
        structure: &platform.structure,
        outside: &outside,
        whitening: Box::new(by_moment_arm(&platform.structure)),
    };
    let problem = Problem {
        members: all_of(&records, options),
        comparison,
        loss: Loss::Squares,
        used: used(&together(&of_cables)),
        stop: progress.stop_flag(),
        seat: None,
    };
    let cycle_s = measurements.robot().cycle_s();
    let mut fitted = in_two_rounds(problem.clone(), &of_cables, &given, cycle_s, options);
    if offsets_ran_away(&fitted) {
        // The samples cannot tell the offsets from each other at all: hold them, or they take the friction with them.
        let is_offset = |parameter: &Parameter| parameter.place() == OFFSET;
        let mut held = problem;
        held.members.iter_mut().for_each(|member| member.free.retain(|parameter| !is_offset(parameter)));
        let offsets = fitted.1.unknowns.iter().chain(&fitted.1.undetermined);
        let offsets: Vec<Unknown> = offsets.filter(|unknown| is_offset(&unknown.parameter)).copied().collect();
        let evaluation_count = fitted.1.evaluation_count;
        fitted = in_two_rounds(held, &of_cables, &given, cycle_s, options);
        fitted.1.undetermined.extend(offsets);
        fitted.1.evaluation_count += evaluation_count;
    }
    progress.finish_one();
    let (problem, solution, standings) = fitted;
    let cables = cable_fits(&problem, &given, &solution, &standings);
    let [before, after] = wrench_errors(&problem, &solution.values, &platform.structure, &outside);
    WrenchFit { cables, measured, before, after }
}

/// A solved problem with the standing of its samples.
type Solved<'a> = (Problem<'a>, Solution, Vec<Standing>);

/// Solves once to learn how the six deviations scatter, and once with that.
fn in_two_rounds<'a>(
    mut problem: Problem<'a>,
    of_cables: &[Vec<Standing>],
    given: &[Values],
    cycle_s: f64,
    options: &FitOptions,
) -> Solved<'a> {
    let members = problem.members.clone();
    let starts = start::starts(&problem, given, cycle_s);
    let mut of_cables = of_cables.to_vec();
    for standings in &mut of_cables {
        leave_out_warm_up(&problem, &starts, standings);
    }
    let mut standings = together(&of_cables);
    problem.used = used(&standings);
    let first = solve(&mut problem, starts, given, cycle_s, options.weighing, &mut standings);
    let scatter = scatter(&problem, &first.values);
    if let (Comparison::Wrench { whitening, .. }, Some(turn)) = (&mut problem.comparison, scatter) {
        **whitening = turn * **whitening;
    }
    problem.members = members;
    problem.loss = Loss::Squares;
    let mut solution = solve(&mut problem, vec![first.values], given, cycle_s, options.weighing, &mut standings);
    solution.evaluation_count += first.evaluation_count;
    (problem, solution, standings)
}

/// Whether an offset is known to no better than the tension that it is added to.
fn offsets_ran_away((problem, solution, _): &Solved<'_>) -> bool {
    solution.unknowns.iter().enumerate().any(|(place, unknown)| {
        let rows = problem.members.get(unknown.member).map_or(&[][..], |member| member.record.rows);
        let mut sensor = Deviation::default();
        rows.iter().filter(|row| row.is_sound()).for_each(|row| sensor.add(row.signals.sensor_force_n));
        let standard_error_n = solution.covariance.get((place, place)).map_or(f64::NAN, |variance| variance.sqrt());
        unknown.parameter.place() == OFFSET
            && (standard_error_n.is_nan() || standard_error_n >= sensor.rms().unwrap_or(0.0))
    })
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

fn all_of<'a>(records: &[CableRecord<'a>], options: &FitOptions) -> Vec<Member<'a>> {
    records.iter().map(|record| Member { record: *record, free: options.free(record.params) }).collect()
}

/// The outside wrench of each sample; NaN where there is none.
fn outside_wrenches(measurements: &Measurements<'_>, measured: bool) -> Vec<Vector6<f64>> {
    let platform = measurements.platform();
    if measured {
        let vector =
            |wrench: &Option<Wrench>| wrench.as_ref().map_or_else(|| Vector6::repeat(f64::NAN), Wrench::to_vector);
        return platform.wrenches.iter().map(vector).collect();
    }
    let ends = measurements.starts().iter().skip(1).copied().chain([platform.poses.len()]);
    let logs = measurements.starts().iter().zip(ends).filter_map(|(start, end)| platform.poses.get(*start..end));
    logs.flat_map(|poses| weight::wrenches(measurements.robot(), poses)).collect()
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
