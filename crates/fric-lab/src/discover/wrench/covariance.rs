//! The covariance of a model's deviations: what turns them into independent ones of variance 1, and how large they are.

use nalgebra::{Matrix6, Vector6};

use super::bench::{Bench, Model};

/// With all components on one scale, a direction with less than this fraction of the greatest variance contains only rounding errors.
const LEAST_VARIANCE_RATIO: f64 = 1e-9;

/// Returns the matrix that turns the deviations of a model into independent ones of variance 1; `None` if there are none. Directions in which a robot
/// has no deviations are left out, such as the torques of a platform that is a point.
pub fn whitening(bench: &Bench<'_>, model: &Model) -> Option<Matrix6<f64>> {
    let plain = Bench { whitening: Matrix6::identity(), ..bench.clone() };
    let covariance = mean_product(&plain.deviations(model))?;
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
    let mut squares: Vec<f64> = covariance.symmetric_eigenvalues().iter().copied().collect();
    squares.sort_by(|one, other| other.total_cmp(one));
    let directions = bench.whitening.row_iter().filter(|row| row.norm_squared() > 0.0).count();
    let logarithms = squares.iter().take(directions).map(|square| square.ln());
    #[expect(clippy::cast_precision_loss, reason = "at most six")]
    let mean = logarithms.sum::<f64>() / directions as f64;
    bench.unit_square(model) * mean.exp()
}

/// Returns the mean of `d·dᵀ` over the finite deviations `d`; `None` if there are none.
fn mean_product(deviations: &[Vector6<f64>]) -> Option<Matrix6<f64>> {
    let finite = || deviations.iter().filter(|deviation| deviation.iter().all(|part| part.is_finite()));
    let count = finite().fold(0.0, |count, _| count + 1.0);
    (count > 0.0).then(|| finite().map(|deviation| deviation * deviation.transpose()).sum::<Matrix6<f64>>() / count)
}
