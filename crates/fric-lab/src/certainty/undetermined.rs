//! Finds undetermined parameters: the uncertainty of each parameter, which ones are held at their given values, and what each of those is confused
//! with.
//!
//! While a parameter is undetermined (see [`Yardstick`]), one parameter is held and the rest is fitted again. The open directions of the information
//! matrix ([`open_directions`]) select it: the parameter with the most weight in the least known direction. A time
//! that is [`assumed`] comes first. Among the parameters of one cable an offset comes last, because it does no harm elsewhere. Among the offsets of
//! several cables that only have an effect together (an inner tension of the platform), the one with the most weight is held, because the others
//! compensate for its error.

use std::sync::Arc;

use fric_core::parameters::{OFFSET, SIGMA, Values};
use nalgebra::DMatrix;

use super::determined::{HALF_INTERVAL, Yardstick};
use super::directions::{LEAST_WEIGHT, OpenDirection, open_directions};
use super::groups::Groups;
use super::{assumed, own_noise, unlike_pulleys};
use crate::replay::Deviation;
use crate::samples::selection::Standing;
use crate::search::gram::inverse_of_normal;
use crate::search::optimizer::Termination;
use crate::search::pass::Forces;
use crate::search::problem::{Comparison, Member, Problem};
use crate::search::solve::{
    CONTRADICTION_RATIO, GROSS_CONTRADICTION, NEAR_ERRORS, OpenCombination, OpenPart, Solution, Unknown, Weighing,
    hold, settle, squares, unknowns,
};
use crate::search::vector::Coordinate;

/// The uncertainty of the parameters at some values.
struct Knowledge {
    unknowns: Vec<Unknown>,
    /// `JᵀJ`; `None` if it is not finite.
    normal: Option<DMatrix<f64>>,
    covariance: DMatrix<f64>,
    /// Vagueness of each parameter; above 1 it is undetermined.
    vagueness: Vec<f64>,
}

impl Knowledge {
    fn of(problem: &Problem<'_>, values: &[Values]) -> Self {
        let (normal, covariance, leverages) = uncertainty(problem, values, None);
        let sticks = yardsticks(problem, values);
        let of = |(place, unknown): (usize, &Unknown)| {
            let standard_error = covariance[(place, place)].sqrt();
            let leverage = leverages.get(place).copied().unwrap_or(0.0);
            sticks.get(unknown.member).zip(values.get(unknown.member)).map_or(f64::INFINITY, |(stick, values)| {
                stick.vagueness(&unknown.parameter, values, standard_error, leverage)
            })
        };
        let unknowns = unknowns(problem);
        let vagueness = unknowns.iter().enumerate().map(of).collect();
        Self { unknowns, normal, covariance, vagueness }
    }

    /// Whether the interval of a parameter reaches so far from its value.
    fn reaches(&self, unknown: &Unknown, off: f64) -> bool {
        let place = self.unknowns.iter().position(|other| other == unknown);
        place.is_some_and(|place| off.abs() < HALF_INTERVAL * self.covariance[(place, place)].sqrt())
    }

    /// Returns by how much the sum of squares rises from a minimum to the end of the interval of a parameter, with the others free; 0 if it has none.
    fn rise(&self, unknown: &Unknown) -> f64 {
        let place = self.unknowns.iter().position(|other| other == unknown);
        let inverse = self.normal.as_ref().and_then(inverse_of_normal);
        let rise = place
            .zip(inverse)
            .map(|(place, inverse)| HALF_INTERVAL.powi(2) * self.covariance[(place, place)] / inverse[(place, place)]);
        rise.filter(|rise| rise.is_finite()).unwrap_or(0.0)
    }

