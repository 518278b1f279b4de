//! Noise of the measured length. A model takes it for motion, and each small movement adds friction.
//!
//! The cycle suppresses this noise with a play of `length_noise_m` of the robot's monitor: only a length that pushes against the edge of the play
//! counts as motion. The play takes the same distance away from each true reversal, so it must be no wider than necessary. A play of 2σ to either
//! side suppresses white noise of the standard deviation σ best. The noise is a recording fault if the model with this play agrees better with the
//! log than without it, on samples that neither was fitted to.

use std::sync::atomic::AtomicBool;

use fric_core::signals::SignalLimits;
use rayon::prelude::*;

use super::{Fault, RecordingFault};
use crate::discover::cable::held_out_squares;
use crate::fit::{CableRecord, Measurements, Row};
use crate::samples::record::PLAY_OF_NOISE;

/// Minimum relative decrease of the sum of squares. It corresponds to 0.25 % of the rms, as for an effect.
const LEAST_GAIN: f64 = 0.005;

/// Signals from which the noise of the lengths was removed.
pub struct Steadied {
    /// The cycles of each cable.
    pub rows: Vec<Vec<Row>>,
    /// The play that keeps the noise out, m to either side.
    pub length_play_m: f64,
    /// The fault of each cable; `None` where the noise of its length does not matter.
    pub faults: Vec<Option<RecordingFault>>,
}

/// Returns the records without the noise of their lengths where it matters.
pub fn records<'a>(given: &[CableRecord<'a>], steadied: Option<&'a Steadied>) -> Vec<CableRecord<'a>> {
    match steadied {
        Some(steadied) => {
            let with_rows = given.iter().zip(&steadied.rows);
            with_rows.map(|(given, rows)| given.behind_play(rows, steadied.length_play_m)).collect()
        }
        None => given.to_vec(),
    }
}

/// Removes the noise of the lengths from the measurements. Returns `None` if the noise does not matter or the robot's monitor already has a play.
pub fn steadied(measurements: &Measurements<'_>, stop: &AtomicBool) -> Option<Steadied> {
    let limits = measurements.robot().monitor().limits();
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    let noise_that_matters_m = |record: &CableRecord<'_>| {
        let noise_m = record.length_noise_m()?;
        let limits = SignalLimits { length_noise_m: PLAY_OF_NOISE * noise_m, ..limits };
        if noise_m <= 0.0 || limits.length_noise_m >= limits.length_jump_m {
            return None;
        }
        let rows = record.conditioned(&limits);
        let [with, without] =
            [record.behind_play(&rows, limits.length_noise_m), *record].map(|record| held_out_squares(&record, stop));
        (with? < (1.0 - LEAST_GAIN) * without?).then_some(noise_m)
    };
    if limits.length_noise_m > 0.0 {
        return None;
    }
    let noise_m: Vec<Option<f64>> = records.par_iter().map(noise_that_matters_m).collect();
    // The monitor has one play for all cables.
    let length_noise_m = PLAY_OF_NOISE * noise_m.iter().flatten().copied().reduce(f64::max)?;
    let limits = SignalLimits { length_noise_m, ..limits };
    let fault = |noise_m: Option<f64>| {
        let parameters = vec![("noise_m", noise_m?), ("length_noise_m", length_noise_m)];
        Some(RecordingFault { fault: Fault::NoisyLength, parameters, intervals_s: Vec::new() })
    };
    Some(Steadied {
        length_play_m: length_noise_m,
        rows: records.iter().map(|record| record.conditioned(&limits)).collect(),
        faults: noise_m.into_iter().map(fault).collect(),
    })
}
