//! Fits the unknowns by least squares: Gauss–Newton with slopes by finite differences, together with the errors of the calibration lines.
//!
//! Each signal is scaled: first by its white noise, then by the root mean square of its residual after the fit, until that changes no more, so that a
//! signal that the model describes less well has less weight. The end is a stationary point of the likelihood with two unknown noises. The errors of the lines have the prior 0 ± 1 standard error.

use fric_lab::statistics::{Scores, inverse_of_normal, white_noise_throughout};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::evaluation::{Evaluation, Row, Runs, State};
use super::unknown::Unknown;

/// Maximum number of steps of one search.
const MOST_STEPS: usize = 12;
/// Maximum number of halvings of a step.
const MOST_HALVINGS: i32 = 8;
/// A step that would decrease χ² by less is not taken: no unknown would move by a tenth of its error.
const SETTLED: f64 = 0.01;
/// Maximum number of times that the scales are updated.
const MOST_ROUNDS: usize = 20;
/// Relative change of a scale below which it has settled; weights change by about twice that.
const SAME_UNIT: f64 = 0.01;

/// Scale of each signal.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    pub tension_n: f64,
    pub marker_m: f64,
}

impl Units {
    fn is_near(&self, other: &Self) -> bool {
        let is_near = |one: f64, other: f64| (one / other - 1.0).abs() < SAME_UNIT;
        is_near(self.tension_n, other.tension_n) && is_near(self.marker_m, other.marker_m)
    }
}

/// The end of a search.
pub struct Solution {
    pub state: State,
    pub evaluation: Evaluation,
    pub units: Units,
    /// Derivatives of the residuals at the end, in the order of the unknowns, then of the lines' constants and slopes.
    slopes: Vec<Slopes>,
}

/// Derivatives of all residuals with respect to one number: run, sample, tensions before markers.
type Slopes = Vec<Vec<Vec<f64>>>;

/// The normal equations in scaled units.
pub struct Normal {
    /// Contributions of tensions and of markers.
    pub matrices: [DMatrix<f64>; 2],
    pub counts: [f64; 2],
    pub gradient: DVector<f64>,
    pub inverse: DMatrix<f64>,
    pub scores: Scores,
}

/// Searches from a start.
pub fn solve(runs: &Runs, start: State) -> Option<Solution> {
    let mut evaluation = runs.evaluate(&start, None)?;
    let mut units = white(&evaluation);
    let mut state = start;
    let of_lines = line_slopes(runs, &state, &evaluation)?;
    let mut slopes = Vec::new();
    for _ in 0..MOST_ROUNDS {
        let mut cost = squares(&evaluation, &state, units);
        for _ in 0..MOST_STEPS {
            slopes = unknown_slopes(runs, &state, &evaluation)?;
            slopes.extend(of_lines.iter().cloned());
            let normal = normal(&evaluation, &state, &slopes, units)?;
            let step = -(&normal.inverse * &normal.gradient);
            if -step.dot(&normal.gradient) < SETTLED {
                break;
            }
            let trial = |share: f64| {
                let moved = moved(&state, &step, share);
                let trial = runs.evaluate(&moved, Some(&evaluation))?;
                let trial_cost = squares(&trial, &moved, units);
                // A sample without a shape has no residual, which is no gain.
                (trial_cost < cost && has_shapes_of(&trial, &evaluation)).then_some((moved, trial, trial_cost))
            };
            let Some((next, trial, next_cost)) = (0..MOST_HALVINGS).find_map(|halving| trial(0.5_f64.powi(halving)))
            else {
                break;
            };
            let is_settled = cost - next_cost < SETTLED;
            (state, evaluation, cost) = (next, trial, next_cost);
            if is_settled {
                break;
            }
        }
        let last = units;
        units = left(&evaluation, last);
        if units.is_near(&last) {
            break;
        }
    }
    Some(Solution { state, evaluation, units, slopes })
}

impl Solution {
    /// Returns the normal equations at the end. `more` holds the slopes of further numbers, which come before the lines.
    pub fn normal(&self, more: &[Slopes]) -> Option<Normal> {
        let count = self.state.unknowns.len();
        let (own, lines) = self.slopes.split_at_checked(count)?;
        let slopes: Vec<Slopes> = own.iter().chain(more).chain(lines).cloned().collect();
        normal(&self.evaluation, &self.state, &slopes, self.units)
    }

