//! `sensor_offset` in the simulated robot: a sensor that was not set to zero.

use super::truth::{Cause, TruthEffect};
use super::{LabEffect, Sizing, Start, always, as_it_is};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts: as_it_is, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Zero {
    offset_n: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Zero { offset_n: (cause.value)("offset_n") })
}

impl TruthEffect for Zero {
    fn sensor_offset_n(&self, _time_s: f64) -> f64 {
        self.offset_n
    }
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("offset_n", scale.either(0.3))]
}
