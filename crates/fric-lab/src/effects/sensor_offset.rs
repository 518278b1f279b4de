//! `sensor_offset` in the simulated robot: a sensor that was not set to zero.

use fric_core::effects::sensor_offset::OFFSET;
use fric_core::parameters::Values;

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, as_it_is};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts: as_it_is, typical, is_more_than_usual };

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

/// Whether the zero is off by more of the mean load than laws of friction differ.
fn is_more_than_usual(values: &Values, around: &Around) -> bool {
    let load_n = around.sensor_ratio * around.mean_tension_n.abs();
    values[OFFSET].abs() > around.between_laws_ratio(values) * load_n
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("offset_n", scale.either(0.3))]
}
