//! Classifies the rest after naming: drift of the sensors, or something without a name.
//!
//! Sensor drift is noise. It continues while the cable rests and is spread over the log. A rest is not drift if it changes with the motion or the
//! load, is a function of a condition, is concentrated in a narrow stretch of time, or is many times the noise.

pub mod empirical;
pub mod neighbours;
pub mod places;
pub mod stretch;

use std::ops::Range;

use fric_core::parameters::{MU, SIGMA};

use self::places::{Excess, Place};
use crate::candidates::ripple::ripple_power;
use crate::fit::{CableRecord, Row};

/// Maximum fraction of a drift that lies in one tenth of the log.
const MOST_IN_TENTH: f64 = 0.6;
/// Maximum fraction of a drift that is one level and one wave with a period above this value, s, computed from means over this time. Noise has no
/// such long memory.
const MOST_WAVE: f64 = 0.7;
const QUICKEST_S: f64 = 4.0;
const WINDOW_S: f64 = 0.25;
/// Maximum ratio of a drift to the noise. A greater one needs another cause.
const MOST_WANDER: f64 = 2.0;
/// Windows over which slow changes are computed, s; shorter than the memory of a drift.
const CHANGE_S: f64 = 0.1;
/// Minimum number of windows for a mean.
const FEWEST_QUIET: usize = 16;
/// Changes with and without motion count as equal up to this many standard deviations of chance.
const LEAST_RANKS_APART: f64 = 3.0;
/// Time constants with which a creeping cable or mount follows its load, s. Two lags that differ by a factor of two are hardly told apart, so three,
/// each four times the one before, do for a second to half a minute.
pub const CREEP_S: [f64; 3] = [1.0, 4.0, 16.0];
/// Widths of hysteresis over the load, as fractions of its standard deviation. For a sensor with hystereses of several widths, with 0.1 to 0.8 of it, half
/// of the deviation explains 93 % of the rest, a quarter 82 %, all of it 65 %.
const WIDTH_RATIOS: [f64; 4] = [0.125, 0.25, 0.5, 1.0];
/// Number of equal shifts of the residual against a signal through the log, which give the chance level.
const SHIFTS: usize = 80;
/// Minimum excess, as a fraction of the noise variance, that needs an explanation. The rms is then 5 % above the floor.
pub const WORTH: f64 = 0.1;

/// Returns the mean square of the sensors' drift in an excess, as a fraction of the noise variance. `places` are the conditions that the excess is a
/// function of.
pub fn wander(excess: &Excess<'_>, places: &[Place]) -> f64 {
    let is_wander = excess.share() < MOST_WANDER * MOST_WANDER
        && places.is_empty()
        && share_of_tenth(excess) < MOST_IN_TENTH
        && share_of_wave(excess) < MOST_WAVE;
    if is_wander { excess.share() * (1.0 - share_of_motion(excess).max(share_of_past(excess))) } else { 0.0 }
}

/// Returns the fraction of the excess that follows what the load has been; zero where this may be chance.
///
/// Such a rest goes on while the cable rests, as a drift does, and no condition of the moment tells it. Two kinds are compared:
///
/// - Creep: a cable that creeps under its load `F` by `x`, with `τ·dx/dt = F − x`, moves its contacts, which store friction in proportion; a motion by
///   the presliding distance `d` makes them forget it. So with the way `l` of the cable the stored part is `dc = dx − c·|dl|/d`.
/// - Hysteresis, as a sensor has it: the load's last changes up to a width. Sensor and reference must both show it, because a drift of either is part of
///   its own past.
fn share_of_past(excess: &Excess<'_>) -> f64 {
    let record = excess.record;
    let over_load = |force_n: &dyn Fn(usize) -> f64| {
        let deviation_n = deviation((0..record.rows.len()).map(force_n));
        share_above_chance(excess, &WIDTH_RATIOS.map(|ratio| stopped(record, force_n, ratio * deviation_n)))
    };
    let sensor_n = |cycle: usize| record.rows.get(cycle).map_or(f64::NAN, |row| row.signals.sensor_force_n);
    let load = over_load(&sensor_n).min(over_load(&|cycle| record.reference_n(cycle)));
    load.max(share_above_chance(excess, &CREEP_S.map(|lag_s| crept(record, lag_s).collect())))
}

