//! Prepares a run for the search: decimated, and split into training samples and held-out samples.

use fric_lab::replay::Deviation;
use fric_lab::statistics::{blocks, white_noise_in};
use fric_tendon::file::{ManipulatorFile, OneOrEach};
use fric_tendon::{ManipulatorParams, Tendon};

use super::friction::lines::take_off;
use super::friction::model::Model;
use crate::error::ContinuumError;
use crate::gratings::Gratings;
use crate::run::{Run, RunSample};
use crate::shape_errors::{ComputedShape, Way, shapes};

/// Maximum number of samples to compare. The history may take long steps while the tension changes in one direction.
const MOST_SAMPLES: usize = 800;
/// Minimum number of samples, of which half are held out.
const LEAST_SAMPLES: usize = 40;
/// Turning points of the tension are kept if they exceed this fraction of the greatest tension.
const TURN_RATIO: f64 = 0.005;
/// Number of samples in a block of the noise estimate.
const NOISE_BLOCK: usize = 40;

/// A run with its measurements.
pub struct Case<'a> {
    pub file: &'a ManipulatorFile,
    pub samples: Vec<RunSample>,
    /// Tension in each segment, N; NaN if it was not measured.
    pub observed_n: Vec<Vec<f64>>,
    pub held_out: Vec<bool>,
    /// Whether each grating is dead, or disproportionate to its neighbours.
    pub is_dead: Vec<Vec<bool>>,
    /// Error of each tension for one standard error of its calibration line's constant and of its slope, N.
    pub line_error_n: Vec<Vec<[f64; 2]>>,
    /// Errors of each line that tensions and markers show together, in standard errors of its constant and slope. Shapes are computed without them.
    pub found_lines: Vec<[f64; 2]>,
    /// Slope of each grating's calibration, N/nm.
    pub newton_per_nm: Vec<f64>,
    /// Noise of the gratings, N, used to weight the errors of the calibration lines; estimated from the given model's residual.
    pub noise_n: f64,
    /// Standard error of the tension at the base if that is an estimate without its noise, N.
    pub base_error_n: f64,
    pub run_samples: usize,
}

/// Residuals of a model (gratings minus model, N) and their sums.
#[derive(Clone, Debug)]
pub struct Fit {
    pub model: Model,
    /// Residuals after subtracting the estimated errors of the calibration lines.
    pub residual_n: Vec<Vec<f64>>,
    /// Estimated errors of the calibration lines, in standard errors of constant and slope.
    pub line_errors: Vec<[f64; 2]>,
    /// Training sum of squares, N². The errors of the lines are included, each as a residual in units of the noise.
    pub squares: f64,
    /// Error over the held-out samples.
    pub held_out_n: Deviation,
    /// Tension of the model in each segment, N.
    pub tension_n: Vec<Vec<f64>>,
    /// Markers minus disks, m; NaN if a marker is hidden or there is no shape, empty without markers.
    pub marker_m: Vec<Vec<[f64; 2]>>,
}

impl<'a> Case<'a> {
    /// Prepares a run. `kept` holds the samples to compare, `base_error_n` is the standard error of the tension at the base, N.
    pub fn new(
        file: &'a ManipulatorFile,
        run: &Run,
        gratings: &Gratings,
        kept: &[usize],
        base_error_n: f64,
    ) -> Result<Self, ContinuumError> {
        let tensions = gratings.unbridged(run)?;
        let judged = gratings.read(run)?;
        if kept.len() < LEAST_SAMPLES {
            return Err(ContinuumError::TooShort { count: kept.len(), needed: LEAST_SAMPLES });
        }
        let samples: Vec<RunSample> = kept.iter().filter_map(|place| run.samples().get(*place)).cloned().collect();
        let row = |place: &usize| Some(tensions.get(*place)?.iter().map(|tension| tension.value_n).collect());
        let observed_n: Vec<Vec<f64>> = kept.iter().filter_map(row).collect();
        let line_errors = |row: &Vec<f64>| -> Vec<[f64; 2]> {
            let lines = gratings.lines().iter().zip(gratings.line_errors());
            lines.zip(row).map(|((line, error), tension_n)| error.parts_n(line.shift_nm(*tension_n))).collect()
        };
        let span_s = samples.last().map_or(0.0, |last| last.time_s) - samples.first().map_or(0.0, |first| first.time_s);
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let cycle_s = span_s / samples.len() as f64;
        let mut held_out = vec![false; samples.len()];
        for block in blocks(samples.len(), cycle_s) {
            held_out[block.cycles].fill(block.held_out);
        }
        let mut case = Self {
            file,
            noise_n: 0.0,
            base_error_n,
            line_error_n: observed_n.iter().map(line_errors).collect(),
            found_lines: vec![[0.0; 2]; gratings.lines().len()],
            observed_n,
            is_dead: kept.iter().filter_map(|place| Some(judged.get(*place)?.is_bridged.clone())).collect(),
            samples,
            held_out,
            newton_per_nm: gratings.lines().iter().map(|line| line.newton_per_nm).collect(),
            run_samples: run.samples().len(),
        };
        let given = case.fit(&case.given()).ok_or(ContinuumError::UntoldNoise)?;
        case.noise_n = case.noise_of(&given)?;
        Ok(case)
    }

