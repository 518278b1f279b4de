//! Bound on the work of a search.
//!
//! Where the truth is in the catalogue, a search ends by itself: the names leave only noise. Where it is not, every name leaves a rest that others seem to
//! reduce; they enter, are exchanged and refused, and each attempt tries all candidates again, with more parameters each time. So the work is counted
//! and bounded. It is counted in evaluations of the model, each a pass over the log, and not in time, so that the answer is the same on every computer.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Number of evaluations in a pass over a cable after which no candidate enters any more, none is exchanged, and no further pass begins but one with parameters that only the names have made known; and the number by which each
/// effect in the model raises it, since every search beside it is one over all candidates. What is named until then still has to justify itself, and the
/// rest is described as usual. Logs with one hidden effect take up to 800, with five 2800, a real drive with three names 1700. Half of both numbers cuts
/// these short; with double, a log with three wrong names takes twice the time. A search by the wrench has the same bound; those of logs with a wrong mass take
/// up to 240.
const MOST_EVALUATIONS: usize = 1000;
const MORE_PER_EFFECT: usize = 400;

/// The work done so far.
#[derive(Debug, Default)]
pub struct Effort {
    evaluations: AtomicUsize,
}

impl Effort {
    /// Counts evaluations of the model.
    pub fn add(&self, evaluations: usize) {
        self.evaluations.fetch_add(evaluations, Ordering::Relaxed);
    }

    /// Whether a search that has named so many effects has to come to an end.
    pub fn is_spent(&self, effect_count: usize) -> bool {
        self.evaluations.load(Ordering::Relaxed) >= MOST_EVALUATIONS + MORE_PER_EFFECT * effect_count
    }
}
