//! `cable_elasticity` in the simulated robot: a cable that is a spring.
//!
//! Its material lies `(j/n)·c·F` further out at pulley j of n under the tension F at the platform; as F changes, it runs
//! over the pulleys, the far ones most, whether the winch turns or not. Within a cycle F changes evenly.

use super::{Cause, TruthEffect};

#[derive(Debug)]
struct Spring {
    compliance_m_per_n: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Spring { compliance_m_per_n: (cause.value)("compliance_m_per_n") })
}

impl TruthEffect for Spring {
    fn compliance_m_per_n(&self) -> f64 {
        self.compliance_m_per_n
    }
}
