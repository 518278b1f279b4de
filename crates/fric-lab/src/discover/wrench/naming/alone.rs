//! What a search on one cable asks of a name, asked of the names of single cables.
//!
//! Beside the forces of the other cables, the wrench shows the force of one: the force with which the sum comes nearest to zero
//! (`shown_by_others_n` of the bench). In the place of a force measured at the platform, it makes a log of this cable alone, on which the rules of that search
//! hold: an effect has one size in all conditions, and neither an unnamed law nor what sound robots have stands in for it.

use fric_core::effects::Effect;
use fric_core::parameters::MU;

use super::Search;
use crate::candidates::catalogue::around;
use crate::discover::effort::Effort;
use crate::discover::naming::{self, Refusal};
use crate::discover::workbench::{Model, Workbench};
use crate::discover::wrench::bench::Trial;
use crate::discover::wrench::candidate::Candidate;
use crate::discover::wrench::model::Model as WrenchModel;
use crate::samples::conditions::{conditions, steady};

impl Search<'_> {
    /// Returns a name of a single cable that cannot stay by what the wrench shows of this cable's force, and the reason.
    pub(super) fn refused_alone(&mut self, found: &[Candidate]) -> Option<(Candidate, Refusal)> {
        let trial = self.fit(found);
        (0..self.bench.records.len()).find_map(|cable| {
            let own = |candidate: &Candidate| match candidate {
                Candidate::Own(of, effect) if *of == cable => Some(*effect),
                _ => None,
            };
            let effects: Vec<Effect> = found.iter().filter_map(own).collect();
            let (effect, refusal) = self.refused_on(cable, &trial, &effects)?;
            Some((Candidate::Own(cable, effect), refusal))
        })
    }

    fn refused_on(&self, cable: usize, trial: &Trial, effects: &[Effect]) -> Option<(Effect, Refusal)> {
        if effects.is_empty() {
            return None;
        }
        let references_n = self.bench.shown_by_others_n(&trial.model, cable);
        let record = self.bench.records.get(cable)?.with_references(&references_n);
        let bench = Workbench {
            record,
            blocks: &self.bench.blocks,
            counts: &self.bench.counts,
            measured: self.bench.measured,
            stop: self.bench.stop,
        };
        let fit = |model: &WrenchModel| {
            let (values, free) = (*model.values.get(cable)?, model.free.get(cable)?.clone());
            Some(bench.try_one(&Model { values, free }))
        };
        let with = fit(&trial.model)?;
        let mut without = trial.model.clone();
        for effect in effects {
            Candidate::Own(cable, *effect).remove_from(&mut without);
        }
        let base = fit(&without)?;
        let noise_n = self.bench.white_noise(bench.residuals_n(&with.values).into_iter())?;
        let (conditions, effort) = (steady(&record, &conditions(&record)), Effort::default());
        let around = around(&record, base.values[MU], noise_n);
        let search = || naming::Search::new(&bench, noise_n, around.clone(), &base, &conditions, &effort);
        // How strong the evidence is was judged by the whole wrench.
        let is_of_law = |(_, refusal): &(Effect, Refusal)| !matches!(refusal, Refusal::Weak);
        let refused = search().refused_in(with, effects).into_iter().find(is_of_law);
        if refused.is_some() || effects.len() == 1 {
            return refused;
        }
        // Several names may share what is something else, each of one size beside the others. A search that begins without them names none of these.
        let mut search = search();
        let named = search.run(&[]).effects();
        let mut others = effects.iter().filter(|effect| !named.contains(effect));
        others.find_map(|effect| Some((*effect, search.reason_against(*effect)?)))
    }
}
