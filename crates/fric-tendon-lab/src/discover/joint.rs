//! A common cost for tensions and markers, and fits of any set of numbers to it.
//!
//! Each signal is scaled by its white noise together with the model's own error. Friction and the calibration lines are free in every fit within
//! their prior uncertainty: each hole's μ within a spread around the shared one, each line within its calibration error. So no candidate enters a set
//! for something that these can explain.

use std::sync::Arc;

use fric_lab::statistics::{Scores, inverse_of_normal, white_noise_throughout};
use fric_tendon::file::{ManipulatorFile, OneOrEach, USUAL_SIGMA_N_PER_M};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::candidate::Candidate;
use crate::identify::errors::{MODEL_MARKER_RATIO, MODEL_TENSION_RATIO};
use crate::identify::evaluation::{Evaluation, Runs, State};
use crate::identify::unknown::Unknown;
use crate::run::Run;

/// Start value of μ if the file has no friction.
const START_MU: f64 = 0.15;
/// Standard deviation of the logarithm of a hole's μ around the shared one: that of a uniform spread of ±10 %.
const HOLE_SPREAD: f64 = 0.06;
/// The same for numbers that are nearly free: shared μ and σ, and an individual hole.
const LOOSE: f64 = 1.0;
/// Prior of a wrong calibration line, in standard errors of the calibration.
const LOOSE_LINE: f64 = 1000.0;
/// Prior standard deviation of a free number, as a multiple of its widest interval. It is no bound, but keeps the normal equations regular.
const WIDE: f64 = 20.0;

const MOST_STEPS: usize = 8;
const MOST_HALVINGS: i32 = 5;
/// A step that decreases the cost by less than this is the last one.
const SETTLED: f64 = 0.05;

/// The run with all numbers that take part.
pub struct Joint {
    pub runs: Runs,
    /// Numbers of all candidates and of the friction. The lines follow, two numbers per grating.
    unknowns: Vec<Unknown>,
    line_count: usize,
    pub length_m: f64,
}

/// Scales of the signals.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    pub tension_n: f64,
    pub marker_m: f64,
}

/// A state with its residual.
#[derive(Clone)]
pub struct Point {
    pub state: State,
    evaluation: Arc<Evaluation>,
    /// Residual tensions and markers of each sample, N and m; NaN if there is none.
    left: Vec<f64>,
}

/// The free numbers and their prior standard deviations.
#[derive(Clone, Debug)]
pub struct Set {
    active: Vec<usize>,
    precision: Vec<f64>,
}

/// Derivatives of the residual with respect to all numbers.
#[derive(Clone)]
pub struct Jacobian(Vec<Vec<f64>>);

/// Standard errors of a free number: with all contributions, and with white noise alone.
#[derive(Clone, Copy, Debug)]
pub struct StandardError {
    pub place: usize,
    pub whole: f64,
    pub white: f64,
}

/// Sums of squares by signal, m² and N², and their numbers of terms.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sums {
    pub tension_n2: f64,
    pub marker_m2: f64,
    pub tension_count: f64,
    pub marker_count: f64,
}

impl Jacobian {
    /// Replaces the slopes of one number.
    pub fn replace(&mut self, place: usize, slope: Vec<f64>) {
        self.0[place] = slope;
    }
}

impl Joint {
    /// Prepares the cost. Returns `None` if nothing can be compared.
    pub fn new(file: &ManipulatorFile, run: &Run, candidates: &[Candidate]) -> Option<Self> {
        let mut runs = Runs::new(file, std::slice::from_ref(run)).ok()?;
        let tendon = &mut runs.given.tendon;
        if tendon.mu.as_slice().iter().all(|mu| *mu == 0.0) {
            tendon.mu = OneOrEach::One(START_MU);
        }
        if tendon.sigma_n_per_m.is_none() {
            tendon.sigma_n_per_m = Some(OneOrEach::One(USUAL_SIGMA_N_PER_M));
        }
        let count = runs.given.disk_count;
        let mut unknowns = vec![Unknown::SharedMu];
        unknowns.extend((0..count).map(Unknown::HoleMu));
        unknowns.extend(Some(Unknown::Sigma).filter(|sigma| sigma.is_possible(&runs.given)));
        for unknown in candidates.iter().flat_map(|candidate| candidate.frees(&runs.given)) {
            if !unknowns.contains(&unknown) {
                unknowns.push(unknown);
            }
        }
        let length_m = runs.given.length_m();
        let line_count = runs.start(&[]).lines.len();
        Some(Self { runs, unknowns, line_count, length_m })
    }

