//! Weakening of the evidence for a parameter by the memory of the residual.

use crate::certainty::undetermined::inverse_of_normal;
use crate::discover::workbench::{Trial, Workbench};
use crate::fit::Parameter;

/// Returns the greatest ratio of two variances over some of a model's parameters: the variance under correlated residuals divided by that under
/// independent residuals. It is at least 1, and infinite where nothing is known.
pub fn inflation(bench: &Workbench<'_>, model: &Trial, of: &[Parameter]) -> f64 {
    let problem = bench.problem(&model.free, None);
    let Some((gram, scores)) = problem.gram_and_scores(&[model.values], None) else { return f64::INFINITY };
    let (matrix, _, squares) = gram.normal_equations();
    let Some(inverse) = inverse_of_normal(&matrix) else { return f64::INFINITY };
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let variance = squares / bench.count(false) as f64;
    let covariance = scores.covariance(&inverse);
    let places = model.free.iter().enumerate().filter(|(_, parameter)| of.contains(parameter));
    places
        .map(|(place, _)| covariance[(place, place)] / (variance * inverse[(place, place)]))
        .fold(1.0, |most, ratio| if ratio.is_finite() { most.max(ratio) } else { f64::INFINITY })
}

/// Returns the BIC difference for `count` independent samples, a ratio of the sums of squares, and `more` additional parameters. Fewer than two
/// samples give no evidence.
pub fn delta_bic(count: f64, squares_ratio: f64, more: f64) -> f64 {
    if count < 2.0 { f64::INFINITY } else { count * squares_ratio.ln() + more * count.ln() }
}

#[cfg(test)]
mod tests {
    use super::delta_bic;

    #[test]
    fn what_nothing_is_known_of_is_no_evidence() {
        let few = delta_bic(10.0, 0.5, 1.0);
        assert!((few - (10.0 * 0.5_f64.ln() + 10.0_f64.ln())).abs() < 1e-12);
        assert!(delta_bic(0.0, 0.5, 1.0) > 0.0 && delta_bic(1.5, 0.01, 1.0) > 0.0);
    }
}
