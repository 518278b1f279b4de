//! A piecewise linear estimate of a noisy signal, with as many corners as its noise allows.
//!
//! The ℓ1 trend filter (Kim, Koh, Boyd, Gorinevsky, SIAM Review 51, 2009) minimises `½·Σ(y − x)² + λ·Σ|D x|` with the changes of slope `D x`. Its
//! minimum is piecewise linear, so it shows where corners are, but it flattens turning points by λ. Therefore the polygon with these corners is
//! fitted anew without λ; of corners side by side, which share one, the largest is kept. λ is the one with the least `Σ(y − x)²/σ² + p·ln n` (the BIC at
//! the noise σ), with `p = 2 + 2·corners`: a line, and the place and the change of slope of each corner.
//!
//! The minimum is found by reweighting, in its dual form `(M + λ·D·Dᵀ)·z = D·y`, `x = y − λ·Dᵀ·z` with `M = |D x|`. There the smooth part of the
//! signal does not cancel. The matrix has five diagonals, so the time is proportional to the number of samples.

/// λ of the first estimate, in units of the noise, and the ratio of each to the one before.
const FIRST_RATIO: f64 = 0.5;
const GROWTH: f64 = 2.0;
/// Maximum number of estimates. The last λ suits ramps of some thousand samples.
const MOST_ESTIMATES: u32 = 40;
/// The search ends after this many estimates with a greater risk than the least one.
const MOST_WORSE: u32 = 3;
/// Maximum number of reweightings for one λ, and the change of the estimate that ends them, in units of the noise.
const MOST_ROUNDS: u32 = 100;
const SETTLED_RATIO: f64 = 1e-3;
/// Least change of slope that counts as a corner, in units of `σ²/λ`, the size that noise gives it.
const CORNER_RATIO: f64 = 0.01;

/// A signal with its times.
struct Signal<'a> {
    values: &'a [f64],
    /// Weights of three neighbouring samples in each change of slope, in units of the median sample distance.
    rows: Vec<[f64; 3]>,
}

/// Returns the standard deviation of white noise in a signal, from the deviation of each sample from the cubic through its four neighbours: the root
/// mean square of those within three standard deviations, of which the median gives the first value. Corners, which are rare, are not among them.
/// `None` for fewer than five samples.
pub fn noise(times_s: &[f64], values: &[f64]) -> Option<f64> {
    /// Median of the absolute value of a Gaussian number of unit deviation.
    const MEDIAN: f64 = 0.674_489_750_196_081_7;
    /// Root mean square of those below three.
    const WITHIN_THREE: f64 = 0.986_6;
    const ROUNDS: u32 = 5;
    let deviation = |(times_s, values): (&[f64], &[f64])| {
        let (&[t0, t1, t, t2, t3], &[y0, y1, y, y2, y3]) = (times_s, values) else { return f64::NAN };
        let weight = |own: f64, [one, other, last]: [f64; 3]| {
            (t - one) * (t - other) * (t - last) / ((own - one) * (own - other) * (own - last))
        };
        let weights =
            [weight(t0, [t1, t2, t3]), weight(t1, [t0, t2, t3]), weight(t2, [t0, t1, t3]), weight(t3, [t0, t1, t2])];
        let expected: f64 = weights.iter().zip([y0, y1, y2, y3]).map(|(weight, value)| weight * value).sum();
        let square: f64 = weights.iter().map(|weight| weight * weight).sum();
        (y - expected).abs() / (1.0 + square).sqrt()
    };
    let mut deviations: Vec<f64> = times_s.windows(5).zip(values.windows(5)).map(deviation).collect();
    deviations.retain(|deviation| deviation.is_finite());
    deviations.sort_unstable_by(f64::total_cmp);
    let mut found = deviations.get(deviations.len() / 2)? / MEDIAN;
    for _ in 0..ROUNDS {
        let within = deviations.iter().take_while(|deviation| **deviation <= 3.0 * found);
        let (count, sum) =
            within.fold((0.0, 0.0), |(count, sum), deviation| (count + 1.0, sum + deviation * deviation));
        found = (sum / f64::max(count, 1.0)).sqrt() / WITHIN_THREE;
    }
    Some(found)
}

/// Returns the estimate of a signal with this noise, and its standard error, `σ·√(p/n)`. Times increase.
pub fn estimate(times_s: &[f64], values: &[f64], noise: f64) -> (Vec<f64>, f64) {
    let signal = Signal::new(times_s, values);
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = values.len() as f64;
    let mut best = (f64::INFINITY, values.to_vec(), noise);
    let mut now = values.to_vec();
    let mut changes = signal.changes(values);
    let mut worse = 0;
    let mut strength = FIRST_RATIO * noise;
    for _ in 0..MOST_ESTIMATES {
        let least = signal.minimum(strength, noise, &mut changes, &mut now);
        let (polygon, corners) = signal.polygon(strength, least, &changes);
        let squares: f64 = values.iter().zip(&polygon).map(|(value, now)| (value - now) * (value - now)).sum();
        let numbers = 2.0 + 2.0 * corners;
        let risk = squares / (noise * noise) + numbers * count.ln();
        if risk < best.0 {
            best = (risk, polygon, noise * (numbers / count).sqrt().min(1.0));
            worse = 0;
        } else {
            worse += 1;
            if worse == MOST_WORSE {
                break;
            }
        }
        strength *= GROWTH;
    }
    (best.1, best.2)
}

