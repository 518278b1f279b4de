//! Which effects are missing, and on which cables: candidates enter, justify themselves and are exchanged, all cables jointly.
//!
//! The rules are those of the search on a cable with a reference force: who enters helps on samples learned from and on those held out; who stays
//! has strong evidence, is large enough to matter, is within its range and helps beyond a single block. Two come on top. An effect that all cables
//! have alike costs its parameters once, and has to be taken apart where cables differ. And what is wrong about the description of the robot is
//! a candidate like an effect, or it would come out as one.

use std::collections::BTreeMap;

use fric_core::effects::Effect;
use fric_core::parameters::MU;
use nalgebra::DVector;
use rayon::prelude::*;

use super::bench::{Bench, Model, Trial, Unknown};
use super::geometry::Geometry;
use super::screen::{Candidate, Promise, promises};
use crate::candidates::catalogue::{around, fitted, has};
use crate::candidates::ripple::periods;
use crate::certainty::undetermined::inverse_of_normal;
use crate::discover::naming::evidence::delta_bic;
use crate::discover::naming::justification::is_at_end;
use crate::discover::naming::{LEAST_GAIN, LEAST_SIZE, NEGLIGIBLE, Refusal, STRONG_BIC};
use crate::effects::{self, Around};
use crate::fit::Parameter;
use crate::replay::WrenchReference;

/// Candidates that are fitted of those that promise most.
const FITTED: usize = 6;
/// Most names.
const MOST: usize = 16;
/// How near to its minimum a candidate comes, in standard errors.
const NEAR_ERRORS: f64 = 0.5;
/// What was found is away from its neutral value by so many standard errors.
const LEAST_AWAY: f64 = 4.0;
/// By how much the gains of all sensors are off alike.
const USUAL_GAIN: f64 = 0.02;
/// Rounds of entering, leaving and exchanging.
const ROUNDS: usize = 6;

/// A name with what speaks for it.
#[derive(Clone, Debug)]
pub struct Named {
    pub candidate: Candidate,
    pub delta_bic: f64,
    /// The best other one in its place, with its evidence; and whether it is as good.
    pub runner_up: Option<(Candidate, f64, bool)>,
}

/// A candidate that helps and does not suffice.
#[derive(Clone, Debug)]
pub struct Tried {
    pub candidate: Candidate,
    pub delta_bic: f64,
    pub refusal: Refusal,
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Naming {
    pub trial: Trial,
    pub named: Vec<Named>,
    pub tried: Vec<Tried>,
}

impl Naming {
    /// The model fitted to all samples, without the names that do not stand there.
    pub fn confirmed(&mut self, bench: &Bench<'_>, fit: impl Fn(&Model) -> Trial) -> Trial {
        loop {
            let fitted = fit(&self.trial.model);
            let found: Vec<Candidate> = self.named.iter().map(|named| named.candidate).collect();
            let all = standings(bench, &fitted, &found).into_iter().zip(&found);
            let weakest = all.min_by(|(one, _), (other, _)| one.away.total_cmp(&other.away));
            let Some((_, candidate)) = weakest.filter(|(standing, _)| standing.away < LEAST_AWAY) else {
                return fitted;
            };
            take_away(&mut self.trial.model, *candidate);
            self.named.retain(|named| named.candidate != *candidate);
        }
    }
}

/// The search.
pub struct Search<'b, 'a> {
    bench: &'b Bench<'a>,
    /// Mean of the noise's squares of a sample, of whitened deviations.
    noise_square: f64,
    fits: BTreeMap<Vec<Candidate>, Trial>,
    promised: BTreeMap<Vec<Candidate>, Vec<Promise>>,
    refused: BTreeMap<Candidate, Refusal>,
}

impl<'b, 'a> Search<'b, 'a> {
    /// From a model that was fitted.
    pub fn new(bench: &'b Bench<'a>, base: Trial, noise_square: f64) -> Self {
        Self {
            bench,
            noise_square,
            fits: BTreeMap::from([(Vec::new(), base)]),
            promised: BTreeMap::new(),
            refused: BTreeMap::new(),
        }
    }

