//! The result of a tendon's discovery: `fric-discover/1`, with the tendon in the place of a cable.

use std::fmt::Write as _;

use fric_core::continuum::edit::ManipulatorEdit;
use fric_core::continuum::file::USUAL_SIGMA_N_PER_M;
use nalgebra::DMatrix;
use serde::Serialize;

use super::TendonDiscovery;
use super::case::{Case, Fit};
use super::fitting::covariance;
use super::model::{Effect, Model, Parameter};
use super::naming::{Finding, Outcome, excess_n, rms_n};
use crate::continuum::shape_errors::Way;
use crate::discover::Verdict;
use crate::discover::result::{DiscoverResult, Evidence};
use crate::errors::ForceError;
use crate::fit::HALF_INTERVAL;
use crate::fit::result::Numbers;
use crate::text::{quantity, table, wrapped};

/// `fric-discover/1` of a manipulator.
#[derive(Clone, Debug, Serialize)]
pub struct TendonDiscoverResult {
    /// Name and version of the form.
    pub format: &'static str,
    /// The run.
    pub log: Vec<String>,
    /// Name of the manipulator.
    pub robot: String,
    /// The tendon.
    pub cables: Vec<TendonResult>,
}

/// The tendon.
#[derive(Clone, Debug, Serialize)]
pub struct TendonResult {
    /// `tendon`.
    pub name: &'static str,
    /// Samples of the run.
    pub samples: usize,
    /// Standard deviation of the gratings' noise, N.
    pub noise_floor_n: f64,
    /// Error of the given model, fitted, on samples held out.
    pub before: Option<ForceError>,
    /// Error of the extended one.
    pub after: Option<ForceError>,
    /// Share of the gap that the extended model has closed.
    pub gap_closed: Option<f64>,
    /// `complete`, `extended` or `unexplained`.
    pub verdict: &'static str,
    /// Segments in which the given model disagrees, what tells most first.
    #[serde(rename = "where")]
    pub places: Vec<TendonPlace>,
    /// What was found, in the order in which it entered.
    pub effects: Vec<TendonEffect>,
    /// Where what no effect accounts for lies.
    pub unexplained: Option<TendonRest>,
}

/// A segment.
#[derive(Clone, Debug, Serialize)]
pub struct TendonPlace {
    /// `grating`.
    pub signal: &'static str,
    /// Which, from 1 at the base.
    pub from: usize,
    /// The same.
    pub to: usize,
    /// `1`.
    pub unit: &'static str,
    /// Share of the squared residual that it holds.
    pub share_of_excess: f64,
}

