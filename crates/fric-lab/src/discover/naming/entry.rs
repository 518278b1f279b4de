//! Rules by which candidates enter a model.

use fric_core::effects::Effect;

use super::evidence::inflation;
use super::fits::gains;
use super::justification::is_at_end;
use super::{NEGLIGIBLE, STRONG_BIC, Search};
use crate::candidates::catalogue::fitted;
use crate::discover::workbench::Trial;

/// Maximum number of effects per cable.
pub(super) const MOST_EFFECTS: usize = 8;
/// Number of candidates that still get a turn once the work of a search is spent. On a log with a wrong zero beside a piece of cable that rubs, one suffices.
pub(super) const LAST_TURNS: usize = 4;

/// A candidate with evidence in its favour.
struct Entrant {
    effect: Effect,
    trial: Trial,
    /// Factor by which memory in the residual weakens the evidence, at least 1.
    inflation: f64,
}

impl Search<'_, '_> {
    /// Adds candidates as long as they help, except those that were refused: the best one with strong evidence.
    pub(super) fn enter(&mut self, found: &mut Vec<Effect>) {
        while found.len() < MOST_EFFECTS {
            if self.is_spent(found) {
                // The candidates beside what is found have been fitted, or will be for those that are told as tried. The best of them get their turn though the
                // search has spent its work on others.
                let Some(left) = self.last_turns.checked_sub(1) else { break };
                self.last_turns = left;
            }
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
                .map(|(effect, trial)| Entrant {
                    inflation: inflation(self.bench, &trial, &fitted(effect)),
                    effect,
                    trial,
                })
                .collect();
            // The best is the one with the most evidence for its number of parameters, whatever the memory: one for all, that of the best fit.
            let memory = entrants.first().map_or(1.0, |best| best.inflation);
            let evidence = |entrant: &Entrant| self.delta_bic(&model, &entrant.trial, memory);
            entrants.sort_by(|one, other| evidence(one).total_cmp(&evidence(other)));
            let enters = |entrant: &&Entrant| {
                let delta_bic = self.delta_bic(&model, &entrant.trial, entrant.inflation);
                // Of friction every model has its own: what is still missing of it hides the evidence for the rest. Apparent evidence that comes only
                // from the memory of the residual is no reason to continue.
                delta_bic < -STRONG_BIC || entrant.effect.is_friction() && delta_bic < 0.0
            };
            let Some(effect) = entrants.iter().find(enters).map(|entrant| entrant.effect) else { break };
            self.add(found, &[effect]);
        }
    }

    /// Adds effects to a model one after the other, each from its own start values.
    pub(super) fn add(&mut self, found: &mut Vec<Effect>, effects: &[Effect]) {
        for effect in effects {
            self.beside(found, &[*effect]);
            found.push(*effect);
        }
    }
}
