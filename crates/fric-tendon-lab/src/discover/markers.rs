//! Compares markers with the shapes under the tensions that the gratings measure.
//!
//! With measured tensions the friction has no influence on a shape. A difference between disks and markers above the markers' noise and beyond the
//! calibration error of the gratings must come from the bending: from stiffness, geometry, loads, or the markers' frame.

use fric_lab::replay::Deviation;
use fric_lab::statistics::white_noise_throughout;

use super::case::{Case, Fit, off_markers};
use super::friction::model::Model;
use crate::fbg::Tension;
use crate::gratings::GratingSample;
use crate::identify::errors::{PRACTICAL, model_marker_m};
use crate::run::RunSample;
use crate::shape_errors::{Way, shapes};

/// Limits of noise: this many standard errors of the calibration lines, and a relative error of the noise estimate itself.
const LINE_ERRORS: f64 = 2.0;
const NOISE_ERROR_RATIO: f64 = 0.3;
/// Maximum number of samples at which the influence of the lines on the shapes is computed.
const MOST_SHAPES: usize = 40;

/// Distances between disks and markers under the tensions that the gratings measure.
#[derive(Clone, Debug)]
pub struct MarkerFit {
    /// Markers minus disks, m; NaN if a marker is hidden or there is no shape.
    pub residual_m: Vec<Vec<[f64; 2]>>,
    /// The applied tensions, N.
    pub tension_n: Vec<Vec<f64>>,
    /// Root mean square noise of a distance, m: noise of the markers, and of the shapes due to the gratings' noise.
    pub noise_m: f64,
    /// Root mean square displacement of the disks for one standard error of the calibration lines, m.
    pub line_error_m: f64,
    /// Distances over all disks.
    pub distance_m: Deviation,
    pub greatest_m: f64,
    /// Negligible distance, m.
    practical_m: f64,
}

impl MarkerFit {
    /// Computes the distances of a model. Returns `None` without markers, or with too few to estimate their noise.
    pub fn new(case: &Case<'_>, fit: &Fit) -> Option<Self> {
        if case.samples.iter().all(|sample| sample.marker_m.is_empty()) {
            return None;
        }
        let tension_n = tensions(case, fit);
        let residual_m = residuals(case, &fit.model, &case.samples, &tension_n, 1.0)?;
        let noise_m = noise_m(&residual_m)?;
        let (mut distance_m, mut greatest_m) = (Deviation::default(), 0.0_f64);
        for [x_m, y_m] in residual_m.iter().flatten().filter(|[x_m, y_m]| (x_m + y_m).is_finite()) {
            distance_m.add(x_m.hypot(*y_m));
            greatest_m = greatest_m.max(x_m.hypot(*y_m));
        }
        let line_error_m = line_error_m(case, &fit.model, &tension_n)?;
        let params = case.file.params();
        let practical_m = PRACTICAL * model_marker_m(params, tension_n.iter().map(Vec::as_slice));
        Some(Self { residual_m, tension_n, noise_m, line_error_m, distance_m, greatest_m, practical_m })
    }

    pub fn rms_m(&self) -> f64 {
        self.distance_m.rms().unwrap_or(0.0)
    }

    /// Returns the root mean square distance above the noise, m.
    pub fn excess_m(&self) -> f64 {
        (self.rms_m().powi(2) - self.noise_m.powi(2)).max(0.0).sqrt()
    }

    /// Whether the disks are further off than a common error `tension_n` of all gratings could explain: more than twice the displacement by one
    /// standard error of the independent calibration lines, scaled to this error.
    pub fn is_beyond(&self, case: &Case<'_>, tension_n: f64) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let alike = (case.newton_per_nm.len() as f64).sqrt();
        self.excess_m() > LINE_ERRORS * alike * self.line_error_m * tension_n / case.line_error_rms_n()
    }

    /// Whether noise and calibration explain all but a negligible part.
    pub fn is_noise(&self) -> bool {
        let allowed_m = (LINE_ERRORS * self.line_error_m).hypot(NOISE_ERROR_RATIO * self.noise_m);
        self.excess_m() <= allowed_m.hypot(self.practical_m)
    }
}

