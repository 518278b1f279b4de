//! Rules by which effects take each other's place.

use fric_core::effects::Effect;

use super::Search;
use super::evidence::inflation;
use super::justification::is_at_end;
use crate::candidates::catalogue::fitted;
use crate::discover::workbench::Trial;

/// A rival that leaves less than this fraction of the noise's squares makes less of the noise, not of the error: a gain of 0.7 and less.
const LEAST_NOISE_RATIO: f64 = 0.5;

impl Search<'_, '_> {
    /// Tries every other effect in the place of each effect. Returns whether one was better.
    pub(super) fn exchange(&mut self, found: &mut [Effect]) -> bool {
        let mut is_changed = false;
        for place in 0..found.len() {
            if self.is_spent(found) {
                break;
            }
            let Some((other, trial)) = self.alternative(found, place) else { continue };
            let model = self.fit(found);
            let is_better = trial.training < model.training && trial.held_out < model.held_out;
            // More parameters fit a little better anyway.
            let memory = inflation(self.bench, &trial, &fitted(other));
            if !self.refused.contains_key(&other) && is_better && self.delta_bic(&model, &trial, memory) < 0.0 {
                found[place] = other;
                is_changed = true;
            }
        }
        self.renumber(found);
        is_changed
    }

    /// Returns the best other effect in the place of one. Friction that every model has is not replaced.
    pub(super) fn alternative(&mut self, found: &[Effect], place: usize) -> Option<(Effect, Trial)> {
        let effect = *found.get(place)?;
        if effect.is_friction() {
            return None;
        }
        let others: Vec<Effect> = found.iter().copied().filter(|other| *other != effect).collect();
        let without = self.fit(&others);
        // An effect that the log cannot distinguish from it is another name for it.
        let beyond = self.beyond_the_log(found);
        let mut rivals = self.round(&others);
        let cycle_s = self.bench.record.cycle_s;
        rivals.retain(|(other, trial)| {
            let is_refused = !beyond.contains_key(other) && self.refused.contains_key(other);
            // Under one load a gain of nearly nothing agrees with it, and makes less of the noise too.
            let is_trivial = trial.held_out < LEAST_NOISE_RATIO * self.noise_squares;
            *other != effect && !is_refused && !is_trivial && !is_at_end(*other, &trial.values, cycle_s)
        });
        let memory = inflation(self.bench, &self.fit(found), &fitted(effect));
        let evidence = |(_, trial): &(Effect, Trial)| self.delta_bic(&without, trial, memory);
        let squares = |(_, trial): &(Effect, Trial)| trial.training;
        rivals.into_iter().min_by(|one, other| {
            evidence(one).total_cmp(&evidence(other)).then(squares(one).total_cmp(&squares(other)))
        })
    }
}
