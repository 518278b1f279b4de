//! What follows the past of the load: creep and hysteresis.

use fric_core::parameters::{MU, SIGMA, Values};

use super::places::Excess;
use crate::fit::CableRecord;

/// Time constants with which a creeping cable or mount follows its load, s. Two lags that differ by a factor of two are hardly told apart, so three,
/// each four times the one before, do for a second to half a minute.
pub const CREEP_S: [f64; 3] = [1.0, 4.0, 16.0];
/// Widths of hysteresis over the load, as fractions of its standard deviation. For a sensor with hystereses of several widths, with 0.1 to 0.8 of it, half
/// of the deviation explains 93 % of the rest, a quarter 82 %, all of it 65 %.
const WIDTH_RATIOS: [f64; 4] = [0.125, 0.25, 0.5, 1.0];
/// Number of equal shifts of the residual against a signal through the log, which give the chance level.
const SHIFTS: usize = 80;

/// Returns the fraction of the excess that follows what the load has been; zero where this may be chance.
///
/// Such a rest goes on while the cable rests, as a drift does, and no condition of the moment tells it. Two kinds are compared:
///
/// - Creep: a cable that creeps under its load `F` by `x`, with `τ·dx/dt = F − x`, moves its contacts, which store friction in proportion; a motion by
///   the presliding distance `d` makes them forget it. So with the way `l` of the cable the stored part is `dc = dx − c·|dl|/d`.
/// - Hysteresis, as a sensor has it: the load's last changes up to a width. Sensor and reference must both show it, because a drift of either is part of
///   its own past.
pub fn share_of_past(excess: &Excess<'_>) -> f64 {
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
    let follows = -libm::expm1(-record.interval_s / lag_s);
    stored(record, &record.params.values(), move |_, _, ahead_n| [follows * ahead_n; 2])
}

/// Returns the part of the friction that contacts have stored from changes of the load, N in each cycle, if a contact at rest keeps its ratio of friction
/// to load and not its friction. `friction_n` is the friction in a cycle. The contacts of the model keep their friction (paper on cable robots, eq. 12);
/// those of `load_release` let it go where the load falls.
pub fn loaded<'a, F: Fn(usize) -> f64 + Clone>(
    record: &CableRecord<'a>,
    values: &Values,
    friction_n: F,
) -> impl Iterator<Item = f64> + use<'a, F> {
    let of_load = move |cycle, force_n: f64, ahead_n: f64| {
        let stored_n = ahead_n * friction_n(cycle) / force_n;
        [ahead_n, if stored_n.is_finite() { stored_n } else { 0.0 }]
    };
    stored(record, values, of_load)
}

/// Returns what contacts store from changes of the load beside those of the model, N in each cycle. They forget it over their presliding distance. `step`
/// gets the cycle, the load and how far it is ahead of the load that was followed, and returns by how much that follows and how much is stored. What the
/// cycle itself stores is left out, because its noise is in the residual too.
fn stored<'a, S: Fn(usize, f64, f64) -> [f64; 2] + Clone>(
    record: &CableRecord<'a>,
    values: &Values,
    step: S,
) -> impl Iterator<Item = f64> + use<'a, S> {
    let presliding_m_per_n = record.params.memory_m_per_n(values[MU], values[SIGMA]);
    record.logs().flat_map(move |(start, rows)| {
        let step = step.clone();
        let (mut followed_n, mut stored_n) = (f64::NAN, 0.0_f64);
        rows.iter().enumerate().map(move |(place, row)| {
            let force_n = row.signals.sensor_force_n;
            if !followed_n.is_finite() {
                followed_n = force_n;
            }
            let before_n = stored_n;
            if force_n.is_finite() {
                let [follows_n, adds_n] = step(start + place, force_n, force_n - followed_n);
                let way_m = row.signals.displacement_m.abs();
                followed_n += follows_n;
                stored_n += adds_n;
                if way_m > 0.0 {
                    stored_n *= libm::exp(-way_m / (presliding_m_per_n * force_n).max(f64::MIN_POSITIVE));
                }
            }
            before_n
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
