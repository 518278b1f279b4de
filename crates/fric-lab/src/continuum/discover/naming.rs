//! Which effects are missing: the best candidate enters where it helps on the samples that were held out.

use rayon::prelude::*;

use super::case::{Case, Fit};
use super::fitting::fitted;
use super::model::{Effect, Model};
use crate::continuum::error::ContinuumError;
use crate::continuum::shape_errors::Way;
use crate::discover::Verdict;
use crate::replay::Deviation;

/// Evidence that an effect needs: Schwarz's criterion falls by more.
const LEAST_EVIDENCE: f64 = 10.0;
/// What is within this ratio of the best error is as good.
const AS_GOOD_RATIO: f64 = 1.05;
/// Where the search for μ begins in a model without friction.
const START_MU: f64 = 0.15;
/// Share of the gap that an effect has to close.
const LEAST_SHARE: f64 = 0.2;
/// What counts as noise: an error of the noise's own estimate; that of the gratings' lines, as a share of the standard error of a
/// tension; and what a spread of μ by ±10 % over the holes leaves at usual bends, as a share of the greatest tension.
const NOISE_ERROR_RATIO: f64 = 0.3;
const LINE_ERROR_RATIO: f64 = 0.5;
const TOLERATED_RATIO: f64 = 0.0025;
/// Most effects.
const MOST_EFFECTS: usize = 6;

/// An effect that was found.
#[derive(Clone, Debug)]
pub struct Finding {
    pub effect: Effect,
    /// With it and all before it.
    pub fit: Fit,
    pub delta_bic: f64,
    pub runner_up: Option<(Effect, f64)>,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub noise_n: f64,
    pub verdict: Verdict,
    pub before: Fit,
    pub after: Fit,
    pub findings: Vec<Finding>,
}

/// A candidate with its fit; several effects may belong together.
struct Trial {
    effects: Vec<Effect>,
    fit: Fit,
    delta_bic: f64,
}

/// Searches for what is missing.
///
/// Where something is left, a name is not put on a grating, or on a hole between two, that still disagrees: what is wrong there is
/// something else.
///
/// # Errors
/// [`ContinuumError::UntoldNoise`] where gaps, or a model without shapes, leave nothing that tells the noise.
pub fn name(case: &Case<'_>) -> Result<Outcome, ContinuumError> {
    let mut distrusted = Vec::new();
    loop {
        let outcome = search(case, &distrusted)?;
        let disagrees = |grating: usize| !is_noise_at(case, &outcome.after, outcome.noise_n, grating);
        let is_wrong = |effect: &Effect| match *effect {
            Effect::SensorDrift(grating) => disagrees(grating),
            Effect::HoleFriction(hole) => (hole.saturating_sub(1)..=hole).any(disagrees),
            Effect::Coulomb | Effect::Presliding => false,
        };
        let effects = outcome.findings.iter().map(|finding| finding.effect);
        let wrong: Vec<Effect> = effects.filter(is_wrong).collect();
        if outcome.verdict != Verdict::Unexplained || wrong.is_empty() {
            return Ok(outcome);
        }
        distrusted.extend(wrong);
    }
}

/// Searches among all effects but the distrusted.
fn search(case: &Case<'_>, distrusted: &[Effect]) -> Result<Outcome, ContinuumError> {
    let given = case.given();
    let before = fitted(case, &given).or_else(|| case.fit(&given)).ok_or(ContinuumError::UntoldNoise)?;
    let mut now = before.clone();
    let mut findings: Vec<Finding> = Vec::new();
    let mut noise_n = case.noise_n(&now)?;
    while findings.len() < MOST_EFFECTS && !is_noise(case, &now, noise_n) {
        let mut trials = trials(case, &now, distrusted);
        let gap_n = excess_n(&now, noise_n);
        let helps = |trial: &Trial| {
            trial.delta_bic < -LEAST_EVIDENCE && excess_n(&trial.fit, noise_n) < (1.0 - LEAST_SHARE) * gap_n
        };
        // Of those that are as good, the one with fewer effects.
        let least_n = trials.iter().map(|trial| rms_n(&trial.fit)).fold(f64::INFINITY, f64::min);
        let rank = |trial: &Trial| {
            let is_worse = rms_n(&trial.fit) > AS_GOOD_RATIO * least_n;
            (is_worse, if is_worse { 0 } else { trial.effects.len() })
        };
        trials.sort_by(|one, other| rank(one).cmp(&rank(other)).then(rms_n(&one.fit).total_cmp(&rms_n(&other.fit))));
        let mut trials = trials.into_iter();
        let Some(best) = trials.next().filter(helps) else { break };
        let runner_up = trials
            .find(|trial| trial.effects != best.effects)
            .and_then(|trial| Some((*trial.effects.last()?, trial.delta_bic)));
        for effect in best.effects {
            findings.push(Finding { effect, fit: best.fit.clone(), delta_bic: best.delta_bic, runner_up });
        }
        now = best.fit;
        noise_n = case.noise_n(&now)?;
    }
    if !is_noise(case, &now, noise_n) {
        // A name for less than what is left would be a guess.
        let left_n = excess_n(&now, noise_n);
        while let Some(last) = findings.last() {
            let earlier = findings.iter().rev().find(|other| other.fit.model != last.fit.model);
            let earlier = earlier.map_or(&before, |other| &other.fit);
            if excess_n(earlier, noise_n).powi(2) >= 2.0 * left_n * left_n {
                break;
            }
            now = earlier.clone();
            let model = last.fit.model.clone();
            findings.retain(|finding| finding.fit.model != model);
        }
    }
    let verdict = match (findings.is_empty(), is_noise(case, &now, noise_n)) {
        (true, true) => Verdict::Complete,
        (false, true) => Verdict::Extended,
        (_, false) => Verdict::Unexplained,
    };
    Ok(Outcome { noise_n, verdict, before, after: now, findings })
}

