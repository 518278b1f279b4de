//! The discovery on one cable, from its record to what was found.

use std::sync::atomic::AtomicBool;

use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS, Values};
use nalgebra::DMatrix;

use super::candidates::Scale;
use super::conditions::{Condition, conditions};
use super::foreign::{FaultyStretch, faulty_stretches, leave_out};
use super::lines::{Line, Times, lines};
use super::naming::{Named, Naming, STRONG_BIC, Search};
use super::noise::white_noise;
use super::places::{Excess, Place};
use super::profile::profile;
use super::readiness::{lack_of, lack_of_noise, lack_of_samples};
use super::report::{CableDiscovery, Finding, Model, RunnerUp, Tried, Unexplained, Verdict};
use super::rest::{WORTH, is_wander};
use super::split::{Block, split};
use super::stretch::{Stretch, stretch_of_cable};
use super::workbench::{self, Trial, Workbench};
use crate::fit::engine;
use crate::fit::{CableRecord, FitOptions, Parameter, Progress, Row, SampleCounts};
use crate::replay::Deviation;

/// What is left of a gap when its cause is known is not worth a further name below this share.
const REMAINDER: f64 = 0.02;

/// No model is believed to less than this share of the tension, however little noise there is.
const BELIEVED_RATIO: f64 = 1e-4;

/// Looks at one cable.
pub fn discover_cable(record: &CableRecord<'_>, progress: &Progress) -> CableDiscovery {
    let stop = progress.stop_flag();
    if let Some(lack) = lack_of(record) {
        return CableDiscovery::untold(record, engine::count(&engine::prepared(record)), lack);
    }
    let faults = faulty_stretches(record);
    let mut standings = engine::prepared(record);
    leave_out(&faults, record.cycle_s, &mut standings);
    let gang = engine::Gang::new(1, stop);
    let paper = engine::Search::run(record, &standings, &FitOptions::default(), stop, gang.seat(0));
    let samples = engine::count(&paper.standings);
    if let Some(lack) = lack_of_samples(&samples, record.cycle_s) {
        return CableDiscovery::untold(record, samples, lack);
    }
    let counts = engine::used(&paper.standings);
    let blocks = split(record);
    let conditions = conditions(record);
    let (mut start, held) = given_model(record, &paper.solution);

    // What hums is no matter of friction: it comes off the reference.
    let measured = engine::measured(record);
    let bench = Workbench { record: *record, blocks: &blocks, counts: &counts, measured: &measured, stop };
    let fitted = bench.try_one(&start);
    // Between two measurements too: it may be faster than they are.
    let throughout = with_interpolated(record, &counts, &measured);
    let times = Times::of(record);
    let hum = lines(&Workbench { counts: &throughout, ..bench }.residuals_n(&fitted.values), &times);
    let rows = without_lines(record, &hum, &times);
    let case = Case { record: record.with_signals(&rows), raw: *record, blocks: &blocks, measured: &measured, stop };
    let Some(mut outcome) = case.look(&counts, &start, &conditions) else {
        return CableDiscovery::untold(record, samples, lack_of_noise());
    };
    let told = case.told(&counts, &outcome.naming, &held);
    if !told.is_empty() {
        start.free.extend(told);
        if let Some(again) = case.look(&counts, &start, &conditions) {
            outcome = again;
        }
    }
    let mut stretch = None;
    // A narrow stretch with trouble of its own may hide what else there is, or be taken for it.
    if let Some(found) = outcome.stretch.take() {
        let outside: Vec<bool> = counts.iter().zip(&found.cycles).map(|(counts, inside)| *counts && !inside).collect();
        let again = case.look(&outside, &start, &conditions);
        let is_clearer = |again: &Outcome| again.rest_is_noise || again.naming.named.len() > outcome.naming.named.len();
        if let Some(again) = again.filter(is_clearer) {
            (outcome, stretch) = (again, Some(found.place));
        }
    }
    case.report(&outcome, &counts, samples, &conditions, Foreign { faults, hum, stretch })
}

