//! Which effects are missing: the best candidate enters where it helps on the samples that were held out.

use rayon::prelude::*;

use super::case::{Case, Fit};
use super::fitting::fitted;
use super::model::{Effect, Model};
use crate::continuum::shape_errors::Way;
use crate::discover::Verdict;

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
pub fn name(case: &Case<'_>) -> Outcome {
    let given = case.given();
    let before = fitted(case, &given).or_else(|| case.fit(&given)).unwrap_or_else(|| nothing(&given));
    let mut now = before.clone();
    let mut findings: Vec<Finding> = Vec::new();
    let mut noise_n = case.noise_n(&now);
    while findings.len() < MOST_EFFECTS && !is_noise(case, &now, noise_n) {
        let mut trials = trials(case, &now);
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
        noise_n = case.noise_n(&now);
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
    Outcome { noise_n, verdict, before, after: now, findings }
}

/// A run that no model fits, such as one without any live grating.
fn nothing(model: &Model) -> Fit {
    Fit { model: model.clone(), residual_n: Vec::new(), squares: 0.0, held_out_n: crate::replay::Deviation::default() }
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
    let tolerated_n = (TOLERATED_RATIO * case.greatest_n).hypot(LINE_ERROR_RATIO * case.standard_error_n);
    excess_n(fit, noise_n) <= tolerated_n.hypot(NOISE_ERROR_RATIO * noise_n)
}

/// All candidates beside what is there, each fitted to what is learned from.
fn trials(case: &Case<'_>, now: &Fit) -> Vec<Trial> {
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
    let learned = case.learned_count();
    let trial = |(effects, model): (Vec<Effect>, Model)| {
        let fit = fitted(case, &model)?;
        let delta_bic = learned * (fit.squares / now.squares).ln() + learned.ln();
        Some(Trial { effects, fit, delta_bic })
    };
    candidates.into_par_iter().filter_map(trial).collect()
}
