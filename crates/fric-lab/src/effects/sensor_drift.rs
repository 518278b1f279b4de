//! `sensor_drift` in the simulated robot: a sensor whose zero drifts at a constant rate from the start of the log until the drift ends.

use super::truth::{Cause, TruthEffect, drifted_s};
use super::{Around, LabEffect, Sizing, Start, always};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Creep {
    rate_n_per_s: f64,
    until_s: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Creep { rate_n_per_s: (cause.value)("rate_n_per_s"), until_s: (cause.value)("until_s") })
}

impl TruthEffect for Creep {
    fn sensor_offset_n(&self, time_s: f64) -> f64 {
        self.rate_n_per_s * drifted_s(time_s, self.until_s)
    }
}

fn starts(around: &Around) -> Vec<Start> {
    vec![vec![("until_s", around.end_s)]]
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("rate_n_per_s", scale.either(0.005))]
}
