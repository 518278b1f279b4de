//! Recording faults that `fit`, and `replay` on request, correct before they compare model and log. Neither searches for effects.
//!
//! The faults are found as in the discovery (`timing`, `length_noise`), but with the given model. An effect that is missing from this model may look
//! like a late reference. Only the discovery repeats the check with the effects that it has found.

use fric_core::Sample;
use rayon::prelude::*;

use super::length_noise::{self, LengthNoise};
use super::timing;
use crate::fit::cables::{prepared, used};
use crate::fit::{
    CableFit, CableRecord, FitOptions, Measurements, Progress, SampleStore, StoreError, fit_cables, residuals_n,
};
use crate::recording_fault::RecordingFault;
use crate::samples::noise::white_noise_apart;
use crate::samples::selection::leave_out_warm_up;

/// A fit corrects the time of a reference only if the residual after the correction is at most this multiple of the white noise. Otherwise an effect
/// may be missing that looks like a late reference. Tuned on 24 simulated logs of others: the two logs with such a fault come to 0.99 and 0.97 of
/// their noise; the four in which a missing effect mimics it come to 1.38, 1.69, 2.6 and 4.7. With 1.12 the decisions are the same; with 1.5 the
/// first of the four is corrected wrongly.
const NOTHING_LEFT_RATIO: f64 = 1.25;

/// The corrections of a log, cable by cable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Corrections {
    cables: Vec<CableCorrection>,
    length_noise_m: Option<f64>,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct CableCorrection {
    faults: Vec<RecordingFault>,
    /// The reference of each sample at its correct time, N; `None` if its time was right.
    references_n: Option<Vec<f64>>,
}

/// Finds the correctable faults of all cables that have a reference: a reference that is late or runs on another clock, and a noisy length.
///
/// # Errors
/// Returns the [`StoreError`] of a log that does not fit into memory.
pub fn corrections(samples: &SampleStore<'_>, progress: &Progress) -> Result<Corrections, StoreError> {
    progress.begin(samples.robot().cables().len());
    let noise = LengthNoise::of(samples, progress.stop_flag())?;
    let mut cables = Vec::new();
    for group in samples.groups() {
        let measurements = length_noise::steadied(samples.load(group)?, noise.as_ref());
        let records: Vec<CableRecord<'_>> = measurements.cables().collect();
        let of_cable = |(place, record): (usize, &CableRecord<'_>)| {
            let of_length =
                noise.as_ref().and_then(|noise| noise.faults.get(measurements.held().start + place)?.clone());
            let late = timing::retimed(record, progress.stop_flag());
            progress.finish_one();
            let (references_n, late) = late.map(|late| (late.references_n, late.fault)).unzip();
            CableCorrection { faults: late.into_iter().chain(of_length).collect(), references_n }
        };
        cables.par_extend(records.par_iter().enumerate().map(of_cable));
    }
    Ok(Corrections { cables, length_noise_m: noise.map(|noise| noise.length_play_m) })
}

impl Corrections {
    /// Returns the recording faults of a cable.
    #[must_use]
    pub fn faults(&self, cable: usize) -> &[RecordingFault] {
        self.cables.get(cable).map_or(&[], |cable| &cable.faults)
    }

    /// Returns the play that suppresses the noise of the lengths, m to either side; `None` if the noise does not matter.
    #[must_use]
    pub fn length_noise_m(&self) -> Option<f64> {
        self.length_noise_m
    }

    /// Returns a sample of the log with its references at their correct times. `number` counts the samples from 0; `room` is a buffer for the forces.
    pub fn corrected<'a>(&self, number: usize, sample: &Sample<'a>, room: &'a mut Vec<f64>) -> Sample<'a> {
        if self.cables.iter().all(|cable| cable.references_n.is_none()) {
            return *sample;
        }
        room.clear();
        room.extend_from_slice(sample.reference_force_n);
        for (reference_n, cable) in room.iter_mut().zip(&self.cables) {
            if let Some(references_n) = &cable.references_n {
                *reference_n = references_n.get(number).copied().unwrap_or(f64::NAN);
            }
        }
        Sample { reference_force_n: room, ..*sample }
    }
}

/// A fit to references at their correct times.
#[derive(Clone, Debug, Default)]
pub struct CorrectedFit {
    /// The fits of the cables, in the robot's order.
    pub cables: Vec<CableFit>,
    /// The recording faults of each cable.
    pub faults: Vec<Vec<RecordingFault>>,
}

