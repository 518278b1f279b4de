//! Discovery on one cable: takes its record and returns everything that was found.

use std::sync::atomic::AtomicBool;

use fric_core::effects::Effect;
use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS, Values};
use nalgebra::DMatrix;

use super::Task;
use super::faults::oscillations::Oscillations;
use super::faults::spectrum::{Times, motion_and_load};
use super::faults::{Fault, RecordingFault, coarse_step_n, faulty_stretches, leave_out, of_stretches};
use super::figures::curve::curves;
use super::figures::profile::profile;
use super::naming::{self, Named, Naming, STRONG_BIC, Search};
use super::readiness::{lack_of, lack_of_noise, lack_of_samples};
use super::report::{CableDiscovery, Candidate, Finding, Model, RunnerUp, Tried, Unexplained, Verdict};
use super::rest::empirical::{Table, has_table, table, without_table};
use super::rest::neighbours::neighbours_of;
use super::rest::places::{Excess, Place};
use super::rest::stretch::{Stretch, stretch_of_cable};
use super::rest::{self, WORTH, wander};
use super::workbench::{self, Trial, Workbench};
use crate::candidates::catalogue::around;
use crate::effects::Around;
use crate::fit::{CableRecord, FitOptions, HALF_INTERVAL, Parameter, Row, SampleCounts};
use crate::replay::Deviation;
use crate::samples::conditions::{Condition, conditions, time};
use crate::samples::noise::white_noise;
use crate::samples::selection::Standing;
use crate::samples::split::{Block, split};

/// The steps of a converter are told of where they make this part of the noise, as squares: a twentieth of its size.
const LEAST_ROUNDING: f64 = 0.1;
/// Maximum number of passes over a cable. Each pass starts from what the previous one found.
const LOOKS: usize = 3;

/// No model is trusted to better than this fraction of the tension, however low the noise is.
pub const BELIEVED_RATIO: f64 = 1e-4;

/// Number of progress steps per cable: fit of the given model, first search, second search, table for the rest.
pub const STAGES: usize = 4;

