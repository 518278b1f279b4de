//! `sensor_gain` in the simulated robot: a sensor whose amplifier is set to another slope.

use super::{Cause, TruthEffect};

#[derive(Debug)]
struct Slope {
    gain: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Slope { gain: (cause.value)("gain") })
}

impl TruthEffect for Slope {
    fn sensor_gain(&self) -> f64 {
        self.gain
    }
}
