//! `pulley_defect` in the simulated robot: one pulley's bearing has run dry.

use fric_core::effects::pulley_defect::{MU, PULLEY};
use fric_core::parameters::{MU as MU_OF_ALL, Values};

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start};
use crate::random::uniform;

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual };

/// Start value of the defective pulley's friction, as a multiple of the others'.
const TIMES: f64 = 2.0;
/// Minimum friction of a defective pulley, as a multiple of the others'. Healthy pulleys differ by a tenth and more; one of three with 1.3 times the
/// friction of the others is no defect.
const LEAST_TIMES: f64 = 1.5;

#[derive(Debug)]
struct Dry {
    pulley: f64,
    mu: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [pulley, mu] = ["pulley", "mu"].map(cause.value);
    Box::new(Dry { pulley, mu })
}

impl TruthEffect for Dry {
    fn own_mu(&self, pulley: f64) -> Option<f64> {
        ((pulley - self.pulley).abs() < 0.5).then_some(self.mu)
    }
}

/// Starts with each pulley in turn.
fn starts(around: &Around) -> Vec<Start> {
    let of_pulley = |pulley| vec![("pulley", f64::from(pulley)), ("mu", TIMES * around.mu)];
    (1..=around.pulley_count).map(of_pulley).collect()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    // One of the three pulleys of a cable.
    let pulley = 1.0 + libm::floor(uniform(scale.random, 0.0, 3.0)).min(2.0);
    let mu = scale.mu * (1.0 + scale.about(4.0));
    vec![("pulley", pulley), ("mu", mu)]
}

/// Returns the values that say the same of the other of two pulleys, if the defective one rubs less than the other.
pub fn other_way(values: &Values, pulley_count: u32) -> Option<Values> {
    let (mu, mu_of_all) = (values[MU], values[MU_OF_ALL]);
    (pulley_count == 2 && values[PULLEY] > 0.0 && mu < mu_of_all).then(|| {
        let mut other = *values;
        other[PULLEY] = 3.0 - values[PULLEY];
        (other[MU], other[MU_OF_ALL]) = (mu_of_all, mu);
        other
    })
}

fn is_more_than_usual(values: &Values, _: &Around) -> bool {
    values[MU] > LEAST_TIMES * values[MU_OF_ALL]
}
