//! Operating conditions in which the residual exceeds the noise.
//!
//! Two measures are computed for every condition. The first is how much of the excess is a function of the condition, separately for each direction
//! of motion: means over bins of the training samples are tested on the held-out samples, so that chance gains nothing. The second is the range of
//! the condition in which the excess is densest: the training samples choose the range, and the held-out samples tell how much more of the excess
//! than of the samples lies there. The chance level of the first measure comes from residuals shifted in time against the conditions; the uncertainty
//! of the second comes from the scatter over the blocks. Both are valid for residuals with a memory no longer than a block.

use std::ops::Range;

use serde::Serialize;

use crate::fit::CableRecord;
use crate::samples::bins::Bins;
use crate::samples::conditions::{Condition, sign};
use crate::samples::split::Block;

/// Minimum gain in standard errors; a smaller one is chance.
pub const LEAST_SIGNIFICANCE: f64 = 4.0;
/// Minimum concentration in standard errors; a smaller one may be chance.
pub const LEAST_CONCENTRATION: f64 = 3.0;
/// Minimum concentration to report, in standard errors.
const WORTH_TELLING: f64 = 1.0;
/// Minimum difference between a range's fraction of the excess and its fraction of the samples.
const LEAST_MORE: f64 = 0.1;
/// A range with this fraction of the samples is the whole condition, not a place.
pub const WHOLE: f64 = 0.995;
/// Bins beside the densest one belong to it down to this fraction of its density.
const SHOULDER: f64 = 0.4;
/// Number of equal shifts of the residual against the conditions through the log, which give the chance level.
const SHIFTS: usize = 79;
/// Marks a cycle without a value of a condition; beyond the cells of any condition.
const NOWHERE: u16 = u16::MAX;
/// Minimum number of samples in a bin.
const FEWEST_SAMPLES: f64 = 50.0;
/// Maximum number of time intervals to report.
const MOST_INTERVALS: usize = 5;
/// Length of the windows that intervals consist of, s, and the minimum excess of a window relative to the loudest.
const WINDOW_S: f64 = 0.5;
const LOUD: f64 = 0.25;
/// Two intervals closer than this are merged, s.
const MERGED_S: f64 = 0.25;

/// A range of a condition in which the excess is concentrated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// The condition.
    pub signal: &'static str,
    /// Lower end of the range, in `unit`.
    pub from: f64,
    /// Upper end of the range, in `unit`.
    pub to: f64,
    /// The condition's unit.
    pub unit: &'static str,
    /// Least and greatest value of the condition.
    #[serde(skip)]
    pub range: [f64; 2],
    /// Fraction of the excess in this range.
    pub share_of_excess: f64,
    /// Fraction of the samples in this range.
    pub share_of_samples: f64,
    /// Fraction of the excess that is a function of this condition and of the direction of motion.
    pub explains: f64,
    /// Number of standard errors above chance.
    pub significance: f64,
    /// Time intervals to look at, s since the first sample.
    pub intervals_s: Vec<[f64; 2]>,
}

/// A residual whose excess above the noise is to be located.
#[derive(Clone, Copy, Debug)]
pub struct Excess<'a> {
    /// The cable.
    pub record: &'a CableRecord<'a>,
    /// Its blocks.
    pub blocks: &'a [Block],
    /// The residual, N; NaN where a sample does not count.
    pub residual_n: &'a [f64],
    /// Standard deviation of the noise, N.
    pub noise_n: f64,
}

