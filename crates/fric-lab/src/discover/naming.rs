//! Which effects are missing: candidates enter, are exchanged, and have to justify themselves.
//!
//! 1. *Enter.* Every candidate is fitted together with all that the model has. The best on the samples learned from
//!    enters if it also helps on those held out; leniently, for what is still missing colours the residual.
//! 2. *Leave.* An effect stays if the evidence for it is strong, if it is large enough to matter, if its parameters keep clear of the
//!    ends of their ranges and can be told from the others, if it has one size in every operating condition, and if no law without a name makes it
//!    superfluous. One that cannot stay is set aside, and the next has its turn.
//! 3. *Exchange.* For every effect that stays, all others are tried in its place.
//!
//! What was set aside gets another turn beside all that has been found since.

use std::collections::{BTreeMap, BTreeSet};

use fric_core::effects::sensor_offset::OFFSET as OFFSET_OF_SENSOR;
use fric_core::effects::{self, EffectRow, pulley_eccentricity, sensor_gain, sensor_offset};
use fric_core::parameters::{MU, OFFSET, Values};

use super::candidates::{Scale, fitted, has, is_friction, starts};
use super::evidence::inflation;
use super::rest::WORTH;
use super::ripple::periods_m;
use super::rivals::{Chance, Rival, best_rival};
use super::steadiness::{Portrait, Steadiness};
use super::workbench::{Model, NEAR_ERRORS, Trial, Workbench};
use crate::fit::Parameter;
use crate::fit::engine::{self, Condition, Coordinate};

/// Most effects of one cable.
const MOST_EFFECTS: usize = 8;
/// Of the squares above the noise that are left, a candidate has to take away this share to enter.
const LEAST_GAIN: f64 = 0.02;
/// No equation of friction is believed to less than this share of what it adds to the force of the sensor: what the equation of a
/// strong effect leaves must not be taken for a weak one.
const BELIEVED_RATIO: f64 = 1e-3;
/// A candidate takes away at least this share of the noise's own squares, half of what is negligible: the rms falls by a quarter of a per
/// cent. Less is what the equation of another effect leaves: at 0.002, four of 250 extended files were given a second name so small.
const LEAST_SIZE: f64 = 0.5 * NEGLIGIBLE;
/// What is left above the noise, as a share of it, from which on no further name is sought: the rms is half of it above.
const NEGLIGIBLE: f64 = 0.01;
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

/// Names of effects in the order of the alphabet.
type Kinds = Vec<&'static str>;

/// An effect in a model with what speaks for it.
#[derive(Clone, Debug)]
pub struct Named {
    /// Its row.
    pub row: &'static EffectRow,
    /// The model without it, fitted anew.
    pub without: Trial,
    /// The best other effect in its place.
    pub runner_up: Option<(&'static EffectRow, Trial)>,
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
    pub first_round: Vec<(&'static EffectRow, Trial)>,
    /// Candidates that help the model with all that was found and do not suffice, the best first.
    pub tried: Vec<Tried>,
}

/// A candidate that helps and does not suffice.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Its row.
    pub row: &'static EffectRow,
    /// The model with it.
    pub trial: Trial,
    /// By how much memory in the residual weakens the evidence, at least 1.
    pub inflation: f64,
    /// Why it is not named.
    pub refusal: Refusal,
}

/// The search on one cable. Every set of effects is fitted once.
pub struct Search<'b, 'a> {
    bench: &'b Workbench<'a>,
    noise_n: f64,
    noise_squares: f64,
    scale: Scale,
    conditions: &'b [Condition],
    fits: BTreeMap<Kinds, Trial>,
    /// Whether the reference tells more loads than one; if not, a sensor of no gain that is off by that load agrees with it best, and a
    /// gain is another word for an offset.
    knows_load: bool,
    /// Candidates that were refused, and why.
    refused: BTreeMap<&'static str, Refusal>,
    /// Of effects in sets: by how much memory weakens the evidence, and why they cannot stay.
    judged: BTreeMap<(Kinds, &'static str), (f64, Option<Refusal>)>,
    /// Sets that no law without a name makes superfluous.
    unrivalled: BTreeSet<Kinds>,
}

impl<'b, 'a> Search<'b, 'a> {
    /// From the given model, fitted; `noise_n` is the standard deviation of the noise.
    pub fn new(
        bench: &'b Workbench<'a>,
        noise_n: f64,
        scale: Scale,
        base: &Trial,
        conditions: &'b [Condition],
    ) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let noise_squares = bench.count(true) as f64 * noise_n * noise_n;
        let fits = BTreeMap::from([(Kinds::new(), base.clone())]);
        Self {
            bench,
            noise_n,
            noise_squares,
            scale,
            conditions,
            fits,
            knows_load: bench.reference_variation_n() > noise_n,
            refused: BTreeMap::new(),
            judged: BTreeMap::new(),
            unrivalled: BTreeSet::new(),
        }
    }

