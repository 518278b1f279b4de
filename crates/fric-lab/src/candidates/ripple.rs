//! Ripples: periodic components of a residual, and their periods.

use std::f64::consts::TAU;

use fric_core::effects::Effect;
use nalgebra::{Matrix3, Vector3};
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

use crate::effects::Periods;
use crate::samples::cable::CableRecord;
use crate::samples::record::Row;
use crate::search::vector::Parameter;

/// Number of the strongest periods that are used.
const MOST_PERIODS: usize = 2;
/// Places per turn at the shortest period, by which the scan divides the range of the length: at most an eighth of a turn is lost between them, 2 % of
/// the power.
const PLACES_PER_TURN: usize = 8;
/// Minimum number of half periods in the range: fewer are a slow change.
const LEAST_HALF_TURNS: usize = 4;
/// Number of golden-section steps over half a period, down to a thousandth.
const SECTIONS: usize = 14;

/// Returns the period parameter of an effect that is periodic in the cable's length. It has no neutral value to start from; a scan of the residual
/// finds it.
pub fn period_of(effect: Effect) -> Option<Parameter> {
    Parameter::of(effect).find(Parameter::is_period)
}

/// Returns the range of lengths over which the scan finds a period, half a turn more than the least, so that its peak is clear.
pub fn least_range_m(period_m: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a few")]
    let half_turns = (LEAST_HALF_TURNS + 1) as f64;
    0.5 * half_turns * period_m
}

/// Returns the periods in the cable's length at which a residual ripples, and the circumference of the pulley whose radius is known, if the cable moves
/// by at least that: the scan needs two turns.
pub fn periods(record: &CableRecord<'_>, residual_n: &[f64]) -> Periods {
    let circumference_m = record.params.pose_pulley_radius_m().map(|radius_m| TAU * radius_m);
    let lengths_m = || record.rows.iter().map(|row| row.signals.length_m).filter(|length_m| length_m.is_finite());
    let range_m = lengths_m().fold(f64::NEG_INFINITY, f64::max) - lengths_m().fold(f64::INFINITY, f64::min);
    let of = |carrier: &dyn Fn(&Row) -> f64| {
        let mut periods_m = scanned_m(record, residual_n, carrier);
        let is_new =
            |turn_m: &f64| !periods_m.iter().any(|period_m| (period_m / turn_m - 1.0).abs() < 0.5 * turn_m / range_m);
        periods_m.extend(circumference_m.filter(|turn_m| *turn_m <= range_m).filter(is_new));
        periods_m
    };
    Periods {
        with_load: of(&|row| row.signals.sensor_force_n),
        with_friction: of(&|row| row.signals.sensor_force_n * row.signals.displacement_m.signum()),
        alone: of(&|_| 1.0),
    }
}

/// Returns the periods at which a residual ripples in proportion to `carrier`, the strongest first.
fn scanned_m(record: &CableRecord<'_>, residual_n: &[f64], carrier: impl Fn(&Row) -> f64) -> Vec<f64> {
    /// Number of samples that suffices.
    const ENOUGH: usize = 6000;
    let moving = record.rows.iter().zip(residual_n).filter(|(row, residual_n)| {
        residual_n.is_finite() && row.signals.displacement_m.abs() > 0.0 && row.signals.sensor_force_n > 0.0
    });
    let samples: Vec<(f64, f64)> =
        moving.map(|(row, residual_n)| (row.signals.length_m, residual_n / carrier(row))).collect();
    let (least_m, greatest_m) =
        samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), (length_m, _)| {
            (least.min(*length_m), most.max(*length_m))
        });
    let range_m = greatest_m - least_m;
    if samples.len() < ENOUGH / 10 || range_m <= 0.0 {
        return Vec::new();
    }
    let powers = powers(&samples, least_m, range_m, most_turns(range_m, samples.len(), slow_way_m(record)));
    let mut peaks: Vec<(usize, f64)> = (1..)
        .zip(powers.windows(3))
        .filter(|(half_turns, three)| *half_turns >= LEAST_HALF_TURNS && three[1] > three[0] && three[1] >= three[2])
        .map(|(half_turns, three)| (half_turns, three[1]))
        .collect();
    peaks.sort_by(|one, other| other.1.total_cmp(&one.1));
    let few: Vec<(f64, f64)> = samples.iter().step_by(samples.len() / ENOUGH + 1).copied().collect();
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let period_m = |half_turns: usize| 2.0 * range_m / half_turns as f64;
    peaks.iter().take(MOST_PERIODS).map(|(half_turns, _)| sharpened(&few, period_m(*half_turns), range_m)).collect()
}

