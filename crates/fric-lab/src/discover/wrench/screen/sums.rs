//! Sums over the samples from which the promises of all candidates follow.

use nalgebra::{DMatrix, DVector, Vector6};

use super::columns::{Columns, Start};
use crate::discover::wrench::bench::Bench;
use crate::discover::wrench::geometry::Geometry;
use crate::discover::wrench::model::Model;
use crate::search::gram::{Gram, inverse_of_normal};

/// A direction of a candidate counts as one that the model already has if less than this fraction of its squares is independent of the model.
const OWN_RATIO: f64 = 1e-6;

/// Returns `bᵀS⁻¹b` without directions that the model already has; NaN if the sums are.
pub fn schur_gain(
    own: &DMatrix<f64>,
    mixed: &DMatrix<f64>,
    normal: &DMatrix<f64>,
    own_gradient: &DVector<f64>,
    gradient: &DVector<f64>,
) -> f64 {
    let Some(inverse) = inverse_of_normal(normal) else { return f64::NAN };
    let by_others = mixed.transpose() * inverse;
    let schur = own - &by_others * mixed;
    let score = own_gradient - &by_others * gradient;
    let scale: Vec<f64> = own.diagonal().iter().map(|square| square.sqrt()).collect();
    let unit = |place: usize| if scale[place] > 0.0 { scale[place].recip() } else { 0.0 };
    let scaled =
        DMatrix::from_fn(own.nrows(), own.ncols(), |row, column| schur[(row, column)] * unit(row) * unit(column));
    if scaled.iter().any(|entry| !entry.is_finite()) {
        return f64::NAN;
    }
    let eigen = scaled.symmetric_eigen();
    let scaled_score = DVector::from_fn(score.len(), |row, _| score[row] * unit(row));
    let parts = eigen.eigenvectors.column_iter().zip(eigen.eigenvalues.iter());
    parts
        .filter(|(_, size)| **size > OWN_RATIO)
        .map(|(direction, size)| direction.dot(&scaled_score).powi(2) / size)
        .sum()
}

/// The sums of an entry of the robot file, and the whitened derivatives of the deviations by its numbers in every sample.
pub struct GeometrySums {
    pub geometry: Geometry,
    tangents: Vec<Vec<Vector6<f64>>>,
    pub own: DMatrix<f64>,
    pub mixed: DMatrix<f64>,
    pub score: DVector<f64>,
}

impl GeometrySums {
    pub fn new(geometry: Geometry, tangents: Vec<Vec<Vector6<f64>>>, unknowns: usize) -> Self {
        let count = tangents.len();
        let (own, mixed) = (DMatrix::zeros(count, count), DMatrix::zeros(unknowns, count));
        Self { geometry, tangents, own, mixed, score: DVector::zeros(count) }
    }

    fn add(&mut self, place: usize, rows: &[Vec<f64>]) {
        let changes: Vec<Vector6<f64>> =
            self.tangents.iter().filter_map(|tangent| tangent.get(place)).copied().collect();
        for (column, change) in changes.iter().enumerate() {
            for (row, part) in rows.iter().zip(change.iter()) {
                let Some((deviation, derivatives)) = row.split_last() else { continue };
                self.score[column] += part * deviation;
                let mut mixed = self.mixed.column_mut(column);
                mixed.iter_mut().zip(derivatives).for_each(|(sum, derivative)| *sum += part * derivative);
            }
            for (row, other) in changes.iter().enumerate() {
                self.own[(row, column)] += other.dot(change);
            }
        }
    }
}

/// Returns the pairs of starts whose products are needed, with sums of 0: each start with itself, and with the start of the same effect on each other
/// cable that has the same index among its starts.
fn squares_of(starts: &[Start]) -> Vec<(usize, usize, DMatrix<f64>)> {
    let order = |place: usize, of: &Start| {
        starts.iter().take(place).filter(|other| other.cable == of.cable && other.effect == of.effect).count()
    };
    let mut squares = Vec::new();
    for (one, from) in starts.iter().enumerate() {
        for (other, to) in starts.iter().enumerate().skip(one) {
            let is_pair = other == one
                || from.effect == to.effect
                    && from.cable != to.cable
                    && from.columns.len() == to.columns.len()
                    && order(one, from) == order(other, to);
            if is_pair {
                squares.push((one, other, DMatrix::zeros(from.columns.len(), to.columns.len())));
            }
        }
    }
    squares
}

