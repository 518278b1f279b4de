//! `pulley_inertia`: pulleys that must be accelerated.
//!
//! Equation: `F_j = F_{j−1} + … + mass_kg·a` with the acceleration a of the cable, positive paying out, and `mass_kg = J/r²` of each pulley. The
//! force needs no presliding distance and stays outside the Dahl state. Two low-pass filters in series, with `T = window_s`, give the acceleration:
//!
//! ```text
//! a₁ = (v   − v_f )/(T + dt)    v_f  ← v_f  + a₁·dt
//! a₂ = (v_f − v_ff)/(T + dt)    v_ff ← v_ff + a₂·dt
//! a  = a₁ + (a₁ − a₂)·(T + dt/2)/(T + dt)
//! ```
//!
//! a₁ lags behind the cable by `T + dt/2`, of which dt/2 is that of any difference, and a₂ behind a₁ by `T + dt`, so a constant jerk is followed
//! without lag. With `T = 0` it is the backward difference of second order, `(3v₀ − 4v₁ + v₂)/2dt`.
//!
//! Speed noise δ causes acceleration noise of at most `2.6·δ/(T + dt)`. Example: 1 mm/s, one step of an encoder with 1 µm read every millisecond,
//! gives 0.9 m/s² with the default window of 2 ms. Set points allow a window of 0; a coarser encoder needs a longer one. Neutral: `mass_kg = 0`.
//!
//! Cause: heavy pulleys, or pulleys of large radius, at high acceleration.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "strokes there and back with high acceleration";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "pulley_inertia",
    cause: "the pulleys take a force to be accelerated",
    remedy: "lighter pulleys, or gentler acceleration",
    parameters: &[
        ParameterRow::fitted("mass_kg", "kg", [0.0, 0.0, 1e4], EXCITATION),
        ParameterRow::setting("window_s", "s", [0.0, 0.002, 0.1], EXCITATION),
    ],
    example: &[0.05, 0.002],
    memory: Memory::OfMotion(2),
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::PulleyInertia.acts();
/// Index of `mass_kg` in [`Values`](crate::parameters::Values).
pub const MASS: usize = Effect::PulleyInertia.first_place();
/// Index of `window_s`.
pub const WINDOW: usize = MASS + 1;

/// Indices of its state: both low-pass filters of the speed, m/s.
pub(crate) const SPEEDS: [usize; 2] = {
    let first = Effect::PulleyInertia.memory_places().start;
    [first, first + 1]
};

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulleyInertia<T> {
    /// Moment of inertia of each pulley divided by its squared radius, kg.
    pub mass_kg: T,
    /// Time constant of both low-pass filters, s.
    pub window_s: T,
}

impl<T: Scalar> PulleyInertia<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { mass_kg: value(MASS), window_s: value(WINDOW) }
    }

    /// Returns the force that accelerates one pulley, N, and the state of both low-pass filters for the next cycle. `filtered_m_per_s` is the last
    /// cycle's state, [`UNKNOWN`] before the first; `step_s` is the time since then.
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