/// Runs [`fit_cables`] without the noise of the lengths where it matters, and runs it again with late or early references moved to their correct times. A
/// cable keeps its first fit if that fit's residual is not correlated with the rate of the reference, or if the second fit leaves more than noise.
/// `take_residual_n` takes the [`residuals_n`] of each cable in turn, with the reference that it was fitted to.
///
/// # Errors
/// Returns the [`StoreError`] of a log that does not fit into memory.
pub fn fit_cables_corrected(
    samples: &SampleStore<'_>,
    options: &FitOptions,
    progress: &Progress,
    mut take_residual_n: impl FnMut(Vec<f64>),
) -> Result<CorrectedFit, StoreError> {
    let mut all = CorrectedFit::default();
    let noise = LengthNoise::of(samples, progress.stop_flag())?;
    for group in samples.groups() {
        let measurements = length_noise::steadied(samples.load(group)?, noise.as_ref());
        let (fits, left_n) = fit_group(&measurements, options, progress);
        all.cables.extend(fits.cables);
        all.faults.extend(fits.faults);
        left_n.into_iter().for_each(&mut take_residual_n);
    }
    for (faults, of_length) in all.faults.iter_mut().zip(noise.into_iter().flat_map(|noise| noise.faults)) {
        faults.extend(of_length);
    }
    Ok(all)
}

/// Fits the cables that are held. Returns the residuals too.
fn fit_group(
    measurements: &Measurements<'_>,
    options: &FitOptions,
    progress: &Progress,
) -> (CorrectedFit, Vec<Vec<f64>>) {
    let cables = fit_cables(measurements, options, progress);
    let left_n = residuals_n(measurements, &cables);
    let stop = progress.stop_flag();
    let retimed = |(cable, (fit, left_n)): (usize, (&CableFit, &Vec<f64>))| -> Option<timing::Retimed> {
        let record = measurements.cable(measurements.held().start + cable)?;
        if !timing::may_be_off(&record, left_n, stop) {
            return None;
        }
        // Friction fitted to a late reference is biased, the given one may be a guess.
        timing::retimed(&record, stop).or_else(|| {
            let fitted = record.params.with_values(&fit.values).ok()?;
            timing::retimed(&record.with_params(&fitted), stop)
        })
    };
    let found: Vec<_> = cables.par_iter().zip(&left_n).enumerate().map(retimed).collect();
    if found.iter().all(Option::is_none) {
        return (CorrectedFit { faults: vec![Vec::new(); cables.len()], cables }, left_n);
    }
    let parts = |retimed: Option<timing::Retimed>| {
        retimed.map(|retimed| (retimed.references_n, (retimed.fault, retimed.noise_reach))).unzip()
    };
    let (references_n, faults): (Vec<_>, Vec<_>) = found.into_iter().map(parts).unzip();
    let corrected = measurements.with_references(references_n);
    let again = fit_cables(&corrected, options, progress);
    let mut all = (CorrectedFit::default(), Vec::new());
    let first = cables.into_iter().zip(left_n);
    let again_n = residuals_n(&corrected, &again);
    let again = again.into_iter().zip(again_n);
    for (((first, again), fault), record) in first.zip(again).zip(faults).zip(corrected.cables()) {
        let fault = fault.filter(|(_, noise_reach)| is_noise(&judged_n(&record, &again.0, &again.1), *noise_reach));
        let (fit, left_n) = if fault.is_some() { again } else { first };
        all.0.cables.push(fit);
        all.0.faults.push(fault.into_iter().map(|(fault, _)| fault).collect());
        all.1.push(left_n);
    }
    all
}

/// Returns a fit's residual, NaN in the samples that the fit has not used.
fn judged_n(record: &CableRecord<'_>, fit: &CableFit, left_n: &[f64]) -> Vec<f64> {
    let mut standings = prepared(record);
    leave_out_warm_up(record, &fit.values, &mut standings);
    let judged = |(left_n, counts): (&f64, bool)| if counts { *left_n } else { f64::NAN };
    left_n.iter().zip(used(&standings)).map(judged).collect()
}

/// Whether a residual is little more than white noise, which so many consecutive samples share.
fn is_noise(residual_n: &[f64], noise_reach: usize) -> bool {
    let known = || residual_n.iter().filter(|left_n| left_n.is_finite());
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let mean_square = known().map(|left_n| left_n * left_n).sum::<f64>() / known().count() as f64;
    white_noise_apart(residual_n, noise_reach).is_some_and(|noise_n| mean_square.sqrt() <= NOTHING_LEFT_RATIO * noise_n)
}
