//! The prediction of a manipulator file for runs, and the residual of the measurements.
//!
//! Two signals are compared. If there are gratings, the tension in each segment is compared with the model's, computed from the history of the
//! tension at the base. The markers are compared with the disks of the shape under the measured tensions, which does not depend on the friction;
//! without gratings, under the model's own tensions.

use fric_lab::fit::Progress;
use fric_tendon::ManipulatorParams;
use fric_tendon::Tendon;
use fric_tendon::file::{ManipulatorFile, ManipulatorTables, OneOrEach};

use super::super::discover::thinned;
use super::super::error::ContinuumError;
use super::super::fbg::{Calibration, LineError, Tension};
use super::super::gratings::{GratingSample, Gratings};
use super::super::measuring::{corrected, moved_m};
use super::super::run::{Run, RunSample};
use super::super::shape_errors::{ComputedShape, Way, shapes};
use super::errors::model_marker_m;
use super::unknown::Unknown;

/// Runs to compare with, and the file at which the search starts.
pub struct Runs<'a> {
    pub given: ManipulatorTables,
    all: Vec<One>,
    has_gratings: bool,
    pub greatest_tension_n: f64,
    /// Root mean square error of the model's disks, m.
    pub model_marker_m: f64,
    /// Ends the work if it is stopped; `None` where it is short.
    progress: Option<&'a Progress>,
}

/// One run.
struct One {
    whole: Run,
    /// Samples to compare.
    kept: Vec<usize>,
    /// Whether each grating is dead in them.
    is_dead: Vec<Vec<bool>>,
}

/// Distances from the file, and the errors of the calibration lines, in standard errors of their constants and slopes.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub unknowns: Vec<(Unknown, f64)>,
    pub lines: Vec<[f64; 2]>,
}

impl State {
    /// Returns the time by which the markers are late, s.
    fn marker_lag_s(&self) -> f64 {
        self.unknowns.iter().find(|(unknown, _)| *unknown == Unknown::MarkerLag).map_or(0.0, |(_, lag_s)| *lag_s)
    }

    /// Returns the tables of a state.
    pub fn tables(&self, given: &ManipulatorTables) -> ManipulatorTables {
        let mut tables = given.clone();
        for (unknown, distance) in &self.unknowns {
            unknown.put(&mut tables, *distance);
        }
        tables
    }
}

/// A state with its prediction.
pub struct Evaluation {
    pub runs: Vec<RunEvaluation>,
}

/// The prediction for one run.
pub struct RunEvaluation {
    history: Option<Computed>,
    measured: Option<Computed>,
    /// Residuals, sample by sample.
    pub rows: Vec<Row>,
}

impl RunEvaluation {
    /// Returns the shapes that the markers are compared with, and their manipulator.
    pub fn shown(&self) -> Option<(&ManipulatorParams, &[ComputedShape])> {
        self.measured.as_ref().or(self.history.as_ref()).map(|one| (&one.params, one.shapes.as_slice()))
    }
}

/// The residual of one sample; NaN where nothing was measured or there is no shape.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// Gratings minus model, N.
    pub tension_n: Vec<f64>,
    /// Markers minus disks, x and y alternating, base frame, m.
    pub marker_m: Vec<f64>,
    /// The same under the model's own tensions, computed from that at the base.
    pub own_marker_m: Vec<f64>,
}

/// Shapes with their inputs, so that they need not be computed again.
#[derive(Clone)]
struct Computed {
    params: ManipulatorParams,
    tension_n: Vec<f64>,
    shapes: Vec<ComputedShape>,
}

