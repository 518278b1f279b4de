//! What a discovery gives for one cable.

use fric_core::effects::Effect;
use fric_core::parameters::Values;
use nalgebra::DMatrix;

use super::faults::RecordingFault;
use super::figures::curve::FrictionCurves;
use super::figures::profile::Profile;
use super::naming::Refusal;
use super::readiness::Lack;
use super::rest::neighbours::Neighbour;
use super::rest::places::Place;
use crate::fit::{CableRecord, Parameter, SampleCounts};
use crate::replay::Deviation;

/// Whether something is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing: what is left is noise.
    Complete,
    /// Something with a name; what is left with it is noise.
    Extended,
    /// Something that no effect of the catalogue accounts for.
    Unexplained,
    /// The log does not allow to tell.
    Untold,
}

/// A model with its errors on the samples held out.
#[derive(Clone, Debug)]
pub struct Model {
    /// All its parameters.
    pub values: Values,
    /// Those that were fitted, in the order of the covariance.
    pub fitted: Vec<Parameter>,
    /// Covariance of the fitted parameters.
    pub covariance: DMatrix<f64>,
    /// Force at the platform less the reference on the samples held out.
    pub held_out_n: Deviation,
}

/// An effect that was found.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Its effect in the catalogue.
    pub effect: Effect,
    /// Error with it and all found before it, on the samples held out.
    pub held_out_n: Deviation,
    /// Schwarz's criterion with it less without it; negative speaks for it.
    pub delta_bic: f64,
    /// The best other effect in its place, by the same criterion against no effect there.
    pub runner_up: Option<RunnerUp>,
}

/// Another effect that might have been it.
#[derive(Clone, Debug)]
pub struct RunnerUp {
    /// Its effect in the catalogue.
    pub effect: Effect,
    /// Schwarz's criterion with it less without it.
    pub delta_bic: f64,
    /// Sum of squares with it over the samples held out, N².
    pub held_out_squares: f64,
    /// The log cannot tell it from the one that was found.
    pub is_as_good: bool,
}

/// An effect by itself beside the given model.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Its effect in the catalogue.
    pub effect: Effect,
    /// Schwarz's criterion with it less without it; of one that cannot enter an upper bound, for its search ended early.
    pub delta_bic: f64,
    /// Root mean square of the error with it on the samples held out, N.
    pub held_out_rms_n: f64,
}

/// An effect that helps the extended model and does not suffice.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Its effect in the catalogue.
    pub effect: Effect,
    /// Schwarz's criterion with it less without it, the memory of the residual taken into account.
    pub delta_bic: f64,
    /// Root mean square of the error with it on the samples held out, N.
    pub held_out_rms_n: f64,
    /// Why it is not named.
    pub refusal: Refusal,
}

/// What no effect accounts for.
#[derive(Clone, Debug, Default)]
pub struct Unexplained {
    /// Root mean square of what is left above the noise on the samples held out, N.
    pub rms_n: f64,
    /// Where the rest sits.
    pub places: Vec<Place>,
    /// When, s since the first sample.
    pub intervals_s: Vec<[f64; 2]>,
    /// Signals of other cables that it goes with, the closest first.
    pub neighbours: Vec<Neighbour>,
}

/// One cable.
#[derive(Clone, Debug)]
pub struct CableDiscovery {
    /// Samples by what was done with them.
    pub samples: SampleCounts,
    /// Standard deviation of the reference over the samples held out, N.
    pub reference_variation_n: f64,
    /// Those held out, in the order of time: cycles `from..to`.
    pub held_out: Vec<[usize; 2]>,
    /// Standard deviation of the white noise of sensor and reference together, N.
    pub noise_floor_n: f64,
    /// Standard deviation of noise that wanders slowly and has nothing to do with the motion, N.
    pub wander_n: f64,
    /// Whether something is missing.
    pub verdict: Verdict,
    /// The given model, fitted.
    pub before: Model,
    /// The extended model; the given one where nothing was found.
    pub after: Model,
    /// What was found, in the order in which it entered.
    pub findings: Vec<Finding>,
    /// Every candidate by itself beside the given model, the best first.
    pub candidates: Vec<Candidate>,
    /// Candidates that help the extended model and do not suffice, the best first.
    pub tried: Vec<Tried>,
    /// Where the given model disagrees.
    pub places: Vec<Place>,
    /// What is wrong with the log itself, corrected before model and log were compared.
    pub faults: Vec<RecordingFault>,
    /// What no effect accounts for.
    pub unexplained: Option<Unexplained>,
    /// Why nothing can be told.
    pub lack: Option<Lack>,
    /// The residuals over the condition that tells most, of the given model and of what is left.
    pub profiles: Vec<Profile>,
    /// Friction over speed and length, measured and by both models.
    pub curves: FrictionCurves,
    /// When each cycle is, s since the first sample; several logs one after the other.
    pub times_s: Vec<f64>,
    /// Residual of the given model in each cycle, N; NaN where a sample does not count.
    pub residual_before_n: Vec<f64>,
    /// And of the extended one.
    pub residual_after_n: Vec<f64>,
}

impl Model {
    /// Standard error of a parameter, in its unit; `None` where it was not fitted.
    #[must_use]
    pub fn standard_error(&self, parameter: &Parameter) -> Option<f64> {
        let place = self.fitted.iter().position(|fitted| fitted == parameter)?;
        Some(self.covariance.get((place, place))?.sqrt())
    }
}

impl CableDiscovery {
    /// A cable of which nothing can be told.
    pub(crate) fn untold(record: &CableRecord<'_>, samples: SampleCounts, lack: Lack) -> Self {
        let model = Model {
            values: record.params.values(),
            fitted: Vec::new(),
            covariance: DMatrix::zeros(0, 0),
            held_out_n: Deviation::default(),
        };
        Self {
            samples,
            reference_variation_n: f64::NAN,
            held_out: Vec::new(),
            noise_floor_n: f64::NAN,
            wander_n: f64::NAN,
            verdict: Verdict::Untold,
            before: model.clone(),
            after: model,
            findings: Vec::new(),
            candidates: Vec::new(),
            tried: Vec::new(),
            places: Vec::new(),
            faults: Vec::new(),
            unexplained: None,
            lack: Some(lack),
            profiles: Vec::new(),
            curves: FrictionCurves::default(),
            times_s: Vec::new(),
            residual_before_n: Vec::new(),
            residual_after_n: Vec::new(),
        }
    }
}
