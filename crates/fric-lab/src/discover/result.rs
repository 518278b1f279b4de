//! The machine-readable result of a discovery, `format = "fric-discover/1"`, with additional data for reports.
//!
//! `before`, `after` and all `held_out` figures refer to the same samples: those of `held_out_samples`. The closed fraction of the gap is `1 − (error
//! − floor)/(before − floor)` in root mean squares; the fraction of an effect includes the effect and all above it in the list. If nothing is missing
//! there is no gap, and the fraction is null.

use fric_core::effects::Effect;
use fric_core::effects::empirical::{Over, RATIO, SHARE_PLACES, SHARES, SIZE};
use fric_core::parameters::NO_PRESLIDING_N_PER_M;
use fric_core::robot::file::RobotFile;
use serde::Serialize;

use super::faults::{Fault, RecordingFault};
use super::report::{self, CableDiscovery, Finding, Model, Tried, Unexplained, Verdict};
use super::rest::empirical;
use super::rest::neighbours::Neighbour;
use super::rest::places::Place;
use super::summary;
use super::wrench::{GeometryFinding, WrenchDiscovery};
use crate::errors::{ForceError, WrenchError};
use crate::fit::readiness::Readiness;
use crate::fit::result::{LeftOut, Numbers};
use crate::fit::{FitError, Parameter};

/// The result of a discovery.
#[derive(Clone, Debug, Serialize)]
pub struct DiscoverResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// The logs, in order.
    pub log: Vec<String>,
    /// Start of each log, s. Several logs follow one another.
    pub log_start_s: Vec<f64>,
    /// Name of the robot.
    pub robot: String,
    /// The cables in the robot's order.
    pub cables: Vec<DiscoverCableResult>,
    /// Effects that several cables share.
    pub common_effects: Vec<CommonEffect>,
    /// Results for all cables together, if they were compared with the wrench.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrench: Option<WrenchGap>,
}

/// The wrench error before and after, and the findings about the whole robot.
#[derive(Clone, Debug, Serialize)]
pub struct WrenchGap {
    /// `wrench`, or `mass` if the reference is the wrench computed from the platform's mass and pose.
    pub reference: &'static str,
    /// Verdict for all cables together: `complete`, `extended` or `unexplained`.
    pub verdict: &'static str,
    /// Error of the given model, fitted, on held-out samples.
    pub before: Option<WrenchError>,
    /// Error of the extended model on held-out samples.
    pub after: Option<WrenchError>,
    /// White noise.
    pub noise_floor: WrenchError,
    /// The six components.
    pub components: Vec<WrenchComponent>,
    /// Effects that all cables share, with one value.
    pub alike: Vec<&'static str>,
    /// Entries of the robot file that are wrong.
    pub geometry: Vec<GeometryResult>,
    /// Findings for all cables together that help but do not suffice.
    pub tried: Vec<TriedTogether>,
}

/// One component of the wrench.
#[derive(Clone, Debug, Serialize)]
pub struct WrenchComponent {
    /// `fx_n` … `tz_nm`, the unit with it.
    pub name: &'static str,
    /// Standard deviation of the component's white noise.
    pub noise: f64,
    /// Root mean square error of the given model.
    pub before: f64,
    /// Root mean square error of the extended model.
    pub after: f64,
}

/// Entries of the robot file that are wrong.
#[derive(Clone, Debug, Serialize)]
pub struct GeometryResult {
    /// Key in the robot file.
    pub kind: &'static str,
    /// The cable, if the entry belongs to one.
    pub cable: Option<String>,
    /// The correct values.
    pub parameters: Numbers,
    /// Evidence for the correction.
    pub evidence: Evidence,
}

/// A finding for all cables together that helps but does not suffice.
#[derive(Clone, Debug, Serialize)]
pub struct TriedTogether {
    /// Name of the effect, or key of the robot file.
    pub kind: String,
    /// The reason why it is not named, as a clause.
    pub reason: String,
}

