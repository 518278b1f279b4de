//! The comparison of each name with other candidates in its place.

use super::fits::scales_all;
use super::{Search, Tried, without};
use crate::discover::naming::{NEGLIGIBLE, Refusal, STRONG_BIC};
use crate::discover::wrench::bench::Trial;
use crate::discover::wrench::candidate::Candidate;
use crate::discover::wrench::geometry::Geometry;

/// The parameter that the weight cannot tell from a wrong mass.
const GAIN: &str = "sensor_gain.gain";

impl Search<'_> {
    /// Replaces each name by the best other candidate if that one is better. Returns whether a name was replaced.
    pub(super) fn exchange(&mut self, found: &mut [Candidate]) -> bool {
        let mut is_changed = false;
        for place in 0..found.len() {
            let Some((other, with)) = self.alternative(found, place) else { continue };
            let trial = self.fit(found);
            if !self.refused.contains_key(&other)
                && self.cost(&with, other) < self.cost(&trial, found[place])
                && with.held_out < trial.held_out
                && !self.is_at_end(other, &with)
            {
                found[place] = other;
                is_changed = true;
            }
        }
        is_changed
    }

    /// Returns BIC of a model up to a constant, to compare two candidates in the same place.
    fn cost(&self, trial: &Trial, candidate: Candidate) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (6.0 * self.bench.count(false) as f64, candidate.count() as f64);
        count * trial.training.ln() + more * count.ln() + self.oddity(trial)
    }

    /// Returns the best other candidate in the place of a name, with its model.
    fn alternative(&mut self, found: &[Candidate], place: usize) -> Option<(Candidate, Trial)> {
        let candidate = *found.get(place)?;
        let mut rivals = self.beside(&without(found, candidate));
        rivals.retain(|(of, _)| *of != candidate && !found.contains(of));
        rivals
            .into_iter()
            .min_by(|(one, with), (other, beside)| self.cost(with, *one).total_cmp(&self.cost(beside, *other)))
    }

    /// Returns the best other candidate in the place of a name, the evidence for it, and whether it is as good as the name.
    pub(super) fn runner_up(&mut self, found: &[Candidate], place: usize) -> Option<(Candidate, f64, bool)> {
        let candidate = *found.get(place)?;
        let (other, with) = self.alternative(found, place)?;
        let (without, trial) = (self.fit(&without(found, candidate)), self.fit(found));
        let inflation = self.inflation(candidate, &trial);
        let delta_bic = self.delta_bic(&without, &with, other.count(), inflation);
        let lead = self.delta_bic(&without, &trial, candidate.count(), inflation) - delta_bic;
        Some((other, delta_bic, lead > -STRONG_BIC))
    }

    /// Returns the candidates that help the model with all names but do not suffice, the best first.
    pub(super) fn tried(&mut self, found: &[Candidate]) -> Vec<Tried> {
        let trial = self.fit(found);
        let mut tried = Vec::new();
        if self.excess(&trial) > NEGLIGIBLE {
            let helping = self.beside(found).into_iter().filter(|(_, with)| with.held_out < trial.held_out);
            tried.extend(helping.map(|(candidate, with)| {
                let inflation = self.inflation(candidate, &with);
                let delta_bic = self.delta_bic(&trial, &with, candidate.count(), inflation);
                let refusal = if self.is_at_end(candidate, &with) { Refusal::AtBound } else { Refusal::Weak };
                Tried { candidate, delta_bic, refusal }
            }));
        }
        tried.retain(|tried: &Tried| tried.delta_bic < 0.0);
        tried.sort_by(|one, other| one.delta_bic.total_cmp(&other.delta_bic));
        // If every sensor has a gain of its own, the weight does not show the mass.
        let mass = Candidate::Geometry(Geometry::Mass);
        if scales_all(&self.bench, &trial.model, mass) {
            tried.push(Tried { candidate: mass, delta_bic: 0.0, refusal: Refusal::Open(GAIN) });
        }
        tried
    }
}
