//! Discovery on one cable: takes its record and returns everything that was found.

mod assemble;
mod final_fit;
mod passes;

use std::sync::atomic::AtomicBool;

use fric_core::parameters::{MU, Values};

use self::assemble::comparable;
use crate::candidates::catalogue::around;
use crate::discover::faults::oscillations::Oscillations;
use crate::discover::faults::spectrum::{Times, motion_and_load};
use crate::discover::faults::{faulty_stretches, leave_out, of_stretches, spikes_among};
use crate::discover::given::given_model;
use crate::discover::lack::{lack_of, lack_of_noise, lack_of_samples};
use crate::discover::naming::Named;
use crate::discover::report::CableDiscovery;
use crate::discover::rest::places::Excess;
use crate::discover::workbench::{self, Trial, Workbench};
use crate::discover::{Task, rest};
use crate::effects::Around;
use crate::fit::{CableRecord, FitOptions, StoreError};
use crate::recording_fault::{Fault, RecordingFault};
use crate::samples::conditions::{Condition, conditions, steady};
use crate::samples::selection::Standing;
use crate::samples::split::{Block, split};
use crate::samples::steps::CoarseSteps;

pub use assemble::add_corrected_faults;

/// The steps of a converter are reported if rounding makes at least this fraction of the noise variance.
const LEAST_ROUNDING: f64 = 0.1;

/// No model is trusted to better than this fraction of the tension, however low the noise is.
pub const BELIEVED_RATIO: f64 = 1e-4;

/// Number of progress steps per cable: fit of the given model, first search, second search, table for the rest.
pub const STAGES: usize = 4;

/// Runs the discovery on one cable.
///
/// # Errors
/// Returns the [`StoreError`] of a log that does not fit into memory, if a signal of another cable is needed.
pub fn discover_cable(record: &CableRecord<'_>, task: &Task<'_>) -> Result<CableDiscovery, StoreError> {
    let stop = task.progress.stop_flag();
    if let Some(lack) = lack_of(record) {
        let samples = crate::samples::selection::count(&crate::fit::cables::prepared(record));
        return Ok(CableDiscovery::untold(record, samples, lack));
    }
    let stretches = faulty_stretches(record);
    let mut standings = crate::fit::cables::prepared(record);
    leave_out(record, &stretches, &mut standings);
    let gang = crate::search::gang::Gang::new(1, stop);
    // Its forces, which would stay with its problem, are of no further use.
    let crate::fit::cables::Search { solution, standings: found, .. } =
        crate::fit::cables::Search::run(record, &standings, &FitOptions::default(), stop, gang.seat(0));
    task.stages.finish_one();
    let samples = crate::samples::selection::count(&found);
    if let Some(lack) = lack_of_samples(&samples, record.interval_s) {
        return Ok(CableDiscovery::untold(record, samples, lack));
    }
    let counts = crate::fit::cables::used(&found);
    let blocks = split(record);
    let conditions = conditions(record);
    let steady = steady(record, &conditions);
    let (mut start, held) = given_model(record, &solution, &counts, stop);

    let measured = crate::samples::interpolated::measured(record);
    let times = Times::of(record);
    let bench = Workbench { record: *record, blocks: &blocks, counts: &counts, measured: &measured, stop };
    // Samples between two measurements count too, because a line may be faster than the measurements.
    let throughout = rest::with_interpolated(&counts, &measured, &comparable(record));
    let left_by = |values: &Values| Workbench { counts: &throughout, ..bench.clone() }.residuals_n(values);
    let raw = CableLog {
        record: *record,
        raw: *record,
        blocks: &blocks,
        counts: &counts,
        standings: &standings,
        measured: &measured,
        conditions: &conditions,
        steady: &steady,
        stop,
    };
    let search = |heard: &Oscillations, start: &mut workbench::Model| {
        // An oscillation of the sensor is not friction, so it is subtracted from the reference first.
        let references_n = heard.taken_off(record, &times);
        raw.with_references(&references_n).passes(start, &held)
    };
    let signals = motion_and_load(record);
    let mut heard = Oscillations::lines_of(&left_by(&bench.try_one(&start).values), &times, record, &signals);
    let Some(mut outcome) = search(&heard, &mut start) else {
        return Ok(CableDiscovery::untold(record, samples, lack_of_noise()));
    };
    task.stages.finish_one();
    // A wrong model may hide an oscillation, or leave an error that only looks like one. That error was taken off the log to which the extended model is
    // fitted, and is what this leaves of the whole log, so the model is fitted to the whole first.
    let named = outcome.fitted.model();
    let whole = if heard.faults().is_empty() { named.values } else { bench.try_one(&named).values };
    let after = Oscillations::of(&left_by(&whole), &times, record, &signals);
    let mut faults = after.faults();
    if !heard.are_like(&after)
        && !outcome.is_cut_short()
        && let Some(again) = search(&after, &mut start)
    {
        // No filter removes the onset of a vibration. An effect that is named only after the removal stands for that remainder.
        let was_named = |named: &Named| outcome.naming.named.iter().any(|before| before.effect == named.effect);
        if !after.vibrate() || again.naming.named.iter().all(was_named) {
            (outcome, heard) = (again, after);
        }
    } else {
        faults = heard.faults();
    }
    task.stages.finish_one();
    let references_n = heard.taken_off(record, &times);
    let mut told = [&stretches[..], &spikes_among(record, &found)].concat();
    told.sort_by_key(|stretch| stretch.cycles.start);
    faults.extend(of_stretches(&told, |cycle| record.time_s(cycle)));
    let gain = record.params.frictionless_gain();
    let signals = [("step_n", gain, &*record.shown_forces_n()), ("reference_step_n", 1.0, record.references_n)];
    let coarse = |(key, gain, shown_n): (&'static str, f64, &[f64])| {
        let step_n = CoarseSteps::of(shown_n)?.step;
        // Rounding noise is uniform within ± half a step.
        let rounding_n = gain * step_n / 12.0_f64.sqrt();
        let matters = rounding_n * rounding_n > LEAST_ROUNDING * outcome.rest.noise_n * outcome.rest.noise_n;
        let fault = Fault::CoarseConverter;
        matters.then(|| RecordingFault { fault, parameters: vec![(key, step_n)], intervals_s: Vec::new() })
    };
    faults.extend(signals.into_iter().filter_map(coarse));
    let case = raw.with_references(&references_n);
    let table = if task.options.empirical { case.table(&outcome, task)? } else { None };
    let mut found = case.report(&outcome, table.as_ref(), samples, faults);
    found.times_s = task.all.samples.times_s();
    found.per_log = case.log_values(&outcome, &found.after);
    found.add_to_zeros(&[]);
    Ok(found)
}

/// A cable with its log and all that is known of each sample.
#[derive(Clone, Copy)]
struct CableLog<'a> {
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
    conditions: &'a [Condition<'a>],
    /// The conditions over which an effect has one size.
    steady: &'a [Condition<'a>],
    stop: &'a AtomicBool,
}

impl<'a> CableLog<'a> {
    /// Returns the same log with other references.
    fn with_references<'b>(&self, references_n: &'b [f64]) -> CableLog<'b>
    where
        'a: 'b,
    {
        CableLog { record: self.raw.with_references(references_n), ..*self }
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

    fn around(&self, base: &Trial, noise_n: f64) -> Around {
        around(&self.record, base.values[MU], noise_n)
    }
}
