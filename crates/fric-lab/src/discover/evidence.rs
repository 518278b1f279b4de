//! By how much the memory of a residual weakens the evidence for a parameter.

use nalgebra::DMatrix;

use super::workbench::{Trial, Workbench};
use crate::fit::Parameter;

/// The greatest ratio of the variance of some of a model's parameters, as correlated residuals scatter them, to that of
/// residuals that do not depend on each other; at least 1, infinite where nothing is known.
pub fn inflation(bench: &Workbench<'_>, model: &Trial, of: &[Parameter]) -> f64 {
    let problem = bench.problem(&model.free, None);
    let Some((gram, scores)) = problem.gram_and_scores(&[model.values]) else { return f64::INFINITY };
    let (matrix, _, squares) = gram.normal_equations();
    let count = matrix.nrows();
    let scale: Vec<f64> = matrix.diagonal().iter().map(|square| 1.0 / square.max(f64::MIN_POSITIVE).sqrt()).collect();
    let scaled = DMatrix::from_fn(count, count, |row, column| {
        matrix[(row, column)] * scale[row] * scale[column] + if row == column { 1e-12 } else { 0.0 }
    });
    let Some(factor) = scaled.cholesky() else { return f64::INFINITY };
    let inverse = factor.inverse();
    let inverse = DMatrix::from_fn(count, count, |row, column| inverse[(row, column)] * scale[row] * scale[column]);
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let variance = squares / bench.count(false) as f64;
    let covariance = scores.covariance(&inverse);
    let places = model.free.iter().enumerate().filter(|(_, parameter)| of.contains(parameter));
    places
        .map(|(place, _)| covariance[(place, place)] / (variance * inverse[(place, place)]))
        .fold(1.0, |most, ratio| if ratio.is_finite() { most.max(ratio) } else { most })
}
