//! Which effects are missing: candidates enter, are exchanged, and have to justify themselves.
//!
//! 1. *Enter.* Every candidate is fitted together with all that the model has. The best on the samples learned from with strong evidence
//!    enters if it also helps on those held out. Where none has strong evidence alone, those enter that have it beside each other. Friction that
//!    every model has needs no strong evidence here: what is missing of it hides the rest.
//! 2. *Leave.* An effect stays if the evidence for it is strong, if it is large enough to matter, if its parameters keep clear of the
//!    ends of their ranges and can be told from the others, if it has one size in every operating condition, and if neither a law without a name
//!    nor an effect of a size that robots usually have makes it superfluous. One that cannot stay is set aside, and the next has its turn.
//! 3. *Exchange.* For every effect that stays, all others are tried in its place.
//!
//! What was set aside gets another turn beside all that has been found since.

mod entry;
pub mod evidence;
mod fits;
pub mod justification;
pub mod projection;
mod rivals;
mod steadiness;

use std::collections::{BTreeMap, BTreeSet};

use fric_core::effects::Effect;
use fric_core::effects::empirical::SHARES;
use fric_core::parameters::Values;

use self::evidence::{delta_bic, inflation};
use self::justification::is_at_end;
use super::workbench::{Trial, Workbench};
use crate::candidates::catalogue::fitted;
use crate::effects::Around;
use crate::fit::Parameter;
use crate::samples::conditions::Condition;

/// Of the squares above the noise that are left, a candidate has to take away this share to enter.
pub const LEAST_GAIN: f64 = 0.02;
/// A candidate takes away at least this share of the noise's own squares, half of what is negligible: the rms falls by a quarter of a per
/// cent. Less is what the equation of another effect leaves: at 0.002, four of 250 extended files were given a second name so small.
pub const LEAST_SIZE: f64 = 0.5 * NEGLIGIBLE;
/// What is left above the noise, as a share of it, from which on no further name is sought: the rms is half of it above.
pub const NEGLIGIBLE: f64 = 0.01;
/// Minimum ΔBIC to keep an effect, and to prefer one name over another. 10 would do if the memory of the residual were
/// known; where noise wanders, the best of a dozen candidates comes to nearly 30 by chance.
pub const STRONG_BIC: f64 = 30.0;
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

/// The search on one cable. Every set of effects is fitted once.
pub struct Search<'b, 'a> {
    bench: &'b Workbench<'a>,
    noise_n: f64,
    noise_squares: f64,
    around: Around,
    conditions: &'b [Condition],
    fits: BTreeMap<Set, Trial>,
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
        if self.bench.knows_load(self.noise_n) {
            return BTreeMap::new();
        }
        let of_the_curve = [Effect::SensorGain, Effect::SensorNonlinearity];
        of_the_curve.into_iter().map(|effect| (effect, Refusal::Open("offset_n"))).collect()
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

    /// Tries all other effects in the place of each; whether one was better.
    fn exchange(&mut self, found: &mut [Effect]) -> bool {
        let mut is_changed = false;
        for place in 0..found.len() {
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

/// The best on the samples learned from.
fn best(tried: impl IntoIterator<Item = (Effect, Trial)>) -> Option<(Effect, Trial)> {
    tried.into_iter().min_by(|(_, one), (_, other)| one.training.total_cmp(&other.training))
}

fn set_of(found: &[Effect]) -> Set {
    let mut set = found.to_vec();
    set.sort_unstable();
    set
}
