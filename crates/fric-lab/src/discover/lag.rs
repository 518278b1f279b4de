//! Tells a lag of first order of the force sensor from what looks like it: a reference that is early, or a motion that is known too early.
//!
//! A model that undoes the lag makes the noise louder that enters behind the filter, so its residual says little against it. What it leaves is therefore
//! put behind the same lag again: that is the residual of the sensor's own signal, with the reference and the friction behind the lag.

use crate::discover::workbench::Workbench;
use crate::samples::cable::CableRecord;
use crate::samples::noise::{VARIANCE_ERROR, white_noise_apart};

/// A model is distinguished from a lag of the sensor by so many standard errors of the noise variance, tried on references that are early: with half as many,
/// a lag of 5 ms in slow motion is taken for an early reference, by luck; with twice as many, a reference that is early by 20 ms is taken for a lag.
const MANY_ERRORS: f64 = 3.0;
/// A lag has forgotten a sample of which this fraction is left. At 0.1 or 0.002 the result is the same.
const FORGOTTEN: f64 = 0.02;

/// Returns a series of a cable's samples behind a lag of first order; NaN in the samples that depend on what was before each log or a gap. `keeps` is the
/// fraction that the lag keeps from one sample to the next, as a function of the time between them, s.
pub fn behind_lag(record: &CableRecord<'_>, series: &[f64], keeps: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut lagging = series.to_vec();
    for (start, log) in record.logs() {
        // What is kept of the first sample after a gap, which stands for all before it.
        let (mut behind, mut memory) = (f64::NAN, 1.0);
        let mut last_s = f64::NAN;
        for (place, number) in lagging.iter_mut().enumerate().skip(start).take(log.len()) {
            let time_s = record.time_s(place);
            let keeps = keeps((time_s - last_s).max(0.0));
            last_s = time_s;
            if behind.is_finite() && number.is_finite() {
                behind = keeps * behind + (1.0 - keeps) * *number;
                memory *= keeps;
            } else {
                (behind, memory) = (*number, 1.0);
            }
            *number = if memory < FORGOTTEN { behind } else { f64::NAN };
        }
    }
    lagging
}

/// Whether a model's residual is smaller than one behind a lag, on the learned and on the held-out samples that both have. The noise that the lag removes
/// does not count, nor what may be an error of its estimate. `reaches` are the numbers of consecutive samples that share noise in the first residual, and in
/// the second without the lag; `None` if the noise cannot be estimated.
pub fn is_better_than_behind_lag(
    bench: &Workbench<'_>,
    [reach, reach_before_lag]: [usize; 2],
    left_n: &[f64],
    lagging_n: &[f64],
    time_constant_s: f64,
) -> Option<bool> {
    let noise_square = |left_n: &[f64], reach: usize| {
        let noise_n = white_noise_apart(&bench.measured_of(left_n), reach)?;
        Some(noise_n * noise_n)
    };
    let measured_count = bench.measured.iter().filter(|measured| **measured).count();
    #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
    let measured_s = bench.record.interval_s * bench.measured.len() as f64 / measured_count as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of samples, not below 0")]
    let lag_reach = reach_before_lag + (-time_constant_s * FORGOTTEN.ln() / measured_s).max(0.0) as usize;
    let noise = noise_square(left_n, reach)?;
    // Over so many samples a rest that is no noise looks like it.
    let removed = (noise - noise_square(lagging_n, lag_reach)?).max(0.0);
    let sums = |held_out: bool| {
        let used = bench.used(held_out);
        let known = left_n.iter().zip(lagging_n).zip(&used);
        let known = known.filter(|((one, other), used)| **used && (*one + *other).is_finite());
        known.fold([0.0; 3], |[count, one, other], ((left_n, lagging_n), _)| {
            [count + 1.0, one + left_n * left_n, other + lagging_n * lagging_n]
        })
    };
    let (learned, held_out) = (sums(false), sums(true));
    let error = VARIANCE_ERROR * std::f64::consts::SQRT_2 / (learned[0] + held_out[0]).sqrt() * noise;
    let is_better = |[count, left, lagging]: [f64; 3]| lagging - left > count * (MANY_ERRORS * error - removed);
    Some(is_better(learned) && is_better(held_out))
}
