//! What is left when all names are given: noise that wanders, or something that has no name.
//!
//! A sensor's wander is noise: it has nothing to do with what the cable does and is spread over the log. What is a
//! function of a condition, or sits in a narrow stretch of the cable or of time, is not.

use std::ops::Range;

use super::conditions::Condition;
use super::places::{Excess, Place};

/// Of a wander, no more than this share is a function of any condition.
const MOST_EXPLAINED: f64 = 0.12;
/// And no more than this share lies in a tenth of the log.
const MOST_IN_TENTH: f64 = 0.6;
/// Nor is more than this share still there in the mean over this part of the log: noise forgets, a level does not.
const MOST_LASTING: f64 = 0.6;
const LASTING_PARTS: usize = 16;
/// A narrow stretch of cable holds at most this share of the samples and at least that of the excess.
const NARROW: f64 = 0.2;
const MOST_OF_IT: f64 = 0.5;
/// An excess above this share of the noise's mean square is worth an explanation: the rms is 3 % above the floor.
pub const WORTH: f64 = 0.06;

/// Whether an excess is a wander of the sensors.
pub fn is_wander(excess: &Excess<'_>, places: &[Place]) -> bool {
    places.iter().all(|place| place.explains < MOST_EXPLAINED)
        && share_of_tenth(excess) < MOST_IN_TENTH
        && lasting_share(excess) < MOST_LASTING
}

/// Share of the excess that is in the means over equal parts of the log.
fn lasting_share(excess: &Excess<'_>) -> f64 {
    let length = excess.residual_n.len().div_ceil(LASTING_PARTS).max(1);
    let of_part = |part: &[f64]| -> f64 {
        let (sum, count) = part
            .iter()
            .filter(|number| number.is_finite())
            .fold((0.0, 0.0), |(sum, count), number| (sum + number, count + 1.0));
        if count > 0.0 { sum * sum / count - excess.noise_n * excess.noise_n } else { 0.0 }
    };
    excess.residual_n.chunks(length).map(of_part).sum::<f64>() / excess.sum()
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

/// A narrow stretch of cable or of time that holds most of an excess: cycles to leave out, and where it is.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Which cycles.
    pub cycles: Vec<bool>,
    /// Where.
    pub place: Place,
}

/// The stretch of cable in which most of an excess sits, if it is narrow.
pub fn stretch_of_cable(excess: &Excess<'_>, conditions: &[Condition]) -> Option<Stretch> {
    let length = conditions.iter().find(|condition| condition.signal == "length")?;
    let place = excess.place(length)?;
    let is_narrow = place.share_of_samples < NARROW && place.share_of_excess > MOST_OF_IT;
    let range = place.from..=place.to;
    is_narrow.then(|| Stretch { cycles: length.values.iter().map(|value| range.contains(value)).collect(), place })
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
