//! The winch's encoder.
//!
//! Without noise and with unlimited resolution, length and speed are those of the motion. Otherwise the drive only knows counts, and its speed is the
//! difference of two lengths over a cycle.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::simulate::mechanics::motion::CableMotion;

/// The encoder of one winch.
#[derive(Debug)]
pub struct Encoder {
    resolution_m: f64,
    noise_m: f64,
    random: ChaCha8Rng,
    last_length_m: Option<f64>,
}

impl Encoder {
    pub fn new(resolution_m: f64, noise_m: f64, random: ChaCha8Rng) -> Self {
        Self { resolution_m, noise_m, random, last_length_m: None }
    }

    /// Returns the logged values of a motion, one cycle after the last call.
    pub fn read(&mut self, motion: CableMotion, cycle_s: f64) -> CableMotion {
        if self.resolution_m <= 0.0 && self.noise_m <= 0.0 {
            return motion;
        }
        let noise: f64 = StandardNormal.sample(&mut self.random);
        let noisy_m = motion.length_m + self.noise_m * noise;
        let length_m = if self.resolution_m > 0.0 {
            libm::round(noisy_m / self.resolution_m) * self.resolution_m
        } else {
            noisy_m
        };
        let speed_m_per_s = self.last_length_m.map_or(0.0, |last_m| (length_m - last_m) / cycle_s);
        self.last_length_m = Some(length_m);
        CableMotion { length_m, speed_m_per_s }
    }
}
