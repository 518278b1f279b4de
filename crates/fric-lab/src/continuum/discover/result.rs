//! The result of a tendon's discovery: `fric-discover/1`, with the tendon in the place of a cable.

use fric_core::continuum::edit::ManipulatorEdit;
use fric_core::continuum::file::USUAL_SIGMA_N_PER_M;
use serde::Serialize;

use super::TendonDiscovery;
use super::case::{Case, Fit};
use super::final_fit::{Final, shared_mu};
use super::goes_with::{GoesWith, of_markers, of_tensions};
use super::markers::MarkerFit;
use super::model::{Effect, Model, Parameter};
use super::naming::{Finding, Outcome, Tried};
use super::noise::{excess_n, is_negligible, rms_n};
use super::worse::Worse;
use crate::continuum::shape_errors::Way;
use crate::discover::Verdict;
use crate::discover::result::{DiscoverResult, Evidence};
use crate::errors::ForceError;
use crate::fit::result::Numbers;

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
    /// What one standard error of the gratings' lines is over the run, N.
    pub calibration_error_n: f64,
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
    /// Distances between disks and markers under the tensions that the gratings show; absent where too few markers tell their noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub markers: Option<TendonMarkers>,
    /// What was found, in the order in which it entered.
    pub effects: Vec<TendonEffect>,
    /// Candidates that helped and did not suffice, best first.
    pub tried: Vec<TendonTried>,
    /// Why the file keeps a μ that the run contradicts; absent where it keeps none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kept: Option<String>,
    /// Where what no effect accounts for lies.
    pub unexplained: Option<TendonRest>,
}

/// Disks against markers; the friction has no part in it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TendonMarkers {
    /// Noise of a distance, root mean square, mm: of markers and gratings.
    pub noise_mm: f64,
    /// What one standard error of the gratings' lines moves the disks by, root mean square, mm.
    pub calibration_error_mm: f64,
    /// With the given file.
    pub before: MarkerError,
    /// With the extended one.
    pub after: MarkerError,
}

/// Distances over all disks and samples.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MarkerError {
    /// Root mean square, mm.
    pub rms_mm: f64,
    /// Greatest, mm.
    pub max_mm: f64,
}

/// A candidate that helped and did not suffice.
#[derive(Clone, Debug, Serialize)]
pub struct TendonTried {
    /// Its name.
    pub kind: &'static str,
    /// Which: `grating` or `hole`, from 1 at the base.
    pub parameters: Numbers,
    /// What speaks for it.
    pub evidence: Evidence,
    /// Why it is not named.
    pub reason: String,
}

/// A segment, or a disk.
#[derive(Clone, Debug, Serialize)]
pub struct TendonPlace {
    /// `grating` or `marker`.
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
    /// Error of the tensions above the noise, N.
    pub rms_n: f64,
    /// Distance of the disks from their markers above the noise, mm; absent where it is noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_mm: Option<f64>,
    /// Segments and disks in which it lies: those of the signal that is not noise.
    #[serde(rename = "where")]
    pub places: Vec<TendonPlace>,
    /// What it goes with, where it does so with one thing for the most part.
    pub goes_with: Vec<GoesWith>,
}

/// All of it.
pub(super) fn told(case: &Case<'_>, outcome: &Outcome, log: &str) -> TendonDiscovery {
    let Outcome { noise_n, verdict, before, after, last, findings, tried, markers, .. } = outcome;
    let closed = |fit: &Fit| {
        let gap_n = rms_n(before) - noise_n;
        (*verdict != Verdict::Complete && gap_n > 0.0).then(|| (1.0 - (rms_n(fit) - noise_n) / gap_n).min(1.0))
    };
    let evidence = |delta_bic: f64, rms_n: Option<f64>| Evidence { delta_bic: Some(delta_bic), held_out_rms_n: rms_n };
    let effect = |finding: &Finding| TendonEffect {
        kind: finding.effect.kind(),
        parameters: parameters(case, finding.effect, &last.fit.model),
        standard_errors: standard_errors(case, finding.effect, last),
        gap_closed: closed(&finding.fit),
        evidence: evidence(finding.delta_bic, finding.fit.held_out_n.rms()),
        runner_up: finding.runner_up.map(|(effect, delta_bic)| TendonRunnerUp { kind: effect.kind(), delta_bic }),
        words: finding.effect.cause_and_remedy(),
    };
    let helped = |tried: &Tried| TendonTried {
        kind: tried.effect.kind(),
        parameters: place_of(tried.effect),
        evidence: evidence(tried.delta_bic, Some(tried.rms_n)),
        reason: tried.reason.clone(),
    };
    let mut tried: Vec<&Tried> = tried.iter().collect();
    tried.sort_by(|one, other| one.delta_bic.total_cmp(&other.delta_bic));
    let tendon = TendonResult {
        name: "tendon",
        samples: case.run_samples,
        noise_floor_n: *noise_n,
        calibration_error_n: case.line_error_rms_n(),
        before: ForceError::of(&before.held_out_n),
        after: ForceError::of(&after.held_out_n),
        gap_closed: closed(after),
        verdict: verdict.name(),
        places: if *verdict == Verdict::Complete { Vec::new() } else { places(before) },
        markers: marker_errors(markers),
        effects: findings.iter().map(effect).collect(),
        tried: tried.into_iter().map(helped).collect(),
        kept: last.kept.map(|(worse, mu)| kept(&worse, mu)),
        unexplained: (*verdict == Verdict::Unexplained).then(|| rest(case, outcome)),
    };
    TendonDiscovery {
        result: TendonDiscoverResult {
            format: DiscoverResult::FORMAT,
            log: vec![log.to_owned()],
            robot: case.file.tables().name.clone(),
            cables: vec![tendon],
        },
        edit: edit(case, outcome),
        time_s: case.samples.iter().map(|sample| sample.time_s).collect(),
        residual_before_n: before.residual_n.clone(),
        residual_after_n: after.residual_n.clone(),
    }
}