    /// Returns the open directions. Each parameter is scaled so that its own interval is as wide as its vagueness.
    fn directions(&self) -> Vec<OpenDirection> {
        let count = self.unknowns.len();
        let Some((normal, inverse)) =
            self.normal.as_ref().and_then(|normal| Some((normal, inverse_of_normal(normal)?)))
        else {
            return open_directions(&DMatrix::from_element(count, count, f64::NAN));
        };
        let scale = |place: usize| {
            let vagueness = self.vagueness.get(place).copied().unwrap_or(f64::INFINITY);
            let scale = HALF_INTERVAL * inverse[(place, place)].sqrt() / vagueness;
            if scale.is_finite() { scale } else { 0.0 }
        };
        open_directions(&DMatrix::from_fn(count, count, |row, column| {
            normal[(row, column)] * scale(row) * scale(column)
        }))
    }

    /// Returns the parameter to hold and its combination; `None` if all are determined or must be varied.
    fn to_hold(&self, kept: &[Unknown]) -> Option<(Unknown, OpenCombination)> {
        let is_kept = |place: usize| self.unknowns.get(place).is_none_or(|unknown| kept.contains(unknown));
        let vagueness = |place: usize| self.vagueness.get(place).copied().unwrap_or(f64::INFINITY);
        if !(0..self.unknowns.len()).any(|place| vagueness(place) > 1.0 && !is_kept(place)) {
            return None;
        }
        let is_offset =
            |place: usize| self.unknowns.get(place).is_some_and(|unknown| unknown.parameter.place() == OFFSET);
        let is_assumed =
            |place: usize| self.unknowns.get(place).is_some_and(|unknown| assumed::is_assumed(&unknown.parameter));
        let of_direction = |direction: &OpenDirection| {
            let parts = direction.parts();
            let (offsets, others): (Vec<usize>, Vec<usize>) = parts.iter().partition(|place| is_offset(**place));
            let first_of = |places: Vec<usize>| places.into_iter().find(|place| !is_kept(*place));
            let assumed = first_of(parts.iter().copied().filter(|place| is_assumed(*place)).collect());
            let held = assumed.or_else(|| {
                if offsets.len() > 1 {
                    first_of(offsets).or_else(|| first_of(others))
                } else {
                    first_of(others).or_else(|| first_of(offsets))
                }
            });
            Some((held?, parts, direction.clone()))
        };
        let (held, mut parts, direction) = self.directions().iter().find_map(of_direction)?;
        // Along the direction, each parameter moves in proportion to its weight and its own standard error.
        let step = |place: usize| {
            let weight = direction.weights.get(place).copied().unwrap_or(0.0);
            weight * self.covariance[(place, place)].sqrt() / vagueness(place)
        };
        // The step of the held parameter is 1.96 standard errors.
        let factor = HALF_INTERVAL * self.covariance[(held, held)].sqrt() / step(held);
        // Parameters of one kind are compared in their own unit.
        let is_alike = |place: usize| {
            self.unknowns.get(place).map(|unknown| unknown.parameter)
                == self.unknowns.get(held).map(|held| held.parameter)
                && step(place).abs() >= LEAST_WEIGHT * step(held).abs()
        };
        parts.extend((0..self.unknowns.len()).filter(|place| is_alike(*place)));
        parts.sort_unstable();
        parts.dedup();
        parts.retain(|place| *place != held);
        parts.insert(0, held);
        let part = |place: &usize| {
            let Unknown { member, parameter } = *self.unknowns.get(*place)?;
            Some(OpenPart { cable: member, parameter, step: factor * step(*place) })
        };
        let held = *self.unknowns.get(held)?;
        Some((held, OpenCombination { parts: parts.iter().filter_map(part).collect() }))
    }
}

/// Solves a problem from the given starts, the most promising first, and holds parameters that the samples do not determine. Marks outliers in
/// `standings`.
pub fn solve(
    problem: &mut Problem<'_>,
    starts: Vec<Vec<Values>>,
    given: &[Values],
    cycle_s: f64,
    weighing: Weighing,
    standings: &mut [Standing],
) -> Solution {
    let mut solution = settle(problem, starts, given, cycle_s, weighing, standings);
    solution.hold_undetermined(problem, given, cycle_s);
    if matches!(problem.comparison, Comparison::Forces) && !solution.unknowns.is_empty() {
        solution.covariance = reported_covariance(problem, &solution.values, &solution.undetermined);
    }
    solution
}

