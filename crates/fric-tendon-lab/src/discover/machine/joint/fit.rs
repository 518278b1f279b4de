//! Minima of the joint cost over a set of free numbers, and the linearised decrease by which candidates are ranked.

use fric_lab::statistics::inverse_of_normal;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::{Jacobian, Joint, Point, Set, Units, weighted};
use crate::identify::unknown::Unknown;

const MOST_STEPS: usize = 8;

const MOST_HALVINGS: i32 = 5;

/// A step that decreases the cost by less than this is the last one.
const SETTLED: f64 = 0.05;

impl Joint<'_> {
    /// Returns the normal equations of all numbers.
    pub fn gram(&self, point: &Point, jacobian: &Jacobian, units: Units) -> (DMatrix<f64>, DVector<f64>) {
        let weights = self.weights(point, units);
        let columns: Vec<Vec<f64>> = jacobian.0.par_iter().map(|column| weighted(column, &weights)).collect();
        let left = weighted(&point.left, &weights);
        let dot = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(one, other)| one * other).sum::<f64>();
        let count = columns.len();
        let rows: Vec<Vec<f64>> = (0..count)
            .into_par_iter()
            .map(|row| {
                (0..count)
                    .map(|column| if column <= row { dot(&columns[row], &columns[column]) } else { 0.0 })
                    .collect()
            })
            .collect();
        let matrix = DMatrix::from_fn(count, count, |row, column| rows[row.max(column)][row.min(column)]);
        let right = DVector::from_iterator(count, columns.iter().map(|column| dot(column, &left)));
        (matrix, right)
    }

    /// Returns the linearised decrease of the cost by a set, and its step.
    pub fn linear(
        &self,
        point: &Point,
        set: &Set,
        (matrix, right): (&DMatrix<f64>, &DVector<f64>),
    ) -> Option<(f64, DVector<f64>)> {
        let count = set.active.len();
        let picked = DMatrix::from_fn(count, count, |row, column| {
            let known = if row == column { set.precision[row] } else { 0.0 };
            matrix[(set.active[row], set.active[column])] + known
        });
        let gradient = DVector::from_fn(count, |row, _| {
            right[set.active[row]] + set.precision[row] * self.distance(&point.state, set.active[row])
        });
        let step = -(inverse_of_normal(&picked)? * &gradient);
        Some((-step.dot(&gradient), step))
    }

    /// Returns the minimum of a set. `jacobian` belongs to a nearby point; only the slopes of the numbers in `fresh` are recomputed.
    pub fn fitted(
        &self,
        start: &Point,
        set: &Set,
        jacobian: &Jacobian,
        fresh: &[Unknown],
        units: Units,
    ) -> Option<Point> {
        let mut now = self.neutral(start, set)?;
        let mut own = Jacobian(jacobian.0.clone());
        let mut cost = self.cost(&now, set, units);
        for step_count in 0..MOST_STEPS {
            if step_count > 0 {
                for place in fresh.iter().filter_map(|unknown| self.place(*unknown)) {
                    own.0[place] = self.slope(&now, place)?;
                }
            }
            let (matrix, right) = self.gram_of(&now, &own, set, units);
            let (gain, step) = self.linear(&now, set, (&matrix, &right))?;
            if gain < SETTLED {
                break;
            }
            let finite = now.left.iter().filter(|left| left.is_finite()).count();
            let trial = |share: f64| {
                let state = set
                    .active
                    .iter()
                    .zip(step.iter())
                    .fold(now.state.clone(), |state, (place, change)| self.moved(&state, *place, share * change));
                let trial = self.point(state, Some(&now))?;
                let is_whole = trial.left.iter().filter(|left| left.is_finite()).count() >= finite;
                let trial_cost = self.cost(&trial, set, units);
                (is_whole && trial_cost < cost).then_some((trial, trial_cost))
            };
            let Some((next, next_cost)) = (0..MOST_HALVINGS).find_map(|halving| trial(0.5_f64.powi(halving))) else {
                break;
            };
            let is_settled = cost - next_cost < SETTLED;
            (now, cost) = (next, next_cost);
            if is_settled {
                break;
            }
        }
        Some(now)
    }

    /// Returns the point with all numbers outside a set as the file states them.
    fn neutral(&self, point: &Point, set: &Set) -> Option<Point> {
        let mut state = point.state.clone();
        for (place, (_, distance)) in state.unknowns.iter_mut().enumerate() {
            if !set.active.contains(&place) {
                *distance = 0.0;
            }
        }
        if state == point.state { Some(point.clone()) } else { self.point(state, Some(point)) }
    }

    /// Returns the normal equations of a set, in a matrix of all numbers.
    pub(super) fn gram_of(
        &self,
        point: &Point,
        jacobian: &Jacobian,
        set: &Set,
        units: Units,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let weights = self.weights(point, units);
        let columns: Vec<Vec<f64>> = set.active.iter().map(|place| weighted(&jacobian.0[*place], &weights)).collect();
        let left = weighted(&point.left, &weights);
        let dot = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(one, other)| one * other).sum::<f64>();
        let count = jacobian.0.len();
        let (mut matrix, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (row, place) in set.active.iter().enumerate() {
            right[*place] = dot(&columns[row], &left);
            for (column, other) in set.active.iter().enumerate().take(row + 1) {
                let product = dot(&columns[row], &columns[column]);
                (matrix[(*place, *other)], matrix[(*other, *place)]) = (product, product);
            }
        }
        (matrix, right)
    }

    /// Returns the sample from which on a common shift of all gratings decreases the cost most, beside a set.
    pub fn step_begin(&self, point: &Point, set: &Set, jacobian: &Jacobian, units: Units) -> Option<usize> {
        let shift = self.place(Unknown::CommonShift)?;
        let weights = self.weights(point, units);
        let column = weighted(&jacobian.0[shift], &weights);
        let others: Vec<usize> = set.active.iter().copied().filter(|place| *place != shift).collect();
        let columns: Vec<Vec<f64>> = others.iter().map(|place| weighted(&jacobian.0[*place], &weights)).collect();
        let left = weighted(&point.left, &weights);
        let (matrix, right) = self.gram_of(point, jacobian, set, units);
        let count = others.len();
        let precision =
            |row: usize| set.active.iter().position(|place| *place == others[row]).map_or(0.0, |at| set.precision[at]);
        let picked = DMatrix::from_fn(count, count, |row, other| {
            matrix[(others[row], others[other])] + if row == other { precision(row) } else { 0.0 }
        });
        let inverse = inverse_of_normal(&picked)?;
        let gradient = DVector::from_fn(count, |row, _| {
            right[others[row]] + precision(row) * self.distance(&point.state, others[row])
        });
        let pulled = &inverse * gradient;
        let (tension_width, marker_width) = self.widths();
        let width = (tension_width + marker_width).max(1);
        let (mut squares, mut product, mut cross) = (0.0, 0.0, DVector::zeros(count));
        let mut best = (0.0, 0);
        for sample in (0..left.len() / width).rev() {
            for place in sample * width..(sample + 1) * width {
                squares += column[place] * column[place];
                product += column[place] * left[place];
                for (cross, other) in cross.iter_mut().zip(&columns) {
                    *cross += column[place] * other[place];
                }
            }
            let own = squares - cross.dot(&(&inverse * &cross));
            let gain = (product - cross.dot(&pulled)).powi(2) / own;
            if own > 1e-6 * squares && gain > best.0 {
                best = (gain, sample);
            }
        }
        Some(best.1)
    }
}
