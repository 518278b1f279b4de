//! Which effects are missing: candidates enter, are exchanged, and have to justify themselves.
//!
//! 1. *Enter.* Every candidate is fitted together with all that the model has. The best on the samples learned from with strong evidence
//!    enters if it also helps on those held out. Where none has strong evidence alone, those enter that have it beside each other.
//! 2. *Leave.* An effect stays if the evidence for it is strong, if it is large enough to matter, if its parameters keep clear of the
//!    ends of their ranges and can be told from the others, if it has one size in every operating condition, and if neither a law without a name
//!    nor an effect of a size that robots usually have makes it superfluous. One that cannot stay is set aside, and the next has its turn.
//! 3. *Exchange.* For every effect that stays, all others are tried in its place.
//!
//! What was set aside gets another turn beside all that has been found since.

pub mod evidence;
pub mod projection;
mod rivals;
mod steadiness;

use std::collections::{BTreeMap, BTreeSet};

use fric_core::effects::Effect;
use fric_core::effects::empirical::SHARES;
use fric_core::effects::sensor_offset::OFFSET as OFFSET_OF_SENSOR;
use fric_core::parameters::{MU, OFFSET, Values};

use self::evidence::inflation;
use self::projection::{Columns, less_projection};
use self::rivals::{Chance, Rival, best_rival};
use self::steadiness::{Portrait, Steadiness};
use super::rest::WORTH;
use super::workbench::{Model, NEAR_ERRORS, Trial, Workbench};
use crate::candidates::catalogue::{fitted, has, starts};
use crate::candidates::ripple::{period_of, periods};
use crate::effects::{self, Around};
use crate::fit::Parameter;
use crate::samples::conditions::Condition;
use crate::search::vector::Coordinate;

/// Most effects of one cable.
const MOST_EFFECTS: usize = 8;
/// Of the squares above the noise that are left, a candidate has to take away this share to enter.
pub const LEAST_GAIN: f64 = 0.02;
/// No equation of friction is believed to less than this share of what it adds to the force of the sensor: what the equation of a
/// strong effect leaves must not be taken for a weak one.
const BELIEVED_RATIO: f64 = 1e-3;
/// A candidate takes away at least this share of the noise's own squares, half of what is negligible: the rms falls by a quarter of a per
/// cent. Less is what the equation of another effect leaves: at 0.002, four of 250 extended files were given a second name so small.
pub const LEAST_SIZE: f64 = 0.5 * NEGLIGIBLE;
/// What is left above the noise, as a share of it, from which on no further name is sought: the rms is half of it above.
pub const NEGLIGIBLE: f64 = 0.01;
/// Candidates are first brought so near to their minima that what is left to gain is this part of what a candidate needs to enter.
const UNDECIDED: f64 = 0.5;
/// A parameter within this fraction of its bound counts as stuck at the bound, by the way from its neutral value.
const END_RATIO: f64 = 0.01;
/// Minimum ΔBIC to keep an effect, and to prefer one name over another. 10 would do if the memory of the residual were
/// known; where noise wanders, the best of a dozen candidates comes to nearly 30 by chance.
pub const STRONG_BIC: f64 = 30.0;
/// The size of an effect, as a share of itself, differs between operating conditions by less than this (root mean square): it then explains as one constant
/// four fifths of what it would with one in each condition.
const MOST_SCATTER_RATIO: f64 = 0.5;
/// Of what is above the noise, no more than this share is what the effect would explain if its size went with a condition.
const MOST_BENT: f64 = 0.5;
/// The named model is brought this near to its minimum, in standard errors.
const AT_MINIMUM: f64 = 0.01;
/// Rounds of entering, exchanging and justifying, and passes in which everything that was refused gets another turn.
const ROUNDS: usize = 8;
const PASSES: usize = 2;

/// A set of effects, in their order.
type Set = Vec<Effect>;

/// An effect in a model with what speaks for it.
#[derive(Clone, Debug)]
pub struct Named {
    /// Its effect.
    pub effect: Effect,
    /// The model without it, fitted anew.
    pub without: Trial,
    /// The best other effect in its place.
    pub runner_up: Option<(Effect, Trial)>,
    /// By how much memory in the residual weakens the evidence, at least 1.
    pub inflation: f64,
    /// Why it cannot stay.
    refusal: Option<Refusal>,
}

