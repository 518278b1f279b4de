//! `pulley_eccentricity`: a tension ripple that is periodic in the cable's length.
//!
//! Equation: `F ← F·(1 + sin_ratio·sin(2πl/period_m) + cos_ratio·cos(2πl/period_m))` at the platform, l the cable length, the
//! delayed one with `time_delay`. The zero of the length decides what is sine and what cosine: a length that starts anew
//! with each run needs its own ratios. An identification finds the ratios; the period only from a start that is right to
//! a fraction of a turn over the whole way, so it is not varied unless asked for. Neutral: both ratios 0.
//!
//! Cause: a pulley that runs out of true, with its circumference as the period; the cogging of a motor shows the same way.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "slow long movements over several turns of the pulleys";

/// What it is.
pub const ROW: EffectRow = EffectRow {
    kind: "pulley_eccentricity",
    cause: "a pulley runs out of true, or the motor cogs: the force ripples with the cable length",
    remedy: "check the run-out of the pulleys; the period is the circumference of the one to look at",
    parameters: &[
        ParameterRow {
            key: "sin_ratio",
            unit: "1",
            neutral: 0.0,
            min: -0.5,
            max: 0.5,
            fitted: true,
            excitation: EXCITATION,
        },
        ParameterRow {
            key: "cos_ratio",
            unit: "1",
            neutral: 0.0,
            min: -0.5,
            max: 0.5,
            fitted: true,
            excitation: EXCITATION,
        },
        ParameterRow {
            key: "period_m",
            unit: "m",
            neutral: 0.1,
            min: 1e-4,
            max: 100.0,
            fitted: false,
            excitation: EXCITATION,
        },
    ],
    example: &[0.02, -0.01, 0.07],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Effect::PulleyEccentricity.acts();
/// Place of `sin_ratio` in [`Values`](crate::parameters::Values).
pub const SIN: usize = Effect::PulleyEccentricity.first_place();
/// Place of `cos_ratio`.
pub const COS: usize = SIN + 1;
/// Place of `period_m`.
pub const PERIOD: usize = SIN + 2;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulleyEccentricity<T> {
    /// Amplitude of the sine as a share of the tension, 1.
    pub sin_ratio: T,
    /// Amplitude of the cosine, 1.
    pub cos_ratio: T,
    /// Cable length of one period, m.
    pub period_m: T,
}

impl<T: Scalar> PulleyEccentricity<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { sin_ratio: value(SIN), cos_ratio: value(COS), period_m: value(PERIOD) }
    }

    /// Factor on the tension at a cable length (m); 1 where it is [`UNKNOWN`], before the first.
    #[inline(never)]
    pub fn factor(&self, length_m: T) -> T {
        let known = length_m.lt(T::splat(UNKNOWN));
        let [sin, cos] = (length_m.keep(known) / self.period_m).sin_cos_turns();
        let one = T::splat(1.0);
        T::select(known, one + self.sin_ratio * sin + self.cos_ratio * cos, one)
    }
}
