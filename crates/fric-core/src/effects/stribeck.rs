//! `stribeck`: friction that falls with the speed.
//!
//! Equation: `μ(v) = μ·(1 + ratio·exp(−(v/velocity)²))`. At rest friction is greater by the fraction `ratio`; at twice `velocity` only 2 % of this
//! remains. Neutral: `ratio = 0`.
//!
//! The friction of a cycle belongs to the motion since the cycle before, so v is the mean of the speeds at both its ends. With the speed at its end
//! alone, friction would be half a cycle ahead wherever the cable stops or starts.
//!
//! Cause: at low speed the lubricant film in the bearing has not formed and the surfaces touch.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN, first};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements at several speeds, creeping ones too, in both directions";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "stribeck",
    cause: "at low speed the lubricant film of a bearing has not formed yet, so friction is higher near standstill",
    remedy: "check the grease of the pulley bearings: too little of it, or too stiff for the temperature",
    parameters: &[
        ParameterRow::fitted("ratio", "1", [-0.9, 0.0, 5.0], EXCITATION),
        ParameterRow::fitted("velocity_m_per_s", "m/s", [1e-4, 0.02, 10.0], EXCITATION),
    ],
    example: &[0.6, 0.03],
    memory: Memory::OfMotion(1),
    on_mu: OnMu::AtMost {
        factor: |values| 1.0 + first(values).max(0.0),
        key: "ratio",
        problem: "raises the friction at rest, `mu`·(1 + `ratio`), beyond 0.9; lower it, or `mu`",
    },
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::Stribeck.acts();
/// Index of `ratio` in [`Values`](crate::parameters::Values).
pub const RATIO: usize = Effect::Stribeck.first_place();
/// Index of `velocity_m_per_s`.
pub const VELOCITY: usize = RATIO + 1;

/// Index of its state: the speed at the end of the cycle before, m/s.
pub(crate) const SPEED: usize = Effect::Stribeck.memory_places().start;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stribeck<T> {
    /// Additional friction at rest, as a fraction of μ.
    pub ratio: T,
    /// Speed at which the additional fraction has fallen by the factor e, m/s.
    pub velocity_m_per_s: T,
}

impl<T: Scalar> Stribeck<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { ratio: value(RATIO), velocity_m_per_s: value(VELOCITY) }
    }

    /// Returns the factor on μ in a cycle with these speeds at its end and at the end of the one before, [`UNKNOWN`] at the start of a run.
    #[inline(never)]
    pub fn factor(&self, speed_m_per_s: T, before_m_per_s: T) -> T {
        let before_m_per_s = T::select(before_m_per_s.lt(T::splat(UNKNOWN)), before_m_per_s, speed_m_per_s);
        let mean_m_per_s = (before_m_per_s + speed_m_per_s).scale(T::splat(0.5));
        let relative = mean_m_per_s / self.velocity_m_per_s;
        let fall = (-(relative * relative)).exp_negative();
        T::splat(1.0) + self.ratio * fall
    }
}
