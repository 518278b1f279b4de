//! Bound on the work of a discovery on one cable.
//!
//! Where the truth is in the catalogue, a search ends by itself: the names leave only noise. Where it is not, every name leaves a rest that others seem to
//! reduce; they enter, are exchanged and refused, and each attempt tries all candidates again, with more parameters each time. So the work is counted
//! and bounded. It is counted in evaluations of the model, each a pass over the log, and not in time, so that the answer is the same on every computer.

use std::cell::Cell;

use super::workbench::Trial;

/// Number of evaluations after which no candidate enters any more, none is exchanged, and no further pass begins. What is named until then still has
/// to justify itself, and the rest is described as usual.
pub const MOST_EVALUATIONS: usize = 2500;

/// The work done on a cable so far.
#[derive(Debug, Default)]
pub struct Effort {
    evaluations: Cell<usize>,
}

impl Effort {
    /// Counts fits.
    pub fn add(&self, fits: &[Trial]) {
        let evaluations: usize = fits.iter().map(|trial| trial.evaluation_count).sum();
        self.evaluations.set(self.evaluations.get() + evaluations);
    }

    /// Whether the search has to come to an end.
    pub fn is_spent(&self) -> bool {
        self.evaluations.get() >= MOST_EVALUATIONS
    }
}
