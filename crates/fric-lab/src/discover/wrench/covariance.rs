//! The covariance of a model's deviations: what turns them into independent ones of variance 1, and how large they are.

use nalgebra::{Matrix6, Vector6};

use super::bench::{Bench, Trial};
use super::model::Model;

/// With all components on one scale, a direction with less than this fraction of the greatest variance contains only rounding errors.
const LEAST_VARIANCE_RATIO: f64 = 1e-9;

/// Maximum number of fits, each with the whitening of the one before. The recording of `docs/recordings.md` takes 11.
const FITS: usize = 30;

/// Fits a model again and again, each time with the whitening of the fit before, until that no longer makes the samples likelier. Returns the last fit
/// and its whitening; `None` if there are no deviations.
pub fn reweighted(
    bench: &Bench<'_>,
    mut trial: Trial,
    fit: impl Fn(&Bench<'_>, &Model) -> Trial,
) -> Option<(Trial, Matrix6<f64>)> {
    let mut bench = bench.clone();
    for _ in 0..FITS {
        bench.whitening = whitening(&bench, &trial.model)?;
        let square = geometric_mean_square(&bench, &trial.model, false);
        trial = fit(&bench, &trial.model);
        let ratio = square / geometric_mean_square(&bench, &trial.model, false);
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = bench.count(false) as f64;
        // Twice the increase of the logarithm of the likelihood; NaN ends the fits too.
        let is_likelier = 6.0 * count * ratio.ln() >= 1.0;
        if !is_likelier {
            break;
        }
    }
    Some((trial, bench.whitening))
}

/// Returns the matrix that turns the deviations of a model into independent ones of variance 1; `None` if there are none. Directions in which a robot
/// has no deviations are left out, such as the torques of a platform that is a point.
pub fn whitening(bench: &Bench<'_>, model: &Model) -> Option<Matrix6<f64>> {
    let plain = Bench { whitening: Matrix6::identity(), ..bench.clone() };
    inverse_root(&mean_product(&plain.deviations(model))?)
}

/// Returns a matrix `W` with `W C Wᵀ = 1` for a covariance `C`, with rows of zeros in place of the directions without variance; `None` if there is none
/// in any direction.
fn inverse_root(covariance: &Matrix6<f64>) -> Option<Matrix6<f64>> {
    // The unit of each component is its standard deviation, so that forces and torques can be compared.
    let size = |component: usize| covariance[(component, component)].sqrt();
    let unit = Matrix6::from_fn(|row, column| if row == column && size(row) > 0.0 { size(row).recip() } else { 0.0 });
    let eigen = (unit * covariance * unit).symmetric_eigen();
    let greatest = eigen.eigenvalues.max();
    let root = |value: f64| if value > LEAST_VARIANCE_RATIO * greatest { value.sqrt().recip() } else { 0.0 };
    let scaled = Matrix6::from_diagonal(&eigen.eigenvalues.map(root)) * eigen.eigenvectors.transpose() * unit;
    (greatest > 0.0 && scaled.iter().all(|entry| entry.is_finite())).then_some(scaled)
}

/// Returns the geometric mean of the variances of a model's deviations in the directions that the whitening does not leave out, over the held-out
/// samples or the training samples; NaN if there are none.
pub fn geometric_mean_square(bench: &Bench<'_>, model: &Model, held_out: bool) -> f64 {
    let used = bench.used(held_out);
    let deviations = bench.deviations(model);
    let of_samples: Vec<Vector6<f64>> =
        deviations.into_iter().zip(used).filter(|(_, used)| *used).map(|(deviation, _)| deviation).collect();
    let Some(covariance) = mean_product(&of_samples) else { return f64::NAN };
    let directions = bench.whitening.row_iter().filter(|row| row.norm_squared() > 0.0).count();
    bench.unit_square(model) * geometric_mean(&covariance, directions)
}

/// Returns the geometric mean of the `directions` greatest principal variances.
fn geometric_mean(covariance: &Matrix6<f64>, directions: usize) -> f64 {
    let mut squares: Vec<f64> = covariance.symmetric_eigenvalues().iter().copied().collect();
    squares.sort_by(|one, other| other.total_cmp(one));
    let logarithms = squares.iter().take(directions).map(|square| square.ln());
    #[expect(clippy::cast_precision_loss, reason = "at most six")]
    let mean = logarithms.sum::<f64>() / directions as f64;
    mean.exp()
}

/// Returns the mean of `d·dᵀ` over the finite deviations `d`; `None` if there are none.
fn mean_product(deviations: &[Vector6<f64>]) -> Option<Matrix6<f64>> {
    let finite = || deviations.iter().filter(|deviation| deviation.iter().all(|part| part.is_finite()));
    let count = finite().fold(0.0, |count, _| count + 1.0);
    (count > 0.0).then(|| finite().map(|deviation| deviation * deviation.transpose()).sum::<Matrix6<f64>>() / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces of some N that go with torques of some mN m, as those of a small platform.
    fn covariance() -> Matrix6<f64> {
        let sizes = Matrix6::from_diagonal(&Vector6::new(3.0, 2.0, 5.0, 2e-3, 3e-3, 1e-3));
        let correlated = Matrix6::from_fn(|row, column| if row == column { 1.0 } else { 0.4 });
        sizes * correlated * sizes
    }

    #[test]
    fn whitened_deviations_are_independent_and_of_variance_1() {
        let root = inverse_root(&covariance()).unwrap();
        let whitened = root * covariance() * root.transpose();
        assert!((whitened - Matrix6::identity()).norm() < 1e-10, "{whitened}");
    }

    /// A platform that is a point has no torques.
    #[test]
    fn directions_without_variance_are_left_out() {
        let forces = Matrix6::from_diagonal(&Vector6::new(1.0, 1.0, 1.0, 0.0, 0.0, 0.0));
        let point = forces * covariance() * forces;
        let root = inverse_root(&point).unwrap();
        assert_eq!(root.row_iter().filter(|row| row.norm() > 0.0).count(), 3);
        assert!(((root * point * root.transpose()).trace() - 3.0).abs() < 1e-10);
        assert_eq!(inverse_root(&Matrix6::zeros()), None);
    }

    #[test]
    fn the_geometric_mean_is_the_root_of_the_determinant() {
        let of_six = geometric_mean(&covariance(), 6);
        assert!((of_six / covariance().determinant().powf(1.0 / 6.0) - 1.0).abs() < 1e-9, "{of_six}");
        // In the units of another whitening, the ratio of two means is the same.
        let root = inverse_root(&covariance()).unwrap();
        let other = covariance() + Matrix6::from_diagonal(&Vector6::new(1.0, 2.0, 0.0, 1e-6, 0.0, 1e-6));
        let ratio = geometric_mean(&other, 6) / of_six;
        let [of_other, of_one] = [other, covariance()].map(|of| geometric_mean(&(root * of * root.transpose()), 6));
        assert!((of_other / of_one / ratio - 1.0).abs() < 1e-9);
        let point = Matrix6::from_diagonal(&Vector6::new(4.0, 0.0, 9.0, 0.0, 0.0, 0.0));
        assert!((geometric_mean(&point, 2) - 6.0).abs() < 1e-12);
    }
}
