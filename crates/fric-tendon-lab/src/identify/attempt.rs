//! One search for some quantities, until every number that it finds is determined by the runs.

use fric_lab::fit::{OpenDirection, Progress, open_directions};
use fric_lab::statistics::inverse_of_normal;
use fric_tendon::file::{ManipulatorFile, ManipulatorTables};
use nalgebra::DMatrix;

use super::errors::{self, PRACTICAL};
use super::evaluation::{Evaluation, Row, RunEvaluation, Runs};
use super::least_squares::{Solution, solve};
use super::quantity::Quantity;
use super::result::Undetermined;
use super::unknown::Unknown;
use crate::discover::markers::noise_m;
use crate::discover::noise::{PRACTICAL_RATIO, is_misfit};
use crate::discover::worse::{Worse, grown};
use crate::error::ContinuumError;
use crate::run::Run;

/// Ratio by which the tensions may get further from the gratings: the errors of the lines, which a fit takes into account, are not written. Sound
/// runs of another simulator come to 1.003 at most, a μ that stands for a stiffness 3 % off to 1.9: half as much growth or twice as much decides alike.
const MOST_GROWTH_RATIO: f64 = 1.25;

/// Where the runs leave a combination of numbers open, the stated value of one is contradicted if the one found is further from it, in standard errors: by
/// chance one in 370 is. At half of this one fit in eight would hold the wrong number; at twice, lying flat, a hole radius 20 % off would stay.
const CONTRADICTED: f64 = 3.0;

/// The outcome of a search.
pub struct Attempt {
    /// The given numbers; a mass on the tip that would come out below zero is taken as 0.
    pub given: ManipulatorTables,
    /// The prediction of the given file.
    pub before: Evaluation,
    /// The prediction of the fitted file.
    pub after: Evaluation,
    /// Unless the lines are fitted, their errors are no part of the fitted file.
    pub solution: Solution,
    pub covariance: DMatrix<f64>,
    pub undetermined: Vec<Undetermined>,
    /// What it makes worse.
    pub worse: Option<MadeWorse>,
    /// What it leaves more of than noise, unlike holes and errors of the lines.
    pub misfit: Misfit,
}

impl Attempt {
    /// Searches for the numbers of some quantities, in runs from which so many common steps of the gratings were taken off.
    ///
    /// # Errors
    /// Returns the errors of [`Runs::new`], or [`ContinuumError::NotIdentified`] if the model has no shapes for the runs or `progress` is stopped.
    pub fn new(
        file: &ManipulatorFile,
        runs: &[Run],
        quantities: &[Quantity],
        step_count: usize,
        progress: &Progress,
    ) -> Result<Self, ContinuumError> {
        let mut runs = Runs::new(file, runs, Some(progress))?;
        let all_unknowns = || quantities.iter().flat_map(|quantity| quantity.unknowns(file.tables()));
        let mut unknowns: Vec<Unknown> = all_unknowns().collect();
        let mut undetermined: Vec<Undetermined> = Vec::new();
        let before = runs.evaluate(&runs.start(&[]), None).ok_or(ContinuumError::NotIdentified)?;
        let mut start = runs.start(&unknowns);
        let (solution, covariance) = loop {
            let solution = solve(&runs, start).ok_or(ContinuumError::NotIdentified)?;
            let tables = solution.state.tables(&runs.given);
            if Unknown::TipMass.is_below_range(&runs.given, &solution.state.unknowns) {
                // A negative mass is noise, or stands for something else. What could not be told apart from it can be without it.
                runs.given.tip.mass_kg = 0.0;
                unknowns = all_unknowns().filter(|unknown| *unknown != Unknown::TipMass).collect();
                undetermined = vec![Undetermined::at_bound(Unknown::TipMass)];
                start = runs.start(&unknowns);
                continue;
            }
            if unknowns.is_empty() {
                break (solution, DMatrix::zeros(0, 0));
            }
            let covariance = errors::covariance(&runs, &solution).ok_or(ContinuumError::NotIdentified)?;
            let widest: Vec<f64> =
                unknowns.iter().map(|unknown| unknown.widest(&tables, runs.greatest_tension_n)).collect();
            let Some(direction) = open(&covariance, &widest).into_iter().next() else { break (solution, covariance) };
            // If the file's value is contradicted, another number must be held.
            let is_contradicted = |place: &usize| {
                let distance = solution.state.unknowns.get(*place).map_or(0.0, |(_, distance)| *distance);
                distance.abs() > CONTRADICTED * covariance[(*place, *place)].max(0.0).sqrt()
            };
            let parts = direction.parts();
            let least = parts.iter().min_by_key(|place| (is_contradicted(place), unknowns[**place].rank()));
            let Some(held) = least.map(|place| unknowns[*place]) else { break (solution, covariance) };
            let parts: Vec<Unknown> = parts.iter().map(|place| unknowns[*place]).collect();
            undetermined.push(Undetermined::of(held, &parts));
            unknowns.retain(|unknown| *unknown != held);
            start = solution.state;
            start.unknowns.retain(|(unknown, _)| *unknown != held);
        };
        let mut as_written = solution.state.clone();
        if !quantities.contains(&Quantity::Calibration) {
            as_written.lines = runs.start(&[]).lines;
        }
        let after = runs.evaluate(&as_written, Some(&solution.evaluation)).ok_or(ContinuumError::NotIdentified)?;
        let misfit = Misfit {
            gratings: is_misfit(
                &gratings_left_n(&solution.evaluation),
                PRACTICAL_RATIO * runs.greatest_tension_n,
                step_count,
            ),
            // The error of a step's size is one of all tensions, and bends the whole shape.
            markers: step_count == 0
                && is_misfit(&markers_left_m(&solution.evaluation), PRACTICAL * runs.model_marker_m, 0),
        };
        Ok(Self {
            worse: MadeWorse::of(&before, &after, misfit.any()),
            misfit,
            given: runs.given,
            before,
            after,
            solution,
            covariance,
            undetermined,
        })
    }

