//! What a search has found.

use fric_core::effects::Effect;

use super::refusal::Refusal;
use crate::discover::workbench::Trial;

/// An effect in a model with its evidence.
#[derive(Clone, Debug)]
pub struct Named {
    /// The effect.
    pub effect: Effect,
    /// The model with the effect in which it was judged.
    pub with: Trial,
    /// The model without the effect, fitted again.
    pub without: Trial,
    /// The best other effect in its place.
    pub runner_up: Option<(Effect, Trial)>,
    /// Whether that explains as much although its BIC is worse: a lag of the sensor, seen behind the lag, or what goes with the load in the place
    /// of a zero, under one load.
    pub is_as_good: bool,
    /// Factor by which memory in the residual weakens the evidence, at least 1.
    pub inflation: f64,
    /// The reason why the effect cannot stay.
    pub(super) refusal: Option<Refusal>,
}

/// The outcome of naming.
#[derive(Clone, Debug)]
pub struct Naming {
    /// The model with all effects found.
    pub model: Trial,
    /// The effects found, in the order in which they entered.
    pub named: Vec<Named>,
    /// The models from the given one to the final one: one more than there are effects.
    pub ladder: Vec<Trial>,
    /// The first fit of every candidate beside the given model.
    pub first_round: Vec<(Effect, Trial)>,
    /// Candidates that improve the final model but do not suffice, the best first.
    pub tried: Vec<Tried>,
}

impl Naming {
    /// Returns the effects found.
    pub fn effects(&self) -> Vec<Effect> {
        self.named.iter().map(|named| named.effect).collect()
    }

    /// Returns this naming with what a search from its model has named beyond it.
    pub fn followed_by(self, beyond: Self) -> Self {
        Self {
            model: beyond.model,
            named: [self.named, beyond.named].concat(),
            ladder: self.ladder.into_iter().chain(beyond.ladder.into_iter().skip(1)).collect(),
            first_round: self.first_round,
            tried: beyond.tried,
        }
    }
}

/// A candidate that helps but does not suffice.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The effect.
    pub effect: Effect,
    /// The model with the effect.
    pub trial: Trial,
    /// Factor by which memory in the residual weakens the evidence, at least 1.
    pub inflation: f64,
    /// The reason why it is not named.
    pub refusal: Refusal,
    /// Whether nearly all that is left goes with it.
    pub takes_rest: bool,
}

impl Tried {
    /// Whether what is left may be this effect: one that sound robots have too, or that the log cannot tell from something else.
    pub fn may_be_rest(&self) -> bool {
        self.takes_rest && self.refusal.leaves_open()
    }
}
