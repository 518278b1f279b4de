//! The passes over one cable: fit, name what is missing, fit the extended model, assess what is left, and start again from there.

use fric_core::effects::Effect;
use nalgebra::DVector;

use super::final_fit::Fitted;
use super::{BELIEVED_RATIO, CableLog};
use crate::candidates::catalogue as candidates;
use crate::certainty::assumed;
use crate::discover::effort::Effort;
use crate::discover::given::determined_beside;
use crate::discover::naming::evidence::in_standard_errors;
use crate::discover::naming::justification::is_at_end;
use crate::discover::naming::{LEAST_AWAY, Naming, Refusal, Search};
use crate::discover::rest::places::Place;
use crate::discover::rest::stretch::{Stretch, stretch_of_cable};
use crate::discover::rest::{WORTH, wander};
use crate::discover::workbench::{self, Trial, Workbench};
use crate::fit::Parameter;
use crate::samples::noise::white_noise_apart;
use crate::search::problem::Problem;
use crate::search::solve::squares;

/// Maximum number of passes over a cable. Each pass starts from what the previous one found.
const MOST_PASSES: usize = 3;

/// The outcome of one pass.
pub(super) struct Outcome {
    /// The samples that the pass used.
    pub(super) counts: Vec<bool>,
    /// The work that it took.
    pub(super) effort: Effort,
    pub(super) base: Trial,
    pub(super) naming: Naming,
    /// The model with everything that was found, fitted to all samples as an identification does.
    pub(super) fitted: Fitted,
    pub(super) rest: Rest,
    /// A stretch of cable with a local defect, left out of the assessment of the rest.
    pub(super) stretch: Option<Place>,
}

impl Outcome {
    /// Whether the search had to come to an end, so that no further pass begins but one with parameters that only the names have made known.
    pub(super) fn is_cut_short(&self) -> bool {
        self.effort.is_spent(self.naming.named.len())
    }
}

/// What a model leaves unexplained.
pub(super) struct Rest {
    pub(super) noise_n: f64,
    pub(super) wander_n: f64,
    pub(super) residual_n: Vec<f64>,
    pub(super) is_noise: bool,
    pub(super) places: Vec<Place>,
    pub(super) stretch: Option<Stretch>,
}

