//! Estimates the noise of sensor and reference together, from the residual alone.
//!
//! Differences of fourth order, `(r₀ − 4r₁ + 6r₂ − 4r₃ + r₄)/√70`, preserve white noise and nearly remove slow changes, which the model misses. Their
//! mean square is computed over short blocks, and the median of these is used, so that a few noisier stretches do not count. A missing sample removes
//! only the differences that contain it: a block continues after a gap. Correlated noise is not detected.

/// Number of samples in a block.
const BLOCK: usize = 200;
/// The same for a signal that rests now and then, and the number of such blocks that tell as much as one long one. A run may not rest for longer.
const REST_BLOCK: usize = 50;
const FEWEST_REST_BLOCKS: usize = 4;
/// Binomial coefficients of the difference, and the root of the sum of their squares.
const COEFFICIENTS: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
const NORM: f64 = 8.366_600_265_340_756;
/// Number of independent differences that each overlapping difference of a block is worth.
const INDEPENDENT_RATIO: f64 = 0.3;

/// Relative standard error of the noise variance from one sample; from n samples it is the `√n`-th part. Of a block's mean square it is `√(2/(0.3·n))`, and of a
/// median 1.25 times that of a mean.
pub const VARIANCE_ERROR: f64 = 3.2;

/// Returns the ratio of the mean of a χ² distribution to its median, for the overlapping differences of a block: `(1 − 2/(9·n))⁻³`.
fn mean_per_median(block: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let count = INDEPENDENT_RATIO * block as f64;
    (1.0 - 2.0 / (9.0 * count)).powi(-3)
}

/// Returns the standard deviation of the white noise in a residual, in its unit. The residual is NaN where a sample is missing. Returns `None` if the
/// samples with four neighbours do not fill a block.
pub fn white_noise(residual: &[f64]) -> Option<f64> {
    white_noise_in(residual, BLOCK)
}

/// The same for noise that `reach` consecutive samples share in part, as a reference that was interpolated: from samples that far apart.
pub fn white_noise_apart(residual: &[f64], reach: usize) -> Option<f64> {
    if reach <= 1 {
        return white_noise(residual);
    }
    let interleaved = (0..reach).flat_map(|first| residual.iter().skip(first).step_by(reach).chain(&[f64::NAN]));
    white_noise(&interleaved.copied().collect::<Vec<f64>>())
}

/// The same over blocks of so many samples, for residuals that are short.
#[must_use]
pub fn white_noise_in(residual: &[f64], block: usize) -> Option<f64> {
    let mut squares = block_squares(residual, block);
    if squares.is_empty() {
        return None;
    }
    let middle = squares.len() / 2;
    let (_, median, _) = squares.select_nth_unstable_by(middle, f64::total_cmp);
    Some((*median * mean_per_median(block)).sqrt())
}

/// Returns the same for a signal that itself changes, if the noise is permanent, from the blocks in which the signal changes by less than `usual_change`
/// standard deviations of the noise from sample to sample. Where it changes faster, uncertain times of the samples look like noise. Returns `None` if
/// there are too few such blocks, or a tenth of all has less than half of the noise, as with the steps of a resolution while nothing moves, or where the signal
/// only looks like noise when it starts to move.
pub fn lasting_white_noise(signal: &[f64], usual_change: f64) -> Option<f64> {
    // White noise alone changes by √2 standard deviations from sample to sample.
    let most = 2.0 + usual_change * usual_change;
    let blocks = blocks_of(signal, REST_BLOCK, |window| [fourth_difference(window), window[2] - window[1]]);
    let of_quantile = |mut squares: Vec<f64>, divisor: usize| {
        let place = squares.len() / divisor;
        (place < squares.len()).then(|| *squares.select_nth_unstable_by(place, f64::total_cmp).1)
    };
    let resting: Vec<f64> =
        blocks.iter().filter(|[square, change]| *change < most * square).map(|[square, _]| *square).collect();
    if resting.len() < FEWEST_REST_BLOCKS {
        return None;
    }
    let median = of_quantile(resting, 2)?;
    let quiet = of_quantile(blocks.iter().map(|[square, _]| *square).collect(), 10)?;
    (quiet > 0.25 * median).then(|| (median * mean_per_median(REST_BLOCK)).sqrt())
}

/// The same with the stretches that have more: root mean square over all blocks. An encoder's steps, for one, make noise of a model's
/// accelerations while the cable moves.
#[must_use]
pub fn white_noise_throughout(residual: &[f64]) -> Option<f64> {
    let squares = block_squares(residual, BLOCK);
    #[expect(clippy::cast_precision_loss, reason = "a count of blocks")]
    let count = squares.len() as f64;
    (count > 0.0).then(|| (squares.iter().sum::<f64>() / count).sqrt())
}

