//! `cable_elasticity`: pulleys that move with the stretch of the cable.
//!
//! Equation: at pulley j of n, counted from the winch, the cable moves by `Δl + (j/n)·compliance_m_per_n·ΔF`. The cable between winch and pulley
//! stretches, and a growing tension (ΔF > 0) moves the cable there towards the platform, as paying out does. (This answers \[P\]'s open question: an
//! outside force reverses the friction at the far pulleys while the winch rests.) The single state of `lumped` presliding moves by the mean over its
//! pulleys, `(n + 1)/(2n)` of the stretch.
//!
//! ΔF is the distance by which the tension at the platform, with the friction of the last cycle, pushes the edge of a play of ± `play_n`: noise
//! within the play moves nothing, and a tension that keeps changing is followed. Without the play the sensor noise would release the stored friction.
//! With a play of one and a half times the sensor noise, as cable tension, hardly any of this release remains.
//!
//! A slow change passes through a play in bursts, at the peaks of the noise. Between the bursts, the small motions of a winch at rest would reverse
//! pulleys that in reality keep moving with the stretch; such reversals wear off the stored friction, which would then be too small. Therefore a
//! burst is released gradually: per cycle, `Δt/20 ms` of the waiting stretch moves the cable. If the winch moves in the opposite direction, enough is
//! released to keep the middle pulley from reversing. Anything beyond the stretch by `play_n` is released at once. (A low-pass filter on the tension
//! would also delay stops and starts, and leave several times the error.)
//!
//! Friction that follows a tension to which it contributes is stable while `compliance·σ·(n + 1)/(2n) < 1`, as for a cable far stiffer than its
//! presliding. Beyond that limit friction jumps to its Coulomb bound, but no further. A sensor pulley with a wrap of less than 60° (or more than
//! 300°) multiplies its friction by `cos α₁/(1 − cos α₁)`, and the compliance must be lower by that factor. Only presliding and its direction follow
//! the stretch. Viscous friction and everything that depends on speed follow the winch, because the rate of a tension is mostly noise. Neutral:
//! `compliance_m_per_n = 0`.
//!
//! Cause: the cable is an elastic spring between winch and platform.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "an outside force on the resting platform that rises and falls, beside the usual run";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "cable_elasticity",
    cause: "the cable stretches, so that a change of force moves the far pulleys while the winch rests",
    remedy: "a stiffer cable, or a shorter way between winch and platform; else keep the compliance",
    parameters: &[
        ParameterRow::fitted("compliance_m_per_n", "m/N", [0.0, 0.0, 1.0], EXCITATION),
        ParameterRow::setting("play_n", "N", [0.0, 0.0, 1e6], EXCITATION),
    ],
    example: &[0.00025, 0.02],
    memory: Memory::OfTension(2),
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::CableElasticity.acts();
/// Index of `compliance_m_per_n` in [`Values`](crate::parameters::Values).
pub const COMPLIANCE: usize = Effect::CableElasticity.first_place();
/// Index of `play_n`.
pub const PLAY: usize = COMPLIANCE + 1;

/// Index of its state: the middle of the play of the tension, N.
pub(crate) const TENSION: usize = Effect::CableElasticity.memory_places().start;
/// Index of the stretch that waits to move the cable, m.
pub(crate) const STRETCH: usize = TENSION + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CableElasticity<T> {
    /// Stretch of the cable from the winch to its last pulley, m/N.
    pub compliance_m_per_n: T,
    /// Half width of the play, N: tension changes within it move nothing.
    pub play_n: T,
}

/// The state of an elastic cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretching<T> {
    /// Middle of the play, N; [`UNKNOWN`] before the first cycle.
    pub middle_n: T,
    /// Stretch that waits to move the last pulley, m.
    pub waiting_m: T,
}

/// Time constant with which waiting stretch is released, s.
const RELEASE_S: f64 = 0.02;
/// Position of the middle pulley, as a fraction of the stretch.
const MIDDLE: f64 = 0.5;

impl<T: Scalar> CableElasticity<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { compliance_m_per_n: value(COMPLIANCE), play_n: value(PLAY) }
    }

    /// Returns the stretch at the last pulley in this cycle of `step_s`, m, while the winch moves by `displacement_m`. `memory` holds the last
    /// cycle's state, on return this one's.
    #[inline(always)]
    pub fn stretch_m(&self, tension_n: T, displacement_m: T, step_s: T, memory: &mut Stretching<T>) -> T {
        let zero = T::splat(0.0);
        let known = memory.middle_n.lt(T::splat(UNKNOWN));
        let before_n = T::select(known, memory.middle_n, tension_n);
        let change_n = tension_n - before_n;
        let step_n = change_n.sign() * (change_n.abs() - self.play_n).max(zero);
        let waiting_m = memory.waiting_m.keep(known) + self.compliance_m_per_n * step_n;
        let size_m = waiting_m.abs();
        let share = step_s.scale(T::splat(1.0 / RELEASE_S)).min(T::splat(1.0));
        let turning_m = displacement_m
            .abs()
            .scale(T::splat(1.0 / MIDDLE))
            .keep((displacement_m.sign() * waiting_m.sign()).lt(zero));
        let excess_m = size_m - self.compliance_m_per_n * self.play_n;
        let moved_m = waiting_m.sign() * (size_m * share).max(turning_m.min(size_m)).max(excess_m);
        *memory = Stretching { middle_n: before_n + step_n, waiting_m: waiting_m - moved_m };
        moved_m
    }
}