impl<'a> Signal<'a> {
    fn new(times_s: &[f64], values: &'a [f64]) -> Self {
        let mut steps_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let rates: Vec<f64> = steps_s.iter().map(|step_s| step_s.recip()).collect();
        steps_s.sort_unstable_by(f64::total_cmp);
        let usual_s = steps_s.get(steps_s.len() / 2).copied().unwrap_or(1.0);
        let row = |pair: &[f64]| {
            let [before, after] = [usual_s * pair[0], usual_s * pair[1]];
            [before, -before - after, after]
        };
        Self { values, rows: rates.windows(2).map(row).collect() }
    }

    /// Returns `D x`.
    fn changes(&self, values: &[f64]) -> Vec<f64> {
        let change =
            |(row, part): (&[f64; 3], &[f64])| row.iter().zip(part).map(|(weight, value)| weight * value).sum();
        self.rows.iter().zip(values.windows(3)).map(change).collect()
    }

    /// Finds the minimum for one λ, starting from changes of slope nearby, and returns the least change of slope that is a corner of it.
    fn minimum(&self, strength: f64, noise: f64, changes: &mut [f64], now: &mut [f64]) -> f64 {
        let least = CORNER_RATIO * noise * noise / strength;
        let right = self.changes(self.values);
        for change in changes.iter_mut() {
            *change = change.abs().max(least);
        }
        for _ in 0..MOST_ROUNDS {
            let dual = self.solved(strength, changes, &right);
            let next = self.primal(strength, &dual);
            let moved = next.iter().zip(&*now).map(|(next, now)| (next - now).abs()).fold(0.0, f64::max);
            now.copy_from_slice(&next);
            for (change, dual) in changes.iter_mut().zip(&dual) {
                *change = (*change * dual.abs()).max(least);
            }
            if moved < SETTLED_RATIO * noise {
                break;
            }
        }
        least
    }

    /// Returns the polygon that is nearest to the signal with the corners of a minimum, and their number. Of corners side by side only the largest
    /// is kept.
    fn polygon(&self, strength: f64, least: f64, changes: &[f64]) -> (Vec<f64>, f64) {
        /// Weight of a corner's change of slope that leaves it free.
        const FREE: f64 = 1e12;
        let mut weights = vec![least; changes.len()];
        let mut corners = 0.0;
        let mut at = 0;
        for group in changes.chunk_by(|one, other| (*one > least) == (*other > least)) {
            let largest = group.iter().enumerate().max_by(|(_, one), (_, other)| one.total_cmp(other));
            if let Some((place, _)) = largest.filter(|(_, change)| **change > least) {
                weights[at + place] = FREE;
                corners += 1.0;
            }
            at += group.len();
        }
        let dual = self.solved(strength, &weights, &self.changes(self.values));
        (self.primal(strength, &dual), corners)
    }

    /// Returns `y − λ·Dᵀ·z`.
    fn primal(&self, strength: f64, dual: &[f64]) -> Vec<f64> {
        let mut values = self.values.to_vec();
        for (at, (row, dual)) in self.rows.iter().zip(dual).enumerate() {
            for (value, weight) in values[at..].iter_mut().zip(row) {
                *value -= strength * weight * dual;
            }
        }
        values
    }