/// One cable.
#[derive(Clone, Debug, Serialize)]
pub struct DiscoverCableResult {
    /// Its name.
    pub name: String,
    /// Number of samples that count.
    pub samples: usize,
    /// Samples that do not count.
    pub left_out: LeftOut,
    /// The held-out samples, `from..to`, counted over all rows of all logs.
    pub held_out_samples: Vec<[usize; 2]>,
    /// Time intervals of the held-out samples, s since the first sample.
    pub held_out_s: Vec<[f64; 2]>,
    /// Standard deviation of the white noise, N.
    pub noise_floor_n: Option<f64>,
    /// Standard deviation of slow sensor noise, N.
    pub wander_n: Option<f64>,
    /// Standard deviation of the reference over the held-out samples, N: the error of a model that predicts a constant.
    pub reference_variation_n: Option<f64>,
    /// Error of the given model, fitted; absent without a reference force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<ForceError>,
    /// Error of the extended model; absent without a reference force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<ForceError>,
    /// Fraction of the gap that the extended model closes.
    pub gap_closed: Option<f64>,
    /// `complete`, `extended` or `unexplained`; `untold` if the log does not allow a verdict, which is `null` in JSON.
    #[serde(serialize_with = "verdict_or_null")]
    pub verdict: &'static str,
    /// What the log lacks for a verdict.
    pub missing: Option<Missing>,
    /// Conditions in which the given model disagrees with the log, the most informative first.
    #[serde(rename = "where")]
    pub places: Vec<WhereResult>,
    /// The effects found, in the order in which they entered.
    pub effects: Vec<EffectResult>,
    /// Every candidate alone beside the given model, the best first.
    pub candidates: Vec<Candidate>,
    /// Candidates that help the extended model but do not suffice, the best first.
    pub tried: Vec<TriedResult>,
    /// Values of the extended model, keyed as in the robot file's `friction` and as `effect.key`.
    pub parameters: Numbers,
    /// Standard errors of the fitted values.
    pub standard_errors: Numbers,
    /// Recording faults, which concern the log and not the machine.
    pub faults: Vec<FaultResult>,
    /// The rest that no effect explains.
    pub unexplained: Option<UnexplainedResult>,
}

/// The reason why there is no verdict.
#[derive(Clone, Debug, Serialize)]
pub struct Missing {
    /// One sentence without its full stop.
    pub cause: String,
    /// What to do, one sentence.
    pub advice: &'static str,
}

/// A range of a condition in which the disagreement is concentrated.
#[derive(Clone, Debug, Serialize)]
pub struct WhereResult {
    /// The condition.
    pub signal: &'static str,
    /// Lower end of the range, in `unit`.
    pub from: f64,
    /// Upper end of the range, in `unit`.
    pub to: f64,
    /// Its unit.
    pub unit: &'static str,
    /// Fraction of the excess above the noise in this range.
    pub share_of_excess: Option<f64>,
    /// Fraction of the samples in this range.
    pub share_of_samples: Option<f64>,
    /// Fraction of the excess above the noise that is a function of this condition and of the direction of motion.
    pub explains: Option<f64>,
    /// Number of standard errors above chance.
    pub significance: Option<f64>,
    /// Time intervals to look at, s since the first sample.
    pub intervals_s: Vec<[f64; 2]>,
    /// Least and greatest value of the condition.
    #[serde(skip)]
    pub range: [f64; 2],
}

/// An effect that was found.
#[derive(Clone, Debug, Serialize)]
pub struct EffectResult {
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
    pub runner_up: Option<RunnerUpResult>,
    /// Content of an `empirical` table, which is no name.
    pub table: Option<TableResult>,
    /// The catalogue entry.
    #[serde(skip)]
    pub effect: Effect,
}

/// A table for a rest without a name: its size and position.
#[derive(Clone, Debug, Serialize)]
pub struct TableResult {
    /// `unnamed`: a table is no explanation.
    pub status: &'static str,
    /// `force` at the platform, N, or `friction`, a change of μ as a share of it.
    pub changes: &'static str,
    /// Unit of the tabulated values.
    pub value_unit: &'static str,
    /// The condition that the table is over.
    pub over: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Points of the table. Values are interpolated linearly between them and constant beyond the first and the last.
    pub points: Vec<TablePoint>,
    /// Physical causes that look like the table.
    pub looks_like: Vec<&'static str>,
}

