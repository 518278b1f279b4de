//! Classifies the rest after naming: drift of the sensors, or something without a name.
//!
//! Sensor drift is noise. It continues while the cable rests and is spread over the log. A rest is not drift if it changes with the motion or the
//! load, is a function of a condition, is louder at some times than at others, or is many times the noise. Nor is it if it follows the past of the
//! load ([`past`]) or goes with its rate, or is what friction of another law leaves ([`drift`], [`contacts`]).

pub mod contacts;
pub mod drift;
pub mod empirical;
pub mod neighbours;
pub mod past;
pub mod places;
pub mod stretch;

use std::ops::Range;

use self::drift::Drift;
use self::past::share_of_past;
use self::places::{Excess, Place};
use crate::candidates::ripple::ripple_power;
use crate::fit::Row;

/// Maximum fraction of a drift that is one level and one wave with a period above this value, s, computed from means over this time. Noise has no
/// such long memory.
const MOST_WAVE: f64 = 0.7;
const QUICKEST_S: f64 = 4.0;
const WINDOW_S: f64 = 0.25;
/// Maximum ratio of a drift to the noise, white and smoothed by an amplifier. A greater one needs another cause.
const MOST_WANDER: f64 = 2.0;
/// Windows over which slow changes are computed, s; shorter than the memory of a drift.
const CHANGE_S: f64 = 0.1;
/// Minimum number of windows for a mean.
const FEWEST_QUIET: usize = 16;
/// Changes with and without motion count as equal up to this many standard deviations of chance.
const LEAST_RANKS_APART: f64 = 3.0;
/// Minimum excess, as a fraction of the noise variance, that needs an explanation. The rms is then 5 % above the floor.
pub const WORTH: f64 = 0.1;

/// Returns the mean square of the sensors' drift in an excess, as a fraction of the noise variance, with the drift; `None` if there is none. `places` are
/// the conditions that the excess is a function of.
pub fn wander<'e, 'a>(excess: &'e Excess<'a>, places: &[Place]) -> Option<(f64, Drift<'e, 'a>)> {
    let share = excess.share();
    if share <= WORTH || !places.is_empty() || share_of_wave(excess) >= MOST_WAVE {
        return None;
    }
    let [quick, quick_of_motion] = quick_shares(excess);
    let smoothed = share * quick * (1.0 - quick_of_motion);
    if share - smoothed >= MOST_WANDER * MOST_WANDER * (1.0 + smoothed) {
        return None;
    }
    let drift = Drift::of(excess)?;
    let of_cable = share_of_motion(excess).max(share_of_rate(excess)).max(share_of_past(excess));
    let slow = share * (1.0 - quick) * (1.0 - of_cable);
    let wander = (slow + smoothed) * drift.steady_share();
    (wander > 0.0).then_some((wander, drift))
}

/// Returns the fraction of a residual's slow changes that comes with motion of the cable or a change of its load.
///
/// Means over windows of [`CHANGE_S`] differ from one window to the next by white noise, by the drift, and by the model's errors in motion and load.
/// The white noise is known. The drift is the same in all windows. The model's errors vanish in windows in which neither motion nor load changes, so
/// the mean square in these windows gives the drift. A difference that may be chance counts as none: a Mann-Whitney test compares the ranks of both
/// kinds of windows.
fn share_of_motion(excess: &Excess<'_>) -> f64 {
    let mut changes: Vec<Change> = Vec::new();
    for windows in windows(excess) {
        changes.extend(windows.windows(2).filter_map(|pair| {
            let [one, next] = pair else { return None };
            let noise = excess.noise_n * excess.noise_n * (1.0 / one.count + 1.0 / next.count);
            let change = Change {
                residual_n: next.mean_n - one.mean_n,
                square: (next.mean_n - one.mean_n).powi(2) - noise,
                way_m: one.way_m + next.way_m,
                length_m: next.length_m - one.length_m,
                load_n: next.load_n - one.load_n,
            };
            change.square.is_finite().then_some(change)
        }));
    }
    // Takes the quietest quarter of the quarter with the least motion, but at least as many windows as a mean needs.
    let mut all: Vec<&Change> = changes.iter().collect();
    all.sort_by(|one, other| one.way_m.total_cmp(&other.way_m));
    let moves = all.split_off((all.len() / 4).max(FEWEST_QUIET).min(all.len()));
    // Even the small motion of a winch that holds a force reveals what the model misses.
    let with_motion =
        correlated_share(&all, |change| change.length_m).max(correlated_share(&all, |change| change.load_n));
    all.sort_by(|one, other| one.load_n.abs().total_cmp(&other.load_n.abs()));
    let loaded = all.split_off((all.len() / 4).max(FEWEST_QUIET).min(all.len()));
    let (quiet, busy) = (all, [moves, loaded].concat());
    let squares = |of: &[&Change]| -> Vec<f64> { of.iter().map(|change| change.square).collect() };
    let (quiet, busy) = (squares(&quiet), squares(&busy));
    let (of_quiet, of_all) = (mean(&quiet), mean(&changes.iter().map(|change| change.square).collect::<Vec<_>>()));
    if !(ranks_apart(&quiet, &busy) > LEAST_RANKS_APART && of_all > 0.0) {
        return with_motion;
    }
    (1.0 - of_quiet.max(0.0) / of_all).clamp(with_motion, 1.0)
}