    /// Names what the model lacks; what was found before has a place in it from the start, and has to justify itself with the rest.
    pub fn run(&mut self, before: &[&'static EffectRow]) -> Naming {
        let base = self.fit(&[]);
        let first_round = if self.excess(&base) > NEGLIGIBLE { self.round(&[]) } else { Vec::new() };
        let mut rows = Vec::new();
        for row in before.iter().copied() {
            // Each beside those before it, from its own starts.
            self.beside(&rows, &[row]);
            rows.push(row);
        }
        let mut named = Vec::new();
        for _ in 0..PASSES {
            let before = kinds(&rows);
            self.refused = self.beyond_the_log();
            named = self.pass(&mut rows);
            if kinds(&rows) == before {
                break;
            }
        }
        for (place, named) in named.iter_mut().enumerate() {
            named.runner_up = self.alternative(&rows, place);
        }
        let tried = self.tried(&rows);
        self.polish(&rows);
        let ladder = (0..=rows.len()).map(|count| self.fit(rows.get(..count).unwrap_or_default())).collect();
        Naming { model: self.fit(&rows), named, ladder, first_round, tried }
    }

    /// Candidates that no log like this can justify.
    fn beyond_the_log(&self) -> BTreeMap<&'static str, Refusal> {
        let of_gain = (sensor_gain::ROW.kind, Refusal::Open("offset_n"));
        if self.knows_load { BTreeMap::new() } else { BTreeMap::from([of_gain]) }
    }

    /// Lets candidates in and has them justify themselves until nothing changes; what cannot is set aside, and the next has its turn. What
    /// remains is exchanged for what is better in its place.
    fn pass(&mut self, rows: &mut Vec<&'static EffectRow>) -> Vec<Named> {
        for _ in 0..ROUNDS {
            let before = self.refused.len();
            self.enter(rows);
            let named = self.leave(rows);
            if self.refused.len() == before && !self.exchange(rows) {
                return named;
            }
        }
        self.leave(rows)
    }

    /// Sets aside what cannot justify itself, the weakest first.
    fn leave(&mut self, rows: &mut Vec<&'static EffectRow>) -> Vec<Named> {
        loop {
            let named = self.justified(rows);
            let held_out = |named: &&Named| named.without.held_out;
            let refused = named.iter().filter(|named| named.refusal.is_some());
            let weakest = refused.min_by(|one, other| held_out(one).total_cmp(&held_out(other)));
            let Some(Named { row, refusal: Some(refusal), .. }) = weakest else { return named };
            self.refused.insert(row.kind, *refusal);
            rows.retain(|of| of.kind != row.kind);
        }
    }

    /// Difference of Schwarz's criterion from one model to another over the samples learned from; negative speaks for the other.
    pub fn delta_bic(&self, from: &Trial, to: &Trial, inflation: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (self.bench.count(false) as f64 / inflation, to.free.len() as f64 - from.free.len() as f64);
        delta_bic(count, to.training / from.training, more)
    }

    /// Mean square above the noise of the samples held out, as a share of the noise's.
    fn excess(&self, trial: &Trial) -> f64 {
        trial.held_out / self.noise_squares - 1.0
    }

