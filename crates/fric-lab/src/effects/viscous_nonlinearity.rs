//! `viscous_nonlinearity` in the simulated robot: churned grease, turbulent air drag.
//!
//! The n pulleys of a cable each take `c/n·v·|v|` from the tension, where v is the speed of the cable over the pulley.

use super::truth::{Cause, TruthEffect};
use super::{LabEffect, Sizing, Start, always, as_it_is};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts: as_it_is, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Churning {
    quadratic_n_s2_per_m2: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Churning { quadratic_n_s2_per_m2: (cause.value)("quadratic_n_s2_per_m2") })
}

impl TruthEffect for Churning {
    fn viscous_n(&self, speed_m_per_s: f64) -> f64 {
        self.quadratic_n_s2_per_m2 * speed_m_per_s * speed_m_per_s.abs()
    }
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("quadratic_n_s2_per_m2", scale.about(0.9))]
}
