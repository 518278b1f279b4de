//! Candidates that help and are not named.

use fric_core::effects::Effect;

use super::evidence::inflation;
use super::fits::gains;
use super::justification::is_at_end;
use super::{NEGLIGIBLE, Refusal, STRONG_BIC, Search, Tried};
use crate::candidates::catalogue::fitted;
use crate::discover::rest::WORTH;

/// An effect takes the rest if it removes all but this fraction of it, or all but noise. Of the differences between the common laws of friction, an asymmetry
/// leaves 0.006; half and double give the same answers.
const NEARLY: f64 = 0.05;

impl Search<'_, '_> {
    /// Returns the candidates that help a model but do not suffice, the best first. Where only the error of the noise's estimate leaves room for them,
    /// these are the candidates with strong evidence.
    pub(super) fn tried(&mut self, found: &[Effect]) -> Vec<Tried> {
        let model = self.fit(found);
        let excess = self.excess(&model);
        if excess <= NEGLIGIBLE - self.noise_error {
            return Vec::new();
        }
        let is_within_noise = excess <= NEGLIGIBLE;
        let least_evidence = if is_within_noise { -STRONG_BIC } else { 0.0 };
        let (enough, cycle_s) = (self.least_gain(&model), self.bench.record.cycle_s);
        let mut tried: Vec<Tried> = self
            .round(found)
            .into_iter()
            .filter(|(_, trial)| trial.held_out < model.held_out && trial.training < model.training)
            .map(|(effect, trial)| {
                let inflation = inflation(self.bench, &trial, &fitted(effect));
                let refusal = if is_at_end(effect, &trial.values, cycle_s) {
                    Refusal::AtBound
                } else if let Some(refusal) = self.refused.get(&effect) {
                    *refusal
                } else if self.delta_bic(&model, &trial, inflation) >= -STRONG_BIC {
                    Refusal::Weak
                } else if !gains(&model, &trial, enough) {
                    Refusal::Small
                } else if is_within_noise {
                    Refusal::WithinNoise
                } else {
                    Refusal::Unjudged
                };
                let takes_rest = self.excess(&trial) <= WORTH.max(NEARLY * excess);
                Tried { effect, trial, inflation, refusal, takes_rest }
            })
            .filter(|tried| self.delta_bic(&model, &tried.trial, tried.inflation) < least_evidence)
            .collect();
        if !is_within_noise
            && let Some(hidden) = self.hidden_lag(found)
            && hidden.trial.training < model.training
            && hidden.trial.held_out < model.held_out
        {
            tried.retain(|tried| tried.effect != hidden.effect);
            tried.push(hidden);
        }
        let evidence = |tried: &Tried| self.delta_bic(&model, &tried.trial, tried.inflation);
        tried.sort_by(|one, other| evidence(one).total_cmp(&evidence(other)));
        tried
    }
}