/// Returns the standard deviation of the finite numbers.
fn deviation(numbers: impl Iterator<Item = f64>) -> f64 {
    let [mut count, mut sum, mut squares] = [0.0_f64; 3];
    for number in numbers.filter(|number| number.is_finite()) {
        count += 1.0;
        sum += number;
        squares += number * number;
    }
    (squares / count - (sum / count).powi(2)).max(0.0).sqrt()
}

/// Returns the greatest fraction of the excess that is a multiple of one of these signals; zero where it may be chance. The chance level is the greatest
/// fraction for residuals shifted in time against the signals.
fn share_above_chance(excess: &Excess<'_>, signals: &[Vec<f64>]) -> f64 {
    let count = excess.residual_n.len();
    let greatest = |shift: usize| {
        let residual_n = || excess.residual_n.iter().cycle().skip(shift * count / SHIFTS).take(count);
        signals.iter().map(|signal| common_squares(residual_n(), signal)).fold(0.0, f64::max)
    };
    let squares = greatest(0);
    if (1..SHIFTS).any(|shift| greatest(shift) >= squares) { 0.0 } else { (squares / excess.sum()).min(1.0) }
}

/// Returns how far a quantity has moved before each cycle, at most by a width from where it turned last: the stop operator (A. Visintin, *Differential
/// Models of Hysteresis*, Springer 1994, III.2). The cycle itself is left out, because its noise is in the residual too.
fn stopped(record: &CableRecord<'_>, value: &dyn Fn(usize) -> f64, width: f64) -> Vec<f64> {
    let mut stopped = Vec::with_capacity(record.rows.len());
    for (start, rows) in record.logs() {
        let (mut moved, mut last) = (0.0_f64, f64::NAN);
        for cycle in start..start + rows.len() {
            stopped.push(moved);
            let now = value(cycle);
            if now.is_finite() {
                moved = if last.is_finite() { (moved + now - last).clamp(-width, width) } else { 0.0 };
                last = now;
            }
        }
    }
    stopped
}

/// Returns the part of the sensor force that contacts have stored from a creep with this time constant, N in each cycle: see [`share_of_past`].
pub fn crept<'a>(record: &CableRecord<'a>, lag_s: f64) -> impl Iterator<Item = f64> + use<'a> {
    let values = record.params.values();
    let presliding_m_per_n = record.params.memory_m_per_n(values[MU], values[SIGMA]);
    let follows = -libm::expm1(-record.interval_s / lag_s);
    record.logs().flat_map(move |(_, rows)| {
        let (mut followed_n, mut stored_n) = (f64::NAN, 0.0);
        rows.iter().map(move |row| {
            let force_n = row.signals.sensor_force_n;
            if !followed_n.is_finite() {
                followed_n = force_n;
            }
            if force_n.is_finite() {
                let step_n = follows * (force_n - followed_n);
                let way_m = row.signals.displacement_m.abs();
                followed_n += step_n;
                stored_n += step_n;
                if way_m > 0.0 {
                    stored_n *= libm::exp(-way_m / (presliding_m_per_n * force_n).max(f64::MIN_POSITIVE));
                }
            }
            stored_n
        })
    })
}

/// Returns how much of a residual's squares, N², is a multiple of a signal, apart from the means of both, over the samples that have a residual.
fn common_squares<'a>(residual_n: impl Iterator<Item = &'a f64>, signal: &[f64]) -> f64 {
    let mut sums = [0.0; 5];
    for (residual_n, signal) in residual_n.zip(signal).filter(|(residual_n, _)| residual_n.is_finite()) {
        let of_sample = [1.0, *residual_n, *signal, residual_n * signal, signal * signal];
        sums.iter_mut().zip(of_sample).for_each(|(sum, of_sample)| *sum += of_sample);
    }
    let [count, residuals, signals, products, squares] = sums;
    let covariance = products - residuals * signals / count;
    let variance = squares - signals * signals / count;
    if variance > 0.0 { covariance * covariance / variance } else { 0.0 }
}

