//! The findings on one cable.

use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, VISCOUS, Values};
use serde::{Serialize, Serializer};

use super::effect::{Candidate, EffectResult, TriedResult, effect_result, errors};
use super::finite;
use super::machine::{Machine, Robot, is_absent};
use super::place::{UnexplainedResult, WhereResult, unexplained};
use super::revised::{RevisedResult, revised};
use crate::discover::extended::contradicted;
use crate::discover::report::{CableDiscovery, Model, Verdict};
use crate::discover::rest::empirical;
use crate::errors::ForceError;
use crate::fit::Parameter;
use crate::fit::result::{LeftOut, LogValues};
use crate::numbers::Numbers;
use crate::recording_fault::FaultResult;
use crate::search::vector::Coordinate;

/// One cable, or the tendon of a manipulator.
#[derive(Clone, Debug, Serialize)]
#[serde(bound = "")]
pub struct DiscoverCableResult<M: Machine = Robot> {
    /// Its name.
    pub name: String,
    /// Number of samples that count.
    pub samples: usize,
    /// Samples that do not count.
    #[serde(skip_serializing_if = "is_absent")]
    pub left_out: M::OfRobots<LeftOut>,
    /// The held-out samples, `from..to`, counted over all rows of all logs.
    #[serde(skip_serializing_if = "is_absent")]
    pub held_out_samples: M::OfRobots<Vec<[usize; 2]>>,
    /// Time intervals of the held-out samples, s since the first sample.
    #[serde(skip_serializing_if = "is_absent")]
    pub held_out_s: M::OfRobots<Vec<[f64; 2]>>,
    /// Standard deviation of the white noise, N.
    pub noise_floor_n: Option<f64>,
    /// Standard deviation of slow sensor noise, N.
    #[serde(skip_serializing_if = "is_absent")]
    pub wander_n: M::OfRobots<Option<f64>>,
    /// Standard deviation of the reference over the held-out samples, N: the error of a model that predicts a constant.
    #[serde(skip_serializing_if = "is_absent")]
    pub reference_variation_n: M::OfRobots<Option<f64>>,
    /// Root mean square error of the reference for one standard error of its calibration, N; absent without a calibration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration_error_n: Option<f64>,
    /// Error of the given model, fitted; absent without a reference force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<ForceError>,
    /// Error of the extended model; absent without a reference force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<ForceError>,
    /// Fraction of the gap that the extended model closes.
    pub gap_closed: Option<f64>,
    /// The verdict.
    pub verdict: Verdict,
    /// What the log lacks for a verdict.
    #[serde(skip_serializing_if = "is_absent")]
    pub missing: M::OfRobots<Option<Missing>>,
    /// Conditions in which the given model disagrees with the log, the most informative first.
    #[serde(rename = "where")]
    pub places: Vec<WhereResult<M>>,
    /// Distances from markers; absent if there are too few to estimate their noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub markers: Option<M::Markers>,
    /// The effects found, in the order in which they entered.
    pub effects: Vec<EffectResult<M>>,
    /// Every candidate alone beside the given model, the best first.
    #[serde(skip_serializing_if = "is_absent")]
    pub candidates: M::OfRobots<Vec<Candidate>>,
    /// Candidates that help the extended model but do not suffice, the best first.
    pub tried: Vec<TriedResult>,
    /// The reason why the file keeps a value that the log contradicts; absent if it keeps none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kept: Option<String>,
    /// Values of the extended model, keyed as in the robot file's `friction` and as `effect.key`.
    #[serde(skip_serializing_if = "is_absent")]
    pub parameters: M::OfRobots<Numbers>,
    /// Standard errors of the fitted values.
    #[serde(skip_serializing_if = "is_absent")]
    pub standard_errors: M::OfRobots<Numbers>,
    /// Friction parameters at the greatest value of their range, which the log would have beyond it; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub at_bound: Vec<String>,
    /// Parameters whose given value the log contradicts without determining a better one: `parameters` has one of many that agree with the log. Absent
    /// if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub undetermined: Vec<String>,
    /// Parameters of the robot file's effects that the log has otherwise, by more than their intervals; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub revised: Vec<RevisedResult>,
    /// What each log has of its own, in the order of the logs; absent if they share all parameters. `parameters` has the value of the last log.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub per_log: Vec<LogValues>,
    /// Recording faults, which concern the log and not the machine.
    #[serde(skip_serializing_if = "is_absent")]
    pub faults: M::OfRobots<Vec<FaultResult>>,
    /// The rest that no effect explains.
    pub unexplained: Option<UnexplainedResult<M>>,
}

/// The reason why there is no verdict.
#[derive(Clone, Debug, Serialize)]
pub struct Missing {
    /// One sentence without its full stop.
    pub cause: String,
    /// What to do, one sentence.
    pub advice: &'static str,
}

impl Verdict {
    /// Returns the name used in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Extended => "extended",
            Self::Unexplained => "unexplained",
            Self::Untold => "untold",
        }
    }
}

