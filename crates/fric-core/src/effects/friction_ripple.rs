//! `friction_ripple`: friction that is periodic in the cable's length.
//!
//! Equation: `μ(l) = μ·(1 + sin_ratio·sin(2πl/period_m) + cos_ratio·cos(2πl/period_m))`, where l is the cable length, behind a play of the gear if
//! there is one. During motion in one direction the force ripples as with `pulley_eccentricity`, but unlike there it reverses with the motion. For
//! the zero of the length and the period, see there. Of two of them the factors multiply. Neutral: both ratios 0.
//!
//! Cause: a bearing with a flat spot, an out-of-round groove, a drum on which the cable lies unevenly.

use super::ripple::{self, Ripples};
use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::scalar::Scalar;

const EXCITATION: &str = "slow long movements in both directions over several turns of the pulleys";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "friction_ripple",
    cause: "a bearing or groove is not the same all around, so friction ripples as the pulley or the drum turns",
    remedy: "look for a damaged bearing, or dirt in the groove, of the pulley whose circumference is the period",
    parameters: &ripple::rows(["sin_ratio", "cos_ratio"], "1", 0.6, EXCITATION),
    example: &[0.2, -0.15, 0.07],
    memory: Memory::Nothing,
    on_mu: OnMu::AtMost {
        factor: |values| 1.0 + ripple::amplitude(values),
        key: "sin_ratio",
        problem: "and `cos_ratio` raise the friction, `mu`·(1 + amplitude), beyond 0.9; lower them, or `mu`",
    },
    goes_by_time: false,
};

/// The ripples of this kind that a cable can have.
const RIPPLES: Ripples = Ripples::of([Effect::FrictionRipple, Effect::FrictionRipple2]);
/// The effects as a set, to test whether any acts.
pub(crate) const ACTS: Acting = RIPPLES.acts();

/// Returns a number times the factors at a cable length (m) of those that act, from a cable's parameter values by index.
#[inline(always)]
pub(crate) fn times<T: Scalar>(number: T, acting: Acting, value: impl Fn(usize) -> T, length_m: T) -> T {
    RIPPLES.apply(acting, value, number, |number, ripple| number * ripple.added_to(T::splat(1.0), length_m))
}
