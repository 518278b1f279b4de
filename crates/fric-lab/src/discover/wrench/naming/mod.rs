//! Names what the model of all cables lacks: effects of single cables, effects that all cables have alike, and wrong entries of the robot file.
//!
//! The search works in rounds:
//!
//! 1. *Enter.* Candidates enter one after the other, each time the one with the most evidence on the training samples that also helps on the held-out
//!    samples. Several cables with the same effect become one effect with the same parameters if that explains as much, and the other way round.
//! 2. *Leave.* A name stays if the evidence for it is strong, also outside the block in which it helps most; it is large enough to matter; it exceeds
//!    what robots without it show; its parameters keep clear of their bounds; and cables that have it alike agree in it. If at least three
//!    other cables have the effect with strong evidence, [`LEAST_AWAY`] standard errors take the place of strong evidence; all else holds. The least significant name that cannot stay is set aside, and does not
//!    return in this search.
//! 3. *Exchange.* Each name is compared with the best other candidate in its place. An effect that several other cables have too gives way only to strong
//!    evidence.
//! 4. *Alone.* Beside the forces of the others, the wrench shows the force of one cable. On that log of one cable its names have to keep the rules of a search on
//!    one cable.
//!
//! The search ends if nothing changes, after [`ROUNDS`] rounds of at most [`MOST`] names, and in any case when its work is spent ([`Effort`](crate::discover::effort::Effort)). It begins without a name or, where that is better
//! than any single name, with all force sensors in doubt.

mod alone;
mod doubt;
mod entry;
mod exchange;
mod fits;
mod justification;
mod standing;

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Matrix6;

use self::standing::standings;
use super::bench::{Bench, Trial};
use super::candidate::Candidate;
use super::covariance::whitening;
use super::geometry::Geometry;
use super::model::Model;
use super::screen::Promise;
use crate::discover::cable::BELIEVED_RATIO;
use crate::discover::naming::{LEAST_AWAY, Refusal};
use crate::discover::rest::WORTH;

pub use self::doubt::{is_better, sensors_doubted};

/// Maximum number of names.
const MOST: usize = 16;
/// Maximum number of rounds.
const ROUNDS: usize = 6;
/// Distance from its minimum to which a model with a candidate is optimised, in standard errors.
const NEAR_ERRORS: f64 = 0.5;
/// Minimum number of cables with the same effect that may become one effect of all cables, of other cables with an effect that make it no surprise on one more,
/// and of sensors in doubt that are judged together.
const LEAST_ALIKE: usize = 3;

/// A name with its evidence.
#[derive(Clone, Debug)]
pub struct Named {
    pub candidate: Candidate,
    /// BIC of the model with it minus that of the model without it.
    pub delta_bic: f64,
    /// The best other candidate in its place, the same difference for that one, and whether it is as good.
    pub runner_up: Option<(Candidate, f64, bool)>,
}

/// A candidate that helps but does not suffice.
#[derive(Clone, Debug)]
pub struct Tried {
    pub candidate: Candidate,
    pub delta_bic: f64,
    pub refusal: Refusal,
}

/// The outcome of a search.
#[derive(Clone, Debug)]
pub struct Naming {
    /// The model with all names.
    pub trial: Trial,
    /// The whitening with which it was fitted.
    pub whitening: Matrix6<f64>,
    pub named: Vec<Named>,
    /// Candidates that help this model but do not suffice, the best first.
    pub tried: Vec<Tried>,
    /// Whether the model leaves nothing beside the noise that needs an explanation.
    pub is_complete: bool,
    /// Whether the search had to come to an end, so that no further one begins.
    pub is_cut_short: bool,
}

impl Naming {
    /// Returns the start of a search that begins with some names.
    pub fn start(trial: Trial, whitening: &Matrix6<f64>, candidates: Vec<Candidate>) -> Self {
        let named = |candidate| Named { candidate, delta_bic: f64::NAN, runner_up: None };
        let named = candidates.into_iter().map(named).collect();
        Self { trial, whitening: *whitening, named, tried: Vec::new(), is_complete: false, is_cut_short: false }
    }

    /// Returns what is named.
    pub fn candidates(&self) -> Vec<Candidate> {
        self.named.iter().map(|named| named.candidate).collect()
    }

    /// Returns the model as `fit` fits it, with its whitening, and drops the names that are no longer significant there; `None` if there are no deviations.
    pub fn confirmed(
        &mut self,
        bench: &Bench<'_>,
        fit: impl Fn(&Model) -> Option<(Trial, Matrix6<f64>)>,
    ) -> Option<(Trial, Matrix6<f64>)> {
        loop {
            let (fitted, whitening) = fit(&self.trial.model)?;
            let bench = Bench { whitening, ..bench.clone() };
            let found = self.candidates();
            let all = standings(&bench, &fitted, &found).into_iter().zip(&found);
            let weakest = all.min_by(|(one, _), (other, _)| one.away.total_cmp(&other.away));
            let Some((_, candidate)) = weakest.filter(|(standing, _)| standing.away < LEAST_AWAY) else {
                return Some((fitted, whitening));
            };
            candidate.remove_from(&mut self.trial.model);
            self.named.retain(|named| named.candidate != *candidate);
        }
    }

    /// Returns the names that are entries of the robot file.
    pub fn geometries(&self) -> impl Iterator<Item = (&Named, Geometry)> {
        self.named.iter().filter_map(|named| match named.candidate {
            Candidate::Geometry(of) => Some((named, of)),
            _ => None,
        })
    }
}

/// Mean squared whitened deviation of a sample that friction models make which are not exact.
struct Believed {
    /// If the errors of the cables are independent.
    apart: f64,
    /// If they add up, as those of a law that all cables have alike.
    together: f64,
}

