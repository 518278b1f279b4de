//! A signal for tests.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// A force of 10 ± 3 N with 0.01 N of noise, written with steps of `step_n`; `repeats` tells how often each value is shown.
pub fn shown_n(step_n: f64, repeats: impl Fn(usize) -> usize) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let noise = std::iter::repeat_with(|| -> f64 { StandardNormal.sample(&mut random) });
    let force_n = |(place, noise): (i32, f64)| 10.0 + 3.0 * (0.002 * f64::from(place)).sin() + 0.01 * noise;
    let stepped_n = (0..4000).zip(noise).map(force_n).map(|force_n| (force_n / step_n).round() * step_n);
    stepped_n.enumerate().flat_map(|(place, force_n)| std::iter::repeat_n(force_n, repeats(place))).collect()
}
