//! `load_nonlinearity`: friction that does not grow in proportion to the load.
//!
//! Equation: `f_c = μ·F_N·(F_N/F_0)^(exponent − 1)`, so that `f_c ∝ F_N^exponent` and `μ` is the coefficient at the normal
//! force `F_0 = reference_n`, a fixed scale that is not identified: it and μ are one. Neutral: `exponent = 1`, whatever `reference_n`.
//!
//! Cause: the contact of the bearing's rolling elements, or of the groove, grows less or more than the force on it.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements in both directions at cable forces that differ by a factor of two and more";

/// What it is.
pub const ROW: EffectRow = EffectRow {
    kind: "load_nonlinearity",
    cause: "contact surfaces of the bearings grow with the load, so friction is not proportional to it",
    remedy: "larger bearings, or bearings meant for this load",
    parameters: &[
        ParameterRow {
            key: "exponent",
            unit: "1",
            neutral: 1.0,
            min: 0.2,
            max: 3.0,
            fitted: true,
            excitation: EXCITATION,
        },
        ParameterRow {
            key: "reference_n",
            unit: "N",
            neutral: 10.0,
            min: 1e-3,
            max: 1e6,
            fitted: false,
            excitation: EXCITATION,
        },
    ],
    example: &[0.7, 8.0],
    memory: Memory::Nothing,
    on_mu: OnMu::Unbounded,
    goes_by_time: false,
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Effect::LoadNonlinearity.acts();
/// Place of `exponent` in [`Values`](crate::parameters::Values).
pub const EXPONENT: usize = Effect::LoadNonlinearity.first_place();
/// Place of `reference_n`.
pub const REFERENCE: usize = EXPONENT + 1;

/// The normal force beside the reference below which the power law says nothing.
const LEAST_RELATIVE: f64 = 1e-6;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadNonlinearity<T> {
    /// Exponent of the normal force, 1.
    pub exponent: T,
    /// Normal force at which μ is the coefficient, N.
    pub reference_n: T,
}

impl<T: Scalar> LoadNonlinearity<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { exponent: value(EXPONENT), reference_n: value(REFERENCE) }
    }

    /// Factor on μ at a normal force (N); at a millionth of the reference, and below, that of a millionth.
    #[inline(never)]
    pub fn factor(&self, normal_n: T) -> T {
        let relative = (normal_n / self.reference_n).max(T::splat(LEAST_RELATIVE));
        relative.pow(self.exponent - T::splat(1.0))
    }
}
