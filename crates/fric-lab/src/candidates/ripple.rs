//! Ripples: periodic components of a residual, and their periods.

use std::f64::consts::TAU;

use fric_core::effects::Effect;
use fric_core::effects::ripple::PERIOD_KEY;

use crate::effects::Periods;
use crate::samples::record::{CableRecord, Row};
use crate::search::vector::Parameter;

/// Number of trial periods, and the number of the strongest that are used.
const PERIODS: usize = 512;
const MOST_PERIODS: usize = 2;
/// Number of golden-section steps over half a period, down to a thousandth.
const SECTIONS: usize = 14;

/// Returns the period parameter of an effect that is periodic in the cable's length. It has no neutral value to start from; a scan of the residual
/// finds it.
pub fn period_of(effect: Effect) -> Option<Parameter> {
    Parameter::of(effect).find(is_period)
}

/// Whether a parameter is the period of a ripple.
pub fn is_period(parameter: &Parameter) -> bool {
    parameter.row().key == PERIOD_KEY
}

/// Returns the periods in the cable's length at which a residual ripples.
pub fn periods(record: &CableRecord<'_>, residual_n: &[f64]) -> Periods {
    Periods {
        with_load: periods_m(record, residual_n, |row| row.signals.sensor_force_n),
        with_friction: periods_m(record, residual_n, |row| {
            row.signals.sensor_force_n * row.signals.displacement_m.signum()
        }),
        alone: periods_m(record, residual_n, |_| 1.0),
    }
}

/// Returns the periods at which a residual ripples in proportion to `carrier`, the strongest first.
fn periods_m(record: &CableRecord<'_>, residual_n: &[f64], carrier: impl Fn(&Row) -> f64) -> Vec<f64> {
    /// Number of samples that suffices.
    const ENOUGH: usize = 6000;
    let moving = record.rows.iter().zip(residual_n).filter(|(row, residual_n)| {
        residual_n.is_finite() && row.signals.displacement_m.abs() > 0.0 && row.signals.sensor_force_n > 0.0
    });
    let samples: Vec<(f64, f64)> =
        moving.map(|(row, residual_n)| (row.signals.length_m, residual_n / carrier(row))).collect();
    let (least_m, greatest_m) =
        samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), (length_m, _)| {
            (least.min(*length_m), most.max(*length_m))
        });
    let range_m = greatest_m - least_m;
    if samples.len() < ENOUGH / 10 || range_m <= 0.0 {
        return Vec::new();
    }
    let few: Vec<(f64, f64)> = samples.iter().step_by(samples.len() / ENOUGH + 1).copied().collect();
    let powers: Vec<(f64, f64)> = (3..PERIODS)
        .map(|half_turns| {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let period_m = 2.0 * range_m / half_turns as f64;
            (period_m, ripple_power(&few, period_m))
        })
        .collect();
    let mut peaks: Vec<(f64, f64)> = powers
        .windows(3)
        .filter(|three| three[1].1 > three[0].1 && three[1].1 >= three[2].1)
        .map(|three| three[1])
        .collect();
    peaks.sort_by(|one, other| other.1.total_cmp(&one.1));
    peaks.into_iter().take(MOST_PERIODS).map(|(period_m, _)| sharpened(&few, period_m, range_m)).collect()
}

/// Refines a period of the grid to the strongest ripple, by golden sections of the number of periods over the whole range.
fn sharpened(samples: &[(f64, f64)], period_m: f64, range_m: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (range_m / period_m - 0.5, range_m / period_m + 0.5);
    let power = |turns: f64| ripple_power(samples, range_m / turns);
    for _ in 0..SECTIONS {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if power(left) > power(right) { high = right } else { low = left }
    }
    range_m / f64::midpoint(low, high)
}

/// Returns the decrease of the squares by a sine of this period beside a constant.
pub fn ripple_power(samples: &[(f64, f64)], period_m: f64) -> f64 {
    let (mut matrix, mut right) = (nalgebra::Matrix3::<f64>::zeros(), nalgebra::Vector3::<f64>::zeros());
    for (length_m, ratio) in samples {
        let (sin, cos) = (TAU * length_m / period_m).sin_cos();
        let row = nalgebra::Vector3::new(1.0, sin, cos);
        matrix += row * row.transpose();
        right += row * *ratio;
    }
    let constant = right[0] * right[0] / matrix[(0, 0)];
    matrix.cholesky().map_or(0.0, |factor| factor.solve(&right).dot(&right) - constant)
}
