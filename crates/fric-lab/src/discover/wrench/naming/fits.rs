//! The models that a search has fitted, and the comparison of two of them.

use std::collections::BTreeMap;

use fric_core::effects::Effect;
use fric_core::parameters::MU;
use rayon::prelude::*;

use super::standing::standings;
use super::{LEAST_ALIKE, NEAR_ERRORS, Search, set_of};
use crate::candidates::catalogue::{around, has};
use crate::candidates::ripple::{period_of, periods};
use crate::discover::naming::evidence::delta_bic;
use crate::discover::naming::justification::is_at_end;
use crate::discover::wrench::bench::{Bench, Trial};
use crate::discover::wrench::candidate::Candidate;
use crate::discover::wrench::geometry::Geometry;
use crate::discover::wrench::model::Model;
use crate::discover::wrench::screen::{Promise, promises};
use crate::effects::{self, Around};
use crate::replay::WrenchReference;

/// Number of candidates beside a model that are fitted: those that promise most, and of one kind, such as a gain on different cables, at most so many.
const FITTED: usize = 6;
const FITTED_OF_KIND: usize = 2;

impl Search<'_> {
    /// Returns the model with these candidates. A new set is fitted from the best known model with one candidate more.
    pub(super) fn fit(&mut self, found: &[Candidate]) -> Trial {
        let set = set_of(found);
        if let Some(trial) = self.fits.get(&set) {
            return trial.clone();
        }
        let larger = self
            .fits
            .iter()
            .filter(|(of, _)| of.len() == set.len() + 1 && set.iter().all(|candidate| of.contains(candidate)))
            .min_by(|(_, one), (_, other)| one.training.total_cmp(&other.training));
        let Some((larger, trial)) = larger else { return self.fit(&[]) };
        let mut model = trial.model.clone();
        for candidate in larger.iter().filter(|of| !set.contains(of)) {
            candidate.remove_from(&mut model);
        }
        let trial = self.bench.fit(&model, NEAR_ERRORS);
        self.fits.insert(set, trial.clone());
        trial
    }

    /// Returns the model with one more candidate; `None` if it promises nothing.
    pub(super) fn with(&mut self, found: &[Candidate], candidate: Candidate) -> Option<Trial> {
        self.each_beside(found, &[candidate]).pop().map(|(_, trial)| trial)
    }

    /// Returns the models with one more of the most promising candidates, without those that were set aside.
    pub(super) fn beside(&mut self, found: &[Candidate]) -> Vec<(Candidate, Trial)> {
        let all: Vec<Candidate> = self.promises(found).iter().map(|promise| promise.candidate).collect();
        let mut of_kinds: BTreeMap<&str, usize> = BTreeMap::new();
        let is_first = |candidate: &Candidate| {
            let count = of_kinds.entry(candidate.kind()).or_default();
            *count += 1;
            *count <= FITTED_OF_KIND
        };
        let open = all.into_iter().filter(|candidate| !self.refused.contains_key(candidate));
        let most_promising: Vec<Candidate> = open.filter(is_first).take(FITTED).collect();
        self.each_beside(found, &most_promising)
    }

    /// Returns the models with one more candidate, for each of some that promise anything.
    pub(super) fn each_beside(&mut self, found: &[Candidate], candidates: &[Candidate]) -> Vec<(Candidate, Trial)> {
        let with = |candidate: &Candidate| set_of(&[found, &[*candidate]].concat());
        let unknown: Vec<Candidate> =
            candidates.iter().copied().filter(|candidate| !self.fits.contains_key(&with(candidate))).collect();
        if !unknown.is_empty() {
            let promises = self.promises(found).iter().filter(|promise| unknown.contains(&promise.candidate));
            let new: Vec<Promise> = promises.cloned().collect();
            let fit = |promise: &Promise| {
                let mut trial = self.bench.fit(&promise.model, NEAR_ERRORS);
                if found.is_empty() {
                    // The friction of the model without the candidate may be far from the truth, so the fit also starts from the given friction.
                    let from_given = self.bench.fit(&self.bench.with_given_friction(&promise.model), NEAR_ERRORS);
                    trial = if from_given.training < trial.training { from_given } else { trial };
                }
                (with(&promise.candidate), self.with_period(trial, promise.candidate))
            };
            let fits: Vec<(Vec<Candidate>, Trial)> = new.par_iter().map(fit).collect();
            self.fits.extend(fits);
        }
        candidates.iter().filter_map(|of| Some((*of, self.fits.get(&with(of))?.clone()))).collect()
    }

    /// Returns the model with the period of a new ripple fitted too. The scan that finds a period is coarser than the samples determine it, and another
    /// ripple of the same cable would make up for the difference.
    fn with_period(&self, trial: Trial, candidate: Candidate) -> Trial {
        let Some(period) = candidate.effect().and_then(period_of) else { return trial };
        let mut model = trial.model;
        match candidate {
            Candidate::Own(cable, _) => model.free.iter_mut().skip(cable).take(1).for_each(|free| free.push(period)),
            _ => model.alike.push(period),
        }
        self.bench.fit(&model, NEAR_ERRORS)
    }

    /// Returns what candidates promise beside a model, the best first; without those that promise nothing.
    pub(super) fn promises(&mut self, found: &[Candidate]) -> &[Promise] {
        let set = set_of(found);
        if !self.promised.contains_key(&set) {
            let trial = self.fit(found);
            let around = self.around(&trial, true);
            let model = &trial.model;
            // By the weight alone, gains of all sensors that are wrong alike show as a wrong mass does, which is the likelier cause. If several sensors need
            // gains of their own, the sensors are, and the mass would only take the place of one of these gains.
            let gains = model.values.iter().filter(|values| has(Effect::SensorGain, values)).count();
            let unlikely = match self.bench.description.reference {
                WrenchReference::Mass if gains < LEAST_ALIKE => Some(Candidate::Alike(Effect::SensorGain)),
                WrenchReference::Mass => Some(Candidate::Geometry(Geometry::Mass)),
                WrenchReference::Measured => None,
            };
            // This search names one ripple of each kind on a cable.
            let is_wanted = |candidate: Candidate| {
                !candidate.effect().is_some_and(Effect::is_second)
                    && !candidate.is_in(model)
                    && Some(candidate) != unlikely
                    && !scales_all(&self.bench, model, candidate)
            };
            let mut all = promises(&self.bench, model, &around, is_wanted);
            all.retain(|promise| promise.gain > 0.0);
            self.promised.insert(set.clone(), all);
        }
        self.promised.entry(set).or_default()
    }

    /// Returns the surroundings of each cable from which a search starts, with periods of ripples only if wanted, because their scan takes long.
    fn around(&self, trial: &Trial, with_periods: bool) -> Vec<Around> {
        let deviations = self.bench.deviations(&trial.model);
        let of = |(cable, record)| {
            let residual_n = self.bench.of_cable_n(&trial.model, &deviations, cable);
            let mu = trial.model.values.get(cable).map_or(0.0, |values| values[MU]);
            let mut around = around(record, mu, self.bench.white_noise(residual_n.iter().copied()).unwrap_or(0.0));
            if with_periods {
                around.periods = periods(record, &residual_n);
            }
            around
        };
        self.bench.records.par_iter().enumerate().map(of).collect()
    }

    /// Returns the squared deviations of the held-out samples above the noise, as a fraction of the noise.
    pub(super) fn excess(&self, trial: &Trial) -> f64 {
        trial.held_out / self.held_out_squares(self.noise_square) - 1.0
    }

    /// Returns the sum over the held-out samples of so much in each.
    pub(super) fn held_out_squares(&self, square: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = self.bench.count(true) as f64;
        count * square
    }

    /// Returns the BIC difference from one model to another with `more` additional parameters; a negative value favours the second.
    pub(super) fn delta_bic(&self, from: &Trial, to: &Trial, more: usize, inflation: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (6.0 * self.bench.count(false) as f64 / inflation, more as f64);
        delta_bic(count, to.training / from.training, more) + self.oddity(to) - self.oddity(from)
    }

    /// Returns the evidence against a model that is known before any sample: points and the vertical are seldom far off.
    pub(super) fn oddity(&self, trial: &Trial) -> f64 {
        let of = |(of, numbers): (&Geometry, &Vec<f64>)| {
            let usual = self.bench.description.usual(*of);
            numbers.iter().map(|number| (number / usual).powi(2)).sum::<f64>()
        };
        trial.model.changes.iter().map(of).sum()
    }

    /// Whether a parameter of a candidate is stuck at a bound of its range, or beyond what can be.
    pub(super) fn is_at_end(&self, candidate: Candidate, trial: &Trial) -> bool {
        let cycle_s = self.bench.records.first().map_or(f64::NAN, |record| record.cycle_s);
        let is_at = |cable: usize, effect| {
            trial.model.values.get(cable).is_none_or(|values| is_at_end(effect, values, cycle_s))
        };
        match candidate {
            Candidate::Own(cable, effect) => is_at(cable, effect),
            Candidate::Alike(effect) => is_at(0, effect),
            Candidate::Geometry(of) => self.bench.description.is_at_end(of, &trial.model.changes),
        }
    }

    /// Whether a candidate exceeds what robots without it show, on any cable.
    pub(super) fn is_more_than_usual(&self, candidate: Candidate, trial: &Trial) -> bool {
        let Some(lab) = candidate.effect().and_then(effects::of) else { return true };
        let around = self.around(trial, false);
        let is_more = |cable: usize| {
            let values = trial.model.values.get(cable).zip(around.get(cable));
            values.is_none_or(|(values, around)| (lab.is_more_than_usual)(values, around))
        };
        match candidate {
            Candidate::Own(cable, _) => is_more(cable),
            Candidate::Alike(_) => (0..self.bench.records.len()).any(is_more),
            Candidate::Geometry(_) => true,
        }
    }

    /// Returns the factor by which memory in the deviations weakens the evidence for a candidate of a model.
    pub(super) fn inflation(&self, candidate: Candidate, trial: &Trial) -> f64 {
        standings(&self.bench, trial, &[candidate]).first().map_or(f64::INFINITY, |standing| standing.inflation)
    }
}

/// Whether with a candidate all forces of a model and the weight that they bear could shrink together, and with them all deviations.
pub fn scales_all(bench: &Bench<'_>, model: &Model, candidate: Candidate) -> bool {
    let has_gain = |cable: usize| {
        let own = model.values.get(cable).is_some_and(|values| has(Effect::SensorGain, values));
        own || matches!(candidate, Candidate::Own(of, Effect::SensorGain) if of == cable)
            || candidate == Candidate::Alike(Effect::SensorGain)
    };
    let mass = Geometry::Mass;
    bench.description.reference == WrenchReference::Mass
        && (candidate == Candidate::Geometry(mass) || model.changes.contains_key(&mass))
        && (0..bench.records.len()).all(has_gain)
}
