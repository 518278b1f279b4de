//! Rules by which candidates enter a model.

use fric_core::effects::Effect;

use super::evidence::{delta_bic, inflation};
use super::fits::gains;
use super::justification::is_at_end;
use super::projection::{Columns, less_projection};
use super::{NEGLIGIBLE, STRONG_BIC, Search};
use crate::candidates::catalogue::fitted;
use crate::discover::workbench::Trial;

/// Maximum number of effects per cable.
const MOST_EFFECTS: usize = 8;

/// A candidate with evidence in its favour.
struct Entrant {
    effect: Effect,
    trial: Trial,
    /// Factor by which memory in the residual weakens the evidence, at least 1.
    inflation: f64,
    delta_bic: f64,
}

impl Search<'_, '_> {
    /// Adds candidates as long as they help, except those that were refused: the best one with strong evidence, or, if none has strong evidence
    /// alone, those that have it together.
    pub(super) fn enter(&mut self, found: &mut Vec<Effect>) {
        while found.len() < MOST_EFFECTS && !self.is_spent(found) {
            let model = self.fit(found);
            if self.excess(&model) <= NEGLIGIBLE {
                break;
            }
            let enough = self.least_gain(&model);
            let candidates = self.round(found);
            let cycle_s = self.bench.record.cycle_s;
            let may_enter = |(effect, trial): &(Effect, Trial)| {
                !self.refused.contains_key(effect)
                    && gains(&model, trial, enough)
                    && !is_at_end(*effect, &trial.values, cycle_s)
            };
            let mut entrants: Vec<(Effect, Trial)> = candidates.into_iter().filter(may_enter).collect();
            entrants.sort_by(|(_, one), (_, other)| one.training.total_cmp(&other.training));
            let mut entrants: Vec<Entrant> = entrants
                .into_iter()
                .map(|(effect, trial)| {
                    let inflation = inflation(self.bench, &trial, &fitted(effect));
                    Entrant { effect, delta_bic: self.delta_bic(&model, &trial, inflation), inflation, trial }
                })
                // Apparent evidence that comes only from the memory of the residual is no reason to continue.
                .filter(|entrant| entrant.delta_bic < 0.0)
                .collect();
            // The best is the one with the most evidence for its number of parameters, whatever the memory: one for all, that of the best fit.
            let memory = entrants.first().map_or(1.0, |best| best.inflation);
            let evidence = |entrant: &Entrant| self.delta_bic(&model, &entrant.trial, memory);
            entrants.sort_by(|one, other| evidence(one).total_cmp(&evidence(other)));
            // Of friction every model has its own: what is still missing of it hides the evidence for the rest.
            let enters = |entrant: &&Entrant| entrant.delta_bic < -STRONG_BIC || entrant.effect.is_friction();
            let entering = match entrants.iter().find(enters) {
                Some(entrant) => vec![entrant.effect],
                None => self.strong_together(&model, &entrants),
            };
            if entering.is_empty() {
                break;
            }
            self.add(found, &entering);
        }
    }

    /// Returns those candidates that each have strong evidence beside the others, estimated by linear steps from the model.
    fn strong_together(&self, model: &Trial, entrants: &[Entrant]) -> Vec<Effect> {
        let problem = self.bench.problem(&model.free, None);
        let mut residual_n = self.bench.residuals_n(&model.values);
        for (residual_n, _) in residual_n.iter_mut().zip(&problem.used).filter(|(_, used)| !**used) {
            *residual_n = f64::NAN;
        }
        let adds = |entrant: &Entrant| -> Vec<f64> {
            let with_n = self.bench.residuals_n(&entrant.trial.values);
            with_n.iter().zip(&residual_n).map(|(with, without)| with - without).collect()
        };
        let signals: Vec<Vec<f64>> = entrants.iter().map(adds).collect();
        let Some(columns) = less_projection(&problem, &model.values, &signals) else { return Vec::new() };
        let columns = Columns::new(&columns, 0, &residual_n);
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let evidence = |place: usize, all: &[usize]| {
            let others: Vec<usize> = all.iter().copied().filter(|other| *other != place).collect();
            let [with, without] = [all, &others].map(|places| model.training - columns.gain(places));
            let more = fitted(entrants[place].effect).len() as f64;
            delta_bic(self.bench.count(false) as f64 / entrants[place].inflation, with / without, more)
        };
        let mut places: Vec<usize> = (0..entrants.len()).collect();
        while places.len() > 1 {
            let each = places.iter().map(|place| (evidence(*place, &places), *place));
            let Some((delta_bic, weakest)) = each.max_by(|one, other| one.0.total_cmp(&other.0)) else { break };
            if delta_bic < -STRONG_BIC {
                return places.iter().map(|place| entrants[*place].effect).collect();
            }
            places.retain(|place| *place != weakest);
        }
        Vec::new()
    }

    /// Adds effects to a model one after the other, each from its own start values.
    pub(super) fn add(&mut self, found: &mut Vec<Effect>, effects: &[Effect]) {
        for effect in effects {
            self.beside(found, &[*effect]);
            found.push(*effect);
        }
    }
}
