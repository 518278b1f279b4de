//! Entry of two or three effects at once.
//!
//! Each of several effects may look like something else as long as the others are missing. An asymmetry of the friction and a drift of the sensor, of
//! like size, leave each other an error that changes with the time and with the direction; alone, neither helps on the samples held out. So where no
//! candidate may enter alone, sets of two and three are tried, including what was refused. To choose among the thousands of them, each candidate is taken
//! for the force that it adds where it fits best alone, and the sums of squares of all sets follow from the inner products of these forces. The memory
//! that weakens the evidence is that of what a whole set leaves: as long as anything is missing, the residual remembers that. Those sets in which each
//! effect has strong evidence beside the others are fitted, the best first, and the first enters whose effects can all stay, with those that the model
//! had.

use fric_core::effects::Effect;
use fric_core::parameters::Values;

use super::entry::MOST_EFFECTS;
use super::evidence::{delta_bic, inflations};
use super::projection::{Columns, less_projection};
use super::{NEGLIGIBLE, STRONG_BIC, Search};
use crate::candidates::catalogue::{fitted, starts};
use crate::discover::workbench::Trial;

/// Maximum number of effects in a set.
const MOST_TOGETHER: usize = 3;
/// Number of sets that are fitted. In the four logs of a sweep in which one entered it was the first; on the real drive EMPS the second explains most.
const MOST_SETS: usize = 3;
/// Number of sets of which the memory is computed, those with the most evidence without any.
const MOST_WEIGHED: usize = 32;
/// A candidate that adds less than this fraction of the sum of squares adds nothing.
const NOTHING: f64 = 1e-9;

/// A candidate and the force that it adds to the model.
struct Candidate {
    effect: Effect,
    /// Training sum of squares of its fit alone, N².
    training: f64,
    added_n: Vec<f64>,
}

impl Search<'_, '_> {
    /// Adds two or three candidates that can stay only beside each other. Returns whether there were any.
    pub(super) fn enter_together(&mut self, found: &mut Vec<Effect>) -> bool {
        let model = self.fit(found);
        if self.excess(&model) <= NEGLIGIBLE || self.effort.is_spent(self.given_count + found.len() + 2) {
            return false;
        }
        let beyond = self.beyond_the_log();
        let mut round = self.round(found);
        round.retain(|(effect, _)| !effect.is_friction() && !beyond.contains_key(effect));
        for set in self.strong_sets(&model, &round, MOST_EFFECTS.saturating_sub(found.len())) {
            let mut with = found.clone();
            self.add(&mut with, &set);
            self.settle(&with);
            if self.justified(&with).iter().all(|named| named.refusal.is_none()) {
                self.refused.retain(|effect, _| !set.contains(effect));
                *found = with;
                return true;
            }
        }
        false
    }