    /// Names what is missing, beginning with what was found before: models that have it.
    pub fn run(mut self, before: &[Named], model: &Model) -> Naming {
        let mut found: Vec<Candidate> = before.iter().map(|named| named.candidate).collect();
        if !found.is_empty() {
            self.fits.insert(set_of(&found), self.bench.fit(model, NEAR_ERRORS));
        }
        let mut named = Vec::new();
        for _ in 0..ROUNDS {
            let set = set_of(&found);
            let refused = self.refused.len();
            self.enter(&mut found);
            self.unite(&mut found);
            self.take_apart(&mut found);
            named = self.leave(&mut found);
            let is_exchanged = self.exchange(&mut found);
            if !is_exchanged && (set_of(&found) == set || self.refused.len() == refused) {
                break;
            }
        }
        for place in 0..named.len() {
            let runner_up = self.runner_up(&found, place);
            named.iter_mut().skip(place).take(1).for_each(|named| named.runner_up = runner_up);
        }
        let tried = self.tried(&found);
        Naming { trial: self.fit(&found), named, tried }
    }

    fn excess(&self, trial: &Trial) -> f64 {
        trial.held_out / self.noise_squares(true) - 1.0
    }

    fn noise_squares(&self, held_out: bool) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = self.bench.count(held_out) as f64;
        count * self.noise_square
    }

    fn least_gain(&self, trial: &Trial) -> f64 {
        let noise = self.noise_squares(true);
        (LEAST_GAIN * (trial.held_out - noise)).max(LEAST_SIZE * noise)
    }

    /// Lets the best in as long as they help.
    fn enter(&mut self, found: &mut Vec<Candidate>) {
        while found.len() < MOST {
            let trial = self.fit(found);
            if self.excess(&trial) <= NEGLIGIBLE {
                break;
            }
            let enough = self.least_gain(&trial);
            let mut entrants = self.beside(found);
            entrants.retain(|(candidate, with)| {
                !self.refused.contains_key(candidate)
                    && trial.held_out - with.held_out > enough
                    && !self.is_at_end(*candidate, with)
                    && self.is_more_than_usual(*candidate, with)
            });
            let cost = |(candidate, with): &(Candidate, Trial)| self.delta_bic(&trial, with, candidate.count(), 1.0);
            entrants.sort_by(|one, other| cost(one).total_cmp(&cost(other)));
            let speaks_for_it = |(candidate, with): &&(Candidate, Trial)| {
                let inflation = self.inflation(*candidate, with);
                self.delta_bic(&trial, with, candidate.count(), inflation) < 0.0
            };
            let Some((candidate, _)) = entrants.iter().find(speaks_for_it) else { break };
            found.push(*candidate);
            self.spread(found, *candidate);
        }
    }

    /// What several cables have becomes one that all have alike, where that says as much with fewer parameters.
    fn unite(&mut self, found: &mut Vec<Candidate>) {
        let effects: Vec<_> =
            found.iter().filter_map(|of| matches!(of, Candidate::Own(..)).then(|| of.effect())?).collect();
        for effect in effects.iter().copied().filter(|effect| effects.iter().filter(|of| *of == effect).count() > 2) {
            let is_own = |of: &Candidate| matches!(of, Candidate::Own(_, own) if *own == effect);
            let count = found.iter().filter(|of| is_own(of)).count();
            let (others, candidate) =
                (found.iter().copied().filter(|of| !is_own(of)).collect::<Vec<_>>(), Candidate::Alike(effect));
            if count < 3 || self.refused.contains_key(&candidate) {
                continue;
            }
            let (apart, Some(alike)) = (self.fit(found), self.with(&others, candidate)) else { continue };
            let saved = candidate.count() * (count - 1);
            // Fewer parameters: as good is better.
            if -self.delta_bic(&alike, &apart, saved, 1.0) < 0.0 {
                *found = others;
                found.push(candidate);
            }
        }
    }

    /// What all cables seem to have alike is taken apart where one of them differs.
    fn take_apart(&mut self, found: &mut Vec<Candidate>) {
        for candidate in found.clone() {
            if matches!(candidate, Candidate::Alike(_)) {
                self.spread(found, candidate);
            }
        }
    }

