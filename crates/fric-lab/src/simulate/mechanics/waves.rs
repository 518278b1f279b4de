//! Slow variations: sums of a few sinusoids with seeded phases, and load steps with soft edges.
//!
//! These are pure functions of time: they need no integration and no memory, and do not jump wherever a run is cut or repeated.

use core::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;

use crate::random::uniform;

/// A sum of sinusoids.
#[derive(Clone, Debug)]
pub struct Waves {
    parts: Vec<Wave>,
}

#[derive(Clone, Copy, Debug)]
struct Wave {
    amplitude: f64,
    rad_per_s: f64,
    phase_rad: f64,
}

impl Waves {
    /// Creates one sinusoid per `(amplitude, hertz)`. Frequencies are drawn within ±20 %, so that no two cables vary in step; phases are drawn over
    /// the full circle.
    pub fn new(parts: &[(f64, f64)], random: &mut ChaCha8Rng) -> Self {
        let parts = parts.iter().map(|&(amplitude, hertz)| Wave {
            amplitude,
            rad_per_s: TAU * hertz * uniform(random, 0.8, 1.2),
            phase_rad: uniform(random, 0.0, TAU),
        });
        Self { parts: parts.collect() }
    }

    pub fn value(&self, time_s: f64) -> f64 {
        self.parts.iter().map(|wave| wave.amplitude * libm::sin(wave.rad_per_s * time_s + wave.phase_rad)).sum()
    }

    /// Returns the derivative with respect to time.
    pub fn rate(&self, time_s: f64) -> f64 {
        let rate = |wave: &Wave| wave.amplitude * wave.rad_per_s * libm::cos(wave.rad_per_s * time_s + wave.phase_rad);
        self.parts.iter().map(rate).sum()
    }

    /// Returns the sum with each sinusoid driven into saturation: it stays at ±amplitude and changes within a tenth of its period.
    pub fn steps(&self, time_s: f64) -> f64 {
        let step = |wave: &Wave| wave.amplitude * libm::tanh(5.0 * libm::sin(wave.rad_per_s * time_s + wave.phase_rad));
        self.parts.iter().map(step).sum()
    }
}