/// The given model, with start values from the data for what it has of its own: of friction what acts, an offset if it has one (a
/// sensor that was not tared is to be found, not to be fitted away), and the parameters of its effects; without what the log does not determine, which comes beside it.
fn given_model(record: &CableRecord<'_>, paper: &engine::Solution) -> (workbench::Model, Vec<Parameter>) {
    let given = record.params.values();
    let undetermined = |parameter: &Parameter| paper.undetermined.iter().any(|unknown| unknown.parameter == *parameter);
    let acts = |parameter: &Parameter| match parameter.place() {
        MU | VISCOUS => given[parameter.place()] > 0.0,
        OFFSET => given[OFFSET].abs() > 0.0,
        SIGMA => given[MU] > 0.0 && given[SIGMA] < NO_PRESLIDING_N_PER_M,
        _ => true,
    };
    let all = FitOptions::default().free(record.params);
    let (held, free): (Vec<Parameter>, Vec<Parameter>) = all.into_iter().filter(acts).partition(undetermined);
    let mut values = given;
    if let Some(found) = paper.values.first() {
        for parameter in &free {
            values[parameter.place()] = found[parameter.place()];
        }
    }
    (workbench::Model { values, free }, held)
}

/// What counts, and what is between two neighbours of it, on the line from one measurement to the next.
fn with_interpolated(record: &CableRecord<'_>, counts: &[bool], measured: &[bool]) -> Vec<bool> {
    let mut all = counts.to_vec();
    let mut before = 0;
    for (place, counts_too) in counts.iter().enumerate().filter(|(place, _)| measured.get(*place) == Some(&true)) {
        let is_between = *counts_too && counts.get(before) == Some(&true);
        let between = before + 1..place;
        before = place;
        let (true, Some(all), Some(rows)) = (is_between, all.get_mut(between.clone()), record.rows.get(between)) else {
            continue;
        };
        for (counts, row) in all.iter_mut().zip(rows) {
            *counts = row.is_sound() && row.reference_n.is_finite();
        }
    }
    all
}

/// The rows with lines taken off the reference.
fn without_lines(record: &CableRecord<'_>, lines: &[Line], times: &Times) -> Vec<Row> {
    let mut rows = record.rows.to_vec();
    for line in lines {
        line.add_to(rows.iter_mut().map(|row| &mut row.reference_n), 1.0, times);
    }
    rows
}

/// What is wrong with the log itself.
struct Foreign {
    faults: Vec<FaultyStretch>,
    hum: Vec<Line>,
    stretch: Option<Place>,
}

/// A cable with its log.
struct Case<'a> {
    /// Without hum.
    record: CableRecord<'a>,
    /// As it is.
    raw: CableRecord<'a>,
    blocks: &'a [Block],
    measured: &'a [bool],
    stop: &'a AtomicBool,
}

/// One look at it.
struct Outcome {
    /// The samples that it was of.
    counts: Vec<bool>,
    base: Trial,
    naming: Naming,
    noise_n: f64,
    wander_n: f64,
    rest_n: Vec<f64>,
    rest_is_noise: bool,
    rest_places: Vec<Place>,
    stretch: Option<Stretch>,
}