/// Returns the fraction of a residual's slow changes that comes with motion of the cable or a change of its load.
///
/// Means over windows of [`CHANGE_S`] differ from one window to the next by white noise, by the drift, and by the model's errors in motion and load.
/// The white noise is known. The drift is the same in all windows. The model's errors vanish in windows in which neither motion nor load changes, so
/// the mean square in these windows gives the drift. A difference that may be chance counts as none: a Mann-Whitney test compares the ranks of both
/// kinds of windows.
fn share_of_motion(excess: &Excess<'_>) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let length = (CHANGE_S / excess.record.interval_s).ceil().max(1.0) as usize;
    let mut changes: Vec<Change> = Vec::new();
    for (start, rows) in excess.record.logs() {
        let windows: Vec<Window> = rows
            .chunks_exact(length)
            .enumerate()
            .map(|(place, rows)| {
                let from = start + place * length;
                Window::of(rows, excess.residual_n.get(from..from + length).unwrap_or_default())
            })
            .collect();
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
    #[expect(clippy::cast_precision_loss, reason = "counts of windows")]
    let mean = |of: &[&Change]| of.iter().map(|change| change.square).sum::<f64>() / of.len() as f64;
    let (of_quiet, of_all) = (mean(&quiet), mean(&changes.iter().collect::<Vec<_>>()));
    if !(ranks_apart(&quiet, &busy) > LEAST_RANKS_APART && of_all > 0.0) {
        return with_motion;
    }
    (1.0 - of_quiet.max(0.0) / of_all).clamp(with_motion, 1.0)
}

/// A short window of a log.
struct Window {
    mean_n: f64,
    count: f64,
    way_m: f64,
    length_m: f64,
    load_n: f64,
}

impl Window {
    /// Creates the window from rows with their residual. It has no mean if half of the residual is missing.
    fn of(rows: &[Row], residual_n: &[f64]) -> Self {
        let finite = || residual_n.iter().filter(|number| number.is_finite());
        #[expect(clippy::cast_precision_loss, reason = "small counts")]
        let (count, all) = (finite().count() as f64, rows.len() as f64);
        Self {
            mean_n: if 2.0 * count > all { finite().sum::<f64>() / count } else { f64::NAN },
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
    let [mut squares, mut others, mut products, mut count] = [0.0_f64; 4];
    for change in changes {
        let number = other(change);
        squares += change.residual_n * change.residual_n;
        others += number * number;
        products += change.residual_n * number;
        count += 1.0;
    }
    let share = products * products / (squares * others);
    if share * count > LEAST_RANKS_APART * LEAST_RANKS_APART { share } else { 0.0 }
}

/// Returns by how many standard deviations of chance the changes of the first kind rank below those of the second.
fn ranks_apart(low: &[&Change], high: &[&Change]) -> f64 {
    let mut all: Vec<(f64, bool)> = low.iter().map(|change| (change.square, true)).collect();
    all.extend(high.iter().map(|change| (change.square, false)));
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

/// Returns the fraction of the excess in the tenth of the blocks that contains most of it.
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

/// Returns the samples that count, and the sound samples between two of them, which lie on the line from one measurement to the next.
pub fn with_interpolated(counts: &[bool], measured: &[bool], is_sound: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut all = counts.to_vec();
    let mut before = 0;
    for (place, counts_too) in counts.iter().enumerate().filter(|(place, _)| measured.get(*place) == Some(&true)) {
        let is_between = *counts_too && counts.get(before) == Some(&true);
        let between = before + 1..place;
        before = place;
        if is_between && let Some(all) = all.get_mut(between.clone()) {
            all.iter_mut().zip(between).for_each(|(counts, place)| *counts = is_sound(place));
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
