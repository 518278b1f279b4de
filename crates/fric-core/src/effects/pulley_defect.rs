//! `pulley_defect`: one pulley with its own friction.
//!
//! Equation: at the pulley with the number `pulley`, counted from 1 at the sensor, `mu` of this effect replaces the cable's μ. Effects that change
//! the friction of all pulleys (`stribeck`, `friction_drift`, …) change it too. If the sensor pulley cannot have this friction, the cycle limits it,
//! as for every effect that raises μ. Neutral: `pulley = 0`, none.
//!
//! Cause: a dry, seized or damaged bearing; a cable that rubs on a flange or on the frame.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::{GREATEST_MU, ParameterRow};
use crate::robot::MAX_PULLEYS;
use crate::scalar::Scalar;

const EXCITATION: &str =
    "long movements in both directions in which the wraps of the pulleys, or the forces at them, differ";

#[expect(clippy::cast_precision_loss, reason = "a small count")]
const MOST_PULLEYS: f64 = MAX_PULLEYS as f64;

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "pulley_defect",
    cause: "one pulley rubs otherwise than the rest: its bearing is dry, seized or damaged, or the cable touches a flange there",
    remedy: "look at this pulley: turn it by hand, clean and grease its bearing or replace it",
    parameters: &[
        ParameterRow::setting("pulley", "1", [0.0, 0.0, MOST_PULLEYS], EXCITATION),
        ParameterRow::fitted("mu", "1", [0.0, 0.0, GREATEST_MU], EXCITATION),
    ],
    example: &[1.0, 0.1],
    memory: Memory::Nothing,
    on_mu: OnMu::Unbounded,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::PulleyDefect.acts();
/// Index of `pulley` in [`Values`](crate::parameters::Values).
pub const PULLEY: usize = Effect::PulleyDefect.first_place();
/// Index of `mu`.
pub const MU: usize = PULLEY + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulleyDefect<T> {
    /// Number of the pulley, from 1 at the sensor; 0 for none.
    pub pulley: T,
    /// Its μ, dimensionless.
    pub mu: T,
}

impl<T: Scalar> PulleyDefect<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { pulley: value(PULLEY), mu: value(MU) }
    }

    /// Returns whether the pulley with this number is the defective one.
    #[inline(always)]
    pub fn is_at(&self, number: T) -> T::Mask {
        number.eq(self.pulley)
    }
}
