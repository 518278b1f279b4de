//! `load_nonlinearity`: friction that does not grow in proportion to the load.
//!
//! Equation: `f_c = μ·F_N·(F_N/F_0)^(exponent − 1)`, so that `f_c ∝ F_N^exponent` and `μ` is the coefficient at the normal force `F_0 = reference_n`.
//! This fixed scale is not identified, because it is equivalent to μ. Neutral: `exponent = 1`, whatever `reference_n`.
//!
//! μ and the load of a pulley depend on each other. With `lumped` presliding two steps of Newton's method solve the two: to 0.3 % of a pulley's mean
//! tension for an exponent below 1 at any load, and to 4 % above 1. The exception is friction that grows so fast with the load that the pulley
//! nearly locks: there the computed friction can be several times too small. With `per_pulley` the stored friction follows from cycle to cycle.
//!
//! Cause: the contact area of the bearing's rolling elements, or of the groove, grows less or more than the force on it.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements in both directions at cable forces that differ by a factor of two and more";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "load_nonlinearity",
    cause: "contact surfaces of the bearings grow with the load, so friction is not proportional to it",
    remedy: "larger bearings, or bearings meant for this load",
    parameters: &[
        ParameterRow::fitted("exponent", "1", [0.2, 1.0, 3.0], EXCITATION),
        ParameterRow::setting("reference_n", "N", [1e-3, 10.0, 1e6], EXCITATION),
    ],
    example: &[0.7, 8.0],
    memory: Memory::Nothing,
    on_mu: OnMu::Unbounded,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::LoadNonlinearity.acts();
/// Index of `exponent` in [`Values`](crate::parameters::Values).
pub const EXPONENT: usize = Effect::LoadNonlinearity.first_place();
/// Index of `reference_n`.
pub const REFERENCE: usize = EXPONENT + 1;

/// Ratio of normal force to reference below which the power law is not used.
const LEAST_RELATIVE: f64 = 1e-6;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadNonlinearity<T> {
    /// Exponent of the normal force, dimensionless.
    pub exponent: T,
    /// Normal force at which μ is the coefficient, N.
    pub reference_n: T,
}

impl<T: Scalar> LoadNonlinearity<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { exponent: value(EXPONENT), reference_n: value(REFERENCE) }
    }

    /// Returns the factor on μ at a normal force (N). Below a millionth of the reference, it is that at a millionth.
    #[inline(never)]
    pub fn factor(&self, normal_n: T) -> T {
        let relative = (normal_n / self.reference_n).max(T::splat(LEAST_RELATIVE));
        relative.pow(self.exponent - T::splat(1.0))
    }
}
