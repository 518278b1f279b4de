//! Mains hum in the sensor's cable: one line in the spectrum of the sensor signal.

use core::f64::consts::TAU;

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, TruthEffect};
use crate::random::uniform;

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "hum",
    cause: "mains or motor current couples into the sensor's cable, a steady sinusoid of unknown phase",
    parameters: &[
        parameter("amplitude_n", "N", 0.1, [0.0, 1000.0]),
        parameter("frequency_hz", "Hz", 50.0, [0.01, 1e5]),
    ],
    build,
};

#[derive(Debug)]
struct Hum {
    amplitude_n: f64,
    rad_per_s: f64,
    phase_rad: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [amplitude_n, frequency_hz] = ["amplitude_n", "frequency_hz"].map(cause.value);
    let phase_rad = uniform(cause.random, 0.0, TAU);
    Box::new(Hum { amplitude_n, rad_per_s: TAU * frequency_hz, phase_rad })
}

impl TruthEffect for Hum {
    fn sensor_offset_n(&self, time_s: f64) -> f64 {
        self.amplitude_n * libm::sin(self.rad_per_s * time_s + self.phase_rad)
    }
}
