//! What a discovery on one cable returns, put together from the outcome of its passes.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use fric_core::effects::Effect;
use fric_core::parameters::{OFFSET, Values};
use nalgebra::DMatrix;

use super::CableLog;
use super::passes::Outcome;
use crate::certainty::log_zeros::log_zeros;
use crate::discover::Task;
use crate::discover::figures::curve::curves;
use crate::discover::figures::profile::profile;
use crate::discover::given::given_to;
use crate::discover::naming::{self, Named, STRONG_BIC, Search};
use crate::discover::report::{CableDiscovery, Candidate, Finding, Model, RunnerUp, Tried, Unexplained, Verdict};
use crate::discover::rest::empirical::{Table, has_table, table, without_table};
use crate::discover::rest::neighbours::neighbours_of;
use crate::discover::rest::places::Place;
use crate::discover::rest::{self, WORTH};
use crate::discover::workbench::{self, Trial, Workbench};
use crate::fit::{CableRecord, LogValue, Parameter, Row, SampleCounts, StoreError};
use crate::recording_fault::RecordingFault;
use crate::replay::Deviation;
use crate::samples::held::repeated_forces;
use crate::samples::interpolated::measured;
use crate::samples::record::PerLog;
use crate::samples::split::split;
use crate::search::problem::Problem;
use crate::set_up::SetUp;

impl CableLog<'_> {
    /// Returns a table for a rest that has no name and may be no effect that is known.
    pub(super) fn table(&self, outcome: &Outcome, task: &Task<'_>) -> Result<Option<Table>, StoreError> {
        let Outcome { fitted, rest, stretch, .. } = outcome;
        let is_known = outcome.naming.tried.iter().any(naming::Tried::may_be_rest);
        if rest.is_noise && stretch.is_none() || is_known || has_table(&fitted.values) {
            return Ok(None);
        }
        let bench = self.bench(self.counts);
        let places: Vec<Place> = stretch.iter().chain(&rest.places).cloned().collect();
        let Some(table) = table(&bench, &fitted.model(), rest.noise_n, &places) else { return Ok(None) };
        // Coupling from a neighbouring cable is not this cable's effect, however well a table over this cable's conditions fits it.
        let neighbours = neighbours_of(&bench.residuals_n(&fitted.values), task)?;
        let of_neighbour = neighbours.first().map_or(0.0, |neighbour| neighbour.correlation * neighbour.correlation);
        Ok((table.gain_ratio > of_neighbour).then_some(table))
    }

    pub(super) fn report(
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
        let with_interpolated = rest::with_interpolated(self.counts, self.measured, &comparable(&self.raw));
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
        let (parameters, covariance) = without(&fitted.open, parameters, covariance);
        let after = Model { values: *values, fitted: parameters, covariance, held_out_n: held_out_of(values) };
        let bench = self.bench(&outcome.counts);
        let search = Search::new(&bench, noise_n, self.around(base, noise_n), base, self.steady, &outcome.effort);
        // The last step of the ladder is the extended model as it is written.
        let last = naming.named.len().saturating_sub(1);
        let steps = naming.ladder.iter().skip(1).enumerate();
        let steps = steps.map(|(place, step)| if place == last { &fitted.values } else { &step.values });
        let findings = naming.named.iter().zip(steps);
        let mut findings: Vec<Finding> =
            findings.map(|(named, step)| finding(&search, named, held_out_of(step))).collect();
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
            takes_rest: tried.takes_rest,
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
            // A table would make up for any scale.
            set_up: self.set_up(&residual_before_n, base.values[OFFSET]),
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
            per_log: Vec::new(),
            findings,
            candidates,
            tried,
            places,
            faults,
            unexplained,
            lack: None,
            profiles: profiles.collect(),
            times_s: Arc::default(),
            residual_before_n,
            residual_after_n,
        }
    }

    /// Returns the forces by the sensor and by a model with this residual beside the reference. A zero at the platform, `offset_n`, would hide the scale
    /// of a load that does not vary.
    fn set_up(&self, residual_n: &[f64], offset_n: f64) -> SetUp {
        let gain = self.raw.params.frictionless_gain();
        let mut set_up = SetUp::new(gain, self.record.reference_is_known);
        let samples = self.raw.rows.iter().zip(self.raw.references_n).zip(residual_n).enumerate();
        for (cycle, ((row, reference_n), residual_n)) in samples {
            if row.signals.jump || self.raw.starts.contains(&cycle) {
                set_up.start();
            }
            let forces_n = [row.signals.sensor_force_n * gain, residual_n + reference_n - offset_n];
            set_up.add(row.signals.length_m, *reference_n, forces_n);
        }
        set_up
    }

    /// Returns the value of each log of its own in a model, from all samples.
    pub(super) fn log_values(&self, outcome: &Outcome, model: &Model) -> Vec<Option<LogValue>> {
        let Some(PerLog { zero, .. }) = self.record.per_log else { return Vec::new() };
        let bench = self.bench(&outcome.counts);
        let problem = Problem { used: outcome.counts.clone(), ..bench.problem(&model.fitted, None) };
        LogValue::of_logs(zero, &model.values, &log_zeros(&problem, &model.values), &[])
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
            self.rest(&bench, &workbench::Model { values, free: after.fitted.clone() }, rest.noise_n)
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

/// Returns parameters with their covariance, less those that are open.
fn without(open: &[Parameter], parameters: &[Parameter], covariance: &DMatrix<f64>) -> (Vec<Parameter>, DMatrix<f64>) {
    let all = parameters.iter().copied().enumerate();
    let (places, told): (Vec<usize>, Vec<Parameter>) = all.filter(|(_, parameter)| !open.contains(parameter)).unzip();
    (told, covariance.select_rows(&places).select_columns(&places))
}

fn finding(search: &Search<'_, '_>, named: &Named, held_out_n: Deviation) -> Finding {
    let bic = |trial: &Trial| search.delta_bic(&named.without, trial, named.inflation);
    let delta_bic = bic(&named.with);
    let runner_up = named.runner_up.as_ref().map(|(effect, trial)| {
        let other_bic = bic(trial);
        RunnerUp {
            effect: *effect,
            delta_bic: other_bic,
            held_out_squares: trial.held_out,
            is_as_good: named.is_as_good || other_bic - delta_bic < STRONG_BIC,
        }
    });
    Finding { effect: named.effect, held_out_n, delta_bic, runner_up }
}

/// Adds faults that were corrected for the whole log, the last one first. The given model is the one without the corrections.
pub fn add_corrected_faults(
    found: &mut CableDiscovery,
    given: &CableRecord<'_>,
    faults: &[RecordingFault],
    stop: &AtomicBool,
) {
    found.faults.splice(0..0, faults.iter().rev().cloned());
    let Some((counts, start)) = given_to(given, stop) else { return };
    let (blocks, measured) = (split(given), measured(given));
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

/// Returns which cycles have a reference and a force that the sensor does not only repeat.
pub(super) fn comparable(record: &CableRecord<'_>) -> Vec<bool> {
    let repeated = repeated_forces(record).unwrap_or_default();
    let is_comparable = |(place, row): (usize, &Row)| {
        row.is_sound() && record.reference_n(place).is_finite() && repeated.get(place) != Some(&true)
    };
    record.rows.iter().enumerate().map(is_comparable).collect()
}