/// Runs the discovery on one cable.
pub fn discover_cable(record: &CableRecord<'_>, task: &Task<'_>) -> CableDiscovery {
    let stop = task.progress.stop_flag();
    if let Some(lack) = lack_of(record) {
        return CableDiscovery::untold(
            record,
            crate::samples::selection::count(&crate::fit::cables::prepared(record)),
            lack,
        );
    }
    let stretches = faulty_stretches(record);
    let mut standings = crate::fit::cables::prepared(record);
    leave_out(&stretches, record.interval_s, &mut standings);
    let gang = crate::search::gang::Gang::new(1, stop);
    let paper = crate::fit::cables::Search::run(record, &standings, &FitOptions::default(), stop, gang.seat(0));
    task.stages.finish_one();
    let samples = crate::samples::selection::count(&paper.standings);
    if let Some(lack) = lack_of_samples(&samples, record.interval_s) {
        return CableDiscovery::untold(record, samples, lack);
    }
    let counts = crate::fit::cables::used(&paper.standings);
    let blocks = split(record);
    let conditions = conditions(record);
    // The force rate contains the sensor's noise, and so does the residual. No effect would appear steady over it.
    let steady = conditions.iter().filter(|condition| condition.signal != "force_rate");
    let with_time: Vec<Condition> = steady.cloned().chain([time(record)]).collect();
    let (mut start, held) = given_model(record, &paper.solution);

    let measured = crate::samples::interpolated::measured(record);
    let times = Times::of(record);
    let bench = Workbench { record: *record, blocks: &blocks, counts: &counts, measured: &measured, stop };
    // Samples between two measurements count too, because a line may be faster than the measurements.
    let throughout = rest::with_interpolated(&counts, &measured, |place| has_reference(record, place));
    let left_by = |values: &Values| Workbench { counts: &throughout, ..bench.clone() }.residuals_n(values);
    let raw = Case {
        record: *record,
        raw: *record,
        blocks: &blocks,
        counts: &counts,
        standings: &standings,
        measured: &measured,
        conditions: &conditions,
        with_time: &with_time,
        stop,
    };
    let look = |heard: &Oscillations, start: &mut workbench::Model| {
        // What oscillates by itself is no matter of friction: it comes off the reference.
        let rows = heard.taken_off(record, &times);
        raw.with_rows(&rows).look_closely(start, &held)
    };
    let signals = motion_and_load(record);
    let mut heard = Oscillations::lines_of(&left_by(&bench.try_one(&start).values), &times, &signals);
    let Some(mut outcome) = look(&heard, &mut start) else {
        return CableDiscovery::untold(record, samples, lack_of_noise());
    };
    task.stages.finish_one();
    // A wrong model may hide an oscillation, or leave what only looks like one.
    let after = Oscillations::of(&left_by(&outcome.fitted.values), &times, record, &signals);
    let mut faults = after.faults();
    if !heard.are_like(&after)
        && let Some(again) = look(&after, &mut start)
    {
        // No filter takes off the onset of a vibration: a name that comes with its removal stands for what is left of it.
        let was_named = |named: &Named| outcome.naming.named.iter().any(|before| before.effect == named.effect);
        if !after.vibrate() || again.naming.named.iter().all(was_named) {
            (outcome, heard) = (again, after);
        }
    } else {
        faults = heard.faults();
    }
    task.stages.finish_one();
    let rows = heard.taken_off(record, &times);
    faults.extend(of_stretches(&stretches, |cycle| record.time_s(cycle)));
    let step_n = coarse_step_n(record).filter(|step_n| {
        // Rounding noise is uniform within ± half a step.
        let rounding_n = record.params.frictionless_gain() * step_n / 12.0_f64.sqrt();
        rounding_n * rounding_n > LEAST_ROUNDING * outcome.rest.noise_n * outcome.rest.noise_n
    });
    let coarse = |step_n| RecordingFault {
        fault: Fault::CoarseConverter,
        parameters: vec![("step_n", step_n)],
        intervals_s: Vec::new(),
    };
    faults.extend(step_n.map(coarse));
    let case = raw.with_rows(&rows);
    let table = if task.options.empirical { case.table(&outcome, task) } else { None };
    case.report(&outcome, table.as_ref(), samples, faults)
}

/// Returns the sum of squares, N², of the given model over the held-out samples after fitting it to the training samples. Returns `None` where the
/// log cannot tell.
pub fn held_out_squares(record: &CableRecord<'_>, stop: &AtomicBool) -> Option<f64> {
    let (counts, start) = given_to(record, stop)?;
    let (blocks, measured) = (split(record), crate::samples::interpolated::measured(record));
    let bench = Workbench { record: *record, blocks: &blocks, counts: &counts, measured: &measured, stop };
    Some(bench.try_one(&start).held_out)
}

/// Returns which samples count, and the given model with start values from the data.
pub fn given_to(record: &CableRecord<'_>, stop: &AtomicBool) -> Option<(Vec<bool>, workbench::Model)> {
    if lack_of(record).is_some() {
        return None;
    }
    let mut standings = crate::fit::cables::prepared(record);
    leave_out(&faulty_stretches(record), record.interval_s, &mut standings);
    let gang = crate::search::gang::Gang::new(1, stop);
    let paper = crate::fit::cables::Search::run(record, &standings, &FitOptions::default(), stop, gang.seat(0));
    let (start, _) = given_model(record, &paper.solution);
    Some((crate::fit::cables::used(&paper.standings), start))
}

/// Adds a fault that was corrected for the whole log. The given model is the one without the correction.
pub fn tell_of(found: &mut CableDiscovery, given: &CableRecord<'_>, fault: RecordingFault, stop: &AtomicBool) {
    found.faults.insert(0, fault);
    let Some((counts, start)) = given_to(given, stop) else { return };
    let (blocks, measured) = (split(given), crate::samples::interpolated::measured(given));
    let bench = Workbench { record: *given, blocks: &blocks, counts: &counts, measured: &measured, stop };
    let base = bench.try_one(&start);
    found.residual_before_n = bench.residuals_n(&base.values);
    found.before = Model {
        held_out_n: judged(&found.residual_before_n, &bench.used(true)),
        covariance: crate::certainty::undetermined::covariance(&bench.problem(&base.free, None), &[base.values]),
        fitted: base.free,
        values: base.values,
    };
}

