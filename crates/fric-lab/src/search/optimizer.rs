//! The optimiser: Levenberg–Marquardt as in MINPACK, by the crate `levenberg-marquardt`.
//!
//! It works on the reduced problem ([`Triangle`]), on which each of its decisions is the same as on the full one.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::gram::Triangle;
use super::vector::Coordinate;

/// Relative decrease of the sum of squares at which a search ends in any case.
const SQUARES_TOLERANCE: f64 = 1e-10;
/// Relative change of the coordinates at which a search ends in any case. Their standard errors are 1e-4 of their value or more.
const STEP_TOLERANCE: f64 = 1e-8;
/// Maximum number of evaluations per parameter.
const PATIENCE: usize = 20;
/// The same maximum if a point several standard errors from the minimum suffices.
const PATIENCE_AFAR: usize = 2;
/// A search that only has to come this near to its minimum compares models and gets fewer evaluations. On a surface that is rough on a small scale a
/// search creeps, and its gain is no evidence.
const NEAR_TO_COMPARE: f64 = 0.5;
const MOST_TO_COMPARE: usize = 100;

/// A coordinate that changes the residuals by less than this many standard errors over its whole range has no effect.
const IDLE_ERRORS: f64 = 1e-3;

/// The reason why a search has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Termination {
    /// The search reached a minimum: neither the sum of squares nor the parameters change any more.
    Converged,
    /// The search reached the maximum number of evaluations; the values are the best so far.
    OutOfPatience,
    /// The model gave non-finite numbers, or no step improved it.
    Stalled,
    /// There was nothing to vary, or no training sample.
    NothingToFit,
    /// The search was stopped on request.
    Stopped,
}

impl Termination {
    /// Returns the name used in the result's JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::OutOfPatience => "out of patience",
            Self::Stalled => "stalled",
            Self::NothingToFit => "nothing to fit",
            Self::Stopped => "stopped",
        }
    }
}

/// The end of a search.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The values.
    pub values: Vec<f64>,
    /// The values of the last evaluation, one short step before `values`.
    pub evaluated: Vec<f64>,
    /// The reason why the search ended.
    pub termination: Termination,
    /// Number of model evaluations.
    pub evaluation_count: usize,
    /// Sum of squares at `values`.
    pub squares: f64,
}

/// `JᵀJ`, `Jᵀr` and `rᵀr` with respect to the values.
pub type NormalEquations = (DMatrix<f64>, DVector<f64>, f64);

/// Minimises the sum of squares of `evaluate` over values within the ranges of their coordinates. `evaluate` returns `None` to stop.
///
/// `residual_count` is the number of residuals of the full problem. At a distance of δ standard errors from the minimum, in any direction, the sum of
/// squares is greater by a fraction `δ²/residual_count`. The search ends if δ is at most `near_errors`. The standard errors assume uncorrelated
/// residuals; the true ones are no smaller. Within one standard error, a step over which all coordinates are [straight](Coordinate::is_straight) is
/// the last one and is not evaluated: its remaining error is quadratic in the step.
///
/// A coordinate that has no effect at the start is held until the others have reached their minimum. For example, a time constant has no effect while
/// the effect has no size, and with a guessed size the first step would move the time constant anywhere. A coordinate that has no effect at that
/// minimum either stays: the ratio of a friction that does not exist would run to the end of its range.
///
/// A coordinate that a step moves beyond its range stays at that bound, and the search continues with the others. At their minimum, bounded
/// coordinates that gain from moving inside are released (an active set; J. Nocedal, S. J. Wright, *Numerical Optimization*, 2006, ch. 16.7). Each is
/// released once: where the surface bends back to the bound, the same way would be gone again and again.
pub fn minimize(
    coordinates: &[Coordinate],
    start: &[f64],
    residual_count: usize,
    near_errors: f64,
    evaluate: impl FnMut(&[f64]) -> Option<NormalEquations>,
) -> Minimum {
    let places: Vec<f64> = coordinates.iter().zip(start).map(|(of, value)| of.place_of(*value)).collect();
    let mut search =
        Search { evaluate, coordinates, residual_count, near_errors, places, at: None, evaluation_count: 0 };
    if start.is_empty() {
        return search.minimum(Termination::NothingToFit, None);
    }
    search.evaluate();
    let patience = if near_errors > 1.0 { PATIENCE_AFAR } else { PATIENCE };
    let is_compared = near_errors >= NEAR_TO_COMPARE;
    let most = (patience * (start.len() + 1)).min(if is_compared { MOST_TO_COMPARE } else { usize::MAX });
    let patience = most.div_ceil(start.len() + 1);
    let mut held: Vec<bool> = (0..start.len()).map(|place| !search.tells(place)).collect();
    let mut waiting = held.clone();
    let mut released = vec![false; start.len()];
    loop {
        let free: Vec<usize> = (0..start.len()).filter(|place| !held[*place]).collect();
        let (termination, arrival) = search.among(free, patience);
        if search.evaluation_count > most {
            return search.minimum(Termination::OutOfPatience, arrival);
        }
        let beyond: Vec<usize> = search.beyond().collect();
        if !beyond.is_empty() {
            for place in beyond {
                held[place] = true;
            }
            search.keep_in();
            continue;
        }
        if waiting.contains(&true) {
            if let Some(places) = &arrival {
                search.places.clone_from(places);
                search.evaluate();
            }
            for place in 0..start.len() {
                held[place] &= !waiting[place] || !search.tells(place);
            }
            waiting.fill(false);
            continue;
        }
        let there = arrival.as_deref().unwrap_or(&search.places);
        let inward: Vec<usize> = (0..start.len())
            .filter(|place| held[*place] && !released[*place] && search.gains_inside(*place, there))
            .collect();
        if termination != Termination::Converged || inward.is_empty() {
            return search.minimum(termination, arrival);
        }
        let mut from = arrival.unwrap_or_else(|| search.places.clone());
        for place in inward {
            (held[place], released[place]) = (false, true);
            from[place] = search.inside(place, &from);
        }
        search.places = from;
        search.evaluate();
    }
}

