//! Identification of each cable separately, from the force measured at its platform end (\[P\] 18).

use fric_core::LANES;
use fric_core::parameters::{MU, OFFSET, SIGMA, VISCOUS, Values};
use std::panic::resume_unwind;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;

use super::report::{CableFit, ForceErrors, LogValue};
use super::{FitOptions, Progress, start};
use crate::candidates::newcomers::with_newcomers;
use crate::certainty::log_zeros::{LogZeroEstimate, log_zeros};
use crate::certainty::one_load::is_one_load;
use crate::certainty::undetermined::solve;
use crate::certainty::{one_load, one_way};
use crate::replay::Deviation;
use crate::samples::cable::{CableRecord, Zeroed};
use crate::samples::interpolated::measured;
use crate::samples::record::{LogZero, Measurements, PerLog};
use crate::samples::selection;
use crate::samples::selection::Standing;
use crate::search::gang::{Gang, Seat};
use crate::search::pass::Forces;
use crate::search::problem::{Comparison, Loss, Member, Problem};
use crate::search::solve::{NEAR_ERRORS, OpenCombination, Solution, Unknown};
use crate::search::vector::Parameter;
use crate::set_up::SetUp;

/// Another fit is run if the warm-up estimate was wrong by more than this percentage of the samples.
const MISJUDGED_PERCENT: usize = 1;
/// Maximum number of fits with the zeros of a sensor changed in the signals. What a fit leaves is of second order in its change of the zeros, so that the
/// second one is usually the last.
const MOST_TARES: usize = 4;

/// Fits every cable that is held and has a reference.
#[must_use]
pub fn fit_cables(measurements: &Measurements<'_>, options: &FitOptions, progress: &Progress) -> Vec<CableFit> {
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    progress.begin(records.len());
    let gangs: Vec<(&[CableRecord<'_>], Gang<'_>)> =
        records.chunks(LANES).map(|records| (records, Gang::new(records.len(), progress.stop_flag()))).collect();
    thread::scope(|scope| {
        let mut searches = Vec::with_capacity(records.len());
        for (records, gang) in &gangs {
            for (place, record) in records.iter().enumerate() {
                let seat = gang.seat(place);
                searches.push(scope.spawn(move || {
                    let fit = fit_cable(record, options, progress, seat);
                    progress.finish_one();
                    fit
                }));
            }
        }
        let fits = searches.into_iter().map(|search| search.join().unwrap_or_else(|panic| resume_unwind(panic)));
        let of_cables = measurements.held().zip(fits);
        of_cables.flat_map(|(cable, fits)| fits.into_iter().map(move |fit| of_cable(fit, cable))).collect()
    })
}

/// Converts the fit of a single cable into that of a cable of the robot.
fn of_cable(mut fit: CableFit, cable: usize) -> CableFit {
    fit.open.iter_mut().flat_map(|open| &mut open.parts).for_each(|part| part.cable = cable);
    fit
}

fn fit_cable<'a>(
    record: &CableRecord<'a>,
    options: &FitOptions,
    progress: &'a Progress,
    seat: Seat<'a>,
) -> Vec<CableFit> {
    if let Some(PerLog { zero: LogZero::Sensor, .. }) = record.per_log {
        drop(seat);
        return with_sensor_zeros(record, options, progress.stop_flag());
    }
    let search = Search::run(record, &prepared(record), options, progress.stop_flag(), seat);
    let zeros = search.log_zeros();
    // The errors must be those that a replay finds.
    search.problem.forget_step();
    let mut fits = cable_fits(&search.problem, &[record.params.values()], &search.solution, &search.standings);
    for fit in &mut fits {
        with_log_values(fit, record, &zeros, &[]);
    }
    fits
}

/// Fits a cable whose sensor has a zero of its own in each log. Friction in presliding is not quite linear in the zero, so what is found is changed in
/// the signals, until a fit finds nothing more.
fn with_sensor_zeros(record: &CableRecord<'_>, options: &FitOptions, stop: &AtomicBool) -> Vec<CableFit> {
    let mut changed_n = vec![0.0; record.logs().count()];
    let mut rounds = 0;
    loop {
        rounds += 1;
        let zeroed = record.with_zeros(&changed_n);
        let tared = record.zeroed(&zeroed);
        let gang = Gang::new(1, stop);
        let search = Search::run(&tared, &prepared(&tared), options, stop, gang.seat(0));
        let zeros = search.log_zeros();
        let is_near = |zero: &LogZeroEstimate| zero.change_n.abs() <= NEAR_ERRORS * zero.standard_error_n;
        if rounds == MOST_TARES || zeros.iter().flatten().all(is_near) {
            search.problem.forget_step();
            let mut fits = cable_fits(&search.problem, &[record.params.values()], &search.solution, &search.standings);
            for fit in &mut fits {
                fit.errors.before_n = frictionless_errors(record);
                with_log_values(fit, record, &zeros, &changed_n);
            }
            return fits;
        }
        for (changed_n, zero) in changed_n.iter_mut().zip(&zeros) {
            *changed_n += zero.map_or(0.0, |zero| zero.change_n);
        }
    }
}

