//! Contacts whose bristles are damped, as in the `LuGre` model of friction.
//!
//! The friction force of a bearing is `σ₀·z + σ₁·dz/dt`, where z is the deflection of its bristle, with the damping `σ₁ = lead_s·σ₀` (C. Canudas de
//! Wit, H. Olsson, K. J. Åström, P. Lischinsky, *A New Model for Control of Systems with Friction*, IEEE Trans. Autom. Control 40, 1995, eq. 1–3).
//! While a contact yields, its friction depends on the rate; while it slides at a constant speed, nothing changes. Together with the effect
//! `stribeck` it is the whole `LuGre` model.

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, TruthEffect};

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "bristle_damping",
    cause: "the grease of the bearings damps their contacts, whose friction depends on the rate at which they yield",
    parameters: &[parameter("lead_s", "s", 0.008, [0.0, 10.0])],
    build,
};

#[derive(Debug)]
struct Damped {
    lead_s: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Damped { lead_s: (cause.value)("lead_s") })
}

impl TruthEffect for Damped {
    fn bristle_lead_s(&self) -> f64 {
        self.lead_s
    }
}
