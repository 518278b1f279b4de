//! Finds the missing effects: the best candidate enters if it helps on the held-out samples.

use fric_lab::discover::Verdict;

use super::fitting::{covariance, fitted};
use super::model::{Effect, Model};
use super::trials::{Trial, trials};
use crate::discover::case::{Case, Fit};
use crate::discover::final_fit::{Final, is_own_mu};
use crate::discover::markers::MarkerFit;
use crate::discover::noise::{excess_n, is_as_elsewhere, is_negligible, rms_n};
use crate::discover::worse::{are_tensions_worse, worse_shape};
use crate::error::ContinuumError;

/// Minimum decrease of the BIC for an effect.
pub const LEAST_EVIDENCE: f64 = 10.0;
/// Candidates within this ratio of the best error are as good.
const AS_GOOD_RATIO: f64 = 1.05;
/// Minimum fraction of the gap that an effect must close.
const LEAST_SHARE: f64 = 0.2;
/// Maximum number of effects, not counting holes that enter together.
const MOST_EFFECTS: usize = 6;

/// An effect that was found.
#[derive(Clone, Debug)]
pub struct Finding {
    pub effect: Effect,
    /// The fit with it and all before it.
    pub fit: Fit,
    pub delta_bic: f64,
    pub runner_up: Option<(Effect, f64)>,
}

/// A candidate that helped but did not suffice.
#[derive(Clone, Debug)]
pub struct Tried {
    pub effect: Effect,
    pub delta_bic: f64,
    /// Error with it on held-out samples, N.
    pub rms_n: f64,
    /// The reason why it is not named.
    pub reason: String,
}

/// The outcome of the search.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub noise_n: f64,
    pub verdict: Verdict,
    /// The model as the file states it.
    pub given: Fit,
    pub before: Fit,
    pub after: Fit,
    /// The model to write, fitted to all samples.
    pub last: Final,
    pub findings: Vec<Finding>,
    pub tried: Vec<Tried>,
    /// Whether only the markers make it unexplained, if it is.
    pub are_tensions_explained: bool,
    /// Distances with the given model and with the extended one.
    pub markers: [Option<MarkerFit>; 2],
}

impl Outcome {
    /// Combines the outcome of a search in an extended file with the file that was given: the error before, and the verdict that it is extended.
    ///
    /// # Errors
    /// Returns [`ContinuumError::UntoldNoise`] if the given file has no shapes.
    pub fn beside(self, given_case: &Case<'_>) -> Result<Self, ContinuumError> {
        let given = given_case.given();
        let stated = given_case.fit(&given).ok_or(ContinuumError::UntoldNoise)?;
        let before = fitted(given_case, &given).unwrap_or_else(|| stated.clone());
        let [_, after] = self.markers;
        let verdict = if self.verdict == Verdict::Complete { Verdict::Extended } else { self.verdict };
        Ok(Self { before, markers: [MarkerFit::new(given_case, &stated), after], verdict, ..self })
    }
}