    /// Solves `(diag(changes) + λ·D·Dᵀ)·z = right` by the factors L·diag·Lᵀ of a matrix with two diagonals beside the main one.
    fn solved(&self, strength: f64, changes: &[f64], right: &[f64]) -> Vec<f64> {
        let count = self.rows.len();
        let none = [0.0; 3];
        let row = |place: usize| self.rows.get(place).unwrap_or(&none);
        let (mut pivots, mut first, mut second) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        let mut solution = right.to_vec();
        for place in 0..count {
            let (one, two) = (place.wrapping_sub(1), place.wrapping_sub(2));
            let before = |list: &[f64], at: usize| list.get(at).copied().unwrap_or(0.0);
            let [a, b, c] = *row(place);
            let [next_a, next_b, _] = *row(place + 1);
            let [after_a, ..] = *row(place + 2);
            let pivot = changes[place] + strength * (a * a + b * b + c * c)
                - before(&first, one).powi(2) * before(&pivots, one)
                - before(&second, two).powi(2) * before(&pivots, two);
            let beside = strength * (b * next_a + c * next_b)
                - before(&second, one) * before(&first, one) * before(&pivots, one);
            (pivots[place], first[place], second[place]) = (pivot, beside / pivot, strength * c * after_a / pivot);
            solution[place] -=
                before(&first, one) * before(&solution, one) + before(&second, two) * before(&solution, two);
        }
        for place in (0..count).rev() {
            let behind = |at: usize| solution.get(at).copied().unwrap_or(0.0);
            solution[place] =
                solution[place] / pivots[place] - first[place] * behind(place + 1) - second[place] * behind(place + 2);
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// A triangle of 200 samples, its times, and the same with noise of 0.01.
    fn triangle(seed: u64, jitter: f64) -> [Vec<f64>; 3] {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut deviate = || -> f64 { StandardNormal.sample(&mut random) };
        let times_s: Vec<f64> =
            (0..200_u32).map(|place| f64::from(place) + jitter * deviate().clamp(-1.0, 1.0)).collect();
        let clean: Vec<f64> =
            times_s.iter().map(|time_s| 0.02 * ((time_s + 25.0).rem_euclid(50.0) - 25.0).abs()).collect();
        let shown = clean.iter().map(|value| value + 0.01 * deviate()).collect();
        [times_s, clean, shown]
    }

    fn rms(one: &[f64], other: &[f64]) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let count = one.len() as f64;
        (one.iter().zip(other).map(|(one, other)| (one - other).powi(2)).sum::<f64>() / count).sqrt()
    }

    #[test]
    fn noise_is_that_of_the_samples_and_not_of_corners_or_times() {
        for (seed, jitter) in [(1, 0.0), (2, 0.3), (3, 0.0)] {
            let [times_s, clean, shown] = triangle(seed, jitter);
            assert!(noise(&times_s, &clean).unwrap() < 1e-12);
            let found = noise(&times_s, &shown).unwrap();
            assert!((found / 0.01 - 1.0).abs() < 0.2, "{seed} {found}");
        }
        assert_eq!(noise(&[0.0; 4], &[0.0; 4]), None);
    }

    /// The estimate is nearer to the truth by more than the half, has its turning points where they are, and goes no other way in between.
    #[test]
    fn turning_points_stay_and_ramps_are_monotone() {
        for (seed, jitter) in [(1, 0.0), (2, 0.3), (3, 0.0)] {
            let [times_s, clean, shown] = triangle(seed, jitter);
            let (found, error) = estimate(&times_s, &shown, 0.01);
            assert!(rms(&found, &clean) < 0.5 * rms(&shown, &clean), "{seed} {}", rms(&found, &clean));
            assert!(rms(&found, &clean) < 2.0 * error && error < 0.007, "{seed} {error}");
            for (place, pair) in found.windows(2).enumerate() {
                let is_near_turn = (place + 3) % 25 < 7;
                let rises = clean[place + 1] > clean[place];
                assert!(is_near_turn || (pair[1] > pair[0]) == rises, "{seed} {place}");
            }
        }
    }

    /// Of a ramp hardly a corner is left, and an error of about `σ·√(2/n)`.
    #[test]
    fn a_ramp_is_a_line() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut deviate = || -> f64 { StandardNormal.sample(&mut random) };
        let times_s: Vec<f64> = (0..67_u32).map(f64::from).collect();
        for _ in 0..4 {
            let clean: Vec<f64> = times_s.iter().map(|time_s| 0.025 * time_s).collect();
            let shown: Vec<f64> = clean.iter().map(|value| value + 0.01 * deviate()).collect();
            let (found, error) = estimate(&times_s, &shown, 0.01);
            assert!(rms(&found, &clean) < 2.0 * error && error < 0.004, "{} {error}", rms(&found, &clean));
        }
    }

    /// The conditions of the minimum, of the primal problem, from its definition: `y − x = λ·Dᵀ·z` with `|z| ≤ 1`, and `z` is the sign of `D x` at
    /// corners. Summed twice, the remainder gives z.
    #[test]
    fn the_minimum_is_that_of_its_definition() {
        let [times_s, _, shown] = triangle(4, 0.0);
        let signal = Signal::new(&times_s, &shown);
        let (strength, noise) = (0.05, 0.01);
        let (mut found, mut changes) = (shown.clone(), signal.changes(&shown));
        let least = signal.minimum(strength, noise, &mut changes, &mut found);
        let corners = changes.iter().filter(|change| **change > least).count();
        assert!((5..60).contains(&corners), "{corners}");
        let (mut sum, mut dual) = (0.0, 0.0);
        for place in 0..shown.len() {
            sum += shown[place] - found[place];
            dual += sum;
            assert!(dual.abs() < 1.02 * strength, "{place} {dual}");
            if let Some([one, middle, other]) = found.get(place..place + 3).and_then(|part| part.first_chunk()) {
                let change = one - 2.0 * middle + other;
                // The reweighting leaves corners that are much smaller than the noise unfinished.
                if change.abs() > 1e-3 {
                    assert!((dual - strength * change.signum()).abs() < 0.02 * strength, "{place} {dual} {change}");
                }
            }
        }
        assert!(sum.abs() < 1e-9 && dual.abs() < 1e-9, "{sum} {dual}");
    }
}
