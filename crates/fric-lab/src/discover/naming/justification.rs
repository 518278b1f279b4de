//! Criteria that an effect must meet to stay in a model.

use fric_core::effects::Effect;
use fric_core::effects::direction_asymmetry::VISCOUS as VISCOUS_ASYMMETRY;
use fric_core::effects::ripple::repeats_first;
use fric_core::effects::sensor_offset::OFFSET as OFFSET_OF_SENSOR;
use fric_core::parameters::{OFFSET, Values};

use super::evidence::inflation;
use super::rivals::{Chance, Rival, best_rival};
use super::steadiness::{Portrait, Steadiness};
use super::{LEAST_SIZE, Named, Refusal, STRONG_BIC, Search, set_of, without};
use crate::candidates::catalogue::{fitted, has};
use crate::discover::rest::WORTH;
use crate::discover::workbench::Trial;
use crate::effects;
use crate::fit::Parameter;
use crate::search::vector::Coordinate;

/// A parameter within this fraction of its bound counts as stuck at the bound, by the way from its neutral value.
const END_RATIO: f64 = 0.01;
/// Maximum relative scatter (rms) of an effect's size between operating conditions. Below it, one constant explains at least four fifths of what one
/// size per condition would.
const MOST_SCATTER_RATIO: f64 = 0.5;
/// An effect is bent if a size that varies with a condition would explain more than this fraction of the excess above the noise.
const MOST_BENT: f64 = 0.5;
/// It is not if that size varies by less than this fraction over the condition. Then the name is right, and the rest is another, smaller effect.
const MOST_TILT: f64 = 0.2;