    /// Gives every cable its own value of an effect that one of them has, or all alike, where the evidence for that is strong. What a cable does not
    /// need leaves afterwards; before, something else would have come in for it.
    fn spread(&mut self, found: &mut Vec<Candidate>, candidate: Candidate) {
        let Some(effect) = candidate.effect() else { return };
        let trial = self.fit(found);
        if scales_all(self.bench, &trial.model, Candidate::Alike(effect)) {
            return;
        }
        let (own, count) = (fitted(effect), self.bench.records.len());
        let others: Vec<Candidate> = found.iter().copied().filter(|of| of.effect() != Some(effect)).collect();
        let is_alike = matches!(candidate, Candidate::Alike(_));
        let before = if is_alike { 1 } else { found.len() - others.len() };
        let mut model = trial.model.clone();
        model.alike.retain(|of| !own.contains(of));
        for cable in 0..count {
            let start = (!has(effect, &model.values[cable])).then(|| {
                self.promises(&others).iter().find(|of| of.candidate == Candidate::Own(cable, effect)).cloned()
            });
            match start {
                Some(None) => return,
                Some(Some(promise)) => Parameter::of(effect).for_each(|of| {
                    model.values[cable][of.place()] = promise.model.values[cable][of.place()];
                }),
                None => {}
            }
            let free = &mut model.free[cable];
            free.extend(own.iter().copied().filter(|of| !free.contains(of)).collect::<Vec<Parameter>>());
        }
        let more = own.len() * (count - before);
        if more == 0 {
            return;
        }
        let apart = self.bench.fit(&model, NEAR_ERRORS);
        let each: Vec<Candidate> = (0..count).map(|cable| Candidate::Own(cable, effect)).collect();
        let standings = standings(self.bench, &apart, &each);
        let inflation = standings.iter().map(|standing| standing.inflation).fold(1.0, f64::max);
        if apart.held_out < trial.held_out && self.delta_bic(&trial, &apart, more, inflation) < -STRONG_BIC {
            *found = others;
            found.extend(each);
            self.fits.insert(set_of(found), apart);
            if is_alike {
                self.refused.insert(candidate, Refusal::Unsteady("cable"));
            }
        }
    }

    /// Sets aside what cannot justify itself, the weakest first: what is fewest standard errors from doing nothing.
    fn leave(&mut self, found: &mut Vec<Candidate>) -> Vec<Named> {
        loop {
            let trial = self.fit(found);
            let mut weakest_first: Vec<(Standing, Candidate)> =
                standings(self.bench, &trial, found).into_iter().zip(found.iter().copied()).collect();
            weakest_first.sort_by(|(one, _), (other, _)| one.away.total_cmp(&other.away));
            let mut named = BTreeMap::new();
            let mut refused = None;
            for (standing, candidate) in weakest_first {
                let others: Vec<Candidate> = found.iter().copied().filter(|of| *of != candidate).collect();
                let without = self.fit(&others);
                let (delta_bic, refusal) = self.judged(candidate, &trial, &without, &standing);
                refused = refusal.map(|refusal| (candidate, refusal));
                if refused.is_some() {
                    break;
                }
                named.insert(candidate, Named { candidate, delta_bic, runner_up: None });
            }
            let Some((candidate, refusal)) = refused else {
                return found.iter().filter_map(|of| named.remove(of)).collect();
            };
            found.retain(|of| *of != candidate);
            self.refused.insert(candidate, refusal);
        }
    }

    /// Evidence for a name, and why it cannot stay.
    fn judged(
        &self,
        candidate: Candidate,
        trial: &Trial,
        without: &Trial,
        standing: &Standing,
    ) -> (f64, Option<Refusal>) {
        let Standing { inflation, away } = *standing;
        let delta_bic = self.delta_bic(without, trial, candidate.count(), inflation);
        let is_small = without.held_out - trial.held_out <= LEAST_SIZE * self.noise_squares(true);
        let refusal = if self.is_at_end(candidate, trial) {
            Some(Refusal::AtBound)
        } else if is_small
            || delta_bic >= -STRONG_BIC
            || away < LEAST_AWAY
            || self.beyond_one_block(trial, without) < STRONG_BIC * inflation
        {
            Some(Refusal::Weak)
        } else if !self.is_more_than_usual(candidate, trial) {
            Some(Refusal::Usual)
        } else {
            None
        };
        (delta_bic, refusal)
    }

    /// What is gained on the blocks held out but the one with the greatest gain, in variances of the noise.
    fn beyond_one_block(&self, trial: &Trial, without: &Trial) -> f64 {
        let blocks = self.bench.blocks.iter().zip(trial.blocks.iter().zip(&without.blocks));
        let gains = blocks.filter(|(block, _)| block.held_out).map(|(_, (with, without))| without - with);
        let (sum, greatest) =
            gains.fold((0.0, 0.0), |(sum, greatest): (f64, f64), gain| (sum + gain, greatest.max(gain)));
        (sum - greatest) * 6.0 / self.noise_square
    }

