//! Signals of the other cables that correlate with an unexplained residual. Disturbances of a sensor often couple in from a neighbour.
//!
//! The part of each signal that the cable's own force and speed explain is removed first, because all cables of a platform act together.

use nalgebra::{Matrix3, Vector3};

use crate::discover::Task;
use crate::fit::{CableRecord, Row, StoreError};
use crate::samples::split::{Block, split};

/// Minimum correlation to report.
const LEAST_CORRELATION: f64 = 0.3;
/// Minimum correlation in standard errors, by the scatter of the blocks.
const LEAST_SIGNIFICANCE: f64 = 4.0;

/// A signal of another cable that correlates with a residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Index of the cable.
    pub cable: usize,
    /// The signal.
    pub signal: &'static str,
    /// Correlation with the residual, after removing from both what the cable's own force and speed explain.
    pub correlation: f64,
}

/// Returns the signals that correlate with the residual of the cable of a task, N in each cycle, the strongest first.
///
/// # Errors
/// Returns the [`StoreError`] of a log that does not fit into memory.
pub fn neighbours_of(residual_n: &[f64], task: &Task<'_>) -> Result<Vec<Neighbour>, StoreError> {
    let (blocks, own_columns) = (split(task.record), columns(task.record));
    let mut neighbours = Vec::new();
    let cable_count = task.all.samples.robot().cables().len();
    for cable in (0..cable_count).filter(|cable| *cable != task.own) {
        let columns = |records: &[CableRecord<'_>]| records.first().map(columns);
        let Some(columns) = task.all.with(cable..cable + 1, columns)? else { continue };
        for (signal, column) in ["sensor_force", "speed"].into_iter().zip(columns) {
            let correlation = correlation(residual_n, &own_columns, &column, &blocks);
            neighbours.extend(correlation.map(|correlation| Neighbour { cable, signal, correlation }));
        }
    }
    neighbours.sort_by(|one, other| other.correlation.abs().total_cmp(&one.correlation.abs()));
    Ok(neighbours)
}

/// Returns sensor force and speed of a cable in each cycle.
fn columns(record: &CableRecord<'_>) -> [Vec<f64>; 2] {
    let of = |row: &Row| [row.signals.sensor_force_n, row.signals.speed_m_per_s];
    [0, 1].map(|signal| record.rows.iter().map(|row| of(row)[signal]).collect())
}

/// Returns the correlation of a residual with a signal, after removing from both what a constant and the cable's own two signals explain. Returns
/// `None` if it is small or may be chance.
fn correlation(residual: &[f64], own: &[Vec<f64>; 2], other: &[f64], blocks: &[Block]) -> Option<f64> {
    let regressors = |cycle: usize| {
        let value = |column: &[f64]| column.get(cycle).copied().unwrap_or(f64::NAN);
        let row = Vector3::new(1.0, value(&own[0]), value(&own[1]));
        (row, value(residual), value(other))
    };
    let samples = || {
        let of_block = |(place, block): (usize, &Block)| block.cycles.clone().map(move |cycle| (place, cycle));
        let all = blocks.iter().enumerate().flat_map(of_block);
        let rows = all.map(|(place, cycle)| (place, regressors(cycle)));
        rows.filter(|(_, (row, residual, other))| row.sum().is_finite() && residual.is_finite() && other.is_finite())
    };
    let (mut matrix, mut of_residual, mut of_other) = (Matrix3::zeros(), Vector3::zeros(), Vector3::zeros());
    for (_, (row, residual, other)) in samples() {
        matrix += row * row.transpose();
        of_residual += row * residual;
        of_other += row * other;
    }
    let factor = matrix.cholesky()?;
    let (of_residual, of_other) = (factor.solve(&of_residual), factor.solve(&of_other));
    let mut products = vec![0.0; blocks.len()];
    let (mut residual_squares, mut other_squares) = (0.0, 0.0);
    for (place, (row, residual, other)) in samples() {
        let (residual, other) = (residual - row.dot(&of_residual), other - row.dot(&of_other));
        residual_squares += residual * residual;
        other_squares += other * other;
        if let Some(product) = products.get_mut(place) {
            *product += residual * other;
        }
    }
    let sum: f64 = products.iter().sum();
    let error = products.iter().map(|product| product * product).sum::<f64>().sqrt();
    let correlation = sum / (residual_squares * other_squares).sqrt();
    (sum.abs() > LEAST_SIGNIFICANCE * error && correlation.abs() > LEAST_CORRELATION).then_some(correlation)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The residual is half of another cable's signal plus equal noise of its own; the signals of both cables contain a common wave.
    #[test]
    fn finds_what_comes_from_next_door_and_not_what_all_cables_have() {
        let wave = |cycle: i32, period: f64| (f64::from(cycle) / period).sin();
        let own = [(10.0, 700.0), (0.0, 331.0)]
            .map(|(level, period)| (0..24_000).map(|cycle| level + wave(cycle, period)).collect());
        let other: Vec<f64> = (0..24_000).map(|cycle| wave(cycle, 700.0) + wave(cycle, 17.0)).collect();
        let common: Vec<f64> = (0..24_000).map(|cycle| wave(cycle, 700.0)).collect();
        let blocks: Vec<Block> =
            (0..48).map(|place| Block { cycles: place * 500..(place + 1) * 500, held_out: place % 2 == 0 }).collect();
        let residual: Vec<f64> = (0..24_000).map(|cycle| 0.5 * wave(cycle, 17.0) + 0.5 * wave(cycle, 23.0)).collect();
        let found = correlation(&residual, &own, &other, &blocks).unwrap();
        assert!((found - 0.5_f64.sqrt()).abs() < 0.01, "{found}");
        assert_eq!(correlation(&common, &own, &residual, &blocks), None);
        let strange: Vec<f64> = (0..24_000).map(|cycle| wave(cycle, 29.0)).collect();
        assert_eq!(correlation(&residual, &own, &strange, &blocks), None);
    }
}