/// Returns the error over the held-out samples.
fn judged(residual_n: &[f64], held_out: &[bool]) -> Deviation {
    let judged = residual_n.iter().zip(held_out).filter(|(_, held_out)| **held_out);
    judged.fold(Deviation::default(), |mut sum, (number, _)| {
        sum.add(*number);
        sum
    })
}

/// The given model, with start values from the data for what it has of its own: of friction what acts, an offset if it has one (a
/// sensor that was not tared is to be found, not to be fitted away), and the parameters of its effects; without what the log does not determine, which comes beside it.
fn given_model(record: &CableRecord<'_>, paper: &crate::search::solve::Solution) -> (workbench::Model, Vec<Parameter>) {
    let given = record.params.values();
    let undetermined = |parameter: &Parameter| paper.undetermined.iter().any(|unknown| unknown.parameter == *parameter);
    let all = FitOptions::default().free(record.params);
    let acting = all.into_iter().filter(|parameter| acts(parameter, &given));
    let (held, free): (Vec<Parameter>, Vec<Parameter>) = acting.partition(undetermined);
    let mut values = given;
    if let Some(found) = paper.values.first() {
        for parameter in &free {
            values[parameter.place()] = found[parameter.place()];
        }
    }
    (workbench::Model { values, free }, held)
}

/// Whether a friction parameter acts in a model.
pub fn acts(parameter: &Parameter, values: &Values) -> bool {
    match parameter.place() {
        MU | VISCOUS => values[parameter.place()] > 0.0,
        OFFSET => values[OFFSET].abs() > 0.0,
        SIGMA => values[MU] > 0.0 && values[SIGMA] < NO_PRESLIDING_N_PER_M,
        _ => true,
    }
}

fn has_reference(record: &CableRecord<'_>, place: usize) -> bool {
    record.rows.get(place).is_some_and(|row| row.is_sound() && row.reference_n.is_finite())
}

/// A cable with its log.
#[derive(Clone, Copy)]
struct Case<'a> {
    /// The record without hum.
    record: CableRecord<'a>,
    /// The record as given.
    raw: CableRecord<'a>,
    blocks: &'a [Block],
    /// Which samples count.
    counts: &'a [bool],
    /// The status of each sample before anything was known about the friction.
    standings: &'a [Standing],
    measured: &'a [bool],
    conditions: &'a [Condition],
    /// The conditions and the time.
    with_time: &'a [Condition],
    stop: &'a AtomicBool,
}

/// The outcome of one pass.
struct Outcome {
    /// The samples that the pass used.
    counts: Vec<bool>,
    base: Trial,
    naming: Naming,
    /// The model with everything that was found, fitted to all samples as an identification does.
    fitted: Fitted,
    rest: Rest,
    /// A stretch of cable with a local defect, left out of the assessment of the rest.
    stretch: Option<Place>,
}

/// A model fitted to all samples.
#[derive(Clone)]
struct Fitted {
    values: Values,
    parameters: Vec<Parameter>,
    covariance: DMatrix<f64>,
}

/// What a model leaves unexplained.
struct Rest {
    noise_n: f64,
    wander_n: f64,
    residual_n: Vec<f64>,
    is_noise: bool,
    places: Vec<Place>,
    stretch: Option<Stretch>,
}