    /// Returns the state of the file as it is.
    pub fn start(&self) -> Option<Point> {
        self.point(self.runs.start(&self.unknowns), None)
    }

    /// Returns the state of the file with one number changed by a distance.
    pub fn at(&self, unknown: Unknown, distance: f64) -> Option<Point> {
        let start = self.runs.start(&self.unknowns);
        self.point(self.moved(&start, self.place(unknown)?, distance), None)
    }

    fn point(&self, state: State, near: Option<&Point>) -> Option<Point> {
        let evaluation = self.runs.evaluate(&state, near.map(|near| &*near.evaluation))?;
        let rows = evaluation.runs.iter().flat_map(|run| &run.rows);
        let left = rows.flat_map(|row| row.tension_n.iter().chain(&row.marker_m)).copied().collect();
        Some(Point { state, evaluation: Arc::new(evaluation), left })
    }

    /// Returns the scales from the white noise of a point.
    pub fn units(&self, point: &Point) -> Units {
        let noise = |is_marker: bool| {
            let mut series = Vec::new();
            for run in &point.evaluation.runs {
                let of = |row: usize, place: usize| {
                    let row = run.rows.get(row)?;
                    if is_marker { row.marker_m.get(place) } else { row.tension_n.get(place) }.copied()
                };
                let width =
                    run.rows.first().map_or(0, |row| if is_marker { row.marker_m.len() } else { row.tension_n.len() });
                for place in 0..width {
                    series.extend((0..run.rows.len()).filter_map(|row| of(row, place)).filter(|one| one.is_finite()));
                    series.push(f64::NAN);
                }
            }
            white_noise_throughout(&series)
        };
        let model_n = MODEL_TENSION_RATIO * self.runs.greatest_tension_n;
        let model_m = MODEL_MARKER_RATIO * self.length_m;
        Units {
            tension_n: noise(false).unwrap_or(model_n).hypot(model_n),
            marker_m: noise(true).unwrap_or(model_m).hypot(model_m),
        }
    }

    /// Returns the numbers that are free in every fit, with their priors.
    pub fn common(&self) -> Set {
        let mut set = Set { active: Vec::new(), precision: Vec::new() };
        for (place, unknown) in self.unknowns.iter().enumerate() {
            let deviation = match unknown {
                Unknown::SharedMu | Unknown::Sigma => LOOSE,
                Unknown::HoleMu(_) => HOLE_SPREAD,
                _ => continue,
            };
            set.active.push(place);
            set.precision.push(deviation.powi(-2));
        }
        for place in 0..2 * self.line_count {
            set.active.push(self.unknowns.len() + place);
            set.precision.push(1.0);
        }
        set
    }

    /// Returns a set extended by a candidate.
    pub fn with(&self, set: &Set, candidate: Candidate) -> Set {
        let mut set = set.clone();
        for unknown in candidate.frees(&self.runs.given) {
            if let Some(place) = self.place(unknown).filter(|place| !set.active.contains(place)) {
                let widest = WIDE * unknown.widest(&self.runs.given, self.runs.greatest_tension_n);
                set.active.push(place);
                set.precision.push(widest.powi(-2));
            }
        }
        let count = self.runs.given.disk_count;
        let loose: Vec<(usize, f64)> = match candidate {
            Candidate::Hole(hole) => {
                self.place(Unknown::HoleMu(hole)).into_iter().map(|place| (place, LOOSE)).collect()
            }
            Candidate::AllHoles => {
                (0..count).filter_map(|hole| Some((self.place(Unknown::HoleMu(hole))?, LOOSE))).collect()
            }
            Candidate::Line(grating) => [0, 1].map(|part| (self.line(grating, part), LOOSE_LINE)).to_vec(),
            Candidate::AllLines => {
                (0..self.line_count).flat_map(|g| [0, 1].map(|part| (self.line(g, part), LOOSE_LINE))).collect()
            }
            _ => Vec::new(),
        };
        for (place, deviation) in loose {
            if let Some(at) = set.active.iter().position(|active| *active == place) {
                set.precision[at] = deviation.powi(-2);
            }
        }
        set
    }

