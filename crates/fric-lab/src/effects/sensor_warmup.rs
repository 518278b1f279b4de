//! `sensor_warmup` in the simulated robot: an amplifier that was switched on shortly before.
//!
//! The temperature approaches its final value exponentially, as in a body with constant heating and proportional cooling; the sensor's zero follows
//! it.

use fric_core::effects::sensor_warmup::TIME_CONSTANT;
use fric_core::parameters::Values;

use super::truth::{Cause, TruthEffect, warmed};
use super::{Around, LabEffect, Sizing, Start};
use crate::random::uniform;

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: lasts };

#[derive(Debug)]
struct SwitchedOn {
    final_n: f64,
    time_constant_s: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [final_n, time_constant_s] = ["final_n", "time_constant_s"].map(cause.value);
    Box::new(SwitchedOn { final_n, time_constant_s })
}

impl TruthEffect for SwitchedOn {
    fn sensor_offset_n(&self, time_s: f64) -> f64 {
        self.final_n * warmed(time_s, self.time_constant_s)
    }
}

fn starts(around: &Around) -> Vec<Start> {
    around.time_constants_s().map(|time_s| vec![("time_constant_s", time_s)]).to_vec()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    let final_n = scale.either(0.3);
    vec![("final_n", final_n), ("time_constant_s", scale.duration_s * uniform(scale.random, 0.1, 0.3))]
}

fn lasts(values: &Values, around: &Around) -> bool {
    around.lasts_s(values[TIME_CONSTANT])
}