    /// Returns `Jᵀb` in scaled units, for errors b of the markers: run by run and sample by sample, m.
    pub fn pull_of_markers(&self, off_m: &[Vec<Vec<f64>>]) -> DVector<f64> {
        let mut pull = DVector::zeros(self.slopes.len());
        each_row(&self.evaluation, |row, run, sample| {
            let off_m = off_m.get(run).and_then(|all| all.get(sample));
            for (place, off_m) in off_m.into_iter().flatten().enumerate() {
                let by = |slopes: &Slopes| slopes.get(run)?.get(sample)?.get(row.tension_n.len() + place).copied();
                let numbers = DVector::from_iterator(
                    self.slopes.len(),
                    self.slopes.iter().map(|one| by(one).unwrap_or(f64::NAN) / self.units.marker_m),
                );
                let is_compared = row.marker_m.get(place).is_some_and(|left_m| left_m.is_finite());
                if is_compared && numbers.iter().all(|one| one.is_finite()) {
                    pull += numbers * (off_m / self.units.marker_m);
                }
            }
        });
        pull
    }

    /// Returns the slopes with respect to other unknowns.
    pub fn slopes_by(&self, runs: &Runs, unknowns: &[Unknown]) -> Option<Vec<Slopes>> {
        let mut state = self.state.clone();
        let own = state.unknowns.len();
        state.unknowns.extend(unknowns.iter().map(|unknown| (*unknown, 0.0)));
        let all =
            (own..state.unknowns.len()).into_par_iter().map(|place| slope_by(runs, &state, &self.evaluation, place));
        all.collect()
    }
}

/// Returns the state moved by a fraction of a step.
fn moved(state: &State, step: &DVector<f64>, share: f64) -> State {
    let mut moved = state.clone();
    let distances = moved.unknowns.iter_mut().map(|(_, distance)| distance);
    for (value, change) in distances.chain(moved.lines.as_flattened_mut()).zip(step.iter()) {
        *value += share * change;
    }
    moved
}

fn unknown_slopes(runs: &Runs, state: &State, now: &Evaluation) -> Option<Vec<Slopes>> {
    (0..state.unknowns.len()).into_par_iter().map(|place| slope_by(runs, state, now, place)).collect()
}

fn slope_by(runs: &Runs, state: &State, now: &Evaluation, place: usize) -> Option<Slopes> {
    let (unknown, distance) = *state.unknowns.get(place)?;
    let small = unknown.small(&runs.given, runs.greatest_tension_n);
    let mut moved = state.clone();
    moved.unknowns[place].1 = distance + small;
    Some(difference(&runs.evaluate(&moved, Some(now))?, now, small))
}

/// Returns the slopes per standard error of each line's constant and slope; empty if the lines are known.
fn line_slopes(runs: &Runs, state: &State, now: &Evaluation) -> Option<Vec<Slopes>> {
    let slope = |place: usize| {
        let mut moved = state.clone();
        moved.lines.as_flattened_mut()[place] += 1.0;
        Some(difference(&runs.evaluate(&moved, Some(now))?, now, 1.0))
    };
    (0..2 * state.lines.len()).into_par_iter().map(slope).collect()
}

fn difference(moved: &Evaluation, now: &Evaluation, change: f64) -> Slopes {
    let runs = moved.runs.iter().zip(&now.runs);
    runs.map(|(moved, now)| {
        let rows = moved.rows.iter().zip(&now.rows);
        rows.map(|(moved, now)| {
            let values = |row: &Row| row.tension_n.iter().chain(&row.marker_m).copied().collect::<Vec<f64>>();
            values(moved).iter().zip(values(now)).map(|(moved, now)| (moved - now) / change).collect()
        })
        .collect()
    })
    .collect()
}

/// Returns the scales from the white noise of the signals.
fn white(evaluation: &Evaluation) -> Units {
    let noise = |of: fn(&Row) -> &Vec<f64>| {
        let mut series = Vec::new();
        for run in &evaluation.runs {
            let width = run.rows.iter().map(|row| of(row).len()).max().unwrap_or(0);
            for place in 0..width {
                series.extend(run.rows.iter().filter_map(|row| of(row).get(place)).filter(|one| one.is_finite()));
                series.push(f64::NAN);
            }
        }
        white_noise_throughout(&series).filter(|noise| *noise > 0.0)
    };
    Units {
        tension_n: noise(|row| &row.tension_n).unwrap_or(0.005),
        marker_m: noise(|row| &row.marker_m).unwrap_or(0.0005),
    }
}

