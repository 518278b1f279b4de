//! What of a residual of the tensions counts as noise.
//!
//! The noise itself is estimated from the residual. The search goes on while more is left than an error of that estimate and what the calibration
//! leaves open of the gratings' lines. The verdict passes over what is practically nothing. How large the gap was before does not enter.

use super::case::{Case, Fit};
use crate::replay::Deviation;

/// Error of the noise's own estimate, as a share of the noise in quadrature: 4 % of the root mean square, which some hundred samples of eight
/// gratings tell it to. At half of it chance alone keeps the search going, at twice a rest of half the noise ends it.
const NOISE_ERROR_RATIO: f64 = 0.3;
/// Standard errors of the gratings' lines.
const LINE_ERRORS: f64 = 2.0;
/// Share of the greatest tension that is practically nothing: what a spread of μ by ±10 % over the holes, which every manipulator has, leaves at
/// usual bends. At half of it such a spread is a rest in quiet runs, at twice one of ±20 % is none.
const PRACTICAL_RATIO: f64 = 0.0025;
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

/// Whether nothing is left to look for.
pub fn is_noise(case: &Case<'_>, fit: &Fit, noise_n: f64) -> bool {
    excess_n(fit, noise_n) <= noise_excess_n(case, noise_n)
}

/// Whether what is left is noise, or practically nothing.
pub fn is_negligible(case: &Case<'_>, fit: &Fit, noise_n: f64) -> bool {
    excess_n(fit, noise_n) <= negligible_n(case, noise_n)
}

/// What counts as nothing above the noise, N.
fn negligible_n(case: &Case<'_>, noise_n: f64) -> f64 {
    let greatest_n = case.samples.iter().map(|sample| sample.tension_base_n).fold(0.0, f64::max);
    noise_excess_n(case, noise_n).hypot(PRACTICAL_RATIO * greatest_n)
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
    rms_n * rms_n - noise_n * noise_n <= (SINGLE_RATIO * negligible_n(case, noise_n)).powi(2)
}