/// One point of a table.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TablePoint {
    /// Value of the condition.
    pub at: f64,
    /// Value of the table there.
    pub value: f64,
    /// Standard error of the value, by the scatter of the log's blocks.
    pub standard_error: Option<f64>,
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
pub struct RunnerUpResult {
    /// Its name in the catalogue.
    pub kind: &'static str,
    /// BIC with the effect minus BIC without it.
    pub delta_bic: Option<f64>,
    /// Error with this effect in the other's place, N.
    pub held_out_rms_n: Option<f64>,
    /// Whether the log cannot distinguish the two.
    pub as_good: bool,
    /// The catalogue entry.
    #[serde(skip)]
    pub effect: Effect,
}

/// An effect that helps the extended model but does not suffice.
#[derive(Clone, Debug, Serialize)]
pub struct TriedResult {
    /// Its name in the catalogue.
    pub kind: &'static str,
    /// Evidence for the effect beside the extended model.
    pub evidence: Evidence,
    /// The reason why it is not named, as a clause.
    pub reason: String,
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

/// A rest that no effect explains.
#[derive(Clone, Debug, Serialize)]
pub struct UnexplainedResult {
    /// Error above the noise, N.
    pub rms_n: Option<f64>,
    /// Conditions in which it is concentrated.
    #[serde(rename = "where")]
    pub places: Vec<WhereResult>,
    /// Time intervals in which it is large, s since the first sample.
    pub intervals_s: Vec<[f64; 2]>,
    /// Signals that correlate with it: conditions that it is a function of, the most informative first, then signals of other cables, such as `cable2
    /// sensor_force`.
    pub goes_with: Vec<String>,
}

/// A fault of a recording.
#[derive(Clone, Debug, Serialize)]
pub struct FaultResult {
    /// Its name.
    pub kind: &'static str,
    /// Its values, by key with the unit.
    pub parameters: Numbers,
    /// Time intervals of the fault, s since the first sample; empty if it lasts throughout the log.
    pub intervals_s: Vec<[f64; 2]>,
    /// The kind of the fault.
    #[serde(skip)]
    pub fault: Fault,
}

/// An effect that several cables share.
#[derive(Clone, Debug, Serialize)]
pub struct CommonEffect {
    /// Its name in the catalogue.
    pub kind: &'static str,
    /// The cables that have it.
    pub cables: Vec<String>,
    /// Its fitted parameters over these cables.
    pub parameters: Vec<CommonParameter>,
}

/// One of its parameters.
#[derive(Clone, Debug, Serialize)]
pub struct CommonParameter {
    /// Its key.
    pub key: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Weighted mean over the cables; the plain mean if they differ.
    pub mean: f64,
    /// Standard error of the mean; from the scatter of the cables if they differ.
    pub standard_error: f64,
    /// Whether the cables differ by more than their errors.
    pub differs: bool,
    /// Least value over the cables.
    pub least: f64,
    /// Greatest value over the cables.
    pub greatest: f64,
}

/// The cables differ if the normalised sum of squares exceeds its expectation by this many of its own standard deviations. The limit is high because
/// the errors that a fit reports are uncertain themselves.
const DIFFERS: f64 = 5.0;

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

impl Fault {
    /// Returns the name used in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hum => "hum",
            Self::Vibration => "vibration",
            Self::NoisyLength => "noisy_length",
            Self::Frozen => "frozen",
            Self::Clipped => "clipped",
            Self::Spikes => "spikes",
            Self::CoarseConverter => "coarse_converter",
            Self::ReferenceDelay => "reference_delay",
            Self::ClockSkew => "clock_skew",
        }
    }
}

