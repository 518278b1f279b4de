//! The error of estimates because the model passes on the sensor's noise.
//!
//! The model takes the sensor force with its noise. Wherever it is not linear in this force, the noise does not average out: the correction of a
//! `sensor_lag` contains the change of the signal from cycle to cycle; an elastic cable, or a contact that slips back, follows the peaks of the noise.
//! Least squares puts the parameters where they make up for that (errors in variables: W. A. Fuller, *Measurement Error Models*, 1987).
//!
//! Added noise shows by how much (simulation extrapolation: J. R. Cook and L. A. Stefanski, *J. Am. Stat. Assoc.* 89, 1994). With noise of `s` times the
//! deviation in all, the estimates move by `a·(s − 1) + c·(s² − 1)`: at a kink with the deviation, at a curvature with the variance. The moves at
//! two strengths give `a` and `c`, and thus the error by the noise that there is, `b = a + c`. Each move is a step of least squares, the mean for noise
//! that is added and for the same noise subtracted, so that what is linear in the noise cancels.
//!
//! The values remain those of least squares, because they compensate best with the noise that there is. The covariance grows by `b bᵀ`.

use fric_core::parameters::Values;
use nalgebra::DVector;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::samples::cable::{AddedNoise, CableRecord};
use crate::samples::noise::white_noise;
use crate::samples::record::Row;
use crate::search::gram::inverse_of_normal;
use crate::search::problem::{Member, Problem};
use crate::search::solve::unknowns;

/// Deviation of the added noise, in deviations of the sensor's own: together √2 and 2 times.
const ADDED: [f64; 2] = [1.0, 1.732_050_807_568_877_2];

/// Returns the error of each estimate, `None` if no parameter of an effect is free: friction by itself is linear in the force.
pub fn error(problem: &Problem<'_>, values: &[Values]) -> Option<DVector<f64>> {
    if unknowns(problem).iter().all(|unknown| unknown.parameter.effect().is_none()) {
        return None;
    }
    let noises: Vec<Vec<f64>> = problem.members.iter().map(noise_n).collect();
    let move_by = |strength: f64| {
        let [added, subtracted] = [strength, -strength].map(|strength| step(problem, values, &noises, strength));
        Some((added? + subtracted?) / 2.0)
    };
    let [weak, strong] = ADDED.map(move_by);
    Some(weak?.zip_map(&strong?, error_by_own))
}

/// Returns `a + c` from the moves at both strengths. Both have the sign of the weaker move: an error grows at least with the deviation and at most
/// with the variance.
fn error_by_own(weak: f64, strong: f64) -> f64 {
    let [(kink_weak, curve_weak), (kink_strong, curve_strong)] =
        ADDED.map(|added| (added.mul_add(added, 1.0).sqrt() - 1.0, added * added));
    let kink = (weak * curve_strong - strong * curve_weak) / (kink_weak * curve_strong - kink_strong * curve_weak);
    let most = weak / kink_weak;
    let kink = kink.clamp(most.min(0.0), most.max(0.0));
    kink + (weak - kink * kink_weak) / curve_weak
}

/// Draws noise with the deviation of the white noise in a cable's sensor force, N in each cycle.
fn noise_n(member: &Member<'_>) -> Vec<f64> {
    let of_row = |row: &Row| if row.is_sound() { row.signals.sensor_force_n } else { f64::NAN };
    let signal: Vec<f64> = member.record.rows.iter().map(of_row).collect();
    let deviation_n = white_noise(&signal).unwrap_or(0.0);
    let random = ChaCha8Rng::seed_from_u64(0);
    StandardNormal.sample_iter(random).take(signal.len()).map(|number: f64| deviation_n * number).collect()
}

/// Returns the step of least squares from the estimates if the sensor forces have so many times this noise in addition.
fn step(problem: &Problem<'_>, values: &[Values], noises: &[Vec<f64>], strength: f64) -> Option<DVector<f64>> {
    let members = problem.members.iter().zip(noises);
    let noisy = Problem {
        members: members.map(|(member, noise_n)| with_noise(member, AddedNoise { noise_n, strength })).collect(),
        comparison: problem.comparison.clone(),
        loss: problem.loss,
        used: problem.used.clone(),
        stop: problem.stop,
        seat: None,
    };
    let (matrix, sums, _) = noisy.gram(values)?.normal_equations();
    Some(-(inverse_of_normal(&matrix)? * sums))
}

fn with_noise<'a>(member: &Member<'a>, noise: AddedNoise<'a>) -> Member<'a> {
    Member { record: CableRecord { added_noise: Some(noise), ..member.record }, free: member.free.clone() }
}

#[cfg(test)]
mod tests {
    use super::error_by_own;

    #[test]
    fn the_error_by_the_noise_follows_from_that_by_more_of_it() {
        let kink = |s: f64| 0.3 * (s - 1.0);
        let curve = |s: f64| 0.2 * (s * s - 1.0);
        let (weak, strong) = (2.0_f64.sqrt(), 2.0);
        for (moved, expected) in [
            (Box::new(kink) as Box<dyn Fn(f64) -> f64>, 0.3),
            (Box::new(curve), 0.2),
            (Box::new(move |s| -kink(s) - curve(s)), -0.5),
            // Beyond the square, the square; below the deviation, the deviation.
            (Box::new(|s| 0.2 * (s * s * s * s - 1.0)), 0.6),
            (Box::new(|_| 0.1), 0.1 / (2.0_f64.sqrt() - 1.0)),
            (Box::new(|_| 0.0), 0.0),
        ] {
            assert!((error_by_own(moved(weak), moved(strong)) - expected).abs() < 1e-12, "{expected}");
        }
    }
}