    /// Returns the model that the file states.
    pub fn given(&self) -> Model {
        let mu = self.file.params().mu(Tendon::Agonist).to_vec();
        let way = if mu.iter().all(|mu| *mu == 0.0) {
            Way::None
        } else if self.file.tables().tendon.sigma_n_per_m.is_none() {
            Way::Coulomb
        } else {
            Way::History
        };
        let count = mu.len();
        Model {
            way,
            mu,
            is_shared_given: false,
            is_own: vec![false; count],
            drifts: vec![false; count],
            drift_n_per_s: vec![0.0; count],
        }
    }

    /// Returns the same run with nothing held out.
    pub fn whole(&self) -> Self {
        Self {
            samples: self.samples.clone(),
            observed_n: self.observed_n.clone(),
            is_dead: self.is_dead.clone(),
            line_error_n: self.line_error_n.clone(),
            found_lines: self.found_lines.clone(),
            newton_per_nm: self.newton_per_nm.clone(),
            held_out: vec![false; self.held_out.len()],
            ..*self
        }
    }

    /// Returns the manipulator with this μ at the holes and a scaled bending stiffness.
    pub fn params(&self, mu: &[f64], stiffness_ratio: f64) -> Option<ManipulatorParams> {
        let mut tables = self.file.tables().clone();
        tables.tendon.mu = OneOrEach::Each(mu.to_vec());
        tables.backbone.youngs_modulus_pa *= stiffness_ratio;
        // A second tendon equal to the first stays unchanged; it is slack.
        ManipulatorFile::check(tables).ok().map(|file| *file.params())
    }

    /// Returns the tension of a model in each segment, N; NaN where it has no shape, `None` if it has none at all.
    pub fn tensions_n(&self, model: &Model) -> Option<Vec<Vec<f64>>> {
        let computed = shapes(&self.params(&model.mu, 1.0)?, &self.samples, model.way, &[]).ok()?;
        let tensions = |shape: ComputedShape| {
            if shape.status.has_shape() { shape.tension_n } else { vec![f64::NAN; model.mu.len()] }
        };
        Some(computed.into_iter().map(tensions).collect())
    }

    /// Returns a model with its residuals; `None` if it has no shapes.
    pub fn fit(&self, model: &Model) -> Option<Fit> {
        let computed = shapes(&self.params(&model.mu, 1.0)?, &self.samples, model.way, &[]).ok()?;
        let start_s = self.samples.first()?.time_s;
        let mut residual_n = Vec::with_capacity(computed.len());
        for ((shape, observed_n), sample) in computed.iter().zip(&self.observed_n).zip(&self.samples) {
            let elapsed_s = sample.time_s - start_s;
            let has_shape = shape.status.has_shape();
            let segments = observed_n.iter().zip(&shape.tension_n).zip(&model.drift_n_per_s);
            let row: Vec<f64> = segments
                .map(
                    |((observed_n, tension_n), drift_n_per_s)| {
                        if has_shape { observed_n - tension_n - drift_n_per_s * elapsed_s } else { f64::NAN }
                    },
                )
                .collect();
            residual_n.push(row);
        }
        let line_errors = take_off(self, &mut residual_n);
        let mut held_out_n = Deviation::default();
        let mut squares: f64 = line_errors.iter().flatten().map(|errors| (errors * self.noise_n).powi(2)).sum();
        for (row, held_out) in residual_n.iter().zip(&self.held_out) {
            for residual_n in row.iter().filter(|residual_n| residual_n.is_finite()) {
                if *held_out {
                    held_out_n.add(*residual_n);
                } else {
                    squares += residual_n * residual_n;
                }
            }
        }
        let marker_m = computed.iter().zip(&self.samples).map(|(shape, sample)| off_markers(shape, sample)).collect();
        let tension_n = computed.into_iter().map(|shape| shape.tension_n).collect();
        (squares > 0.0).then(|| Fit {
            model: model.clone(),
            residual_n,
            line_errors,
            squares,
            held_out_n,
            tension_n,
            marker_m,
        })
    }

