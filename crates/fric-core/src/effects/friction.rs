//! `coulomb`, `viscous`, `presliding`: the friction that every model has.
//!
//! Their parameters are μ, F_pv and σ of [`parameters`](crate::parameters), the keys of the robot file's `friction`. They have rows like the effects,
//! so that there is one list of causes ([`Effect`](super::Effect)); they are no entries of `effects` in a robot file.

use super::{EffectRow, Memory, OnMu};
use crate::parameters::{FRICTION, MU, SIGMA, VISCOUS};

/// Friction in proportion to the load of the bearing, `μ·F_N`.
pub const COULOMB_ROW: EffectRow = EffectRow {
    kind: "coulomb",
    cause: "the bearings of the pulleys rub in proportion to the cable force",
    remedy: "nothing unusual up to 0.03; above, check bearings and cable for wear, and the grooves for rubbing flanges",
    parameters: &[FRICTION[MU]],
    example: &[0.02],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// Friction in proportion to speed, `F_pv·v`.
pub const VISCOUS_ROW: EffectRow = EffectRow {
    kind: "viscous",
    cause: "the grease of the bearings resists in proportion to the speed",
    remedy: "thinner grease, or less of it",
    parameters: &[FRICTION[VISCOUS]],
    example: &[0.2],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// Friction that builds up over the first fractions of a millimetre after a reversal, [`dahl`](crate::dahl).
pub const PRESLIDING_ROW: EffectRow = EffectRow {
    kind: "presliding",
    cause: "the contacts give elastically before they slide, so friction builds up over a way after each reversal",
    remedy: "nothing is wrong with the machine: keep the stiffness",
    parameters: &[FRICTION[SIGMA]],
    example: &[1000.0],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};
