//! Names what the model of all cables lacks: effects of single cables, effects that all cables have alike, and wrong entries of the robot file.
//!
//! The search works in rounds:
//!
//! 1. *Enter.* Candidates enter one after the other, each time the one with the most evidence on the training samples that also helps on the held-out
//!    samples. If a linear step with a gain of its own for each force sensor promises more evidence than any single candidate, the gains enter all at
//!    once: where every sensor is wrong, the friction has made up for that, and no sensor alone explains much. Several cables with the same effect
//!    become one effect with the same parameters if that explains as much, and the other way round.
//! 2. *Leave.* A name stays if the evidence for it is strong, also outside the block in which it helps most; it is large enough to matter; it exceeds
//!    what robots without it show; its parameters keep clear of their bounds; and cables that have it alike agree in it. The least significant name that
//!    cannot stay is set aside, and does not return in this search.
//! 3. *Exchange.* Each name is compared with the best other candidate in its place.
//!
//! The search ends if nothing changes, and in any case after [`ROUNDS`] rounds of at most [`MOST`] names. If something is left then, another one begins
//! with all force sensors in doubt.

mod doubt;
mod entry;
mod exchange;
mod fits;
mod justification;
mod standing;

use std::collections::BTreeMap;

use self::standing::standings;
use super::bench::{Bench, Model, Trial};
use super::candidate::Candidate;
use super::geometry::Geometry;
use super::screen::Promises;
use crate::discover::naming::Refusal;
use crate::discover::rest::WORTH;

pub use self::doubt::{is_better, sensors_doubted};

/// Maximum number of names.
const MOST: usize = 16;
/// Maximum number of rounds.
const ROUNDS: usize = 6;
/// Distance from its minimum to which a model with a candidate is optimised, in standard errors.
const NEAR_ERRORS: f64 = 0.5;
/// The parameters of a name together are at least this many standard errors away from their neutral values.
const LEAST_AWAY: f64 = 4.0;
/// Minimum number of cables with the same effect that may become one effect of all cables, or that let the sensors of all be doubted.
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
    pub named: Vec<Named>,
    /// Candidates that help this model but do not suffice, the best first.
    pub tried: Vec<Tried>,
    /// Whether the model leaves nothing beside the noise that needs an explanation.
    pub is_complete: bool,
}

impl Naming {
    /// Returns the model as `fit` fits it, and drops the names that are no longer significant there.
    pub fn confirmed(&mut self, bench: &Bench<'_>, fit: impl Fn(&Model) -> Trial) -> Trial {
        loop {
            let fitted = fit(&self.trial.model);
            let found: Vec<Candidate> = self.named.iter().map(|named| named.candidate).collect();
            let all = standings(bench, &fitted, &found).into_iter().zip(&found);
            let weakest = all.min_by(|(one, _), (other, _)| one.away.total_cmp(&other.away));
            let Some((_, candidate)) = weakest.filter(|(standing, _)| standing.away < LEAST_AWAY) else {
                return fitted;
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
pub struct Believed {
    /// If the errors of the cables are independent.
    pub apart: f64,
    /// If they add up, as those of a law that all cables have alike.
    pub together: f64,
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
pub struct Search<'b, 'a> {
    bench: &'b Bench<'a>,
    /// Mean squared whitened deviation of a sample by noise, and by independent errors of the cables' friction models.
    noise_square: f64,
    believed: Believed,
    /// Fitted models by the candidates in them, in order.
    fits: BTreeMap<Vec<Candidate>, Trial>,
    /// What further candidates promise beside such a model.
    promised: BTreeMap<Vec<Candidate>, Promises>,
    /// Candidates that were set aside and the reasons.
    refused: BTreeMap<Candidate, Refusal>,
}

impl<'b, 'a> Search<'b, 'a> {
    /// Starts a search from the fitted given model.
    pub fn new(bench: &'b Bench<'a>, base: Trial, noise_square: f64, believed: Believed) -> Self {
        Self {
            bench,
            noise_square,
            believed,
            fits: BTreeMap::from([(Vec::new(), base)]),
            promised: BTreeMap::new(),
            refused: BTreeMap::new(),
        }
    }

    /// Names what the model lacks. The names of a search before are in the model from the start, with the parameters of `model`, and must justify
    /// themselves like the others.
    pub fn run(mut self, before: &[Named], model: &Model) -> Naming {
        let mut found: Vec<Candidate> = before.iter().map(|named| named.candidate).collect();
        if !found.is_empty() {
            self.fits.insert(set_of(&found), self.bench.fit(model, NEAR_ERRORS));
        }
        for _ in 0..ROUNDS {
            let refused = self.refused.len();
            self.enter(&mut found);
            self.unite(&mut found);
            self.take_apart(&mut found);
            self.leave(&mut found);
            let is_exchanged = self.exchange(&mut found);
            if !is_exchanged && self.refused.len() == refused {
                break;
            }
        }
        // The last round may have exchanged a name.
        let mut named = self.leave(&mut found);
        for (place, named) in named.iter_mut().enumerate() {
            named.runner_up = self.runner_up(&found, place);
        }
        let tried = self.tried(&found);
        let trial = self.fit(&found);
        let is_complete = self.excess(&trial) <= WORTH;
        Naming { trial, named, tried, is_complete }
    }
}

/// Returns the candidates in order.
fn set_of(found: &[Candidate]) -> Vec<Candidate> {
    let mut set = found.to_vec();
    set.sort_unstable();
    set
}

/// Returns the candidates except one.
fn without(found: &[Candidate], candidate: Candidate) -> Vec<Candidate> {
    found.iter().copied().filter(|of| *of != candidate).collect()
}