    /// Returns how many numbers a candidate adds.
    pub fn numbers(&self, candidate: Candidate) -> f64 {
        let count = match candidate {
            Candidate::Hole(_) => 1,
            Candidate::AllHoles => self.runs.given.disk_count,
            // The time of the step counts as a number too.
            Candidate::Line(_) | Candidate::Temperature => 2,
            Candidate::AllLines => 2 * self.line_count,
            _ => candidate.frees(&self.runs.given).len(),
        };
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let count = count as f64;
        count
    }

    pub fn place(&self, unknown: Unknown) -> Option<usize> {
        self.unknowns.iter().position(|one| *one == unknown)
    }

    fn line(&self, grating: usize, part: usize) -> usize {
        self.unknowns.len() + 2 * grating + part
    }

    fn distance(&self, state: &State, place: usize) -> f64 {
        match place.checked_sub(self.unknowns.len()) {
            None => state.unknowns.get(place).map_or(0.0, |(_, distance)| *distance),
            Some(line) => state.lines.as_flattened().get(line).copied().unwrap_or(0.0),
        }
    }

    fn moved(&self, state: &State, place: usize, change: f64) -> State {
        let mut state = state.clone();
        match place.checked_sub(self.unknowns.len()) {
            None => state.unknowns[place].1 += change,
            Some(line) => state.lines.as_flattened_mut()[line] += change,
        }
        state
    }

    /// Returns the distance of a number from the value in the file.
    pub fn found(&self, point: &Point, unknown: Unknown) -> f64 {
        self.place(unknown).map_or(0.0, |place| self.distance(&point.state, place))
    }

    /// Returns the derivatives of the residual with respect to one number.
    pub fn slope(&self, point: &Point, place: usize) -> Option<Vec<f64>> {
        let change = match self.unknowns.get(place) {
            Some(unknown) => unknown.small(&self.runs.given, self.runs.greatest_tension_n),
            None => 1.0,
        };
        let moved = self.point(self.moved(&point.state, place, change), Some(point))?;
        Some(moved.left.iter().zip(&point.left).map(|(moved, now)| (moved - now) / change).collect())
    }

    /// Returns the derivatives at a point.
    pub fn jacobian(&self, point: &Point) -> Option<Jacobian> {
        let all = 0..self.unknowns.len() + 2 * self.line_count;
        all.into_par_iter().map(|place| self.slope(point, place)).collect::<Option<_>>().map(Jacobian)
    }

    fn widths(&self) -> (usize, usize) {
        let tension_width = if self.line_count > 0 { self.runs.given.disk_count } else { 0 };
        let marker_width = if self.runs.has_markers() { 2 * self.runs.given.disk_count } else { 0 };
        (tension_width, marker_width)
    }

    /// Returns the inverse scale at each index; 0 at gaps.
    fn weights(&self, point: &Point, units: Units) -> Vec<f64> {
        let (tension_width, marker_width) = self.widths();
        let weight = |(place, left): (usize, &f64)| {
            let is_tension = place % (tension_width + marker_width).max(1) < tension_width;
            if left.is_finite() { if is_tension { units.tension_n } else { units.marker_m }.recip() } else { 0.0 }
        };
        point.left.iter().enumerate().map(weight).collect()
    }

    /// Returns the sums by signal.
    pub fn sums(&self, point: &Point) -> Sums {
        let (tension_width, marker_width) = self.widths();
        let mut sums = Sums::default();
        for (place, left) in point.left.iter().enumerate().filter(|(_, left)| left.is_finite()) {
            if place % (tension_width + marker_width).max(1) < tension_width {
                sums.tension_n2 += left * left;
                sums.tension_count += 1.0;
            } else {
                sums.marker_m2 += left * left;
                sums.marker_count += 1.0;
            }
        }
        sums
    }

