//! What of a residual of the tensions counts as noise.
//!
//! The noise itself is estimated from the residual; an error of that estimate is allowed for, and what the calibration leaves open of
//! the gratings' lines. How large the gap was before does not enter.

use super::case::{Case, Fit};
use crate::replay::Deviation;

/// Error of the noise's own estimate, as a share of the noise in quadrature: 4 % of the root mean square. At half of it one in ten simulated runs of
/// a right model has something left, at twice a rest of half the noise is passed over.
const NOISE_ERROR_RATIO: f64 = 0.3;
/// Standard errors of the gratings' lines.
const LINE_ERRORS: f64 = 2.0;
/// A single grating may have so many times as much left as all have in the mean.
const SINGLE_RATIO: f64 = 2.0;

pub fn rms_n(fit: &Fit) -> f64 {
    fit.held_out_n.rms().unwrap_or(f64::INFINITY)
}

/// What a residual has above the noise, root mean square.
pub fn excess_n(fit: &Fit, noise_n: f64) -> f64 {
    let rms_n = rms_n(fit);
    (rms_n * rms_n - noise_n * noise_n).max(0.0).sqrt()
}

pub fn is_noise(case: &Case<'_>, fit: &Fit, noise_n: f64) -> bool {
    excess_n(fit, noise_n) <= noise_excess_n(case, noise_n)
}

/// What counts as noise above the noise, N.
fn noise_excess_n(case: &Case<'_>, noise_n: f64) -> f64 {
    (LINE_ERRORS * case.line_error_rms_n()).hypot(NOISE_ERROR_RATIO * noise_n)
}

/// Whether one grating, from 0, has noise left alone.
pub fn is_noise_at(case: &Case<'_>, fit: &Fit, noise_n: f64, grating: usize) -> bool {
    let mut left_n = Deviation::default();
    for (row, _) in fit.residual_n.iter().zip(&case.held_out).filter(|(_, held_out)| **held_out) {
        row.get(grating).into_iter().for_each(|residual_n| left_n.add(*residual_n));
    }
    let rms_n = left_n.rms().unwrap_or(0.0);
    rms_n * rms_n - noise_n * noise_n <= (SINGLE_RATIO * noise_excess_n(case, noise_n)).powi(2)
}