impl CableLog<'_> {
    /// Runs a pass, then runs further passes if the findings make more parameters observable or show a narrow stretch of cable with a local defect.
    /// Such a stretch may hide other effects or be mistaken for them, so it is left out. Returns `None` where the noise cannot be estimated.
    pub(super) fn passes(&self, start: &mut workbench::Model, held: &[Parameter]) -> Option<Outcome> {
        let mut outcome = self.pass(self.counts, start)?;
        let held: Vec<Parameter> = held.iter().copied().filter(|held| !start.free.contains(held)).collect();
        let told = self.newly_determined(self.counts, &outcome.naming, &held);
        // Even if the search was cut short: what it wasted its work on may be these.
        if !told.is_empty() {
            start.free.extend(told);
            outcome = self.pass(self.counts, start).unwrap_or(outcome);
        }
        if !outcome.is_cut_short()
            && let Some(found) = outcome.rest.stretch.take()
        {
            let outside: Vec<bool> =
                self.counts.iter().zip(&found.cycles).map(|(counts, inside)| *counts && !inside).collect();
            let again = self.pass(&outside, start);
            let is_clearer =
                |again: &Outcome| again.rest.is_noise || again.naming.named.len() > outcome.naming.named.len();
            if let Some(again) = again.filter(is_clearer) {
                outcome = Outcome { stretch: Some(found.place), ..again };
            }
        }
        Some(outcome)
    }

    /// Fits, names effects and assesses the rest, until no further effect can be named.
    fn pass(&self, counts: &[bool], start: &workbench::Model) -> Option<Outcome> {
        let bench = self.bench(counts);
        let base = bench.try_one(start);
        let noise_n = self.noise_n(&bench, &base)?;
        let effort = Effort::default();
        let mut search = Search::new(&bench, noise_n, self.around(&base, noise_n), &base, self.steady, &effort);
        let mut naming = search.run(&[]);
        let mut fitted = self.fitted(counts, &naming.model, noise_n);
        let mut passes = 1;
        loop {
            let named = naming.effects();
            let doubt = |effect: &Effect| Some((*effect, self.doubt(counts, &fitted, *effect)?));
            if let Some((doubtful, refusal)) = named.iter().find_map(doubt) {
                search.refuse(doubtful, refusal);
                let others: Vec<Effect> = named.iter().copied().filter(|effect| *effect != doubtful).collect();
                naming = search.run(&others);
                fitted = self.fitted(counts, &naming.model, noise_n);
                continue;
            }
            if passes == MOST_PASSES || effort.is_spent(named.len()) {
                break;
            }
            passes += 1;
            let beyond = self.beyond(&bench, &search, &fitted, &named)?;
            if beyond.named.is_empty() {
                // Its noise is that of the extended model.
                naming.tried = beyond.tried;
                break;
            }
            // Beside what is missing, everything has to justify itself again. What does not stay then would still be named from the extended file.
            let again = search.run(&[named.clone(), beyond.effects()].concat());
            let is_new = again.effects().iter().any(|effect| !named.contains(effect));
            naming = if is_new { again } else { naming.followed_by(beyond) };
            fitted = self.fitted(counts, &naming.model, noise_n);
        }
        let rest = self.rest(&bench, &fitted.model(), self.least_n(&base))?;
        Some(Outcome { counts: counts.to_vec(), effort, base, naming, fitted, rest, stretch: None })
    }

    /// Returns the reason why an effect cannot stay by the values and intervals that are reported.
    fn doubt(&self, counts: &[bool], fitted: &Fitted, effect: Effect) -> Option<Refusal> {
        if is_at_end(effect, &fitted.values, self.record.cycle_s) {
            return Some(Refusal::AtBound);
        }
        self.may_be_absent(counts, fitted, effect).then_some(Refusal::Absent)
    }

    /// Whether the parameters that make an effect are too near to the values at which it does nothing, by their errors. Parameters such as a speed, which do
    /// nothing by themselves, do not matter; nor does the error by a time that is assumed, which scales an effect and removes none.
    fn may_be_absent(&self, counts: &[bool], fitted: &Fitted, effect: Effect) -> bool {
        let bench = self.bench(counts);
        let all = Problem { used: counts.to_vec(), ..bench.problem(&fitted.parameters, None) };
        let covariance = &fitted.covariance - assumed::covariance(&all, &[fitted.values], &fitted.undetermined);
        let of_effect = candidates::fitted(effect);
        let mut neutral = fitted.values;
        for parameter in &of_effect {
            neutral[parameter.place()] = parameter.row().neutral;
        }
        let squares_without = squares(&all, &[neutral]);
        let own = fitted.parameters.iter().enumerate().filter(|(_, parameter)| of_effect.contains(parameter));
        let has_an_effect = |(_, parameter): &(usize, &Parameter)| {
            let mut alone = neutral;
            alone[parameter.place()] = fitted.values[parameter.place()];
            squares(&all, &[alone]).to_bits() != squares_without.to_bits()
        };
        let makers: Vec<(usize, &Parameter)> = own.filter(has_an_effect).collect();
        let places: Vec<usize> = makers.iter().map(|(place, _)| *place).collect();
        let off = |(_, parameter): &(usize, &Parameter)| fitted.values[parameter.place()] - neutral[parameter.place()];
        let off = DVector::from_iterator(makers.len(), makers.iter().map(off));
        !makers.is_empty() && in_standard_errors(&off, &covariance, &places).is_some_and(|away| away < LEAST_AWAY)
    }

    /// Names what would be missing if the model with the effects that `search` has found were the given one.
    fn beyond(
        &self,
        bench: &Workbench<'_>,
        search: &Search<'_, '_>,
        fitted: &Fitted,
        found: &[Effect],
    ) -> Option<Naming> {
        let base = bench.try_one(&fitted.model());
        let noise_n = self.noise_n(bench, &base)?;
        Some(search.beyond(found, &base, noise_n, self.around(&base, noise_n)).run(&[]))
    }

    /// Returns the standard deviation of the white noise in the model's residual, N.
    pub(super) fn noise_n(&self, bench: &Workbench<'_>, model: &Trial) -> Option<f64> {
        let residual_n = bench.residuals_n(&model.values);
        Some(self.white_noise_n(bench, &residual_n)?.max(self.least_n(model)))
    }

    fn white_noise_n(&self, bench: &Workbench<'_>, residual_n: &[f64]) -> Option<f64> {
        white_noise_apart(&bench.measured_of(residual_n), self.record.noise_reach)
    }

    /// Returns the force below which the model is not trusted, N.
    fn least_n(&self, model: &Trial) -> f64 {
        BELIEVED_RATIO * self.around(model, 0.0).tension_n
    }

    /// Assesses what a model leaves.
    pub(super) fn rest(&self, bench: &Workbench<'_>, model: &workbench::Model, least_n: f64) -> Option<Rest> {
        let residual_n = bench.residuals_n(&model.values);
        let noise_n = self.white_noise_n(bench, &residual_n)?.max(least_n);
        let excess = self.excess(&residual_n, noise_n);
        let places = excess.places(self.conditions);
        let share = excess.share();
        let stretch = if share <= WORTH { None } else { stretch_of_cable(&excess, self.conditions) };
        let found = if stretch.is_some() { None } else { wander(&excess, &places) };
        let wander =
            found.map_or(0.0, |(wander, drift)| wander.min(share * (1.0 - drift.share_of_cable(bench, model))));
        Some(Rest {
            noise_n,
            wander_n: noise_n * wander.sqrt(),
            is_noise: share - wander <= WORTH * (1.0 + wander),
            places,
            stretch,
            residual_n,
        })
    }

    /// Returns which of the held parameters the log determines once the model has the first of the effects that were missing, or the first two, and so on:
    /// the later ones may stand for what is held.
    fn newly_determined(&self, counts: &[bool], naming: &Naming, held: &[Parameter]) -> Vec<Parameter> {
        if held.is_empty() {
            return Vec::new();
        }
        let bench = self.bench(counts);
        let told_by = |named: &Trial| determined_beside(&bench, &named.model(), held).1;
        let told: Vec<Parameter> = naming.ladder.iter().skip(1).flat_map(told_by).collect();
        held.iter().copied().filter(|held| told.contains(held)).collect()
    }
}