impl<'a> Runs<'a> {
    /// Prepares the comparison with the runs.
    ///
    /// # Errors
    /// Returns [`ContinuumError::MissingGroup`] if nothing can be compared, [`ContinuumError::NoGratings`] if the shifts are needed and the file has
    /// no lines, or [`ContinuumError::OverCapacity`].
    pub fn new(file: &ManipulatorFile, runs: &[Run], progress: Option<&'a Progress>) -> Result<Self, ContinuumError> {
        let gratings = Gratings::from_file(file)?;
        let lack =
            |what, remedy| ContinuumError::MissingGroup { what, consequence: "there is nothing to compare", remedy };
        for run in runs {
            run.check_sizes(file.params())?;
            match (run.has_tension(), run.has_shifts(), run.has_markers()) {
                (true, _, true) => {}
                (true, true, false) | (false, true, true) if gratings.is_some() => {}
                (true, true, false) | (false, true, true) => return Err(ContinuumError::NoGratings),
                (true, false, false) => return Err(lack("marker or grating", "`marker_1_x_m` …, or `shift_1_nm` …")),
                (false, true, false) => {
                    return Err(lack("tension at the base or marker", "`tension_base_n`, or `marker_1_x_m` …"));
                }
                (false, false, _) => return Err(lack("tension", "`tension_base_n`, or `shift_1_nm` …")),
            }
        }
        let has_gratings = gratings.is_some() && runs.iter().any(Run::has_shifts);
        let one = |run: &Run| -> Result<One, ContinuumError> {
            let kept = thinned(run.samples());
            let is_dead = match gratings.as_ref().filter(|_| run.has_shifts()) {
                Some(gratings) => {
                    let read = gratings.read(run)?;
                    kept.iter().filter_map(|place| Some(read.get(*place)?.is_bridged.clone())).collect()
                }
                None => Vec::new(),
            };
            Ok(One { whole: run.clone(), kept, is_dead })
        };
        let all: Vec<One> = runs.iter().map(one).collect::<Result<_, _>>()?;
        let samples = all.iter().flat_map(|run| run.whole.samples());
        let greatest_tension_n = samples.map(|sample| sample.tension_base_n).fold(0.0, f64::max);
        let greatest_tension_n = if greatest_tension_n > 0.0 { greatest_tension_n } else { 1.0 };
        let of_base = |sample: &RunSample| vec![sample.tension_base_n; file.params().disk_count()];
        let base_n: Vec<Vec<f64>> = all.iter().flat_map(|run| run.whole.samples()).map(of_base).collect();
        let model_marker_m = model_marker_m(file.params(), base_n.iter().map(Vec::as_slice));
        Ok(Self { given: file.tables().clone(), all, has_gratings, greatest_tension_n, model_marker_m, progress })
    }

    /// Returns the times of the compared samples of the first run, s.
    pub fn times_s(&self) -> Vec<f64> {
        let first = self.all.first();
        let time_s = |run: &One, place: &usize| run.whole.samples().get(*place).map(|sample| sample.time_s);
        first.map_or_else(Vec::new, |run| run.kept.iter().filter_map(|place| time_s(run, place)).collect())
    }

    pub fn has_markers(&self) -> bool {
        self.all.iter().all(|run| run.whole.has_markers())
    }

    /// Returns the number of compared samples in each run.
    pub fn sample_counts(&self) -> Vec<usize> {
        self.all.iter().map(|run| run.kept.len()).collect()
    }

    pub fn has_base_tension(&self) -> bool {
        self.all.iter().all(|run| run.whole.has_tension())
    }

    /// Returns the start: the file as it is, with correct lines.
    pub fn start(&self, unknowns: &[Unknown]) -> State {
        let lines = if self.has_gratings { vec![[0.0; 2]; self.given.disk_count] } else { Vec::new() };
        State { unknowns: unknowns.iter().map(|unknown| (*unknown, 0.0)).collect(), lines }
    }

    /// Returns the prediction of a state; `None` if its numbers do not form a manipulator, or if the work is stopped. Shapes that `near` already contains
    /// are reused.
    pub fn evaluate(&self, state: &State, near: Option<&Evaluation>) -> Option<Evaluation> {
        if self.progress.is_some_and(Progress::is_stopped) {
            return None;
        }
        let file = ManipulatorFile::check(state.tables(&self.given)).ok()?;
        let gratings = if self.has_gratings { Gratings::from_file(&file).ok()? } else { None };
        let mut smooth = file.tables().clone();
        smooth.tendon.mu = OneOrEach::One(0.0);
        let smooth = *ManipulatorFile::check(smooth).ok()?.params();
        let runs = self.all.iter().enumerate().map(|(place, run)| {
            let near = near.and_then(|near| near.runs.get(place));
            let gratings = gratings.as_ref().filter(|_| run.whole.has_shifts());
            run.evaluate(&file, &smooth, gratings, state, near)
        });
        Some(Evaluation { runs: runs.collect::<Option<_>>()? })
    }
}