    fn is_more_than_usual(&self, candidate: Candidate, trial: &Trial) -> bool {
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

    /// Tries what promises most in the place of each; whether something was better.
    fn exchange(&mut self, found: &mut [Candidate]) -> bool {
        let mut is_changed = false;
        for place in 0..found.len() {
            let Some((other, with)) = self.alternative(found, place) else { continue };
            let Some(candidate) = found.get(place).copied() else { continue };
            let trial = self.fit(found);
            let more = self.cost(&with, other) < self.cost(&trial, candidate);
            if !self.refused.contains_key(&other)
                && more
                && with.held_out < trial.held_out
                && !self.is_at_end(other, &with)
            {
                found[place] = other;
                is_changed = true;
            }
        }
        is_changed
    }

    /// Schwarz's criterion of a model as far as it tells two candidates apart.
    fn cost(&self, trial: &Trial, candidate: Candidate) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (6.0 * self.bench.count(false) as f64, candidate.count() as f64);
        count * trial.training.ln() + more * count.ln() + self.oddity(trial)
    }

    fn alternative(&mut self, found: &[Candidate], place: usize) -> Option<(Candidate, Trial)> {
        let candidate = *found.get(place)?;
        let others: Vec<Candidate> = found.iter().copied().filter(|of| *of != candidate).collect();
        let mut rivals = self.beside(&others);
        rivals.retain(|(of, _)| *of != candidate && !found.contains(of));
        rivals
            .into_iter()
            .min_by(|(one, with), (other, beside)| self.cost(with, *one).total_cmp(&self.cost(beside, *other)))
    }

    fn runner_up(&mut self, found: &[Candidate], place: usize) -> Option<(Candidate, f64, bool)> {
        let candidate = *found.get(place)?;
        let (other, with) = self.alternative(found, place)?;
        let others: Vec<Candidate> = found.iter().copied().filter(|of| *of != candidate).collect();
        let (without, trial) = (self.fit(&others), self.fit(found));
        let inflation = self.inflation(candidate, &trial);
        let delta_bic = self.delta_bic(&without, &with, other.count(), inflation);
        let lead = self.delta_bic(&without, &trial, candidate.count(), inflation) - delta_bic;
        Some((other, delta_bic, lead > -STRONG_BIC))
    }

    /// Candidates that help the model with all that was found and do not suffice, the best first.
    fn tried(&mut self, found: &[Candidate]) -> Vec<Tried> {
        let trial = self.fit(found);
        if self.excess(&trial) <= NEGLIGIBLE {
            return Vec::new();
        }
        let tried = self.beside(found).into_iter().filter(|(_, with)| with.held_out < trial.held_out).map(
            |(candidate, with)| {
                let inflation = self.inflation(candidate, &with);
                let delta_bic = self.delta_bic(&trial, &with, candidate.count(), inflation);
                let refusal = if self.is_at_end(candidate, &with) {
                    Refusal::AtBound
                } else {
                    self.refused.get(&candidate).copied().unwrap_or(Refusal::Weak)
                };
                Tried { candidate, delta_bic, refusal }
            },
        );
        let mut tried: Vec<Tried> = tried.filter(|tried| tried.delta_bic < 0.0).collect();
        tried.sort_by(|one, other| one.delta_bic.total_cmp(&other.delta_bic));
        tried
    }

    fn delta_bic(&self, from: &Trial, to: &Trial, more: usize, inflation: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (6.0 * self.bench.count(false) as f64 / inflation, more as f64);
        delta_bic(count, to.training / from.training, more) + self.oddity(to) - self.oddity(from)
    }

    /// What speaks against a model before the samples do: a point or the vertical is seldom far off, and gains of all sensors are seldom wrong
    /// alike, which by the weight looks as a wrong mass does.
    fn oddity(&self, trial: &Trial) -> f64 {
        let model = &trial.model;
        let of = |(of, numbers): (&Geometry, &Vec<f64>)| {
            let usual = self.bench.description.usual(*of);
            numbers.iter().map(|number| (number / usual).powi(2)).sum::<f64>()
        };
        let is_gain = |of: &&Parameter| of.effect() == Some(Effect::SensorGain);
        let by_weight = self.bench.description.reference == WrenchReference::Mass;
        let gain = model.alike.iter().find(is_gain).filter(|_| by_weight);
        let of_gain = gain
            .zip(model.values.first())
            .map_or(0.0, |(of, values)| ((values[of.place()] - of.row().neutral) / USUAL_GAIN).powi(2));
        model.changes.iter().map(of).sum::<f64>() + of_gain
    }

