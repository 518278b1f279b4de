//! How significant the names of a model are.

use fric_core::effects::Effect;
use nalgebra::{DMatrix, DVector};

use crate::candidates::catalogue::fitted;
use crate::discover::naming::evidence::in_standard_errors;
use crate::discover::wrench::bench::{Bench, Trial};
use crate::discover::wrench::candidate::Candidate;
use crate::discover::wrench::model::{Model, Unknown};
use crate::fit::Parameter;
use crate::search::gram::inverse_of_normal;

/// The certainty of a name's parameters.
pub struct Standing {
    /// Factor by which memory in the deviations weakens the evidence, at least 1; infinite if the samples do not determine the parameters.
    pub inflation: f64,
    /// Distance of all parameters together from their neutral values, in standard errors.
    pub away: f64,
}

impl Standing {
    /// If the samples do not determine the parameters.
    pub const UNDETERMINED: Self = Self { inflation: f64::INFINITY, away: 0.0 };
}

/// Returns the certainty of each of a model's candidates.
pub fn standings(bench: &Bench<'_>, trial: &Trial, candidates: &[Candidate]) -> Vec<Standing> {
    if candidates.is_empty() {
        return Vec::new();
    }
    let unknowns = trial.model.unknowns();
    let covariances = bench.covariances(&trial.model);
    let of = |candidate: &Candidate| {
        let [covariance, independent] = covariances.as_ref()?;
        // The period of a ripple has no neutral value.
        let is_of = |parameter: &Parameter, effect| parameter.effect() == Some(effect) && !parameter.is_period();
        let is_its = |unknown: &Unknown| match (*candidate, unknown) {
            (Candidate::Own(cable, effect), Unknown::Own(of, parameter)) => cable == *of && is_of(parameter, effect),
            (Candidate::Alike(effect), Unknown::Alike(parameter)) => is_of(parameter, effect),
            (Candidate::Geometry(geometry), Unknown::Geometry(of, _)) => geometry == *of,
            _ => false,
        };
        let places: Vec<usize> = (0..unknowns.len()).filter(|place| unknowns.get(*place).is_some_and(is_its)).collect();
        let inflation =
            places.iter().map(|place| covariance[(*place, *place)] / independent[(*place, *place)]).fold(1.0, f64::max);
        let away = places.iter().map(|place| away_from_neutral(&trial.model, &unknowns[*place]));
        let away = DVector::from_iterator(places.len(), away);
        Some(Standing { inflation, away: in_standard_errors(&away, covariance, &places)? })
    };
    candidates.iter().map(|candidate| of(candidate).unwrap_or(Standing::UNDETERMINED)).collect()
}

/// Returns how much the cables of a model differ in the parameters of an effect that each has on its own: `χ²` of the differences minus its degrees of
/// freedom, in standard deviations of that. 0 if the samples do not determine the parameters.
pub fn disagreement(bench: &Bench<'_>, apart: &Trial, effect: Effect) -> f64 {
    let unknowns = apart.model.unknowns();
    let known = |covariances: [DMatrix<f64>; 2]| {
        let [covariance, _] = covariances;
        let place_of = |cable: usize, parameter: &Parameter| {
            unknowns.iter().position(|unknown| *unknown == Unknown::Own(cable, *parameter))
        };
        let parameters: Vec<Parameter> = fitted(effect);
        let pairs = (1..bench.records.len()).flat_map(|cable| parameters.iter().map(move |of| (cable, *of)));
        let pairs: Vec<(usize, usize, f64)> = pairs
            .map(|(cable, of)| {
                let difference = apart.model.values[cable][of.place()] - apart.model.values[0][of.place()];
                Some((place_of(cable, &of)?, place_of(0, &of)?, difference))
            })
            .collect::<Option<_>>()?;
        let of_difference = DMatrix::from_fn(pairs.len(), unknowns.len(), |row, column| {
            let (one, other, _) = pairs[row];
            f64::from(u8::from(column == one)) - f64::from(u8::from(column == other))
        });
        let differences = DVector::from_iterator(pairs.len(), pairs.iter().map(|(_, _, difference)| *difference));
        let inverse = inverse_of_normal(&(&of_difference * covariance * of_difference.transpose()))?;
        #[expect(clippy::cast_precision_loss, reason = "a few parameters")]
        let freedom = pairs.len() as f64;
        Some(((differences.transpose() * inverse * &differences)[(0, 0)] - freedom) / (2.0 * freedom).sqrt())
    };
    bench.covariances(&apart.model).and_then(known).unwrap_or(0.0)
}

fn away_from_neutral(model: &Model, unknown: &Unknown) -> f64 {
    let from_neutral = |cable: usize, of: &Parameter| {
        model.values.get(cable).map_or(f64::NAN, |values| values[of.place()] - of.row().neutral)
    };
    match unknown {
        Unknown::Own(cable, of) => from_neutral(*cable, of),
        Unknown::Alike(of) => from_neutral(0, of),
        Unknown::Geometry(of, place) => {
            model.changes.get(of).and_then(|numbers| numbers.get(*place)).copied().unwrap_or(0.0)
        }
    }
}
