//! `pulley_defect`: one pulley with a friction of its own.
//!
//! Equation: at the pulley of the number `pulley`, counted from 1 at the sensor, `mu` of this effect stands in the place of the cable's μ; what changes
//! the friction of all (`stribeck`, `friction_drift`, …) changes it likewise. Where the sensor pulley could not bear it the cycle
//! holds it, as for every effect that raises μ. Neutral: `pulley = 0`, none.
//!
//! Cause: a bearing that has run dry, has seized or was damaged; a cable that rubs on a flange or on the frame.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::{GREATEST_MU, ParameterRow};
use crate::robot::MAX_PULLEYS;
use crate::scalar::Scalar;

const EXCITATION: &str =
    "long movements in both directions in which the wraps of the pulleys, or the forces at them, differ";

#[expect(clippy::cast_precision_loss, reason = "a small count")]
const MOST_PULLEYS: f64 = MAX_PULLEYS as f64;

/// What it is.
pub const ROW: EffectRow = EffectRow {
    kind: "pulley_defect",
    cause: "one pulley rubs otherwise than the rest: its bearing is dry, seized or damaged, or the cable touches a flange there",
    remedy: "look at this pulley: turn it by hand, clean and grease its bearing or replace it",
    parameters: &[
        ParameterRow {
            key: "pulley",
            unit: "1",
            neutral: 0.0,
            min: 0.0,
            max: MOST_PULLEYS,
            fitted: false,
            excitation: EXCITATION,
        },
        ParameterRow {
            key: "mu",
            unit: "1",
            neutral: 0.0,
            min: 0.0,
            max: GREATEST_MU,
            fitted: true,
            excitation: EXCITATION,
        },
    ],
    example: &[1.0, 0.1],
    memory: Memory::Nothing,
    on_mu: OnMu::Unbounded,
    goes_by_time: false,
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Effect::PulleyDefect.acts();
/// Place of `pulley` in [`Values`](crate::parameters::Values).
pub const PULLEY: usize = Effect::PulleyDefect.first_place();
/// Place of `mu`.
pub const MU: usize = PULLEY + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulleyDefect<T> {
    /// Number of the pulley, from 1 at the sensor; 0 for none.
    pub pulley: T,
    /// Its μ, 1.
    pub mu: T,
}

impl<T: Scalar> PulleyDefect<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { pulley: value(PULLEY), mu: value(MU) }
    }

    /// Where the pulley of a number is the one.
    #[inline(always)]
    pub fn is_at(&self, number: T) -> T::Mask {
        number.eq(self.pulley)
    }
}
