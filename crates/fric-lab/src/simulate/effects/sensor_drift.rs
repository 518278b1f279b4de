//! `sensor_drift` in the simulated robot: a sensor whose zero creeps away, evenly from the start of the log.

use super::{Cause, TruthEffect};

#[derive(Debug)]
struct Creep {
    rate_n_per_s: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Creep { rate_n_per_s: (cause.value)("rate_n_per_s") })
}

impl TruthEffect for Creep {
    fn sensor_offset_n(&self, time_s: f64) -> f64 {
        self.rate_n_per_s * time_s
    }
}
