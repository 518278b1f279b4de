//! Weakening of the evidence for a parameter by the memory of the residual.

use nalgebra::{DMatrix, DVector};

use crate::certainty::scores::Scores;
use crate::discover::workbench::{Trial, Workbench};
use crate::fit::Parameter;
use crate::search::gram::inverse_of_normal;

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

/// Returns the length of some parameters' differences together in standard errors, by their places in a covariance; `None` if that is singular.
pub fn in_standard_errors(differences: &DVector<f64>, covariance: &DMatrix<f64>, places: &[usize]) -> Option<f64> {
    let inverse = inverse_of_normal(&covariance.select_rows(places).select_columns(places))?;
    Some((differences.transpose() * inverse * differences)[(0, 0)].sqrt())
}

/// The memory of what some columns leave in a linear least-squares problem, taken in sample by sample.
pub struct Memory {
    /// Which of the numbers of a sample are the columns.
    places: Vec<usize>,
    /// The factors of the columns as added to the residual, and the inverse of their normal matrix.
    factors: DVector<f64>,
    inverse: DMatrix<f64>,
    scores: Scores,
    /// Sum of squares of what is left, N², and number of samples.
    squares: f64,
    count: f64,
}

impl Memory {
    /// Creates the memory without samples.
    pub fn new(places: Vec<usize>, factors: DVector<f64>, inverse: DMatrix<f64>) -> Self {
        let scores = Scores::new(places.len());
        Self { places, factors, inverse, scores, squares: 0.0, count: 0.0 }
    }

    /// Takes in a sample: the numbers of all columns, 0 where one is not finite, and the residual. It does not count if its residual is not finite.
    pub fn add(&mut self, numbers: &[f64], residual_n: f64) {
        if !residual_n.is_finite() {
            return;
        }
        let number = |place: &usize| numbers.get(*place).copied().filter(|number| number.is_finite()).unwrap_or(0.0);
        let row = DVector::from_iterator(self.places.len(), self.places.iter().map(number));
        let left_n = residual_n + row.dot(&self.factors);
        self.squares += left_n * left_n;
        self.count += 1.0;
        self.scores.add((row * left_n).as_slice());
    }

    /// Returns the same ratio as [`inflation`] for each column.
    pub fn inflations(&self) -> Vec<f64> {
        let covariance = self.scores.covariance(&self.inverse);
        let ratio = |place| covariance[(place, place)] * self.count / (self.squares * self.inverse[(place, place)]);
        let known = |ratio: f64| if ratio.is_finite() { ratio.max(1.0) } else { f64::INFINITY };
        (0..self.places.len()).map(ratio).map(known).collect()
    }
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

    use super::delta_bic;
    use crate::discover::naming::projection::Columns;

    /// The variance of the mean of an AR(1) series is (1 + ρ)/(1 − ρ) times that of independent numbers. A column of random signs sees none of it, and
    /// what the columns themselves explain is no memory.
    #[test]
    fn a_level_is_known_less_well_where_the_residual_remembers() {
        const MEMORY: f64 = 0.9;
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut number = 0.0;
        let mut sample = |place: usize| {
            number = MEMORY * number + normal();
            let sign = normal().signum();
            ([1.0, sign], if usize::is_multiple_of(place, 10) { f64::NAN } else { number + 50.0 + 30.0 * sign })
        };
        let samples: Vec<([f64; 2], f64)> = (0..40_000).map(&mut sample).collect();
        let mut columns = Columns::new(2, 0, 2);
        for (numbers, residual_n) in &samples {
            columns.add(numbers, *residual_n);
        }
        let mut memory = columns.memory(&[0, 1]).unwrap();
        for (numbers, residual_n) in &samples {
            memory.add(numbers, *residual_n);
        }
        let [of_level, of_signs] = memory.inflations()[..] else { panic!("one of each") };
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
