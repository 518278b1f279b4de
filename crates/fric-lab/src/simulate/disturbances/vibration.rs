//! A sensor that shakes on its mount, or with the frame that carries it, after each change of speed of the winch.
//!
//! An oscillator of one mass: each change of speed is a blow, and what the sensor shows in addition is its displacement. `amplitude_n` is how
//! far it rings after a sudden change of speed by 0.1 m/s.

use core::f64::consts::TAU;

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, Contact, TruthEffect};

/// Change of speed that `amplitude_n` is stated for, m/s.
const BLOW_M_PER_S: f64 = 0.1;

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "vibration",
    cause: "the sensor's mount or the frame rings after each change of speed",
    parameters: &[
        parameter("amplitude_n", "N", 1.0, [0.0, 1e6]),
        parameter("frequency_hz", "Hz", 18.0, [0.1, 1e4]),
        parameter("damping_ratio", "1", 0.02, [1e-4, 0.9]),
    ],
    build,
};

#[derive(Debug)]
struct Ringing {
    newtons_per_speed: f64,
    decay_per_s: f64,
    rad_per_s: f64,
    /// Displacement, and the part that is a quarter of a turn ahead, in the unit of a speed.
    phasor: [f64; 2],
    speed_m_per_s: Option<f64>,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [amplitude_n, frequency_hz, damping_ratio] = ["amplitude_n", "frequency_hz", "damping_ratio"].map(cause.value);
    let undamped = TAU * frequency_hz;
    Box::new(Ringing {
        newtons_per_speed: amplitude_n / BLOW_M_PER_S,
        decay_per_s: damping_ratio * undamped,
        rad_per_s: undamped * libm::sqrt(1.0 - damping_ratio * damping_ratio),
        phasor: [0.0; 2],
        speed_m_per_s: None,
    })
}

impl TruthEffect for Ringing {
    fn moved(&mut self, contact: &Contact, step_s: f64) {
        let (sin, cos) = libm::sincos(self.rad_per_s * step_s);
        let decay = libm::exp(-self.decay_per_s * step_s);
        let [shown, ahead] = self.phasor;
        let blow = contact.speed_m_per_s - self.speed_m_per_s.unwrap_or(contact.speed_m_per_s);
        self.phasor = [decay * (shown * cos + ahead * sin), decay * (ahead * cos - shown * sin) + blow];
        self.speed_m_per_s = Some(contact.speed_m_per_s);
    }

    fn sensor_offset_n(&self, _time_s: f64) -> f64 {
        self.newtons_per_speed * self.phasor[0]
    }
}