impl One {
    fn evaluate(
        &self,
        file: &ManipulatorFile,
        smooth: &ManipulatorParams,
        gratings: Option<&Gratings>,
        state: &State,
        near: Option<&RunEvaluation>,
    ) -> Option<RunEvaluation> {
        let run = corrected(&self.whole, file).ok()?;
        let samples: Vec<RunSample> = self.kept.iter().filter_map(|place| run.samples().get(*place)).cloned().collect();
        let has_markers = run.has_markers();
        let history = if run.has_tension() && (gratings.is_some() || has_markers) {
            let base_n = samples.iter().map(|sample| sample.tension_base_n).collect();
            let old = near.and_then(|near| near.history.as_ref());
            Some(Computed::of(file.params(), &samples, way(file), base_n, &[], old)?)
        } else {
            None
        };
        let observed: Vec<Vec<f64>>;
        if let Some(gratings) = gratings {
            let tensions = gratings.unbridged(&run).ok()?;
            let rows = self.kept.iter().filter_map(|place| tensions.get(*place));
            let mut all = Vec::with_capacity(samples.len());
            for row in rows {
                let each = row.iter().zip(gratings.lines().iter().zip(gratings.line_errors())).zip(&state.lines);
                let right = |((tension, (line, error)), off): ((&Tension, (&Calibration, &LineError)), &[f64; 2])| {
                    let [constant_n, slope_n] = error.parts_n(line.shift_nm(tension.value_n));
                    tension.value_n - constant_n * off[0] - slope_n * off[1]
                };
                all.push(each.map(right).collect::<Vec<f64>>());
            }
            observed = all;
        } else {
            observed = Vec::new();
        }
        let measured = if gratings.is_some() && has_markers {
            let fed = self.fed(&observed, history.as_ref());
            let old = near.and_then(|near| near.measured.as_ref());
            Some(Computed::of(smooth, &samples, Way::Measured, fed.concat(), &fed, old)?)
        } else {
            None
        };
        let shown = measured.as_ref().or(history.as_ref());
        let lag_s = state.marker_lag_s();
        let late_m = match &history {
            Some(own) if lag_s != 0.0 => {
                let times_s: Vec<f64> = samples.iter().map(|sample| sample.time_s).collect();
                moved_m(&times_s, &own.shapes, lag_s)
            }
            _ => Vec::new(),
        };
        let row = |(place, sample): (usize, &RunSample)| {
            let own = history.as_ref().and_then(|one| one.shapes.get(place));
            let tension_n = match (observed.get(place), own) {
                (Some(observed), Some(own)) => {
                    let has_shape = own.status.has_shape();
                    let left =
                        |(shown_n, tension_n): (&f64, &f64)| if has_shape { shown_n - tension_n } else { f64::NAN };
                    observed.iter().zip(&own.tension_n).map(left).collect()
                }
                _ => Vec::new(),
            };
            let off_disks_m = |shape: &ComputedShape| -> Vec<f64> {
                let has_shape = shape.status.has_shape();
                let places = shape.disk_position_m.iter().zip(&sample.marker_m);
                let left = |([x_m, y_m], [marker_x_m, marker_y_m]): (&[f64; 2], &[f64; 2])| {
                    if has_shape { [marker_x_m - x_m, marker_y_m - y_m] } else { [f64::NAN; 2] }
                };
                places.flat_map(left).collect()
            };
            let mut marker_m = shown.and_then(|one| one.shapes.get(place)).map_or_else(Vec::new, off_disks_m);
            for (left_m, late_m) in marker_m.iter_mut().zip(late_m.get(place).into_iter().flatten().flatten()) {
                *left_m += late_m;
            }
            Row { tension_n, marker_m, own_marker_m: own.map_or_else(Vec::new, off_disks_m) }
        };
        let rows = samples.iter().enumerate().map(row).collect();
        Some(RunEvaluation { history, measured, rows })
    }

    /// Returns the tensions of the gratings; where one is dead, those of the model, or without friction if there is none.
    fn fed(&self, observed: &[Vec<f64>], history: Option<&Computed>) -> Vec<Vec<f64>> {
        let one = |(place, row): (usize, &Vec<f64>)| {
            let own = history.and_then(|one| one.shapes.get(place));
            let is_dead = |segment: usize| self.is_dead.get(place).and_then(|all| all.get(segment)) == Some(&true);
            let tension_n = |(segment, shown_n): (usize, &f64)| {
                let model_n = || own.and_then(|shape| shape.tension_n.get(segment)).copied();
                if is_dead(segment) { model_n().unwrap_or(f64::NAN) } else { *shown_n }
            };
            row.iter().enumerate().map(tension_n).collect()
        };
        observed.iter().enumerate().map(one).collect()
    }
}

impl Computed {
    fn of(
        params: &ManipulatorParams,
        samples: &[RunSample],
        way: Way,
        tension_n: Vec<f64>,
        fed: &[Vec<f64>],
        old: Option<&Self>,
    ) -> Option<Self> {
        if let Some(old) = old.filter(|old| old.params == *params && same_bits(&old.tension_n, &tension_n)) {
            return Some(old.clone());
        }
        let measured = |row: &Vec<f64>| GratingSample {
            tension: row.iter().map(|value_n| Tension { value_n: *value_n, standard_error_n: 0.0 }).collect(),
            is_bridged: vec![false; row.len()],
        };
        let measured: Vec<GratingSample> = fed.iter().map(measured).collect();
        let shapes = shapes(params, samples, way, &measured).ok()?;
        Some(Self { params: *params, tension_n, shapes })
    }
}

fn same_bits(one: &[f64], other: &[f64]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(one, other)| one.to_bits() == other.to_bits())
}

/// Returns the friction model of the file.
pub fn way(file: &ManipulatorFile) -> Way {
    if file.params().mu(Tendon::Agonist).iter().all(|mu| *mu == 0.0) {
        Way::None
    } else if file.tables().tendon.sigma_n_per_m.is_none() {
        Way::Coulomb
    } else {
        Way::History
    }
}
