//! The uncertainty of the unknowns: intervals that contain the true values.
//!
//! Four contributions add up. The first is noise: white noise, or the estimate from blocks of the run for correlated residuals, whichever is greater.
//! The second is the calibration error of the lines, which the fit includes. The third is that holes share a μ although each has its own. The fourth
//! is the error of the model itself: segments of constant curvature, Dahl's contacts. It repeats in every sample, so the statistics of a run cannot
//! show it; its size comes from a comparison with an independent elastica whose holes stick and slip.

use fric_lab::replay::Deviation;
use fric_tendon::ManipulatorParams;
use fric_tendon::file::OneOrEach;
use nalgebra::{DMatrix, DVector};

use super::arc_error::arc_error_m;
use super::evaluation::Runs;
use super::least_squares::{Normal, Solution};
use super::unknown::Unknown;
use crate::discover::friction::spread;

/// Root mean square error of the model's tensions relative to the greatest tension: 0.4 mN of 1.7 N in runs with both directions, against the
/// elastica with each hole's own μ (docs/manipulators.md).
pub const MODEL_TENSION_RATIO: f64 = 0.00024;
/// The same for the disks relative to the length, at a bend of 130°.
const MODEL_MARKER_RATIO: f64 = 0.0002;
/// Distance by which constant curvature misses a disk, as a multiple of the pitch and the third power of a segment's bend, rad: between two holes the
/// tendon is straight, so that the curvature is least in the middle. 0.09 to 0.12 in the mean of finely divided arms of 8, 6, 4 and 3 segments, at bends
/// to 65° each. With eight segments it is less than [`MODEL_MARKER_RATIO`] has, which was found with these.
const ARC_RATIO: f64 = 0.1;
/// Negligible distance as a multiple of the model's own error. At half of it, quiet runs of a correct model come near the bound; at twice, a bending
/// stiffness that is 0.5 % off is missed.
pub const PRACTICAL: f64 = 2.5;
/// Fraction of the error of the model's tensions that acts along one unknown. The error is smooth, and therefore near some combination of a handful of
/// unknowns.
pub const ALONG_RATIO: f64 = 0.5;

/// Standard error of μ as a fraction of the difference between the two forms of the friction law.
const LAW_SHARE: f64 = 0.85;

/// Returns the root mean square error of the model's disks under tensions in each segment, sample by sample, m.
pub fn model_marker_m<'a>(params: &ManipulatorParams, tension_n: impl Iterator<Item = &'a [f64]>) -> f64 {
    let mut arc_m = Deviation::default();
    for row in tension_n {
        let segments = row.iter().zip(params.pitch_m()).zip(params.segment_stiffness_n_m2());
        for ((tension_n, pitch_m), stiffness_n_m2) in segments {
            let bend_rad = tension_n * params.hole_radius_m() * pitch_m / stiffness_n_m2;
            arc_m.add(ARC_RATIO * pitch_m * bend_rad.powi(3));
        }
    }
    (MODEL_MARKER_RATIO * params.length_m()).max(arc_m.rms().unwrap_or(0.0))
}

/// Returns the covariance of the unknowns as distances, without the lines; `None` if the run says nothing.
pub fn covariance(runs: &Runs, solution: &Solution) -> Option<DMatrix<f64>> {
    let normal = solution.normal(&[])?;
    let count = solution.state.unknowns.len();
    let mut covariance = statistical(&normal, count) + systematic(runs, solution, &normal).view((0, 0), (count, count));
    if let Some(of_holes) = of_holes(runs, solution) {
        covariance += of_holes;
    }
    add_law(runs, solution, &mut covariance);
    Some(covariance)
}

/// Returns the contribution of noise: white or, for each unknown, that of blocks if it is greater. The prior of the lines is part of the inverse.
fn statistical(normal: &Normal, count: usize) -> DMatrix<f64> {
    let white = &normal.inverse;
    let lines = normal.inverse.columns(count, normal.inverse.ncols() - count);
    let in_blocks = normal.scores.covariance(white) + lines * lines.transpose();
    let factor = |place: usize| {
        let ratio: f64 = in_blocks[(place, place)] / white[(place, place)];
        if ratio.is_finite() { ratio.max(1.0).sqrt() } else { 1.0 }
    };
    DMatrix::from_fn(count, count, |row, column| factor(row) * factor(column) * white[(row, column)])
}