impl<'a> Case<'a> {
    /// Returns the same case with other signals.
    fn with_rows<'b>(&self, rows: &'b [Row]) -> Case<'b>
    where
        'a: 'b,
    {
        Case { record: self.raw.with_signals(rows), ..*self }
    }

    fn bench<'b>(&self, counts: &'b [bool]) -> Workbench<'b>
    where
        'a: 'b,
    {
        Workbench { record: self.record, blocks: self.blocks, counts, measured: self.measured, stop: self.stop }
    }

    fn excess<'b>(&'b self, residual_n: &'b [f64], noise_n: f64) -> Excess<'b> {
        Excess { record: &self.record, blocks: self.blocks, residual_n, noise_n }
    }

    /// Runs a pass, then runs further passes if the findings make more parameters observable or show a narrow stretch of cable with a local defect.
    /// Such a stretch may hide other effects or be mistaken for them, so it is left out. Returns `None` where the noise cannot be estimated.
    fn look_closely(&self, start: &mut workbench::Model, held: &[Parameter]) -> Option<Outcome> {
        let mut outcome = self.look(self.counts, start)?;
        let told = self.told(self.counts, &outcome.naming, held);
        if told.iter().any(|parameter| !start.free.contains(parameter)) {
            start.free.extend(told);
            outcome = self.look(self.counts, start).unwrap_or(outcome);
        }
        if let Some(found) = outcome.rest.stretch.take() {
            let outside: Vec<bool> =
                self.counts.iter().zip(&found.cycles).map(|(counts, inside)| *counts && !inside).collect();
            let again = self.look(&outside, start);
            let is_clearer =
                |again: &Outcome| again.rest.is_noise || again.naming.named.len() > outcome.naming.named.len();
            if let Some(again) = again.filter(is_clearer) {
                outcome = Outcome { stretch: Some(found.place), ..again };
            }
        }
        Some(outcome)
    }

    /// Fits, names effects and assesses the rest, until no further effect can be named.
    fn look(&self, counts: &[bool], start: &workbench::Model) -> Option<Outcome> {
        let bench = self.bench(counts);
        let base = bench.try_one(start);
        let noise_n = self.noise_n(&bench, &base)?;
        let mut search = Search::new(&bench, noise_n, self.around(&base, noise_n), &base, self.with_time);
        let (mut before, mut rows): (Vec<Effect>, Vec<Effect>) = (Vec::new(), Vec::new());
        let mut looks = 0;
        loop {
            looks += 1;
            let naming = search.run(&before);
            let fitted = self.fitted(counts, &naming.model, noise_n);
            let found: Vec<Effect> = naming.named.iter().map(|named| named.effect).collect();
            // Effects that were offered and did not stay would be offered again.
            let more = if found == rows || looks == LOOKS {
                Vec::new()
            } else {
                self.missing(&bench, &workbench::Model { values: fitted.values, free: fitted.parameters.clone() })?
            };
            if more.is_empty() {
                let residual_n = bench.residuals_n(&fitted.values);
                let rest = self.rest(&bench, residual_n, self.least_n(&base))?;
                return Some(Outcome { counts: counts.to_vec(), base, naming, fitted, rest, stretch: None });
            }
            before = found.iter().copied().chain(more).collect();
            rows = found;
        }
    }

    /// Returns the effects that would be missing if `model` were the given model.
    fn missing(&self, bench: &Workbench<'_>, model: &workbench::Model) -> Option<Vec<Effect>> {
        let base = bench.try_one(model);
        let noise_n = self.noise_n(bench, &base)?;
        let naming = Search::new(bench, noise_n, self.around(&base, noise_n), &base, self.with_time).run(&[]);
        Some(naming.named.iter().map(|named| named.effect).collect())
    }

    /// Returns the standard deviation of the white noise in the model's residual, N.
    fn noise_n(&self, bench: &Workbench<'_>, model: &Trial) -> Option<f64> {
        let residual_n = bench.residuals_n(&model.values);
        Some(white_noise(&bench.measured_of(&residual_n))?.max(self.least_n(model)))
    }

    /// Returns the force below which the model is not trusted, N.
    fn least_n(&self, model: &Trial) -> f64 {
        BELIEVED_RATIO * self.around(model, 0.0).tension_n
    }

    /// Assesses the residual of a model, N.
    fn rest(&self, bench: &Workbench<'_>, residual_n: Vec<f64>, least_n: f64) -> Option<Rest> {
        let noise_n = white_noise(&bench.measured_of(&residual_n))?.max(least_n);
        let excess = self.excess(&residual_n, noise_n);
        let places = excess.places(self.conditions);
        let share = excess.share();
        let is_small = share <= WORTH;
        let stretch = if is_small { None } else { stretch_of_cable(&excess, self.conditions) };
        let wander = if is_small || stretch.is_some() { 0.0 } else { wander(&excess, &places) };
        let is_noise = share - wander <= WORTH * (1.0 + wander);
        Some(Rest { noise_n, wander_n: noise_n * wander.sqrt(), is_noise, places, stretch, residual_n })
    }

    /// Fits the model with everything found to all samples that count, as an identification of the extended robot file does. Friction that is neither
    /// in the file nor found stays out. An offset that is larger than chance stays out too, because naming has refused it.
    fn fitted(&self, counts: &[bool], model: &Trial, noise_n: f64) -> Fitted {
        let given = self.record.params.values();
        let is_known = |parameter: &Parameter| {
            !parameter.is_friction() || acts(parameter, &model.values) || acts(parameter, &given)
        };
        let of = |also: fn(&Parameter) -> bool| {
            let params = self.record.params.with_values(&model.values).ok()?;
            let mut parameters = FitOptions::default().free(&params);
            parameters.retain(|parameter| is_known(parameter) || also(parameter));
            let options = FitOptions { parameters: Some(parameters), ..FitOptions::default() };
            let left_out = self.counts.iter().zip(counts).map(|(all, counts)| *all && !counts);
            let standing = |(standing, left_out)| if left_out { Standing::Flagged } else { standing };
            let standings: Vec<Standing> = self.standings.iter().copied().zip(left_out).map(standing).collect();
            let gang = crate::search::gang::Gang::new(1, self.stop);
            let record = self.record.with_params(&params);
            let solution =
                crate::fit::cables::Search::run(&record, &standings, &options, self.stop, gang.seat(0)).solution;
            let parameters = solution.unknowns.iter().map(|unknown| unknown.parameter).collect();
            Some(Fitted { values: *solution.values.first()?, parameters, covariance: solution.covariance })
        };
        let has_chance_offset = |fitted: &Fitted| {
            let place = fitted.parameters.iter().position(|parameter| parameter.place() == OFFSET);
            let error_n = place.map_or(0.0, |place| fitted.covariance[(place, place)].sqrt());
            // An offset that is known less well than a single sample stands in for something else.
            let is_chance =
                fitted.values[OFFSET].abs() <= HALF_INTERVAL * error_n && HALF_INTERVAL * error_n <= noise_n;
            model.values[OFFSET].abs() > 0.0 || is_chance
        };
        of(|parameter| parameter.place() == OFFSET).filter(has_chance_offset).or_else(|| of(|_| false)).unwrap_or_else(
            || {
                let problem = self.bench(counts).problem(&model.free, None);
                let covariance = crate::certainty::undetermined::covariance(&problem, &[model.values]);
                Fitted { values: model.values, parameters: model.free.clone(), covariance }
            },
        )
    }

    /// Returns which of the held parameters the log determines once the model has the effects that were missing.
    fn told(&self, counts: &[bool], naming: &Naming, held: &[Parameter]) -> Vec<Parameter> {
        if held.is_empty() || naming.named.is_empty() {
            return Vec::new();
        }
        let bench = self.bench(counts);
        let mut with_all = naming.model.model();
        with_all.free.extend(held);
        let trial = bench.try_one(&with_all);
        let (_, all) = crate::certainty::undetermined::vagueness(&bench.problem(&trial.free, None), &[trial.values]);
        let is_told =
            |(vagueness, of): &(f64, crate::search::solve::Unknown)| *vagueness <= 1.0 && held.contains(&of.parameter);
        all.into_iter().filter(is_told).map(|(_, of)| of.parameter).collect()
    }

    fn around(&self, base: &Trial, noise_n: f64) -> Around {
        around(&self.record, base.values[MU], noise_n)
    }

    /// Returns a table for a rest that has no name.
    fn table(&self, outcome: &Outcome, task: &Task<'_>) -> Option<Table> {
        let Outcome { fitted, rest, stretch, .. } = outcome;
        if rest.is_noise && stretch.is_none() || has_table(&fitted.values) {
            return None;
        }
        let bench = self.bench(self.counts);
        let places: Vec<Place> = stretch.iter().chain(&rest.places).cloned().collect();
        let model = workbench::Model { values: fitted.values, free: fitted.parameters.clone() };
        let table = table(&bench, &model, rest.noise_n, &places)?;
        // Coupling from a neighbouring cable is not this cable's effect, however well a table over this cable's conditions fits it.
        let neighbours = neighbours_of(&bench.residuals_n(&fitted.values), task.own, task.records);
        let of_neighbour = neighbours.first().map_or(0.0, |neighbour| neighbour.correlation * neighbour.correlation);
        (table.gain_ratio > of_neighbour).then_some(table)
    }

    fn report(
        &self,
        outcome: &Outcome,
        table: Option<&Table>,
        samples: SampleCounts,
        faults: Vec<RecordingFault>,
    ) -> CableDiscovery {
        let Outcome { base, naming, fitted, rest, .. } = outcome;
        let noise_n = rest.noise_n;
        let raw = Workbench { record: self.raw, ..self.bench(self.counts) };
        let held_out = raw.used(true);
        let with_interpolated =
            rest::with_interpolated(self.counts, self.measured, |place| has_reference(&self.raw, place));
        let throughout = Workbench { counts: &with_interpolated, ..raw.clone() };
        let held_out_of = |values: &Values| judged(&raw.residuals_n(values), &held_out);
        let before = Model {
            values: base.values,
            fitted: base.free.clone(),
            covariance: crate::certainty::undetermined::covariance(
                &self.bench(&outcome.counts).problem(&base.free, None),
                &[base.values],
            ),
            held_out_n: held_out_of(&base.values),
        };
        let (values, parameters, covariance) = match table {
            Some(table) => (&table.values, &table.fitted, &table.covariance),
            None => (&fitted.values, &fitted.parameters, &fitted.covariance),
        };
        let after = Model {
            values: *values,
            fitted: parameters.clone(),
            covariance: covariance.clone(),
            held_out_n: held_out_of(values),
        };
        let bench = self.bench(&outcome.counts);
        let search = Search::new(&bench, noise_n, self.around(base, noise_n), base, self.with_time);
        // The last step of the ladder is the extended model as it is written.
        let last = naming.named.len().saturating_sub(1);
        let steps = naming.ladder.iter().skip(1).enumerate();
        let steps = steps.map(|(place, step)| if place == last { &fitted.values } else { &step.values });
        let findings = naming.named.iter().zip(steps);
        let mut findings: Vec<Finding> =
            findings.map(|(named, step)| finding(&search, &naming.model, named, held_out_of(step))).collect();
        findings.extend(table.map(|table| Finding {
            effect: Effect::Empirical,
            held_out_n: after.held_out_n,
            delta_bic: search.delta_bic_of_table(table.training, table.inflation),
            runner_up: None,
        }));
        let rms_n = |trial: &Trial| held_out_of(&trial.values).rms().unwrap_or(f64::NAN);
        let candidate = |(effect, trial): &(Effect, Trial)| Candidate {
            effect: *effect,
            delta_bic: search.delta_bic(base, trial, 1.0),
            held_out_rms_n: rms_n(trial),
        };
        let mut candidates: Vec<Candidate> = naming.first_round.iter().map(candidate).collect();
        candidates.sort_by(|one, other| one.delta_bic.total_cmp(&other.delta_bic));
        let of_tried = |tried: &naming::Tried| Tried {
            effect: tried.effect,
            delta_bic: search.delta_bic(&naming.model, &tried.trial, tried.inflation),
            held_out_rms_n: rms_n(&tried.trial),
            refusal: tried.refusal,
        };
        let tried = naming.tried.iter().map(of_tried).collect();
        let clean_n = self.bench(self.counts).residuals_n(&base.values);
        let places = self.excess(&clean_n, noise_n).concentrations(self.conditions);
        let places = if self.excess(&clean_n, noise_n).share() > WORTH { places } else { Vec::new() };
        let unexplained = self.unexplained(outcome, &after, &held_out_of);
        let verdict = match (&unexplained, findings.is_empty()) {
            (Some(_), _) => Verdict::Unexplained,
            (None, true) => Verdict::Complete,
            (None, false) => Verdict::Extended,
        };
        // The signals that explain most of the given model's residual and of the rest.
        let told = [places.first(), unexplained.as_ref().and_then(|rest: &Unexplained| rest.places.first())];
        let mut signals: Vec<&str> = told.into_iter().flatten().map(|place| place.signal).collect();
        signals.dedup();
        let (residual_before_n, residual_after_n) = (raw.residuals_n(&base.values), raw.residuals_n(&after.values));
        let profiles = signals.into_iter().filter_map(|signal| {
            let condition = self.conditions.iter().find(|condition| condition.signal == signal)?;
            profile(&self.record, condition, &residual_before_n, &residual_after_n)
        });
        let curves = curves(&self.record, &residual_before_n, &residual_after_n);
        CableDiscovery {
            curves,
            samples,
            reference_variation_n: raw.reference_variation_n(),
            held_out: rest::ranges(throughout.used(true).into_iter())
                .into_iter()
                .map(|range| [range.start, range.end])
                .collect(),
            noise_floor_n: noise_n,
            wander_n: rest.wander_n,
            verdict,
            before,
            after,
            findings,
            candidates,
            tried,
            places,
            faults,
            unexplained,
            lack: None,
            profiles: profiles.collect(),
            times_s: (0..self.record.rows.len()).map(|cycle| self.record.time_s(cycle)).collect(),
            residual_before_n,
            residual_after_n,
        }
    }

    /// Returns what has no name, from the outcome with its final model. Anything that only a table accounts for has no name.
    fn unexplained(
        &self,
        outcome: &Outcome,
        after: &Model,
        held_out_of: &impl Fn(&Values) -> Deviation,
    ) -> Option<Unexplained> {
        let unnamed = has_table(&after.values).then(|| without_table(&after.values));
        let Outcome { rest, stretch, .. } = outcome;
        if stretch.is_none() && rest.is_noise && unnamed.is_none() {
            return None;
        }
        let of_table = unnamed.and_then(|values| {
            let bench = self.bench(self.counts);
            self.rest(&bench, bench.residuals_n(&values), rest.noise_n)
        });
        let rms_n = unnamed.map_or(after.held_out_n, |values| held_out_of(&values)).rms().unwrap_or(f64::NAN);
        let rms_n = (rms_n * rms_n - rest.noise_n * rest.noise_n).max(0.0).sqrt();
        let rest = of_table.as_ref().unwrap_or(rest);
        let excess = self.excess(&rest.residual_n, rest.noise_n);
        let loud = |cycle: usize| rest.residual_n.get(cycle).is_some_and(|number| number.abs() > 4.0 * rest.noise_n);
        Some(Unexplained {
            rms_n,
            places: stretch.iter().chain(if rest.is_noise { &[][..] } else { &rest.places }).cloned().collect(),
            intervals_s: if rest.is_noise { Vec::new() } else { excess.intervals_s(loud) },
            neighbours: Vec::new(),
        })
    }
}

fn finding(search: &Search<'_, '_>, model: &Trial, named: &Named, held_out_n: Deviation) -> Finding {
    let bic = |trial: &Trial| search.delta_bic(&named.without, trial, named.inflation);
    let delta_bic = bic(model);
    let runner_up = named.runner_up.as_ref().map(|(effect, trial)| {
        let other_bic = bic(trial);
        RunnerUp {
            effect: *effect,
            delta_bic: other_bic,
            held_out_squares: trial.held_out,
            is_as_good: other_bic - delta_bic < STRONG_BIC,
        }
    });
    Finding { effect: named.effect, held_out_n, delta_bic, runner_up }
}
