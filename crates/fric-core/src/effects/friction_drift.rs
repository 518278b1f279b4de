//! `friction_drift`: friction that changes over the run.
//!
//! Equation: `μ(t) = μ·(1 + rate_per_s·t)`, with t from the start of the run up to `until_s`, where the drift ends. μ is never below 0, and the cycle
//! limits it to values at which the sensor pulley still determines the tension. Without an end (`until_s = 0`) the drift continues without limit in a
//! running loop; the discovery sets the end to that of its log. Neutral: `rate_per_s = 0`.
//!
//! Cause: bearings and grease warm up, or dirt gets in.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNTIL_ROW, drifting_s};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "a long run with the same movements at its beginning and its end";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "friction_drift",
    cause: "bearings and grease warm up during the run, so friction falls or rises",
    remedy: "let the robot run warm before work, and identify it warm; or renew the grease",
    parameters: &[ParameterRow::fitted("rate_per_s", "1/s", [-1.0, 0.0, 1.0], EXCITATION), UNTIL_ROW],
    example: &[0.006, 0.0],
    memory: Memory::Nothing,
    on_mu: OnMu::Unbounded,
    goes_by_time: true,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::FrictionDrift.acts();
/// Index of `rate_per_s` in [`Values`](crate::parameters::Values).
pub const RATE: usize = Effect::FrictionDrift.first_place();
/// Index of `until_s`.
pub const UNTIL: usize = RATE + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionDrift<T> {
    /// Relative change of μ per second, 1/s.
    pub rate_per_s: T,
    /// End of the drift, s; 0 for never.
    pub until_s: T,
}

impl<T: Scalar> FrictionDrift<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { rate_per_s: value(RATE), until_s: value(UNTIL) }
    }

    /// Returns the factor on μ at a time (s) since the start.
    #[inline(always)]
    pub fn factor(&self, time_s: T) -> T {
        (T::splat(1.0) + self.rate_per_s * drifting_s(time_s, self.until_s)).max(T::splat(0.0))
    }
}
