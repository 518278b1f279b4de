//! Finds which effects are missing: candidates enter, are exchanged, and must justify themselves.
//!
//! 1. *Enter.* Every candidate is fitted together with everything that the model has. The best one on the training samples enters if its evidence is
//!    strong and it also helps on the held-out samples. Friction that every model has needs no strong evidence here, because a missing part of it hides
//!    everything else.
//! 2. *Leave.* An effect stays if all of the following hold: the evidence for it is strong; it is large enough to matter; its parameters keep clear
//!    of their bounds and can be distinguished from the others; it has one size in every operating condition; and neither an unnamed law nor an
//!    effect of typical size makes it superfluous. An effect that cannot stay is set aside, and the next one is tried.
//! 3. *Exchange.* Each remaining effect is compared with every other effect in its place, and one may take the place of several. A delay is finally compared with a lag of the sensor, which it
//!    may be although the lag leaves more noise.
//! 4. *Enter together.* If nothing changes any more and something is left, two or three effects enter that can stay only beside each other.
//!
//! Effects that were set aside are tried again beside everything that was found since.

mod entry;
pub mod evidence;
mod exchange;
mod fits;
pub mod justification;
mod late;
mod one_load;
mod outcome;
pub mod projection;
mod refusal;
mod rivals;
mod steadiness;
mod together;
mod tried;

use std::collections::{BTreeMap, BTreeSet};

use fric_core::effects::Effect;
use fric_core::effects::empirical::SHARES;
use fric_core::effects::sensor_gain::GAIN;
use fric_core::parameters::{MU, OFFSET, Values};

use self::entry::LAST_TURNS;
use self::evidence::delta_bic;
use super::effort::Effort;
use super::lack::has_one_speed;
use super::workbench::{Trial, Workbench};
use crate::candidates::catalogue::has;
use crate::certainty::one_load::{is_gain, is_one_load};
use crate::effects::Around;
use crate::fit::Parameter;
use crate::samples::conditions::Condition;
use crate::samples::noise::VARIANCE_ERROR;

pub use outcome::{Named, Naming, Tried};
pub use refusal::Refusal;

/// Minimum fraction of the remaining squares above the noise that a candidate must remove to enter.
pub const LEAST_GAIN: f64 = 0.02;
/// A candidate removes at least this fraction of the noise's own squares, half of what is negligible: the rms falls by 0.25 %. A smaller gain is
/// typical of the model error of another effect: at 0.002, four of 250 extended files received a second name of this size.
pub const LEAST_SIZE: f64 = 0.5 * NEGLIGIBLE;
/// Excess above the noise, as a fraction of the noise variance, below which no further name is sought. The rms then exceeds the noise by half of this
/// fraction.
pub const NEGLIGIBLE: f64 = 0.01;
/// Minimum ΔBIC to keep an effect, and to prefer one name over another. 10 would suffice if the memory of the residual were known. Under drifting
/// noise, the best of a dozen candidates reaches nearly 30 by chance.
pub const STRONG_BIC: f64 = 30.0;
/// The parameters of a name together are at least this many standard errors away from the values at which it does nothing. Many candidates are tried, and some
/// are two away by chance. Half of it let two false names, of 0.5 and 1.4 %, pass in 358 simulated logs. Double was not tried: the asymmetry of a real drive is
/// about seven away.
pub const LEAST_AWAY: f64 = 4.0;
/// Maximum number of rounds of entering, exchanging and justifying, and of passes in which everything that was refused is tried again.
const ROUNDS: usize = 8;
const PASSES: usize = 2;

/// A set of effects, sorted.
type Set = Vec<Effect>;

/// The search on one cable. Every set of effects is fitted once.
pub struct Search<'b, 'a> {
    bench: &'b Workbench<'a>,
    noise_n: f64,
    noise_squares: f64,
    /// Standard error of the noise variance, as a fraction of it.
    noise_error: f64,
    around: Around,
    conditions: &'b [Condition<'a>],
    effort: &'b Effort,
    /// Number of candidates that may still be judged once the work is spent.
    last_turns: usize,
    /// Number of effects that the model has from the start.
    given_count: usize,
    fits: BTreeMap<Set, Trial>,
    /// Fits of another search from which the first fits of these sets start.
    earlier: BTreeMap<Set, Trial>,
    /// Refused candidates and the reasons.
    refused: BTreeMap<Effect, Refusal>,
    /// Candidates that stay refused, and the reasons.
    excluded: BTreeMap<Effect, Refusal>,
    /// For effects in sets: the factor by which memory weakens the evidence, and the reason why the effect cannot stay.
    judged: BTreeMap<(Set, Effect), (f64, Option<Refusal>)>,
    /// Sets that no unnamed law makes superfluous.
    unrivalled: BTreeSet<Set>,
}