fn verdict_or_null<S: serde::Serializer>(verdict: &&'static str, serializer: S) -> Result<S::Ok, S::Error> {
    Some(*verdict).filter(|verdict| *verdict != Verdict::Untold.name()).serialize(serializer)
}

impl DiscoverResult {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-discover/1";

    /// Creates the result for a robot's cables. `logs` holds the name and the start of each log, s.
    #[must_use]
    pub fn new(
        robot: &RobotFile,
        logs: &[(String, f64)],
        readiness: &Readiness,
        discoveries: &[CableDiscovery],
    ) -> Self {
        let names = robot.cable_names();
        let cables = discoveries.iter().take(names.len()).enumerate();
        let cables: Vec<DiscoverCableResult> = cables
            .map(|(place, found)| {
                let lack = readiness.lack_of(place).map(|lack| (lack.cause.clone(), lack.advice));
                cable_result(place, &names, found, lack)
            })
            .collect();
        Self {
            format: Self::FORMAT,
            log: logs.iter().map(|(name, _)| name.clone()).collect(),
            log_start_s: logs.iter().map(|(_, start_s)| *start_s).collect(),
            robot: robot.options().name.clone(),
            common_effects: common_effects(&cables),
            wrench: None,
            cables,
        }
    }

    /// Adds the findings for all cables together.
    #[must_use]
    pub fn with_wrench(mut self, found: Option<&WrenchDiscovery>) -> Self {
        let names: Vec<String> = self.cables.iter().map(|cable| cable.name.clone()).collect();
        self.wrench = found.map(|found| WrenchGap::of(found, &names));
        // A value that all cables share is as certain as on each cable.
        for effect in &mut self.common_effects {
            let first = self.cables.iter().flat_map(|cable| &cable.effects).find(|of| of.kind == effect.kind);
            let is_alike = found.is_some_and(|found| found.alike.iter().any(|alike| alike.kind() == effect.kind));
            for parameter in effect.parameters.iter_mut().filter(|_| is_alike) {
                let error = first.and_then(|of| of.standard_errors.get(parameter.key));
                parameter.standard_error = error.unwrap_or(parameter.standard_error);
            }
        }
        self
    }

    /// Returns a summary for people: the verdicts, then the findings.
    #[must_use]
    pub fn summary(&self) -> String {
        summary::describe(self)
    }

    /// Checks that at least one cable has a verdict.
    ///
    /// # Errors
    /// Returns a [`FitError`] with the reason if none has.
    pub fn check_told(&self) -> Result<(), FitError> {
        let missing: Vec<&Missing> = self.cables.iter().filter_map(|cable| cable.missing.as_ref()).collect();
        let (Some(first), true) = (missing.first(), missing.len() == self.cables.len()) else { return Ok(()) };
        let name = self.cables.first().map_or("", |cable| cable.name.as_str());
        let others = if self.cables.len() > 1 { ", and nothing of the others" } else { "" };
        Err(FitError::new(format!("the log tells nothing of {name}{others}: {}", first.cause), first.advice))
    }
}

/// Names of the components with their units.
const COMPONENTS: [&str; 6] = ["fx_n", "fy_n", "fz_n", "tx_nm", "ty_nm", "tz_nm"];

impl WrenchGap {
    fn of(found: &WrenchDiscovery, names: &[String]) -> Self {
        let parts = found.noise.iter().zip(found.before.components.iter().zip(&found.after.components));
        let component = |(name, (noise, (before, after))): (&&'static str, (&f64, (&f64, &f64)))| WrenchComponent {
            name,
            noise: *noise,
            before: *before,
            after: *after,
        };
        let geometry = |of: &GeometryFinding| GeometryResult {
            kind: of.geometry.key(),
            cable: of.geometry.cable().and_then(|cable| names.get(cable).cloned()),
            parameters: Numbers(
                of.geometry
                    .names()
                    .iter()
                    .zip(&of.numbers)
                    .map(|(name, number)| ((*name).to_owned(), *number))
                    .collect(),
            ),
            evidence: Evidence { delta_bic: finite(of.delta_bic), held_out_rms_n: None },
        };
        let length = |parts: &[f64]| parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        let (force, torque) = found.noise.split_at(3);
        Self {
            reference: found.reference.name(),
            verdict: found.verdict.name(),
            before: WrenchError::of(&found.before.errors),
            after: WrenchError::of(&found.after.errors),
            noise_floor: WrenchError { force_rms_n: length(force), torque_rms_nm: length(torque) },
            components: COMPONENTS.iter().zip(parts).map(component).collect(),
            alike: found.alike.iter().map(|effect| effect.kind()).collect(),
            geometry: found.geometry.iter().map(geometry).collect(),
            tried: found
                .tried
                .iter()
                .map(|(kind, refusal)| TriedTogether { kind: kind.clone(), reason: refusal.in_words() })
                .collect(),
        }
    }
}