pub fn rms_n(fit: &Fit) -> f64 {
    fit.held_out_n.rms().unwrap_or(f64::INFINITY)
}

/// What a residual has above the noise, root mean square.
pub fn excess_n(fit: &Fit, noise_n: f64) -> f64 {
    let rms_n = rms_n(fit);
    (rms_n * rms_n - noise_n * noise_n).max(0.0).sqrt()
}

fn is_noise(case: &Case<'_>, fit: &Fit, noise_n: f64) -> bool {
    excess_n(fit, noise_n) <= noise_excess_n(case, noise_n)
}

/// What counts as noise above the noise, N.
fn noise_excess_n(case: &Case<'_>, noise_n: f64) -> f64 {
    let tolerated_n = (TOLERATED_RATIO * case.greatest_n).hypot(LINE_ERROR_RATIO * case.standard_error_n);
    tolerated_n.hypot(NOISE_ERROR_RATIO * noise_n)
}

/// Whether one grating, from 0, has noise left alone; it may have twice as much of it as all have in the mean.
fn is_noise_at(case: &Case<'_>, fit: &Fit, noise_n: f64, grating: usize) -> bool {
    let mut left_n = Deviation::default();
    for (row, _) in fit.residual_n.iter().zip(&case.held_out).filter(|(_, held_out)| **held_out) {
        row.get(grating).into_iter().for_each(|residual_n| left_n.add(*residual_n));
    }
    let rms_n = left_n.rms().unwrap_or(0.0);
    rms_n * rms_n - noise_n * noise_n <= (2.0 * noise_excess_n(case, noise_n)).powi(2)
}

/// Whether what a grating shows goes with the time rather than with its tension: a line of it that is wrong in slope and offset, which is
/// no effect of the catalogue, must not account for it as well as a drift does.
fn is_told_from_line(case: &Case<'_>, fit: &Fit, grating: usize) -> bool {
    let Some(start_s) = case.samples.first().map(|sample| sample.time_s) else { return false };
    let drift_n_per_s = fit.model.drift_n_per_s.get(grating).copied().unwrap_or(0.0);
    // What the drift leaves, the tension, and what there is without the drift.
    let learned = fit.residual_n.iter().zip(&case.observed_n).zip(case.samples.iter().zip(&case.held_out));
    let points: Vec<[f64; 3]> = learned
        .filter(|(_, (_, held_out))| !**held_out)
        .filter_map(|((row, observed_n), (sample, _))| {
            let (left_n, tension_n) = (*row.get(grating)?, *observed_n.get(grating)?);
            left_n.is_finite().then_some([left_n, tension_n, left_n + drift_n_per_s * (sample.time_s - start_s)])
        })
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = points.len() as f64;
    let mean = |column: usize| points.iter().map(|point| point[column]).sum::<f64>() / count;
    let (mean_tension_n, mean_shown_n) = (mean(1), mean(2));
    let product = |of: &dyn Fn(f64, f64) -> f64| {
        points.iter().map(|[_, tension_n, shown_n]| of(tension_n - mean_tension_n, shown_n - mean_shown_n)).sum::<f64>()
    };
    let (tension, common, shown) = (product(&|x, _| x * x), product(&|x, y| x * y), product(&|_, y| y * y));
    let of_line = if tension > 0.0 { shown - common * common / tension } else { shown };
    let of_drift: f64 = points.iter().map(|[left_n, ..]| left_n * left_n).sum();
    // The line has a number more.
    count * (of_line / of_drift).ln() + count.ln() > LEAST_EVIDENCE
}

/// All candidates beside what is there but the distrusted, each fitted to what is learned from.
fn trials(case: &Case<'_>, now: &Fit, distrusted: &[Effect]) -> Vec<Trial> {
    let model = &now.model;
    let count = model.mu.len();
    let mut candidates: Vec<(Vec<Effect>, Model)> = Vec::new();
    match model.way {
        Way::None => {
            let rubbing = |way: Way| Model { way, mu: vec![START_MU; count], ..model.clone() };
            candidates.push((vec![Effect::Coulomb], rubbing(Way::Coulomb)));
            candidates.push((vec![Effect::Coulomb, Effect::Presliding], rubbing(Way::History)));
        }
        Way::Coulomb => candidates.push((vec![Effect::Presliding], Model { way: Way::History, ..model.clone() })),
        Way::Measured | Way::History => {}
    }
    for place in 0..count {
        if model.drifts.get(place) == Some(&false) {
            candidates.push((vec![Effect::SensorDrift(place)], model.with_drift(place)));
        }
        if model.way != Way::None && model.is_own.get(place) == Some(&false) {
            candidates.push((vec![Effect::HoleFriction(place)], model.with_hole(place)));
        }
    }
    candidates.retain(|(effects, _)| effects.iter().all(|effect| !distrusted.contains(effect)));
    let learned = case.learned_count();
    let trial = |(effects, model): (Vec<Effect>, Model)| {
        let fit = fitted(case, &model)?;
        if let [Effect::SensorDrift(grating)] = effects[..]
            && !is_told_from_line(case, &fit, grating)
        {
            return None;
        }
        let delta_bic = learned * (fit.squares / now.squares).ln() + learned.ln();
        Some(Trial { effects, fit, delta_bic })
    };
    candidates.into_par_iter().filter_map(trial).collect()
}
