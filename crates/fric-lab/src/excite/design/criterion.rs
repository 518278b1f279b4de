//! What a run is worth for a question, from sums over its pieces.
//!
//! Let `J` be the derivatives of the force at the platform by all parameters that a model varies, `r` what the model misses of a noise-free
//! log, `N` the samples and `s` the noise. Of `r` a refit leaves `R = rᵀr − rᵀJ(JᵀJ)⁻¹Jᵀr`, to first order. The expected evidence
//! against the model is `ΔBIC = N/2·ln(1 + R/(N·s²))`, for the discovery learns from half of the samples. Of a parameter the run
//! leaves the variance `s²·((JᵀJ)⁻¹)ᵢᵢ`: the other parameters of the model are as unknown as it. `JᵀJ`, `Jᵀr` and `rᵀr` of a run are the
//! sums of those of its pieces.

use nalgebra::{DMatrix, DVector};

use crate::certainty::determined::Yardstick;
use crate::certainty::undetermined::inverse_of_normal;
use crate::discover::naming::STRONG_BIC;
use crate::fit::Parameter;
use crate::search::gram::Gram;
use crate::search::problem::Problem;
use fric_core::parameters::Values;

/// `JᵀJ`, `Jᵀr`, `rᵀr` and `N`.
#[derive(Clone, Debug)]
pub struct Sums {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    squares: f64,
    count: f64,
}

impl Sums {
    /// Of no samples.
    pub fn new(parameters: usize) -> Self {
        let (matrix, gradient) = (DMatrix::zeros(parameters, parameters), DVector::zeros(parameters));
        Self { matrix, gradient, squares: 0.0, count: 0.0 }
    }

    /// How many parameters.
    pub fn parameter_count(&self) -> usize {
        self.gradient.len()
    }

    /// With those of another piece.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            matrix: &self.matrix + &other.matrix,
            gradient: &self.gradient + &other.gradient,
            squares: self.squares + other.squares,
            count: self.count + other.count,
        }
    }

    /// What a refit leaves of the squares, N².
    fn left(&self) -> f64 {
        let explained = inverse_of_normal(&self.matrix)
            .map_or(0.0, |inverse| (self.gradient.transpose() * inverse * &self.gradient)[(0, 0)]);
        (self.squares - explained).max(0.0)
    }
}

/// Sums of each log of a problem with one cable; `None` when stopped.
pub fn sums_of_logs(problem: &Problem<'_>, values: &Values) -> Option<Vec<Sums>> {
    let count = problem.parameter_count();
    let starts: Vec<usize> = problem.members.first()?.record.logs().map(|(start, _)| start).collect();
    let mut grams: Vec<(Gram, f64)> = starts.iter().map(|_| (Gram::new(count), 0.0)).collect();
    let completed = problem.visit(&[*values], true, |place, rows| {
        let log = starts.partition_point(|start| *start <= place).saturating_sub(1);
        let Some((gram, samples)) = grams.get_mut(log) else { return };
        rows.for_each(|row| gram.add(row));
        *samples += 1.0;
    });
    let sums = grams.into_iter().map(|(gram, count)| {
        let (matrix, gradient, squares) = gram.normal_equations();
        Sums { matrix, gradient, squares, count }
    });
    completed.then(|| sums.collect())
}

/// What is asked of the sums.
#[derive(Clone, Debug)]
pub enum Measure {
    /// How plainly the model is refuted.
    Evidence,
    /// How well parameters are known: place among those varied, the parameter, its value.
    Knowledge {
        /// The parameters that are wanted.
        wanted: Vec<(usize, Parameter, f64)>,
        /// What counts as known.
        yardstick: Yardstick,
    },
}

/// A model that is put to the test, linear about some values, with its sums over each piece.
#[derive(Clone, Debug)]
pub struct Test {
    pub measure: Measure,
    /// Standard deviation of the noise, N.
    pub noise_n: f64,
    pub pieces: Vec<Sums>,
}

impl Test {
    /// What a run with these sums is worth: 1 is just enough, twice the samples are worth twice as much.
    pub fn score(&self, sums: &Sums) -> f64 {
        let variance = self.noise_n * self.noise_n;
        match &self.measure {
            Measure::Evidence => {
                let left = sums.left();
                let evidence = 0.5 * sums.count * (left / (sums.count.max(1.0) * variance)).ln_1p();
                evidence / STRONG_BIC
            }
            Measure::Knowledge { wanted, yardstick } => {
                let Some(inverse) = inverse_of_normal(&sums.matrix) else { return 0.0 };
                let of = |(place, parameter, value): &(usize, Parameter, f64)| {
                    let of_one = inverse[(*place, *place)];
                    let leverage = (sums.count * of_one).sqrt();
                    yardstick.vagueness(parameter, *value, (variance * of_one).sqrt(), leverage).powi(-2)
                };
                wanted.iter().map(of).fold(f64::INFINITY, f64::min)
            }
        }
    }
}

/// All that a run is to tell: for each question the tests that it has to pass, of which the hardest counts.
pub type Tests = Vec<Vec<Test>>;

/// A score below this is nothing: it keeps the logarithm finite.
const NOTHING: f64 = 1e-6;

/// Sum of the logarithms of all questions' scores: twice as much on one weighs as much as twice as much on another.
pub fn objective(tests: &Tests, sums: &[Vec<Sums>]) -> f64 {
    let of_question = |(tests, sums): (&Vec<Test>, &Vec<Sums>)| {
        let scores = tests.iter().zip(sums).map(|(test, sums)| test.score(sums));
        scores.fold(f64::INFINITY, f64::min).max(NOTHING).ln()
    };
    tests.iter().zip(sums).map(of_question).sum()
}