    /// Lets the best candidates in as long as they help, but for those that were refused.
    fn enter(&mut self, rows: &mut Vec<&'static EffectRow>) {
        while rows.len() < MOST_EFFECTS {
            let model = self.fit(rows);
            if self.excess(&model) <= NEGLIGIBLE {
                break;
            }
            let enough = self.least_gain(&model);
            let candidates = self.round(rows);
            let cycle_s = self.bench.record.cycle_s;
            let may_enter = |(row, trial): &(&'static EffectRow, Trial)| {
                !self.refused.contains_key(row.kind)
                    && gains(&model, trial, enough)
                    && !is_at_end(row, &trial.values, cycle_s)
            };
            let Some((row, _)) = best(candidates.into_iter().filter(may_enter)) else { break };
            rows.push(row);
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
    fn round(&mut self, rows: &[&'static EffectRow]) -> Vec<(&'static EffectRow, Trial)> {
        let model = self.fit(rows);
        let slides = model.values[MU] > 0.0;
        // An offset of the sensor and one at the platform are the same to the force.
        let has_offset = model.free.iter().any(|parameter| parameter.place() == OFFSET);
        let lacking = |friction: bool| -> Vec<&'static EffectRow> {
            effects::named()
                .filter(|row| is_friction(row) == friction && !has(row, &model.values) && !contains(rows, row))
                .filter(|row| row.kind != "presliding" || slides)
                .filter(|row| row.kind != sensor_offset::ROW.kind || !has_offset)
                .collect()
        };
        let friction = self.beside(rows, &lacking(true));
        let enough = self.least_gain(&model);
        if friction.iter().any(|(_, trial)| gains(&model, trial, enough)) {
            return friction;
        }
        self.beside(rows, &lacking(false))
    }

    /// The model with one more effect, for each of several.
    fn beside(
        &mut self,
        rows: &[&'static EffectRow],
        candidates: &[&'static EffectRow],
    ) -> Vec<(&'static EffectRow, Trial)> {
        let with = |row: &&'static EffectRow| kinds(&[rows, &[*row]].concat());
        let model = self.fit(rows);
        let unknown: Vec<&'static EffectRow> =
            candidates.iter().copied().filter(|row| !self.fits.contains_key(&with(row))).collect();
        if unknown.iter().any(|row| row.kind == "pulley_eccentricity") {
            let residuals_n = self.bench.residuals_n(&model.values);
            self.scale.periods_m = periods_m(&self.bench.record, &residuals_n);
        }
        let (mut models, mut owners) = (Vec::new(), Vec::new());
        for row in unknown {
            for values in starts(row, &model.values, &self.scale, &self.bench.record) {
                let mut free = model.free.clone();
                free.extend(fitted(row).into_iter().filter(|parameter| !model.free.contains(parameter)));
                models.push(Model { values, free });
                owners.push(with(&row));
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
        let trained = |row: &&'static EffectRow| self.fits.get(&with(row)).map(|trial| trial.training);
        let enough = model.training - UNDECIDED * needed;
        let bound = candidates.iter().filter_map(trained).fold(enough, |least, training| least.min(training + needed));
        let contenders: Vec<&'static EffectRow> =
            candidates.iter().copied().filter(|row| trained(row).is_some_and(|training| training < bound)).collect();
        self.refine(contenders.iter().map(with));
        candidates.iter().filter_map(|row| Some((*row, self.fits.get(&with(row))?.clone()))).collect()
    }

    /// Brings the models with some sets of effects to their minima.
    fn refine(&mut self, sets: impl Iterator<Item = Kinds>) {
        let coarse: Vec<Kinds> =
            sets.filter(|set| self.fits.get(set).is_some_and(|trial| trial.near_errors > NEAR_ERRORS)).collect();
        let models: Vec<Model> = coarse.iter().filter_map(|set| self.fits.get(set)).map(Trial::model).collect();
        let fits = self.bench.try_all(&models, NEAR_ERRORS);
        self.fits.extend(coarse.into_iter().zip(fits));
    }

    /// The model with a set of effects. One that has not been tried yet is fitted from the best that has one more.
    fn fit(&mut self, rows: &[&'static EffectRow]) -> Trial {
        let set = kinds(rows);
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
        for row in effects::named().filter(|row| larger.contains(&row.kind) && !set.contains(&row.kind)) {
            for parameter in Parameter::of_row(row) {
                model.values[parameter.place()] = parameter.row().neutral;
            }
            let of_row = fitted(row);
            model.free.retain(|parameter| !of_row.contains(parameter));
        }
        let trial = self.bench.try_one(&model);
        self.fits.insert(set, trial.clone());
        trial
    }

    /// Brings the model with a set of effects to its minimum, the period of a ripple with it: it was found by a scan.
    fn polish(&mut self, rows: &[&'static EffectRow]) {
        let mut model = self.fit(rows).model();
        if contains(rows, &pulley_eccentricity::ROW) {
            let is_period = |parameter: &Parameter| parameter.place() == pulley_eccentricity::PERIOD;
            model.free.extend(Parameter::all().find(is_period));
        }
        self.fits.insert(kinds(rows), self.bench.fit(&model, AT_MINIMUM));
    }

    /// Tries all other effects in the place of each; whether one was better.
    fn exchange(&mut self, rows: &mut [&'static EffectRow]) -> bool {
        let mut is_changed = false;
        for place in 0..rows.len() {
            let Some((other, trial)) = self.alternative(rows, place) else { continue };
            let model = self.fit(rows);
            if !self.refused.contains_key(other.kind)
                && trial.training < model.training
                && trial.held_out < model.held_out
            {
                rows[place] = other;
                is_changed = true;
            }
        }
        is_changed
    }

    /// The best other effect in the place of one; friction that every model has stays.
    fn alternative(&mut self, rows: &[&'static EffectRow], place: usize) -> Option<(&'static EffectRow, Trial)> {
        let row = *rows.get(place)?;
        if is_friction(row) {
            return None;
        }
        let others: Vec<&'static EffectRow> = rows.iter().copied().filter(|other| other.kind != row.kind).collect();
        let others = self.round(&others).into_iter().filter(|(other, _)| other.kind != row.kind);
        // What the log cannot tell from it is another name for it.
        let beyond = self.beyond_the_log();
        let is_rival = |other: &EffectRow| beyond.contains_key(other.kind) || !self.refused.contains_key(other.kind);
        best(others.filter(|(other, _)| is_rival(other)).collect::<Vec<_>>())
    }

    /// Every effect of a model with what speaks for it, and why it cannot stay if it cannot.
    fn justified(&mut self, rows: &[&'static EffectRow]) -> Vec<Named> {
        let set = kinds(rows);
        let model = self.fit(rows);
        let mut named = Vec::new();
        for row in rows.iter().copied() {
            let others: Vec<&'static EffectRow> = rows.iter().copied().filter(|other| other.kind != row.kind).collect();
            let without = self.fit(&others);
            let known = self.judged.get(&(set.clone(), row.kind)).copied();
            let (inflation, refusal) = known.unwrap_or_else(|| {
                let inflation = inflation(self.bench, &model, &fitted(row));
                (inflation, self.refusal(&model, row, &without, inflation))
            });
            self.judged.insert((set.clone(), row.kind), (inflation, refusal));
            named.push(Named { row, without, runner_up: None, inflation, refusal });
        }
        if named.iter().all(|named| named.refusal.is_none()) && !self.unrivalled.contains(&set) {
            match self.rival(&model, &named) {
                Some(rival) => {
                    for place in rival.replaces {
                        let named = &mut named[place];
                        named.refusal = Some(Refusal::StandsIn(rival.signal));
                        self.judged.insert((set.clone(), named.row.kind), (named.inflation, named.refusal));
                    }
                }
                None => {
                    self.unrivalled.insert(set);
                }
            }
        }
        named
    }

    /// A law without a name that makes some of the effects superfluous.
    fn rival(&self, model: &Trial, named: &[Named]) -> Option<Rival> {
        let effects: Vec<(Vec<Parameter>, Values)> =
            named.iter().map(|named| (fitted(named.row), without(named.row, &model.values))).collect();
        let inflation = named.iter().fold(1.0, |most: f64, named| most.max(named.inflation));
        let is_friction_only = named.iter().all(|named| is_friction(named.row));
        let white = STRONG_BIC * self.noise_n * self.noise_n;
        let chance = Chance { enough: white * inflation, white, noise_n: self.noise_n };
        let rival = (!is_friction_only).then(|| best_rival(self.bench, model, &effects, &chance))??;
        (!rival.replaces.iter().any(|place| is_friction(named[*place].row))).then_some(rival)
    }

    /// Why an effect cannot stay in a model.
    fn refusal(&self, model: &Trial, row: &EffectRow, without_it: &Trial, inflation: f64) -> Option<Refusal> {
        let cycle_s = self.bench.record.cycle_s;
        if is_at_end(row, &model.values, cycle_s) {
            return Some(Refusal::AtBound);
        }
        let gain = without_it.held_out - model.held_out;
        let is_strong = self.delta_bic(without_it, model, inflation) < -STRONG_BIC;
        if !is_strong || gain <= LEAST_SIZE * self.noise_squares {
            return Some(Refusal::Weak);
        }
        if is_friction(row) {
            return None;
        }
        if let Some(other) = self.confused_with(model, row) {
            return Some(Refusal::Open(other));
        }
        let neutral = without(row, &model.values);
        let noise = (self.noise_n, inflation);
        let portrait = Portrait::of(self.bench, model, &fitted(row), &neutral, self.conditions, noise)?;
        let is_noise = self.excess(model) <= WORTH;
        doubt(&portrait, is_noise)
    }

    /// The parameter that an effect cannot be told from, where the log determines none of the effect's own; an offset at the platform is one
    /// that every cable may have.
    fn confused_with(&self, model: &Trial, row: &EffectRow) -> Option<&'static str> {
        let mut free = model.free.clone();
        let has_offset = free.iter().any(|parameter| [OFFSET, OFFSET_OF_SENSOR].contains(&parameter.place()));
        free.extend(Parameter::all().filter(|parameter| parameter.place() == OFFSET && !has_offset));
        let of_row = fitted(row);
        let (covariance, all) = engine::vagueness(&self.bench.problem(&free, None), &[model.values]);
        let own = |of: &engine::Unknown| of_row.contains(&of.parameter);
        if all.iter().any(|(vagueness, of)| own(of) && *vagueness <= 1.0) {
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
    fn tried(&mut self, rows: &[&'static EffectRow]) -> Vec<Tried> {
        let model = self.fit(rows);
        if self.excess(&model) <= NEGLIGIBLE {
            return Vec::new();
        }
        let mut tried: Vec<Tried> = self
            .round(rows)
            .into_iter()
            .filter(|(_, trial)| trial.held_out < model.held_out && trial.training < model.training)
            .map(|(row, trial)| {
                let inflation = inflation(self.bench, &trial, &fitted(row));
                let cycle_s = self.bench.record.cycle_s;
                let refusal = if is_at_end(row, &trial.values, cycle_s) {
                    Refusal::AtBound
                } else {
                    self.refused.get(row.kind).copied().unwrap_or(Refusal::Weak)
                };
                Tried { row, trial, inflation, refusal }
            })
            .filter(|tried| self.delta_bic(&model, &tried.trial, tried.inflation) < 0.0)
            .collect();
        tried.sort_by(|one, other| one.trial.training.total_cmp(&other.trial.training));
        tried
    }
}

/// The values of a model without an effect.
fn without(row: &EffectRow, values: &Values) -> Values {
    let mut neutral = *values;
    for parameter in Parameter::of_row(row) {
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
fn delta_bic(count: f64, squares_ratio: f64, more: f64) -> f64 {
    if count < 2.0 { f64::INFINITY } else { count * squares_ratio.ln() + more * count.ln() }
}

/// Whether a parameter of an effect has run into an end of its range that is not its neutral value; of friction that every model
/// has the ranges are orders of magnitude.
fn is_at_end(row: &EffectRow, values: &Values, cycle_s: f64) -> bool {
    let has_run = |parameter: &Parameter| {
        let (least, greatest) = Coordinate::of(parameter, cycle_s).range();
        let neutral = parameter.row().neutral;
        let left = |end: f64| (end - values[parameter.place()]).abs() / (end - neutral).abs();
        [least, greatest].into_iter().any(|end| left(end) < END_RATIO)
    };
    !is_friction(row) && fitted(row).iter().any(has_run)
}

/// Whether a model has so much less of the squares held out than another, N².
fn gains(before: &Trial, after: &Trial, enough: f64) -> bool {
    before.held_out - after.held_out > enough
}

/// The best on the samples learned from.
fn best(tried: impl IntoIterator<Item = (&'static EffectRow, Trial)>) -> Option<(&'static EffectRow, Trial)> {
    tried.into_iter().min_by(|(_, one), (_, other)| one.training.total_cmp(&other.training))
}

fn contains(rows: &[&'static EffectRow], row: &EffectRow) -> bool {
    rows.iter().any(|of| of.kind == row.kind)
}

fn kinds(rows: &[&'static EffectRow]) -> Kinds {
    let mut kinds: Kinds = rows.iter().map(|row| row.kind).collect();
    kinds.sort_unstable();
    kinds
}

#[cfg(test)]
mod tests {
    use fric_core::effects::{presliding_shape, pulley_inertia, stribeck, time_delay};
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
        for (row, inside, end) in
            [(presliding_shape::ROW, 0.5, 0.3), (stribeck::ROW, 2.0, 5.0), (time_delay::ROW, 0.02, 0.063)]
        {
            let place = fitted(&row)[0].place();
            for (value, has_run) in [(inside, false), (end, true), (end * (1.0 - 1e-6), true)] {
                let mut values = neutral();
                values[place] = value;
                assert_eq!(is_at_end(&row, &values, CYCLE_S), has_run, "{}: {value}", row.kind);
            }
        }
        // At an end that is the neutral value there is only little of the effect.
        assert!(!is_at_end(&pulley_inertia::ROW, &neutral(), CYCLE_S));
    }

    #[test]
    fn what_nothing_is_known_of_is_no_evidence() {
        let few = delta_bic(10.0, 0.5, 1.0);
        assert!((few - (10.0 * 0.5_f64.ln() + 10.0_f64.ln())).abs() < 1e-12);
        assert!(delta_bic(0.0, 0.5, 1.0) > 0.0 && delta_bic(1.5, 0.01, 1.0) > 0.0);
    }
}