/// Why a candidate that helps is not named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The evidence for it is weaker than what chance gives.
    Weak,
    /// Its parameter runs to the end of its range.
    AtBound,
    /// The log cannot tell it from the parameter of this name.
    Open(&'static str),
    /// Its size differs between operating conditions of this name: something else is taken for it.
    Unsteady(&'static str),
    /// A law without a name that goes with this explains more in its place, and leaves little for it to explain.
    StandsIn(&'static str),
    /// It is no more than what robots without it have.
    Usual,
    /// What it explains is not more than what another one of a usual size does.
    UsualInstead(Effect),
    /// What is left would go away if its size went with this condition: its law is another one.
    Bent(&'static str),
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Naming {
    /// The model with all that was found.
    pub model: Trial,
    /// What was found, in the order in which it entered.
    pub named: Vec<Named>,
    /// The models on the way from the first to the last, one more than effects.
    pub ladder: Vec<Trial>,
    /// Every candidate's first fit beside the given model.
    pub first_round: Vec<(Effect, Trial)>,
    /// Candidates that help the model with all that was found and do not suffice, the best first.
    pub tried: Vec<Tried>,
}

/// A candidate that helps and does not suffice.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Its effect.
    pub effect: Effect,
    /// The model with it.
    pub trial: Trial,
    /// By how much memory in the residual weakens the evidence, at least 1.
    pub inflation: f64,
    /// Why it is not named.
    pub refusal: Refusal,
}

/// A candidate that something speaks for.
struct Entrant {
    effect: Effect,
    trial: Trial,
    /// By how much memory in the residual weakens the evidence, at least 1.
    inflation: f64,
    delta_bic: f64,
}

/// The search on one cable. Every set of effects is fitted once.
pub struct Search<'b, 'a> {
    bench: &'b Workbench<'a>,
    noise_n: f64,
    noise_squares: f64,
    around: Around,
    conditions: &'b [Condition],
    fits: BTreeMap<Set, Trial>,
    /// Whether the reference tells more loads than one; if not, a sensor of no gain that is off by that load agrees with it best, and a
    /// gain is another word for an offset.
    knows_load: bool,
    /// Candidates that were refused, and why.
    refused: BTreeMap<Effect, Refusal>,
    /// Of effects in sets: by how much memory weakens the evidence, and why they cannot stay.
    judged: BTreeMap<(Set, Effect), (f64, Option<Refusal>)>,
    /// Sets that no law without a name makes superfluous.
    unrivalled: BTreeSet<Set>,
}

impl<'b, 'a> Search<'b, 'a> {
    /// From the given model, fitted; `noise_n` is the standard deviation of the noise.
    pub fn new(
        bench: &'b Workbench<'a>,
        noise_n: f64,
        around: Around,
        base: &Trial,
        conditions: &'b [Condition],
    ) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let noise_squares = bench.count(true) as f64 * noise_n * noise_n;
        let fits = BTreeMap::from([(Set::new(), base.clone())]);
        Self {
            bench,
            noise_n,
            noise_squares,
            around,
            conditions,
            fits,
            knows_load: bench.reference_variation_n() > noise_n,
            refused: BTreeMap::new(),
            judged: BTreeMap::new(),
            unrivalled: BTreeSet::new(),
        }
    }

    /// Names what the model lacks; what was found before has a place in it from the start, and has to justify itself with the rest.
    pub fn run(&mut self, before: &[Effect]) -> Naming {
        let base = self.fit(&[]);
        let first_round = if self.excess(&base) > NEGLIGIBLE { self.round(&[]) } else { Vec::new() };
        let mut found = Vec::new();
        self.add(&mut found, before);
        let mut named = Vec::new();
        for _ in 0..PASSES {
            let before = set_of(&found);
            self.refused = self.beyond_the_log();
            named = self.pass(&mut found);
            if set_of(&found) == before {
                break;
            }
        }
        for (place, named) in named.iter_mut().enumerate() {
            named.runner_up = self.alternative(&found, place);
        }
        let tried = self.tried(&found);
        self.polish(&found);
        let ladder = (0..=found.len()).map(|count| self.fit(found.get(..count).unwrap_or_default())).collect();
        Naming { model: self.fit(&found), named, ladder, first_round, tried }
    }

    /// Candidates that no log like this can justify.
    fn beyond_the_log(&self) -> BTreeMap<Effect, Refusal> {
        let of_gain = (Effect::SensorGain, Refusal::Open("offset_n"));
        if self.knows_load { BTreeMap::new() } else { BTreeMap::from([of_gain]) }
    }

    /// Lets candidates in and has them justify themselves until nothing changes; what cannot is set aside, and the next has its turn. What
    /// remains is exchanged for what is better in its place.
    fn pass(&mut self, found: &mut Vec<Effect>) -> Vec<Named> {
        for _ in 0..ROUNDS {
            let before = self.refused.len();
            self.enter(found);
            let named = self.leave(found);
            if self.refused.len() == before && !self.exchange(found) {
                return named;
            }
        }
        self.leave(found)
    }

    /// Sets aside what cannot justify itself, the weakest first.
    fn leave(&mut self, found: &mut Vec<Effect>) -> Vec<Named> {
        loop {
            let named = self.justified(found);
            let held_out = |named: &&Named| named.without.held_out;
            let refused = named.iter().filter(|named| named.refusal.is_some());
            let weakest = refused.min_by(|one, other| held_out(one).total_cmp(&held_out(other)));
            let Some(Named { effect, refusal: Some(refusal), .. }) = weakest else { return named };
            let (effect, refusal) = (*effect, *refusal);
            found.retain(|of| *of != effect);
            // What could not be told from it can be told without it.
            let keys: Vec<&str> = Parameter::of(effect).map(|parameter| parameter.row().key).collect();
            self.refused.retain(|_, refusal| !matches!(refusal, Refusal::Open(key) if keys.contains(key)));
            self.refused.insert(effect, refusal);
        }
    }

    /// Difference of Schwarz's criterion from one model to another over the samples learned from; negative speaks for the other.
    pub fn delta_bic(&self, from: &Trial, to: &Trial, inflation: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (self.bench.count(false) as f64 / inflation, to.free.len() as f64 - from.free.len() as f64);
        delta_bic(count, to.training / from.training, more)
    }

    /// The same for a table, from the squares without and with it.
    pub fn delta_bic_of_table(&self, [without, with]: [f64; 2], inflation: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (self.bench.count(false) as f64 / inflation, SHARES as f64);
        delta_bic(count, with / without, more)
    }

    /// Mean square above the noise of the samples held out, as a share of the noise's.
    fn excess(&self, trial: &Trial) -> f64 {
        trial.held_out / self.noise_squares - 1.0
    }

    /// Lets candidates in as long as they help, but for those that were refused: the best with strong evidence, or, where none has it alone, those
    /// that have it together.
    fn enter(&mut self, found: &mut Vec<Effect>) {
        while found.len() < MOST_EFFECTS {
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
            let entrants: Vec<Entrant> = entrants
                .into_iter()
                .map(|(effect, trial)| {
                    let inflation = inflation(self.bench, &trial, &fitted(effect));
                    Entrant { effect, delta_bic: self.delta_bic(&model, &trial, inflation), inflation, trial }
                })
                // What memory in the residual makes of chance is no reason to go on.
                .filter(|entrant| entrant.delta_bic < 0.0)
                .collect();
            let entering = match entrants.iter().find(|entrant| entrant.delta_bic < -STRONG_BIC) {
                Some(strong) => vec![strong.effect],
                None => self.strong_together(&model, &entrants),
            };
            if entering.is_empty() {
                break;
            }
            self.add(found, &entering);
        }
    }

    /// Those of some candidates for each of which there is strong evidence beside the others, by linear steps from the model.
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

    /// Adds effects to a model, each beside those before it, from its own starts.
    fn add(&mut self, found: &mut Vec<Effect>, effects: &[Effect]) {
        for effect in effects {
            self.beside(found, &[*effect]);
            found.push(*effect);
        }
    }

    /// By how much the squares of the samples held out have to fall for a candidate to be let in beside a model, N².
    fn least_gain(&mut self, model: &Trial) -> f64 {
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

    /// Each candidate that a model lacks, fitted beside all that it has; the ladder of friction comes before everything else.
    fn round(&mut self, found: &[Effect]) -> Vec<(Effect, Trial)> {
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
    fn beside(&mut self, found: &[Effect], candidates: &[Effect]) -> Vec<(Effect, Trial)> {
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
    fn refine(&mut self, sets: impl Iterator<Item = Set>) {
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
    fn fit(&mut self, found: &[Effect]) -> Trial {
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
    fn polish(&mut self, found: &[Effect]) {
        let model = self.fit(found).model();
        self.fits.insert(set_of(found), self.bench.fit(&model, AT_MINIMUM));
    }

    /// Tries all other effects in the place of each; whether one was better.
    fn exchange(&mut self, found: &mut [Effect]) -> bool {
        let mut is_changed = false;
        for place in 0..found.len() {
            let Some((other, trial)) = self.alternative(found, place) else { continue };
            let model = self.fit(found);
            if !self.refused.contains_key(&other) && trial.training < model.training && trial.held_out < model.held_out
            {
                found[place] = other;
                is_changed = true;
            }
        }
        is_changed
    }

    /// The best other effect in the place of one; friction that every model has stays.
    fn alternative(&mut self, found: &[Effect], place: usize) -> Option<(Effect, Trial)> {
        let effect = *found.get(place)?;
        if effect.is_friction() {
            return None;
        }
        let others: Vec<Effect> = found.iter().copied().filter(|other| *other != effect).collect();
        let others = self.round(&others).into_iter().filter(|(other, _)| *other != effect);
        // What the log cannot tell from it is another name for it.
        let beyond = self.beyond_the_log();
        let is_rival = |other: &Effect| beyond.contains_key(other) || !self.refused.contains_key(other);
        best(others.filter(|(other, _)| is_rival(other)).collect::<Vec<_>>())
    }

    /// Every effect of a model with what speaks for it, and why it cannot stay if it cannot.
    fn justified(&mut self, found: &[Effect]) -> Vec<Named> {
        let set = set_of(found);
        let model = self.fit(found);
        let mut named = Vec::new();
        for effect in found.iter().copied() {
            let others: Vec<Effect> = found.iter().copied().filter(|other| *other != effect).collect();
            let without = self.fit(&others);
            let known = self.judged.get(&(set.clone(), effect)).copied();
            let (inflation, refusal) = known.unwrap_or_else(|| {
                let inflation = inflation(self.bench, &model, &fitted(effect));
                (inflation, self.refusal(&model, effect, &without, inflation))
            });
            self.judged.insert((set.clone(), effect), (inflation, refusal));
            let refusal = refusal.or_else(|| self.usual_instead(found, effect, inflation));
            named.push(Named { effect, without, runner_up: None, inflation, refusal });
        }
        if named.iter().all(|named| named.refusal.is_none()) && !self.unrivalled.contains(&set) {
            match self.rival(&model, &named) {
                Some(rival) => {
                    for place in rival.replaces {
                        let named = &mut named[place];
                        named.refusal = Some(Refusal::StandsIn(rival.signal));
                        self.judged.insert((set.clone(), named.effect), (named.inflation, named.refusal));
                    }
                }
                None => {
                    self.unrivalled.insert(set);
                }
            }
        }
        named
    }

    /// Whether there is no strong evidence for an effect beside another one of a size that robots usually have.
    fn usual_instead(&mut self, found: &[Effect], effect: Effect, inflation: f64) -> Option<Refusal> {
        let is_usual = |(other, refusal): (&Effect, &Refusal)| {
            (*refusal == Refusal::Usual && !found.contains(other)).then_some(*other)
        };
        let usual: Vec<Effect> = self.refused.iter().filter_map(is_usual).collect();
        let others: Vec<Effect> = found.iter().copied().filter(|other| *other != effect).collect();
        usual.into_iter().find_map(|usual| {
            let (_, with) = self.beside(found, &[usual]).pop()?;
            let (_, without) = self.beside(&others, &[usual]).pop()?;
            (self.delta_bic(&without, &with, inflation) >= -STRONG_BIC).then_some(Refusal::UsualInstead(usual))
        })
    }

    /// A law without a name that makes some of the effects superfluous.
    fn rival(&self, model: &Trial, named: &[Named]) -> Option<Rival> {
        let effects: Vec<(Vec<Parameter>, Values)> =
            named.iter().map(|named| (fitted(named.effect), without(named.effect, &model.values))).collect();
        let inflation = named.iter().fold(1.0, |most: f64, named| most.max(named.inflation));
        let is_friction_only = named.iter().all(|named| named.effect.is_friction());
        let white = STRONG_BIC * self.noise_n * self.noise_n;
        let chance = Chance { enough: white * inflation, white, noise_n: self.noise_n };
        let kinds: Vec<Effect> = named.iter().map(|named| named.effect).collect();
        let rival = (!is_friction_only).then(|| best_rival(self.bench, model, (&kinds, &effects), &chance))??;
        (!rival.replaces.iter().any(|place| named[*place].effect.is_friction())).then_some(rival)
    }

    /// Why an effect cannot stay in a model.
    fn refusal(&self, model: &Trial, effect: Effect, without_it: &Trial, inflation: f64) -> Option<Refusal> {
        let cycle_s = self.bench.record.cycle_s;
        if is_at_end(effect, &model.values, cycle_s) {
            return Some(Refusal::AtBound);
        }
        let gain = without_it.held_out - model.held_out;
        let is_strong = self.delta_bic(without_it, model, inflation) < -STRONG_BIC;
        if !is_strong || gain <= LEAST_SIZE * self.noise_squares {
            return Some(Refusal::Weak);
        }
        let lab = effects::of(effect)?;
        if !(lab.is_more_than_usual)(&model.values, &self.around) {
            return Some(Refusal::Usual);
        }
        if let Some(other) = self.confused_with(model, effect) {
            return Some(Refusal::Open(other));
        }
        let neutral = without(effect, &model.values);
        let noise = (self.noise_n, inflation);
        let portrait = Portrait::of(self.bench, model, &fitted(effect), &neutral, self.conditions, noise)?;
        let is_noise = self.excess(model) <= WORTH;
        doubt(&portrait, is_noise)
    }

    /// The parameter that an effect cannot be told from, where the log determines none of the effect's own, be the others of them known; an offset at the platform is one
    /// that every cable may have.
    fn confused_with(&self, model: &Trial, effect: Effect) -> Option<&'static str> {
        let mut free = model.free.clone();
        let has_offset = free.iter().any(|parameter| [OFFSET, OFFSET_OF_SENSOR].contains(&parameter.place()));
        free.extend(Parameter::all().filter(|parameter| parameter.place() == OFFSET && !has_offset));
        let of_effect = fitted(effect);
        let (covariance, all) =
            crate::certainty::undetermined::vagueness(&self.bench.problem(&free, None), &[model.values]);
        let own = |of: &crate::search::solve::Unknown| of_effect.contains(&of.parameter);
        // What only the effect's own parameters share is no matter of another's.
        let alone = |of: &Parameter| {
            let free: Vec<Parameter> =
                free.iter().copied().filter(|other| other == of || !of_effect.contains(other)).collect();
            let (_, all) = crate::certainty::undetermined::vagueness(&self.bench.problem(&free, None), &[model.values]);
            all.iter().any(|(vagueness, unknown)| unknown.parameter == *of && *vagueness <= 1.0)
        };
        if all.iter().any(|(vagueness, of)| own(of) && *vagueness <= 1.0)
            || of_effect.len() > 1 && of_effect.iter().any(alone)
        {
            return None;
        }
        let correlation = |one: usize, other: usize| {
            (covariance[(one, other)] / (covariance[(one, one)] * covariance[(other, other)]).sqrt()).abs()
        };
        let (own, others): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(|place| own(&all[*place].1));
        let nearest = |other: &usize| own.iter().map(|own| correlation(*own, *other)).fold(0.0, f64::max);
        let other = others.into_iter().max_by(|one, other| nearest(one).total_cmp(&nearest(other)))?;
        Some(all[other].1.parameter.row().key)
    }

    /// The candidates that help a model and do not suffice, the best first.
    fn tried(&mut self, found: &[Effect]) -> Vec<Tried> {
        let model = self.fit(found);
        if self.excess(&model) <= NEGLIGIBLE {
            return Vec::new();
        }
        let mut tried: Vec<Tried> = self
            .round(found)
            .into_iter()
            .filter(|(_, trial)| trial.held_out < model.held_out && trial.training < model.training)
            .map(|(effect, trial)| {
                let inflation = inflation(self.bench, &trial, &fitted(effect));
                let cycle_s = self.bench.record.cycle_s;
                let refusal = if is_at_end(effect, &trial.values, cycle_s) {
                    Refusal::AtBound
                } else {
                    self.refused.get(&effect).copied().unwrap_or(Refusal::Weak)
                };
                Tried { effect, trial, inflation, refusal }
            })
            .filter(|tried| self.delta_bic(&model, &tried.trial, tried.inflation) < 0.0)
            .collect();
        tried.sort_by(|one, other| one.trial.training.total_cmp(&other.trial.training));
        tried
    }
}

/// The values of a model without an effect.
fn without(effect: Effect, values: &Values) -> Values {
    let mut neutral = *values;
    for parameter in Parameter::of(effect) {
        neutral[parameter.place()] = parameter.row().neutral;
    }
    neutral
}

/// Whether something else is taken for an effect, whose size then is not one constant.
fn doubt(portrait: &Portrait<'_>, is_noise: bool) -> Option<Refusal> {
    let all = portrait.steadiness();
    let scatters = |of: &&Steadiness| of.scatter > MOST_SCATTER_RATIO * MOST_SCATTER_RATIO;
    let unsteady = all.iter().filter(scatters).max_by(|one, other| one.scatter.total_cmp(&other.scatter));
    if let Some(unsteady) = unsteady {
        return Some(Refusal::Unsteady(unsteady.signal));
    }
    let bent = all.iter().filter(|of| !is_noise && of.bent > MOST_BENT);
    bent.max_by(|one, other| one.bent.total_cmp(&other.bent)).map(|bent| Refusal::Bent(bent.signal))
}

/// Difference of Schwarz's criterion for so many samples that do not depend on each other, a ratio of the sums of squares, and so many
/// more parameters; of less than two samples there is no evidence.
pub fn delta_bic(count: f64, squares_ratio: f64, more: f64) -> f64 {
    if count < 2.0 { f64::INFINITY } else { count * squares_ratio.ln() + more * count.ln() }
}

/// Whether a parameter of an effect has run into an end of its range that is not its neutral value; of friction that every model
/// has the ranges are orders of magnitude.
pub fn is_at_end(effect: Effect, values: &Values, cycle_s: f64) -> bool {
    let has_run = |parameter: &Parameter| {
        let (least, greatest) = Coordinate::of(parameter, cycle_s).range();
        let neutral = parameter.row().neutral;
        let left = |end: f64| (end - values[parameter.place()]).abs() / (end - neutral).abs();
        [least, greatest].into_iter().any(|end| left(end) < END_RATIO)
    };
    !effect.is_friction() && fitted(effect).iter().any(has_run)
}

/// Whether a model has so much less of the squares held out than another, N².
fn gains(before: &Trial, after: &Trial, enough: f64) -> bool {
    before.held_out - after.held_out > enough
}

/// The best on the samples learned from.
fn best(tried: impl IntoIterator<Item = (Effect, Trial)>) -> Option<(Effect, Trial)> {
    tried.into_iter().min_by(|(_, one), (_, other)| one.training.total_cmp(&other.training))
}

fn set_of(found: &[Effect]) -> Set {
    let mut set = found.to_vec();
    set.sort_unstable();
    set
}

#[cfg(test)]
mod tests {
    use fric_core::effects::Effect;
    use fric_core::parameters::{PARAMETER_COUNT, Values};

    use super::{delta_bic, fitted, is_at_end};
    use crate::fit::Parameter;

    const CYCLE_S: f64 = 1e-3;

    fn neutral() -> Values {
        let mut values = [0.0; PARAMETER_COUNT];
        for parameter in Parameter::all() {
            values[parameter.place()] = parameter.row().neutral;
        }
        values
    }

    #[test]
    fn a_parameter_at_the_end_of_its_range_has_run_into_it() {
        for (effect, inside, end) in
            [(Effect::PreslidingShape, 0.5, 0.3), (Effect::Stribeck, 2.0, 5.0), (Effect::TimeDelay, 0.02, 0.063)]
        {
            let place = fitted(effect)[0].place();
            for (value, has_run) in [(inside, false), (end, true), (end * (1.0 - 1e-6), true)] {
                let mut values = neutral();
                values[place] = value;
                assert_eq!(is_at_end(effect, &values, CYCLE_S), has_run, "{effect:?}: {value}");
            }
        }
        // At an end that is the neutral value there is only little of the effect.
        assert!(!is_at_end(Effect::PulleyInertia, &neutral(), CYCLE_S));
    }

    #[test]
    fn what_nothing_is_known_of_is_no_evidence() {
        let few = delta_bic(10.0, 0.5, 1.0);
        assert!((few - (10.0 * 0.5_f64.ln() + 10.0_f64.ln())).abs() < 1e-12);
        assert!(delta_bic(0.0, 0.5, 1.0) > 0.0 && delta_bic(1.5, 0.01, 1.0) > 0.0);
    }
}