/// Returns the number if it is finite.
fn finite(number: f64) -> Option<f64> {
    number.is_finite().then_some(number)
}

fn cable_result(
    place: usize,
    names: &[&str],
    found: &CableDiscovery,
    lack: Option<(String, &'static str)>,
) -> DiscoverCableResult {
    let samples = found.samples;
    let (before, after) = (ForceError::of(&found.before.held_out_n), ForceError::of(&found.after.held_out_n));
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
        gap_closed: after.and_then(|after| share(after.rms_n)),
        verdict: found.verdict.name(),
        missing,
        places,
        effects: found.findings.iter().map(|finding| effect_result(found, finding)).collect(),
        candidates: found.candidates.iter().map(Candidate::of).collect(),
        tried: found.tried.iter().map(TriedResult::of).collect(),
        parameters: parameters(found),
        standard_errors: errors(&found.after, Parameter::all(), ToString::to_string),
        faults: found.faults.iter().map(FaultResult::of).collect(),
        unexplained: found.unexplained.as_ref().map(|rest| unexplained(rest, names)),
    }
}

/// Returns the fraction of the gap closed if this error is left; `None` if there is no gap.
fn gap_closed(found: &CableDiscovery, rms_n: f64) -> Option<f64> {
    let gap_n = found.before.held_out_n.rms()? - found.noise_floor_n;
    (found.verdict != Verdict::Complete && gap_n > 0.0)
        .then(|| 1.0 - (rms_n - found.noise_floor_n) / gap_n)
        .and_then(finite)
}

/// Returns the mean square above the noise, N².
fn excess(model: &Model, noise_n: f64) -> f64 {
    model.held_out_n.rms().map_or(f64::NAN, |rms_n| rms_n * rms_n - noise_n * noise_n)
}

/// Returns the values of the extended model: friction, fitted parameters, and all parameters of each effect found.
fn parameters(found: &CableDiscovery) -> Numbers {
    let model = &found.after;
    let of_finding = |parameter: &Parameter| {
        found.findings.iter().any(|finding| finding.effect.places().contains(&parameter.place()))
    };
    let shown = |parameter: Parameter| {
        let value = model.values[parameter.place()];
        let of_finding = of_finding(&parameter) && !empirical::is_idle(&parameter, &model.values);
        let relevant = parameter.is_friction() || model.fitted.contains(&parameter) || of_finding;
        (relevant && value < NO_PRESLIDING_N_PER_M).then(|| (parameter.to_string(), value))
    };
    Numbers(Parameter::all().filter_map(shown).collect())
}

/// Returns the standard errors of the fitted ones among some parameters, by name.
fn errors(model: &Model, of: impl Iterator<Item = Parameter>, name: impl Fn(&Parameter) -> String) -> Numbers {
    Numbers(of.filter_map(|parameter| Some((name(&parameter), finite(model.standard_error(&parameter)?)?))).collect())
}

fn effect_result(found: &CableDiscovery, finding: &Finding) -> EffectResult {
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
        standard_errors: errors(&found.after, Parameter::of(finding.effect), key),
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
        effect: finding.effect,
    }
}

