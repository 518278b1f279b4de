//! Drifting noise: a slowly moving zero, as amplifiers have.
//!
//! `w_{k+1} = φ·w_k + √(1 − φ²)·s·n_k`, `φ = e^{−T/τ}`: normally distributed with standard deviation s, correlated over the time τ (an
//! Ornstein-Uhlenbeck process, sampled exactly every cycle T). It starts in its stationary state.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// The drift of one signal.
#[derive(Debug)]
pub struct Wander {
    standard_deviation_n: f64,
    kept_ratio: f64,
    value_n: f64,
    random: ChaCha8Rng,
}

impl Wander {
    pub fn new(standard_deviation_n: f64, time_constant_s: f64, cycle_s: f64, mut random: ChaCha8Rng) -> Self {
        let start: f64 = StandardNormal.sample(&mut random);
        let kept_ratio = libm::exp(-cycle_s / time_constant_s);
        Self { standard_deviation_n, kept_ratio, value_n: standard_deviation_n * start, random }
    }

    /// Returns the present value and advances by a cycle.
    pub fn advance(&mut self) -> f64 {
        let value_n = self.value_n;
        if self.standard_deviation_n > 0.0 {
            let pushed: f64 = StandardNormal.sample(&mut self.random);
            let fresh_n = libm::sqrt(1.0 - self.kept_ratio * self.kept_ratio) * self.standard_deviation_n * pushed;
            self.value_n = self.kept_ratio * value_n + fresh_n;
        }
        value_n
    }
}
