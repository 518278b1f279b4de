//! Types that hold the result of a discovery for one cable.

use std::sync::Arc;

use fric_core::effects::Effect;
use fric_core::parameters::Values;
use nalgebra::DMatrix;

use super::figures::curve::FrictionCurves;
use super::figures::profile::Profile;
use super::lack::Lack;
use super::naming::Refusal;
use super::rest::neighbours::Neighbour;
use super::rest::places::Place;
use crate::fit::{CableRecord, LogValue, Parameter, SampleCounts};
use crate::recording_fault::RecordingFault;
use crate::replay::Deviation;
use crate::set_up::SetUp;

/// The verdict on a cable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing is missing: the rest is noise.
    Complete,
    /// Named effects are missing: the rest with them is noise.
    Extended,
    /// Something is missing that no effect of the catalogue explains.
    Unexplained,
    /// The log does not allow a verdict.
    Untold,
}

/// A model with its errors on the held-out samples.
#[derive(Clone, Debug)]
pub struct Model {
    /// All its parameters.
    pub values: Values,
    /// The fitted parameters, in the order of the covariance.
    pub fitted: Vec<Parameter>,
    /// Covariance of the fitted parameters.
    pub covariance: DMatrix<f64>,
    /// Force at the platform minus the reference on the held-out samples.
    pub held_out_n: Deviation,
}

/// An effect that was found.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The effect in the catalogue.
    pub effect: Effect,
    /// Error with this effect and all found before it, on the held-out samples.
    pub held_out_n: Deviation,
    /// BIC with the effect minus BIC without it; negative favours the effect.
    pub delta_bic: f64,
    /// The best other effect in its place, by BIC against no effect there, or a lag of the sensor that is as good in spite of its BIC.
    pub runner_up: Option<RunnerUp>,
}

/// Another effect that may be present instead.
#[derive(Clone, Debug)]
pub struct RunnerUp {
    /// The effect in the catalogue.
    pub effect: Effect,
    /// BIC with the effect minus BIC without it.
    pub delta_bic: f64,
    /// Held-out sum of squares with the effect, N².
    pub held_out_squares: f64,
    /// Whether the log cannot distinguish it from the effect that was found.
    pub is_as_good: bool,
}

/// A single effect beside the given model.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The effect in the catalogue.
    pub effect: Effect,
    /// BIC with the effect minus BIC without it. For an effect that cannot enter it is an upper bound, because its search ended early.
    pub delta_bic: f64,
    /// Root mean square error with the effect on the held-out samples, N.
    pub held_out_rms_n: f64,
}

/// An effect that helps the extended model but does not suffice.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The effect in the catalogue.
    pub effect: Effect,
    /// BIC with the effect minus BIC without it, corrected for the memory of the residual.
    pub delta_bic: f64,
    /// Root mean square error with the effect on the held-out samples, N.
    pub held_out_rms_n: f64,
    /// The reason why it is not named.
    pub refusal: Refusal,
    /// Whether nearly all that is left goes with it.
    pub takes_rest: bool,
}

/// A rest that no effect explains.
#[derive(Clone, Debug, Default)]
pub struct Unexplained {
    /// Root mean square of the rest above the noise on the held-out samples, N.
    pub rms_n: f64,
    /// Conditions in which the rest is concentrated.
    pub places: Vec<Place>,
    /// Time intervals of the rest, s since the first sample.
    pub intervals_s: Vec<[f64; 2]>,
    /// Signals of other cables that correlate with the rest, the closest first.
    pub neighbours: Vec<Neighbour>,
}

/// The result for one cable.
#[derive(Clone, Debug)]
pub struct CableDiscovery {
    /// Sample counts by use.
    pub samples: SampleCounts,
    /// Standard deviation of the reference over the held-out samples, N.
    pub reference_variation_n: f64,
    /// The held-out samples, in the order of time: cycles `from..to`.
    pub held_out: Vec<[usize; 2]>,
    /// Standard deviation of the white noise of sensor and reference together, N.
    pub noise_floor_n: f64,
    /// Standard deviation of slow noise that is unrelated to the motion, N.
    pub wander_n: f64,
    /// The verdict.
    pub verdict: Verdict,
    /// The given model, fitted.
    pub before: Model,
    /// The extended model; equal to the given one if nothing was found.
    pub after: Model,
    /// The value of each log of its own in the extended model, in the order of the logs; `None` for a log without a sample that counts, and nothing if
    /// all logs share all parameters. `after` holds the value of the last log.
    pub per_log: Vec<Option<LogValue>>,
    /// The effects found, in the order in which they entered.
    pub findings: Vec<Finding>,
    /// Every candidate alone beside the given model, the best first.
    pub candidates: Vec<Candidate>,
    /// Candidates that help the extended model but do not suffice, the best first.
    pub tried: Vec<Tried>,
    /// Conditions in which the given model disagrees with the log.
    pub places: Vec<Place>,
    /// Faults of the log itself, corrected before model and log were compared.
    pub faults: Vec<RecordingFault>,
    /// The rest that no effect explains.
    pub unexplained: Option<Unexplained>,
    /// The reason if there is no verdict.
    pub lack: Option<Lack>,
    /// The residuals of the given model and of the extended one over the most informative condition.
    pub profiles: Vec<Profile>,
    /// Friction over speed and length, measured and by both models.
    pub curves: FrictionCurves,
    /// Time of each cycle, s since the first sample; several logs follow one another.
    pub times_s: Arc<Vec<f64>>,
    /// Residual of the given model in each cycle, N; NaN where a sample does not count.
    pub residual_before_n: Vec<f64>,
    /// Residual of the extended model in each cycle, N; NaN where a sample does not count.
    pub residual_after_n: Vec<f64>,
    /// The forces by the sensor and by the given model beside the reference.
    pub(crate) set_up: SetUp,
}

impl Model {
    /// Returns the standard error of a parameter, in its unit; `None` if it was not fitted.
    #[must_use]
    pub fn standard_error(&self, parameter: &Parameter) -> Option<f64> {
        let place = self.fitted.iter().position(|fitted| fitted == parameter)?;
        Some(self.covariance.get((place, place))?.sqrt())
    }
}

impl CableDiscovery {
    /// Returns the standard error of a parameter of the extended model, in its unit; `None` if it was not fitted.
    #[must_use]
    pub fn standard_error(&self, parameter: &Parameter) -> Option<f64> {
        let last = LogValue::last(&self.per_log).filter(|last| last.parameter == *parameter);
        last.map(|last| last.standard_error).or_else(|| self.after.standard_error(parameter))
    }

    /// Takes over that the zeros of the logs were changed in the data by so much before, N.
    pub(crate) fn add_to_zeros(&mut self, changed_n: &[f64]) {
        for (log, changed_n) in self.per_log.iter_mut().zip(changed_n) {
            if let Some(log) = log {
                log.value += changed_n;
            }
        }
        if let Some(last) = LogValue::last(&self.per_log) {
            self.after.values[last.parameter.place()] = last.value;
        }
    }

    /// Returns the result of a cable without a verdict.
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
            per_log: Vec::new(),
            findings: Vec::new(),
            candidates: Vec::new(),
            tried: Vec::new(),
            places: Vec::new(),
            faults: Vec::new(),
            unexplained: None,
            lack: Some(lack),
            profiles: Vec::new(),
            curves: FrictionCurves::default(),
            times_s: Arc::default(),
            residual_before_n: Vec::new(),
            residual_after_n: Vec::new(),
            set_up: SetUp::default(),
        }
    }
}
