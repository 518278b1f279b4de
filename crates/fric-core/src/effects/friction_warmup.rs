//! `friction_warmup`: friction that approaches another value as the machine warms up.
//!
//! Equation: `μ(t) = μ·(1 + ratio·(1 − exp(−t/time_constant_s)))`, with t from the start of the run. So `μ` is the value of the cold machine and
//! `μ·(1 + ratio)` the final value of the warm one. A steady change over the run is described by `friction_drift`. For a machine that is already
//! warm, set `μ` to the value of the warm machine and leave the effect out. Neutral: `ratio = 0`.
//!
//! Cause: grease becomes thinner as the bearings warm up to their steady temperature, at which heat loss equals frictional heating.

use super::{Acting, Effect, EffectRow, Memory, OnMu, first, warmed};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str =
    "a long run from cold with the same movements throughout, three times as long as it takes to warm up";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "friction_warmup",
    cause: "bearings and grease warm up towards a final temperature, and friction with them",
    remedy: "let the robot run warm before work, and identify it warm; or a grease that depends less on temperature",
    parameters: &[
        ParameterRow::fitted("ratio", "1", [-0.95, 0.0, 5.0], EXCITATION),
        ParameterRow::fitted("time_constant_s", "s", [1e-2, 10.0, 1e6], EXCITATION),
    ],
    example: &[-0.3, 5.0],
    memory: Memory::Nothing,
    on_mu: OnMu::AtMost {
        factor: |values| 1.0 + first(values).max(0.0),
        key: "ratio",
        problem: "raises the friction of the warm machine, `mu`·(1 + `ratio`), beyond 0.9; lower it, or `mu`",
    },
    goes_by_time: true,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::FrictionWarmup.acts();
/// Index of `ratio` in [`Values`](crate::parameters::Values).
pub const RATIO: usize = Effect::FrictionWarmup.first_place();
/// Index of `time_constant_s`.
pub const TIME_CONSTANT: usize = RATIO + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionWarmup<T> {
    /// Change of μ from cold to warm, as a fraction of the cold value.
    pub ratio: T,
    /// Time constant of the change, s.
    pub time_constant_s: T,
}

impl<T: Scalar> FrictionWarmup<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { ratio: value(RATIO), time_constant_s: value(TIME_CONSTANT) }
    }

    /// Returns the factor on μ at a time (s) since the start.
    #[inline(never)]
    pub fn factor(&self, time_s: T) -> T {
        T::splat(1.0) + self.ratio * warmed(time_s, self.time_constant_s)
    }
}