    /// The model with some names. One that has not been tried is fitted from the best that has one more.
    fn fit(&mut self, found: &[Candidate]) -> Trial {
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
            take_away(&mut model, *candidate);
        }
        let trial = self.bench.fit(&model, NEAR_ERRORS);
        self.fits.insert(set, trial.clone());
        trial
    }

    /// The model with one more name, fitted.
    fn with(&mut self, found: &[Candidate], candidate: Candidate) -> Option<Trial> {
        let set = set_of(&[found, &[candidate]].concat());
        if !self.fits.contains_key(&set) {
            let promise = self.promises(found).iter().find(|promise| promise.candidate == candidate)?.clone();
            self.fits.insert(set.clone(), self.bench.fit(&promise.model, NEAR_ERRORS));
        }
        self.fits.get(&set).cloned()
    }

    /// The models with one more of those that promise most, fitted.
    fn beside(&mut self, found: &[Candidate]) -> Vec<(Candidate, Trial)> {
        let best: Vec<Candidate> = {
            let promises = self.promises(found).to_vec();
            let open = promises.iter().filter(|promise| !self.refused.contains_key(&promise.candidate));
            open.take(FITTED).map(|promise| promise.candidate).collect()
        };
        let unknown = |candidate: &Candidate| !self.fits.contains_key(&set_of(&[found, &[*candidate]].concat()));
        let wanted: Vec<Candidate> = best.iter().copied().filter(unknown).collect();
        let promises = self.promised.get(&set_of(found)).map(Vec::as_slice).unwrap_or_default();
        let new: Vec<Promise> =
            promises.iter().filter(|promise| wanted.contains(&promise.candidate)).cloned().collect();
        let fit = |promise: &Promise| {
            let mut trial = self.bench.fit(&promise.model, NEAR_ERRORS);
            if found.is_empty() {
                // What is missing may have led the friction astray.
                let by_given = self.bench.fit(&self.bench.with_given_friction(&promise.model), NEAR_ERRORS);
                trial = if by_given.training < trial.training { by_given } else { trial };
            }
            (set_of(&[found, &[promise.candidate]].concat()), trial)
        };
        let fits: Vec<(Vec<Candidate>, Trial)> = new.par_iter().map(fit).collect();
        self.fits.extend(fits);
        best.into_iter().filter_map(|candidate| Some((candidate, self.with(found, candidate)?))).collect()
    }

    fn promises(&mut self, found: &[Candidate]) -> &[Promise] {
        let set = set_of(found);
        if !self.promised.contains_key(&set) {
            let trial = self.fit(found);
            let around = self.around(&trial, true);
            let model = &trial.model;
            let has_effect = |cable: usize, effect| model.values.get(cable).is_some_and(|values| has(effect, values));
            let is_new = |candidate: Candidate| match candidate {
                Candidate::Own(cable, effect) => !has_effect(cable, effect),
                Candidate::Alike(effect) => (0..model.values.len()).all(|cable| !has_effect(cable, effect)),
                Candidate::Geometry(of) => !model.changes.contains_key(&of),
            };
            let is_wanted = |candidate: Candidate| is_new(candidate) && !scales_all(self.bench, model, candidate);
            let mut all = promises(self.bench, model, &around, is_wanted);
            // Per parameter: the criterion's price is nothing beside the gains that matter, yet of two equals the simpler goes first.
            all.retain(|promise| promise.gain > 0.0);
            self.promised.insert(set.clone(), all);
        }
        self.promised.get(&set).map(Vec::as_slice).unwrap_or_default()
    }

    /// What a search on each cable begins from; the scan for periods takes its time.
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

    fn is_at_end(&self, candidate: Candidate, trial: &Trial) -> bool {
        let cycle_s = self.bench.records.first().map_or(f64::NAN, |record| record.cycle_s);
        let is_at = |cable: usize, effect| {
            trial.model.values.get(cable).is_none_or(|values| is_at_end(effect, values, cycle_s))
        };
        match candidate {
            Candidate::Own(cable, effect) => is_at(cable, effect),
            Candidate::Alike(effect) => is_at(0, effect),
            Candidate::Geometry(_) => false,
        }
    }

    fn inflation(&self, candidate: Candidate, trial: &Trial) -> f64 {
        standings(self.bench, trial, &[candidate]).first().map_or(f64::INFINITY, |standing| standing.inflation)
    }
}

