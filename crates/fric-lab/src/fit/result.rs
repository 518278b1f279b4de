//! The machine-readable result of an identification, `format = "fric-fit/1"`, with additional data for reports.

use std::collections::BTreeSet;

use fric_core::parameters::NO_PRESLIDING_N_PER_M;
use fric_core::robot::file::RobotFile;
use serde::{Serialize, Serializer};

use super::error::FitError;
use super::readiness::Readiness;
use super::report::{CableFit, LogValue, WrenchFit};
use super::summary;
use crate::errors::{ForceError, WrenchError, WrenchResult};
use crate::numbers::Numbers;
use crate::recording_fault::{FaultResult, RecordingFault};
use crate::replay::WrenchReference;
use crate::search::optimizer::Termination;
use crate::search::solve::{CONTRADICTION_RATIO, OpenCombination, OpenPart};
use crate::search::vector::Parameter;
use crate::set_up;
use crate::text::listed;
use crate::weight::NEVER_QUIET;

/// The fits, by the kind of reference.
#[derive(Clone, Debug)]
pub enum Fits {
    /// Each cable fitted to its force at the platform.
    Forces(Vec<CableFit>),
    /// All cables fitted to the external wrench.
    Wrench(WrenchFit),
}

impl Fits {
    /// Returns the fits of the cables, in the robot's order.
    #[must_use]
    pub fn cables(&self) -> &[CableFit] {
        match self {
            Self::Forces(cables) => cables,
            Self::Wrench(fit) => &fit.cables,
        }
    }
}

/// The reference of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitReference {
    /// Forces at the platform.
    Forces,
    /// The wrench.
    Wrench(WrenchReference),
}

impl FitReference {
    /// Returns the name used in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Forces => "forces",
            Self::Wrench(reference) => reference.name(),
        }
    }

    /// Returns a description.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::Forces => "the cable forces at the platform",
            Self::Wrench(WrenchReference::Measured) => "the wrench on the platform",
            Self::Wrench(WrenchReference::Mass) => "the wrench of the platform's mass and pose",
        }
    }
}

impl Serialize for FitReference {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// The result of an identification.
#[derive(Clone, Debug, Serialize)]
pub struct FitResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// Name of the robot.
    pub robot: String,
    /// The reference.
    pub reference: FitReference,
    /// The cables in the robot's order.
    pub cables: Vec<FitCableResult>,
    /// Errors of the wrench, if it is the reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrench: Option<WrenchResult>,
}

/// One cable.
#[derive(Clone, Debug, Serialize)]
pub struct FitCableResult {
    /// Its name.
    pub name: String,
    /// Number of training samples.
    pub samples: usize,
    /// Samples that were left out.
    pub left_out: LeftOut,
    /// The reason why the search ended.
    pub termination: &'static str,
    /// Number of model evaluations with derivatives.
    pub evaluations: usize,
    /// Values, fitted or kept.
    pub parameters: Numbers,
    /// Standard errors of the fitted values.
    pub standard_errors: Numbers,
    /// Parameters that the samples do not determine; they keep the given value.
    pub undetermined: Vec<String>,
    /// Parameters whose given value the samples contradict without determining another; they have the best value found, and no standard error.
    #[serde(skip)]
    pub contradicted: Vec<String>,
    /// What each log has of its own, in the order of the logs; absent if they share all parameters. `parameters` has the value of the last log.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub per_log: Vec<LogValues>,
    /// Combinations that the samples leave open: a kept parameter of this cable, with the parameters that change with it.
    pub open: Vec<OpenResult>,
    /// Parameters at a bound that the samples would move beyond it.
    pub at_bound: Vec<String>,
    /// Error without friction compensation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<ForceError>,
    /// Error with these values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<ForceError>,
    /// Whether sensor and reference change alike, so that a level between them is a zero and no scale.
    #[serde(skip)]
    pub is_scale_told: bool,
    /// Mean of the reference, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_reference_n: Option<f64>,
    /// Faults of the recording that were corrected before the fit.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<FaultResult>,
}