    /// Returns the root mean square error of the tensions over the run for one standard error of the calibration lines, N.
    pub fn line_error_rms_n(&self) -> f64 {
        let mut all = Deviation::default();
        for [constant_n, slope_n] in self.line_error_n.iter().flatten() {
            all.add(constant_n.hypot(*slope_n));
        }
        all.rms().unwrap_or(0.0)
    }

    /// Returns the number of training tensions, which the evidence counts. The error of a calibration line, which all samples share, is a separate
    /// term.
    pub fn learned_count(&self) -> f64 {
        let learned = self.observed_n.iter().zip(&self.held_out).filter(|(_, held_out)| !**held_out);
        #[expect(clippy::cast_precision_loss, reason = "a count of tensions")]
        let count = learned.flat_map(|(row, _)| row).filter(|tension_n| tension_n.is_finite()).count() as f64;
        count
    }

    /// Returns the standard deviation of the gratings' noise, N, from a residual.
    ///
    /// # Errors
    /// Returns [`ContinuumError::UntoldNoise`] if gaps leave too few samples.
    pub fn noise_of(&self, fit: &Fit) -> Result<f64, ContinuumError> {
        let mut series = Vec::new();
        for grating in 0..self.newton_per_nm.len() {
            series.extend(fit.residual_n.iter().filter_map(|row| row.get(grating)).copied());
            series.push(f64::NAN);
        }
        white_noise_in(&series, NOISE_BLOCK.min(self.samples.len() / 2)).ok_or(ContinuumError::UntoldNoise)
    }
}

/// Returns markers minus disks; NaN if a marker is hidden or there is no shape.
pub fn off_markers(shape: &ComputedShape, sample: &RunSample) -> Vec<[f64; 2]> {
    let has_shape = shape.status.has_shape();
    let off = |([x_m, y_m], [marker_x_m, marker_y_m]): (&[f64; 2], &[f64; 2])| {
        if has_shape { [marker_x_m - x_m, marker_y_m - y_m] } else { [f64::NAN; 2] }
    };
    shape.disk_position_m.iter().zip(&sample.marker_m).map(off).collect()
}

/// Returns indices of samples: some, evenly spaced, and all turning points of the tension.
pub fn thinned(samples: &[RunSample]) -> Vec<usize> {
    thinned_to(samples, MOST_SAMPLES)
}

/// Returns the same with at most `most` samples besides the turning points.
pub fn thinned_to(samples: &[RunSample], most: usize) -> Vec<usize> {
    let stride = samples.len().div_ceil(most).max(1);
    let greatest_n = samples.iter().map(|sample| sample.tension_base_n).fold(0.0, f64::max);
    let band_n = TURN_RATIO * greatest_n;
    let mut turns = Vec::new();
    let (mut extreme, mut rises) = (0_usize, true);
    let tension_n = |place: usize| samples.get(place).map_or(0.0, |sample| sample.tension_base_n);
    for place in 0..samples.len() {
        let ahead_n = if rises { tension_n(place) - tension_n(extreme) } else { tension_n(extreme) - tension_n(place) };
        if ahead_n >= 0.0 {
            extreme = place;
        } else if ahead_n < -band_n {
            turns.push(extreme);
            (extreme, rises) = (place, !rises);
        }
    }
    let last = samples.len().saturating_sub(1);
    let is_kept = |place: &usize| place.is_multiple_of(stride) || *place == last || turns.binary_search(place).is_ok();
    (0..samples.len()).filter(is_kept).collect()
}