impl<'a> Case<'a> {
    fn bench<'b>(&self, counts: &'b [bool]) -> Workbench<'b>
    where
        'a: 'b,
    {
        Workbench { record: self.record, blocks: self.blocks, counts, measured: self.measured, stop: self.stop }
    }

    fn excess<'b>(&'b self, residual_n: &'b [f64], noise_n: f64) -> Excess<'b> {
        Excess { record: &self.record, blocks: self.blocks, residual_n, noise_n }
    }

    /// Fits, names, and judges the rest; `None` where nothing tells the noise.
    fn look(&self, counts: &[bool], start: &workbench::Model, conditions: &[Condition]) -> Option<Outcome> {
        let bench = self.bench(counts);
        let base = bench.try_one(start);
        let residual_n = bench.residuals_n(&base.values);
        let least_n = BELIEVED_RATIO * self.scale(&base, 0.0).tension_n;
        let noise_n = white_noise(&bench.measured_of(&residual_n))?.max(least_n);
        let naming = Search::new(&bench, noise_n, self.scale(&base, noise_n), &base).run();
        let rest_n = bench.residuals_n(&naming.model.values);
        let noise_n = white_noise(&bench.measured_of(&rest_n))?.max(least_n);
        let excess = self.excess(&rest_n, noise_n);
        let before_n = bench.residuals_n(&naming.with_friction.values);
        let (share, before) = (excess.share(), self.excess(&before_n, noise_n).share());
        let is_small = share <= WORTH.max(REMAINDER * if naming.named.is_empty() { 0.0 } else { before });
        let rest_places = excess.places(conditions);
        let stretch = if is_small { None } else { stretch_of_cable(&excess, conditions) };
        let is_wander = !is_small && stretch.is_none() && is_wander(&excess, &rest_places);
        Some(Outcome {
            counts: counts.to_vec(),
            base,
            naming,
            noise_n,
            wander_n: if is_wander { noise_n * share.sqrt() } else { 0.0 },
            rest_is_noise: is_small || is_wander,
            rest_places,
            stretch,
            rest_n,
        })
    }

    /// Which of the held parameters the log determines when the model has what it lacked.
    fn told(&self, counts: &[bool], naming: &Naming, held: &[Parameter]) -> Vec<Parameter> {
        if held.is_empty() || naming.named.is_empty() {
            return Vec::new();
        }
        let bench = self.bench(counts);
        let mut with_all = naming.model.model();
        with_all.free.extend(held);
        let trial = bench.try_one(&with_all);
        let (_, all) = engine::vagueness(&bench.problem(&trial.free, None), &[trial.values]);
        let is_told = |(vagueness, of): &(f64, engine::Unknown)| *vagueness <= 1.0 && held.contains(&of.parameter);
        all.into_iter().filter(is_told).map(|(_, of)| of.parameter).collect()
    }

    fn scale(&self, base: &Trial, noise_n: f64) -> Scale {
        Scale::of(&self.record, base.values[MU], noise_n)
    }

    fn report(
        &self,
        outcome: &Outcome,
        counts: &[bool],
        samples: SampleCounts,
        conditions: &[Condition],
        foreign: Foreign,
    ) -> CableDiscovery {
        let Outcome { base, naming, noise_n, .. } = outcome;
        let raw = Workbench { record: self.raw, ..self.bench(counts) };
        let held_out = raw.used(true);
        let with_interpolated = with_interpolated(&self.raw, counts, self.measured);
        let throughout = Workbench { counts: &with_interpolated, ..raw.clone() };
        let held_out_of = |values: &Values| {
            let residual_n = raw.residuals_n(values);
            let judged = residual_n.iter().zip(&held_out).filter(|(_, held_out)| **held_out);
            judged.fold(Deviation::default(), |mut sum, (number, _)| {
                sum.add(*number);
                sum
            })
        };
        let model = |trial: &Trial| Model {
            values: trial.values,
            fitted: trial.free.clone(),
            covariance: self.covariance(&outcome.counts, trial),
            held_out_n: held_out_of(&trial.values),
        };
        let bench = self.bench(&outcome.counts);
        let search = Search::new(&bench, *noise_n, self.scale(base, *noise_n), base);
        let findings = naming.named.iter().zip(naming.ladder.iter().skip(1));
        let findings: Vec<Finding> =
            findings.map(|(named, step)| finding(&search, &naming.model, named, held_out_of(&step.values))).collect();
        let rms_n = |trial: &Trial| held_out_of(&trial.values).rms().unwrap_or(f64::NAN);
        let mut tried: Vec<Tried> = naming
            .first_round
            .iter()
            .map(|(row, trial)| Tried {
                row,
                delta_bic: search.delta_bic(base, trial, 1.0),
                held_out_rms_n: rms_n(trial),
            })
            .collect();
        tried.sort_by(|one, other| one.delta_bic.total_cmp(&other.delta_bic));
        let after = model(&naming.model);
        let clean_n = self.bench(counts).residuals_n(&base.values);
        let places = self.excess(&clean_n, *noise_n).concentrations(conditions);
        let places = if self.excess(&clean_n, *noise_n).share() > WORTH { places } else { Vec::new() };
        let is_foreign = !foreign.faults.is_empty() || !foreign.hum.is_empty() || foreign.stretch.is_some();
        let unexplained = (is_foreign || !outcome.rest_is_noise).then(|| {
            let rms_n = after.held_out_n.rms().unwrap_or(f64::NAN);
            self.unexplained(outcome, (rms_n * rms_n - noise_n * noise_n).max(0.0).sqrt(), foreign)
        });
        let verdict = match (&unexplained, findings.is_empty()) {
            (Some(_), _) => Verdict::Unexplained,
            (None, true) => Verdict::Complete,
            (None, false) => Verdict::Extended,
        };
        // What tells most of the given model, and of what is left.
        let told = [places.first(), unexplained.as_ref().and_then(|rest: &Unexplained| rest.places.first())];
        let mut signals: Vec<&str> = told.into_iter().flatten().map(|place| place.signal).collect();
        signals.dedup();
        let (residual_before_n, residual_after_n) =
            (raw.residuals_n(&base.values), raw.residuals_n(&naming.model.values));
        let profiles = signals.into_iter().filter_map(|signal| {
            let condition = conditions.iter().find(|condition| condition.signal == signal)?;
            profile(&self.record, condition, &residual_before_n, &residual_after_n)
        });
        CableDiscovery {
            samples,
            held_out: super::rest::ranges(throughout.used(true).into_iter())
                .into_iter()
                .map(|range| [range.start, range.end])
                .collect(),
            noise_floor_n: *noise_n,
            wander_n: outcome.wander_n,
            verdict,
            before: model(base),
            after,
            findings,
            tried,
            places,
            unexplained,
            lack: None,
            profiles: profiles.collect(),
            times_s: (0..self.record.rows.len()).map(|cycle| self.record.time_s(cycle)).collect(),
            residual_before_n,
            residual_after_n,
        }
    }

    fn covariance(&self, counts: &[bool], trial: &Trial) -> DMatrix<f64> {
        engine::covariance(&self.bench(counts).problem(&trial.free, None), &[trial.values]).0
    }

    fn unexplained(&self, outcome: &Outcome, rms_n: f64, foreign: Foreign) -> Unexplained {
        let Foreign { faults, hum, stretch } = foreign;
        let time_s = |cycle: usize| self.record.time_s(cycle);
        let faults = faults
            .into_iter()
            .map(|FaultyStretch { fault, cycles }| (fault, [time_s(cycles.start), time_s(cycles.end)]));
        let rest = if outcome.rest_is_noise { Vec::new() } else { outcome.rest_places.clone() };
        let excess = self.excess(&outcome.rest_n, outcome.noise_n);
        let loud = |cycle: usize| outcome.rest_n.get(cycle).is_some_and(|number| number.abs() > 4.0 * outcome.noise_n);
        Unexplained {
            rms_n,
            lines: hum,
            faults: faults.collect(),
            places: stretch.into_iter().chain(rest).collect(),
            intervals_s: if outcome.rest_is_noise { Vec::new() } else { excess.intervals_s(loud) },
            neighbours: Vec::new(),
        }
    }
}

fn finding(search: &Search<'_, '_>, model: &Trial, named: &Named, held_out_n: Deviation) -> Finding {
    let bic = |trial: &Trial| search.delta_bic(&named.without, trial, named.inflation);
    let delta_bic = bic(model);
    let runner_up = named.runner_up.as_ref().map(|(row, trial)| {
        let other_bic = bic(trial);
        RunnerUp {
            row,
            delta_bic: other_bic,
            held_out_squares: trial.held_out,
            is_as_good: other_bic - delta_bic < STRONG_BIC,
        }
    });
    Finding { row: named.row, held_out_n, delta_bic, runner_up }
}
