//! Cache of the models that a search has fitted: each set of effects is fitted once.

use fric_core::effects::Effect;
use fric_core::parameters::{MU, SIGMA, Values};

use super::evidence::inflation;
use super::{LEAST_GAIN, LEAST_SIZE, Search, Set, set_of, without};
use crate::candidates::catalogue::{fitted, has, starts};
use crate::candidates::ripple::{period_of, periods};
use crate::certainty::determined::NEGLIGIBLE_MU;
use crate::discover::workbench::{Model, NEAR_ERRORS, Trial};
use crate::effects::pulley_defect;
use crate::fit::Parameter;
use crate::search::vector::Coordinate;

/// No friction equation is trusted to better than this fraction of the force that it adds. Otherwise the model error of a strong effect would be
/// taken for a weak effect.
const BELIEVED_RATIO: f64 = 1e-3;
/// Candidates are first optimised until the remaining gain is below this fraction of what a candidate needs to enter.
const UNDECIDED: f64 = 0.5;
/// Distance from its minimum to which the named model is optimised, in standard errors.
const AT_MINIMUM: f64 = 0.01;

impl Search<'_, '_> {
    /// Fits each candidate that a model lacks beside its present effects. The ladder of friction comes before everything else.
    pub(super) fn round(&mut self, found: &[Effect]) -> Vec<(Effect, Trial)> {
        let model = self.fit(found);
        let slides = model.values[MU] > 0.0;
        // A sensor offset and an offset at the platform have the same effect on the force.
        let has_zero = self.bench.has_zero(&model.free);
        let lacking = |friction: bool| -> Vec<Effect> {
            Effect::ALL
                .iter()
                .copied()
                .filter(|effect| {
                    effect.is_friction() == friction && !has(*effect, &model.values) && !found.contains(effect)
                })
                .filter(|effect| *effect != Effect::Presliding || slides)
                .filter(|effect| *effect != Effect::SensorOffset || !has_zero)
                .filter(|effect| effect.first().is_none_or(|first| has(first, &model.values)))
                .collect()
        };
        let friction = self.beside(found, &lacking(true));
        let enough = self.least_gain(&model);
        // Friction that cannot enter, because it was refused or because what else is missing leaves it no evidence, keeps nothing from its turn.
        let can_enter = |(effect, trial): &(Effect, Trial)| {
            !self.refused.contains_key(effect)
                && gains(&model, trial, enough)
                && self.delta_bic(&model, trial, inflation(self.bench, trial, &fitted(*effect))) < 0.0
        };
        if friction.iter().any(can_enter) {
            return friction;
        }
        [friction, self.beside(found, &lacking(false))].concat()
    }

