//! A table with its prediction error: whether it holds in other conditions, and its fit beside the model.

use std::ops::Range;

use fric_core::effects::Effect;
use fric_core::effects::empirical::{Over, RATIO, SHARES, SIZE};
use fric_core::parameters::Values;
use nalgebra::{DMatrix, DVector};

use super::layout::{Changes, Layout, condition, shares};
use super::normal::{Normal, Rows};
use crate::discover::workbench::{Model, Workbench};
use crate::fit::Parameter;
use crate::search::gram::inverse_of_normal;

/// Trial penalties on the second differences of a table, relative to the mean information on a share.
const PENALTIES: [f64; 5] = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1];
/// Number of folds for cross-validation over the training blocks.
const FOLDS: usize = 4;
/// The same minimum in conditions where the table was not learned, if there is an excess.
const LEAST_CLOSED_ELSEWHERE: f64 = 0.25;
/// Excess squares below this fraction of the noise variance count as small.
const LITTLE: f64 = 0.2;
/// Rounds that alternate between fitting the table and fitting the model.
const ROUNDS: usize = 3;
/// A share is known if its samples weigh at least this much.
const LEAST_WEIGHT: f64 = 20.0;
/// Minimum number of samples in a third of a condition.
const FEWEST_SAMPLES: usize = 200;

/// A table with its prediction error.
pub struct Tried {
    pub layout: Layout,
    pub penalty: f64,
    /// Fraction of the squares above the noise that it removes on the training samples, each predicted from other blocks.
    pub closed: f64,
    pub rows: Rows,
}

impl Tried {
    /// Fits the table beside the model with the penalty that predicts best. `told_n` are the loads for this, see [`loads`](super::loads).
    pub fn of(layout: &Layout, bench: &Workbench<'_>, base: &Model, told_n: &[f64], noise_n: f64) -> Option<Self> {
        let values = layout.set(&base.values, 1.0, &[0.0; SHARES]);
        let rows = layout.rows(bench, base, &values);
        let read = (layout.over == Over::Load).then(|| rows.with_conditions(layout.range, told_n));
        let read = read.as_ref().unwrap_or(&rows);
        let learned: Vec<usize> =
            bench.blocks.iter().enumerate().filter(|(_, block)| !block.held_out).map(|(place, _)| place).collect();
        let fold_of = |block: usize| learned.iter().position(|place| *place == block).map(|place| place % FOLDS);
        let folds: Vec<Option<usize>> = (0..bench.blocks.len()).map(fold_of).collect();
        let normals: Vec<Normal> = (0..FOLDS)
            .map(|fold| read.normal(|row| folds.get(read.blocks[row]).copied().flatten() == Some(fold)))
            .collect();
        let all = normals.iter().fold(Normal::none(read.width), |sum, normal| sum.and(normal));
        let predicted = |penalty: f64| -> Option<f64> {
            let of_fold = |normal: &Normal| {
                let step = all.less(normal).solved(read.first_share, penalty, &[0.0; SHARES])?;
                Some(normal.squares_after(&step))
            };
            normals.iter().map(of_fold).sum::<Option<f64>>()
        };
        let best = PENALTIES.iter().filter_map(|penalty| Some((predicted(*penalty)?, *penalty)));
        let (predicted, penalty) = best.min_by(|one, other| one.0.total_cmp(&other.0))?;
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let noise = read.held_out.iter().filter(|held_out| !**held_out).count() as f64 * noise_n * noise_n;
        let before = all.squares();
        let closed = (before - predicted) / (before - noise);
        (before > noise).then(|| Self { layout: layout.clone(), penalty, closed, rows })
    }

    /// Whether a table that was learned without a part of another condition holds in this part.
    pub fn holds_elsewhere(&self, bench: &Workbench<'_>, noise_n: f64) -> bool {
        let others = Over::ALL.into_iter().filter(|over| *over != self.layout.over);
        let mut all: Vec<Vec<f64>> = others
            .map(|over| {
                let values = condition(bench, over);
                if over == Over::Speed { values.into_iter().map(f64::abs).collect() } else { values }
            })
            .collect();
        all.push((0..bench.record.rows.len()).map(|cycle| bench.record.time_s(cycle)).collect());
        all.iter().all(|values| {
            let of_row = |row: usize| values.get(self.rows.cycles[row]).copied().unwrap_or(f64::NAN);
            thirds(&(0..self.rows.count()).map(of_row).collect::<Vec<_>>())
                .into_iter()
                .all(|range| self.holds_in(|row| range.contains(&of_row(row)), noise_n))
        })
    }

