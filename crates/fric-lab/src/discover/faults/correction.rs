//! Recording faults that `fit`, and `replay` on request, correct before they compare model and log. Neither searches for effects.
//!
//! The faults are found as in the discovery (`timing`, `length_noise`), but with the given model. An effect that is missing from this model may look
//! like a late reference. Only the discovery repeats the check with the effects that it has found.

use fric_core::Sample;
use rayon::prelude::*;

use super::RecordingFault;
use super::{length_noise, timing};
use crate::fit::{CableFit, CableRecord, FitOptions, Measurements, Progress, Row, fit_cables, residuals_n};
use crate::samples::noise::white_noise;

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
#[must_use]
pub fn corrections(measurements: &Measurements<'_>, progress: &Progress) -> Corrections {
    let given: Vec<CableRecord<'_>> = measurements.cables().collect();
    progress.begin(given.len());
    let steadied = length_noise::steadied(measurements, progress.stop_flag());
    let records = length_noise::records(&given, steadied.as_ref());
    let of_cable = |(place, record): (usize, &CableRecord<'_>)| {
        let noisy = steadied.as_ref().and_then(|steadied| steadied.faults.get(place)?.clone());
        let late = timing::retimed(record, progress.stop_flag());
        progress.finish_one();
        let (rows, late) = late.unzip();
        CableCorrection {
            faults: late.into_iter().chain(noisy).collect(),
            references_n: rows.map(|rows| rows.iter().map(|row| row.reference_n).collect()),
        }
    };
    Corrections {
        cables: records.par_iter().enumerate().map(of_cable).collect(),
        length_noise_m: steadied.map(|steadied| steadied.length_play_m),
    }
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
#[derive(Clone, Debug)]
pub struct CorrectedFit<'a> {
    /// The fits of the cables, in the robot's order.
    pub cables: Vec<CableFit>,
    /// The recording faults of each cable.
    pub faults: Vec<Vec<RecordingFault>>,
    /// The corrected measurements that the cables were fitted to; `None` if nothing was wrong.
    pub measurements: Option<Measurements<'a>>,
}

/// Runs [`fit_cables`], and runs it again with late references moved to their correct times. A cable keeps its first fit if that fit's residual is
/// not correlated with the rate of the reference, or if the second fit leaves more than noise.
#[must_use]
pub fn fit_cables_corrected<'a>(
    measurements: &Measurements<'a>,
    options: &FitOptions,
    progress: &Progress,
) -> CorrectedFit<'a> {
    let cables = fit_cables(measurements, options, progress);
    let left_n = residuals_n(measurements, &cables);
    let stop = progress.stop_flag();
    let retimed = |(cable, (fit, left_n)): (usize, (&CableFit, &Vec<f64>))| -> Option<(Vec<Row>, RecordingFault)> {
        let record = measurements.cable(cable)?;
        if !timing::may_be_off(&record, left_n) {
            return None;
        }
        let fitted = record.params.with_values(&fit.values).ok()?;
        timing::retimed(&record.with_params(&fitted), stop)
    };
    let found: Vec<_> = cables.par_iter().zip(&left_n).enumerate().map(retimed).collect();
    if found.iter().all(Option::is_none) {
        return CorrectedFit { faults: vec![Vec::new(); cables.len()], cables, measurements: None };
    }
    let (rows, faults): (Vec<_>, Vec<_>) = found.into_iter().map(Option::unzip).unzip();
    let corrected = measurements.with_rows(&rows);
    let again = fit_cables(&corrected, options, progress);
    let is_corrected: Vec<bool> = residuals_n(&corrected, &again)
        .iter()
        .zip(&faults)
        .map(|(left_n, fault)| fault.is_some() && is_noise(left_n))
        .collect();
    let kept = rows.into_iter().zip(&is_corrected).map(|(rows, is)| rows.filter(|_| *is));
    CorrectedFit {
        measurements: is_corrected.contains(&true).then(|| measurements.with_rows(&kept.collect::<Vec<_>>())),
        faults: faults
            .into_iter()
            .zip(&is_corrected)
            .map(|(fault, is)| fault.filter(|_| *is).into_iter().collect())
            .collect(),
        cables: cables
            .into_iter()
            .zip(again)
            .zip(&is_corrected)
            .map(|((first, again), is)| if *is { again } else { first })
            .collect(),
    }
}

/// Whether a residual is little more than white noise.
fn is_noise(residual_n: &[f64]) -> bool {
    let known = || residual_n.iter().filter(|left_n| left_n.is_finite());
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let mean_square = known().map(|left_n| left_n * left_n).sum::<f64>() / known().count() as f64;
    white_noise(residual_n).is_some_and(|noise_n| mean_square.sqrt() <= NOTHING_LEFT_RATIO * noise_n)
}