/// What a log has of its own. Without a sample that counts it has no values.
#[derive(Clone, Debug, Serialize)]
pub struct LogValues {
    /// Its name.
    pub log: String,
    /// Values by parameter.
    pub parameters: Numbers,
    /// Their standard errors.
    pub standard_errors: Numbers,
}

impl LogValues {
    /// What the values mean, one sentence without its full stop.
    pub const EXPLANATION: &str = "each log has its own value, and the robot file that of the last one";

    /// Returns the results of all logs.
    pub(crate) fn of_logs(logs: &[Option<LogValue>], names: &[String]) -> Vec<Self> {
        let of_log = |(place, value): (usize, &Option<LogValue>)| {
            let numbers = |number: fn(&LogValue) -> f64| {
                let of = value.iter().map(|value| (value.parameter.to_string(), number(value)));
                Numbers(of.filter(|(_, number)| number.is_finite()).collect())
            };
            Self {
                log: names.get(place).cloned().unwrap_or_else(|| format!("log {}", place + 1)),
                parameters: numbers(|value| value.value),
                standard_errors: numbers(|value| value.standard_error),
            }
        };
        logs.iter().enumerate().map(of_log).collect()
    }
}

/// A combination of parameters that the samples leave open: changing them together by these steps has no effect.
#[derive(Clone, Debug, Serialize)]
#[serde(transparent)]
pub struct OpenResult(pub Vec<OpenPartResult>);

impl OpenResult {
    /// Whether a parameter is the one that is kept.
    pub(crate) fn is_held(&self, name: &str) -> bool {
        self.0.first().is_some_and(|held| held.parameter == name)
    }
}

/// A parameter of such a combination.
#[derive(Clone, Debug, Serialize)]
pub struct OpenPartResult {
    /// Name of its cable.
    pub cable: String,
    /// Its name.
    pub parameter: String,
    /// Its part of a step of 1.96 standard errors, in its unit; of a zero that motion one way leaves open, of a step as large as takes all friction for a zero; of a zero that one load leaves open beside a gain, of a step that takes all of the gain for a zero.
    pub step: f64,
}

/// Counts of the samples that were left out.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LeftOut {
    /// Faulty samples, or samples without tension on the cable.
    pub flagged: usize,
    /// Samples without a reference.
    pub without_reference: usize,
    /// Samples at the start of a log.
    pub warm_up: usize,
    /// Outliers.
    pub outliers: usize,
}

impl FitResult {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-fit/1";

    /// Creates the result of a robot's fits to logs with these names.
    #[must_use]
    pub fn new(robot: &RobotFile, logs: &[String], fits: &Fits) -> Self {
        let names = robot.cable_names();
        let cables = names.iter().zip(fits.cables());
        let (reference, wrench) = match fits {
            Fits::Forces(_) => (FitReference::Forces, None),
            Fits::Wrench(WrenchFit { reference, before, after, held_out, .. }) => {
                let wrench = WrenchResult::of(*reference, before, after);
                let held_out = WrenchError::of(held_out);
                (FitReference::Wrench(*reference), wrench.map(|wrench| WrenchResult { held_out, ..wrench }))
            }
        };
        Self {
            format: Self::FORMAT,
            robot: robot.options().name.clone(),
            reference,
            cables: cables.map(|(name, fit)| cable_result(name, fit, &names, logs)).collect(),
            wrench,
        }
    }

    /// Adds the recording faults of each cable.
    #[must_use]
    pub fn with_faults(mut self, faults: &[Vec<RecordingFault>]) -> Self {
        for (cable, faults) in self.cables.iter_mut().zip(faults) {
            cable.faults = faults.iter().map(FaultResult::of).collect();
        }
        self
    }

    /// Returns a summary for people: \[P\] table I, the uncertainties, and what the log does not determine.
    #[must_use]
    pub fn summary(&self) -> String {
        summary::describe(self)
    }