    /// Performs the same check on the rows for which `is_inside` holds.
    fn holds_in(&self, is_inside: impl Fn(usize) -> bool, noise_n: f64) -> bool {
        let rows = &self.rows;
        let outside = rows.normal(|row| !rows.held_out[row] && !is_inside(row));
        let (Some(with), Some(without)) =
            (outside.solved(rows.first_share, self.penalty, &[0.0; SHARES]), outside.without_shares(rows.first_share))
        else {
            return true;
        };
        // Only the part of the condition that the table has learned is checked.
        let mut weights = [0.0; SHARES];
        let mut greatest = [0.0_f64; SHARES];
        let of_shares = |row: usize| rows.at(row).get(rows.first_share..rows.width - 1).unwrap_or_default();
        for row in 0..rows.count() {
            for (greatest, number) in greatest.iter_mut().zip(of_shares(row)) {
                *greatest = greatest.max(number.abs());
            }
        }
        for row in (0..rows.count()).filter(|row| !rows.held_out[*row] && !is_inside(*row)) {
            for ((weight, number), greatest) in weights.iter_mut().zip(of_shares(row)).zip(greatest) {
                *weight += if greatest > 0.0 { number.abs() / greatest } else { 0.0 };
            }
        }
        let is_known = |row: usize| {
            of_shares(row).iter().zip(weights).all(|(number, weight)| *number == 0.0 || weight >= LEAST_WEIGHT)
        };
        let inside = |row: &usize| rows.held_out[*row] && is_inside(*row) && is_known(*row);
        let inside: Vec<usize> = (0..rows.count()).filter(inside).collect();
        if inside.len() < FEWEST_SAMPLES {
            return true;
        }
        let left = |row: usize, step: &DVector<f64>| {
            let (residual_n, derivatives) = rows.at(row).split_last().unwrap_or((&0.0, &[]));
            residual_n + derivatives.iter().zip(step.iter()).map(|(derivative, step)| derivative * step).sum::<f64>()
        };
        let squares = |step: &DVector<f64>| inside.iter().map(|row| left(*row, step).powi(2)).sum::<f64>();
        let (before, after) = (squares(&without), squares(&with));
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let noise = inside.len() as f64 * noise_n * noise_n;
        let excess = before - noise;
        if excess > LITTLE * noise {
            before - after >= LEAST_CLOSED_ELSEWHERE * excess
        } else {
            after - before <= LITTLE * noise
        }
    }

    /// Returns the table and the model beside it at their minimum: values, covariance, inflation, fitted parameters.
    pub fn finished(&self, bench: &Workbench<'_>, base: &Model) -> Option<(Values, DMatrix<f64>, f64, Vec<Parameter>)> {
        let layout = &self.layout;
        let mut model = base.clone();
        let mut changes = vec![0.0; SHARES];
        let of_shares = |rows: &Rows, changes: &[f64]| -> Option<Vec<f64>> {
            let learned = rows.normal(|row| !rows.held_out[row]);
            let step = learned.solved(rows.first_share, self.penalty, changes)?;
            let steps = step.iter().skip(rows.first_share);
            Some(changes.iter().zip(steps).map(|(change, step)| change + step).collect())
        };
        let mut rows = None;
        for _ in 0..ROUNDS {
            changes = of_shares(rows.as_ref().unwrap_or(&self.rows), &changes)?;
            model.values = layout.scaled(&model.values, &changes);
            changes = layout.changes_of(&model.values);
            let trial = bench.try_one(&model);
            model.values = trial.values;
            rows = Some(layout.rows(bench, &model, &model.values));
        }
        let rows = rows?;
        // A table that no robot file may have, such as a change of the friction where there is hardly any, is none.
        let is_allowed = |of: Parameter| (of.row().min..=of.row().max).contains(&model.values[of.place()]);
        if !Parameter::of(Effect::Empirical).all(is_allowed) {
            return None;
        }
        let learned = rows.normal(|row| !rows.held_out[row]);
        let inverse = inverse_of_normal(&learned.penalised(rows.first_share, self.penalty))?;
        // The covariance follows from the scatter of the blocks' scores.
        let free = learned.free();
        let mut scores = vec![DVector::<f64>::zeros(free); bench.blocks.len()];
        let mut squares = 0.0;
        for row in (0..rows.count()).filter(|row| !rows.held_out[*row]) {
            let Some((residual_n, derivatives)) = rows.at(row).split_last() else { continue };
            squares += residual_n * residual_n;
            if let Some(score) = scores.get_mut(rows.blocks[row]) {
                score.iter_mut().zip(derivatives).for_each(|(sum, derivative)| *sum += derivative * residual_n);
            }
        }
        let scatter = scores.iter().fold(DMatrix::zeros(free, free), |sum, score| sum + score * score.transpose());
        let mut covariance = &inverse * scatter * &inverse;
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let variance = squares / rows.held_out.iter().filter(|held_out| !**held_out).count().max(1) as f64;
        let inflation = (rows.first_share..free)
            .map(|place| covariance[(place, place)] / (variance * inverse[(place, place)]))
            .fold(1.0, f64::max);
        // Converts from newtons, or fractions of μ, to shares of the table.
        let size = model.values[if layout.changes == Changes::Force { SIZE } else { RATIO }];
        for place in rows.first_share..free {
            covariance.row_mut(place).unscale_mut(size);
            covariance.column_mut(place).unscale_mut(size);
        }
        let fitted = model.free.iter().copied().chain(shares()).collect();
        Some((model.values, covariance, inflation, fitted))
    }
}

/// Returns the lower, middle and upper third of some numbers, as non-empty ranges.
fn thirds(numbers: &[f64]) -> Vec<Range<f64>> {
    let mut sorted: Vec<f64> = numbers.iter().copied().filter(|number| number.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let edge = |part: usize| sorted.get(part * sorted.len() / 3).copied();
    let edges = [Some(f64::NEG_INFINITY), edge(1), edge(2), Some(f64::INFINITY)];
    let ranges = edges.windows(2).filter_map(|pair| Some(pair.first().copied()??..pair.get(1).copied()??));
    ranges.filter(|range| range.start < range.end).collect()
}
