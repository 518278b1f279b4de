//! Random numbers that are equal on every computer platform.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Uniform};

/// Returns a uniformly distributed number between `min` and `max`.
pub fn uniform(random: &mut ChaCha8Rng, min: f64, max: f64) -> f64 {
    // Only an empty or infinite range is refused, and the callers pass neither.
    Uniform::new_inclusive(min, max).map_or(min, |range| range.sample(random))
}