/// Without a verdict, `null`.
impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (*self != Self::Untold).then(|| self.name()).serialize(serializer)
    }
}

pub fn cable_result(
    place: usize,
    names: &[&str],
    found: &CableDiscovery,
    lack: Option<(String, &'static str)>,
    logs: &[String],
    given: &Values,
) -> DiscoverCableResult {
    let samples = found.samples;
    let (before, after) = (ForceError::of(&found.before.held_out_n), ForceError::of(&found.after.held_out_n));
    let contradicted = contradicted(found, given);
    let share = |rms_n: f64| gap_closed(found, rms_n);
    let told = found.lack.as_ref().map(|lack| (lack.cause.clone(), lack.advice));
    let missing = told.map(|told| lack.unwrap_or(told)).map(|(cause, advice)| Missing { cause, advice });
    let time_s = |sample: usize| found.times_s.get(sample).or(found.times_s.last()).copied().unwrap_or(0.0);
    let gap = excess(&found.before, found.noise_floor_n);
    let mut places: Vec<WhereResult> = found.places.iter().map(WhereResult::of).collect();
    places.extend(found.faults.iter().filter_map(|fault| WhereResult::of_hum(fault, gap)));
    DiscoverCableResult {
        name: names.get(place).copied().unwrap_or_default().to_owned(),
        samples: samples.used,
        left_out: LeftOut {
            flagged: samples.flagged,
            without_reference: samples.without_reference + samples.interpolated,
            warm_up: samples.warm_up,
            outliers: samples.outliers,
        },
        held_out_samples: found.held_out.clone(),
        held_out_s: found.held_out.iter().map(|range| range.map(time_s)).collect(),
        noise_floor_n: finite(found.noise_floor_n),
        wander_n: finite(found.wander_n),
        reference_variation_n: finite(found.reference_variation_n),
        before,
        after,
        calibration_error_n: None,
        gap_closed: after.and_then(|after| share(after.rms_n)),
        verdict: found.verdict,
        missing,
        places,
        markers: None,
        effects: found.findings.iter().map(|finding| effect_result(found, finding)).collect(),
        candidates: found.candidates.iter().map(Candidate::of).collect(),
        tried: found.tried.iter().map(TriedResult::of).collect(),
        kept: None,
        parameters: parameters(found, &contradicted),
        standard_errors: errors(found, Parameter::all(), ToString::to_string),
        at_bound: at_bound(&found.after),
        undetermined: contradicted.iter().map(ToString::to_string).collect(),
        revised: revised(found, given),
        per_log: LogValues::of_logs(&found.per_log, logs),
        faults: found.faults.iter().map(FaultResult::of).collect(),
        unexplained: found.unexplained.as_ref().map(|rest| unexplained(rest, names)),
    }
}

/// Returns the fraction of the gap closed if this error is left; `None` if there is no gap.
pub fn gap_closed(found: &CableDiscovery, rms_n: f64) -> Option<f64> {
    let gap_n = found.before.held_out_n.rms()? - found.noise_floor_n;
    (found.verdict != Verdict::Complete && gap_n > 0.0)
        .then(|| 1.0 - (rms_n - found.noise_floor_n) / gap_n)
        .and_then(finite)
}

/// Returns the mean square above the noise, N².
fn excess(model: &Model, noise_n: f64) -> f64 {
    model.held_out_n.rms().map_or(f64::NAN, |rms_n| rms_n * rms_n - noise_n * noise_n)
}

/// Returns the friction parameters at the greatest value of their range. At the least, nothing rubs.
fn at_bound(model: &Model) -> Vec<String> {
    let rubs = |parameter: &&Parameter| [MU, VISCOUS].contains(&parameter.place());
    let is_at_bound = |parameter: &&Parameter| {
        // The range of friction does not depend on the cycle time.
        let coordinate = Coordinate::of(parameter, 1.0);
        coordinate.bound_at(model.values[parameter.place()], 0.0) == Some(coordinate.range().1)
    };
    model.fitted.iter().filter(rubs).filter(is_at_bound).map(ToString::to_string).collect()
}

/// Returns the values of the extended model: friction, fitted parameters, those that the log has otherwise than the file, and all parameters of each effect
/// found.
fn parameters(found: &CableDiscovery, contradicted: &[Parameter]) -> Numbers {
    let model = &found.after;
    let of_finding = |parameter: &Parameter| {
        found.findings.iter().any(|finding| finding.effect.places().contains(&parameter.place()))
    };
    let shown = |parameter: Parameter| {
        let value = model.values[parameter.place()];
        let of_finding = of_finding(&parameter) && !empirical::is_idle(&parameter, &model.values);
        let is_per_log = found.per_log.iter().flatten().any(|log| log.parameter == parameter);
        let is_changed = model.fitted.contains(&parameter) || contradicted.contains(&parameter);
        let relevant = parameter.is_friction() || is_per_log || is_changed || of_finding;
        (relevant && value < NO_PRESLIDING_N_PER_M).then(|| (parameter.to_string(), value))
    };
    Numbers(Parameter::all().filter_map(shown).collect())
}