    /// Returns header and rows of a table of the samples that were used and left out, the evaluations and how the search ended; one row if it is the same
    /// for all cables.
    #[must_use]
    pub fn samples(&self) -> (Vec<&'static str>, Vec<Vec<String>>) {
        summary::samples(self)
    }

    /// Checks that samples were used, and that they determine at least one parameter. A file with the values that are kept, or that ran to their bounds, would
    /// be no result.
    ///
    /// # Errors
    /// Returns a [`FitError`] with the likely cause if not.
    pub fn check_fitted(&self) -> Result<(), FitError> {
        if let Some(first) = self.cables.first().filter(|_| self.cables.iter().all(|cable| cable.samples == 0)) {
            let (cause, advice) = why_unused(&first.left_out, self.reference);
            return Err(FitError::new(format!("no sample can be used: {cause}"), advice));
        }
        let of_logs = |cable: &FitCableResult| cable.per_log.iter().any(|log| !log.standard_errors.0.is_empty());
        // A value at the bound where it does nothing is a finding, a cable without friction, unless it agrees with the samples less than no model.
        let is_none = |cable: &FitCableResult, key: &String| {
            let value = cable.parameters.get(key);
            let squares = |error: Option<ForceError>| error.map_or(0.0, |error| error.rms_n.powi(2));
            let is_worse = squares(cable.after) > (1.0 + CONTRADICTION_RATIO) * squares(cable.before);
            !is_worse && Parameter::named(key).is_some_and(|of| value == Some(of.row().neutral))
        };
        let is_fitted = |cable: &FitCableResult| {
            let determined = !cable.standard_errors.0.is_empty() || of_logs(cable);
            determined || cable.at_bound.iter().any(|key| is_none(cable, key))
        };
        if self.cables.iter().any(is_fitted) {
            return Ok(());
        }
        let at_bound: BTreeSet<&str> =
            self.cables.iter().flat_map(|cable| &cable.at_bound).map(String::as_str).collect();
        let at_bound: Vec<&str> = at_bound.into_iter().collect();
        let ran = if at_bound.is_empty() {
            String::new()
        } else {
            format!("; {} ran to the end of its range", listed(&at_bound))
        };
        Err(FitError::new(
            format!("the log determines none of the parameters that are fitted{ran}"),
            "Record the run of `fric-cli excite`, or see what else the model lacks: `fric-cli discover` with the same log and model.",
        ))
    }

    /// Returns warnings that people need beside the summary, or beside the error of [`Self::check_fitted`].
    #[must_use]
    pub fn warnings(&self, fits: &Fits, readiness: &Readiness) -> Vec<String> {
        // Cables with the same problem share a line.
        let mut unused: Vec<(&str, Vec<&str>)> = Vec::new();
        let is_told = self.cables.iter().all(|cable| cable.samples == 0);
        let told = |place: &usize| is_told || readiness.is_lacking(*place);
        for (_, cable) in self.cables.iter().enumerate().filter(|(place, cable)| cable.samples == 0 && !told(place)) {
            let (cause, _) = why_unused(&cable.left_out, self.reference);
            match unused.iter_mut().find(|(of, _)| *of == cause) {
                Some((_, names)) => names.push(&cable.name),
                None => unused.push((cause, vec![&cable.name])),
            }
        }
        let told_unused = |(cause, names): (&str, Vec<&str>)| {
            format!("{}: no sample can be used, values kept: {cause}", names.join(", "))
        };
        let mut warnings: Vec<String> = unused.into_iter().map(told_unused).collect();
        let set_ups = fits.cables().iter().map(|fit| fit.errors.set_up);
        warnings.extend(set_up::warnings(self.cables.iter().map(|cable| cable.name.as_str()).zip(set_ups)));
        for (cable, fit) in self.cables.iter().zip(fits.cables()) {
            // Cables that were not fitted are listed below the tables.
            if !matches!(fit.termination, Termination::Converged | Termination::NothingToFit) {
                warnings.push(format!(
                    "{}: the search ended without converging ({}); the values are the best found: look at the error \
                     that is left before you use them",
                    cable.name,
                    fit.termination.name()
                ));
            }
        }
        warnings
    }
}

