//! `viscous_nonlinearity`: a part of the viscous friction that grows with the square of the speed.
//!
//! Equation: `F_v = F_pv·v + (quadratic/n)·v·|v|` at each of a cable's n pulleys, in addition to \[P\] 6; like σ the parameter belongs to the whole
//! cable. Like viscous friction it needs no presliding distance and does not depend on the load; `direction_asymmetry` does not change it. Neutral:
//! `quadratic_n_s2_per_m2 = 0`. A negative value would push the cable at some speed, so an identification excludes it.
//!
//! Cause: churned grease, air drag of a fast drum or pulley.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements at several speeds up to the highest, in both directions";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "viscous_nonlinearity",
    cause: "grease is churned, or a fast drum or pulley drives air, so that friction grows with the square of the speed",
    remedy: "less grease, or a thinner one; covers around fast drums; else keep the term",
    parameters: &[ParameterRow::fitted("quadratic_n_s2_per_m2", "N s²/m²", [0.0, 0.0, 1e6], EXCITATION)],
    example: &[0.6],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::ViscousNonlinearity.acts();
/// Index of `quadratic_n_s2_per_m2` in [`Values`](crate::parameters::Values).
pub const QUADRATIC: usize = Effect::ViscousNonlinearity.first_place();

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViscousNonlinearity<T> {
    /// Friction of all pulleys together per squared speed, N s²/m².
    pub quadratic_n_s2_per_m2: T,
}

impl<T: Scalar> ViscousNonlinearity<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { quadratic_n_s2_per_m2: value(QUADRATIC) }
    }

    /// Returns the friction of all pulleys at a speed, N.
    #[inline(always)]
    pub fn force_n(&self, speed_m_per_s: T) -> T {
        self.quadratic_n_s2_per_m2 * (speed_m_per_s * speed_m_per_s.abs())
    }
}