/// A search and its present point.
struct Search<'a, E> {
    evaluate: E,
    coordinates: &'a [Coordinate],
    residual_count: usize,
    near_errors: f64,
    /// Coordinates where the last step led. They may lie beyond the bounds, where the values are those of the bounds.
    places: Vec<f64>,
    /// The normal equations with respect to the coordinates; `None` if stopped.
    at: Option<NormalEquations>,
    evaluation_count: usize,
}

impl<E: FnMut(&[f64]) -> Option<NormalEquations>> Search<'_, E> {
    fn values(&self, places: &[f64]) -> Vec<f64> {
        self.coordinates.iter().zip(places).map(|(of, place)| of.value_at(of.kept_in(*place)).0).collect()
    }

    fn evaluate(&mut self) {
        let values = self.values(&self.places);
        self.evaluation_count += 1;
        self.at = (self.evaluate)(&values).map(|(mut matrix, mut gradient, squares)| {
            for (row, (of, place)) in self.coordinates.iter().zip(&self.places).enumerate() {
                let (_, slope) = of.value_at(of.kept_in(*place));
                matrix.row_mut(row).scale_mut(slope);
                matrix.column_mut(row).scale_mut(slope);
                gradient[row] *= slope;
            }
            (matrix, gradient, squares)
        });
    }

    /// Whether a coordinate has an effect here: more than a fraction of a standard error over its whole range.
    fn tells(&self, index: usize) -> bool {
        let Some((matrix, _, squares)) = &self.at else { return true };
        let (of, slopes) = (self.coordinates[index], matrix[(index, index)]);
        let ((least, greatest), (_, slope)) = (of.range(), of.value_at(of.kept_in(self.places[index])));
        let whole = (greatest - least) / slope;
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let variance = squares / self.residual_count as f64;
        slopes > 0.0 && slopes * whole * whole > IDLE_ERRORS * IDLE_ERRORS * variance
    }

    /// Returns the coordinates that are beyond their bounds.
    fn beyond(&self) -> impl Iterator<Item = usize> {
        let all = self.coordinates.iter().zip(&self.places).enumerate();
        all.filter(|(_, (of, place))| of.kept_in(**place).to_bits() != place.to_bits()).map(|(index, _)| index)
    }

    fn keep_in(&mut self) {
        let all = self.coordinates.iter().zip(&mut self.places);
        all.for_each(|(of, place)| *place = of.kept_in(*place));
    }

    /// Returns the slope and curvature of half the sum of squares with respect to a value at its bound, with all other coordinates at a nearby point.
    fn bend(&self, index: usize, there: &[f64]) -> Option<(f64, f64)> {
        let (matrix, gradient, _) = self.at.as_ref()?;
        let ways = there.iter().zip(&self.places).map(|(there, here)| there - here);
        let gradient =
            gradient[index] + matrix.row(index).iter().zip(ways).map(|(entry, way)| entry * way).sum::<f64>();
        let (_, slope) = self.coordinates[index].value_at(self.places[index]);
        Some((gradient / slope, matrix[(index, index)] / (slope * slope)))
    }

    /// Whether moving a coordinate from its bound into the range reduces the sum of squares.
    fn gains_inside(&self, index: usize, there: &[f64]) -> bool {
        let (Some((slope, curvature)), Some((_, _, squares))) = (self.bend(index, there), &self.at) else {
            return false;
        };
        let here = self.places[index];
        let is_inward = self.inside(index, there).to_bits() != here.to_bits();
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let errors_square = slope * slope / curvature / squares * self.residual_count as f64;
        is_inward && errors_square > self.near_errors * self.near_errors
    }

    /// Returns the coordinate at which the sum of squares is least, starting from a bound.
    fn inside(&self, index: usize, there: &[f64]) -> f64 {
        let (of, here) = (self.coordinates[index], self.places[index]);
        let Some((slope, curvature)) = self.bend(index, there) else { return here };
        let (value, (least, greatest)) = (of.value_at(here).0, of.range());
        let outward = if value - least < greatest - value { slope >= 0.0 } else { slope <= 0.0 };
        if outward { here } else { of.place_of(value - slope / curvature) }
    }

    /// Searches among some of the coordinates from the present point. Returns why it ended, and the minimum if it is a short step away.
    fn among(&mut self, free: Vec<usize>, patience: usize) -> (Termination, Option<Vec<f64>>) {
        if free.is_empty() {
            let is_stopped = self.at.is_none();
            return (if is_stopped { Termination::Stopped } else { Termination::Converged }, None);
        }
        let mut adapter = Adapter { search: self, free, triangle: None };
        adapter.reduce();
        let (adapter, report) = LevenbergMarquardt::new()
            .with_ftol(SQUARES_TOLERANCE)
            .with_xtol(STEP_TOLERANCE)
            .with_patience(patience)
            .minimize(adapter);
        let arrival = adapter.arrival();
        let termination = match report.termination {
            TerminationReason::ResidualsZero
            | TerminationReason::Orthogonal
            | TerminationReason::Converged { .. }
            | TerminationReason::NoImprovementPossible(_) => Termination::Converged,
            TerminationReason::LostPatience => Termination::OutOfPatience,
            TerminationReason::User(_) if arrival.is_some() => Termination::Converged,
            TerminationReason::User(_) => Termination::Stopped,
            _ => Termination::Stalled,
        };
        (termination, arrival)
    }

    fn minimum(&self, termination: Termination, arrival: Option<Vec<f64>>) -> Minimum {
        let evaluated = self.values(&self.places);
        Minimum {
            values: arrival.map_or_else(|| evaluated.clone(), |places| self.values(&places)),
            evaluated,
            termination,
            evaluation_count: self.evaluation_count,
            squares: self.at.as_ref().map_or(f64::NAN, |(_, _, squares)| *squares),
        }
    }
}

