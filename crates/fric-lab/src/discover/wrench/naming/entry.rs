//! How candidates enter a model, on one cable, on some, or on all alike.

use fric_core::effects::Effect;

use super::fits::scales_all;
use super::standing::standings;
use super::{LEAST_ALIKE, MOST, NEAR_ERRORS, Search, set_of};
use crate::candidates::catalogue::{fitted, has};
use crate::discover::naming::{LEAST_GAIN, LEAST_SIZE, NEGLIGIBLE, Refusal, STRONG_BIC};
use crate::discover::wrench::bench::Trial;
use crate::discover::wrench::candidate::Candidate;
use crate::fit::Parameter;

impl Search<'_> {
    /// Adds candidates as long as they help, each time the one with the most evidence.
    pub(super) fn enter(&mut self, found: &mut Vec<Candidate>) {
        while found.len() < MOST {
            let trial = self.fit(found);
            if self.excess(&trial) <= NEGLIGIBLE || self.is_spent(found) {
                break;
            }
            let enough = self.least_gain(&trial);
            let mut entrants = self.beside(found);
            entrants.retain(|(candidate, with)| {
                trial.held_out - with.held_out > enough
                    && !self.is_at_end(*candidate, with)
                    && self.is_more_than_usual(*candidate, with)
            });
            let cost = |(candidate, with): &(Candidate, Trial)| self.delta_bic(&trial, with, candidate.count(), 1.0);
            entrants.sort_by(|one, other| cost(one).total_cmp(&cost(other)));
            let has_evidence = |(candidate, with): &&(Candidate, Trial)| {
                let inflation = self.inflation(*candidate, with);
                // As on one cable, apparent evidence that comes only from the memory of the deviations is no reason to continue, but for friction.
                let enough = if candidate.effect().is_some_and(Effect::is_friction) { 0.0 } else { -STRONG_BIC };
                self.delta_bic(&trial, with, candidate.count(), inflation) < enough
            };
            let Some((candidate, _)) = entrants.iter().find(has_evidence) else { break };
            found.push(*candidate);
            self.spread(found, *candidate);
        }
    }

    /// Returns the decrease of the held-out squares that a candidate needs to enter.
    pub(super) fn least_gain(&self, trial: &Trial) -> f64 {
        let noise = self.held_out_squares(self.noise_square);
        (LEAST_GAIN * (trial.held_out - noise)).max(LEAST_SIZE * noise)
    }

    /// Replaces the same effect on several cables by one with the same parameters on all cables, if that explains as much with fewer parameters.
    pub(super) fn unite(&mut self, found: &mut Vec<Candidate>) {
        for effect in Effect::ALL.iter().copied() {
            let is_own = |of: &Candidate| matches!(of, Candidate::Own(_, own) if *own == effect);
            let count = found.iter().filter(|of| is_own(of)).count();
            let candidate = Candidate::Alike(effect);
            if count < LEAST_ALIKE || self.refused.contains_key(&candidate) {
                continue;
            }
            let others: Vec<Candidate> = found.iter().copied().filter(|of| !is_own(of)).collect();
            let (apart, Some(alike)) = (self.fit(found), self.with(&others, candidate)) else { continue };
            let saved = candidate.count() * (count - 1);
            if self.delta_bic(&alike, &apart, saved, 1.0) > 0.0 {
                *found = others;
                found.push(candidate);
            }
        }
    }

    /// Gives each cable its own parameters of the effects that all cables have alike, where cables differ.
    pub(super) fn take_apart(&mut self, found: &mut Vec<Candidate>) {
        for candidate in found.clone() {
            if matches!(candidate, Candidate::Alike(_)) {
                self.spread(found, candidate);
            }
        }
    }

    /// Gives each cable its own parameters of an effect that one cable has or all cables have alike, if the evidence for that is
    /// strong. Cables that do not need the effect lose it when names leave. If they got it one by one, another effect would enter before.
    fn spread(&mut self, found: &mut Vec<Candidate>, candidate: Candidate) {
        let Some(effect) = candidate.effect() else { return };
        if (0..self.bench.records.len()).all(|cable| found.contains(&Candidate::Own(cable, effect))) {
            return;
        }
        let Some((each, apart)) = self.apart(found, effect) else { return };
        let others: Vec<Candidate> = found.iter().copied().filter(|of| of.effect() != Some(effect)).collect();
        if self.enters(found, others, each, apart) && matches!(candidate, Candidate::Alike(_)) {
            self.refused.insert(candidate, Refusal::Unsteady("cable"));
        }
    }

    /// Returns the effect as a candidate of each cable with its own parameters, and the model with these instead of the names of that effect; `None` if
    /// the effect promises nothing on some cable.
    pub(super) fn apart(&mut self, found: &[Candidate], effect: Effect) -> Option<(Vec<Candidate>, Trial)> {
        let mut model = self.fit(found).model;
        if scales_all(&self.bench, &model, Candidate::Alike(effect)) {
            return None;
        }
        let others: Vec<Candidate> = found.iter().copied().filter(|of| of.effect() != Some(effect)).collect();
        model.alike.retain(|of| of.effect() != Some(effect));
        let each: Vec<Candidate> = (0..self.bench.records.len()).map(|cable| Candidate::Own(cable, effect)).collect();
        for (cable, of_cable) in each.iter().enumerate() {
            if !has(effect, &model.values[cable]) {
                let promise = self.promises(&others).iter().find(|promise| promise.candidate == *of_cable).cloned()?;
                for place in Parameter::of(effect).map(|of| of.place()) {
                    model.values[cable][place] = promise.model.values[cable][place];
                }
            }
            let free = &mut model.free[cable];
            let missing: Vec<Parameter> = fitted(effect).into_iter().filter(|of| !free.contains(of)).collect();
            free.extend(missing);
        }
        Some((each, self.bench.fit(&model, NEAR_ERRORS)))
    }

    /// Puts effects of each cable in the place of others if the evidence for the model with them is strong. Returns whether it did.
    fn enters(
        &mut self,
        found: &mut Vec<Candidate>,
        others: Vec<Candidate>,
        each: Vec<Candidate>,
        apart: Trial,
    ) -> bool {
        let trial = self.fit(found);
        let more = apart.model.unknowns().len().saturating_sub(trial.model.unknowns().len());
        let standings = standings(&self.bench, &apart, &each);
        let inflation = standings.iter().map(|standing| standing.inflation).fold(1.0, f64::max);
        let enters = apart.held_out < trial.held_out && self.delta_bic(&trial, &apart, more, inflation) < -STRONG_BIC;
        if enters {
            *found = others;
            found.extend(each);
            self.fits.insert(set_of(found), apart);
        }
        enters
    }
}
