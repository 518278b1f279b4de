//! `friction_drift`: friction that changes over the run.
//!
//! Equation: `μ(t) = μ·(1 + rate_per_s·t)`, t from the start of the run to `until_s`, where the drift ends; never below 0, and the cycle
//! holds μ where the sensor pulley still tells the tension. Without an end (`until_s = 0`) the line leads nowhere in a loop that goes
//! on: the discovery sets it to that of its log. Neutral: `rate_per_s = 0`.
//!
//! Cause: bearings and grease warm up, or dirt gets in.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNTIL_ROW, drifting_s};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "a long run with the same movements at its beginning and its end";

/// What it is.
pub const ROW: EffectRow = EffectRow {
    kind: "friction_drift",
    cause: "bearings and grease warm up during the run, so friction falls or rises",
    remedy: "let the robot run warm before work, and identify it warm; or renew the grease",
    parameters: &[
        ParameterRow {
            key: "rate_per_s",
            unit: "1/s",
            neutral: 0.0,
            min: -1.0,
            max: 1.0,
            fitted: true,
            excitation: EXCITATION,
        },
        UNTIL_ROW,
    ],
    example: &[0.006, 0.0],
    memory: Memory::Nothing,
    on_mu: OnMu::Unbounded,
    goes_by_time: true,
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Effect::FrictionDrift.acts();
/// Place of `rate_per_s` in [`Values`](crate::parameters::Values).
pub const RATE: usize = Effect::FrictionDrift.first_place();
/// Place of `until_s`.
pub const UNTIL: usize = RATE + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionDrift<T> {
    /// Relative change of μ per second, 1/s.
    pub rate_per_s: T,
    /// When the drift ends, s; never where it is 0.
    pub until_s: T,
}

impl<T: Scalar> FrictionDrift<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { rate_per_s: value(RATE), until_s: value(UNTIL) }
    }

    /// Factor on μ at a time (s) since the start.
    #[inline(always)]
    pub fn factor(&self, time_s: T) -> T {
        (T::splat(1.0) + self.rate_per_s * drifting_s(time_s, self.until_s)).max(T::splat(0.0))
    }
}