fn kept(worse: &Worse, mu: f64) -> String {
    format!(
        "the file keeps its μ; fitted to the run it is {mu:.4}, and disk {} is then {:.2} mm off its marker (rms) instead of {:.2} mm.",
        worse.disk + 1,
        1e3 * worse.after_m,
        1e3 * worse.before_m
    )
}

fn marker_errors(markers: &[Option<MarkerFit>; 2]) -> Option<TendonMarkers> {
    let [Some(before), Some(after)] = markers else { return None };
    let error = |one: &MarkerFit| MarkerError { rms_mm: 1e3 * one.rms_m(), max_mm: 1e3 * one.greatest_m };
    Some(TendonMarkers {
        noise_mm: 1e3 * after.noise_m,
        calibration_error_mm: 1e3 * after.line_error_m,
        before: error(before),
        after: error(after),
    })
}

/// What is left: of the tensions, and of the markers where they are not noise.
fn rest(case: &Case<'_>, outcome: &Outcome) -> TendonRest {
    let Outcome { given, after, last, markers: [_, markers], .. } = outcome;
    let off = markers.as_ref().filter(|markers| !markers.is_noise());
    let are_tensions_off = !is_negligible(case, after);
    let tensions = are_tensions_off.then(|| of_tensions(case, given)).flatten();
    // Gratings that are wrong make shapes that are wrong; only tensions that are right tell of the bending.
    let bending = off.filter(|_| !are_tensions_off).and_then(|markers| of_markers(case, &last.fit, markers));
    let of_gratings = if are_tensions_off { places(after) } else { Vec::new() };
    TendonRest {
        rms_n: excess_n(after),
        rms_mm: off.map(|markers| 1e3 * markers.excess_m()),
        places: of_gratings.into_iter().chain(off.map(disks).unwrap_or_default()).collect(),
        goes_with: tensions.into_iter().chain(bending).collect(),
    }
}

fn count(place: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let count = (place + 1) as f64;
    count
}

fn named(pairs: &[(&str, f64)]) -> Numbers {
    Numbers(pairs.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect())
}

/// Of what an effect has that was fitted.
fn standard_errors(case: &Case<'_>, effect: Effect, last: &Final) -> Numbers {
    let found = match effect {
        Effect::Coulomb => last.shared_mu_error().map(|error| ("mu", error)),
        Effect::Presliding => None,
        Effect::SensorDrift(grating) => {
            let newton_per_nm = case.newton_per_nm.get(grating).map_or(f64::NAN, |slope| slope.abs());
            last.standard_error(Parameter::Drift(grating)).map(|error| ("drift_nm_per_s", error / newton_per_nm))
        }
        Effect::HoleFriction(hole) => last.standard_error(Parameter::OwnMu(hole)).map(|error| ("mu", error)),
    };
    named(found.as_slice())
}

/// The grating or the hole of an effect.
fn place_of(effect: Effect) -> Numbers {
    match effect {
        Effect::Coulomb | Effect::Presliding => named(&[]),
        Effect::SensorDrift(grating) => named(&[("grating", count(grating))]),
        Effect::HoleFriction(hole) => named(&[("hole", count(hole))]),
    }
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
    by_share("grating", fit.model.mu.len(), |segment| {
        let values = fit.residual_n.iter().filter_map(|row| row.get(segment));
        values.filter(|value| value.is_finite()).map(|value| value * value).sum()
    })
}

/// Disks by their share of the squared distance.
fn disks(markers: &MarkerFit) -> Vec<TendonPlace> {
    by_share("marker", markers.residual_m.iter().map(Vec::len).max().unwrap_or(0), |disk| {
        let places = markers.residual_m.iter().filter_map(|row| row.get(disk));
        places.map(|[x_m, y_m]| x_m * x_m + y_m * y_m).filter(|square| square.is_finite()).sum()
    })
}

fn by_share(signal: &'static str, place_count: usize, squares: impl Fn(usize) -> f64) -> Vec<TendonPlace> {
    let squares: Vec<f64> = (0..place_count).map(squares).collect();
    let whole: f64 = squares.iter().sum();
    let place = |(place, squares): (usize, &f64)| TendonPlace {
        signal,
        from: place + 1,
        to: place + 1,
        unit: "1",
        share_of_excess: squares / whole,
    };
    let all = squares.iter().enumerate().map(place);
    let mut all: Vec<TendonPlace> = all.filter(|one| one.share_of_excess > 0.0).collect();
    all.sort_by(|one, other| other.share_of_excess.total_cmp(&one.share_of_excess));
    all
}

/// What the extended file says: what was found, and values fitted to the run where it contradicts those given.
fn edit(case: &Case<'_>, outcome: &Outcome) -> ManipulatorEdit {
    let Outcome { given, last, findings, .. } = outcome;
    let model = &last.fit.model;
    let is_same = model.mu.windows(2).all(|pair| pair[0].to_bits() == pair[1].to_bits());
    let drifts = findings.iter().any(|finding| matches!(finding.effect, Effect::SensorDrift(_)));
    let remembers = findings.iter().any(|finding| finding.effect == Effect::Presliding);
    ManipulatorEdit {
        mu: match model.way {
            Way::None => Vec::new(),
            _ if model.mu == given.model.mu => Vec::new(),
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