/// A search among some of its coordinates.
struct Adapter<'s, 'a, E> {
    search: &'s mut Search<'a, E>,
    free: Vec<usize>,
    triangle: Option<Triangle>,
}

impl<E: FnMut(&[f64]) -> Option<NormalEquations>> Adapter<'_, '_, E> {
    fn reduce(&mut self) {
        self.triangle = self.search.at.as_ref().map(|(matrix, gradient, squares)| {
            let matrix = matrix.select_rows(&self.free).select_columns(&self.free);
            Triangle::new(&matrix, &gradient.select_rows(&self.free), *squares)
        });
    }

    /// Returns all coordinates with the free ones replaced.
    fn with(&self, free: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut places = self.search.places.clone();
        self.free.iter().zip(free).for_each(|(index, place)| places[*index] = place);
        places
    }

    /// Returns the minimum if it is near, or the present point if hardly anything can be gained; `None` if the minimum is far.
    fn arrival(&self) -> Option<Vec<f64>> {
        let (search, triangle) = (&*self.search, self.triangle.as_ref()?);
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let errors = (triangle.reducible_ratio() * search.residual_count as f64).sqrt();
        let step = triangle.step().filter(|_| errors <= 1.0);
        let there = step.map(|step| self.with(self.params().iter().zip(step).map(|(place, step)| place - step)));
        let is_near = |there: &Vec<f64>| {
            let mut all = search.coordinates.iter().zip(&search.places).zip(there);
            all.all(|((of, here), there)| {
                of.kept_in(*there).to_bits() == there.to_bits() && of.is_straight(*here, *there)
            })
        };
        there.filter(is_near).or_else(|| (errors <= search.near_errors).then(|| search.places.clone()))
    }
}