/// Returns the tensions measured by the gratings, without known drifts and errors of the lines; those of the model where a grating is dead.
fn tensions(case: &Case<'_>, fit: &Fit) -> Vec<Vec<f64>> {
    let start_s = case.samples.first().map_or(0.0, |sample| sample.time_s);
    let measured = case.observed_n.iter().zip(&case.line_error_n).zip(&case.is_dead);
    let rows = measured.zip(&fit.tension_n).zip(&case.samples);
    rows.map(|((((observed_n, line_error_n), is_dead), model_n), sample)| {
        let lines =
            line_error_n.iter().zip(&case.found_lines).map(|(parts_n, off)| parts_n[0] * off[0] + parts_n[1] * off[1]);
        let known =
            lines.zip(&fit.model.drift_n_per_s).map(|(line_n, drift)| line_n + drift * (sample.time_s - start_s));
        let segments = observed_n.iter().zip(known).zip(is_dead.iter().zip(model_n));
        segments
            .map(|((observed_n, known_n), (is_dead, model_n))| if *is_dead { *model_n } else { observed_n - known_n })
            .collect()
    })
    .collect()
}

/// Returns markers minus disks for given tensions and a scaled bending stiffness.
pub fn residuals(
    case: &Case<'_>,
    model: &Model,
    samples: &[RunSample],
    tension_n: &[Vec<f64>],
    stiffness_ratio: f64,
) -> Option<Vec<Vec<[f64; 2]>>> {
    let measured = |row: &Vec<f64>| GratingSample {
        tension: row.iter().map(|value_n| Tension { value_n: *value_n, standard_error_n: 0.0 }).collect(),
        is_bridged: vec![false; row.len()],
    };
    let measured: Vec<GratingSample> = tension_n.iter().map(measured).collect();
    let params = case.params(&model.mu, stiffness_ratio)?;
    let computed = shapes(&params, samples, Way::Measured, &measured).ok()?;
    Some(computed.iter().zip(samples).map(|(shape, sample)| off_markers(shape, sample)).collect())
}

/// Returns the noise of a distance, from both coordinates of all disks together. Hidden markers are skipped.
pub fn noise_m(residual_m: &[Vec<[f64; 2]>]) -> Option<f64> {
    let disk_count = residual_m.iter().map(Vec::len).max().unwrap_or(0);
    let mut series = Vec::new();
    for (disk, coordinate) in (0..disk_count).flat_map(|disk| [(disk, 0), (disk, 1)]) {
        let values = residual_m.iter().filter_map(|row| row.get(disk)).map(|place| place[coordinate]);
        series.extend(values.filter(|value| value.is_finite()));
        series.push(f64::NAN);
    }
    white_noise_throughout(&series).map(|noise_m| noise_m * std::f64::consts::SQRT_2)
}

/// Returns the root mean square displacement of the disks over disks and samples for one standard error of each line, m.
fn line_error_m(case: &Case<'_>, model: &Model, tension_n: &[Vec<f64>]) -> Option<f64> {
    let stride = case.samples.len().div_ceil(MOST_SHAPES).max(1);
    let shown: Vec<usize> = (0..case.samples.len()).step_by(stride).collect();
    let samples: Vec<RunSample> = shown.iter().filter_map(|place| case.samples.get(*place)).cloned().collect();
    let part =
        |rows: &[Vec<f64>]| -> Vec<Vec<f64>> { shown.iter().filter_map(|place| rows.get(*place)).cloned().collect() };
    let tension_n = part(tension_n);
    let undisturbed = residuals(case, model, &samples, &tension_n, 1.0)?;
    let mut sum_m2 = 0.0;
    for (segment, line_part) in (0..model.mu.len()).flat_map(|segment| [(segment, 0), (segment, 1)]) {
        let mut disturbed_n = tension_n.clone();
        for (row, place) in disturbed_n.iter_mut().zip(&shown) {
            let error_n =
                case.line_error_n.get(*place).and_then(|row| row.get(segment)).map_or(0.0, |parts| parts[line_part]);
            if let Some(tension_n) = row.get_mut(segment).filter(|_| error_n.is_finite()) {
                *tension_n += error_n;
            }
        }
        let disturbed = residuals(case, model, &samples, &disturbed_n, 1.0)?;
        let mut moved_m = Deviation::default();
        for ([x_m, y_m], [other_x_m, other_y_m]) in disturbed.iter().flatten().zip(undisturbed.iter().flatten()) {
            moved_m.add((x_m - other_x_m).hypot(y_m - other_y_m));
        }
        sum_m2 += moved_m.rms().unwrap_or(0.0).powi(2);
    }
    Some(sum_m2.sqrt())
}