    /// Returns χ² including the priors of the free numbers.
    pub fn cost(&self, point: &Point, set: &Set, units: Units) -> f64 {
        let sums = self.sums(point);
        let known = set
            .active
            .iter()
            .zip(&set.precision)
            .map(|(place, precision)| precision * self.distance(&point.state, *place).powi(2));
        sums.tension_n2 / units.tension_n.powi(2) + sums.marker_m2 / units.marker_m.powi(2) + known.sum::<f64>()
    }

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
    fn gram_of(&self, point: &Point, jacobian: &Jacobian, set: &Set, units: Units) -> (DMatrix<f64>, DVector<f64>) {
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

    /// Returns the standard error of each free number of a set at its minimum, by index. Noise of a grating moves all disks beyond it, and residuals
    /// are correlated, so the scatter of the scores of whole samples and of blocks counts where it exceeds that of white noise. The error of the
    /// model itself is added.
    pub fn errors(&self, point: &Point, set: &Set, jacobian: &Jacobian) -> Option<Vec<StandardError>> {
        let sums = self.sums(point);
        let rms = |square: f64, count: f64, unit: f64| {
            if count > 0.0 && square > 0.0 { (square / count).sqrt() } else { unit }
        };
        let given = self.units(point);
        let units = Units {
            tension_n: rms(sums.tension_n2, sums.tension_count, given.tension_n),
            marker_m: rms(sums.marker_m2, sums.marker_count, given.marker_m),
        };
        let count = set.active.len();
        let weights = self.weights(point, units);
        let columns: Vec<Vec<f64>> = set.active.iter().map(|place| weighted(&jacobian.0[*place], &weights)).collect();
        let left = weighted(&point.left, &weights);
        let (tension_width, marker_width) = self.widths();
        let width = (tension_width + marker_width).max(1);
        let mut matrices = [DMatrix::zeros(count, count), DMatrix::zeros(count, count)];
        let mut scores = Scores::new(count);
        for sample in 0..left.len() / width {
            let mut score = vec![0.0; count];
            for place in sample * width..(sample + 1) * width {
                let numbers = DVector::from_iterator(count, columns.iter().map(|column| column[place]));
                let signal = usize::from(place % width >= tension_width);
                matrices[signal].syger(1.0, &numbers, &numbers, 1.0);
                score.iter_mut().zip(numbers.iter()).for_each(|(score, slope)| *score += slope * left[place]);
            }
            scores.add(&score);
        }
        for matrix in &mut matrices {
            matrix.fill_upper_triangle_with_lower_triangle();
        }
        let known = DMatrix::from_diagonal(&DVector::from_column_slice(&set.precision));
        let inverse = inverse_of_normal(&(&matrices[0] + &matrices[1] + &known))?;
        let off = [
            (sums.tension_count, MODEL_TENSION_RATIO * self.runs.greatest_tension_n / units.tension_n),
            (sums.marker_count, MODEL_MARKER_RATIO * self.length_m / units.marker_m),
        ];
        let mut systematic = DMatrix::zeros(count, count);
        for (matrix, (count, off)) in matrices.iter().zip(off) {
            systematic += matrix * (count * (0.5 * off).powi(2));
        }
        let systematic = &inverse * systematic * &inverse;
        let in_blocks = scores.covariance(&inverse) + &inverse * known * &inverse;
        let error = |(at, place): (usize, &usize)| {
            let ratio: f64 = in_blocks[(at, at)] / inverse[(at, at)];
            let factor = if ratio.is_finite() { ratio.max(1.0) } else { 1.0 };
            let whole = (factor * inverse[(at, at)] + systematic[(at, at)]).max(0.0).sqrt();
            StandardError { place: *place, whole, white: inverse[(at, at)].max(0.0).sqrt() }
        };
        Some(set.active.iter().enumerate().map(error).collect())
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

/// Returns a column in units of the noise; gaps are 0.
fn weighted(column: &[f64], weights: &[f64]) -> Vec<f64> {
    let one = |(value, weight): (&f64, &f64)| if *weight > 0.0 && value.is_finite() { value * weight } else { 0.0 };
    column.iter().zip(weights).map(one).collect()
}