impl<E: FnMut(&[f64]) -> Option<NormalEquations>> LeastSquaresProblem<f64, Dyn, Dyn> for Adapter<'_, '_, E> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, free: &DVector<f64>) {
        if self.params() != *free {
            self.search.places = self.with(free.iter().copied());
            self.search.evaluate();
            self.reduce();
        }
    }

    fn params(&self) -> DVector<f64> {
        DVector::from_iterator(self.free.len(), self.free.iter().map(|index| self.search.places[*index]))
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.triangle.as_ref().map(|triangle| DVector::from_row_slice(triangle.residuals.as_slice()))
    }

    /// Returns `None`, which ends the search, if it has arrived or left the range of a coordinate.
    fn jacobian(&self) -> Option<DMatrix<f64>> {
        if self.arrival().is_some() || self.search.beyond().next().is_some() {
            return None;
        }
        let jacobian = &self.triangle.as_ref()?.jacobian;
        Some(DMatrix::from_column_slice(jacobian.nrows(), jacobian.ncols(), jacobian.as_slice()))
    }
}

#[cfg(test)]
mod tests {
    use fric_core::effects::Effect;
    use nalgebra::{DMatrix, DVector};

    use super::{Termination, minimize};
    use crate::search::vector::{Coordinate, Parameter};

    /// Fits `size·(1 − exp(−t/time))` over 28 s to one with −0.3 and 12 s.
    #[test]
    fn a_time_constant_waits_for_the_size_of_what_it_is_of() {
        let at = |size: f64, time_s: f64, t_s: f64| size * (1.0 - (-t_s / time_s).exp());
        let evaluate = |values: &[f64]| {
            let (size, time_s) = (values[0], values[1]);
            let (mut matrix, mut gradient, mut squares) = (DMatrix::zeros(2, 2), DVector::zeros(2), 0.0);
            for t_s in (0..2800).map(|sample| 0.01 * f64::from(sample)) {
                let decay = (-t_s / time_s).exp();
                let slopes = DVector::from_vec(vec![1.0 - decay, -size * decay * t_s / (time_s * time_s)]);
                // A disturbance that no size or time constant explains.
                let residual = at(size, time_s, t_s) - at(-0.3, 12.0, t_s) - 0.01 * (40.0 * t_s).sin();
                matrix += &slopes * slopes.transpose();
                gradient += &slopes * residual;
                squares += residual * residual;
            }
            Some((matrix, gradient, squares))
        };
        let parameters: Vec<Parameter> = Parameter::of(Effect::FrictionWarmup).collect();
        let coordinates: Vec<Coordinate> = parameters.iter().map(|of| Coordinate::of(of, 1e-3)).collect();
        for start_s in [0.5, 2.0, 8.0, 30.0] {
            let found = minimize(&coordinates, &[0.0, start_s], 2800, 0.01, evaluate);
            assert_eq!(found.termination, Termination::Converged, "from {start_s} s");
            assert!((found.values[0] + 0.3).abs() < 1e-3, "from {start_s} s: {:?}", found.values);
            assert!((found.values[1] - 12.0).abs() < 0.05, "from {start_s} s: {:?}", found.values);
        }
    }

    /// The sum of squares falls from the bound by a little and then rises: the slope at the bound promises what is not there.
    #[test]
    fn a_value_that_comes_back_to_its_bound_stays_there() {
        let parameter = Parameter::named("bearing_drag.drag_n").unwrap();
        let coordinates = [Coordinate::of(&parameter, 1e-3)];
        let mut evaluations = 0;
        let evaluate = |values: &[f64]| {
            evaluations += 1;
            let (residual, slope) =
                if values[0] < 0.01 { (2.0 - values[0], -1.0) } else { (1.99 + 3.0 * (values[0] - 0.01), 3.0) };
            let one = |number| DMatrix::from_element(1, 1, number);
            Some((one(slope * slope), DVector::from_element(1, slope * residual), residual * residual))
        };
        let found = minimize(&coordinates, &[0.5], 1000, 0.01, evaluate);
        assert_eq!(found.termination, Termination::Converged);
        assert!(found.values[0] < 0.02, "{:?}", found.values);
        assert!(evaluations < 20, "{evaluations} evaluations");
    }
}
