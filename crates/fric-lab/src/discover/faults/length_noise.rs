//! Noise of the measured length. A model takes it for motion, and each small movement adds friction.
//!
//! The cycle suppresses this noise with a play of `length_noise_m` of the robot's monitor: only a length that pushes against the edge of the play
//! counts as motion. The play takes the same distance away from each true reversal, so it must be no wider than necessary. A play of 2σ to either
//! side suppresses white noise of the standard deviation σ best. The noise is a recording fault if the model with this play, fitted, agrees better with
//! the log than without it. The lengths alone determine the play, so both fits have the same freedom.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::atomic::AtomicBool;

use fric_core::signals::SignalLimits;
use rayon::prelude::*;

use crate::discover::given::fitted_to;
use crate::fit::{CableRecord, Measurements, Row, SampleStore, StoreError};
use crate::recording_fault::{Fault, LENGTH_NOISE_M, RecordingFault};
use crate::samples::cable::PLAY_OF_NOISE;
use crate::search::gang::Gang;

/// Minimum relative decrease of the sum of squares. It corresponds to 0.25 % of the rms, as for an effect.
const LEAST_GAIN: f64 = 0.005;
/// Number of cycles that suffice to see whether the noise matters: 65 s at 1 kHz.
const MOST_CYCLES: usize = 65_536;

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
            let parameters = vec![("noise_m", noise_m?), (LENGTH_NOISE_M, length_noise_m)];
            Some(RecordingFault { fault: Fault::NoisyLength, parameters, intervals_s: Vec::new() })
        };
        let faults = noise_m.into_iter().map(fault).collect();
        Ok(Some(Self { limits: SignalLimits { length_noise_m, ..limits }, length_play_m: length_noise_m, faults }))
    }
}

/// Returns the standard deviation of the noise of a length where it matters, m.
fn noise_that_matters_m(record: &CableRecord<'_>, limits: &SignalLimits, stop: &AtomicBool) -> Option<f64> {
    let noise_m = record.length_noise_m()?;
    let limits = SignalLimits { length_noise_m: PLAY_OF_NOISE * noise_m, ..*limits };
    if noise_m <= 0.0 || limits.length_noise_m >= limits.length_jump_m {
        return None;
    }
    let record = record.stretch(&liveliest(record));
    let rows = record.conditioned(&limits);
    let behind = record.behind_play(&rows, limits.length_noise_m);
    let left_n = |record: &CableRecord<'_>| {
        let gang = Gang::new(1, stop);
        fitted_to(record, gang.seat(0), stop).map(|search| search.residuals_n())
    };
    let (mut with, mut without) = (0.0, 0.0);
    for (with_n, without_n) in left_n(&behind)?.iter().zip(left_n(&record)?) {
        if with_n.is_finite() && without_n.is_finite() {
            (with, without) = (with + with_n * with_n, without + without_n * without_n);
        }
    }
    (with < (1.0 - LEAST_GAIN) * without).then_some(noise_m)
}

/// Returns the stretch of a log, at most [`MOST_CYCLES`] long, with the longest way.
fn liveliest(record: &CableRecord<'_>) -> Range<usize> {
    let mut covered_m = vec![0.0];
    covered_m.extend(record.rows.iter().scan(0.0, |way_m, row| {
        *way_m += row.signals.displacement_m.abs();
        Some(*way_m)
    }));
    let way_m = |cycles: &Range<usize>| covered_m[cycles.end] - covered_m[cycles.start];
    let of_log = |(start, rows): (usize, &[Row])| {
        let (end, length) = (start + rows.len(), rows.len().min(MOST_CYCLES));
        (start..=end - length).step_by(MOST_CYCLES / 8).map(move |from| from..from + length)
    };
    let stretches = record.logs().flat_map(of_log);
    stretches.max_by(|one, other| way_m(one).total_cmp(&way_m(other))).unwrap_or(0..0)
}