/// Returns the way of a cable in a cycle that three quarters of the cycles in motion exceed; 0 if none is in motion.
fn slow_way_m(record: &CableRecord<'_>) -> f64 {
    let ways_m = record.rows.iter().map(|row| row.signals.displacement_m.abs());
    let mut ways_m: Vec<f64> = ways_m.filter(|way_m| *way_m > 0.0 && way_m.is_finite()).collect();
    let quarter = ways_m.len() / 4;
    if ways_m.is_empty() { 0.0 } else { *ways_m.select_nth_unstable_by(quarter, f64::total_cmp).1 }
}

/// Returns the number of turns in the range at the shortest period that is sought: the least that a robot file may state, but two samples a turn, also while the
/// cable is slow. At one speed the lengths are a grid, on which a shorter period looks like a longer one, or like a constant.
fn most_turns(range_m: f64, sample_count: usize, slow_way_m: f64) -> usize {
    let least_m = period_of(Effect::WinchRipple).map_or(f64::INFINITY, |period| period.row().min);
    let least_m = least_m.max(2.0 * slow_way_m);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast saturates")]
    let turns = (range_m / least_m) as usize;
    turns.min(sample_count / 2)
}

/// Returns the decrease of the squares by a sine beside a constant, by the number of its half periods in the range: those of [`ripple_power`] with the
/// lengths rounded to places, by Fourier transforms of the sums per place and of the numbers of samples (W. H. Press and G. B. Rybicki, *Fast
/// algorithm for spectral analysis of unevenly sampled data*, 1989).
fn powers(samples: &[(f64, f64)], least_m: f64, range_m: f64, most_turns: usize) -> Vec<f64> {
    let places = (PLACES_PER_TURN * most_turns).next_power_of_two();
    // Twice the range, so that a harmonic has half a period in it.
    let [mut sums, mut counts] = [vec![0.0; 2 * places], vec![0.0; 2 * places]];
    for (length_m, ratio) in samples {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a share of the places"
        )]
        let place = ((length_m - least_m) / range_m * places as f64).round() as usize;
        if let (Some(sum), Some(count)) = (sums.get_mut(place), counts.get_mut(place)) {
            *sum += ratio;
            *count += 1.0;
        }
    }
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(2 * places);
    let harmonics = |mut values: Vec<f64>| {
        let mut harmonics = vec![Complex::default(); places + 1];
        // Both lengths are those of the plan.
        let is_done = transform.process(&mut values, &mut harmonics).is_ok();
        if is_done { harmonics } else { Vec::new() }
    };
    let (of_sums, of_counts) = (harmonics(sums), harmonics(counts));
    let power = |half_turns: usize| -> Option<f64> {
        let [first, single, double] = [0, half_turns, 2 * half_turns].map(|place| of_counts.get(place).copied());
        let (count, single, double) = (first?.re, single?, double?);
        let (total, sum) = (of_sums.first()?.re, *of_sums.get(half_turns)?);
        // Transforms have exp(−iφ): the sine is the negative of the imaginary part.
        let matrix = Matrix3::new(
            count,
            -single.im,
            single.re,
            -single.im,
            0.5 * (count - double.re),
            -0.5 * double.im,
            single.re,
            -0.5 * double.im,
            0.5 * (count + double.re),
        );
        Some(decrease(matrix, Vector3::new(total, -sum.im, sum.re)))
    };
    (0..=2 * most_turns).map(|half_turns| power(half_turns).unwrap_or(0.0)).collect()
}

