//! Identification of a manipulator from runs: bending, frame, loads and friction from markers, gratings and the tension at the base, any two of them.
//!
//! [`identify`] varies the numbers of the manipulator file ([`Unknown`]) until the model agrees with the measurements (`evaluation` defines the
//! comparison, `least_squares` searches, `errors` computes the intervals). Numbers that the runs do not determine are held as in the file and
//! reported: they lie along directions with small eigenvalues of the information matrix, as in the identification of cables.

pub(super) mod errors;
pub(super) mod evaluation;
mod least_squares;
mod quantity;
mod result;
mod summary;
pub(super) mod unknown;

use fric_lab::fit::{HALF_INTERVAL, OpenDirection, open_directions};
use fric_lab::statistics::inverse_of_normal;
use fric_tendon::edit::{GratingLine, ManipulatorEdit};
use fric_tendon::file::ManipulatorFile;
use nalgebra::DMatrix;

use self::evaluation::{Runs, State};
use self::least_squares::{Solution, solve};
use super::base_noise::{BaseNoise, steadied};
use super::error::ContinuumError;
use super::gratings::Gratings;
use super::run::Run;

pub use quantity::Quantity;
pub use result::{Disagreement, TendonFitResult, Undetermined};
pub use unknown::Unknown;

/// Minimum number of samples of all runs together.
const LEAST_SAMPLES: usize = 20;

/// Options of an identification.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TendonFitOptions {
    /// The quantities to identify; [`Quantity::usual`] if `None`.
    pub quantities: Option<Vec<Quantity>>,
}

/// The outcome of an identification.
#[derive(Clone, Debug)]
pub struct Identification {
    /// The result for machines and people.
    pub result: TendonFitResult,
    /// The changes to the manipulator file.
    pub edit: ManipulatorEdit,
}

/// Identifies the numbers of a manipulator from its runs. `names` holds the names of the runs.
///
/// # Errors
/// Returns [`ContinuumError::MissingGroup`] if a run has nothing to compare, [`ContinuumError::NoGratings`] if its shifts are needed and the file
/// does not say how they become tensions, [`ContinuumError::TooShort`], [`ContinuumError::OverCapacity`], or [`ContinuumError::NotIdentified`] if the
/// model has no shapes for the runs.
pub fn identify(
    file: &ManipulatorFile,
    runs: &[Run],
    names: &[String],
    options: &TendonFitOptions,
) -> Result<Identification, ContinuumError> {
    let (runs, base_noise): (Vec<Run>, Vec<Option<BaseNoise>>) = runs.iter().map(steadied).unzip();
    let mut runs = Runs::new(file, &runs)?;
    let counts = runs.sample_counts();
    let count = counts.iter().sum();
    if count < LEAST_SAMPLES {
        return Err(ContinuumError::TooShort { count, needed: LEAST_SAMPLES });
    }
    let given = file.tables().clone();
    let quantities = options.quantities.clone().unwrap_or_else(|| Quantity::usual(&given));
    let mut unknowns: Vec<Unknown> = quantities.iter().flat_map(|quantity| quantity.unknowns(&given)).collect();
    let mut undetermined: Vec<Undetermined> = Vec::new();
    for quantity in &quantities {
        if quantity.unknowns(&given).is_empty() && *quantity != Quantity::Calibration {
            undetermined.push(Undetermined::impossible(*quantity));
        }
    }
    let before = runs.evaluate(&runs.start(&[]), None).ok_or(ContinuumError::NotIdentified)?;
    let mut start = runs.start(&unknowns);
    let (solution, covariance) = loop {
        let solution = solve(&runs, start).ok_or(ContinuumError::NotIdentified)?;
        let tables = solution.state.tables(&runs.given);
        if Unknown::TipMass.is_below_range(&runs.given, &solution.state.unknowns) {
            // A negative mass is noise, or stands for something else.
            runs.given.tip.mass_kg = 0.0;
            unknowns.retain(|unknown| *unknown != Unknown::TipMass);
            undetermined.push(Undetermined::at_bound(Unknown::TipMass));
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
            distance.abs() > HALF_INTERVAL * covariance[(*place, *place)].max(0.0).sqrt()
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
    // Errors of the lines that are not written are no part of the fitted file.
    let as_written = State { lines: runs.start(&[]).lines, ..solution.state.clone() };
    let written = if quantities.contains(&Quantity::Calibration) {
        None
    } else {
        Some(runs.evaluate(&as_written, Some(&solution.evaluation)).ok_or(ContinuumError::NotIdentified)?)
    };
    let after = written.as_ref().unwrap_or(&solution.evaluation);
    let mut wanted = solution.state.tables(&runs.given);
    tidy(&given, &mut wanted);
    let mut edit = ManipulatorEdit::between(&given, &wanted);
    if quantities.contains(&Quantity::Calibration) {
        edit.lines = lines(file, &solution)?;
    }
    let result = TendonFitResult::new(
        &given,
        names,
        &counts,
        (&before, after),
        (&unknowns, &wanted, &covariance),
        undetermined,
        base_noise,
    );
    Ok(Identification { result, edit })
}

/// Returns the directions that the runs leave open, in units of the widest intervals.
fn open(covariance: &DMatrix<f64>, widest: &[f64]) -> Vec<OpenDirection> {
    let scaled = DMatrix::from_fn(widest.len(), widest.len(), |row, column| {
        covariance[(row, column)] / (widest[row] * widest[column])
    });
    let silent = DMatrix::from_element(widest.len(), widest.len(), f64::NAN);
    open_directions(&inverse_of_normal(&scaled).unwrap_or(silent))
}

/// A frame or a sensor that is as good as none is not written.
fn tidy(given: &fric_tendon::file::ManipulatorTables, wanted: &mut fric_tendon::file::ManipulatorTables) {
    if given.markers.is_none() && wanted.markers == Some(fric_tendon::measuring::MarkersTable::default()) {
        wanted.markers = None;
    }
    if given.base_sensor.is_none() && wanted.base_sensor == Some(fric_tendon::measuring::BaseSensorTable::default()) {
        wanted.base_sensor = None;
    }
}

/// Returns the fitted lines, with their original errors.
fn lines(file: &ManipulatorFile, solution: &Solution) -> Result<Vec<GratingLine>, ContinuumError> {
    let Some(gratings) = Gratings::from_file(file)? else { return Ok(Vec::new()) };
    let each = gratings.lines().iter().zip(gratings.line_errors()).zip(&solution.state.lines);
    Ok(each
        .map(|((line, error), [constant, slope])| {
            let slope_off = slope * error.slope_error_n_per_nm;
            GratingLine {
                newton_per_nm: line.newton_per_nm - slope_off,
                offset_n: line.offset_n - constant * error.line_error_n + slope_off * error.mean_shift_nm,
                standard_error_n: line.tension(0.0).standard_error_n,
                line_error_n: error.line_error_n,
                slope_error_n_per_nm: error.slope_error_n_per_nm,
                mean_shift_nm: error.mean_shift_nm,
            }
        })
        .collect())
}