impl TableResult {
    /// Creates the table of a model, if it has one.
    fn of(model: &Model) -> Option<Self> {
        let value = |place: usize| model.values[place];
        let over = Over::of(value)?;
        let (from, to) = (value(over.from()), value(over.to()));
        let (size, changes, value_unit) =
            if value(SIZE).abs() > 0.0 { (value(SIZE), "force", "N") } else { (value(RATIO), "friction", "1") };
        let shares = Parameter::of(Effect::Empirical).filter(|parameter| SHARE_PLACES.contains(&parameter.place()));
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let points = shares.enumerate().map(|(place, share)| TablePoint {
            at: from + (to - from) * place as f64 / (SHARES - 1) as f64,
            value: size * value(share.place()),
            standard_error: model.standard_error(&share).and_then(|error| finite(size.abs() * error)),
        });
        Some(Self {
            status: "unnamed",
            changes,
            value_unit,
            over: empirical::signal_of(over),
            unit: over.unit(),
            points: points.collect(),
            looks_like: empirical::looks_like(over, changes == "force").to_vec(),
        })
    }
}

impl Candidate {
    fn of(candidate: &report::Candidate) -> Self {
        let report::Candidate { effect, delta_bic, held_out_rms_n } = candidate;
        Self { kind: effect.kind(), delta_bic: finite(*delta_bic), held_out_rms_n: finite(*held_out_rms_n) }
    }
}

impl TriedResult {
    fn of(tried: &Tried) -> Self {
        let Tried { effect, delta_bic, held_out_rms_n, refusal } = tried;
        let evidence = Evidence { delta_bic: finite(*delta_bic), held_out_rms_n: finite(*held_out_rms_n) };
        Self { kind: effect.kind(), evidence, reason: refusal.in_words() }
    }
}

impl WhereResult {
    fn of(place: &Place) -> Self {
        Self {
            signal: place.signal,
            from: place.from,
            to: place.to,
            unit: place.unit,
            share_of_excess: finite(place.share_of_excess),
            share_of_samples: finite(place.share_of_samples),
            explains: finite(place.explains),
            significance: finite(place.significance),
            intervals_s: place.intervals_s.clone(),
            range: place.range,
        }
    }

    /// Creates the entry of a spectral line from its mean square above the noise.
    fn of_hum(fault: &RecordingFault, excess: f64) -> Option<Self> {
        let value = |key: &str| fault.parameters.iter().find(|(of, _)| *of == key).map(|(_, value)| *value);
        let (frequency_hz, amplitude_n) = (value("frequency_hz")?, value("amplitude_n")?);
        let share = finite((0.5 * amplitude_n.powi(2) / excess).clamp(0.0, 1.0));
        Some(Self {
            signal: "frequency",
            from: frequency_hz,
            to: frequency_hz,
            unit: "Hz",
            share_of_excess: share,
            share_of_samples: Some(1.0),
            explains: share,
            significance: None,
            intervals_s: Vec::new(),
            range: [f64::NAN; 2],
        })
    }
}

impl FaultResult {
    /// Creates the entry of a fault.
    #[must_use]
    pub fn of(found: &RecordingFault) -> Self {
        Self {
            kind: found.fault.name(),
            parameters: Numbers(found.parameters.iter().map(|(key, value)| ((*key).to_owned(), *value)).collect()),
            intervals_s: found.intervals_s.clone(),
            fault: found.fault,
        }
    }
}

fn unexplained(rest: &Unexplained, names: &[&str]) -> UnexplainedResult {
    let of_cable = rest.places.iter().map(|place| place.signal.to_owned());
    let of_others = rest.neighbours.iter().map(|Neighbour { cable, signal, .. }| {
        let name = names.get(*cable).copied().unwrap_or_default();
        format!("{name} {signal}")
    });
    UnexplainedResult {
        rms_n: finite(rest.rms_n),
        places: rest.places.iter().map(WhereResult::of).collect(),
        intervals_s: rest.intervals_s.clone(),
        goes_with: of_cable.chain(of_others).collect(),
    }
}

