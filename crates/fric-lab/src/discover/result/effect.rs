//! Effects: those found, those that do not suffice, and every candidate by itself.

use fric_core::effects::Effect;
use serde::Serialize;

use super::cable::gap_closed;
use super::finite;
use super::machine::{Machine, Robot, is_absent};
use super::table::TableResult;
use crate::discover::naming::Refusal;
use crate::discover::report::{self, CableDiscovery, Finding, Tried};
use crate::discover::rest::empirical;
use crate::fit::Parameter;
use crate::numbers::Numbers;

/// An effect that was found.
#[derive(Clone, Debug, Serialize)]
#[serde(bound = "")]
pub struct EffectResult<M: Machine = Robot> {
    /// Its name in the catalogue.
    pub kind: &'static str,
    /// Its parameters by key, including settings.
    pub parameters: Numbers,
    /// Standard errors of the fitted parameters.
    pub standard_errors: Numbers,
    /// Fraction of the gap closed by this effect and all before it.
    pub gap_closed: Option<f64>,
    /// Evidence for the effect.
    pub evidence: Evidence,
    /// The best other effect in its place.
    pub runner_up: Option<RunnerUpResult<M>>,
    /// Content of an `empirical` table, which is no name.
    #[serde(skip_serializing_if = "is_absent")]
    pub table: M::OfRobots<Option<TableResult>>,
    /// Effects that the log does not distinguish from it: any of them may be present instead. A robot names one of them as the best other effect.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub alike: Vec<&'static str>,
    /// The catalogue entry.
    #[serde(skip)]
    pub effect: M::Entry,
}

/// Evidence for an effect.
#[derive(Clone, Debug, Serialize)]
pub struct Evidence {
    /// BIC with the effect minus BIC without it.
    pub delta_bic: Option<f64>,
    /// Error with this effect and all before it, N.
    pub held_out_rms_n: Option<f64>,
}

/// Another effect that may be present instead.
#[derive(Clone, Debug, Serialize)]
#[serde(bound = "")]
pub struct RunnerUpResult<M: Machine = Robot> {
    /// Its name in the catalogue.
    pub kind: &'static str,
    /// BIC with the effect minus BIC without it.
    pub delta_bic: Option<f64>,
    /// Error with this effect in the other's place, N.
    #[serde(skip_serializing_if = "is_absent")]
    pub held_out_rms_n: M::OfRobots<Option<f64>>,
    /// Whether the log cannot distinguish the two.
    #[serde(skip_serializing_if = "is_absent")]
    pub as_good: M::OfRobots<bool>,
    /// The catalogue entry.
    #[serde(skip)]
    pub effect: M::Entry,
}

/// An effect that helps the extended model but does not suffice.
#[derive(Clone, Debug, Serialize)]
pub struct TriedResult {
    /// Its name in the catalogue.
    pub kind: &'static str,
    /// The grating or hole that it concerns; absent for effects of a whole cable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameters: Option<Numbers>,
    /// Evidence for the effect beside the extended model.
    pub evidence: Evidence,
    /// The reason why it is not named, as a clause.
    pub reason: String,
    /// The same reason for an effect of a cable; `None` for a tendon's.
    #[serde(skip)]
    pub refusal: Option<Refusal>,
    /// Whether nearly all that is left goes with it.
    #[serde(skip)]
    pub takes_rest: bool,
}

/// A single effect beside the given model.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// Its name in the catalogue.
    pub kind: &'static str,
    /// BIC with the effect minus BIC without it.
    pub delta_bic: Option<f64>,
    /// Error with the effect, N.
    pub held_out_rms_n: Option<f64>,
}

/// Returns the standard errors of the fitted ones among some parameters, by name.
pub fn errors(
    found: &CableDiscovery,
    of: impl Iterator<Item = Parameter>,
    name: impl Fn(&Parameter) -> String,
) -> Numbers {
    Numbers(of.filter_map(|parameter| Some((name(&parameter), finite(found.standard_error(&parameter)?)?))).collect())
}

pub fn effect_result(found: &CableDiscovery, finding: &Finding) -> EffectResult {
    let key = |parameter: &Parameter| parameter.row().key.to_owned();
    let values = &found.after.values;
    let held_out_rms_n = finding.held_out_n.rms();
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = finding.held_out_n.count() as f64;
    EffectResult {
        kind: finding.effect.kind(),
        parameters: Numbers(
            Parameter::of(finding.effect)
                .filter(|parameter| !empirical::is_idle(parameter, values))
                .map(|parameter| (key(&parameter), values[parameter.place()]))
                .collect(),
        ),
        standard_errors: errors(found, Parameter::of(finding.effect), key),
        gap_closed: held_out_rms_n.and_then(|rms_n| gap_closed(found, rms_n)),
        evidence: Evidence { delta_bic: finite(finding.delta_bic), held_out_rms_n },
        runner_up: finding.runner_up.as_ref().map(|other| RunnerUpResult {
            kind: other.effect.kind(),
            delta_bic: finite(other.delta_bic),
            held_out_rms_n: finite((other.held_out_squares / count).sqrt()),
            as_good: other.is_as_good,
            effect: other.effect,
        }),
        table: (finding.effect == Effect::Empirical).then(|| TableResult::of(&found.after)).flatten(),
        alike: Vec::new(),
        effect: finding.effect,
    }
}

impl Candidate {
    pub(super) fn of(candidate: &report::Candidate) -> Self {
        let report::Candidate { effect, delta_bic, held_out_rms_n } = candidate;
        Self { kind: effect.kind(), delta_bic: finite(*delta_bic), held_out_rms_n: finite(*held_out_rms_n) }
    }
}

impl TriedResult {
    pub(super) fn of(tried: &Tried) -> Self {
        let Tried { effect, delta_bic, held_out_rms_n, refusal, takes_rest } = tried;
        let evidence = Evidence { delta_bic: finite(*delta_bic), held_out_rms_n: finite(*held_out_rms_n) };
        let (reason, refusal) = (refusal.in_words(), Some(*refusal));
        Self { kind: effect.kind(), parameters: None, evidence, reason, refusal, takes_rest: *takes_rest }
    }
}