/// An effect that was found.
#[derive(Clone, Debug, Serialize)]
pub struct TendonEffect {
    /// Its name.
    pub kind: &'static str,
    /// Its parameters by key; `grating` and `hole` count from 1 at the base.
    pub parameters: Numbers,
    /// Standard errors of those that were fitted, by key.
    pub standard_errors: Numbers,
    /// Share of the gap closed with it and all before it.
    pub gap_closed: Option<f64>,
    /// What speaks for it.
    pub evidence: Evidence,
    /// The best other candidate.
    pub runner_up: Option<TendonRunnerUp>,
    /// Cause and remedy.
    #[serde(skip)]
    pub words: [&'static str; 2],
}

/// Another effect that might have been it.
#[derive(Clone, Debug, Serialize)]
pub struct TendonRunnerUp {
    /// Its name.
    pub kind: &'static str,
    /// Schwarz's criterion with it less without it.
    pub delta_bic: f64,
}

/// What no effect accounts for.
#[derive(Clone, Debug, Serialize)]
pub struct TendonRest {
    /// Error above the noise, N.
    pub rms_n: f64,
    /// Segments in which it lies.
    #[serde(rename = "where")]
    pub places: Vec<TendonPlace>,
}

/// All of it.
pub(super) fn told(case: &Case<'_>, outcome: &Outcome, log: &str) -> TendonDiscovery {
    let Outcome { noise_n, verdict, before, after, findings } = outcome;
    let closed = |fit: &Fit| {
        let gap_n = rms_n(before) - noise_n;
        (*verdict != Verdict::Complete && gap_n > 0.0).then(|| 1.0 - (rms_n(fit) - noise_n) / gap_n)
    };
    let covariance = covariance(case, after);
    let effect = |finding: &Finding| TendonEffect {
        kind: finding.effect.kind(),
        parameters: parameters(case, finding.effect, &after.model),
        standard_errors: standard_errors(case, finding.effect, &after.model, covariance.as_ref()),
        gap_closed: closed(&finding.fit),
        evidence: Evidence { delta_bic: Some(finding.delta_bic), held_out_rms_n: finding.fit.held_out_n.rms() },
        runner_up: finding.runner_up.map(|(effect, delta_bic)| TendonRunnerUp { kind: effect.kind(), delta_bic }),
        words: finding.effect.cause_and_remedy(),
    };
    let rest = || TendonRest { rms_n: excess_n(after, *noise_n), places: places(after) };
    let tendon = TendonResult {
        name: "tendon",
        samples: case.run_samples,
        noise_floor_n: *noise_n,
        before: ForceError::of(&before.held_out_n),
        after: ForceError::of(&after.held_out_n),
        gap_closed: closed(after),
        verdict: verdict.name(),
        places: if *verdict == Verdict::Complete { Vec::new() } else { places(before) },
        effects: findings.iter().map(effect).collect(),
        unexplained: (*verdict == Verdict::Unexplained).then(rest),
    };
    TendonDiscovery {
        result: TendonDiscoverResult {
            format: DiscoverResult::FORMAT,
            log: vec![log.to_owned()],
            robot: case.file.tables().name.clone(),
            cables: vec![tendon],
        },
        edit: edit(case, &after.model, findings),
        time_s: case.samples.iter().map(|sample| sample.time_s).collect(),
        residual_before_n: before.residual_n.clone(),
        residual_after_n: after.residual_n.clone(),
    }
}

fn count(place: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let count = (place + 1) as f64;
    count
}

/// μ of the holes that share one.
fn shared_mu(model: &Model) -> f64 {
    let shared = model.mu.iter().zip(&model.is_own).find(|(_, is_own)| !**is_own);
    shared.map_or(0.0, |(mu, _)| *mu)
}

fn named(pairs: &[(&str, f64)]) -> Numbers {
    Numbers(pairs.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect())
}

/// Of what an effect has that was fitted.
fn standard_errors(case: &Case<'_>, effect: Effect, model: &Model, covariance: Option<&DMatrix<f64>>) -> Numbers {
    let of = |parameter: Parameter| {
        let place = model.parameters().iter().position(|fitted| *fitted == parameter)?;
        covariance?.get((place, place)).map(|variance| variance.sqrt()).filter(|error| error.is_finite())
    };
    let found = match effect {
        Effect::Coulomb => of(Parameter::SharedMu).map(|error| ("mu", error)),
        Effect::Presliding => None,
        Effect::SensorDrift(grating) => {
            let newton_per_nm = case.newton_per_nm.get(grating).map_or(f64::NAN, |slope| slope.abs());
            of(Parameter::Drift(grating)).map(|error| ("drift_nm_per_s", error / newton_per_nm))
        }
        Effect::HoleFriction(hole) => of(Parameter::OwnMu(hole)).map(|error| ("mu", error)),
    };
    named(found.as_slice())
}

fn parameters(case: &Case<'_>, effect: Effect, model: &Model) -> Numbers {
    match effect {
        Effect::Coulomb => named(&[("mu", shared_mu(model))]),
        Effect::Presliding => named(&[("sigma_n_per_m", USUAL_SIGMA_N_PER_M)]),
        Effect::SensorDrift(grating) => {
            named(&[("grating", count(grating)), ("drift_nm_per_s", drift(case, model, grating))])
        }
        Effect::HoleFriction(hole) => {
            named(&[("hole", count(hole)), ("mu", model.mu.get(hole).copied().unwrap_or(f64::NAN))])
        }
    }
}

/// Drift of a shift, that which the file states included.
fn drift(case: &Case<'_>, model: &Model, grating: usize) -> f64 {
    let stated = case.file.tables().gratings.as_ref().and_then(|table| table.drift_nm_per_s.get(grating)).copied();
    let found = model.drift_n_per_s.get(grating).zip(case.newton_per_nm.get(grating));
    stated.unwrap_or(0.0) + found.map_or(0.0, |(drift_n_per_s, newton_per_nm)| drift_n_per_s / newton_per_nm)
}

/// Segments by their share of the squared residual.
fn places(fit: &Fit) -> Vec<TendonPlace> {
    let segment_count = fit.model.mu.len();
    let of = |segment: usize| -> f64 {
        let values = fit.residual_n.iter().filter_map(|row| row.get(segment));
        values.filter(|value| value.is_finite()).map(|value| value * value).sum()
    };
    let whole: f64 = (0..segment_count).map(of).sum();
    let place = |segment: usize| TendonPlace {
        signal: "grating",
        from: segment + 1,
        to: segment + 1,
        unit: "1",
        share_of_excess: of(segment) / whole,
    };
    let mut all: Vec<TendonPlace> = (0..segment_count).map(place).filter(|one| one.share_of_excess > 0.0).collect();
    all.sort_by(|one, other| other.share_of_excess.total_cmp(&one.share_of_excess));
    all
}

/// What the extended file says: values fitted to the run, and what was found.
fn edit(case: &Case<'_>, model: &Model, findings: &[Finding]) -> ManipulatorEdit {
    let is_same = model.mu.windows(2).all(|pair| pair[0].to_bits() == pair[1].to_bits());
    let drifts = findings.iter().any(|finding| matches!(finding.effect, Effect::SensorDrift(_)));
    let remembers = findings.iter().any(|finding| finding.effect == Effect::Presliding);
    ManipulatorEdit {
        mu: match model.way {
            Way::None => Vec::new(),
            _ if is_same => model.mu.first().copied().into_iter().collect(),
            _ => model.mu.clone(),
        },
        sigma_n_per_m: remembers.then_some(USUAL_SIGMA_N_PER_M),
        lines: Vec::new(),
        drift_nm_per_s: if drifts {
            (0..model.mu.len()).map(|grating| drift(case, model, grating)).collect()
        } else {
            Vec::new()
        },
    }
}

impl TendonDiscoverResult {
    /// For people.
    #[must_use]
    pub fn summary(&self) -> String {
        let number =
            |error: Option<ForceError>| error.map_or_else(|| "–".to_owned(), |error| format!("{:.4}", error.rms_n));
        let percent =
            |share: Option<f64>| share.map_or_else(|| "–".to_owned(), |share| format!("{:.0} %", 100.0 * share));
        let rows: Vec<[String; 7]> = self
            .cables
            .iter()
            .map(|tendon| {
                let kinds: Vec<&str> = tendon.effects.iter().map(|effect| effect.kind).collect();
                [
                    tendon.name.to_owned(),
                    tendon.verdict.to_owned(),
                    if kinds.is_empty() { "–".to_owned() } else { kinds.join("\n") },
                    format!("{:.4}", tendon.noise_floor_n),
                    number(tendon.before),
                    number(tendon.after),
                    percent(tendon.gap_closed),
                ]
            })
            .collect();
        let header = ["", "verdict", "found", "noise", "before", "after", "closed"];
        let mut text = format!("{}: what the model lacks\n\n{}", self.robot, table(&header, 3, &rows));
        text +=
            "\nrms of the tension in the segments, gratings less model, in N, over samples that\nno fit has seen.\n";
        for effect in self.cables.iter().flat_map(|tendon| &tendon.effects) {
            let values: Vec<String> = effect
                .parameters
                .0
                .iter()
                .map(|(name, value)| {
                    let half_interval = effect.standard_errors.get(name).map(|error| HALF_INTERVAL * error);
                    format!("{name} = {}", quantity(*value, half_interval, "1"))
                })
                .collect();
            // Writing to a String cannot fail.
            let _ = writeln!(text, "\n{}: {}", effect.kind, values.join(", "));
            let [cause, remedy] = effect.words;
            text += &wrapped("  cause   ", cause);
            text += &wrapped("  remedy  ", remedy);
        }
        for rest in self.cables.iter().filter_map(|tendon| tendon.unexplained.as_ref()) {
            let first = rest.places.first().map_or(0, |place| place.from);
            let share = rest.places.first().map_or(0.0, |place| 100.0 * place.share_of_excess);
            let sentence = format!(
                "{:.4} N above the noise are left, {share:.0} % of them at grating {first}; no effect of the catalogue accounts for them.",
                rest.rms_n
            );
            text += "\n";
            text += &wrapped("unexplained: ", &sentence);
        }
        text
    }
}
