//! `bearing_drag`: friction of each bearing that does not depend on its load.
//!
//! Equation: `f_c = μ·F_N + drag_n` at every pulley. Neutral: `drag_n = 0`. A negative value would push the cable, so an identification excludes it;
//! a friction that falls at low load is described by `load_nonlinearity`.
//!
//! Cause: preload of the bearing, its seals and its grease resist independently of the cable tension.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements in both directions at cable forces that differ by a factor of two and more";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "bearing_drag",
    cause: "preload, seals or grease of the bearings resist independently of the cable force",
    remedy: "use bearings with less preload, or without contact seals; less or thinner grease",
    parameters: &[ParameterRow::fitted("drag_n", "N", [0.0, 0.0, 1e4], EXCITATION)],
    example: &[0.04],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::BearingDrag.acts();
/// Index of `drag_n` in [`Values`](crate::parameters::Values).
pub const DRAG: usize = Effect::BearingDrag.first_place();

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BearingDrag<T> {
    /// Friction of each pulley without load, N.
    pub drag_n: T,
}

impl<T: Scalar> BearingDrag<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { drag_n: value(DRAG) }
    }
}