/// Returns the contribution of the model error. That of the shapes is known at each sample ([`arc_error_m`]) and moves the unknowns by `(JᵀJ)⁻¹Jᵀb`. Of
/// that of the tensions only the size b in each of N residuals is, of which a fraction acts along each unknown.
fn systematic(runs: &Runs, solution: &Solution, normal: &Normal) -> DMatrix<f64> {
    let off = MODEL_TENSION_RATIO * runs.greatest_tension_n / solution.units.tension_n;
    let of_tensions = &normal.matrices[0] * (normal.counts[0] * (ALONG_RATIO * off).powi(2));
    let of_shapes = &normal.inverse * solution.pull_of_markers(&arc_error_m(&solution.evaluation));
    &normal.inverse * of_tensions * &normal.inverse + &of_shapes * of_shapes.transpose()
}

/// Returns the contribution of holes that differ while the model has one μ for all, or a list that is scaled. Each hole moves the unknowns by its own
/// slopes (delta method), by as much as the run cannot exclude.
fn of_holes(runs: &Runs, solution: &Solution) -> Option<DMatrix<f64>> {
    let unknowns: Vec<Unknown> = solution.state.unknowns.iter().map(|(unknown, _)| *unknown).collect();
    let has_friction = match &runs.given.tendon.mu {
        OneOrEach::One(mu) => *mu > 0.0 || unknowns.contains(&Unknown::SharedMu),
        OneOrEach::Each(_) => unknowns.contains(&Unknown::SharedMu),
    };
    if !has_friction || !runs.has_base_tension() || unknowns.iter().any(|one| matches!(one, Unknown::HoleMu(_))) {
        return None;
    }
    let count = unknowns.len();
    let holes: Vec<Unknown> = (0..runs.given.disk_count).map(Unknown::HoleMu).collect();
    let slopes = solution.slopes_by(runs, &holes)?;
    let with_holes = solution.normal(&slopes)?;
    let whole = DMatrix::from(&with_holes.matrices[0] + &with_holes.matrices[1]);
    let shared = unknowns.iter().position(|unknown| *unknown == Unknown::SharedMu);
    // The shared μ is the mean of the others, so it is left out while each hole is considered.
    let others: Vec<usize> = (0..whole.nrows()).filter(|place| Some(*place) != shared).collect();
    let picked = DMatrix::from_fn(others.len(), others.len(), |row, column| {
        let (row, column) = (others[row], others[column]);
        // The prior of the lines.
        let prior = if row == column && row >= count + holes.len() { 1.0 } else { 0.0 };
        whole[(row, column)] + prior
    });
    let inverse = fric_lab::statistics::inverse_of_normal(&picked)?;
    let gradient = DVector::from_iterator(others.len(), others.iter().map(|place| with_holes.gradient[*place]));
    let step = -(&inverse * gradient);
    let first = count - usize::from(shared.is_some());
    let ratio = spread::spread(
        &step.rows(first, holes.len()).into_owned(),
        inverse.view((first, first), (holes.len(), holes.len())).into_owned(),
    );
    let normal = solution.normal(&[])?;
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let share = 1.0 / holes.len() as f64;
    let mut covariance = DMatrix::zeros(count, count);
    for hole in 0..holes.len() {
        let own = (0..count).chain(count + holes.len()..whole.nrows());
        let pull = DVector::from_iterator(normal.inverse.nrows(), own.map(|place| whole[(place, count + hole)]));
        let mut change = (&normal.inverse * pull).rows(0, count) * ratio;
        if let Some(shared) = shared {
            change[shared] -= share * ratio;
        }
        covariance += &change * change.transpose();
    }
    Some(covariance)
}

/// Adds the uncertainty of the friction law. The normal force on a hole is either the normal component of both tensions, as in the model, or their
/// full sum; the two differ by `√(1 − μ²)`, and a lab's value may be either. With this fraction the interval still contains both, beside noise of
/// about the same size.
fn add_law(runs: &Runs, solution: &Solution, covariance: &mut DMatrix<f64>) {
    let tables = solution.state.tables(&runs.given);
    for (place, (unknown, _)) in solution.state.unknowns.iter().enumerate() {
        if let Unknown::SharedMu | Unknown::HoleMu(_) = unknown {
            let mu = unknown.value(&tables);
            let between = (1.0 - mu * mu).max(0.1).sqrt().recip() - 1.0;
            covariance[(place, place)] += (LAW_SHARE * between).powi(2);
        }
    }
}
