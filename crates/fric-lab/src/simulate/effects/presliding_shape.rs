//! `presliding_shape` in the simulated robot: bristles that give way earlier or later than the exponential.
//!
//! The exponent of [`presliding`](crate::simulate::presliding), solved stage by stage of the integration.

use super::{Cause, TruthEffect};

#[derive(Debug)]
struct Bend {
    exponent: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Bend { exponent: (cause.value)("exponent") })
}

impl TruthEffect for Bend {
    fn presliding_exponent(&self) -> f64 {
        self.exponent
    }
}