/// Returns why there is no training sample, and what to do.
fn why_unused(left_out: &LeftOut, reference: FitReference) -> (&'static str, &'static str) {
    let LeftOut { flagged, without_reference, warm_up, outliers: _ } = *left_out;
    if warm_up >= flagged.max(without_reference) {
        let cause = "the cables move too little to forget the friction stored in them when the log began";
        return (cause, "Record longer strokes, best the run of `fric-cli excite`.");
    }
    if flagged >= without_reference {
        return ("each is flagged, or has no tension on the cable", "See the flags with `fric-cli replay`.");
    }
    match reference {
        FitReference::Forces => (
            "the reference is missing, or stands still, wherever the other signals are there",
            "See the signals with `fric-cli info`; a load that stays is `reference = { constant_n = … }` under `[log]`.",
        ),
        FitReference::Wrench(WrenchReference::Measured) => {
            ("the wrench is missing wherever all cables have their signals", "See the signals with `fric-cli info`.")
        }
        FitReference::Wrench(WrenchReference::Mass) => {
            (NEVER_QUIET, "Record slower motion, or poses with less noise, or the wrench on the platform.")
        }
    }
}

/// Returns the parts of a genuine combination, with the cables' names.
fn open_result(open: &OpenCombination, names: &[&str]) -> Option<OpenResult> {
    let parts = open.parts.iter().filter(|part| part.step.is_finite());
    let part = |part: &OpenPart| {
        let cable = (*names.get(part.cable)?).to_owned();
        Some(OpenPartResult { cable, parameter: part.parameter.to_string(), step: part.step })
    };
    let parts: Vec<OpenPartResult> = parts.filter_map(part).collect();
    (parts.len() > 1).then_some(OpenResult(parts))
}

fn cable_result(name: &str, fit: &CableFit, names: &[&str], logs: &[String]) -> FitCableResult {
    let shown = |parameter: &Parameter| {
        let value = fit.values[parameter.place()];
        let relevant = parameter.is_friction()
            || fit.per_log.iter().flatten().any(|log| log.parameter == *parameter)
            || [&fit.fitted, &fit.undetermined, &fit.at_bound].iter().any(|list| list.contains(parameter));
        (relevant && value < NO_PRESLIDING_N_PER_M).then(|| (parameter.to_string(), value))
    };
    let error = |parameter: &Parameter| Some((parameter.to_string(), fit.standard_error(parameter)?));
    let is_contradicted =
        |parameter: &&Parameter| fit.standard_error(parameter).is_none() && !fit.at_bound.contains(parameter);
    let samples = fit.samples;
    FitCableResult {
        name: name.to_owned(),
        samples: samples.used,
        left_out: LeftOut {
            flagged: samples.flagged,
            without_reference: samples.without_reference + samples.interpolated,
            warm_up: samples.warm_up,
            outliers: samples.outliers,
        },
        termination: fit.termination.name(),
        evaluations: fit.evaluation_count,
        parameters: Numbers(Parameter::all().filter_map(|parameter| shown(&parameter)).collect()),
        standard_errors: Numbers(Parameter::all().filter_map(|parameter| error(&parameter)).collect()),
        undetermined: fit.undetermined.iter().map(ToString::to_string).collect(),
        contradicted: fit.fitted.iter().filter(is_contradicted).map(ToString::to_string).collect(),
        per_log: LogValues::of_logs(&fit.per_log, logs),
        open: fit.open.iter().filter_map(|open| open_result(open, names)).collect(),
        at_bound: fit.at_bound.iter().map(ToString::to_string).collect(),
        before: ForceError::of(&fit.errors.before_n),
        after: ForceError::of(&fit.errors.after_n),
        is_scale_told: fit.errors.set_up.is_scale_told(),
        mean_reference_n: fit.errors.reference_n.mean_magnitude(),
        faults: Vec::new(),
    }
}