/// Searches for missing effects.
///
/// If the disks disagree with their markers, no hole is named, because its μ follows from the bend. If the tensions fit with individual holes, only
/// the bending remains to be reported.
///
/// If a rest remains, a grating, or a hole between two gratings, that still disagrees, more than the others, is not named: its cause is something else. An effect that makes
/// shapes or tensions worse than with the given file is not named either.
///
/// # Errors
/// Returns [`ContinuumError::UntoldNoise`] if gaps, or a model without shapes, leave no residual to estimate the noise from.
pub fn name(case: &Case<'_>) -> Result<Outcome, ContinuumError> {
    let given = case.fit(&case.given()).ok_or(ContinuumError::UntoldNoise)?;
    let given_markers = MarkerFit::new(case, &given);
    let whole = case.whole();
    let (mut refused, mut distrusted) = (Vec::new(), Vec::new());
    let mut do_refused_holes_explain = false;
    loop {
        let found = search(case, &distrusted)?;
        let wrong = disagreeing(case, &found);
        if found.verdict == Verdict::Unexplained && !wrong.is_empty() {
            refuse(
                &found,
                &wrong,
                "what it leaves at its gratings is neither noise nor as little as at the others",
                &mut refused,
            );
            distrusted.extend(wrong);
            continue;
        }
        let Search { noise_n, verdict, before, after, findings, tried } = found;
        let last = Final::new(&whole, &given, given_markers.as_ref(), &after, verdict, findings.is_empty())
            .ok_or(ContinuumError::UntoldNoise)?;
        let markers = MarkerFit::new(case, &last.fit);
        let is_hole = |effect: &Effect| matches!(effect, Effect::HoleFriction(_));
        let holes: Vec<Effect> = findings.iter().map(|finding| finding.effect).filter(is_hole).collect();
        if !holes.is_empty() && markers.as_ref().is_some_and(|markers| !markers.is_noise()) {
            do_refused_holes_explain = verdict != Verdict::Unexplained;
            let found = Search { noise_n, verdict, before, after, findings, tried };
            let reason = "the disks are off their markers: the bend at the hole, from which its μ is found, is another";
            refuse(&found, &holes, reason, &mut refused);
            distrusted.extend((0..given.model.mu.len()).map(Effect::HoleFriction));
            continue;
        }
        let worse = worse_shape([&given, &last.fit], [given_markers.as_ref(), markers.as_ref()]);
        if let Some(culprit) = findings.last().filter(|_| worse.is_some() || are_tensions_worse(&given, &last.fit)) {
            let reason = worse.map_or_else(
                || "with it the tensions are further from the gratings than as given".to_owned(),
                |worse| {
                    format!(
                        "with it disk {} is {:.2} mm off its marker (rms), {:.2} mm as given",
                        worse.disk + 1,
                        1e3 * worse.after_m,
                        1e3 * worse.before_m
                    )
                },
            );
            let together = findings.iter().filter(|other| other.fit.model == culprit.fit.model);
            let wrong: Vec<Effect> = together.map(|finding| finding.effect).collect();
            let found = Search { noise_n, verdict, before, after, findings, tried };
            refuse(&found, &wrong, &reason, &mut refused);
            distrusted.extend(wrong);
            continue;
        }
        let are_markers_noise = markers.as_ref().is_none_or(MarkerFit::is_noise);
        let are_tensions_explained =
            verdict != Verdict::Unexplained || (do_refused_holes_explain && !are_markers_noise);
        let verdict = if are_markers_noise { verdict } else { Verdict::Unexplained };
        refused.extend(tried);
        return Ok(Outcome {
            noise_n,
            verdict,
            given,
            before,
            after,
            last,
            findings,
            tried: refused,
            are_tensions_explained,
            markers: [given_markers, markers],
        });
    }
}

/// The findings of a search among some effects.
struct Search {
    noise_n: f64,
    verdict: Verdict,
    before: Fit,
    after: Fit,
    findings: Vec<Finding>,
    tried: Vec<Tried>,
}

/// Returns the effects at gratings that disagree more than the others.
fn disagreeing(case: &Case<'_>, found: &Search) -> Vec<Effect> {
    let gratings = |effect: &Effect| match *effect {
        Effect::SensorDrift(grating) => grating..=grating,
        Effect::HoleFriction(hole) => hole.saturating_sub(1)..=hole,
        #[expect(clippy::reversed_empty_ranges, reason = "these are at no grating")]
        Effect::Coulomb | Effect::Presliding => 1..=0,
    };
    let effects = || found.findings.iter().map(|finding| finding.effect);
    let is_accounted = |grating: usize| effects().any(|effect| gratings(&effect).contains(&grating));
    let is_wrong =
        |effect: &Effect| gratings(effect).any(|grating| !is_as_elsewhere(case, &found.after, grating, &is_accounted));
    effects().filter(is_wrong).collect()
}

