//! A sensor that rings on its mount, or with the frame that carries it, whenever the winch starts or turns round.
//!
//! The mount is a damped oscillator. Each start and each reversal strikes it, by the same blow in the direction of motion, and the sensor
//! shows its displacement in addition to the force.

use core::f64::consts::TAU;

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, Contact, TruthEffect};

/// Below this speed the winch stands still, m/s.
const STILL_M_PER_S: f64 = 1e-3;

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "vibration",
    cause: "the sensor's mount or the frame rings after each start and reversal of the winch",
    parameters: &[
        parameter("amplitude_n", "N", 0.2, [0.0, 1000.0]),
        parameter("frequency_hz", "Hz", 18.0, [0.1, 1e4]),
        parameter("damping_ratio", "1", 0.02, [1e-4, 0.9]),
    ],
    build,
};

#[derive(Debug)]
struct Ringing {
    amplitude_n: f64,
    decay_per_s: f64,
    rad_per_s: f64,
    /// What is shown, N, and the part that is a quarter of a turn ahead.
    phasor_n: [f64; 2],
    /// −1, 0 or 1.
    direction: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [amplitude_n, frequency_hz, damping_ratio] = ["amplitude_n", "frequency_hz", "damping_ratio"].map(cause.value);
    let undamped = TAU * frequency_hz;
    Box::new(Ringing {
        amplitude_n,
        decay_per_s: damping_ratio * undamped,
        rad_per_s: undamped * libm::sqrt(1.0 - damping_ratio * damping_ratio),
        phasor_n: [0.0; 2],
        direction: 0.0,
    })
}

impl TruthEffect for Ringing {
    fn moved(&mut self, contact: &Contact, step_s: f64) {
        let (sin, cos) = libm::sincos(self.rad_per_s * step_s);
        let decay = libm::exp(-self.decay_per_s * step_s);
        let [shown_n, ahead_n] = self.phasor_n;
        let speed = contact.speed_m_per_s;
        let direction = if speed.abs() < STILL_M_PER_S { 0.0 } else { speed.signum() };
        let blow_n = if direction * (direction - self.direction) > 0.0 { direction * self.amplitude_n } else { 0.0 };
        self.phasor_n = [decay * (shown_n * cos + ahead_n * sin), decay * (ahead_n * cos - shown_n * sin) + blow_n];
        self.direction = direction;
    }

    fn sensor_offset_n(&self, _time_s: f64) -> f64 {
        self.phasor_n[0]
    }
}
