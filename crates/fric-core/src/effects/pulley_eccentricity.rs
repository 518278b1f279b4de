//! `pulley_eccentricity`: a tension ripple that is periodic in the cable's length.
//!
//! Equation: `F ← F·(1 + sin_ratio·sin(2πl/period_m) + cos_ratio·cos(2πl/period_m))` at the platform, where l is the cable length, delayed if there
//! is a `time_delay`. The zero of the length determines the phase: a length that starts anew with each run needs its own ratios. An identification
//! finds the ratios. It finds the period only from a start that is right to a fraction of a revolution over the whole range, so the period is not
//! varied unless requested. Of two of them the factors multiply. Neutral: both ratios 0.
//!
//! Cause: an eccentric pulley, with its circumference as the period. A ripple that is independent of the load is `winch_ripple`.

use super::ripple::{self, Ripples};
use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::scalar::Scalar;

const EXCITATION: &str = "slow long movements over several turns of the pulleys";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "pulley_eccentricity",
    cause: "a pulley runs out of true: the force ripples with the cable length, in proportion to the load",
    remedy: "check the run-out of the pulleys; the period is the circumference of the one to look at",
    parameters: &ripple::rows(["sin_ratio", "cos_ratio"], "1", 0.5, EXCITATION),
    example: &[0.02, -0.01, 0.07],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The ripples of this kind that a cable can have.
const RIPPLES: Ripples = Ripples::of([Effect::PulleyEccentricity, Effect::PulleyEccentricity2]);
/// The effects as a set, to test whether any acts.
pub(crate) const ACTS: Acting = RIPPLES.acts();

/// Returns a number times the factors at a cable length (m) of those that act, from a cable's parameter values by index.
#[inline(always)]
pub(crate) fn times<T: Scalar>(number: T, acting: Acting, value: impl Fn(usize) -> T, length_m: T) -> T {
    RIPPLES.apply(acting, value, number, |number, ripple| number * ripple.added_to(T::splat(1.0), length_m))
}