/// Returns the mean square of the differences in each block of `block` samples.
fn block_squares(residual: &[f64], block: usize) -> Vec<f64> {
    blocks_of(residual, block, |window| [fourth_difference(window)]).into_iter().map(|[square]| square).collect()
}

fn fourth_difference(window: &[f64]) -> f64 {
    window.iter().zip(COEFFICIENTS).map(|(number, factor)| number * factor).sum::<f64>() / NORM
}

/// Returns, for each block of `block` windows of five samples, the mean squares of some numbers of a window.
fn blocks_of<const N: usize>(signal: &[f64], block: usize, of: impl Fn(&[f64]) -> [f64; N]) -> Vec<[f64; N]> {
    let stretches = signal.split(|number| !number.is_finite());
    let numbers: Vec<[f64; N]> = stretches.flat_map(|stretch| stretch.windows(COEFFICIENTS.len()).map(&of)).collect();
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let mean_square = |part: &[[f64; N]], place: usize| {
        part.iter().map(|numbers| numbers[place] * numbers[place]).sum::<f64>() / block as f64
    };
    numbers.chunks_exact(block).map(|part| std::array::from_fn(|place| mean_square(part, place))).collect()
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn sees_white_noise_below_what_changes_slowly() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for slow_n in [0.0, 0.1, 1.0] {
            let residual: Vec<f64> = (0..50_000)
                .map(|k| {
                    let noise: f64 = StandardNormal.sample(&mut random);
                    let gap = if k % 7000 == 0 { f64::NAN } else { 0.0 };
                    0.0141 * noise + slow_n * (f64::from(k) * 0.006).sin() + gap
                })
                .collect();
            let found = white_noise(&residual).unwrap();
            assert!((found / 0.0141 - 1.0).abs() < 0.015, "{slow_n}: {found}");
        }
    }

    #[test]
    fn noise_that_neighbours_share_is_seen_whole() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let noise: Vec<f64> = std::iter::repeat_with(|| StandardNormal.sample(&mut random)).take(50_000).collect();
        let halves: Vec<f64> = noise.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let found = white_noise_apart(&halves, 2).unwrap();
        assert!((found / 0.5_f64.sqrt() - 1.0).abs() < 0.015, "{found}");
        assert!(white_noise(&halves).unwrap() < 0.5);
        assert_eq!(white_noise_apart(&noise, 1), white_noise(&noise));
    }

    #[test]
    fn gaps_do_not_hide_it() {
        let mut random = ChaCha8Rng::seed_from_u64(2);
        for distance in [150, 37, 6] {
            let residual: Vec<f64> = (0..50_000)
                .map(|k| {
                    let noise: f64 = StandardNormal.sample(&mut random);
                    if k % distance == 0 { f64::NAN } else { 0.0141 * noise + (f64::from(k) * 0.006).sin() }
                })
                .collect();
            for found in [white_noise(&residual), white_noise_throughout(&residual)] {
                let found = found.unwrap();
                assert!((found / 0.0141 - 1.0).abs() < 0.03, "{distance}: {found}");
            }
        }
    }

    /// A length that is known to 3 µm, at rest and while it moves; one that is exact, with times that are uncertain by a third of their distance; one that
    /// does not rest.
    #[test]
    fn noise_of_a_length_is_not_that_of_its_times() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let there_and_back = |time: f64| 0.05 * (1e-3 * time).sin().max(0.0);
        let noisy: Vec<f64> = (0..20_000).map(|k| there_and_back(f64::from(k)) + 3e-6 * normal()).collect();
        let found_m = lasting_white_noise(&noisy, 2.0).unwrap();
        assert!((found_m / 3e-6 - 1.0).abs() < 0.03, "{found_m}");
        let late: Vec<f64> = (0..20_000).map(|k| 2e-3 * (f64::from(k) + 0.3 * normal())).collect();
        assert_eq!(lasting_white_noise(&late, 2.0), None);
        let resting: Vec<f64> = (0..20_000).map(|k| there_and_back(f64::from(k) + 0.3 * normal())).collect();
        assert_eq!(lasting_white_noise(&resting, 2.0), None);
    }

    #[test]
    fn a_residual_too_short_has_none() {
        assert_eq!(white_noise(&[0.1; 150]), None);
        let in_fours: Vec<f64> = (0..50_000).map(|k| if k % 5 == 0 { f64::NAN } else { f64::from(k % 3) }).collect();
        assert_eq!(white_noise(&in_fours), None);
    }
}