/// Adds the values of each log to a fit, which gets that of the last log.
fn with_log_values(fit: &mut CableFit, record: &CableRecord<'_>, zeros: &[Option<LogZeroEstimate>], changed_n: &[f64]) {
    let Some(PerLog { zero, .. }) = record.per_log else { return };
    fit.per_log = LogValue::of_logs(zero, &fit.values, zeros, changed_n);
    if let Some(last) = LogValue::last(&fit.per_log) {
        fit.values[zero.place()] = last.value;
    }
}

/// The whole search for the parameters of a cable.
#[derive(Debug)]
pub struct Search<'a> {
    /// The problem with all samples that have something to compare with.
    problem: Problem<'a>,
    /// The start values.
    pub start: Values,
    /// The solution found.
    pub solution: Solution,
    /// The standing of each sample after the search.
    pub standings: Vec<Standing>,
}

impl<'a> Search<'a> {
    /// Runs the search. `all` are the standings before anything is known about the friction; see [`prepared`].
    pub fn run(
        record: &CableRecord<'a>,
        all: &[Standing],
        options: &FitOptions,
        stop: &'a AtomicBool,
        seat: Seat<'a>,
    ) -> Self {
        let given = record.params.values();
        let mut problem = Problem {
            members: vec![Member { record: *record, free: options.shared(record) }],
            comparison: Comparison::Forces,
            loss: Loss::Squares,
            used: used(all),
            stop,
            seat: Some(Rc::new(seat)),
        };
        let (mut start, mut solution, mut standings) = solved(&problem, record, all, options);
        if let Some(parameter) = options.zero_beside_gain(record).filter(|_| !solution.unknowns.is_empty()) {
            let judged = Problem { used: used(&standings), ..problem.clone() };
            if solution.values.first().is_some_and(|values| is_one_load(&judged, values)) {
                (start, solution, standings) =
                    solved_beside_gain(&mut problem, parameter, solution, (record, all, options));
            }
        }
        if let Some(parameter) = options.open_zero(record).filter(|_| !solution.unknowns.is_empty()) {
            solution.undetermined.push(Unknown { member: 0, parameter });
            let has_friction = solution.unknowns.iter().any(|unknown| unknown.parameter.place() == MU);
            let found = solution.values.first().filter(|_| has_friction);
            solution.open.extend(found.and_then(|values| one_way::combination(&problem, parameter, values, &given)));
        }
        Self { problem, start, solution, standings }
    }
}

impl Search<'_> {
    /// Returns what the solution leaves, N: the compensated force minus the reference, NaN for samples that do not count.
    pub fn residuals_n(&self) -> Vec<f64> {
        let mut left_n = vec![f64::NAN; self.standings.len()];
        let problem = Problem { used: used(&self.standings), ..self.problem.clone() };
        problem.residuals(&self.solution.values, |sample, residuals| {
            if let (Some(left_n), [residual_n]) = (left_n.get_mut(sample), residuals) {
                *left_n = *residual_n;
            }
        });
        left_n
    }

    /// Returns the zero of each log; nothing if all logs have the same.
    fn log_zeros(&self) -> Vec<Option<LogZeroEstimate>> {
        self.solution.values.first().map_or_else(Vec::new, |values| log_zeros(&self.problem, values))
    }
}

