//! The part of a signal that the parameters of a model cannot compensate.

use fric_core::parameters::Values;
use nalgebra::{DMatrix, DVector};

use crate::certainty::undetermined::inverse_of_normal;
use crate::search::problem::Problem;

/// Returns the signals minus their projection on small changes of a problem's parameters, over the samples that count; NaN elsewhere.
pub fn less_projection(problem: &Problem<'_>, values: &Values, signals: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let used = problem.used.iter().enumerate().filter(|(_, used)| **used);
    let places: Vec<usize> = used.map(|(place, _)| place).collect();
    let count = problem.parameter_count();
    let number = |signal: &[f64], place: usize| signal.get(place).copied().filter(|number| number.is_finite());
    let mut matrix = DMatrix::<f64>::zeros(count, count);
    let mut right = DMatrix::<f64>::zeros(count, signals.len());
    let mut place = places.iter();
    problem.rows(&[*values], |row| {
        let Some(place) = place.next() else { return };
        for (one, derivative) in row.iter().take(count).enumerate() {
            for (other, factor) in row.iter().take(count).enumerate() {
                matrix[(one, other)] += derivative * factor;
            }
            for (column, signal) in signals.iter().enumerate() {
                right[(one, column)] += derivative * number(signal, *place).unwrap_or(0.0);
            }
        }
    });
    let factors = inverse_of_normal(&matrix)? * right;
    let signals: Vec<Vec<f64>> = signals
        .iter()
        .map(|signal| {
            let mut signal = signal.clone();
            problem.without_zeros(values, &mut signal);
            signal
        })
        .collect();
    let mut left = vec![vec![f64::NAN; problem.used.len()]; signals.len()];
    let mut place = places.iter();
    problem.rows(&[*values], |row| {
        let Some(place) = place.next() else { return };
        for ((column, signal), left) in signals.iter().enumerate().zip(&mut left) {
            let of_signal = factors.column(column);
            let projected: f64 = row.iter().zip(of_signal.iter()).map(|(derivative, factor)| derivative * factor).sum();
            if let (Some(left), Some(number)) = (left.get_mut(*place), number(signal, *place)) {
                *left = number - projected;
            }
        }
    });
    Some(left)
}

/// A linear least-squares problem of a few columns, stored as the inner products of the columns with each other and with the residual.
#[derive(Clone, Debug)]
pub struct Columns {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

impl Columns {
    /// Creates the problem. The first `included` columns are already part of the residual; samples whose residual is NaN do not count.
    pub fn new(columns: &[Vec<f64>], included: usize, residual_n: &[f64]) -> Self {
        let count = columns.len();
        let (mut matrix, mut right) = (DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count));
        let mut row = vec![0.0; count];
        for (sample, residual_n) in residual_n.iter().enumerate().filter(|(_, number)| number.is_finite()) {
            for (number, column) in row.iter_mut().zip(columns) {
                *number = column.get(sample).copied().filter(|number| number.is_finite()).unwrap_or(0.0);
            }
            let without_n = residual_n - row.iter().take(included).sum::<f64>();
            for (one, number) in row.iter().enumerate() {
                right[one] -= number * without_n;
                for (other, factor) in row.iter().enumerate() {
                    matrix[(one, other)] += number * factor;
                }
            }
        }
        Self { matrix, right }
    }

    /// Returns the decrease of the sum of squares due to some of the columns.
    pub fn gain(&self, places: &[usize]) -> f64 {
        let part = DMatrix::from_fn(places.len(), places.len(), |row, column| {
            // The ridge makes nearly identical columns act as one.
            let ridge = if row == column { 1.0 + 1e-9 } else { 1.0 };
            self.matrix[(places[row], places[column])] * ridge
        });
        let of = DVector::from_fn(places.len(), |row, _| self.right[places[row]]);
        part.cholesky().map_or(0.0, |factor| factor.solve(&of).dot(&of))
    }
}
