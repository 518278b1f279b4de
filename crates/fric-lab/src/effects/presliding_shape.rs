//! `presliding_shape` in the simulated robot: bristles that saturate earlier or later than the exponential.
//!
//! The exponent is that of [`presliding`](crate::simulate::bristle::presliding), solved at each stage of the integration.

use super::truth::{Cause, TruthEffect};
use super::{LabEffect, Sizing, Start, always, as_it_is};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts: as_it_is, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Bend {
    exponent: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Bend { exponent: (cause.value)("exponent") })
}

impl TruthEffect for Bend {
    fn presliding_exponent(&self) -> f64 {
        self.exponent
    }
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("exponent", 1.0 + scale.about(0.8))]
}
