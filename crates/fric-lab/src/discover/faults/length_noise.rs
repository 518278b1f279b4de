//! Noise of the measured length. A model takes it for motion, and each small movement adds friction.
//!
//! The cycle suppresses this noise with a play of `length_noise_m` of the robot's monitor: only a length that pushes against the edge of the play
//! counts as motion. The play takes the same distance away from each true reversal, so it must be no wider than necessary. A play of 2σ to either
//! side suppresses white noise of the standard deviation σ best. The noise is a recording fault if the model with this play agrees better with the
//! log than without it, on samples that neither was fitted to.

use std::borrow::Cow;
use std::sync::atomic::AtomicBool;

use fric_core::signals::SignalLimits;
use rayon::prelude::*;

use super::{Fault, RecordingFault};
use crate::discover::cable::held_out_squares;
use crate::fit::{CableRecord, Measurements, SampleStore, StoreError};
use crate::samples::cable::PLAY_OF_NOISE;

/// Minimum relative decrease of the sum of squares. It corresponds to 0.25 % of the rms, as for an effect.
const LEAST_GAIN: f64 = 0.005;

/// Noise of the lengths that matters.
pub struct LengthNoise {
    limits: SignalLimits,
    /// The play that keeps the noise out, m to either side.
    pub length_play_m: f64,
    /// The fault of each cable of the robot; `None` where the noise of its length does not matter.
    pub faults: Vec<Option<RecordingFault>>,
}

/// Returns measurements without the noise of their lengths where it matters.
pub fn steadied<'m, 'a>(given: Cow<'m, Measurements<'a>>, noise: Option<&LengthNoise>) -> Cow<'m, Measurements<'a>> {
    match noise {
        Some(noise) => Cow::Owned(given.conditioned(&noise.limits)),
        None => given,
    }
}

impl LengthNoise {
    /// Finds the noise of the lengths. Returns `None` if it does not matter or the robot's monitor already has a play.
    ///
    /// # Errors
    /// Returns the [`StoreError`] of a log that does not fit into memory.
    pub fn of(samples: &SampleStore<'_>, stop: &AtomicBool) -> Result<Option<Self>, StoreError> {
        let limits = samples.robot().monitor().limits();
        if limits.length_noise_m > 0.0 {
            return Ok(None);
        }
        let mut noise_m: Vec<Option<f64>> = Vec::new();
        for group in samples.groups() {
            let measurements = samples.load(group)?;
            let records: Vec<CableRecord<'_>> = measurements.cables().collect();
            noise_m.par_extend(records.par_iter().map(|record| noise_that_matters_m(record, &limits, stop)));
        }
        // The monitor has one play for all cables.
        let Some(greatest_m) = noise_m.iter().flatten().copied().reduce(f64::max) else { return Ok(None) };
        let length_noise_m = PLAY_OF_NOISE * greatest_m;
        let fault = |noise_m: Option<f64>| {
            let parameters = vec![("noise_m", noise_m?), ("length_noise_m", length_noise_m)];
            Some(RecordingFault { fault: Fault::NoisyLength, parameters, intervals_s: Vec::new() })
        };
        let faults = noise_m.into_iter().map(fault).collect();
        Ok(Some(Self { limits: SignalLimits { length_noise_m, ..limits }, length_play_m: length_noise_m, faults }))
    }
}

fn noise_that_matters_m(record: &CableRecord<'_>, limits: &SignalLimits, stop: &AtomicBool) -> Option<f64> {
    let noise_m = record.length_noise_m()?;
    let limits = SignalLimits { length_noise_m: PLAY_OF_NOISE * noise_m, ..*limits };
    if noise_m <= 0.0 || limits.length_noise_m >= limits.length_jump_m {
        return None;
    }
    let rows = record.conditioned(&limits);
    let [with, without] =
        [record.behind_play(&rows, limits.length_noise_m), *record].map(|record| held_out_squares(&record, stop));
    (with? < (1.0 - LEAST_GAIN) * without?).then_some(noise_m)
}
