//! `cable_elasticity`: pulleys that move with the stretch of the cable.
//!
//! Equation: at pulley j of n, counted from the winch, the cable moves by `Δl + (j/n)·compliance_m_per_n·ΔF`: what lies between
//! winch and pulley stretches, and a tension that grows (ΔF > 0) moves the cable there towards the platform, as paying out
//! does (\[P\]'s open question: an outside force reverses the friction at the far pulleys while the winch rests). The one
//! state of `lumped` presliding moves by the mean of its pulleys, `(n + 1)/(2n)` of the stretch.
//!
//! ΔF is how far the tension at the platform, with the friction of the last cycle, pushes the edge of a play of ± `play_n`: noise
//! within it moves nothing, and a tension that goes on changing is followed. Without it the noise of the sensor would shake the
//! stored friction loose; with one and a half times the noise of the sensor, as cable tension, next to nothing of it is left.
//!
//! A slow change comes through a play in bursts, at the peaks of the noise. Between them the small motions of a winch at rest would
//! turn each pulley back that in truth goes on with the stretch, and friction, which such turns wear away, would be too small.
//! So a burst waits: of what waits, `Δt/20 ms` moves the cable in a cycle; where the winch moves the other way, as much as keeps
//! the pulley in the middle from turning; and at once what is more than the stretch by `play_n`. (A low pass on the tension itself
//! would delay stops and starts too, and leave several times as much.)
//!
//! Friction that follows a tension it adds to is stable while `compliance·σ·(n + 1)/(2n) < 1`, as it is for a cable far
//! stiffer than its presliding; beyond, friction jumps to its Coulomb bound and no further. A sensor pulley with less wrap than 60° (or
//! more than 300°) makes of the friction in it `cos α₁/(1 − cos α₁)` times as much, and the compliance has
//! to be lower by that factor. Only presliding and its direction follow the stretch; viscous friction and what depends on speed follow the winch, since the rate of a tension is mostly noise.
//! Neutral: `compliance_m_per_n = 0`.
//!
//! Cause: the cable is an elastic spring between winch and platform.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "an outside force on the resting platform that rises and falls, beside the usual run";

/// What it is.
pub const ROW: EffectRow = EffectRow {
    kind: "cable_elasticity",
    cause: "the cable stretches, so that a change of force moves the far pulleys while the winch rests",
    remedy: "a stiffer cable, or a shorter way between winch and platform; else keep the compliance",
    parameters: &[
        ParameterRow {
            key: "compliance_m_per_n",
            unit: "m/N",
            neutral: 0.0,
            min: 0.0,
            max: 1.0,
            fitted: true,
            excitation: EXCITATION,
        },
        ParameterRow {
            key: "play_n",
            unit: "N",
            neutral: 0.0,
            min: 0.0,
            max: 1e6,
            fitted: false,
            excitation: EXCITATION,
        },
    ],
    example: &[0.00025, 0.02],
    memory: Memory::OfTension(2),
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Effect::CableElasticity.acts();
/// Place of `compliance_m_per_n` in [`Values`](crate::parameters::Values).
pub const COMPLIANCE: usize = Effect::CableElasticity.first_place();
/// Place of `play_n`.
pub const PLAY: usize = COMPLIANCE + 1;

/// Place of what it remembers: the middle of the play of the tension, N.
pub(crate) const TENSION: usize = Effect::CableElasticity.memory_places().start;
/// And the stretch that waits to move the cable, m.
pub(crate) const STRETCH: usize = TENSION + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CableElasticity<T> {
    /// Stretch of the cable from the winch to its last pulley, m/N.
    pub compliance_m_per_n: T,
    /// Half the change of tension that moves nothing, N.
    pub play_n: T,
}

/// What an elastic cable remembers of its tension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretching<T> {
    /// Middle of the play, N; [`UNKNOWN`] before the first cycle.
    pub middle_n: T,
    /// Stretch that waits to move the last pulley, m.
    pub waiting_m: T,
}

/// How long what waits takes, s.
const RELEASE_S: f64 = 0.02;
/// Where the pulley in the middle is, as a share of the stretch.
const MIDDLE: f64 = 0.5;

impl<T: Scalar> CableElasticity<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { compliance_m_per_n: value(COMPLIANCE), play_n: value(PLAY) }
    }

    /// Stretch at the last pulley in this cycle of `step_s`, m, while the winch moves by `displacement_m`; `memory` is the last
    /// cycle's, on return this one's.
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