impl Solution {
    /// Sets parameters that the search drove to a bound to that bound.
    fn settle_at_bounds(&mut self, knowledge: &Knowledge, cycle_s: f64) {
        self.at_bound.clear();
        for (place, unknown) in knowledge.unknowns.iter().enumerate() {
            let Some(values) = self.values.get_mut(unknown.member) else { continue };
            let value = &mut values[unknown.parameter.place()];
            // For a determined parameter a hundredth of a standard error is negligible.
            let is_determined = knowledge.vagueness.get(place).is_some_and(|vagueness| *vagueness <= 1.0);
            let near = if is_determined { NEAR_ERRORS * knowledge.covariance[(place, place)].sqrt() } else { 0.0 };
            if let Some(bound) = Coordinate::of(&unknown.parameter, cycle_s).bound_at(*value, near) {
                *value = bound;
                self.at_bound.push(*unknown);
            }
        }
    }

    /// Holds the undetermined parameters one after the other. A parameter whose given value contradicts the samples keeps its estimate, because the
    /// samples know that much. So does friction at its bound, which is none, if friction within its interval contradicts the samples: the interval is as wide as
    /// that because the model misses something, and no friction is the best that it can do, whatever was given. The end of an effect's range is no such value:
    /// the given one takes its place if it is within the interval, unless the contradiction is gross.
    pub(crate) fn hold_undetermined(&mut self, problem: &mut Problem<'_>, given: &[Values], cycle_s: f64) {
        let mut kept = Vec::new();
        let mut least = None;
        loop {
            let knowledge = Knowledge::of(problem, &self.values);
            let stopped = self.termination == Termination::Stopped;
            self.settle_at_bounds(&knowledge, cycle_s);
            let next = knowledge.to_hold(&kept).filter(|_| !stopped);
            let off = |held: &Unknown| {
                let value =
                    |of: &[Values]| of.get(held.member).map_or(f64::NAN, |values| values[held.parameter.place()]);
                value(given) - value(&self.values)
            };
            // Where σ ends it has no slope, and an interval that says nothing.
            let is_ended = |held: &Unknown| held.parameter.place() != SIGMA && self.at_bound.contains(held);
            let ended = next.as_ref().map(|(held, _)| held).filter(|held| is_ended(held));
            let has_friction = ended.is_some_and(|held| held.parameter.is_friction());
            let rise = ended.filter(|_| has_friction).map_or(0.0, |held| knowledge.rise(held));
            let stays_open = ended.is_some_and(|held| !has_friction && knowledge.reaches(held, off(held)));
            (self.covariance, self.unknowns) = (knowledge.covariance, knowledge.unknowns);
            let Some((held, combination)) = next else { return };
            // The bound refers to the values before the first parameter was held, because many small steps add up.
            let least = *least.get_or_insert_with(|| squares(problem, &self.values));
            if rise > CONTRADICTION_RATIO * least {
                kept.push(held);
                continue;
            }
            let (members, found, termination) = (problem.members.clone(), self.values.clone(), self.termination);
            hold(problem, held, &mut self.values, given);
            self.search_on(problem, cycle_s);
            let bound = least * if stays_open { GROSS_CONTRADICTION } else { 1.0 + CONTRADICTION_RATIO };
            if squares(problem, &self.values) > bound {
                (problem.members, self.values, self.termination) = (members, found, termination);
                kept.push(held);
            } else {
                self.undetermined.push(held);
                self.open.push(combination);
            }
        }
    }
}

