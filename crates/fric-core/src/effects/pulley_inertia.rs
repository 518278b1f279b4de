//! `pulley_inertia`: pulleys that have to be set in motion.
//!
//! Equation: `F_j = F_{j−1} + … + mass_kg·a` with the acceleration a of the cable, positive paying out, and `mass_kg = J/r²` of each
//! pulley; it needs no presliding distance and stays outside the Dahl state. Two low passes one behind the other, of
//! `T = window_s`, give the acceleration:
//!
//! ```text
//! a₁ = (v   − v_f )/(T + dt)    v_f  ← v_f  + a₁·dt
//! a₂ = (v_f − v_ff)/(T + dt)    v_ff ← v_ff + a₂·dt
//! a  = a₁ + (a₁ − a₂)·(T + dt/2)/(T + dt)
//! ```
//!
//! a₁ lags behind the cable by `T + dt/2`, of which dt/2 is that of any difference, and a₂ behind a₁ by `T + dt`; so a steady jerk is
//! followed without a lag. With `T = 0` it is the backward difference of second order, `(3v₀ − 4v₁ + v₂)/2dt`.
//!
//! Noise δ of the speed makes a noise of at most `2.6·δ/(T + dt)` in it: 1 mm/s, one step of an encoder of 1 µm read every
//! millisecond, 0.9 m/s² with the 2 ms that stand for a window not given. Set points bear 0; a coarser encoder wants more.
//! Neutral: `mass_kg = 0`.
//!
//! Cause: heavy pulleys, or pulleys of large radius, at high acceleration.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "strokes there and back with high acceleration";

/// What it is.
pub const ROW: EffectRow = EffectRow {
    kind: "pulley_inertia",
    cause: "the pulleys take a force to be accelerated",
    remedy: "lighter pulleys, or gentler acceleration",
    parameters: &[
        ParameterRow {
            key: "mass_kg",
            unit: "kg",
            neutral: 0.0,
            min: 0.0,
            max: 1e4,
            fitted: true,
            excitation: EXCITATION,
        },
        ParameterRow {
            key: "window_s",
            unit: "s",
            neutral: 0.002,
            min: 0.0,
            max: 0.1,
            fitted: false,
            excitation: EXCITATION,
        },
    ],
    example: &[0.05, 0.002],
    memory: Memory::OfMotion(2),
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Effect::PulleyInertia.acts();
/// Place of `mass_kg` in [`Values`](crate::parameters::Values).
pub const MASS: usize = Effect::PulleyInertia.first_place();
/// Place of `window_s`.
pub const WINDOW: usize = MASS + 1;

/// Places of what it remembers: both low passes of the speed, m/s.
pub(crate) const SPEEDS: [usize; 2] = {
    let first = Effect::PulleyInertia.memory_places().start;
    [first, first + 1]
};

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulleyInertia<T> {
    /// Moment of inertia of each pulley by its squared radius, kg.
    pub mass_kg: T,
    /// Time constant of both low passes, s.
    pub window_s: T,
}

impl<T: Scalar> PulleyInertia<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { mass_kg: value(MASS), window_s: value(WINDOW) }
    }

    /// Force that accelerates one pulley, N, and both low passes of the speed for the next cycle; `filtered_m_per_s` are the
    /// last cycle's, [`UNKNOWN`] before the first; `step_s` the time since.
    #[inline(always)]
    pub fn force_n(&self, speed_m_per_s: T, filtered_m_per_s: [T; 2], step_s: T) -> (T, [T; 2]) {
        let [once, twice] = filtered_m_per_s;
        let known = once.lt(T::splat(UNKNOWN));
        let once = T::select(known, once, speed_m_per_s);
        let twice = T::select(known, twice, speed_m_per_s);
        let lag_s = self.window_s + step_s;
        let near = (speed_m_per_s - once) / lag_s;
        let far = (once - twice) / lag_s;
        let lead_ratio = (lag_s - step_s.scale(T::splat(0.5))) / lag_s;
        let force_n = self.mass_kg * (near + (near - far) * lead_ratio);
        (force_n, [once + near.scale(step_s), twice + far.scale(step_s)])
    }
}