/// Returns the fraction of a residual's slow changes that goes with the rate of the load, as what a lag or a delay leaves; zero where this may be chance.
/// The rate of a window is computed from its neighbours, so that its product with noise or drift of the sensor, which is in both signals, is zero on average.
fn share_of_rate(excess: &Excess<'_>) -> f64 {
    let mut sums = Sums::default();
    let mut without_noise = 0.0;
    for windows in windows(excess) {
        for around in windows.windows(4) {
            let [before, one, next, after] = around else { continue };
            let change_n = next.mean_n - one.mean_n;
            let noise = excess.noise_n * excess.noise_n * (1.0 / one.count + 1.0 / next.count);
            let rate_change_n = 0.5 * (after.load_n - next.load_n - one.load_n + before.load_n);
            if (change_n * rate_change_n * noise).is_finite() {
                sums.add(change_n, rate_change_n);
                without_noise += change_n * change_n - noise;
            }
        }
    }
    if sums.is_correlated() { (sums.explained() / without_noise.max(sums.explained())).clamp(0.0, 1.0) } else { 0.0 }
}

/// Returns the fraction of the excess that changes within windows of [`CHANGE_S`], and the fraction of this that comes with motion. The noise of an
/// amplifier that smooths is quick too, but as large at rest as in motion.
fn quick_shares(excess: &Excess<'_>) -> [f64; 2] {
    let logs = windows(excess);
    let mut all: Vec<&Window> = logs.iter().flatten().filter(|window| window.quick.is_finite()).collect();
    all.sort_by(|one, other| one.way_m.total_cmp(&other.way_m));
    let busy = all.split_off((all.len() / 4).max(FEWEST_QUIET).min(all.len()));
    let squares = |of: &[&Window]| -> Vec<f64> { of.iter().map(|window| window.quick).collect() };
    let (quiet, busy) = (squares(&all), squares(&busy));
    let whole = [&quiet[..], &busy].concat();
    let share = (whole.iter().sum::<f64>() / excess.sum()).clamp(0.0, 1.0);
    let is_of_motion = ranks_apart(&quiet, &busy) > LEAST_RANKS_APART && share > 0.0;
    [share, if is_of_motion { (1.0 - mean(&quiet).max(0.0) / mean(&whole)).clamp(0.0, 1.0) } else { 0.0 }]
}

/// Returns the windows of [`CHANGE_S`] of each log.
fn windows(excess: &Excess<'_>) -> Vec<Vec<Window>> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let length = (CHANGE_S / excess.record.interval_s).ceil().max(1.0) as usize;
    let of_log = |(start, rows): (usize, &[Row])| {
        let of_chunk = |(place, rows): (usize, &[Row])| {
            let from = start + place * length;
            Window::of(rows, excess.residual_n.get(from..from + length).unwrap_or_default(), excess.noise_n)
        };
        rows.chunks_exact(length).enumerate().map(of_chunk).collect()
    };
    excess.record.logs().map(of_log).collect()
}

/// Returns the mean of some numbers.
fn mean(of: &[f64]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count of windows")]
    let count = of.len() as f64;
    of.iter().sum::<f64>() / count
}

/// A short window of a log.
struct Window {
    mean_n: f64,
    /// Squares about the mean less those of white noise, N².
    quick: f64,
    count: f64,
    way_m: f64,
    length_m: f64,
    load_n: f64,
}

