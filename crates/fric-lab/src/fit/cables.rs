//! Identification of each cable by itself, from the force measured at its platform end (\[P\] 18).

use fric_core::parameters::{MU, SIGMA, Values};
use rayon::prelude::*;

use super::problem::{Comparison, Loss, Member, Problem};
use super::record::{CableRecord, Measurements, Row};
use super::report::{CableFit, ForceErrors};
use super::selection::{self, Standing};
use super::solve::{Solution, solve};
use super::vector::Parameter;
use super::{FitOptions, Progress, pass, start};

/// A warm-up that is wrong by more than this share of the samples, in per cent, is worth another fit.
const MISJUDGED_PERCENT: usize = 1;

/// Fits every cable that has a reference.
#[must_use]
pub fn fit_cables(measurements: &Measurements<'_>, options: &FitOptions, progress: &Progress) -> Vec<CableFit> {
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    progress.begin(records.len());
    let fit = |record: &CableRecord<'_>| {
        let fit = fit_cable(record, options, progress);
        progress.finish_one();
        fit
    };
    records.par_iter().map(fit).collect()
}

fn fit_cable(record: &CableRecord<'_>, options: &FitOptions, progress: &Progress) -> CableFit {
    let given = record.params.values();
    let all = prepared(record);
    let problem = |standings: &[Standing]| Problem {
        members: vec![Member { record: *record, free: options.free(record.params) }],
        comparison: Comparison::Forces,
        loss: Loss::Squares,
        used: used(standings),
        stop: progress.stop_flag(),
    };
    let starts = start::starts(&problem(&all), &[given], record.cycle_s);
    let solve_without_warm_up = |starts: Vec<Vec<Values>>| {
        let mut standings = all.clone();
        leave_out_warm_up(&problem(&all), &starts, &mut standings);
        let solution =
            solve(&mut problem(&standings), starts, &[given], record.cycle_s, options.weighing, &mut standings);
        (solution, standings)
    };
    let (mut solution, mut standings) = solve_without_warm_up(starts);
    if warm_up_was_misjudged(record, &solution, &all, &standings) {
        let evaluation_count = solution.evaluation_count;
        (solution, standings) = solve_without_warm_up(vec![solution.values]);
        solution.evaluation_count += evaluation_count;
    }
    cable_fit(record, &given, &solution, 0, &standings)
}

/// Whether the fitted values, as far as they can be trusted, give another warm-up than the start did.
fn warm_up_was_misjudged(
    record: &CableRecord<'_>,
    solution: &Solution,
    all: &[Standing],
    standings: &[Standing],
) -> bool {
    let determines_memory = [MU, SIGMA]
        .into_iter()
        .all(|place| !solution.undetermined.iter().any(|unknown| unknown.parameter.place() == place));
    let Some(values) = solution.values.first().filter(|_| determines_memory && !solution.unknowns.is_empty()) else {
        return false;
    };
    let mut renewed = all.to_vec();
    selection::leave_out_warm_up(record, values, &mut renewed);
    let [before, after] = [standings, &renewed].map(|standings| selection::count(standings).warm_up);
    before.abs_diff(after) * 100 > MISJUDGED_PERCENT * all.len()
}

/// Standing of each sample before anything is known about the friction.
pub(super) fn prepared(record: &CableRecord<'_>) -> Vec<Standing> {
    let mut standings = selection::first_look(record, |_, row| row.reference_n.is_finite());
    selection::leave_out_still_references(record, &mut standings);
    standings
}

/// Which samples count.
pub(super) fn used(standings: &[Standing]) -> Vec<bool> {
    standings.iter().map(|standing| *standing == Standing::Used).collect()
}

/// Takes out what the cables still remember of the time before each log, by what they would at the best start. One cable
/// of several that never forgets it keeps it all along, and it adds up with its offset: the others can be told.
pub(super) fn leave_out_warm_up(problem: &Problem<'_>, starts: &[Vec<Values>], standings: &mut [Standing]) {
    let best = starts.first().into_iter().flatten();
    for (member, values) in problem.members.iter().zip(best) {
        let mut left = standings.to_vec();
        selection::leave_out_warm_up(&member.record, values, &mut left);
        if problem.members.len() == 1 || left.contains(&Standing::Used) {
            standings.copy_from_slice(&left);
        }
    }
}

/// The result of one cable of a solved problem.
pub(super) fn cable_fit(
    record: &CableRecord<'_>,
    given: &Values,
    solution: &Solution,
    member: usize,
    standings: &[Standing],
) -> CableFit {
    let values = solution.values.get(member).copied().unwrap_or(*given);
    let of_member = |unknown: &&super::solve::Unknown| unknown.member == member;
    let places: Vec<usize> = (0..solution.unknowns.len()).filter(|k| solution.unknowns[*k].member == member).collect();
    let fitted: Vec<Parameter> = places.iter().map(|place| solution.unknowns[*place].parameter).collect();
    let undetermined = solution.undetermined.iter().filter(of_member).map(|unknown| unknown.parameter).collect();
    let covariance = solution.covariance.select_rows(&places).select_columns(&places);
    CableFit {
        samples: selection::count(standings),
        values,
        fitted,
        undetermined,
        covariance,
        termination: solution.termination,
        evaluation_count: solution.evaluation_count,
        errors: force_errors(record, &values),
    }
}

/// Errors of the force at the platform without and with compensation, over every sample that has a reference, flagged ones
/// too: the figures of a replay.
fn force_errors(record: &CableRecord<'_>, values: &Values) -> ForceErrors {
    let mut errors = ForceErrors::default();
    pass::run_plain(record, values, |_, row: &Row, forces| {
        if row.reference_n.is_finite() {
            errors.reference_n.add(row.reference_n);
            errors.before_n.add(forces.frictionless_n - row.reference_n);
            errors.after_n.add(forces.platform_force_n - row.reference_n);
        }
    });
    errors
}