    /// Returns the sets of at most `room` candidates in which each has strong evidence beside the others, by linear steps from the model: the best first,
    /// in each the strongest first.
    fn strong_sets(&self, model: &Trial, round: &[(Effect, Trial)], room: usize) -> Vec<Vec<Effect>> {
        let problem = self.bench.problem(&model.free, None);
        let mut residual_n = self.bench.residuals_n(&model.values);
        for (residual_n, _) in residual_n.iter_mut().zip(&problem.used).filter(|(_, used)| !**used) {
            *residual_n = f64::NAN;
        }
        let candidates: Vec<Candidate> =
            round.iter().filter_map(|(effect, trial)| self.candidate(model, *effect, trial, &residual_n)).collect();
        let added_n: Vec<Vec<f64>> = candidates.iter().map(|of| of.added_n.clone()).collect();
        let Some(signals) = less_projection(&problem, &model.values, &added_n) else { return Vec::new() };
        let columns = Columns::new(&signals, 0, &residual_n);
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = self.bench.count(false) as f64;
        let left = |places: &[usize]| model.training - columns.gain(places);
        let parameters = |place: usize| {
            #[expect(clippy::cast_precision_loss, reason = "a few parameters")]
            let parameters = fitted(candidates[place].effect).len() as f64;
            parameters
        };
        // The weakest evidence in a set, if memory leaves so many times fewer samples for each effect.
        let weakest = |places: &[usize], memories: &[f64]| {
            let of_place = |(place, memory): (&usize, &f64)| {
                let others: Vec<usize> = places.iter().copied().filter(|other| other != place).collect();
                delta_bic(count / memory, left(places) / left(&others), parameters(*place))
            };
            places.iter().zip(memories).map(of_place).fold(f64::NEG_INFINITY, f64::max)
        };
        let by_evidence = |(one, _): &(f64, Vec<usize>), (other, _): &(f64, Vec<usize>)| one.total_cmp(other);
        let mut sets: Vec<(f64, Vec<usize>)> = subsets(candidates.len(), room)
            .map(|places| (weakest(&places, &[1.0; MOST_TOGETHER]), places))
            .filter(|(weakest, _)| *weakest < -STRONG_BIC)
            .collect();
        sets.sort_by(by_evidence);
        sets.truncate(MOST_WEIGHED);
        for (evidence, places) in &mut sets {
            let of_set: Vec<&[f64]> = places.iter().map(|place| signals[*place].as_slice()).collect();
            *evidence = weakest(places, &inflations(&of_set, &residual_n));
        }
        sets.retain(|(weakest, _)| *weakest < -STRONG_BIC);
        sets.sort_by(by_evidence);
        let of_set = |(_, mut places): (f64, Vec<usize>)| {
            places.sort_by(|one, other| candidates[*one].training.total_cmp(&candidates[*other].training));
            places.into_iter().map(|place| candidates[place].effect).collect()
        };
        sets.into_iter().take(MOST_SETS).map(of_set).collect()
    }

    /// Returns a candidate with the force that it adds where it fits best, or, if it is best left out alone, at its first start; `None` if it adds nothing.
    fn candidate(&self, model: &Trial, effect: Effect, trial: &Trial, residual_n: &[f64]) -> Option<Candidate> {
        let adds = |values: &Values| -> Vec<f64> {
            let with_n = self.bench.residuals_n(values);
            with_n.iter().zip(residual_n).map(|(with, without)| with - without).collect()
        };
        let is_something = |added_n: &Vec<f64>| {
            let squares: f64 = added_n.iter().filter(|number| number.is_finite()).map(|number| number * number).sum();
            squares > NOTHING * model.training
        };
        let starts = starts(effect, &model.values, &self.around, &self.bench.record);
        let added_n = std::iter::once(trial.values).chain(starts).map(|values| adds(&values)).find(is_something)?;
        Some(Candidate { effect, training: trial.training, added_n })
    }
}

/// Returns all sets of two and three of so many places, with at most `room` places.
fn subsets(count: usize, room: usize) -> impl Iterator<Item = Vec<usize>> {
    let pairs = move |last| (0..last).flat_map(|second| (0..second).map(move |first| vec![first, second]));
    let triples = (0..count).flat_map(move |third| pairs(third).map(move |pair| [&pair[..], &[third]].concat()));
    pairs(count).chain(triples).filter(move |set| set.len() <= room)
}

#[cfg(test)]
mod tests {
    use super::subsets;

    #[test]
    fn every_pair_and_triple_comes_once() {
        let mut sets: Vec<Vec<usize>> = subsets(6, 3).collect();
        sets.sort();
        sets.dedup();
        // 6·5/2 and 6·5·4/6.
        assert_eq!(sets.len(), 15 + 20);
        assert!(sets.iter().all(|set| set.is_sorted_by(|one, other| one < other) && set[set.len() - 1] < 6));
        assert!(subsets(6, 2).all(|set| set.len() == 2));
        assert_eq!(subsets(6, 1).count(), 0);
    }
}
