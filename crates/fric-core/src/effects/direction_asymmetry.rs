//! `direction_asymmetry`: friction that differs between paying out and reeling in.
//!
//! Equation: `μ(s) = μ·(1 + s·coulomb_ratio)`, `F_pv(s) = F_pv·(1 + s·viscous_ratio)` with the direction s of the motion, +1 paying out. For μ it is
//! the direction of the displacement at the pulley, for F_pv that of the speed. Neutral: both 0.
//!
//! Cause: seals, cages or a tilted bearing have different friction in the two directions, and so does a cable that runs off a flange.

use super::{Acting, Effect, EffectRow, Memory, OnMu, first};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements at several speeds in both directions";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "direction_asymmetry",
    cause: "a bearing, its seal or the groove rubs more one way than the other",
    remedy: "check the alignment of the pulleys with the cable, and the bearings for damage on one side",
    parameters: &[
        ParameterRow::fitted("coulomb_ratio", "1", [-0.95, 0.0, 0.95], EXCITATION),
        ParameterRow::fitted("viscous_ratio", "1", [-0.95, 0.0, 0.95], EXCITATION),
    ],
    example: &[0.25, -0.2],
    memory: Memory::Nothing,
    on_mu: OnMu::AtMost {
        factor: |values| 1.0 + first(values).abs(),
        key: "coulomb_ratio",
        problem: "raises the friction one way, `mu`·(1 + `coulomb_ratio`), beyond 0.9; lower it, or `mu`",
    },
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::DirectionAsymmetry.acts();
/// Index of `coulomb_ratio` in [`Values`](crate::parameters::Values).
pub const COULOMB: usize = Effect::DirectionAsymmetry.first_place();
/// Index of `viscous_ratio`.
pub const VISCOUS: usize = COULOMB + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionAsymmetry<T> {
    /// Fraction by which μ is greater paying out, and smaller reeling in.
    pub coulomb_ratio: T,
    /// The same for F_pv.
    pub viscous_ratio: T,
}

impl<T: Scalar> DirectionAsymmetry<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { coulomb_ratio: value(COULOMB), viscous_ratio: value(VISCOUS) }
    }

    /// Returns the factor on μ for a direction of the displacement (−1, 0, +1).
    #[inline(always)]
    pub fn coulomb_factor(&self, direction: T) -> T {
        T::splat(1.0) + self.coulomb_ratio.scale(direction)
    }

    /// Returns the factor on F_pv for a direction of the speed (−1, 0, +1).
    #[inline(always)]
    pub fn viscous_factor(&self, direction: T) -> T {
        T::splat(1.0) + self.viscous_ratio.scale(direction)
    }
}
