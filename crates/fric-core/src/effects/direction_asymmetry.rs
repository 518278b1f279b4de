//! `direction_asymmetry`: friction that differs between paying out and reeling in.
//!
//! Equation: `μ(s) = μ·(1 + s·coulomb_ratio)`, `F_pv(s) = F_pv·(1 + s·viscous_ratio)` with the direction s of the motion, +1
//! paying out. The direction of the one is that of the displacement at the pulley, of the other that of the speed.
//! Neutral: both 0.
//!
//! Cause: seals, cages or a tilted bearing rub differently the two ways; a cable that runs off a flange as well.

use super::{Acting, Effect, EffectRow, Memory, OnMu, first};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements at several speeds in both directions";

/// What it is.
pub const ROW: EffectRow = EffectRow {
    kind: "direction_asymmetry",
    cause: "a bearing, its seal or the groove rubs more one way than the other",
    remedy: "check the alignment of the pulleys with the cable, and the bearings for damage on one side",
    parameters: &[
        ParameterRow {
            key: "coulomb_ratio",
            unit: "1",
            neutral: 0.0,
            min: -0.95,
            max: 0.95,
            fitted: true,
            excitation: EXCITATION,
        },
        ParameterRow {
            key: "viscous_ratio",
            unit: "1",
            neutral: 0.0,
            min: -0.95,
            max: 0.95,
            fitted: true,
            excitation: EXCITATION,
        },
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

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Effect::DirectionAsymmetry.acts();
/// Place of `coulomb_ratio` in [`Values`](crate::parameters::Values).
pub const COULOMB: usize = Effect::DirectionAsymmetry.first_place();
/// Place of `viscous_ratio`.
pub const VISCOUS: usize = COULOMB + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionAsymmetry<T> {
    /// Share by which μ is higher paying out, and lower reeling in, 1.
    pub coulomb_ratio: T,
    /// The same of F_pv, 1.
    pub viscous_ratio: T,
}

impl<T: Scalar> DirectionAsymmetry<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { coulomb_ratio: value(COULOMB), viscous_ratio: value(VISCOUS) }
    }

    /// Factor on μ for a direction of the displacement (−1, 0, +1).
    #[inline(always)]
    pub fn coulomb_factor(&self, direction: T) -> T {
        T::splat(1.0) + self.coulomb_ratio.scale(direction)
    }

    /// Factor on F_pv for a direction of the speed (−1, 0, +1).
    #[inline(always)]
    pub fn viscous_factor(&self, direction: T) -> T {
        T::splat(1.0) + self.viscous_ratio.scale(direction)
    }
}
