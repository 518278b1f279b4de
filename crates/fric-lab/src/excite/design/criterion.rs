//! The value of a run for a question, from sums over its pieces.
//!
//! Let `J` be the derivatives of the force at the platform with respect to all free parameters of a model, `r` the residual of the model on a
//! noise-free log, `N` the number of samples and `s` the noise. A refit leaves `R = rᵀr − rᵀJ(JᵀJ)⁻¹Jᵀr` of the squares, to first order. The expected
//! evidence against the model is `ΔBIC = N/2·ln(1 + R/(N·s²))`, because the discovery trains on half of the samples. The variance of a parameter is
//! `s²·((JᵀJ)⁻¹)ᵢᵢ`, with all other parameters of the model unknown too. `JᵀJ`, `Jᵀr` and `rᵀr` of a run are the sums over its pieces.

use nalgebra::{DMatrix, DVector};

use crate::certainty::determined::Yardstick;
use crate::discover::naming::STRONG_BIC;
use crate::fit::Parameter;
use crate::search::gram::Gram;
use crate::search::gram::inverse_of_normal;
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
    /// Creates empty sums.
    pub fn new(parameters: usize) -> Self {
        let (matrix, gradient) = (DMatrix::zeros(parameters, parameters), DVector::zeros(parameters));
        Self { matrix, gradient, squares: 0.0, count: 0.0 }
    }

    /// Returns the number of parameters.
    pub fn parameter_count(&self) -> usize {
        self.gradient.len()
    }

    /// Returns the sums of both pieces together.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            matrix: &self.matrix + &other.matrix,
            gradient: &self.gradient + &other.gradient,
            squares: self.squares + other.squares,
            count: self.count + other.count,
        }
    }

    /// Returns the squares that a refit leaves, N².
    fn left(&self) -> f64 {
        let explained = inverse_of_normal(&self.matrix)
            .map_or(0.0, |inverse| (self.gradient.transpose() * inverse * &self.gradient)[(0, 0)]);
        (self.squares - explained).max(0.0)
    }
}

/// Returns the sums of each log of a problem with one cable; `None` if stopped.
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

/// The measure of a test.
#[derive(Clone, Debug)]
pub enum Measure {
    /// The evidence against the model.
    Evidence,
    /// The uncertainty of parameters.
    Knowledge {
        /// The wanted parameters with their indices among the free ones.
        wanted: Vec<(usize, Parameter)>,
        /// The values of the model.
        values: Box<Values>,
        /// The scale of uncertainties that matter.
        yardstick: Yardstick,
    },
}

/// A model under test, linearised at some values, with its sums over each piece.
#[derive(Clone, Debug)]
pub struct Test {
    pub measure: Measure,
    /// Standard deviation of the noise, N.
    pub noise_n: f64,
    pub pieces: Vec<Sums>,
}

impl Test {
    /// Returns the value of a run with these sums: 1 is just enough, and twice the samples give twice the value.
    pub fn score(&self, sums: &Sums) -> f64 {
        let variance = self.noise_n * self.noise_n;
        match &self.measure {
            Measure::Evidence => {
                let left = sums.left();
                let evidence = 0.5 * sums.count * (left / (sums.count.max(1.0) * variance)).ln_1p();
                evidence / STRONG_BIC
            }
            Measure::Knowledge { wanted, values, yardstick } => {
                let Some(inverse) = inverse_of_normal(&sums.matrix) else { return 0.0 };
                let of = |(place, parameter): &(usize, Parameter)| {
                    let of_one = inverse[(*place, *place)];
                    let leverage = (sums.count * of_one).sqrt();
                    yardstick.vagueness(parameter, values, (variance * of_one).sqrt(), leverage).powi(-2)
                };
                wanted.iter().map(of).fold(f64::INFINITY, f64::min)
            }
        }
    }
}

/// Everything that a run is to answer: the tests of each question. A question is worth the least of its tests' scores.
pub type Tests = Vec<Vec<Test>>;

/// Lower limit of a score, which keeps the logarithm finite.
const NOTHING: f64 = 1e-6;

/// Returns the sum of the logarithms of all questions' scores. A doubled score therefore counts the same for every question.
pub fn objective(tests: &Tests, sums: &[Vec<Sums>]) -> f64 {
    let of_question = |(tests, sums): (&Vec<Test>, &Vec<Sums>)| {
        let scores = tests.iter().zip(sums).map(|(test, sums)| test.score(sums));
        scores.fold(f64::INFINITY, f64::min).max(NOTHING).ln()
    };
    tests.iter().zip(sums).map(of_question).sum()
}
