//! The models that a search has fitted: each set of effects once.

use fric_core::effects::Effect;
use fric_core::parameters::{MU, OFFSET};

use super::{LEAST_GAIN, LEAST_SIZE, Search, Set, set_of, without};
use crate::candidates::catalogue::{fitted, has, starts};
use crate::candidates::ripple::{period_of, periods};
use crate::discover::workbench::{Model, NEAR_ERRORS, Trial};
use crate::fit::Parameter;

/// No equation of friction is believed to less than this share of what it adds to the force of the sensor: what the equation of a
/// strong effect leaves must not be taken for a weak one.
const BELIEVED_RATIO: f64 = 1e-3;
/// Candidates are first brought so near to their minima that what is left to gain is this part of what a candidate needs to enter.
const UNDECIDED: f64 = 0.5;
/// The named model is brought this near to its minimum, in standard errors.
const AT_MINIMUM: f64 = 0.01;

impl Search<'_, '_> {
    /// Each candidate that a model lacks, fitted beside all that it has; the ladder of friction comes before everything else.
    pub(super) fn round(&mut self, found: &[Effect]) -> Vec<(Effect, Trial)> {
        let model = self.fit(found);
        let slides = model.values[MU] > 0.0;
        // An offset of the sensor and one at the platform are the same to the force.
        let has_offset = model.free.iter().any(|parameter| parameter.place() == OFFSET);
        let lacking = |friction: bool| -> Vec<Effect> {
            Effect::ALL
                .iter()
                .copied()
                .filter(|effect| {
                    effect.is_friction() == friction && !has(*effect, &model.values) && !found.contains(effect)
                })
                .filter(|effect| *effect != Effect::Presliding || slides)
                .filter(|effect| *effect != Effect::SensorOffset || !has_offset)
                .collect()
        };
        let friction = self.beside(found, &lacking(true));
        let enough = self.least_gain(&model);
        if friction.iter().any(|(_, trial)| gains(&model, trial, enough)) {
            return friction;
        }
        self.beside(found, &lacking(false))
    }

    /// The model with one more effect, for each of several.
    pub(super) fn beside(&mut self, found: &[Effect], candidates: &[Effect]) -> Vec<(Effect, Trial)> {
        let with = |effect: &Effect| set_of(&[found, &[*effect]].concat());
        let model = self.fit(found);
        let unknown: Vec<Effect> =
            candidates.iter().copied().filter(|effect| !self.fits.contains_key(&with(effect))).collect();
        if unknown.iter().any(|effect| period_of(*effect).is_some()) {
            let residuals_n = self.bench.residuals_n(&model.values);
            self.around.periods = periods(&self.bench.record, &residuals_n);
        }
        let (mut models, mut owners) = (Vec::new(), Vec::new());
        for effect in unknown {
            for values in starts(effect, &model.values, &self.around, &self.bench.record) {
                let mut free = model.free.clone();
                free.extend(fitted(effect).into_iter().filter(|parameter| !model.free.contains(parameter)));
                models.push(Model { values, free });
                owners.push(with(&effect));
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
        let [learned, held_out] = [false, true].map(|held_out| self.bench.count(held_out) as f64);
        let needed = self.least_gain(&model) * learned / held_out;
        let near_errors = (UNDECIDED * needed * learned / model.training).sqrt().max(NEAR_ERRORS);
        for (owner, trial) in owners.into_iter().zip(self.bench.try_all(&models, near_errors)) {
            let is_better = self.fits.get(&owner).is_none_or(|other| trial.training < other.training);
            if trial.training.is_finite() && is_better {
                self.fits.insert(owner, trial);
            }
        }
        // Those that may enter, and may be the best, come to their minima.
        let trained = |effect: &Effect| self.fits.get(&with(effect)).map(|trial| trial.training);
        let enough = model.training - UNDECIDED * needed;
        let bound = candidates.iter().filter_map(trained).fold(enough, |least, training| least.min(training + needed));
        let contenders: Vec<Effect> = candidates
            .iter()
            .copied()
            .filter(|effect| trained(effect).is_some_and(|training| training < bound))
            .collect();
        self.refine(contenders.iter().map(with));
        candidates.iter().filter_map(|effect| Some((*effect, self.fits.get(&with(effect))?.clone()))).collect()
    }

    /// Brings the models with some sets of effects to their minima, the periods of ripples with them: a scan finds these only nearly.
    pub(super) fn refine(&mut self, sets: impl Iterator<Item = Set>) {
        let refined = |set: Set| {
            let trial = self.fits.get(&set)?;
            let mut model = trial.model();
            let periods = set.iter().filter_map(|effect| period_of(*effect));
            model.free.extend(periods.filter(|period| !trial.free.contains(period)));
            let is_coarse = trial.near_errors > NEAR_ERRORS || model.free.len() > trial.free.len();
            is_coarse.then_some((set, model))
        };
        let (sets, models): (Vec<Set>, Vec<Model>) = sets.filter_map(refined).unzip();
        let fits = self.bench.try_all(&models, NEAR_ERRORS);
        self.fits.extend(sets.into_iter().zip(fits));
    }

    /// The model with a set of effects. One that has not been tried yet is fitted from the best that has one more.
    pub(super) fn fit(&mut self, found: &[Effect]) -> Trial {
        let set = set_of(found);
        self.refine(std::iter::once(set.clone()));
        if let Some(trial) = self.fits.get(&set) {
            return trial.clone();
        }
        let larger = self
            .fits
            .iter()
            .filter(|(kinds, _)| kinds.len() == set.len() + 1 && set.iter().all(|kind| kinds.contains(kind)))
            .min_by(|(_, one), (_, other)| one.training.total_cmp(&other.training));
        let Some((larger, of_larger)) = larger else { return self.fit(&[]) };
        let mut model = of_larger.model();
        for effect in Effect::ALL.iter().copied().filter(|effect| larger.contains(effect) && !set.contains(effect)) {
            model.values = without(effect, &model.values);
            let of_effect: Vec<Parameter> = Parameter::of(effect).collect();
            model.free.retain(|parameter| !of_effect.contains(parameter));
        }
        let trial = self.bench.try_one(&model);
        self.fits.insert(set, trial.clone());
        trial
    }

    /// Brings the model with a set of effects to its very minimum.
    pub(super) fn polish(&mut self, found: &[Effect]) {
        let model = self.fit(found).model();
        self.fits.insert(set_of(found), self.bench.fit(&model, AT_MINIMUM));
    }

    /// Mean square above the noise of the samples held out, as a share of the noise's.
    pub(super) fn excess(&self, trial: &Trial) -> f64 {
        trial.held_out / self.noise_squares - 1.0
    }

    /// By how much the squares of the samples held out have to fall for a candidate to be let in beside a model, N².
    pub(super) fn least_gain(&mut self, model: &Trial) -> f64 {
        let gap = (model.held_out - self.noise_squares).max(0.0);
        (LEAST_GAIN * gap).max(self.believed_squares(model)).max(LEAST_SIZE * self.noise_squares)
    }

    /// What a model is not believed to, of the squares held out, N².
    fn believed_squares(&self, model: &Trial) -> f64 {
        let added_n = self.bench.added_n(&model.values);
        let squares: f64 =
            self.bench.used(true).iter().zip(&added_n).filter(|(used, _)| **used).map(|(_, n)| n * n).sum();
        BELIEVED_RATIO * BELIEVED_RATIO * squares
    }
}

/// Whether a model has so much less of the squares held out than another, N².
pub fn gains(before: &Trial, after: &Trial, enough: f64) -> bool {
    before.held_out - after.held_out > enough
}
