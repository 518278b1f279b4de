//! What is left of a signal when the parameters of a model make up for what they can of it.

use fric_core::parameters::Values;
use nalgebra::DMatrix;

use crate::certainty::undetermined::inverse_of_normal;
use crate::search::problem::Problem;

/// Signals less what small changes of a problem's parameters make of them, over the samples that count; NaN elsewhere.
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
