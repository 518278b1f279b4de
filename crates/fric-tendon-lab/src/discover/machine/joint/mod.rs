//! A common cost for tensions and markers, and fits of any set of numbers to it.
//!
//! Each signal is scaled by its white noise together with the model's own error. Friction and the calibration lines are free in every fit within
//! their prior uncertainty: each hole's μ within a spread around the shared one, each line within its calibration error. So no candidate enters a set
//! for something that these can explain.

mod errors;
mod fit;

use std::sync::Arc;

pub use self::errors::StandardError;

use fric_lab::fit::Progress;
use fric_lab::statistics::white_noise_throughout;
use fric_tendon::file::{ManipulatorFile, OneOrEach, USUAL_SIGMA_N_PER_M};
use rayon::prelude::*;

use crate::discover::machine::candidate::Candidate;
use crate::identify::arc_error::arc_error_m;
use crate::identify::errors::MODEL_TENSION_RATIO;
use crate::identify::evaluation::{Evaluation, Row, Runs, State};
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

/// The run with all numbers that take part.
pub struct Joint<'a> {
    pub runs: Runs<'a>,
    /// Numbers of all candidates and of the friction. The lines follow, two numbers per grating.
    unknowns: Vec<Unknown>,
    line_count: usize,
    /// Error of the file's shapes at each residual, m; 0 at tensions.
    pub arc_error_m: Vec<f64>,
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

impl<'a> Joint<'a> {
    /// Prepares the cost. Returns `None` if nothing can be compared. There are no points once `progress` is stopped.
    pub fn new(file: &ManipulatorFile, run: &Run, candidates: &[Candidate], progress: &'a Progress) -> Option<Self> {
        let mut runs = Runs::new(file, std::slice::from_ref(run), Some(progress)).ok()?;
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
        let start = runs.start(&[]);
        let evaluation = runs.evaluate(&start, None)?;
        let of_shapes = arc_error_m(&evaluation);
        let rows = evaluation.runs.iter().flat_map(|run| &run.rows).zip(of_shapes.iter().flatten());
        let each = |(row, off_m): (&Row, &Vec<f64>)| {
            let zeros = std::iter::repeat_n(0.0, row.tension_n.len());
            zeros.chain(off_m.iter().copied().take(row.marker_m.len())).collect::<Vec<f64>>()
        };
        let arc_error_m = rows.flat_map(each).collect();
        Some(Self { runs, unknowns, line_count: start.lines.len(), arc_error_m })
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

    /// Returns the state of a point with another run of the same file and candidates.
    pub fn again(&self, other: &Point) -> Option<Point> {
        self.point(other.state.clone(), None)
    }

    /// Returns the time from which on all gratings are shifted, s.
    pub fn step_s(&self) -> Option<f64> {
        self.runs.given.gratings.as_ref()?.common_step_s
    }

    /// Sets this time.
    pub fn set_step_s(&mut self, step_s: Option<f64>) {
        if let Some(gratings) = &mut self.runs.given.gratings {
            gratings.common_step_s = step_s;
        }
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
        let model_m = self.runs.model_marker_m;
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
}

/// Returns a column in units of the noise; gaps are 0.
fn weighted(column: &[f64], weights: &[f64]) -> Vec<f64> {
    let one = |(value, weight): (&f64, &f64)| if *weight > 0.0 && value.is_finite() { value * weight } else { 0.0 };
    column.iter().zip(weights).map(one).collect()
}
