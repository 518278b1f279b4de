//! A piece of the cable that rubs where the rest does not: a kink, a splice, a broken strand.
//!
//! It resists the motion, one way and the other, while one narrow stretch of the cable's length passes. Every stretch of a few
//! bins is tried on the samples learned from as a force of constant size against the motion; the best of them is tried on those
//! held out. The signs of the blocks' residuals drawn at random tell what the best of so many stretches gains by chance.

use super::places::{Excess, Place, random_sign};
use crate::samples::bins::Bins;
use crate::samples::conditions::{Condition, sign};

/// A stretch holds no more than this share of the samples,
const NARROW: f64 = 0.2;
/// takes away at least this share of the excess,
const LEAST_SHARE: f64 = 0.25;
/// and more than it does in any of so many draws.
const DRAWS: u64 = 200;
/// It reaches this many bins further than where the constant force fits best: it fades out there.
const MARGIN_BINS: usize = 2;

/// A stretch of cable with trouble of its own: cycles to leave out, and where it is.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Which cycles.
    pub cycles: Vec<bool>,
    /// Where.
    pub place: Place,
}

/// What the bins of one block hold: residual in the direction of motion, and samples.
type Sums = Vec<(f64, f64)>;

/// The stretch of cable that rubs for itself, if there is one.
pub fn stretch_of_cable(excess: &Excess<'_>, conditions: &[Condition]) -> Option<Stretch> {
    let length = conditions.iter().find(|condition| condition.signal == "length")?;
    let bins = Bins::new(length, excess.residual_n)?;
    let blocks: Vec<(bool, Sums)> = excess
        .blocks
        .iter()
        .map(|block| {
            let mut sums = vec![(0.0, 0.0); bins.count()];
            for cycle in block.cycles.clone() {
                let residual_n = excess.residual_n.get(cycle).copied().filter(|number| number.is_finite());
                let bin = length.values.get(cycle).and_then(|value| bins.of(*value));
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
    // A cable that rests there too: it stores what rubbed.
    let cycles = excess.record.rows.iter().map(|row| range.contains(&row.signals.length_m)).collect();
    let place = excess.place_in(length, &bins, from..to)?;
    Some(Stretch { cycles, place })
}

/// A stretch of bins.
struct Found {
    from: usize,
    to: usize,
    /// What it takes away of the squares of all samples, N².
    gain: f64,
}

/// The stretch that is best on the blocks learned from, with its gain on those held out in proportion to all; the residuals of each
/// block times `flip`.
fn best_of(blocks: &[(bool, Sums)], flip: impl Fn(usize) -> f64) -> Option<Found> {
    let bins = blocks.first()?.1.len();
    // Sums up to each bin, so that any stretch is a difference: of the blocks learned from, and of those held out.
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
