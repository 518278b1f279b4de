//! A section of the cable with more friction than the rest: a kink, a splice, a broken strand.
//!
//! The section resists the motion in both directions while one narrow range of the cable's length passes. Every range of a few bins is tried on the
//! training samples as a constant force against the motion; the best one is tested on the held-out samples. The chance level of the best range comes
//! from random signs of the blocks' residuals.

use super::places::{Excess, Place, random_sign};
use crate::samples::bins::Bins;
use crate::samples::conditions::{Condition, sign};

/// Maximum fraction of the samples in the range,
const NARROW: f64 = 0.2;
/// minimum fraction of the excess that it removes,
const LEAST_SHARE: f64 = 0.25;
/// and number of random draws, each of which it must exceed.
const DRAWS: u64 = 200;
/// Number of bins by which the range is extended beyond the best constant force, because the force fades out there.
const MARGIN_BINS: usize = 2;

/// A section of cable with a local defect: the cycles to leave out, and its position.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Whether each cycle is within the section.
    pub cycles: Vec<bool>,
    /// The position of the section.
    pub place: Place,
}

/// Sums over the bins of one block: residual in the direction of motion, and sample count.
type Sums = Vec<(f64, f64)>;

/// Returns the section of cable with friction of its own, if there is one.
pub fn stretch_of_cable(excess: &Excess<'_>, conditions: &[Condition<'_>]) -> Option<Stretch> {
    let length = conditions.iter().find(|condition| condition.signal == "length")?;
    let bins = Bins::new(length, excess.residual_n)?;
    let blocks: Vec<(bool, Sums)> = excess
        .blocks
        .iter()
        .map(|block| {
            let mut sums = vec![(0.0, 0.0); bins.count()];
            for cycle in block.cycles.clone() {
                let residual_n = excess.residual_n.get(cycle).copied().filter(|number| number.is_finite());
                let bin = bins.of(length.at(cycle));
                let direction = excess.record.rows.get(cycle).map_or(0.0, |row| sign(row.signals.displacement_m));
                if let (Some(residual_n), Some((sum, count))) = (residual_n, bin.and_then(|bin| sums.get_mut(bin))) {
                    (*sum, *count) = (*sum + direction * residual_n, *count + direction.abs());
                }
            }
            (block.held_out, sums)
        })
        .collect();
    let found = best_of(&blocks, |_| 1.0)?;
    let by_chance =
        |draw: u64| best_of(&blocks, |block| random_sign(draw, block)).is_some_and(|best| best.gain >= found.gain);
    if found.gain < LEAST_SHARE * excess.sum() || (1..=DRAWS).any(by_chance) {
        return None;
    }
    let (from, to) = (found.from.saturating_sub(MARGIN_BINS), (found.to + MARGIN_BINS).min(bins.count()));
    let range = *bins.edges.get(from)?..=*bins.edges.get(to)?;
    // Cycles at rest within the section count too, because the presliding state stores its friction.
    let cycles = excess.record.rows.iter().map(|row| range.contains(&row.signals.length_m)).collect();
    let place = excess.place_in(length, &bins, from..to)?;
    Some(Stretch { cycles, place })
}

/// A range of bins.
struct Found {
    from: usize,
    to: usize,
    /// Decrease of the sum of squares over all samples, N².
    gain: f64,
}

/// Returns the best range on the training blocks, with its gain on the held-out blocks scaled to all samples. The residuals of each block are
/// multiplied by `flip`.
fn best_of(blocks: &[(bool, Sums)], flip: impl Fn(usize) -> f64) -> Option<Found> {
    let bins = blocks.first()?.1.len();
    // Cumulative sums over the bins, for the training blocks and the held-out blocks, so that any range is a difference.
    let mut up_to = [vec![(0.0, 0.0); bins + 1], vec![(0.0, 0.0); bins + 1]];
    for (place, (held_out, sums)) in blocks.iter().enumerate() {
        let mut all = (0.0, 0.0);
        for ((sum, count), total) in sums.iter().zip(up_to[usize::from(*held_out)].iter_mut().skip(1)) {
            all = (all.0 + flip(place) * sum, all.1 + count);
            *total = (total.0 + all.0, total.1 + all.1);
        }
    }
    let within = |of: usize, from: usize, to: usize| {
        let (low, high) = (up_to[of][from], up_to[of][to]);
        (high.0 - low.0, high.1 - low.1)
    };
    let samples = |of: usize| up_to[of][bins].1;
    let mut best: Option<(f64, usize, usize)> = None;
    for from in 0..bins {
        for to in from + 1..=bins {
            let (sum, count) = within(0, from, to);
            if count > NARROW * samples(0) {
                break;
            }
            let learned = if count > 0.0 { sum * sum / count } else { 0.0 };
            if best.is_none_or(|(most, ..)| learned > most) {
                best = Some((learned, from, to));
            }
        }
    }
    let (_, from, to) = best.filter(|_| samples(0) > 0.0 && samples(1) > 0.0)?;
    let ((sum, count), (other_sum, other_count)) = (within(0, from, to), within(1, from, to));
    let mean_n = if count > 0.0 { sum / count } else { 0.0 };
    let gain = (2.0 * other_sum * mean_n - other_count * mean_n * mean_n) * (samples(0) + samples(1)) / samples(1);
    Some(Found { from, to, gain })
}
