//! A start of the search in which every force sensor is in doubt. Where all sensors are wrong, the friction of the given model makes up for that, and no
//! single candidate explains much.

use fric_core::effects::Effect;
use fric_core::parameters::Values;

use super::standing::standings;
use super::{LEAST_ALIKE, MOST, NEAR_ERRORS, Naming, Search};
use crate::candidates::catalogue::fitted;
use crate::discover::naming::evidence::delta_bic;
use crate::discover::naming::{NEGLIGIBLE, STRONG_BIC};
use crate::discover::wrench::bench::{Bench, Trial};
use crate::discover::wrench::candidate::Candidate;
use crate::discover::wrench::covariance::{geometric_mean_square, reweighted};
use crate::discover::wrench::geometry::Geometry;
use crate::discover::wrench::model::Model;
use crate::replay::WrenchReference;

/// Gains that differ by less than this fraction agree. Under a wrong mass the gains of the simulated robots in the tests do; those of the recording in
/// `docs/recordings.md`, which has gains and an offset, do not: two of four differ by more. Half and double are not tried.
const ALIKE_RATIO: f64 = 0.01;

/// Whether a candidate is the gain or the offset of one force sensor.
pub fn is_of_one_sensor(candidate: Candidate) -> bool {
    matches!(candidate, Candidate::Own(_, Effect::SensorGain | Effect::SensorOffset))
}

/// Returns the start of a search in which each force sensor that has none gets a gain of its own, or in which the mass is wrong in place of gains that agree.
/// It is fitted with the covariance of its own deviations: that of the given model makes little of the very directions in which it misses most. `None` if
/// every sensor has a gain, if there are more than a search names, or if there are no deviations.
pub fn sensors_doubted(bench: &Bench<'_>, base: &Trial) -> Option<Naming> {
    let mut model = base.model.clone();
    let mut gains = Vec::new();
    for (cable, free) in model.free.iter_mut().enumerate() {
        let gain = Candidate::Own(cable, Effect::SensorGain);
        if !gain.is_in(&base.model) {
            free.extend(fitted(Effect::SensorGain));
            gains.push(gain);
        }
    }
    if gains.is_empty() || gains.len() > MOST {
        return None;
    }
    let are_all_doubted = gains.len() == bench.records.len();
    let starts = [bench.with_given_friction(&model), model];
    let fits = starts.map(|model| fit(bench, &model));
    let best = fits.into_iter().min_by(|one, other| one.training.total_cmp(&other.training))?;
    let (trial, whitening) = reweighted(bench, best, fit)?;
    let is_by_mass = bench.description.reference == WrenchReference::Mass && are_all_doubted;
    if let Some((candidates, model)) = is_by_mass.then(|| with_mass(&trial.model)).flatten() {
        let (trial, whitening) = reweighted(bench, bench.judged(model), fit)?;
        return Some(Naming::start(trial, &whitening, candidates));
    }
    Some(Naming::start(trial, &whitening, gains))
}

/// Returns the model with a wrong mass in place of the gains that agree, and its candidates. By the weight alone, a factor in which the sensors agree cannot
/// be told from a wrong mass, which is the likelier cause. `None` if half of the gains differ, or so many that the sensors are wrong.
fn with_mass(model: &Model) -> Option<(Vec<Candidate>, Model)> {
    let place = Effect::SensorGain.places().start;
    let mut gains: Vec<f64> = model.values.iter().map(|values| values[place]).collect();
    gains.sort_by(f64::total_cmp);
    let common = *gains.get(gains.len() / 2)?;
    let differs = |values: &Values| (values[place] / common - 1.0).abs() > ALIKE_RATIO;
    let own: Vec<bool> = model.values.iter().map(differs).collect();
    let own_count = own.iter().filter(|differs| **differs).count();
    if own_count >= LEAST_ALIKE || 2 * own_count >= own.len() {
        return None;
    }
    let mut model = model.clone();
    let mut candidates = vec![Candidate::Geometry(Geometry::Mass)];
    for (cable, differs) in own.into_iter().enumerate() {
        let gain = Candidate::Own(cable, Effect::SensorGain);
        if differs {
            model.values[cable][place] /= common;
            candidates.push(gain);
        } else {
            gain.remove_from(&mut model);
        }
    }
    model.changes.insert(Geometry::Mass, vec![0.0; Geometry::Mass.count()]);
    Some((candidates, model))
}

impl Search<'_> {
    /// Whether another start is better than the given model, and than the model with any single candidate, fitted in the same way.
    pub fn is_worse_than(&mut self, start: &Naming) -> bool {
        let base = self.fit(&[]);
        let singles = self.beside(&[]);
        is_better(&self.bench, start, &base, &[])
            && singles.into_iter().all(|(candidate, single)| {
                let is_better = |single: &Trial| is_better(&self.bench, start, single, &[candidate]);
                is_better(&single) && reweighted(&self.bench, single, fit).is_some_and(|(single, _)| is_better(&single))
            })
    }

    /// Whether the given model leaves no more than noise.
    pub fn is_explained(&mut self) -> bool {
        let base = self.fit(&[]);
        self.excess(&base) <= NEGLIGIBLE
    }
}

fn fit(bench: &Bench<'_>, model: &Model) -> Trial {
    bench.fit(model, NEAR_ERRORS)
}

/// Whether the evidence for an outcome beside another model with some names is strong and holds on the held-out samples. Each is judged by the covariance of
/// its own deviations (determinant criterion; G. E. P. Box, N. R. Draper, *The Bayesian estimation of common parameters from several responses*, Biometrika
/// 52, 1965): the whitening of the one would count little of what the other explains in the directions in which the one leaves much.
pub fn is_better(bench: &Bench<'_>, outcome: &Naming, other: &Trial, of_other: &[Candidate]) -> bool {
    let bench = Bench { whitening: outcome.whitening, ..bench.clone() };
    let mut new = outcome.candidates();
    new.retain(|candidate| !of_other.contains(candidate));
    let inflation = standings(&bench, &outcome.trial, &new).iter().map(|of| of.inflation).fold(1.0, f64::max);
    let models = [&outcome.trial.model, &other.model];
    let ratio = |held_out: bool| {
        let [one, other] = models.map(|model| geometric_mean_square(&bench, model, held_out));
        one / other
    };
    let [unknowns, other_unknowns] = models.map(|model| model.unknowns().len());
    #[expect(clippy::cast_precision_loss, reason = "counts")]
    let (count, more) = (6.0 * bench.count(false) as f64 / inflation, unknowns as f64 - other_unknowns as f64);
    ratio(true) < 1.0 && delta_bic(count, ratio(false), more) < -STRONG_BIC
}
