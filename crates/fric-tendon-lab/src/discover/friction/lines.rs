//! Estimates the errors of the gratings' calibration lines together with a model.
//!
//! The calibration gives constant and slope of each line with a standard error. In a fit both errors are unknowns, in standard errors, with the prior
//! 0 ± 1 (generalised least squares). The error of a line is common to all samples and therefore no evidence for an effect.

use nalgebra::{Matrix2, Vector2};

use crate::discover::case::Case;

/// Maximum error of a line in standard errors, constant and slope together: one line in a thousand exceeds it (√χ² of two numbers). Anything beyond
/// stays in the residual.
const MOST_ERRORS: f64 = 3.7;

/// Subtracts the estimated errors of the lines from a residual, as far as the calibration allows. Returns them in standard errors of each line's
/// constant and slope.
pub fn take_off(case: &Case<'_>, residual_n: &mut [Vec<f64>]) -> Vec<[f64; 2]> {
    let mut errors = Vec::with_capacity(case.newton_per_nm.len());
    for segment in 0..case.newton_per_nm.len() {
        let parts = |sample: usize| {
            let parts = case.line_error_n.get(sample).and_then(|row| row.get(segment)).copied();
            Vector2::from(parts.unwrap_or([f64::NAN; 2]))
        };
        let (mut matrix, mut right) = (Matrix2::identity() * case.noise_n.powi(2), Vector2::zeros());
        for (sample, row) in residual_n.iter().enumerate().filter(|(sample, _)| !case.held_out[*sample]) {
            let left_n = row[segment];
            if left_n.is_finite() {
                let parts_n = parts(sample);
                matrix += parts_n * parts_n.transpose();
                right += left_n * parts_n;
            }
        }
        let found = matrix.cholesky().map_or_else(Vector2::zeros, |factor| factor.solve(&right));
        let found = found * (MOST_ERRORS / found.norm()).min(1.0);
        for (sample, row) in residual_n.iter_mut().enumerate() {
            // A gap has no shift either.
            if row[segment].is_finite() {
                row[segment] -= parts(sample).dot(&found);
            }
        }
        errors.push(found.into());
    }
    errors
}