/// Moves effects to those that helped but did not suffice.
fn refuse(found: &Search, effects: &[Effect], reason: &str, tried: &mut Vec<Tried>) {
    for finding in found.findings.iter().filter(|finding| effects.contains(&finding.effect)) {
        let Finding { effect, fit, delta_bic, .. } = finding;
        tried.push(Tried { effect: *effect, delta_bic: *delta_bic, rms_n: rms_n(fit), reason: reason.to_owned() });
    }
}

/// Searches among all effects except the distrusted ones.
fn search(case: &Case<'_>, distrusted: &[Effect]) -> Result<Search, ContinuumError> {
    let given = case.given();
    let before = fitted(case, &given).or_else(|| case.fit(&given)).ok_or(ContinuumError::UntoldNoise)?;
    let mut now = before.clone();
    let mut findings: Vec<Finding> = Vec::new();
    let mut tried: Vec<Tried> = Vec::new();
    // Continues until the verdict would be that nothing is missing, so that a discovery with the written file names nothing more.
    while findings.len() < MOST_EFFECTS && !is_negligible(case, &now) {
        let gap_n = excess_n(&now);
        let (spread, single): (Vec<Trial>, Vec<Trial>) =
            trials(case, &now, distrusted).into_iter().partition(Trial::is_spread);
        let closed = |trial: &Trial| 1.0 - excess_n(&trial.fit) / gap_n;
        let helps = |trial: &Trial| trial.delta_bic < -LEAST_EVIDENCE;
        let is_enough = |trial: &Trial| helps(trial) && closed(trial) > LEAST_SHARE;
        // Sufficient candidates come first, and a spread over all holes comes last, because it would absorb any of them.
        let mut ranking = ranked(single);
        if let Some(place) = ranking.iter().position(is_enough) {
            ranking[..=place].rotate_right(1);
        } else {
            ranking.splice(0..0, spread.into_iter().filter(is_enough));
        }
        if !ranking.first().is_some_and(is_enough) {
            let helped = ranking.into_iter().filter(|trial| helps(trial) && trial.effects.len() == 1);
            tried = helped.map(|trial| too_little(&trial, closed(&trial))).collect();
            break;
        }
        let mut others = ranking.into_iter();
        let Some(best) = others.next() else { break };
        let runner_up = others
            .find(|trial| trial.effects != best.effects)
            .and_then(|trial| Some((*trial.effects.last()?, trial.delta_bic)));
        for effect in best.effects {
            findings.push(Finding { effect, fit: best.fit.clone(), delta_bic: best.delta_bic, runner_up });
        }
        now = best.fit;
    }
    let is_accounted = is_negligible(case, &now);
    (now, findings) = clear(case, now, findings, &mut tried);
    let is_accounted = is_accounted || is_negligible(case, &now);
    if !is_accounted {
        // A name for less than the rest would be a guess.
        let left_n = excess_n(&now);
        while let Some(last) = findings.last() {
            let earlier = findings.iter().rev().find(|other| other.fit.model != last.fit.model);
            let earlier = earlier.map_or(&before, |other| &other.fit);
            if excess_n(earlier).powi(2) >= 2.0 * left_n * left_n {
                break;
            }
            now = earlier.clone();
            let model = last.fit.model.clone();
            let (dropped, kept) = findings.into_iter().partition(|finding| finding.fit.model == model);
            findings = kept;
            let guess = |finding: Finding| Tried {
                effect: finding.effect,
                delta_bic: finding.delta_bic,
                rms_n: rms_n(&finding.fit),
                reason: "more is left than it accounts for".to_owned(),
            };
            tried.extend(Vec::into_iter(dropped).map(guess));
        }
    }
    let verdict = match (findings.is_empty(), is_accounted) {
        (true, true) => Verdict::Complete,
        (false, true) => Verdict::Extended,
        (_, false) => Verdict::Unexplained,
    };
    let noise_n = case.noise_of(&now)?;
    Ok(Search { noise_n, verdict, before, after: now, findings, tried })
}