/// Returns the scales from the residual.
fn left(evaluation: &Evaluation, units: Units) -> Units {
    let (mut squares, mut counts) = ([0.0; 2], [0.0; 2]);
    each_row(evaluation, |row, _, _| {
        for (signal, values) in [&row.tension_n, &row.marker_m].into_iter().enumerate() {
            for value in values.iter().filter(|value| value.is_finite()) {
                squares[signal] += value * value;
                counts[signal] += 1.0;
            }
        }
    });
    let rms = |signal: usize, else_unit: f64| {
        let rms: f64 = (squares[signal] / f64::max(counts[signal], 1.0)).sqrt();
        if rms > 0.0 { rms } else { else_unit }
    };
    Units { tension_n: rms(0, units.tension_n), marker_m: rms(1, units.marker_m) }
}

/// Calls `each` with every row, its run and its sample.
fn each_row(evaluation: &Evaluation, mut each: impl FnMut(&Row, usize, usize)) {
    for (run, of_run) in evaluation.runs.iter().enumerate() {
        for (sample, row) in of_run.rows.iter().enumerate() {
            each(row, run, sample);
        }
    }
}

/// Whether one prediction has a residual wherever another has.
fn has_shapes_of(one: &Evaluation, other: &Evaluation) -> bool {
    values_of(one).zip(values_of(other)).all(|(one, other)| one.is_finite() || !other.is_finite())
}

/// Returns all residuals.
fn values_of(evaluation: &Evaluation) -> impl Iterator<Item = f64> {
    let rows = evaluation.runs.iter().flat_map(|run| &run.rows);
    rows.flat_map(|row| row.tension_n.iter().chain(&row.marker_m)).copied()
}

/// Returns χ² of a state.
fn squares(evaluation: &Evaluation, state: &State, units: Units) -> f64 {
    let mut sum: f64 = state.lines.as_flattened().iter().map(|one| one * one).sum();
    each_row(evaluation, |row, _, _| {
        let whole = row.tension_n.iter().map(|one| one / units.tension_n);
        let whole = whole.chain(row.marker_m.iter().map(|one| one / units.marker_m));
        sum += whole.filter(|one| one.is_finite()).map(|one| one * one).sum::<f64>();
    });
    sum
}

fn normal(evaluation: &Evaluation, state: &State, slopes: &[Slopes], units: Units) -> Option<Normal> {
    let count = slopes.len();
    let first_line = count - 2 * state.lines.len();
    let mut matrices = [DMatrix::zeros(count, count), DMatrix::zeros(count, count)];
    let mut counts = [0.0; 2];
    let mut gradient = DVector::zeros(count);
    let mut scores = Scores::new(count);
    each_row(evaluation, |row, run, sample| {
        let mut score = vec![0.0; count];
        let tensions = row.tension_n.len();
        for (place, value) in row.tension_n.iter().chain(&row.marker_m).enumerate() {
            let (signal, unit) = if place < tensions { (0, units.tension_n) } else { (1, units.marker_m) };
            let by = |slopes: &Slopes| slopes.get(run).and_then(|all| all.get(sample)?.get(place)).copied();
            let numbers = DVector::from_iterator(count, slopes.iter().map(|one| by(one).unwrap_or(f64::NAN) / unit));
            let value = value / unit;
            if value.is_finite() && numbers.iter().all(|one| one.is_finite()) {
                matrices[signal].syger(1.0, &numbers, &numbers, 1.0);
                counts[signal] += 1.0;
                score.iter_mut().zip(numbers.iter()).for_each(|(score, slope)| *score += slope * value);
            }
        }
        gradient += DVector::from_column_slice(&score);
        scores.add(&score);
    });
    for matrix in &mut matrices {
        matrix.fill_upper_triangle_with_lower_triangle();
    }
    let mut whole = &matrices[0] + &matrices[1];
    for (line, off) in state.lines.as_flattened().iter().enumerate() {
        whole[(first_line + line, first_line + line)] += 1.0;
        gradient[first_line + line] += off;
    }
    let inverse = inverse_of_normal(&whole)?;
    Some(Normal { matrices, counts, gradient, inverse, scores })
}
