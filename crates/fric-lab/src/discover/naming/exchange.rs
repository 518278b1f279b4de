//! Rules by which effects take each other's place.

use fric_core::effects::Effect;

use super::evidence::inflation;
use super::justification::is_at_end;
use super::one_load::as_loud_as;
use super::{NEGLIGIBLE, STRONG_BIC, Search};
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

    /// Tries the best other effect in the place of each effect together with those that are superfluous beside it. Returns whether one took the place of
    /// several. It may be one that the log cannot tell from the single effect: under a hanging weight that is accelerated a little, a gain is the zero and the
    /// inertia that make up for it.
    pub(super) fn gather(&mut self, found: &mut Vec<Effect>) -> bool {
        for place in 0..found.len() {
            if found.iter().filter(|effect| !effect.is_friction()).count() < 2 || self.is_spent(found) {
                return false;
            }
            let Some((other, _)) = self.alternative(found, place) else { continue };
            let model = self.fit(found);
            let agrees = |trial: &Trial| trial.held_out <= (1.0 + NEGLIGIBLE) * model.held_out;
            let mut one = found.clone();
            one[place] = other;
            // Nothing that is left out makes it better.
            if !agrees(&as_loud_as(&model, self.fit(&one))) {
                continue;
            }
            self.drop_superfluous(&mut one, other);
            let trial = as_loud_as(&model, self.fit(&one));
            let memory = inflation(self.bench, &model, &model.free);
            if one.len() < found.len()
                && agrees(&trial)
                && self.delta_bic(&model, &trial, memory) < 0.0
                && self.justified(&one).iter().all(|named| named.refusal.is_none())
            {
                self.refused.remove(&other);
                *found = one;
                self.renumber(found);
                return true;
            }
        }
        false
    }

    /// Leaves out the effects for which there is no strong evidence beside a new one, the weakest first. Friction stays.
    fn drop_superfluous(&mut self, found: &mut Vec<Effect>, new: Effect) {
        loop {
            let model = self.fit(found);
            let mut weakest: Option<(f64, usize)> = None;
            for place in (0..found.len()).filter(|place| found[*place] != new && !found[*place].is_friction()) {
                let effect = found[place];
                let others: Vec<Effect> = found.iter().copied().filter(|of| *of != effect).collect();
                let without = self.fit(&others);
                let memory = inflation(self.bench, &model, &fitted(effect));
                let evidence = self.delta_bic(&without, &model, memory);
                if evidence >= -STRONG_BIC && weakest.is_none_or(|(most, _)| evidence > most) {
                    weakest = Some((evidence, place));
                }
            }
            let Some((_, place)) = weakest else { return };
            found.remove(place);
        }
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