fn too_little(trial: &Trial, closed: f64) -> Tried {
    Tried {
        effect: trial.effects.first().copied().unwrap_or(Effect::Coulomb),
        delta_bic: trial.delta_bic,
        rms_n: rms_n(&trial.fit),
        reason: format!("it closes {:.0} % of the gap", 100.0 * closed.max(0.0)),
    }
}

/// Sorts the trials, the best first; among equally good ones, that with fewer effects.
fn ranked(mut trials: Vec<Trial>) -> Vec<Trial> {
    let least_n = trials.iter().map(|trial| rms_n(&trial.fit)).fold(f64::INFINITY, f64::min);
    let rank = |trial: &Trial| {
        let is_worse = rms_n(&trial.fit) > AS_GOOD_RATIO * least_n;
        (is_worse, if is_worse { 0 } else { trial.effects.len() })
    };
    trials.sort_by(|one, other| rank(one).cmp(&rank(other)).then(rms_n(&one.fit).total_cmp(&rms_n(&other.fit))));
    trials
}

/// Keeps only those holes as findings whose μ is clearly different from that of the others ([`is_own_mu`]). Beside a named hole, the other holes that
/// entered keep their own μ, because the evidence is that of all. Without a named hole, all share one μ again and no hole is written; their
/// differences may still explain the rest, but the run does not tell which holes differ.
fn clear(case: &Case<'_>, mut now: Fit, mut findings: Vec<Finding>, tried: &mut Vec<Tried>) -> (Fit, Vec<Finding>) {
    let is_hole = |finding: &Finding| matches!(finding.effect, Effect::HoleFriction(_));
    let clearness = holes_clearness(case, &now, &findings);
    if clearness.is_empty() {
        return (now, findings);
    }
    let is_clear = |finding: &Finding| {
        clearness.iter().all(|(hole, clear)| finding.effect != Effect::HoleFriction(*hole) || *clear >= 1.0)
    };
    let (kept, unclear): (Vec<_>, Vec<_>) = findings.into_iter().partition(is_clear);
    findings = kept;
    tried.extend(unclear.into_iter().map(|finding| Tried {
        effect: finding.effect,
        delta_bic: finding.delta_bic,
        rms_n: rms_n(&finding.fit),
        reason: "the μ would have to be off that of the others beyond its 95 % interval and by 30 %".to_owned(),
    }));
    if !findings.iter().any(is_hole)
        && let Some(shared) = with_shared_mu(case, &now.model)
    {
        now = shared;
    }
    (now, findings)
}

/// Returns how clearly each hole found differs from the others, in half widths of the 95 % interval.
fn holes_clearness(case: &Case<'_>, now: &Fit, findings: &[Finding]) -> Vec<(usize, f64)> {
    let given = case.given();
    let covariance = covariance(case, now);
    let clearness = |finding: &Finding| match finding.effect {
        Effect::HoleFriction(hole) => Some((hole, is_own_mu(&given, &now.model, covariance.as_ref(), hole))),
        _ => None,
    };
    findings.iter().filter_map(clearness).collect()
}

/// Returns the fitted model with one μ for all holes, in the proportions of the file.
fn with_shared_mu(case: &Case<'_>, model: &Model) -> Option<Fit> {
    let given = case.given();
    let unit = |hole: usize| given.mu.get(hole).copied().filter(|mu| *mu > 0.0).unwrap_or(1.0);
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let ratio = model.mu.iter().enumerate().map(|(hole, mu)| mu / unit(hole)).sum::<f64>() / model.mu.len() as f64;
    let mu = (0..model.mu.len()).map(|hole| ratio * unit(hole)).collect();
    fitted(case, &Model { mu, is_own: vec![false; model.mu.len()], ..model.clone() })
}
