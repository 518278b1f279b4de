//! Numbers that are the same on every platform.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Uniform};

/// A number between two, each as likely.
pub fn uniform(random: &mut ChaCha8Rng, min: f64, max: f64) -> f64 {
    // Only an empty or infinite range is refused, and the callers' are neither.
    Uniform::new_inclusive(min, max).map_or(min, |range| range.sample(random))
}