impl Believed {
    /// Returns what a candidate must explain more than.
    fn of(&self, candidate: Candidate) -> f64 {
        match candidate {
            Candidate::Own(..) => self.apart,
            Candidate::Alike(_) | Candidate::Geometry(_) => self.together,
        }
    }
}

/// A search. Every set of candidates is fitted and screened once.
pub struct Search<'a> {
    /// All cables with their samples, and the whitening of the model from which the search starts.
    bench: Bench<'a>,
    /// Mean squared whitened deviation of a sample by noise, and by independent errors of the cables' friction models.
    noise_square: f64,
    believed: Believed,
    /// Fitted models by the candidates in them, in order.
    fits: BTreeMap<Vec<Candidate>, Trial>,
    /// What further candidates promise beside such a model.
    promised: BTreeMap<Vec<Candidate>, Vec<Promise>>,
    /// Candidates that were set aside and the reasons.
    refused: BTreeMap<Candidate, Refusal>,
}

impl<'a> Search<'a> {
    /// Prepares a search beside the fitted given model, with the covariance and the noise of another model's deviations; `None` if there are too few
    /// deviations.
    pub fn new(bench: &Bench<'a>, base: &Trial, model: &Model) -> Option<Self> {
        let bench = Bench { whitening: whitening(bench, model)?, effort: Arc::default(), ..bench.clone() };
        let noise = bench.noise(model)?;
        let believed_square = |cables| bench.believed_square(model, BELIEVED_RATIO, cables);
        let count = bench.records.len();
        let unit_square = bench.unit_square(model);
        let believed = Believed {
            apart: unit_square * (0..count).map(|cable| believed_square(cable..cable + 1)).sum::<f64>(),
            together: unit_square * believed_square(0..count),
        };
        let noise_square = unit_square * noise.iter().map(|noise| noise * noise).sum::<f64>() + believed.apart;
        let base = bench.judged(base.model.clone());
        Some(Self {
            bench,
            noise_square,
            believed,
            fits: BTreeMap::from([(Vec::new(), base)]),
            promised: BTreeMap::new(),
            refused: BTreeMap::new(),
        })
    }

    /// Names what the model lacks. The names of a search before are in the model from the start, and must justify themselves like the others.
    pub fn run(mut self, before: &Naming) -> Naming {
        let mut found = before.candidates();
        if !found.is_empty() {
            self.fits.insert(set_of(&found), self.bench.fit(&before.trial.model, NEAR_ERRORS));
        }
        let mut named = self.rounds(&mut found);
        while let Some((candidate, refusal)) = self.refused_alone(&found) {
            found.retain(|of| *of != candidate);
            self.refused.insert(candidate, refusal);
            named = self.rounds(&mut found);
        }
        for (place, named) in named.iter_mut().enumerate() {
            named.runner_up = self.runner_up(&found, place);
        }
        let tried = self.tried(&found);
        let trial = self.fit(&found);
        let is_complete = self.excess(&trial) <= WORTH;
        let is_cut_short = self.is_spent(&found);
        Naming { trial, whitening: self.bench.whitening, named, tried, is_complete, is_cut_short }
    }

    /// Adds names, exchanges them and sets aside those that cannot stay, until nothing changes. Returns those that stay.
    fn rounds(&mut self, found: &mut Vec<Candidate>) -> Vec<Named> {
        for _ in 0..ROUNDS {
            let refused = self.refused.len();
            self.enter(found);
            self.unite(found);
            self.take_apart(found);
            self.leave(found);
            let is_exchanged = !self.is_spent(found) && self.exchange(found);
            if !is_exchanged && self.refused.len() == refused {
                break;
            }
        }
        // The last round may have exchanged a name.
        self.leave(found)
    }

    /// Whether the search has to come to an end.
    fn is_spent(&self, found: &[Candidate]) -> bool {
        self.bench.effort.is_spent(found.len())
    }
}

/// Returns the candidates in order.
fn set_of(found: &[Candidate]) -> Vec<Candidate> {
    let mut set = found.to_vec();
    set.sort_unstable();
    set
}

/// Whether at least [`LEAST_ALIKE`] other cables have, with strong evidence, the same effect as one cable has by a candidate. Then it is no surprise on
/// this one.
fn is_one_of_many(strong: &[Candidate], candidate: Candidate) -> bool {
    let Candidate::Own(_, effect) = candidate else { return false };
    let others = strong.iter().filter(|of| **of != candidate && matches!(of, Candidate::Own(_, own) if *own == effect));
    others.count() >= LEAST_ALIKE
}

/// Returns the candidates except one.
fn without(found: &[Candidate], candidate: Candidate) -> Vec<Candidate> {
    found.iter().copied().filter(|of| *of != candidate).collect()
}

#[cfg(test)]
mod tests {
    use fric_core::effects::Effect;

    use super::{Candidate, is_one_of_many};

    #[test]
    fn three_other_cables_make_an_effect_no_surprise() {
        let gain = |cable| Candidate::Own(cable, Effect::SensorGain);
        let strong = [gain(0), gain(1), gain(2), Candidate::Own(3, Effect::BearingDrag)];
        assert!(is_one_of_many(&strong, gain(5)));
        // Itself does not count, nor another effect, nor one that all cables have alike.
        assert!(!is_one_of_many(&strong, gain(2)));
        assert!(!is_one_of_many(&strong, Candidate::Own(5, Effect::BearingDrag)));
        assert!(!is_one_of_many(&strong, Candidate::Alike(Effect::SensorGain)));
    }
}
