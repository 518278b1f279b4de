//! By how much the memory of a residual weakens the evidence for a parameter.

use crate::certainty::undetermined::inverse_of_normal;
use crate::discover::workbench::{Trial, Workbench};
use crate::fit::Parameter;

/// The greatest ratio of the variance of some of a model's parameters, as correlated residuals scatter them, to that of
/// residuals that do not depend on each other; at least 1, infinite where nothing is known.
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
