//! Entry of two or three effects at once.
//!
//! Of several effects, each alone can be mistaken for something else. An asymmetry of the friction and a drift of the sensor, of
//! like size, leave each other an error that changes with the time and with the direction; alone, neither helps on the samples held out. So where no
//! candidate may enter alone, sets of two and three are tried, including what was refused. To choose among the thousands of them, each candidate is reduced
//! to one column, the force that it adds where it fits best alone; the sums of squares of all sets follow from the inner products of these columns. The
//! evidence is weakened by the memory of what the whole set leaves, because a residual in which anything is missing has memory. Sets in which each effect
//! has strong evidence beside the others are fitted, the best first. The first one enters whose effects can all stay, together with those that the model
//! had.

use fric_core::effects::Effect;
use fric_core::parameters::Values;

use super::entry::MOST_EFFECTS;
use super::evidence::{Memory, delta_bic};
use super::projection::{Columns, Signals, visit_less_projection};
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

/// A candidate, taken for the force that it adds to the model.
struct Candidate {
    effect: Effect,
    /// Training sum of squares of its fit alone, N².
    training: f64,
    /// The model with it.
    values: Values,
}

impl Search<'_, '_> {
    /// Adds two or three candidates that can stay only beside each other. Returns whether there were any.
    pub(super) fn enter_together(&mut self, found: &mut Vec<Effect>) -> bool {
        let model = self.fit(found);
        if self.excess(&model) <= NEGLIGIBLE || self.effort.is_spent(self.given_count + found.len() + 2) {
            return false;
        }
        let excluded = self.never_tried(found);
        let mut round = self.round(found);
        round.retain(|(effect, _)| !excluded.contains_key(effect));
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

    /// Returns the sets of at most `room` candidates in which each has strong evidence beside the others, by linear steps from the model. The best set comes
    /// first; in each set the strongest candidate comes first.
    fn strong_sets(&self, model: &Trial, round: &[(Effect, Trial)], room: usize) -> Vec<Vec<Effect>> {
        let problem = self.bench.problem(&model.free, None);
        let mut residual_n = self.bench.residuals_n(&model.values);
        for (residual_n, _) in residual_n.iter_mut().zip(&problem.used).filter(|(_, used)| !**used) {
            *residual_n = f64::NAN;
        }
        let candidates: Vec<Candidate> =
            round.iter().filter_map(|(effect, trial)| self.candidate(model, *effect, trial, &residual_n)).collect();
        let values: Vec<Values> = candidates.iter().map(|of| of.values).collect();
        let streams = self.bench.residual_streams(&values);
        let left_n = |cycle: usize| residual_n.get(cycle).copied().unwrap_or(f64::NAN);
        let added_n = || -> Signals<'_> {
            let mut append_residuals = streams.start();
            Box::new(move |cycle, numbers| {
                append_residuals(cycle, numbers);
                for number in numbers.iter_mut() {
                    *number -= left_n(cycle);
                }
            })
        };
        let visit = |visit: &mut dyn FnMut(&[f64], f64)| {
            visit_less_projection(&problem, &model.values, &added_n, |cycle, numbers| visit(numbers, left_n(cycle)))
        };
        let mut columns = Columns::new(values.len(), 0, values.len());
        if visit(&mut |numbers, residual_n| columns.add(numbers, residual_n)).is_none() {
            return Vec::new();
        }
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
        let mut memories: Vec<Option<Memory>> = sets.iter().map(|(_, places)| columns.memory(places)).collect();
        let mut remember = |numbers: &[f64], residual_n: f64| {
            memories.iter_mut().flatten().for_each(|memory| memory.add(numbers, residual_n));
        };
        if visit(&mut remember).is_none() {
            return Vec::new();
        }
        for ((evidence, places), memory) in sets.iter_mut().zip(&memories) {
            *evidence = memory.as_ref().map_or(f64::INFINITY, |memory| weakest(places, &memory.inflations()));
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
        let adds_something = |values: &Values| {
            let with = self.bench.evaluated(values);
            let added_n = with.residuals_n().zip(residual_n).map(|(with, without)| with - without);
            let squares: f64 = added_n.filter(|number| number.is_finite()).map(|number| number * number).sum();
            squares > NOTHING * model.training
        };
        let starts = starts(effect, &model.values, &self.around, &self.bench.record);
        let values = std::iter::once(trial.values).chain(starts).find(adds_something)?;
        Some(Candidate { effect, training: trial.training, values })
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