impl Excess<'_> {
    /// Returns the sum of the squares above the noise over all samples, N².
    pub fn sum(&self) -> f64 {
        self.residual_n.iter().filter(|number| number.is_finite()).map(|number| self.of(*number)).sum()
    }

    /// Returns that sum divided by the noise's squares: the relative excess of the mean square.
    pub fn share(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = self.residual_n.iter().filter(|number| number.is_finite()).count() as f64;
        self.sum() / (count * self.noise_n * self.noise_n)
    }

    /// Returns the residuals that count of some cycles, N.
    pub fn of_cycles(&self, cycles: Range<usize>) -> impl Iterator<Item = f64> {
        self.residual_n.get(cycles).unwrap_or_default().iter().copied().filter(|number| number.is_finite())
    }

    fn of(&self, residual_n: f64) -> f64 {
        residual_n * residual_n - self.noise_n * self.noise_n
    }

    /// Returns the conditions that the excess is a function of, the most informative first.
    pub fn places(&self, conditions: &[Condition<'_>]) -> Vec<Place> {
        let mut places: Vec<Place> = conditions.iter().filter_map(|condition| self.place(condition)).collect();
        places.retain(|place| place.significance >= LEAST_SIGNIFICANCE);
        places.sort_by(|one, other| other.explains.total_cmp(&one.explains));
        places
    }

    /// Returns the places to report to people: conditions with a range in which the excess is concentrated, or that the excess is a function of, the
    /// most certain and largest first. The significance is the greater of the two.
    pub fn concentrations(&self, conditions: &[Condition<'_>]) -> Vec<Place> {
        let mut places: Vec<Place> = conditions
            .iter()
            .filter_map(|condition| {
                let place = self.place(condition)?;
                let is_function = place.significance >= LEAST_SIGNIFICANCE && place.share_of_samples < WHOLE;
                let is_dense = place.share_of_excess - place.share_of_samples >= LEAST_MORE;
                let concentration = self.concentration(condition).unwrap_or(0.0);
                let significance = place.significance.max(concentration);
                (is_function || is_dense && significance >= WORTH_TELLING).then_some(Place { significance, ..place })
            })
            .collect();
        let tells = |place: &Place| place.significance * (place.share_of_excess - place.share_of_samples);
        places.sort_by(|one, other| tells(other).total_cmp(&tells(one)));
        places
    }

    /// Returns by how many standard errors the excess in the densest range exceeds the range's fraction of the samples.
    fn concentration(&self, condition: &Condition<'_>) -> Option<f64> {
        let bins = Bins::new(condition, self.residual_n)?;
        let range = self.densest(&bins, condition, |block| !block.held_out)?;
        let sums: Vec<[f64; 4]> = self
            .blocks
            .iter()
            .filter(|block| block.held_out)
            .map(|block| {
                let [mut inside, mut count_inside, mut all, mut count] = [0.0; 4];
                for cycle in block.cycles.clone() {
                    let value = condition.at(cycle);
                    let residual_n = self.residual_n.get(cycle).copied().unwrap_or(f64::NAN);
                    let Some(bin) = bins.of(value).filter(|_| residual_n.is_finite()) else { continue };
                    let excess = self.of(residual_n);
                    (all, count) = (all + excess, count + 1.0);
                    if range.contains(&bin) {
                        (inside, count_inside) = (inside + excess, count_inside + 1.0);
                    }
                }
                [inside, count_inside, all, count]
            })
            .collect();
        let total = |place: usize| sums.iter().map(|sums| sums[place]).sum::<f64>();
        let share_of_samples = total(1) / total(3);
        let more: Vec<f64> = sums.iter().map(|[inside, _, all, _]| inside - share_of_samples * all).collect();
        let (sum, error) = sum_and_error(&more);
        Some(sum / error).filter(|significance| significance.is_finite())
    }

    /// Returns the place in one condition; `None` if there is nothing to compare.
    pub fn place(&self, condition: &Condition<'_>) -> Option<Place> {
        let bins = Bins::new(condition, self.residual_n)?;
        let range = self.densest(&bins, condition, |_| true)?;
        self.place_in(condition, &bins, range)
    }

    /// Returns the same for a range of bins.
    pub fn place_in(&self, condition: &Condition<'_>, bins: &Bins, range: Range<usize>) -> Option<Place> {
        let total = self.sum();
        let (explains, significance) = self.explained(bins, condition);
        let inside = |value: f64| bins.of(value).is_some_and(|bin| range.contains(&bin));
        let (mut share_of_excess, mut count_inside, mut count) = (0.0, 0.0, 0.0);
        for (value, residual_n) in self.samples(condition) {
            count += 1.0;
            if inside(value) {
                share_of_excess += self.of(residual_n) / total;
                count_inside += 1.0;
            }
        }
        Some(Place {
            signal: condition.signal,
            from: *bins.edges.get(range.start)?,
            to: *bins.edges.get(range.end)?,
            unit: condition.unit,
            range: [*bins.edges.first()?, *bins.edges.last()?],
            share_of_excess,
            share_of_samples: count_inside / count,
            explains: explains / total,
            significance,
            intervals_s: self.intervals_s(|cycle| inside(condition.at(cycle))),
        })
    }

    /// Returns the values of a condition with the residual, where both exist.
    fn samples(&self, condition: &Condition<'_>) -> impl Iterator<Item = (f64, f64)> {
        let samples = condition.values().zip(self.residual_n.iter().copied());
        samples.filter(|(value, residual_n)| value.is_finite() && residual_n.is_finite())
    }

    /// Returns the decrease of the sum of squares over all samples by a function of the condition and the direction, and its significance.
    fn explained(&self, bins: &Bins, condition: &Condition<'_>) -> (f64, f64) {
        let mut halves = vec![NOWHERE; self.residual_n.len()];
        for block in self.blocks {
            for cycle in block.cycles.clone() {
                let Some(bin) = bins.of(condition.at(cycle)) else { continue };
                let direction = self.record.rows.get(cycle).map_or(0.0, |row| sign(row.signals.displacement_m));
                let cell = 3 * bin + if direction > 0.0 { 2 } else { usize::from(direction < 0.0) };
                if let Some(of_cycle) = halves.get_mut(cycle) {
                    *of_cycle = u16::try_from(2 * cell + usize::from(block.held_out)).unwrap_or(NOWHERE);
                }
            }
        }
        let found = self.gain_of_means(&halves, 3 * bins.count(), 0);
        let chances: Vec<f64> = (1..=SHIFTS)
            .map(|shift| self.gain_of_means(&halves, 3 * bins.count(), shift * halves.len() / (SHIFTS + 1)))
            .collect();
        (found, significance(found, &chances))
    }

    /// Returns the decrease of the held-out sum of squares by the means over cells of the training samples, scaled to all samples. The residuals are
    /// shifted in time by `shift` cycles. `halves` holds twice the cell of each cycle, plus 1 where the cycle is held out, or [`NOWHERE`].
    fn gain_of_means(&self, halves: &[u16], cell_count: usize, shift: usize) -> f64 {
        let mut sums = vec![[(0.0_f64, 0.0_f64); 2]; cell_count];
        let (later, earlier) = self.residual_n.split_at(shift);
        for (residual_n, half) in earlier.iter().chain(later).zip(halves).filter(|(number, _)| number.is_finite()) {
            let half = usize::from(*half);
            if let Some((sum, count)) = sums.get_mut(half / 2).and_then(|sums| sums.get_mut(half % 2)) {
                (*sum, *count) = (*sum + residual_n, *count + 1.0);
            }
        }
        let (mut gain, mut held_out, mut all) = (0.0, 0.0, 0.0);
        for [(total, known), (sum, count)] in sums {
            all += known + count;
            if known > 0.0 {
                let mean_n = total / known;
                gain += 2.0 * sum * mean_n - count * mean_n * mean_n;
                held_out += count;
            }
        }
        if held_out > 0.0 { gain * all / held_out } else { 0.0 }
    }

    /// Returns the contiguous bins around the one with the highest excess per sample, in some blocks.
    fn densest(&self, bins: &Bins, condition: &Condition<'_>, of: impl Fn(&Block) -> bool) -> Option<Range<usize>> {
        let mut sums = vec![(0.0, 0.0); bins.count()];
        for cycle in self.blocks.iter().filter(|block| of(block)).flat_map(|block| block.cycles.clone()) {
            let bin = bins.of(condition.at(cycle));
            let residual_n = self.residual_n.get(cycle).copied().filter(|number| number.is_finite());
            if let (Some((sum, count)), Some(residual_n)) = (bin.and_then(|bin| sums.get_mut(bin)), residual_n) {
                (*sum, *count) = (*sum + self.of(residual_n), *count + 1.0);
            }
        }
        let density = |bin: usize| {
            let of_bin = sums.get(bin).filter(|(_, count)| *count >= FEWEST_SAMPLES);
            of_bin.map_or(f64::NEG_INFINITY, |(sum, count)| sum / count)
        };
        let best = (0..bins.count()).max_by(|one, other| density(*one).total_cmp(&density(*other)))?;
        let belongs = |bin: usize| density(bin) >= SHOULDER * density(best);
        let (mut from, mut to) = (best, best + 1);
        while from > 0 && belongs(from - 1) {
            from -= 1;
        }
        while to < bins.count() && belongs(to) {
            to += 1;
        }
        Some(from..to)
    }

    /// Returns the time intervals in which the wanted samples have most excess, in the order of time.
    pub fn intervals_s(&self, wanted: impl Fn(usize) -> bool) -> Vec<[f64; 2]> {
        let mut windows: Vec<(Range<f64>, f64)> = Vec::new();
        for (cycle, residual_n) in self.residual_n.iter().enumerate().filter(|(_, number)| number.is_finite()) {
            if !wanted(cycle) {
                continue;
            }
            let time_s = self.record.time_s(cycle);
            let window = (time_s / WINDOW_S).floor();
            match windows.last_mut().filter(|(range, _)| (range.start / WINDOW_S).floor() >= window) {
                Some((range, excess)) => (range.end, *excess) = (time_s, *excess + self.of(*residual_n)),
                None => windows.push((time_s..time_s, self.of(*residual_n))),
            }
        }
        windows.sort_by(|one, other| other.1.total_cmp(&one.1));
        let loudest = windows.first().map_or(0.0, |(_, excess)| *excess);
        windows.retain(|(_, excess)| *excess > LOUD * loudest);
        windows.truncate(MOST_INTERVALS);
        windows.sort_by(|one, other| one.0.start.total_cmp(&other.0.start));
        let mut found: Vec<[f64; 2]> = Vec::new();
        for (range, _) in windows {
            match found.last_mut().filter(|[_, end_s]| range.start - *end_s < MERGED_S) {
                Some([_, end_s]) => *end_s = range.end,
                None => found.push([range.start, range.end]),
            }
        }
        found
    }
}

/// Returns by how many standard deviations a gain exceeds those obtained by chance.
pub fn significance(found: f64, chances: &[f64]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let count = chances.len() as f64;
    let mean = chances.iter().sum::<f64>() / count;
    let scatter = (chances.iter().map(|chance| (chance - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    if scatter > 0.0 { (found - mean) / scatter } else { 0.0 }
}

/// Returns 1 or −1 for a draw and a block, without a pattern that a run could have (`SplitMix64`).
pub fn random_sign(draw: u64, block: usize) -> f64 {
    let mut bits = (draw << 32 | block as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    if (bits ^ (bits >> 31)) & 1 == 1 { 1.0 } else { -1.0 }
}

/// Returns the sum of numbers and its standard error, estimated from their scatter.
pub fn sum_and_error(numbers: &[f64]) -> (f64, f64) {
    #[expect(clippy::cast_precision_loss, reason = "a count of blocks")]
    let count = numbers.len() as f64;
    let sum: f64 = numbers.iter().sum();
    let mean = sum / count;
    let scatter: f64 = numbers.iter().map(|number| (number - mean).powi(2)).sum();
    (sum, if count > 1.0 { (scatter * count / (count - 1.0)).sqrt() } else { f64::INFINITY })
}