    /// Fits the model with one more effect, for each of several.
    pub(super) fn beside(&mut self, found: &[Effect], candidates: &[Effect]) -> Vec<(Effect, Trial)> {
        let with = |effect: &Effect| set_of(&[found, &[*effect]].concat());
        let model = self.fit(found);
        // A model that fits worse than without one of its effects was fitted from elsewhere, to another minimum.
        let is_known = |effect: &Effect| self.fits.get(&with(effect)).is_some_and(|of| of.training <= model.training);
        let unknown: Vec<Effect> = candidates.iter().copied().filter(|effect| !is_known(effect)).collect();
        if unknown.iter().any(|effect| period_of(*effect).is_some() && !self.earlier.contains_key(&with(effect))) {
            let residuals_n = self.bench.residuals_n(&model.values);
            self.around.periods = periods(&self.bench.record, &residuals_n);
        }
        let from = self.with_friction(&model);
        let (mut models, mut owners) = (Vec::new(), Vec::new());
        for effect in unknown {
            let mut free = model.free.clone();
            free.extend(fitted(effect).into_iter().filter(|parameter| !model.free.contains(parameter)));
            let starts = match self.earlier.get(&with(&effect)) {
                Some(earlier) => vec![start_from(earlier, effect, &model.values, &free)],
                None => starts(effect, &from, &self.around, &self.bench.record),
            };
            for values in starts {
                models.push(Model { values, free: free.clone() });
                owners.push((with(&effect), effect));
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
        let [learned, held_out] = [false, true].map(|held_out| self.bench.count(held_out) as f64);
        let needed = self.least_gain(&model) * learned / held_out;
        let near_errors = (UNDECIDED * needed * learned / model.training).sqrt().max(NEAR_ERRORS);
        let fits = self.try_all(&models, near_errors);
        // Where every start leads away, the effect is best left out.
        let left_out = |model_with: Model| Trial { free: model_with.free, ..model.clone() };
        let left_out: Vec<_> = owners.iter().cloned().zip(models.into_iter().map(left_out)).collect();
        for ((owner, effect), trial) in owners.into_iter().zip(fits).chain(left_out) {
            let is_better = self.fits.get(&owner).is_none_or(|other| trial.training < other.training);
            if trial.training.is_finite() && is_better {
                let trial = self.upright(effect, trial);
                self.fits.insert(owner, trial);
            }
        }
        // Candidates that may enter and may be the best are optimised to their minima.
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

    /// Returns the values of a model with the file's μ and σ if one of them has run to the end of its range, so that hardly any friction is left, or far too
    /// much: what the model lacks may outweigh friction, and a search that starts there hardly comes back.
    fn with_friction(&self, model: &Trial) -> Values {
        let (mut values, given) = (model.values, self.bench.record.params.values());
        let free = model.free.iter().filter(|parameter| [MU, SIGMA].contains(&parameter.place()));
        let has_run = |parameter: &&Parameter| {
            let place = parameter.place();
            let near = if place == MU { NEGLIGIBLE_MU } else { 0.0 };
            let bound = Coordinate::of(parameter, self.bench.record.cycle_s).bound_at(values[place], near);
            bound.is_some_and(|bound| place == MU || bound < given[SIGMA])
        };
        if given[MU] > NEGLIGIBLE_MU && free.clone().any(|parameter| has_run(&parameter)) {
            for place in free.map(Parameter::place) {
                values[place] = given[place];
            }
        }
        values
    }

    /// Chooses the settings of the effects in a model again, such as the window of an acceleration: beside another effect another one may be best. The
    /// periods of ripples are no matter of choice.
    pub(super) fn settle(&mut self, found: &[Effect]) {
        for effect in found.iter().copied().filter(|effect| period_of(*effect).is_none()) {
            let trial = self.fit(found);
            let settings: Vec<usize> =
                Parameter::of(effect).filter(|of| !of.row().fitted).map(|of| of.place()).collect();
            let with_settings_of = |start: Values| {
                let mut values = trial.values;
                for place in &settings {
                    values[*place] = start[*place];
                }
                Model { values, free: trial.free.clone() }
            };
            let others: Vec<Model> = starts(effect, &trial.values, &self.around, &self.bench.record)
                .into_iter()
                .filter(|start| settings.iter().any(|place| start[*place].to_bits() != trial.values[*place].to_bits()))
                .map(with_settings_of)
                .collect();
            let fits = self.try_all(&others, trial.near_errors);
            let best = fits.into_iter().min_by(|one, other| one.training.total_cmp(&other.training));
            if let Some(best) = best.filter(|best| best.training < trial.training) {
                self.fits.insert(set_of(found), self.upright(effect, best));
            }
        }
    }

    /// Optimises the models with some sets of effects to their minima, including the periods of ripples, which a scan finds only approximately.
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
        let fits = self.try_all(&models, NEAR_ERRORS);
        self.fits.extend(sets.into_iter().zip(fits));
    }

    /// Returns the fitted model with a set of effects. A set that has not been tried starts from the best fit that has one effect more.
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
        self.effort.add(trial.evaluation_count);
        self.fits.insert(set, trial.clone());
        trial
    }

    /// Fits several models, each to the given distance from its minimum in standard errors, and counts the work.
    pub(super) fn try_all(&self, models: &[Model], near_errors: f64) -> Vec<Trial> {
        let fits = self.bench.try_all(models, near_errors);
        self.effort.add(fits.iter().map(|trial| trial.evaluation_count).sum());
        fits
    }

    /// Optimises the model with a set of effects to convergence.
    pub(super) fn polish(&mut self, found: &[Effect]) {
        let model = self.fit(found).model();
        self.fits.insert(set_of(found), self.bench.fit(&model, AT_MINIMUM));
    }

    /// Returns the held-out mean square above the noise, as a fraction of the noise variance.
    pub(super) fn excess(&self, trial: &Trial) -> f64 {
        trial.held_out / self.noise_squares - 1.0
    }

    /// Returns the fit with the pulley that rubs too much. Of two pulleys, this is the same model as the other one that rubs too little, in which a search
    /// may end.
    fn upright(&self, effect: Effect, trial: Trial) -> Trial {
        let other_way = if effect == Effect::PulleyDefect {
            pulley_defect::other_way(&trial.values, self.around.pulley_count)
        } else {
            None
        };
        let Some(values) = other_way else { return trial };
        let model = Model { values, free: trial.free.clone() };
        let turned = self.bench.try_all(&[model], trial.near_errors).pop();
        turned.filter(|turned| turned.training < trial.training + self.noise_n * self.noise_n).unwrap_or(trial)
    }

    /// Returns the decrease of the held-out sum of squares that a candidate needs to enter beside a model, N².
    pub(super) fn least_gain(&self, model: &Trial) -> f64 {
        let gap = (model.held_out - self.noise_squares).max(0.0);
        let believed = BELIEVED_RATIO * BELIEVED_RATIO * model.added;
        (LEAST_GAIN * gap).max(believed).max(LEAST_SIZE * self.noise_squares)
    }
}

/// Returns the values of a model with an effect as an earlier fit had them, where both vary them; the effect's settings are always those of the fit.
fn start_from(earlier: &Trial, effect: Effect, model: &Values, free: &[Parameter]) -> Values {
    let is_settled = |parameter: &Parameter| !free.contains(parameter);
    let taken = earlier.free.iter().copied().filter(|parameter| free.contains(parameter));
    let mut values = *model;
    for parameter in taken.chain(Parameter::of(effect).filter(is_settled)) {
        values[parameter.place()] = earlier.values[parameter.place()];
    }
    values
}

/// Whether the held-out sum of squares decreases by at least `enough`, N².
pub fn gains(before: &Trial, after: &Trial, enough: f64) -> bool {
    before.held_out - after.held_out > enough
}
