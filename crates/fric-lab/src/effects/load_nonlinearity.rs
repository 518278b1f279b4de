//! `load_nonlinearity` in the simulated robot: contacts that flatten under load, so that friction is not proportional to it.
//!
//! Sliding friction is `μ·F_ref·(F_N/F_ref)^p`, with the exact momentary normal force.

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Flattening {
    exponent: f64,
    reference_n: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [exponent, reference_n] = ["exponent", "reference_n"].map(cause.value);
    Box::new(Flattening { exponent, reference_n })
}

impl TruthEffect for Flattening {
    fn load_factor(&self, normal_force_n: f64) -> f64 {
        // A bearing without load has no friction. For an exponent below 1 the power alone would be infinite there.
        if normal_force_n > 0.0 { libm::pow(normal_force_n / self.reference_n, self.exponent - 1.0) } else { 0.0 }
    }
}

fn starts(around: &Around) -> Vec<Start> {
    vec![vec![("reference_n", around.tension_n)]]
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("exponent", 1.0 + scale.either(0.3)), ("reference_n", scale.normal_n)]
}
