//! `sensor_nonlinearity`: a force sensor with a nonlinear curve.
//!
//! Equation: `T_shown = T + curvature_per_n·(T − reference_n)²`, where T is the tension without friction, `F_s/(1 − cos α₁)`. At the load
//! `reference_n`, for which the sensor was calibrated, value and slope of its curve are right. So the cycle uses `T = reference + 2y/(1 + √(1 +
//! 4·curvature·y))`, `y = T_shown − reference`. Where the curve has lost half its slope, the cycle continues along its tangent, because no sensor
//! loses more. With a wrong gain, `F_shown` is `gain` times this. Another reference corresponds to another gain and offset. Neutral:
//! `curvature_per_n = 0`, whatever `reference_n`.
//!
//! Cause: a misaligned or overloaded load cell, a bridge with one active gauge, a lever whose angle changes with the load.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements at cable forces that differ by a factor of three and more";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "sensor_nonlinearity",
    cause: "the curve of the force sensor is bent: it shows more, or less, than in proportion at high forces",
    remedy: "calibrate the sensor at the winch with at least five known weights over its range; check its mount",
    parameters: &[
        ParameterRow::fitted("curvature_per_n", "1/N", [-1.0, 0.0, 1.0], EXCITATION),
        ParameterRow::fitted("reference_n", "N", [0.0, 10.0, 1e6], EXCITATION),
    ],
    example: &[0.01, 7.0],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::SensorNonlinearity.acts();
/// Index of `curvature_per_n` in [`Values`](crate::parameters::Values).
pub const CURVATURE: usize = Effect::SensorNonlinearity.first_place();

/// Index of `reference_n`.
pub const REFERENCE: usize = CURVATURE + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorNonlinearity<T> {
    /// Excess of the signal per squared newton of distance from the reference, 1/N.
    pub curvature_per_n: T,
    /// Tension at which value and slope of the curve are right, N.
    pub reference_n: T,
}

impl<T: Scalar> SensorNonlinearity<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { curvature_per_n: value(CURVATURE), reference_n: value(REFERENCE) }
    }

    /// Returns the least fraction of a force change that the sensor shows.
    pub(crate) fn shown_ratio(&self) -> T {
        T::select(self.curvature_per_n.eq(T::splat(0.0)), T::splat(1.0), T::splat(LEAST_SLOPE))
    }

    /// Returns the true sensor force for the one shown, N, for a sensor whose signal is `1/frictionless_gain` of the tension.
    #[inline(never)]
    pub fn undo(&self, shown_n: T, frictionless_gain: T) -> T {
        let (one, two) = (T::splat(1.0), T::splat(2.0));
        let from_reference_n = shown_n.scale(frictionless_gain) - self.reference_n;
        // The slope of the curve is the root.
        let square = one + T::splat(4.0) * self.curvature_per_n * from_reference_n;
        let least = T::splat(LEAST_SLOPE * LEAST_SLOPE);
        let on_parabola_n = two * from_reference_n / (one + square.max(least).sqrt());
        let is_beyond = square.lt(least);
        let curvature_per_n = T::select(is_beyond, self.curvature_per_n, one);
        // The tangent at `y₀ = −3/(16c)`, where the parabola has come to `4y₀/3`.
        let on_tangent_n = two * from_reference_n + T::splat(0.125) / curvature_per_n;
        let true_n = T::select(is_beyond, on_tangent_n, on_parabola_n);
        shown_n - (from_reference_n - true_n) / frictionless_gain
    }
}

/// Least slope of a sensor's curve; `undo` contains the tangent for one half.
const LEAST_SLOPE: f64 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_undone_as_far_as_it_has_half_its_slope() {
        for curvature_per_n in [-0.01, 0.0, 0.003, 0.015] {
            let sensor = SensorNonlinearity { curvature_per_n, reference_n: 8.0 };
            for tension_n in [-2.0_f64, -0.1, 0.0, 3.0, 30.0] {
                let shown_n = tension_n + curvature_per_n * (tension_n - 8.0).powi(2);
                // A sensor at 180° shows twice the tension.
                let force_n = sensor.undo(2.0 * shown_n, 0.5);
                assert!((force_n - 2.0 * tension_n).abs() < 1e-9, "{curvature_per_n} {tension_n}: {force_n}");
            }
        }
        // The curvature −0.01 has half its slope at 25 N above the reference, where the signal is 18.75 N greater; 1 N more of signal is 2 N of
        // tension there.
        let sensor = SensorNonlinearity { curvature_per_n: -0.01, reference_n: 8.0 };
        assert!((sensor.undo(26.75_f64, 1.0) - 33.0).abs() < 1e-9);
        assert!((sensor.undo(27.75_f64, 1.0) - 35.0).abs() < 1e-9);
    }
}