/// How sure the parameters of a name are.
struct Standing {
    /// By how much memory in the deviations weakens the evidence, at least 1.
    inflation: f64,
    /// How far all are from their neutral values together, in standard errors.
    away: f64,
}

impl Standing {
    /// Where the samples do not tell them.
    const NONE: Self = Self { inflation: f64::INFINITY, away: 0.0 };
}

/// Whether with a candidate all forces of a model and the weight that they bear could shrink together, and with them all deviations.
fn scales_all(bench: &Bench<'_>, model: &Model, candidate: Candidate) -> bool {
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

/// How sure the parameters of each of a model's names are.
fn standings(bench: &Bench<'_>, trial: &Trial, candidates: &[Candidate]) -> Vec<Standing> {
    let unknowns = trial.model.unknowns();
    let covariances = bench.covariances(&trial.model);
    let of = |candidate: &Candidate| {
        let [covariance, independent] = covariances.as_ref()?;
        let is_its = |unknown: &Unknown| match (*candidate, unknown) {
            (Candidate::Own(cable, effect), Unknown::Own(of, parameter)) => {
                cable == *of && parameter.effect() == Some(effect)
            }
            (Candidate::Alike(effect), Unknown::Alike(parameter)) => parameter.effect() == Some(effect),
            (Candidate::Geometry(geometry), Unknown::Geometry(of, _)) => geometry == *of,
            _ => false,
        };
        let places: Vec<usize> = (0..unknowns.len()).filter(|place| unknowns.get(*place).is_some_and(is_its)).collect();
        let inflation =
            places.iter().map(|place| covariance[(*place, *place)] / independent[(*place, *place)]).fold(1.0, f64::max);
        let away = places.iter().map(|place| away_from_neutral(&trial.model, &unknowns[*place]));
        let away = DVector::from_iterator(places.len(), away);
        let inverse = inverse_of_normal(&covariance.select_rows(&places).select_columns(&places))?;
        let away = (away.transpose() * inverse * &away)[(0, 0)].sqrt();
        Some(Standing { inflation, away })
    };
    candidates.iter().map(|candidate| of(candidate).unwrap_or(Standing::NONE)).collect()
}

fn away_from_neutral(model: &Model, unknown: &Unknown) -> f64 {
    let from_neutral = |cable: usize, of: &Parameter| {
        model.values.get(cable).map_or(f64::NAN, |values| values[of.place()] - of.row().neutral)
    };
    match unknown {
        Unknown::Own(cable, of) => from_neutral(*cable, of),
        Unknown::Alike(of) => from_neutral(0, of),
        Unknown::Geometry(of, place) => {
            model.changes.get(of).and_then(|numbers| numbers.get(*place)).copied().unwrap_or(0.0)
        }
    }
}

/// Takes a name out of a model: its numbers are neutral.
fn take_away(model: &mut Model, candidate: Candidate) {
    match candidate {
        Candidate::Own(cable, effect) => {
            let own = fitted(effect);
            model.free.iter_mut().skip(cable).take(1).for_each(|free| free.retain(|of| !own.contains(of)));
            let values = model.values.iter_mut().skip(cable).take(1);
            values.for_each(|values| Parameter::of(effect).for_each(|of| values[of.place()] = of.row().neutral));
        }
        Candidate::Alike(effect) => {
            let own = fitted(effect);
            model.alike.retain(|of| !own.contains(of));
            let values = model.values.iter_mut();
            values.for_each(|values| Parameter::of(effect).for_each(|of| values[of.place()] = of.row().neutral));
        }
        Candidate::Geometry(of) => {
            model.changes.remove(&of);
        }
    }
}

fn set_of(found: &[Candidate]) -> Vec<Candidate> {
    let mut set = found.to_vec();
    set.sort_unstable();
    set
}

/// Of which geometries a model corrects numbers.
pub fn geometries(named: &[Named]) -> impl Iterator<Item = (&Named, Geometry)> {
    named.iter().filter_map(|named| match named.candidate {
        Candidate::Geometry(of) => Some((named, of)),
        _ => None,
    })
}