/// Returns the covariance of a problem's free parameters at some values and, in its order, the vagueness of each parameter: above 1 the samples do
/// not determine it, see [`Yardstick`].
pub fn vagueness(problem: &Problem<'_>, values: &[Values]) -> (DMatrix<f64>, Vec<(f64, Unknown)>) {
    let Knowledge { unknowns, covariance, vagueness, .. } = Knowledge::of(problem, values);
    (covariance, vagueness.into_iter().zip(unknowns).collect())
}

/// Returns the scale of each cable of a problem.
pub fn yardsticks(problem: &Problem<'_>, values: &[Values]) -> Vec<Yardstick> {
    let forces = problem.forces(values).unwrap_or_default();
    let of = |((member, values), forces): ((&Member<'_>, &Values), &Arc<Forces>)| {
        let gain = member.record.params.frictionless_gain();
        let (mut friction, mut tension) = (Deviation::default(), Deviation::default());
        for (cycle, row) in member.record.rows.iter().enumerate().filter(|(_, row)| row.is_sound()) {
            let frictionless_n = row.signals.sensor_force_n * gain;
            friction.add(forces.at(cycle).0 - values[OFFSET] - frictionless_n);
            tension.add(frictionless_n);
        }
        let [friction_n, tension_n] = [friction, tension].map(|force| force.rms().unwrap_or(0.0));
        Yardstick::new(friction_n, tension_n, member.record.params.pulley_count())
    };
    problem.members.iter().zip(values).zip(&forces).map(of).collect()
}

/// Returns the covariance of a problem's free parameters, infinite if the samples say nothing.
pub fn covariance(problem: &Problem<'_>, values: &[Values]) -> DMatrix<f64> {
    uncertainty(problem, values, None).1
}

/// Returns the covariance to report: for a single cable it also covers groups of samples in the same condition, and it includes the effects of unlike
/// pulleys, of the sensor's noise in the model, and of the times among what is `undetermined` that are assumed.
pub fn reported_covariance(problem: &Problem<'_>, values: &[Values], undetermined: &[Unknown]) -> DMatrix<f64> {
    let groups = match (&problem.comparison, problem.members.as_slice()) {
        (Comparison::Forces, [member]) => Some(Groups::of(&member.record)),
        _ => None,
    };
    let (normal, mut covariance, _) = uncertainty(problem, values, groups);
    if let Some(inverse) = normal.as_ref().and_then(inverse_of_normal) {
        covariance += unlike_pulleys::covariance(problem, values, &inverse);
    }
    if let Some(error) = own_noise::error(problem, values) {
        covariance += &error * error.transpose();
    }
    covariance + assumed::covariance(problem, values, undetermined)
}

/// Returns the matrix `JᵀJ` (`None` if it is not finite), the covariance, and the greatest shift of each parameter for residuals of 1 N in every
/// sample.
fn uncertainty(
    problem: &Problem<'_>,
    values: &[Values],
    groups: Option<Groups>,
) -> (Option<DMatrix<f64>>, DMatrix<f64>, Vec<f64>) {
    let count = problem.parameter_count();
    let unknown = || (None, DMatrix::from_diagonal_element(count, count, f64::INFINITY), vec![f64::INFINITY; count]);
    let Some((gram, scores)) = problem.gram_and_scores(values, groups) else { return unknown() };
    let (matrix, ..) = gram.normal_equations();
    let Some(inverse) = inverse_of_normal(&matrix) else { return unknown() };
    let covariance = scores.covariance(&inverse);
    let silent = |place: usize| matrix[(place, place)] <= 0.0;
    let finite = |row, column| if row == column && silent(row) { f64::INFINITY } else { covariance[(row, column)] };
    // Residuals of a wrench are not forces of a cable.
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let samples = match problem.comparison {
        Comparison::Forces => problem.used.iter().filter(|used| **used).count() as f64,
        Comparison::Wrench { .. } => 0.0,
    };
    let leverages = inverse.diagonal().iter().map(|variance| (samples * variance).sqrt()).collect();
    let covariance = DMatrix::from_fn(count, count, finite);
    (Some(matrix), covariance, leverages)
}
