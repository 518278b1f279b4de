//! Fits candidates beside a model to the training samples.

use rayon::prelude::*;

use super::fitting::{HoleSlopes, fitted, fitted_from};
use super::model::{Effect, Model};
use super::naming::LEAST_EVIDENCE;
use crate::discover::case::{Case, Fit};
use crate::shape_errors::Way;

/// Start value of μ in a model without friction.
const START_MU: f64 = 0.15;

/// A candidate with its fit; several effects may belong together.
pub struct Trial {
    pub effects: Vec<Effect>,
    pub fit: Fit,
    pub delta_bic: f64,
}

impl Trial {
    /// Whether it gives all holes their own μ.
    pub fn is_spread(&self) -> bool {
        matches!(self.effects[..], [Effect::HoleFriction(_), _, ..])
    }
}

/// Whether a grating's error correlates with the time rather than with its tension: a wrong calibration line (slope and offset), which is no effect
/// of the catalogue, must not explain it as well as a drift.
fn is_told_from_line(case: &Case<'_>, fit: &Fit, grating: usize) -> bool {
    let Some(start_s) = case.samples.first().map(|sample| sample.time_s) else { return false };
    let drift_n_per_s = fit.model.drift_n_per_s.get(grating).copied().unwrap_or(0.0);
    // The residual with the drift, the tension, and the residual without the drift.
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
    // The line has one more parameter.
    count * (of_line / of_drift).ln() + count.ln() > LEAST_EVIDENCE
}

/// Returns all candidates beside the present model except the distrusted ones, each fitted to the training samples.
pub fn trials(case: &Case<'_>, now: &Fit, distrusted: &[Effect]) -> Vec<Trial> {
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
            candidates.push((vec![Effect::HoleFriction(place)], model.with_holes(&[place])));
        }
    }
    // A spread over the holes, because none of them alone closes much of the gap.
    let holes: Vec<usize> = (0..count)
        .filter(|hole| model.is_own.get(*hole) == Some(&false) && !distrusted.contains(&Effect::HoleFriction(*hole)))
        .collect();
    if model.way != Way::None && holes.len() > 1 {
        candidates.push((holes.iter().copied().map(Effect::HoleFriction).collect(), model.with_holes(&holes)));
    }
    candidates.retain(|(effects, _)| effects.iter().all(|effect| !distrusted.contains(effect)));
    let learned = case.learned_count();
    let Some(by_hole) = HoleSlopes::new(case, now) else { return Vec::new() };
    let trial = |(effects, candidate): (Vec<Effect>, Model)| {
        // Candidates with the same friction model start from the present tensions and residuals.
        let fit = if candidate.way == model.way {
            fitted_from(case, Fit { model: candidate, ..now.clone() }, &by_hole)?
        } else {
            fitted(case, &candidate)?
        };
        if let [Effect::SensorDrift(grating)] = effects[..]
            && !is_told_from_line(case, &fit, grating)
        {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let more = fit.model.parameters().len().saturating_sub(now.model.parameters().len()).max(1) as f64;
        let delta_bic = learned * (fit.squares / now.squares).ln() + more * learned.ln();
        Some(Trial { effects, fit, delta_bic })
    };
    candidates.into_par_iter().filter_map(trial).collect()
}