    /// Returns the numbers that were found.
    pub fn unknowns(&self) -> Vec<Unknown> {
        self.solution.state.unknowns.iter().map(|(unknown, _)| *unknown).collect()
    }
}

/// The signals of which a search leaves more than noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Misfit {
    /// The tensions at the gratings.
    pub gratings: bool,
    /// The distances of the disks from their markers.
    pub markers: bool,
}

impl Misfit {
    pub fn any(self) -> bool {
        self.gratings || self.markers
    }
}

/// What a fitted file makes worse than the given one.
#[derive(Clone, Copy)]
pub enum MadeWorse {
    /// A disk is further from its marker.
    Disk(Worse),
    /// The tensions are further from the gratings: root mean square before and after, N.
    Tensions([f64; 2]),
}

impl MadeWorse {
    /// Compares both files. Where a fit leaves no more than noise, a disk may move off its marker if the disks together do not by more than the noise.
    fn of(before: &Evaluation, after: &Evaluation, is_misfit: bool) -> Option<Self> {
        Self::disk(before, after, is_misfit).or_else(|| Self::tensions(before, after))
    }

    /// Compares the disks under the measured tensions, and under the model's own.
    fn disk(before: &Evaluation, after: &Evaluation, is_misfit: bool) -> Option<Self> {
        let grown = |marker_m: fn(&Row) -> &Vec<f64>| {
            let places = |evaluation: &Evaluation| -> Vec<Vec<[f64; 2]>> {
                let of_row = |row: &Row| marker_m(row).chunks_exact(2).map(|place| [place[0], place[1]]).collect();
                evaluation.runs.iter().flat_map(|run| run.rows.iter().map(of_row)).collect()
            };
            let (before, after) = (places(before), places(after));
            let noise_m = noise_m(&before)?;
            let [before_m, after_m] = [&before, &after].map(|all| rms(all.iter().flatten().flatten()));
            // Both coordinates of a distance have their noise.
            let is_further = 2.0 * (after_m * after_m - before_m * before_m) > noise_m * noise_m;
            grown([&before, &after], noise_m).filter(|_| is_misfit || is_further)
        };
        let worse = [grown(|row| &row.marker_m), grown(|row| &row.own_marker_m)].into_iter().flatten();
        let growth_m = |worse: &Worse| worse.after_m - worse.before_m;
        worse.max_by(|one, other| growth_m(one).total_cmp(&growth_m(other))).map(Self::Disk)
    }

    fn tensions(before: &Evaluation, after: &Evaluation) -> Option<Self> {
        let [before_n, after_n] = [before, after].map(gratings_left_n).map(|all| rms(all.iter().flatten()));
        (after_n > MOST_GROWTH_RATIO * before_n).then_some(Self::Tensions([before_n, after_n]))
    }
}

fn rms<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let (sum, count) = values
        .filter(|value| value.is_finite())
        .fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    if count > 0.0 { (sum / count).sqrt() } else { 0.0 }
}

/// Returns what a model leaves of the tension at each grating of each run, N, sample by sample.
fn gratings_left_n(found: &Evaluation) -> Vec<Vec<f64>> {
    let of_grating = |run: &RunEvaluation, grating: usize| -> Vec<f64> {
        run.rows.iter().map(|row| row.tension_n.get(grating).copied().unwrap_or(f64::NAN)).collect()
    };
    let gratings = |run: &RunEvaluation| run.rows.iter().map(|row| row.tension_n.len()).max().unwrap_or(0);
    found.runs.iter().flat_map(|run| (0..gratings(run)).map(move |grating| of_grating(run, grating))).collect()
}

/// Returns the distances of the disks from their markers, m: a series for each disk and axis of each run.
fn markers_left_m(found: &Evaluation) -> Vec<Vec<f64>> {
    let places = |run: &RunEvaluation| run.rows.iter().map(|row| row.marker_m.len()).max().unwrap_or(0);
    let of_place = |run: &RunEvaluation, place: usize| -> Vec<f64> {
        run.rows.iter().map(|row| row.marker_m.get(place).copied().unwrap_or(f64::NAN)).collect()
    };
    found.runs.iter().flat_map(|run| (0..places(run)).map(move |place| of_place(run, place))).collect()
}

/// Returns the directions that the runs leave open, in units of the widest intervals.
fn open(covariance: &DMatrix<f64>, widest: &[f64]) -> Vec<OpenDirection> {
    let scaled = DMatrix::from_fn(widest.len(), widest.len(), |row, column| {
        covariance[(row, column)] / (widest[row] * widest[column])
    });
    let silent = DMatrix::from_element(widest.len(), widest.len(), f64::NAN);
    open_directions(&inverse_of_normal(&scaled).unwrap_or(silent))
}
