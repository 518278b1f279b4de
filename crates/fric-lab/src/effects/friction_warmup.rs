//! `friction_warmup` in the simulated robot: bearings that warm up, so that their grease becomes thinner.
//!
//! The temperature approaches its final value exponentially, as in a body with constant heating and proportional cooling; μ follows it.

use fric_core::effects::friction_warmup::TIME_CONSTANT;
use fric_core::parameters::Values;

use super::truth::{Cause, Contact, TruthEffect, warmed};
use super::{Around, LabEffect, Sizing, Start};
use crate::random::uniform;

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: lasts };

#[derive(Debug)]
struct Warming {
    ratio: f64,
    time_constant_s: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [ratio, time_constant_s] = ["ratio", "time_constant_s"].map(cause.value);
    Box::new(Warming { ratio, time_constant_s })
}

impl TruthEffect for Warming {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        1.0 + self.ratio * warmed(contact.time_s, self.time_constant_s)
    }
}

fn starts(around: &Around) -> Vec<Start> {
    around.time_constants_s().map(|time_s| vec![("time_constant_s", time_s)]).to_vec()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    let ratio = scale.either(0.4);
    vec![("ratio", ratio), ("time_constant_s", scale.duration_s * uniform(scale.random, 0.1, 0.3))]
}

fn lasts(values: &Values, around: &Around) -> bool {
    around.lasts_s(values[TIME_CONSTANT])
}
