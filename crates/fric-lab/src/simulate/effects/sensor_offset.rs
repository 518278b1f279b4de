//! `sensor_offset` in the simulated robot: a sensor that was not set to zero.

use super::{Cause, TruthEffect};

#[derive(Debug)]
struct Zero {
    offset_n: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Zero { offset_n: (cause.value)("offset_n") })
}

impl TruthEffect for Zero {
    fn sensor_offset_n(&self, _time_s: f64) -> f64 {
        self.offset_n
    }
}
