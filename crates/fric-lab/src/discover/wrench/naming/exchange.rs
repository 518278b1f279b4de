//! The comparison of each name with other candidates in its place.

use fric_core::effects::Effect;

use super::fits::scales_all;
use super::standing::standings;
use super::{Search, Tried, is_one_of_many, without};
use crate::discover::naming::{NEGLIGIBLE, Refusal, STRONG_BIC};
use crate::discover::wrench::bench::Trial;
use crate::discover::wrench::candidate::Candidate;
use crate::discover::wrench::geometry::Geometry;
use crate::fit::Parameter;

/// The best other candidate in the place of a name.
struct Rival {
    candidate: Candidate,
    /// The model with it.
    trial: Trial,
    /// BIC of this model minus that of the model with neither.
    delta_bic: f64,
    /// How much more evidence there is for it than for the name, as a difference of BIC.
    lead: f64,
}

impl Search<'_> {
    /// Replaces each name by the best other candidate if that one is better. Returns whether a name was replaced.
    pub(super) fn exchange(&mut self, found: &mut [Candidate]) -> bool {
        let mut is_changed = false;
        for place in 0..found.len() {
            let Some(rival) = self.rival(found, place) else { continue };
            let trial = self.fit(found);
            // What several other cables have is the likelier name here too.
            let all = standings(&self.bench, &trial, found).into_iter().zip(found.iter().copied()).collect::<Vec<_>>();
            let least_lead = if is_one_of_many(&self.strong(&all), found[place]) { STRONG_BIC } else { 0.0 };
            if rival.lead > least_lead
                && rival.trial.held_out < trial.held_out
                && !self.is_at_end(rival.candidate, &rival.trial)
            {
                found[place] = rival.candidate;
                is_changed = true;
            }
        }
        is_changed
    }

    /// Returns the best other candidate in the place of a name.
    fn rival(&mut self, found: &[Candidate], place: usize) -> Option<Rival> {
        let candidate = *found.get(place)?;
        let others = without(found, candidate);
        let (without, trial) = (self.fit(&others), self.fit(found));
        let inflation = self.inflation(candidate, &trial);
        let of_name = self.delta_bic(&without, &trial, candidate.count(), inflation);
        let mut rivals = self.beside(&others);
        rivals.retain(|(of, _)| !found.contains(of));
        let of = |(candidate, trial): (Candidate, Trial)| {
            let delta_bic = self.delta_bic(&without, &trial, candidate.count(), inflation);
            Rival { candidate, trial, delta_bic, lead: of_name - delta_bic }
        };
        rivals.into_iter().map(of).min_by(|one, other| one.delta_bic.total_cmp(&other.delta_bic))
    }

    /// Returns the best other candidate in the place of a name, the evidence for it, and whether it is as good as the name.
    pub(super) fn runner_up(&mut self, found: &[Candidate], place: usize) -> Option<(Candidate, f64, bool)> {
        let Rival { candidate, delta_bic, lead, .. } = self.rival(found, place)?;
        Some((candidate, delta_bic, lead > -STRONG_BIC))
    }

    /// Returns the candidates that help the model with all names but do not suffice, the best first.
    pub(super) fn tried(&mut self, found: &[Candidate]) -> Vec<Tried> {
        let trial = self.fit(found);
        let mut tried = Vec::new();
        if self.excess(&trial) > NEGLIGIBLE {
            let refused: Vec<Candidate> = self.refused.keys().copied().filter(|of| !found.contains(of)).collect();
            let mut helping = self.beside(found);
            helping.extend(self.each_beside(found, &refused));
            helping.retain(|(_, with)| with.held_out < trial.held_out);
            tried.extend(helping.into_iter().map(|(candidate, with)| {
                let inflation = self.inflation(candidate, &with);
                let delta_bic = self.delta_bic(&trial, &with, candidate.count(), inflation);
                let refusal = match self.refused.get(&candidate) {
                    _ if self.is_at_end(candidate, &with) => Refusal::AtBound,
                    _ if !self.is_more_than_usual(candidate, &with) => candidate.usual(),
                    Some(refusal) => *refusal,
                    None if delta_bic >= -STRONG_BIC => Refusal::Weak,
                    None if trial.held_out - with.held_out <= self.least_gain(&trial) => Refusal::Small,
                    None => Refusal::Unjudged,
                };
                Tried { candidate, delta_bic, refusal }
            }));
        }
        tried.retain(|tried: &Tried| tried.delta_bic < 0.0);
        tried.sort_by(|one, other| one.delta_bic.total_cmp(&other.delta_bic));
        // If every sensor has a gain of its own, the weight does not show the mass.
        let mass = Candidate::Geometry(Geometry::Mass);
        if scales_all(&self.bench, &trial.model, mass) {
            tried.extend(Parameter::of(Effect::SensorGain).next().map(|gain| Tried {
                candidate: mass,
                delta_bic: 0.0,
                refusal: Refusal::Open(gain),
            }));
        }
        tried
    }
}
