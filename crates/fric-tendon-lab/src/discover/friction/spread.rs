//! The spread of the individual holes' μ around the one that they share.
//!
//! Each hole has its own μ. Holes share one μ if the run cannot distinguish them or if no difference exceeds chance, but their differences still
//! affect the shared value. The spread is estimated from the scatter of the individual estimates beyond their own errors (method of moments: R.
//! DerSimonian, N. Laird, *Meta-analysis in clinical trials*, Controlled Clinical Trials 7, 1986; here with correlated errors). A run that hardly
//! distinguishes the holes hardly determines their spread, so the upper limit counts: the estimate plus one standard error.

use nalgebra::{DMatrix, DVector};

use super::fitting::Linearised;
use super::model::Model;

/// Returns the standard deviation of the μ of holes that share one, relative to it. The first parameters of `problem` are the μ of each of these
/// holes.
pub fn shared_spread(problem: &Linearised, model: &Model, holes: &[usize]) -> f64 {
    let count = holes.len();
    let mu = DVector::from_iterator(count, holes.iter().map(|hole| model.mu[*hole]));
    let ratios = problem.step().rows(0, count).component_div(&mu);
    let covariance = problem.covariance();
    let relative = DMatrix::from_fn(count, count, |row, column| covariance[(row, column)] / (mu[row] * mu[column]));
    spread(&ratios, relative)
}

/// Returns `τ² = max(0, xᵀPx − (n − 1))/tr P + √(2(n − 1))/tr P` with `P = C⁻¹ − C⁻¹11ᵀC⁻¹/1ᵀC⁻¹1`, for values x with covariance C. Without a spread,
/// `xᵀPx` is χ² of n − 1. Returns 0 if C has no inverse.
pub fn spread(values: &DVector<f64>, covariance: DMatrix<f64>) -> f64 {
    let Some(weights) = covariance.cholesky().map(|factor| factor.inverse()) else { return 0.0 };
    let sums = weights.column_sum();
    let projector = &weights - &sums * sums.transpose() / sums.sum();
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let free = values.len().saturating_sub(1) as f64;
    let beyond = (values.dot(&(&projector * values)) - free).max(0.0);
    let square = (beyond + (2.0 * free).sqrt()) / projector.trace();
    if square > 0.0 { square.sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For equal and independent errors, τ² is the variance of the values minus that of their errors, plus `√(2/(n − 1))` of the latter.
    #[test]
    fn a_scatter_beyond_the_errors_is_a_spread() {
        let values = DVector::from_vec(vec![1.0, -2.0, 4.0, 0.5, -3.5]);
        let variance = values.variance() * 5.0 / 4.0;
        let found = spread(&values, DMatrix::from_diagonal_element(5, 5, 2.0));
        let error = |of: f64| of * 0.5_f64.sqrt();
        assert!((found - (variance - 2.0 + error(2.0)).sqrt()).abs() < 1e-12);
        let none = spread(&values, DMatrix::from_diagonal_element(5, 5, 20.0));
        assert!((none - error(20.0).sqrt()).abs() < 1e-12);
        assert!(spread(&DVector::zeros(1), DMatrix::from_diagonal_element(1, 1, 1.0)).abs() < 1e-12);
    }
}
