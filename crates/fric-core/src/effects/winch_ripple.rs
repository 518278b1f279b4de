//! `winch_ripple`: a force that is periodic in the cable's length and independent of the load.
//!
//! Equation: `F_shown = F_s + sin_n·sin(2πl/period_m) + cos_n·cos(2πl/period_m)` in newtons of the sensor signal, where l is the cable length. A
//! ripple in proportion to the load is `pulley_eccentricity`; a ripple that reverses with the motion is `friction_ripple`. For the zero of the length
//! and the period, see there. Two of them add up. Neutral: `sin_n` and `cos_n` 0.
//!
//! Cause: the cogging of a motor whose current measures the force, at its slot frequency; a drum whose cable pushes on a sensor in its mount.

use super::ripple::{self, Ripple, Ripples};
use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::scalar::Scalar;

const EXCITATION: &str =
    "slow long movements over several turns of the winch, at cable forces that differ by a factor of two and more";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "winch_ripple",
    cause: "the motor cogs, or the drum pushes on the sensor once a turn: the force shown ripples with the cable length whatever the load",
    remedy: "measure the force behind the winch, or compensate the cogging in the drive; the period is the cable of a turn over the number of slots",
    parameters: &ripple::rows(["sin_n", "cos_n"], "N", 1e4, EXCITATION),
    example: &[0.1, -0.05, 0.03],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The ripples of this kind that a cable can have.
const RIPPLES: Ripples = Ripples::of([Effect::WinchRipple, Effect::WinchRipple2]);
/// The effects as a set, to test whether any acts.
pub(crate) const ACTS: Acting = RIPPLES.acts();

/// Returns the sensor force without the ripples that act, for a force shown (N) at a cable length (m), from a cable's parameter values by index.
#[inline(always)]
pub(crate) fn undo<T: Scalar>(acting: Acting, value: impl Fn(usize) -> T, shown_n: T, length_m: T) -> T {
    RIPPLES.apply(acting, value, shown_n, |shown_n, Ripple { sin, cos, period_m }| {
        Ripple { sin: -sin, cos: -cos, period_m }.added_to(shown_n, length_m)
    })
}