impl Search<'_, '_> {
    /// Returns every effect of a model with its evidence and, if it cannot stay, the reason.
    pub(super) fn justified(&mut self, found: &[Effect]) -> Vec<Named> {
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
            let refusal = refusal
                .or_else(|| self.usual_instead(found, effect, inflation))
                .or_else(|| self.straight(&others, effect, inflation));
            let with = model.clone();
            named.push(Named { effect, with, without, runner_up: None, is_as_good: false, inflation, refusal });
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

    /// Whether strong evidence for an effect is missing once another effect of a typical size is in the model, or friction that every robot has and that
    /// this log cannot distinguish.
    fn usual_instead(&mut self, found: &[Effect], effect: Effect, inflation: f64) -> Option<Refusal> {
        let is_usual = |(other, refusal): (&Effect, &Refusal)| {
            (counts_as_usual(*refusal, *other, effect) && !found.contains(other)).then_some(*other)
        };
        let usual: Vec<Effect> = self.refused.iter().filter_map(is_usual).collect();
        let others: Vec<Effect> = found.iter().copied().filter(|other| *other != effect).collect();
        usual.into_iter().find_map(|usual| {
            let (_, with) = self.beside(found, &[usual]).pop()?;
            let (_, without) = self.beside(&others, &[usual]).pop()?;
            (self.delta_bic(&without, &with, inflation) >= -STRONG_BIC).then_some(Refusal::UsualInstead(usual))
        })
    }

    /// Whether another effect explains as much in the place of one, at a size that sound robots have. Friction that every model has is not replaced.
    pub(super) fn usual_in_place_of(&mut self, found: &[Effect], named: &Named) -> Option<Refusal> {
        if named.effect.is_friction() {
            return None;
        }
        let others: Vec<Effect> = found.iter().copied().filter(|other| *other != named.effect).collect();
        let enough = self.delta_bic(&named.without, &named.with, named.inflation) + STRONG_BIC;
        let mut rivals = self.round(&others);
        rivals.retain(|(other, _)| *other != named.effect);
        let is_usual = |(other, trial): &(Effect, Trial)| {
            let is_more = effects::of(*other).is_some_and(|lab| (lab.is_more_than_usual)(&trial.values, &self.around));
            !is_more && counts_as_usual(Refusal::usual(*other), *other, named.effect)
        };
        rivals.retain(is_usual);
        let as_good =
            rivals.into_iter().find(|(_, trial)| self.delta_bic(&named.without, trial, named.inflation) < enough);
        as_good.map(|(usual, _)| Refusal::UsualInstead(usual))
    }

    /// Whether strong evidence for a curve is missing beside a straight line. Where the loads are few or uneven, a bent sensor does what a gain with an offset
    /// would; a warm-up that the log is too short for is a drift.
    fn straight(&mut self, others: &[Effect], effect: Effect, inflation: f64) -> Option<Refusal> {
        let of_a_line: &[Effect] = match effect {
            Effect::SensorNonlinearity => &[Effect::SensorGain, Effect::SensorOffset],
            Effect::SensorWarmup => &[Effect::SensorDrift],
            Effect::FrictionWarmup => &[Effect::FrictionDrift],
            _ => return None,
        };
        let model = self.fit(others);
        let is_there = |of: &Effect| {
            let is_zero = *of == Effect::SensorOffset && self.bench.has_zero(&model.free);
            is_zero || others.contains(of) || has(*of, &model.values)
        };
        let missing: Vec<Effect> = of_a_line.iter().copied().filter(|of| !is_there(of)).collect();
        let mut line = others.to_vec();
        self.add(&mut line, &missing);
        let straight = self.fit(&line);
        let bent = self.fit(&[others, &[effect]].concat());
        (self.delta_bic(&straight, &bent, inflation) >= -STRONG_BIC).then_some(Refusal::Straight)
    }

    /// Returns a law without a name that makes some of the effects superfluous.
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

    /// Returns the reason why an effect cannot stay in a model.
    fn refusal(&self, model: &Trial, effect: Effect, without_it: &Trial, inflation: f64) -> Option<Refusal> {
        let cycle_s = self.bench.record.cycle_s;
        if is_at_end(effect, &model.values, cycle_s) {
            return Some(Refusal::AtBound);
        }
        if let Some(open) = self.open_beside(model, effect) {
            return Some(open);
        }
        let gain = without_it.held_out - model.held_out;
        let is_strong = self.delta_bic(without_it, model, inflation) < -STRONG_BIC;
        if !is_strong || gain <= LEAST_SIZE * self.noise_squares {
            return Some(Refusal::Weak);
        }
        let lab = effects::of(effect)?;
        if !(lab.is_more_than_usual)(&model.values, &self.around) {
            return Some(Refusal::usual(effect));
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

    /// Returns the parameter that an effect cannot be distinguished from, if the log determines none of the effect's own parameters even with its
    /// others known. An offset at the platform is considered too, because every cable may have one.
    fn confused_with(&self, model: &Trial, effect: Effect) -> Option<Parameter> {
        let mut free = model.free.clone();
        let has_zero = self.bench.has_zero(&free) || free.iter().any(|of| of.place() == OFFSET_OF_SENSOR);
        free.extend(Parameter::all().filter(|parameter| parameter.place() == OFFSET && !has_zero));
        let of_effect = fitted(effect);
        let (covariance, all) =
            crate::certainty::undetermined::vagueness(&self.bench.problem(&free, None), &[model.values]);
        let own = |of: &crate::search::solve::Unknown| of_effect.contains(&of.parameter);
        // Confusion among the effect's own parameters does not concern other effects.
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
        Some(all[other].1.parameter)
    }
}

/// Whether an effect that is refused so may be what is taken for a name, as on a sound robot.
fn counts_as_usual(refusal: Refusal, of: Effect, name: Effect) -> bool {
    match refusal {
        Refusal::Usual => true,
        // A zero and a gain are what such an effect degenerates to.
        Refusal::Degenerate => ![Effect::SensorOffset, Effect::SensorGain].contains(&name),
        Refusal::Open(_) => of.is_friction(),
        _ => false,
    }
}

/// Whether something else is mistaken for an effect, so that its size is not one constant.
fn doubt(portrait: &Portrait<'_>, is_noise: bool) -> Option<Refusal> {
    let all = portrait.steadiness();
    let scatters = |of: &&Steadiness| of.scatter > MOST_SCATTER_RATIO * MOST_SCATTER_RATIO;
    let unsteady = all.iter().filter(scatters).max_by(|one, other| one.scatter.total_cmp(&other.scatter));
    if let Some(unsteady) = unsteady {
        return Some(Refusal::Unsteady(unsteady.signal));
    }
    let bent = all.iter().filter(|of| !is_noise && of.bent > MOST_BENT && of.tilt > MOST_TILT);
    bent.max_by(|one, other| one.bent.total_cmp(&other.bent)).map(|bent| Refusal::Bent(bent.signal))
}

/// Whether a parameter of an effect is stuck at a bound other than its neutral value, or the period of a second ripple at that of the first. For friction
/// that every model has, the ranges span orders of magnitude.
pub fn is_at_end(effect: Effect, values: &Values, cycle_s: f64) -> bool {
    // Viscous friction that acts one way only is no run-away search: it is what little there is of it may end up as.
    let has_run = |parameter: &Parameter| {
        let (least, greatest) = Coordinate::of(parameter, cycle_s).range();
        let neutral = parameter.row().neutral;
        let left = |end: f64| (end - values[parameter.place()]).abs() / (end - neutral).abs();
        parameter.place() != VISCOUS_ASYMMETRY && [least, greatest].into_iter().any(|end| left(end) < END_RATIO)
    };
    repeats_first(effect, values) || !effect.is_friction() && fitted(effect).iter().any(has_run)
}

#[cfg(test)]
mod tests {
    use fric_core::effects::Effect;
    use fric_core::parameters::{PARAMETER_COUNT, Values};

    use super::{fitted, is_at_end};
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
        // At a bound that is the neutral value the effect is merely small.
        assert!(!is_at_end(Effect::PulleyInertia, &neutral(), CYCLE_S));
    }
}