/// Solves the problem of one cable. Returns the start values, the solution, and the standing of each sample after the search.
fn solved(
    problem: &Problem<'_>,
    record: &CableRecord<'_>,
    all: &[Standing],
    options: &FitOptions,
) -> (Values, Solution, Vec<Standing>) {
    let given = record.params.values();
    let starts = start::starts(problem, &[given], record.cycle_s);
    let starts = with_newcomers(problem, starts, &[given], record.cycle_s);
    let start = starts.first().and_then(|start| start.first()).copied().unwrap_or(given);
    let solve_without_warm_up = |starts: Vec<Vec<Values>>| {
        let mut standings = all.to_vec();
        leave_out_warm_up(problem, &starts, &mut standings);
        let mut problem = Problem { used: used(&standings), ..problem.clone() };
        let solution = solve(&mut problem, starts, &[given], record.cycle_s, options.weighing, &mut standings);
        (solution, standings)
    };
    let (mut solution, mut standings) = solve_without_warm_up(starts);
    if warm_up_was_misjudged(record, &solution, all, &standings) {
        let evaluation_count = solution.evaluation_count;
        (solution, standings) = solve_without_warm_up(vec![solution.values]);
        solution.evaluation_count += evaluation_count;
    }
    (start, solution, standings)
}

/// Solves the problem of one cable again with a zero as given that one load does not tell from the gain beside it. Viscous friction that was left open beside
/// the zero stays so: what tells it now is the noise, which the gain makes less of.
fn solved_beside_gain(
    problem: &mut Problem<'_>,
    zero: Parameter,
    before: Solution,
    (record, all, options): (&CableRecord<'_>, &[Standing], &FitOptions),
) -> (Values, Solution, Vec<Standing>) {
    let held = before.undetermined.into_iter().zip(before.open);
    let viscous = held.filter(|(held, _)| held.parameter.place() == VISCOUS);
    let (undetermined, open): (Vec<Unknown>, Vec<OpenCombination>) = viscous.unzip();
    let is_held = |free: &Parameter| *free == zero || undetermined.iter().any(|held| held.parameter == *free);
    problem.members.iter_mut().for_each(|member| member.free.retain(|free| !is_held(free)));
    let (start, mut solution, standings) = solved(problem, record, all, options);
    solution.undetermined.extend(undetermined);
    solution.open.extend(open);
    solution.undetermined.push(Unknown { member: 0, parameter: zero });
    solution.open.extend(one_load::combination(problem, zero, &solution));
    (start, solution, standings)
}

/// Whether the fitted values, as far as they can be trusted, imply another warm-up than the start values did. A memory that no log is long enough to
/// forget cannot be trusted.
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
    if !renewed.contains(&Standing::Used) {
        return false;
    }
    let [before, after] = [standings, &renewed].map(|standings| selection::count(standings).warm_up);
    before.abs_diff(after) * 100 > MISJUDGED_PERCENT * all.len()
}

/// Returns the standing of each sample before anything is known about the friction.
pub fn prepared(record: &CableRecord<'_>) -> Vec<Standing> {
    let mut standings = selection::first_look(record, |cycle| record.reference_n(cycle).is_finite());
    selection::leave_out_still_forces(record, &mut standings);
    if record.reference_is_known {
        selection::leave_out_jumps(record, &mut standings);
    } else {
        selection::leave_out_still_references(record, &mut standings);
    }
    selection::leave_out_interpolated(&measured(record), &mut standings);
    standings
}

/// Which samples count.
pub fn used(standings: &[Standing]) -> Vec<bool> {
    standings.iter().map(|standing| *standing == Standing::Used).collect()
}

/// Leaves out the start of each log, where the presliding still depends on the time before, estimated from the best start values. If one cable of
/// several never settles, its stored force stays constant and adds to its offset; the other cables can still be identified. Where no sample would be left, as
/// of a motion one way that says nothing about the presliding, the robot file's values decide.
pub(crate) fn leave_out_warm_up(problem: &Problem<'_>, starts: &[Vec<Values>], standings: &mut [Standing]) {
    let best = starts.first().into_iter().flatten();
    for (member, values) in problem.members.iter().zip(best) {
        let given = member.record.params.values();
        let left = [values, &given].map(|values| {
            let mut left = standings.to_vec();
            selection::leave_out_warm_up(&member.record, values, &mut left);
            left
        });
        let settled = left.iter().find(|left| left.contains(&Standing::Used));
        if let Some(left) = settled.or(left.first().filter(|_| problem.members.len() == 1)) {
            standings.copy_from_slice(left);
        }
    }
}

