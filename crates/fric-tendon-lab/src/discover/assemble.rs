//! Assembles the result of a search from its outcome.

use fric_lab::discover::Verdict;
use fric_lab::discover::result::{
    Absent, DiscoverCableResult, DiscoverResult, EffectResult, Evidence, RunnerUpResult, TriedResult, UnexplainedResult,
};
use fric_lab::errors::ForceError;
use fric_lab::numbers::Numbers;
use fric_tendon::file::USUAL_SIGMA_N_PER_M;

use super::TendonDiscovery;
use super::case::{Case, Fit};
use super::extended_file::{drift, edit};
use super::final_fit::{Final, shared_mu};
use super::friction::model::{Effect, Model, Parameter};
use super::friction::naming::{Finding, Outcome, Tried};
use super::goes_with::{GoesWith, of_markers, of_tensions};
use super::machine::Named;
use super::markers::MarkerFit;
use super::noise::{excess_n, rms_n};
use super::places::{disks, segments};
use super::result::{Manipulator, MarkerError, TendonMarkers};
use super::worse::Worse;

/// Returns the result of an outcome, with the changes to write. `named` lists the findings that are already in the file of the case.
/// `faults` lists what is wrong with the markers of the run, which is then unexplained.
pub fn told(case: &Case<'_>, outcome: &Outcome, named: &[Named], faults: &[GoesWith], log: &str) -> TendonDiscovery {
    let verdict = &if faults.is_empty() { outcome.verdict } else { Verdict::Unexplained };
    let Outcome { noise_n, before, after, last, findings, tried, markers, .. } = outcome;
    let closed = |fit: &Fit| {
        let gap_n = rms_n(before) - noise_n;
        (*verdict != Verdict::Complete && gap_n > 0.0).then(|| (1.0 - (rms_n(fit) - noise_n) / gap_n).min(1.0))
    };
    let evidence = |delta_bic: f64, rms_n: Option<f64>| Evidence { delta_bic: Some(delta_bic), held_out_rms_n: rms_n };
    let runner_up = |kind, delta_bic, effect| RunnerUpResult {
        kind,
        delta_bic: Some(delta_bic),
        held_out_rms_n: Absent,
        as_good: Absent,
        effect,
    };
    let effect = |finding: &Finding| EffectResult {
        kind: finding.effect.kind(),
        parameters: parameters(case, finding.effect, &last.fit.model),
        standard_errors: standard_errors(case, finding.effect, last),
        gap_closed: closed(&finding.fit),
        evidence: evidence(finding.delta_bic, finding.fit.held_out_n.rms()),
        runner_up: finding
            .runner_up
            .map(|(other, delta_bic)| runner_up(other.kind(), delta_bic, other.cause_and_remedy())),
        table: Absent,
        alike: Vec::new(),
        effect: finding.effect.cause_and_remedy(),
    };
    let of_machine = |one: &Named| EffectResult {
        kind: one.candidate.kind(),
        parameters: one.parameters.clone(),
        standard_errors: one.standard_errors.clone(),
        gap_closed: Some(one.gap_closed),
        evidence: evidence(one.delta_bic, after.held_out_n.rms()),
        runner_up: one.runner_up.map(|(other, delta_bic)| runner_up(other.kind(), delta_bic, other.cause_and_remedy())),
        table: Absent,
        alike: one.alike.iter().map(|other| other.kind()).collect(),
        effect: one.candidate.cause_and_remedy(),
    };
    let helped = |tried: &Tried| TriedResult {
        kind: tried.effect.kind(),
        parameters: Some(place_of(tried.effect)),
        evidence: evidence(tried.delta_bic, Some(tried.rms_n)),
        reason: tried.reason.clone(),
        refusal: None,
        takes_rest: false,
    };
    let mut tried: Vec<&Tried> = tried.iter().collect();
    tried.sort_by(|one, other| one.delta_bic.total_cmp(&other.delta_bic));
    let tendon = DiscoverCableResult {
        per_log: Vec::new(),
        name: "tendon".to_owned(),
        samples: case.run_samples,
        left_out: Absent,
        held_out_samples: Absent,
        held_out_s: Absent,
        noise_floor_n: Some(*noise_n),
        wander_n: Absent,
        reference_variation_n: Absent,
        calibration_error_n: Some(case.line_error_rms_n()),
        before: ForceError::of(&before.held_out_n),
        after: ForceError::of(&after.held_out_n),
        gap_closed: closed(after),
        verdict: *verdict,
        missing: Absent,
        places: if *verdict == Verdict::Complete { Vec::new() } else { segments(before) },
        markers: marker_errors(markers),
        effects: named.iter().map(of_machine).chain(findings.iter().map(effect)).collect(),
        candidates: Absent,
        tried: tried.into_iter().map(helped).collect(),
        kept: last.kept.map(|(worse, mu)| kept(&worse, mu)),
        parameters: Absent,
        standard_errors: Absent,
        at_bound: Vec::new(),
        undetermined: Vec::new(),
        revised: Vec::new(),
        faults: Absent,
        unexplained: (*verdict == Verdict::Unexplained).then(|| rest(case, outcome, faults)),
    };
    TendonDiscovery {
        result: DiscoverResult {
            format: DiscoverResult::<Manipulator>::FORMAT,
            log: vec![log.to_owned()],
            log_start_s: Absent,
            robot: case.file.tables().name.clone(),
            cables: vec![tendon],
            common_effects: Absent,
            wrench: None,
        },
        edit: edit(case, outcome),
        base_noise: None,
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

/// Returns the rest: of the tensions, and of the markers if it exceeds the noise.
fn rest(case: &Case<'_>, outcome: &Outcome, faults: &[GoesWith]) -> UnexplainedResult<Manipulator> {
    let Outcome { given, after, last, are_tensions_explained, markers: [_, markers], .. } = outcome;
    let off = markers.as_ref().filter(|markers| !markers.is_noise());
    // Wrong gratings cause wrong shapes. The bending is reported if the gratings cannot explain the shapes.
    let is_bending = |markers: &&MarkerFit| *are_tensions_explained || markers.is_beyond(case, excess_n(after));
    let bending = off.filter(is_bending).and_then(|markers| of_markers(case, &last.fit, markers));
    let tensions = if *are_tensions_explained { None } else { of_tensions(case, given) };
    let of_gratings = if *are_tensions_explained { Vec::new() } else { segments(after) };
    let of_disks = off.map(disks).unwrap_or_default();
    let places = if bending.is_some() { [of_disks, of_gratings] } else { [of_gratings, of_disks] };
    UnexplainedResult {
        rms_n: Some(excess_n(after)),
        rms_mm: off.map(|markers| 1e3 * markers.excess_m()),
        places: places.concat(),
        intervals_s: Absent,
        goes_with: faults.iter().cloned().chain(bending).chain(tensions).collect(),
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

/// Returns the standard errors of an effect's fitted parameters.
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

/// Returns the grating or the hole of an effect.
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
