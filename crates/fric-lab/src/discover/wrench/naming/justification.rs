//! What a name must show to stay.

use std::collections::BTreeMap;

use fric_core::effects::Effect;

use super::doubt::is_of_one_sensor;
use super::standing::{Standing, disagreement, standings};
use super::{LEAST_ALIKE, Named, Search, is_one_of_many, without};
use crate::discover::naming::{LEAST_AWAY, LEAST_SIZE, Refusal, STRONG_BIC};
use crate::discover::wrench::bench::Trial;
use crate::discover::wrench::candidate::Candidate;

impl Search<'_> {
    /// Sets aside names that cannot stay, the least significant first, and returns the others with their evidence. Where several sensors are doubted, these
    /// come last: what entered beside them may make up for some of their errors.
    pub(super) fn leave(&mut self, found: &mut Vec<Candidate>) -> Vec<Named> {
        loop {
            let trial = self.fit(found);
            let mut weakest_first: Vec<(Standing, Candidate)> =
                standings(&self.bench, &trial, found).into_iter().zip(found.iter().copied()).collect();
            let are_doubted = found.iter().filter(|of| is_of_one_sensor(**of)).count() >= LEAST_ALIKE;
            weakest_first.sort_by(|(one, of), (other, beside)| {
                let [one_late, other_late] = [of, beside].map(|of| are_doubted && is_of_one_sensor(*of));
                one_late.cmp(&other_late).then(one.away.total_cmp(&other.away))
            });
            let strong = self.strong(&weakest_first);
            let mut named = BTreeMap::new();
            let mut refused = None;
            for (standing, candidate) in weakest_first {
                let (delta_bic, refusal) = self.judged(found, (candidate, &standing), &trial, &strong);
                refused = refusal.map(|refusal| (candidate, refusal));
                if refused.is_some() {
                    break;
                }
                named.insert(candidate, Named { candidate, delta_bic, runner_up: None });
            }
            let Some((candidate, refusal)) = refused else {
                return found.iter().filter_map(|of| named.remove(of)).collect();
            };
            found.retain(|of| *of != candidate);
            self.refused.insert(candidate, refusal);
        }
    }

    /// Returns the names for which the evidence is strong by their intervals: what leaving one out would cost, to second order.
    pub(super) fn strong(&self, standings: &[(Standing, Candidate)]) -> Vec<Candidate> {
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let of_parameter = (6.0 * self.bench.count(false) as f64).ln();
        #[expect(clippy::cast_precision_loss, reason = "a few parameters")]
        let is_strong = |(standing, candidate): &&(Standing, Candidate)| {
            standing.away * standing.away - candidate.count() as f64 * of_parameter > STRONG_BIC
        };
        standings.iter().filter(is_strong).map(|(_, candidate)| *candidate).collect()
    }

    /// Returns the evidence for a name and, if it cannot stay, the reason. `strong` are the names with strong evidence.
    fn judged(
        &mut self,
        found: &[Candidate],
        (candidate, standing): (Candidate, &Standing),
        trial: &Trial,
        strong: &[Candidate],
    ) -> (f64, Option<Refusal>) {
        let Standing { inflation, away } = *standing;
        let without = self.fit(&without(found, candidate));
        let delta_bic = self.delta_bic(&without, trial, candidate.count(), inflation);
        let least_square = (LEAST_SIZE * self.noise_square).max(self.believed.of(candidate));
        let is_small = without.held_out - trial.held_out <= self.held_out_squares(least_square);
        let is_strong = || delta_bic < -STRONG_BIC && self.beyond_one_block(trial, &without) >= STRONG_BIC * inflation;
        let refusal = if self.is_at_end(candidate, trial) {
            Some(Refusal::AtBound)
        } else if is_small {
            Some(Refusal::Small)
        } else if away < LEAST_AWAY || !is_one_of_many(strong, candidate) && !is_strong() {
            Some(Refusal::Weak)
        } else if !self.is_more_than_usual(candidate, trial) {
            Some(candidate.usual())
        } else if let Candidate::Alike(effect) = candidate
            && self.do_cables_differ(found, effect, trial)
        {
            Some(Refusal::Unsteady("cable"))
        } else if let Candidate::Geometry(of) = candidate
            && self.bench.description.is_contradicted(of, &trial.model.changes, &self.bench.records)
        {
            Some(Refusal::Contradicted)
        } else {
            None
        };
        (delta_bic, refusal)
    }

    /// Whether cables need parameters of their own for an effect that all have alike: these differ significantly, and what that explains matters.
    fn do_cables_differ(&mut self, found: &[Candidate], effect: Effect, trial: &Trial) -> bool {
        let Some((_, apart)) = self.apart(found, effect) else { return false };
        let least_square = (LEAST_SIZE * self.noise_square).max(self.believed.apart);
        trial.held_out - apart.held_out > self.held_out_squares(least_square)
            && disagreement(&self.bench, &apart, effect) > LEAST_AWAY
    }

    /// Returns the decrease of the squares over the held-out blocks except the one in which it is greatest, in variances of the noise.
    fn beyond_one_block(&self, trial: &Trial, without: &Trial) -> f64 {
        let blocks = self.bench.blocks.iter().zip(trial.blocks.iter().zip(&without.blocks));
        let gains = blocks.filter(|(block, _)| block.held_out).map(|(_, (with, without))| without - with);
        let (sum, greatest) =
            gains.fold((0.0, 0.0), |(sum, greatest): (f64, f64), gain| (sum + gain, greatest.max(gain)));
        (sum - greatest) * 6.0 / self.noise_square
    }
}
