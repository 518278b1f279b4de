//! Faults of a recording that are corrected before model and log are compared, for whoever compares and looks for no effect: `replay` on request, and `fit`.
//!
//! They are found as the discovery finds them (`timing`, `length_noise`), by the model that is given. What that model lacks may look like a reference that comes late: the discovery
//! alone looks again with what it has found.

use fric_core::Sample;
use rayon::prelude::*;

use super::RecordingFault;
use super::{length_noise, timing};
use crate::fit::{CableFit, CableRecord, FitOptions, Measurements, Progress, Row, fit_cables, residuals_n};
use crate::samples::noise::white_noise;

/// A fit corrects the time of a reference by itself only where no more than this multiple of the white noise is left then: else something else is missing, which may look like a late
/// reference. Tuned on 24 simulated logs of others: the two that have such a fault come to 0.99 and 0.97 of their noise, the four in which a missing effect looks like it to 1.38, 1.69, 2.6 and
/// 4.7. With 1.12 the same are told; with 1.5 also the first of the four.
const NOTHING_LEFT_RATIO: f64 = 1.25;

/// What was corrected in a log, cable by cable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Corrections {
    cables: Vec<CableCorrection>,
    length_noise_m: Option<f64>,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct CableCorrection {
    faults: Vec<RecordingFault>,
    /// The reference of each sample where it belongs, N; `None` where its time is right.
    references_n: Option<Vec<f64>>,
}

/// The faults of cables with a reference that can be corrected: one that comes late or runs by another clock, and a length that trembles.
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
    /// What was wrong with the recording of a cable.
    #[must_use]
    pub fn faults(&self, cable: usize) -> &[RecordingFault] {
        self.cables.get(cable).map_or(&[], |cable| &cable.faults)
    }

    /// The play that keeps the noise of the lengths out, m to either side; `None` where there is none that matters.
    #[must_use]
    pub fn length_noise_m(&self) -> Option<f64> {
        self.length_noise_m
    }

    /// A sample of the log with its references where they belong; `number` counts the samples from 0, `room` holds the forces.
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

/// A fit with the references where they belong.
#[derive(Clone, Debug)]
pub struct CorrectedFit<'a> {
    /// The cables in the robot's order.
    pub cables: Vec<CableFit>,
    /// What was wrong with the recording of each.
    pub faults: Vec<Vec<RecordingFault>>,
    /// What they were fitted to, where anything was wrong.
    pub measurements: Option<Measurements<'a>>,
}

/// [`fit_cables`], and once more with the references that come late where they belong. The first fit is the result of a cable where what it leaves does not go with the rate of the reference,
/// or where the second leaves more than noise.
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

/// Whether a residual is white noise and little else.
fn is_noise(residual_n: &[f64]) -> bool {
    let known = || residual_n.iter().filter(|left_n| left_n.is_finite());
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let mean_square = known().map(|left_n| left_n * left_n).sum::<f64>() / known().count() as f64;
    white_noise(residual_n).is_some_and(|noise_n| mean_square.sqrt() <= NOTHING_LEFT_RATIO * noise_n)
}