/// Sums over the training samples.
pub struct Sums {
    /// `JᵀJ`.
    pub normal: DMatrix<f64>,
    /// `Jᵀr`.
    pub gradient: DVector<f64>,
    /// `CᵀJ` of each cable.
    mixed: Vec<DMatrix<f64>>,
    /// `Cᵀr` of each cable.
    scores: Vec<DVector<f64>>,
    /// `CᵀC` of the pairs of [`squares_of`].
    squares: Vec<(usize, usize, DMatrix<f64>)>,
}

impl Sums {
    pub fn of(bench: &Bench<'_>, model: &Model, columns: &mut Columns<'_>, geometries: &mut [GeometrySums]) -> Self {
        let count = model.unknowns().len();
        let (structure, _) = bench.description.changed(&model.changes);
        let cables = bench.records.len();
        let mut gram = Gram::new(count);
        let counts: Vec<usize> = (0..cables).map(|cable| columns.count(cable)).collect();
        let mut mixed: Vec<Vec<f64>> = counts.iter().map(|of_cable| vec![0.0; of_cable * count]).collect();
        let mut scores: Vec<DVector<f64>> = counts.iter().map(|of_cable| DVector::zeros(*of_cable)).collect();
        let starts = columns.starts;
        let mut squares = squares_of(starts);
        let mut levers: Vec<Vector6<f64>> = Vec::with_capacity(cables);
        // The product of a cable's whitened column of the structure matrix with the rows: derivatives, then deviation.
        let mut seen = vec![0.0; count + 1];
        bench.rows(model, |place, rows| {
            for row in rows {
                gram.add(row);
            }
            columns.advance_to(place);
            levers.clear();
            for (cable, (mixed, scores)) in mixed.iter_mut().zip(&mut scores).enumerate() {
                let lever =
                    structure.get(place * cables + cable).map_or_else(Vector6::zeros, |of| bench.whitening * of);
                levers.push(lever);
                seen.fill(0.0);
                for (row, part) in rows.iter().zip(lever.iter()) {
                    seen.iter_mut().zip(row).for_each(|(sum, entry)| *sum += part * entry);
                }
                let Some((deviation, derivatives)) = seen.split_last() else { continue };
                let changes = columns.of_cable(cable);
                for (change, of_change) in changes.iter().zip(mixed.chunks_exact_mut(count.max(1))) {
                    of_change.iter_mut().zip(derivatives).for_each(|(sum, derivative)| *sum += change * derivative);
                }
                scores.iter_mut().zip(changes).for_each(|(sum, change)| *sum += change * deviation);
            }
            for (one, other, sum) in &mut squares {
                let (Some(one), Some(other)) = (starts.get(*one), starts.get(*other)) else { continue };
                let (Some(left), Some(right)) = (levers.get(one.cable), levers.get(other.cable)) else { continue };
                let lever = left.dot(right);
                for (row, left) in columns.of_start(one).iter().enumerate() {
                    for (column, right) in columns.of_start(other).iter().enumerate() {
                        sum[(row, column)] += lever * left * right;
                    }
                }
            }
            for of in geometries.iter_mut() {
                of.add(place, rows);
            }
        });
        let (normal, gradient, _) = gram.normal_equations();
        let of_cable = |(mixed, of_cable): (&Vec<f64>, &usize)| DMatrix::from_row_slice(*of_cable, count, mixed);
        let mixed = mixed.iter().zip(&counts).map(of_cable).collect();
        Self { normal, gradient, mixed, scores, squares }
    }

    /// Returns the decrease of the sum of squares by the same step from these starts of different cables.
    pub fn gain(&self, places: &[usize], starts: &[Start]) -> f64 {
        let of: Vec<&Start> = places.iter().filter_map(|place| starts.get(*place)).collect();
        let Some(width) = of.first().map(|start| start.columns.len()) else { return f64::NAN };
        if of.iter().any(|start| start.columns.len() != width) {
            return f64::NAN;
        }
        let mut own = DMatrix::zeros(width, width);
        for (one, other, sum) in
            self.squares.iter().filter(|(one, other, _)| [one, other].iter().all(|of| places.contains(of)))
        {
            own += sum;
            if one != other {
                own += sum.transpose();
            }
        }
        let mut mixed = DMatrix::zeros(self.normal.nrows(), width);
        let mut score = DVector::zeros(width);
        for start in of {
            let (Some(of_cable), Some(scores)) = (self.mixed.get(start.cable), self.scores.get(start.cable)) else {
                return f64::NAN;
            };
            mixed += of_cable.rows(start.columns.start, width).transpose();
            score += scores.rows(start.columns.start, width);
        }
        schur_gain(&own, &mixed, &self.normal, &score, &self.gradient)
    }
}
