//! Weakening of the evidence for a parameter by the memory of the residual.

use nalgebra::{DMatrix, DVector};

use crate::certainty::scores::Scores;
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

/// Returns the same ratio for each of some columns in a linear least-squares problem; samples whose residual is NaN do not count.
pub fn inflations(columns: &[&[f64]], residual_n: &[f64]) -> Vec<f64> {
    let count = columns.len();
    let row = |sample: usize| {
        let number = |column: &&[f64]| column.get(sample).copied().filter(|number| number.is_finite()).unwrap_or(0.0);
        DVector::from_iterator(count, columns.iter().map(number))
    };
    let samples = || residual_n.iter().enumerate().filter(|(_, number)| number.is_finite());
    let (mut matrix, mut right) = (DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count));
    for (sample, residual_n) in samples() {
        let row = row(sample);
        right.axpy(*residual_n, &row, 1.0);
        matrix.ger(1.0, &row, &row, 1.0);
    }
    let Some(inverse) = inverse_of_normal(&matrix) else { return vec![f64::INFINITY; count] };
    let factors = &inverse * right;
    let (mut scores, mut squares, mut of_all) = (Scores::new(count), 0.0, 0.0);
    for (sample, residual_n) in samples() {
        let row = row(sample);
        let left_n = residual_n - row.dot(&factors);
        squares += left_n * left_n;
        of_all += 1.0;
        scores.add((row * left_n).as_slice());
    }
    let covariance = scores.covariance(&inverse);
    let ratio = |place: usize| covariance[(place, place)] * of_all / (squares * inverse[(place, place)]);
    (0..count).map(ratio).map(|ratio| if ratio.is_finite() { ratio.max(1.0) } else { f64::INFINITY }).collect()
}

/// Returns the BIC difference for `count` independent samples, a ratio of the sums of squares, and `more` additional parameters. Fewer than two
/// samples give no evidence.
pub fn delta_bic(count: f64, squares_ratio: f64, more: f64) -> f64 {
    if count < 2.0 { f64::INFINITY } else { count * squares_ratio.ln() + more * count.ln() }
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::{delta_bic, inflations};

    /// The variance of the mean of an AR(1) series is (1 + ρ)/(1 − ρ) times that of independent numbers. A column of random signs sees none of it, and
    /// what the columns themselves explain is no memory.
    #[test]
    fn a_level_is_known_less_well_where_the_residual_remembers() {
        const MEMORY: f64 = 0.9;
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let (mut level, mut signs, mut residual_n, mut number) = (Vec::new(), Vec::new(), Vec::new(), 0.0);
        for sample in 0..40_000 {
            number = MEMORY * number + normal();
            let sign = normal().signum();
            level.push(1.0);
            signs.push(sign);
            residual_n.push(if sample % 10 == 0 { f64::NAN } else { number + 50.0 + 30.0 * sign });
        }
        let [of_level, of_signs] = inflations(&[&level, &signs], &residual_n)[..] else { panic!("one of each") };
        // One sample in ten is missing, which the memory of nine tenths spans.
        let expected = (1.0 + MEMORY) / (1.0 - MEMORY) * 0.9;
        assert!((0.7 * expected..1.5 * expected).contains(&of_level), "{of_level}, expected {expected}");
        assert!((1.0..2.0).contains(&of_signs), "{of_signs}");
    }

    #[test]
    fn what_nothing_is_known_of_is_no_evidence() {
        let few = delta_bic(10.0, 0.5, 1.0);
        assert!((few - (10.0 * 0.5_f64.ln() + 10.0_f64.ln())).abs() < 1e-12);
        assert!(delta_bic(0.0, 0.5, 1.0) > 0.0 && delta_bic(1.5, 0.01, 1.0) > 0.0);
    }
}