/// Refines a period of the grid to the strongest ripple, by golden sections of the number of periods over the whole range.
fn sharpened(samples: &[(f64, f64)], period_m: f64, range_m: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (range_m / period_m - 0.5, range_m / period_m + 0.5);
    let power = |turns: f64| ripple_power(samples, range_m / turns);
    for _ in 0..SECTIONS {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if power(left) > power(right) { high = right } else { low = left }
    }
    range_m / f64::midpoint(low, high)
}

/// Returns the decrease of the squares by a sine of this period beside a constant.
pub fn ripple_power(samples: &[(f64, f64)], period_m: f64) -> f64 {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (length_m, ratio) in samples {
        let (sin, cos) = (TAU * length_m / period_m).sin_cos();
        let row = Vector3::new(1.0, sin, cos);
        matrix += row * row.transpose();
        right += row * *ratio;
    }
    decrease(matrix, right)
}

/// Returns the decrease of the squares by the normal equations of a constant, a sine and a cosine, beside the constant alone.
fn decrease(matrix: Matrix3<f64>, right: Vector3<f64>) -> f64 {
    let constant = right[0] * right[0] / matrix[(0, 0)];
    matrix.cholesky().map_or(0.0, |factor| factor.solve(&right).dot(&right) - constant)
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal, Uniform};

    use super::*;

    #[test]
    fn the_scan_has_the_power_of_each_sine() {
        let mut random = ChaCha8Rng::seed_from_u64(4);
        let lengths = Uniform::new(-0.6, 0.7).unwrap();
        let samples: Vec<(f64, f64)> = (0..5000)
            .map(|_| {
                let (length_m, noise): (f64, f64) = (lengths.sample(&mut random), StandardNormal.sample(&mut random));
                // Of 292 and of 1800 periods in the range of 1.3 m, to a thousandth.
                let ripple = (TAU * length_m / 4.452e-3).sin() + 0.7 * (TAU * length_m / 0.7222e-3).cos();
                (length_m, ripple + noise)
            })
            .collect();
        let powers = powers(&samples, -0.6, 1.3, most_turns(1.3, samples.len(), 0.0));
        for half_turns in [4_u32, 33, 584, 2001, 3600, 4999] {
            let exact = ripple_power(&samples, 2.6 / f64::from(half_turns));
            let found = powers[usize::try_from(half_turns).unwrap()];
            assert!((found - exact).abs() < 0.05 * exact + 10.0, "{half_turns}: {found} instead of {exact}");
        }
        let peak =
            |from: usize, to: usize| (from..to).max_by(|one, other| powers[*one].total_cmp(&powers[*other])).unwrap();
        assert_eq!((powers.len(), peak(4, 1000), peak(1000, 5001)), (5001, 584, 3600));
    }

    /// The slots of a motor whose drum takes up far more than a turn: 49 m at 14.96 mm.
    #[test]
    fn a_short_period_on_a_long_way_is_found() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let (way_m, period_m) = (49.0, 14.96e-3);
        let samples: Vec<(f64, f64)> = (0..40_000)
            .map(|k| {
                let (length_m, noise): (f64, f64) = (way_m * f64::from(k) / 4e4, StandardNormal.sample(&mut random));
                (length_m, 0.5 * (TAU * length_m / period_m).cos() + noise)
            })
            .collect();
        let powers = powers(&samples, 0.0, way_m, most_turns(way_m, samples.len(), 0.0));
        let strongest = (4..powers.len()).max_by(|one, other| powers[*one].total_cmp(&powers[*other])).unwrap();
        let half_turns = u32::try_from(strongest).unwrap();
        assert!((f64::from(half_turns) - 2.0 * way_m / period_m).abs() <= 1.0, "{half_turns}");
    }
}
