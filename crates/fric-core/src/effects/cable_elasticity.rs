//! `cable_elasticity`: pulleys that move with the stretch of the cable.
//!
//! Equation: at pulley j of n, counted from the winch, the cable moves by `Δl + (j/n)·compliance_m_per_n·ΔF`: what lies between
//! winch and pulley stretches, and a tension that grows (ΔF > 0) moves the cable there towards the platform, as paying out
//! does (\[P\]'s open question: an outside force reverses the friction at the far pulleys while the winch rests). The one
//! state of `lumped` presliding moves by the mean of its pulleys, `(n + 1)/(2n)` of the stretch.
//!
//! ΔF is the change of the frictionless tension behind a low pass of the time constant `window_s`. Without it the noise of
//! the sensor would shake the stored friction loose: noise δ (rms) moves the cable there and back by some
//! `compliance·δ/window_s` a second, and friction at rest is forgotten over a way of `f_c/σ`. Taken from the sensor, not from the
//! computed force at the platform, there is no feedback that could swing. Only presliding and its direction follow the
//! stretch; viscous friction and what depends on speed follow the winch, since the rate of a tension is mostly noise.
//! Neutral: `compliance_m_per_n = 0`.
//!
//! Cause: the cable is an elastic spring between winch and platform.

use super::{Acting, EffectRow, first_place};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "an outside force on the resting platform that rises and falls, beside the usual run";

/// The catalogue row.
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
            key: "window_s",
            unit: "s",
            neutral: 0.05,
            min: 0.0,
            max: 1.0,
            fitted: false,
            excitation: EXCITATION,
        },
    ],
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Acting::only(ROW.kind);
/// Place of `compliance_m_per_n` in [`Values`](crate::parameters::Values).
pub const COMPLIANCE: usize = first_place(ROW.kind);
/// Place of `window_s`.
pub const WINDOW: usize = COMPLIANCE + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CableElasticity<T> {
    /// Stretch of the cable from the winch to its last pulley, m/N.
    pub compliance_m_per_n: T,
    /// Time constant of the tension, s.
    pub window_s: T,
}

impl<T: Scalar> CableElasticity<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { compliance_m_per_n: value(COMPLIANCE), window_s: value(WINDOW) }
    }

    /// Stretch at the last pulley in this cycle, m, and the low pass of the tension for the next; `filtered_n` is the last
    /// cycle's, infinite before the first; `step_s` the time since.
    #[inline(always)]
    pub fn stretch_m(&self, tension_n: T, filtered_n: T, step_s: T) -> (T, T) {
        let known = filtered_n.within(f64::MAX);
        let before_n = T::select(known, filtered_n, tension_n);
        let step_n = (tension_n - before_n) * (step_s / (self.window_s + step_s));
        (self.compliance_m_per_n * step_n, before_n + step_n)
    }
}