impl Window {
    /// Creates the window from rows with their residual. It has no mean if half of the residual is missing.
    fn of(rows: &[Row], residual_n: &[f64], noise_n: f64) -> Self {
        let finite = || residual_n.iter().filter(|number| number.is_finite());
        #[expect(clippy::cast_precision_loss, reason = "small counts")]
        let (count, all) = (finite().count() as f64, rows.len() as f64);
        let mean_n = if 2.0 * count > all { finite().sum::<f64>() / count } else { f64::NAN };
        Self {
            mean_n,
            quick: finite().map(|number| (number - mean_n).powi(2)).sum::<f64>() - (count - 1.0) * noise_n * noise_n,
            count,
            way_m: rows.iter().map(|row| row.signals.displacement_m.abs()).sum(),
            length_m: rows.iter().map(|row| row.signals.length_m).sum::<f64>() / all,
            load_n: rows.iter().map(|row| row.signals.sensor_force_n).sum::<f64>() / all,
        }
    }
}

/// The change from one window to the next.
struct Change {
    /// Change of the mean residual, N.
    residual_n: f64,
    /// Squared change of the mean residual minus the contribution of white noise, N².
    square: f64,
    way_m: f64,
    /// Change of the mean length, m.
    length_m: f64,
    load_n: f64,
}

/// Returns the fraction of a residual's squared changes that correlates with another change; zero where this may be chance.
fn correlated_share(changes: &[&Change], other: fn(&Change) -> f64) -> f64 {
    let mut sums = Sums::default();
    for change in changes {
        sums.add(change.residual_n, other(change));
    }
    if sums.is_correlated() { sums.explained() / sums.squares } else { 0.0 }
}

/// Sums over the changes of a residual, N, and another change in its own unit.
#[derive(Default)]
struct Sums {
    squares: f64,
    others: f64,
    products: f64,
    count: f64,
}

impl Sums {
    fn add(&mut self, change_n: f64, other: f64) {
        self.squares += change_n * change_n;
        self.others += other * other;
        self.products += change_n * other;
        self.count += 1.0;
    }

    /// Returns the squares that go with the other change, N².
    fn explained(&self) -> f64 {
        self.products * self.products / self.others
    }

    /// Whether the two correlate by more than chance gives.
    fn is_correlated(&self) -> bool {
        self.explained() * self.count > LEAST_RANKS_APART * LEAST_RANKS_APART * self.squares
    }
}

/// Returns by how many standard deviations of chance the numbers of the first kind rank below those of the second.
fn ranks_apart(low: &[f64], high: &[f64]) -> f64 {
    let mut all: Vec<(f64, bool)> = low.iter().map(|number| (*number, true)).collect();
    all.extend(high.iter().map(|number| (*number, false)));
    all.sort_by(|one, other| one.0.total_cmp(&other.0));
    #[expect(clippy::cast_precision_loss, reason = "counts of windows")]
    let (of_low, of_high) = (low.len() as f64, high.len() as f64);
    #[expect(clippy::cast_precision_loss, reason = "counts of windows")]
    let ranks: f64 = all.iter().enumerate().filter(|(_, (_, is_low))| *is_low).map(|(rank, _)| rank as f64 + 1.0).sum();
    let expected = of_low * (of_low + of_high + 1.0) / 2.0;
    (expected - ranks) / (of_low * of_high * (of_low + of_high + 1.0) / 12.0).sqrt()
}

/// Returns the fraction of the excess that is one level and one slow wave.
fn share_of_wave(excess: &Excess<'_>) -> f64 {
    let interval_s = excess.record.interval_s;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let length = (WINDOW_S / interval_s).ceil().max(1.0) as usize;
    let mut samples = 0.0;
    let mean = |(window, numbers): (usize, &[f64])| {
        let finite = || numbers.iter().filter(|number| number.is_finite());
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, time_s) = (finite().count() as f64, (window * length) as f64 * interval_s);
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

/// Returns the samples that count, and those between two of them that can be compared, which lie on the line from one measurement to the next.
pub fn with_interpolated(counts: &[bool], measured: &[bool], comparable: &[bool]) -> Vec<bool> {
    let mut all = counts.to_vec();
    let mut before = 0;
    for (place, counts_too) in counts.iter().enumerate().filter(|(place, _)| measured.get(*place) == Some(&true)) {
        let is_between = *counts_too && counts.get(before) == Some(&true);
        let between = before + 1..place;
        before = place;
        if is_between && let Some((all, comparable)) = all.get_mut(between.clone()).zip(comparable.get(between)) {
            all.copy_from_slice(comparable);
        }
    }
    all
}

/// Converts a flag per cycle into ranges of cycles.
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