fn common_effects(cables: &[DiscoverCableResult]) -> Vec<CommonEffect> {
    let mut kinds: Vec<&'static str> = Vec::new();
    for effect in cables.iter().flat_map(|cable| &cable.effects) {
        if !kinds.contains(&effect.kind) {
            kinds.push(effect.kind);
        }
    }
    kinds.into_iter().filter_map(|kind| common_effect(kind, cables)).collect()
}

/// Returns an effect over the cables that have it, if there are several.
fn common_effect(kind: &'static str, cables: &[DiscoverCableResult]) -> Option<CommonEffect> {
    let with: Vec<(&str, &EffectResult)> = cables
        .iter()
        .filter_map(|cable| Some((cable.name.as_str(), cable.effects.iter().find(|effect| effect.kind == kind)?)))
        .collect();
    // Tables have no common value.
    if with.first()?.1.effect == Effect::Empirical {
        return None;
    }
    let parameters = with.first()?.1.effect.row().parameters.iter().filter_map(|parameter| {
        let of_cable = |(_, effect): &(&str, &EffectResult)| {
            Some((effect.parameters.get(parameter.key)?, effect.standard_errors.get(parameter.key)?))
        };
        let numbers: Vec<(f64, f64)> = with.iter().filter_map(of_cable).collect();
        CommonParameter::of(parameter.key, parameter.unit, &numbers)
    });
    (with.len() > 1).then(|| CommonEffect {
        kind,
        cables: with.iter().map(|(name, _)| (*name).to_owned()).collect(),
        parameters: parameters.collect(),
    })
}

impl CommonParameter {
    /// Creates the parameter from values with their standard errors.
    fn of(key: &'static str, unit: &'static str, numbers: &[(f64, f64)]) -> Option<Self> {
        let numbers: Vec<(f64, f64)> = numbers.iter().copied().filter(|(_, error)| *error > 0.0).collect();
        #[expect(clippy::cast_precision_loss, reason = "a count of cables")]
        let count = numbers.len() as f64;
        if count < 2.0 {
            return None;
        }
        let weights: f64 = numbers.iter().map(|(_, error)| error.powi(-2)).sum();
        let weighted = numbers.iter().map(|(value, error)| value * error.powi(-2)).sum::<f64>() / weights;
        let squares: f64 = numbers.iter().map(|(value, error)| ((value - weighted) / error).powi(2)).sum();
        let freedom = count - 1.0;
        let differs = squares > freedom + DIFFERS * (2.0 * freedom).sqrt();
        let plain = numbers.iter().map(|(value, _)| value).sum::<f64>() / count;
        let scatter: f64 = numbers.iter().map(|(value, _)| (value - plain).powi(2)).sum();
        let (mean, standard_error) =
            if differs { (plain, (scatter / freedom / count).sqrt()) } else { (weighted, weights.sqrt().recip()) };
        let ends = numbers.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), (value, _)| {
            (least.min(*value), greatest.max(*value))
        });
        Some(Self { key, unit, mean, standard_error, differs, least: ends.0, greatest: ends.1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_over_cables_says_when_they_differ() {
        let of = |numbers: &[(f64, f64)]| CommonParameter::of("delay_s", "s", numbers).unwrap();
        let same = of(&[(6.0e-3, 1e-4), (6.2e-3, 1e-4), (6.1e-3, 2e-4), (6.1e-3, 2e-4)]);
        assert!(!same.differs && (same.mean - 6.1e-3).abs() < 1e-12, "{same:?}");
        assert!((same.standard_error - 1.0 / (2e8_f64 + 0.5e8).sqrt()).abs() < 1e-12, "{same:?}");
        let other = of(&[(2e-3, 1e-5), (6e-3, 1e-4)]);
        assert!(other.differs && (other.mean - 4e-3).abs() < 1e-12, "{other:?}");
        assert!((other.standard_error - 2e-3).abs() < 1e-12 && other.greatest - other.least > 3.9e-3, "{other:?}");
        assert!(CommonParameter::of("delay_s", "s", &[(1.0, 1.0), (1.0, 0.0)]).is_none());
    }
}
