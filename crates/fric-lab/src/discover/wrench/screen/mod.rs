//! Ranks candidates by how much one linear step from a model explains with each.
//!
//! A candidate adds columns `C` beside the model's derivatives `J` and deviations `r`: the derivatives of the deviations by the candidate's
//! parameters at the start of its search, and, if the start is not the model itself, the change of the deviations from the model to the start. The sum
//! of squares falls by `bᵀS⁻¹b` with `S = CᵀC − CᵀJ(JᵀJ)⁻¹JᵀC` and `b = Cᵀr − CᵀJ(JᵀJ)⁻¹Jᵀr` (score test; C. R. Rao, *Large sample tests of
//! statistical hypotheses*, Proc. Cambridge Phil. Soc. 44, 1948). All candidates share one pass over the training samples.

mod columns;
mod sums;

use fric_core::effects::Effect;
use fric_core::parameters::Values;

use self::columns::{Columns, Start};
use self::sums::{GeometrySums, Sums, schur_gain};
use super::bench::Bench;
use super::candidate::Candidate;
use super::model::Model;
use crate::candidates::catalogue::{fitted, starts};
use crate::effects::Around;
use crate::fit::Parameter;

/// A candidate with what a linear step promises.
#[derive(Clone, Debug)]
pub struct Promise {
    pub candidate: Candidate,
    /// The model with the candidate at the best start of its search.
    pub model: Model,
    /// Decrease of the whitened sum of squares over the training samples.
    pub gain: f64,
}

/// Returns what every wanted candidate promises beside a model from its best start.
pub fn promises(
    bench: &Bench<'_>,
    model: &Model,
    around: &[Around],
    is_wanted: impl Fn(Candidate) -> bool,
) -> Vec<Promise> {
    let cables: Vec<usize> = (0..bench.records.len()).collect();
    let catalogue = |cable: usize| {
        let wanted =
            |effect: &Effect| is_wanted(Candidate::Own(cable, *effect)) || is_wanted(Candidate::Alike(*effect));
        Effect::ALL.iter().copied().filter(wanted).collect::<Vec<Effect>>()
    };
    let mut all_starts: Vec<Start> = Vec::new();
    let current = bench.with_problem(model, Vec::new(), |problem| problem.forces(&model.values)).unwrap_or_default();
    for cable in cables {
        let (Some(record), Some(around)) = (bench.records.get(cable), around.get(cable)) else { continue };
        let Some(values) = model.values.get(cable).filter(|_| cable < current.len()) else { continue };
        let mut first = 0;
        for effect in catalogue(cable) {
            for start in starts(effect, values, around, record) {
                let is_elsewhere = is_elsewhere(&start, values);
                let count = fitted(effect).len() + usize::from(is_elsewhere);
                all_starts.push(Start { cable, effect, values: start, is_elsewhere, columns: first..first + count });
                first += count;
            }
        }
    }
    let mut columns = Columns::new(bench, &all_starts, &current);
    let wanted = bench.description.candidates().into_iter().filter(|of| is_wanted(Candidate::Geometry(*of)));
    let force_n = |place: usize, cable: usize| current.get(cable).map_or(f64::NAN, |forces| forces.at(place).0);
    let geometries = wanted.map(|of| {
        let mut tangents = bench.description.tangents(of, &model.changes, force_n);
        tangents.iter_mut().flatten().for_each(|change| *change = bench.whitening * *change);
        GeometrySums::new(of, tangents, model.unknowns().len())
    });
    let mut geometries: Vec<GeometrySums> = geometries.collect();
    let sums = Sums::of(bench, model, &mut columns, &mut geometries);
    let mut promises: Vec<Promise> = Vec::new();
    let mut offer = |promise: Promise| {
        if !is_wanted(promise.candidate) || !promise.gain.is_finite() {
            return;
        }
        match promises.iter_mut().find(|of| of.candidate == promise.candidate) {
            Some(of) if of.gain < promise.gain => *of = promise,
            Some(_) => {}
            None => promises.push(promise),
        }
    };
    for (place, start) in all_starts.iter().enumerate() {
        let candidate = Candidate::Own(start.cable, start.effect);
        let gain = sums.gain(&[place], &all_starts);
        offer(Promise { candidate, model: beside(model, candidate, &[start]), gain });
    }
    for effect in Effect::ALL.iter().copied().filter(|effect| is_wanted(Candidate::Alike(*effect))) {
        let of_cable = |cable: usize| {
            let places = all_starts.iter().enumerate().filter(move |(_, of)| of.cable == cable && of.effect == effect);
            places.map(|(place, _)| place).collect::<Vec<usize>>()
        };
        let of_cables: Vec<Vec<usize>> = (0..bench.records.len()).map(of_cable).collect();
        let count = of_cables.iter().map(Vec::len).min().unwrap_or(0);
        for start in 0..count {
            let places: Vec<usize> = of_cables.iter().filter_map(|of| of.get(start).copied()).collect();
            let from: Vec<&Start> = places.iter().filter_map(|place| all_starts.get(*place)).collect();
            let candidate = Candidate::Alike(effect);
            let gain = sums.gain(&places, &all_starts);
            offer(Promise { candidate, model: beside(model, candidate, &from), gain });
        }
    }
    for of in &geometries {
        let candidate = Candidate::Geometry(of.geometry);
        let gain = schur_gain(&of.own, &of.mixed, &sums.normal, &of.score, &sums.gradient);
        offer(Promise { candidate, model: beside(model, candidate, &[]), gain });
    }
    promises.sort_by(|one, other| other.gain.total_cmp(&one.gain));
    promises
}

fn is_elsewhere(start: &Values, values: &Values) -> bool {
    start.iter().zip(values).any(|(one, other)| one.to_bits() != other.to_bits())
}

/// Returns a model with one more candidate at its start; an effect of all cables alike starts from the mean of their starts.
fn beside(model: &Model, candidate: Candidate, from: &[&Start]) -> Model {
    let mut model = model.clone();
    match candidate {
        Candidate::Own(cable, effect) => {
            if let (Some(values), Some(free), [start]) = (model.values.get_mut(cable), model.free.get_mut(cable), from)
            {
                *values = start.values;
                free.extend(fitted(effect).into_iter().filter(|of| !free.contains(of)).collect::<Vec<Parameter>>());
            }
        }
        Candidate::Alike(effect) => {
            #[expect(clippy::cast_precision_loss, reason = "a count of cables")]
            let count = from.len() as f64;
            for parameter in Parameter::of(effect) {
                let place = parameter.place();
                let mean = from.iter().map(|start| start.values[place]).sum::<f64>() / count;
                model.values.iter_mut().for_each(|values| values[place] = mean);
            }
            let own = fitted(effect);
            model.free.iter_mut().for_each(|free| free.retain(|of| !own.contains(of)));
            model.alike.extend(own);
        }
        Candidate::Geometry(of) => {
            model.changes.insert(of, vec![0.0; of.count()]);
        }
    }
    model
}
