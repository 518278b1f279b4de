//! A sensor whose zero follows a temperature that rises and falls.

use core::f64::consts::TAU;

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, TruthEffect};
use crate::random::uniform;

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "warming",
    cause: "a fan or a heater that cycles warms and cools the sensor, whose zero follows slowly",
    parameters: &[parameter("amplitude_n", "N", 0.1, [0.0, 1000.0]), parameter("period_s", "s", 20.0, [0.1, 1e6])],
    build,
};

#[derive(Debug)]
struct Warming {
    amplitude_n: f64,
    rad_per_s: f64,
    phase_rad: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [amplitude_n, period_s] = ["amplitude_n", "period_s"].map(cause.value);
    Box::new(Warming { amplitude_n, rad_per_s: TAU / period_s, phase_rad: uniform(cause.random, 0.0, TAU) })
}

impl TruthEffect for Warming {
    fn sensor_offset_n(&self, time_s: f64) -> f64 {
        self.amplitude_n * libm::sin(self.rad_per_s * time_s + self.phase_rad)
    }
}
