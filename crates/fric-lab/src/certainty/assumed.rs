//! The error of estimates beside a time that is assumed.
//!
//! The time constant of contacts that age at rest follows only from rests of several lengths. A run that has none determines the size of the ageing
//! for a time that has to be assumed, and another time gives another size. So the time is held first, its logarithm counts as known with a standard
//! deviation, and the covariance of the others grows by `b bᵀ`, where `b = H⁻¹Jᵀj` is how they move if the time is off by it: `j` is the change of the
//! residuals, `H = JᵀJ`.

use fric_core::effects::dwell_stiction::TIME;
use fric_core::parameters::Values;
use nalgebra::DMatrix;

use crate::search::gram::inverse_of_normal;
use crate::search::problem::Problem;
use crate::search::solve::{Unknown, unknowns};
use crate::search::vector::Parameter;

/// Standard deviation of the logarithm of an assumed time: a 95 % interval of a factor of three on both sides, as of bearings at rest for tenths of a
/// second to seconds.
const SPREAD: f64 = 0.56;

/// Whether a parameter that the samples do not determine is assumed, with an error that the others must bear.
pub fn is_assumed(parameter: &Parameter) -> bool {
    parameter.place() == TIME
}

/// Returns the contribution of the assumed ones of the `undetermined` parameters to the covariance of a problem's free parameters.
pub fn covariance(problem: &Problem<'_>, values: &[Values], undetermined: &[Unknown]) -> DMatrix<f64> {
    let count = problem.parameter_count();
    let of_one = |unknown: &Unknown| -> Option<DMatrix<f64>> {
        let mut with = Problem { seat: None, ..problem.clone() };
        with.members.get_mut(unknown.member)?.free.push(unknown.parameter);
        let (matrix, ..) = with.gram(values)?.normal_equations();
        let place = unknowns(&with).iter().position(|of| of == unknown)?;
        let value = values.get(unknown.member)?[unknown.parameter.place()];
        let coupling = matrix.column(place).remove_row(place) * (SPREAD * value);
        let moves = inverse_of_normal(&matrix.remove_row(place).remove_column(place))? * coupling;
        Some(&moves * moves.transpose())
    };
    let assumed = undetermined.iter().filter(|unknown| is_assumed(&unknown.parameter));
    assumed.filter_map(of_one).fold(DMatrix::zeros(count, count), |sum, of_one| sum + of_one)
}
