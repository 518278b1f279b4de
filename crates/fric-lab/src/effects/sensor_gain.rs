//! `sensor_gain` in the simulated robot: a sensor whose amplifier has another slope.

use fric_core::effects::sensor_gain::GAIN;
use fric_core::parameters::Values;

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, as_it_is};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts: as_it_is, typical, is_more_than_usual };

#[derive(Debug)]
struct Slope {
    gain: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Slope { gain: (cause.value)("gain") })
}

impl TruthEffect for Slope {
    fn sensor_gain(&self) -> f64 {
        self.gain
    }
}

/// Whether the gain is off by more than laws of friction differ.
fn is_more_than_usual(values: &Values, around: &Around) -> bool {
    (values[GAIN] - 1.0).abs() > around.between_laws_ratio(values)
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("gain", 1.0 + scale.either(0.03))]
}
