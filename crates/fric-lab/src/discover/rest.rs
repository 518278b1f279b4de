//! What is left when all names are given: noise that wanders, or something that has no name.
//!
//! A sensor's wander is noise: it has nothing to do with what the cable does and is spread over the log. What is a
//! function of a condition, or sits in a narrow stretch of time, or is many times the noise, is not.

use std::ops::Range;

use super::places::{Excess, Place};
use super::ripple::ripple_power;

/// Of a wander, no more than this share is a function of any condition.
const MOST_EXPLAINED: f64 = 0.12;
/// And no more than this share lies in a tenth of the log.
const MOST_IN_TENTH: f64 = 0.6;
/// Nor is more than this share one level and one wave, of a period above this, s, seen by means over this time: noise forgets.
const MOST_WAVE: f64 = 0.7;
const QUICKEST_S: f64 = 4.0;
const WINDOW_S: f64 = 0.25;
/// And it is no more than this many times the noise: what is greater needs another cause.
const MOST_WANDER: f64 = 2.0;
/// An excess above this share of the noise's mean square is worth an explanation: the rms is 3 % above the floor.
pub const WORTH: f64 = 0.06;

/// Whether an excess is a wander of the sensors.
pub fn is_wander(excess: &Excess<'_>, places: &[Place]) -> bool {
    excess.share() < MOST_WANDER * MOST_WANDER
        && places.iter().all(|place| place.explains < MOST_EXPLAINED)
        && share_of_tenth(excess) < MOST_IN_TENTH
        && share_of_wave(excess) < MOST_WAVE
}

/// Share of the excess that is one level and one slow wave.
fn share_of_wave(excess: &Excess<'_>) -> f64 {
    let cycle_s = excess.record.cycle_s;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let length = (WINDOW_S / cycle_s).ceil().max(1.0) as usize;
    let mut samples = 0.0;
    let mean = |(window, numbers): (usize, &[f64])| {
        let finite = || numbers.iter().filter(|number| number.is_finite());
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, time_s) = (finite().count() as f64, (window * length) as f64 * cycle_s);
        samples += count;
        (count > 0.0).then(|| (time_s, finite().sum::<f64>() / count))
    };
    let means: Vec<(f64, f64)> = excess.residual_n.chunks(length).enumerate().filter_map(mean).collect();
    #[expect(clippy::cast_precision_loss, reason = "a count of windows")]
    let count = means.len() as f64;
    let level_n = means.iter().map(|(_, mean_n)| mean_n).sum::<f64>() / count;
    let duration_s = count * WINDOW_S;
    let half_waves = std::iter::successors(Some(1.0), |half_waves| Some(half_waves + 0.5));
    let periods_s =
        half_waves.map(|half_waves| 2.0 * duration_s / half_waves).take_while(|period_s| *period_s > QUICKEST_S);
    let wave = periods_s.map(|period_s| ripple_power(&means, period_s)).fold(0.0, f64::max);
    samples / count * (count * level_n * level_n + wave) / excess.sum()
}

/// Share of the excess in the tenth of the blocks that have most of it.
fn share_of_tenth(excess: &Excess<'_>) -> f64 {
    let mut sums: Vec<f64> = excess
        .blocks
        .iter()
        .map(|block| {
            let of_block = excess.residual_n.get(block.cycles.clone()).unwrap_or_default();
            let count = of_block.iter().filter(|number| number.is_finite());
            count.map(|number| number * number - excess.noise_n * excess.noise_n).sum()
        })
        .collect();
    sums.sort_by(|one: &f64, other| other.total_cmp(one));
    let tenth = sums.len().div_ceil(10);
    sums.iter().take(tenth).sum::<f64>() / excess.sum()
}

/// Cycles as stretches, for results.
pub fn ranges(cycles: impl Iterator<Item = bool>) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for (cycle, _) in cycles.enumerate().filter(|(_, wanted)| *wanted) {
        match ranges.last_mut().filter(|range| range.end == cycle) {
            Some(range) => range.end += 1,
            None => ranges.push(cycle..cycle + 1),
        }
    }
    ranges
}