impl<'b, 'a> Search<'b, 'a> {
    /// Starts a search from the fitted given model. `noise_n` is the standard deviation of the noise.
    pub fn new(
        bench: &'b Workbench<'a>,
        noise_n: f64,
        around: Around,
        base: &Trial,
        conditions: &'b [Condition<'a>],
        effort: &'b Effort,
    ) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
        let [learned, held_out] = [false, true].map(|held_out| bench.count(held_out) as f64);
        let noise_squares = held_out * noise_n * noise_n;
        let fits = BTreeMap::from([(Set::new(), base.clone())]);
        Self {
            bench,
            noise_n,
            noise_squares,
            noise_error: VARIANCE_ERROR / (learned + held_out).sqrt(),
            around,
            conditions,
            effort,
            last_turns: LAST_TURNS,
            given_count: Effect::CATALOGUE.iter().filter(|effect| has(**effect, &base.values)).count(),
            fits,
            earlier: BTreeMap::new(),
            refused: BTreeMap::new(),
            excluded: BTreeMap::new(),
            judged: BTreeMap::new(),
            unrivalled: BTreeSet::new(),
        }
    }

    /// Returns the search for what a model with the effects found lacks, as the given model of the same samples. Its candidates start from the fits that
    /// this search has of them beside these effects.
    pub fn beyond(&self, found: &[Effect], base: &Trial, noise_n: f64, around: Around) -> Self {
        let is_beside = |(set, _): &(&Set, &Trial)| found.iter().all(|effect| set.contains(effect));
        let beside = |(set, trial): (&Set, &Trial)| {
            (set.iter().copied().filter(|effect| !found.contains(effect)).collect(), trial.clone())
        };
        let earlier = self.fits.iter().filter(is_beside).map(beside).collect();
        let excluded = self.excluded.clone();
        Self { earlier, excluded, ..Self::new(self.bench, noise_n, around, base, self.conditions, self.effort) }
    }

    /// Refuses an effect from now on.
    pub fn refuse(&mut self, effect: Effect, refusal: Refusal) {
        self.excluded.insert(effect, refusal);
    }

    /// Names the effects that the model lacks. Effects that were found before are in the model from the start and must justify themselves like the
    /// others.
    pub fn run(&mut self, before: &[Effect]) -> Naming {
        let base = self.fit(&[]);
        let first_round = if self.excess(&base) > NEGLIGIBLE { self.round(&[]) } else { Vec::new() };
        let mut found = Vec::new();
        self.add(&mut found, before);
        let mut named = Vec::new();
        for _ in 0..PASSES {
            let before = set_of(&found);
            self.refused = self.never_tried(&found);
            named = self.pass(&mut found);
            if set_of(&found) == before || self.is_spent(&found) {
                break;
            }
        }
        while let Some((effect, usual)) =
            named.iter().find_map(|named| Some((named.effect, self.usual_in_place_of(&found, named)?)))
        {
            found.retain(|of| *of != effect);
            self.refused.insert(effect, usual);
            named = self.pass(&mut found);
        }
        for (place, named) in named.iter_mut().enumerate() {
            named.runner_up = self.alternative(&found, place);
            if let Some(lagging) = self.lag_in_place_of(&found, named.effect) {
                (named.runner_up, named.is_as_good) = (Some((Effect::SensorLag, lagging)), true);
            }
            if let Some(other) = self.as_good_under_one_load(&found, named.effect) {
                (named.runner_up, named.is_as_good) = (Some(other), true);
            }
        }
        let tried = self.tried(&found);
        self.polish(&found);
        let model = self.fit(&found);
        for named in &mut named {
            named.with = model.clone();
        }
        let ladder = (0..=found.len()).map(|count| self.fit(found.get(..count).unwrap_or_default())).collect();
        Naming { model, named, ladder, first_round, tried }
    }

    /// Whether the search has to come to an end.
    fn is_spent(&self, found: &[Effect]) -> bool {
        self.effort.is_spent(self.given_count + found.len())
    }

    /// Returns the candidates that no log like this one can justify beside the effects found.
    fn beyond_the_log(&mut self, found: &[Effect]) -> BTreeMap<Effect, Refusal> {
        let of_the_curve: &[Effect] = &[Effect::SensorGain, Effect::SensorNonlinearity];
        let of_the_speed: &[Effect] = &[Effect::Viscous, Effect::Stribeck, Effect::ViscousNonlinearity];
        let model = self.fit(found);
        let has_one_load = !self.bench.knows_load(self.noise_n) && !self.tells_gain(found);
        let is_beside_gain =
            model.free.iter().any(is_gain) && is_one_load(&self.bench.problem(&[], None), &model.values);
        let has_one_speed = has_one_speed(&self.bench.record);
        let open = [
            (has_one_load, of_the_curve, OFFSET),
            (is_beside_gain, &[Effect::SensorOffset][..], GAIN),
            (has_one_speed, of_the_speed, MU),
        ];
        let effects = open.into_iter().filter(|(is_open, ..)| *is_open).flat_map(|(_, effects, place)| {
            let from = Parameter::all().find(|of| of.place() == place);
            effects.iter().filter_map(move |effect| Some((*effect, Refusal::Open(from?))))
        });
        effects.collect()
    }

    /// Returns the candidates that are never tried: those beyond the log, and those that by the reported values and intervals cannot stay.
    fn never_tried(&mut self, found: &[Effect]) -> BTreeMap<Effect, Refusal> {
        let mut all = self.beyond_the_log(found);
        all.extend(self.excluded.iter().map(|(effect, refusal)| (*effect, *refusal)));
        all
    }

    /// Adds candidates and tests whether they can stay, until nothing changes. A candidate that cannot stay is set aside, and the next one is tried.
    /// The remaining effects are then exchanged for better ones.
    fn pass(&mut self, found: &mut Vec<Effect>) -> Vec<Named> {
        for _ in 0..ROUNDS {
            let before = self.refused.len();
            self.enter(found);
            let named = self.leave(found);
            if self.refused.len() == before
                && !self.exchange(found)
                && !self.gather(found)
                && !self.enter_together(found)
            {
                return named;
            }
        }
        self.leave(found)
    }

    /// Sets aside the effects that cannot justify themselves, the weakest first.
    fn leave(&mut self, found: &mut Vec<Effect>) -> Vec<Named> {
        loop {
            let named = self.justified(found);
            let Some((effect, refusal)) = refused(&named).first().copied() else { return named };
            found.retain(|of| *of != effect);
            // Effects that could not be distinguished from this one can be distinguished without it.
            self.refused.retain(|_, refusal| !matches!(refusal, Refusal::Open(of) if of.effect() == Some(effect)));
            self.refused.insert(effect, refusal);
            self.renumber(found);
        }
    }

    /// Returns the effects of a model that cannot justify themselves, and the reasons, the weakest first. The model was fitted elsewhere.
    pub fn refused_in(&mut self, model: Trial, found: &[Effect]) -> Vec<(Effect, Refusal)> {
        self.fits.insert(set_of(found), model);
        refused(&self.justified(found))
    }

    /// Returns the reason why an effect was set aside; `None` if it was not.
    pub fn reason_against(&self, effect: Effect) -> Option<Refusal> {
        self.refused.get(&effect).copied()
    }

    /// Makes a second ripple the first where the first is gone, as in a robot file. What was refused is then the second.
    fn renumber(&mut self, found: &mut [Effect]) {
        let given = self.fit(&[]).values;
        for place in 0..found.len() {
            let second = found[place];
            let Some(first) = second.first().filter(|first| !found.contains(first) && !has(*first, &given)) else {
                continue;
            };
            let mut trial = self.fit(found);
            for (from, to) in Parameter::of(second).zip(Parameter::of(first)) {
                trial.values[to.place()] = trial.values[from.place()];
                trial.values[from.place()] = from.row().neutral;
                trial.free.iter_mut().filter(|of| **of == from).for_each(|of| *of = to);
            }
            found[place] = first;
            let set = set_of(found);
            self.judged.retain(|(of, _), _| *of != set);
            self.unrivalled.remove(&set);
            self.fits.insert(set, trial);
            if let Some(refusal) = self.refused.remove(&first) {
                self.refused.insert(second, refusal);
            }
            if let Some(refusal) = self.excluded.remove(&first) {
                self.excluded.insert(second, refusal);
            }
        }
    }

    /// Returns the BIC difference from one model to another over the training samples; a negative value favours the second.
    pub fn delta_bic(&self, from: &Trial, to: &Trial, inflation: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (self.bench.count(false) as f64 / inflation, to.free.len() as f64 - from.free.len() as f64);
        delta_bic(count, to.training / from.training, more)
    }

    /// Returns the same difference for a table, from the sums of squares without and with it.
    pub fn delta_bic_of_table(&self, [without, with]: [f64; 2], inflation: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (self.bench.count(false) as f64 / inflation, SHARES as f64);
        delta_bic(count, with / without, more)
    }
}

/// Returns the effects that cannot justify themselves, and the reasons, the weakest first.
fn refused(named: &[Named]) -> Vec<(Effect, Refusal)> {
    let mut refused: Vec<(&Named, Refusal)> = named.iter().filter_map(|named| Some((named, named.refusal?))).collect();
    refused.sort_by(|(one, _), (other, _)| one.without.held_out.total_cmp(&other.without.held_out));
    refused.into_iter().map(|(named, refusal)| (named.effect, refusal)).collect()
}

/// Returns the values of a model without an effect.
fn without(effect: Effect, values: &Values) -> Values {
    let mut neutral = *values;
    for parameter in Parameter::of(effect) {
        neutral[parameter.place()] = parameter.row().neutral;
    }
    neutral
}

fn set_of(found: &[Effect]) -> Set {
    let mut set = found.to_vec();
    set.sort_unstable();
    set
}