/// Returns the results of the cables of a solved problem.
pub(crate) fn cable_fits(
    problem: &Problem<'_>,
    given: &[Values],
    solution: &Solution,
    standings: &[Standing],
) -> Vec<CableFit> {
    let forces = problem.forces(&solution.values).unwrap_or_default();
    let shifts_n = solution.values.first().and_then(|values| problem.zero_shifts_n(values));
    let is_of = |member: usize, open: &OpenCombination| open.parts.first().is_some_and(|held| held.cable == member);
    let members = problem.members.iter().zip(given).enumerate();
    members
        .map(|(member, (of, given))| {
            let values = solution.values.get(member).copied().unwrap_or(*given);
            let (places, fitted): (Vec<usize>, Vec<Parameter>) = solution
                .unknowns
                .iter()
                .enumerate()
                .filter(|(_, unknown)| unknown.member == member)
                .map(|(place, unknown)| (place, unknown.parameter))
                .unzip();
            let undetermined = solution.undetermined.iter().filter(|unknown| unknown.member == member);
            CableFit {
                samples: selection::count(standings),
                values,
                per_log: Vec::new(),
                fitted,
                undetermined: undetermined.map(|unknown| unknown.parameter).collect(),
                open: solution.open.iter().filter(|open| is_of(member, open)).cloned().collect(),
                at_bound: solution
                    .at_bound
                    .iter()
                    .filter(|unknown| unknown.member == member)
                    .map(|of| of.parameter)
                    .collect(),
                covariance: solution.covariance.select_rows(&places).select_columns(&places),
                termination: solution.termination,
                evaluation_count: solution.evaluation_count,
                errors: forces.get(member).map_or_else(ForceErrors::default, |forces| {
                    force_errors(&of.record, forces, values[OFFSET], shifts_n.as_deref())
                }),
            }
        })
        .collect()
}

/// Returns the compensated force minus the reference with the fitted values, N, for every sample of the cables that are held; NaN without a reference.
#[must_use]
pub fn residuals_n(measurements: &Measurements<'_>, fits: &[CableFit]) -> Vec<Vec<f64>> {
    let stop = AtomicBool::new(false);
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    let tared: Vec<Option<Zeroed<'_>>> = records.iter().zip(fits).map(|(record, fit)| fit.tared(record)).collect();
    let tared = records.iter().zip(&tared).map(|(record, tared)| match tared {
        Some(tared) => record.zeroed(tared),
        None => *record,
    });
    let problem = Problem {
        members: tared.map(|record| Member { record, free: Vec::new() }).collect(),
        comparison: Comparison::Forces,
        loss: Loss::Squares,
        used: Vec::new(),
        stop: &stop,
        seat: None,
    };
    let values: Vec<Values> = fits.iter().map(|fit| fit.values).collect();
    let of_cable = |(member, forces): (&Member<'_>, &Arc<Forces>)| {
        let references_n = member.record.references_n.iter().enumerate();
        references_n.map(|(cycle, reference_n)| forces.at(cycle).0 - reference_n).collect()
    };
    problem.members.iter().zip(&problem.forces(&values).unwrap_or_default()).map(of_cable).collect()
}

/// Returns the errors of the force at the platform without and with compensation, over every sample that has a reference, including flagged ones, as
/// in a replay.
fn force_errors(
    record: &CableRecord<'_>,
    forces: &Forces,
    offset_n: f64,
    zero_shifts_n: Option<&[f64]>,
) -> ForceErrors {
    let gain = record.params.frictionless_gain();
    let before_n = frictionless_errors(record);
    let mut errors =
        ForceErrors { before_n, set_up: SetUp::new(gain, record.reference_is_known), ..ForceErrors::default() };
    for (cycle, reference_n) in record.references_n.iter().enumerate().filter(|(_, known)| known.is_finite()) {
        errors.reference_n.add(*reference_n);
        let shift_n = zero_shifts_n.and_then(|shifts_n| shifts_n.get(cycle)).copied();
        let force_n = forces.at(cycle).0 + shift_n.unwrap_or(0.0);
        errors.after_n.add(force_n - reference_n);
        let Some(signals) = record.rows.get(cycle).map(|row| row.signals) else { continue };
        // A fitted zero at the platform would hide the scale of a load that does not vary.
        if signals.jump || record.starts.contains(&cycle) {
            errors.set_up.start();
        }
        let shown_n = signals.sensor_force_n * gain;
        errors.set_up.add(signals.length_m, *reference_n, [shown_n, force_n - offset_n]);
    }
    errors
}

/// Returns the error of the force at the platform without compensation, over every sample that has a reference.
fn frictionless_errors(record: &CableRecord<'_>) -> Deviation {
    let gain = record.params.frictionless_gain();
    let known = record.rows.iter().zip(record.references_n).filter(|(_, reference_n)| reference_n.is_finite());
    known.fold(Deviation::default(), |mut sum, (row, reference_n)| {
        sum.add(row.signals.sensor_force_n * gain - reference_n);
        sum
    })
}
