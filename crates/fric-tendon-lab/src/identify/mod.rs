//! Identification of a manipulator from runs: bending, frame, loads and friction from markers, gratings and the tension at the base, any two of them.
//!
//! [`identify`] varies the numbers of the manipulator file ([`Unknown`]) until the model agrees with the measurements (`evaluation` defines the
//! comparison, `least_squares` searches, `errors` computes the intervals). Numbers that the runs do not determine are held as in the file and
//! reported: they lie along directions with small eigenvalues of the information matrix, as in the identification of cables.

pub(super) mod arc_error;
mod attempt;
pub(super) mod errors;
pub(super) mod evaluation;
mod least_squares;
mod quantity;
mod result;
mod summary;
pub(super) mod unknown;

use fric_lab::fit::Progress;
use fric_tendon::edit::{GratingLine, ManipulatorEdit};
use fric_tendon::file::ManipulatorFile;

use self::attempt::Attempt;
use self::evaluation::Runs;
use self::least_squares::Solution;
use super::base_noise::{BaseNoise, steadied};
use super::error::ContinuumError;
use super::gratings::Gratings;
use super::guard;
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

/// Identifies the numbers of a manipulator from its runs. `names` holds the names of the runs. Another thread can stop the work by `progress`.
///
/// # Errors
/// Returns [`ContinuumError::MissingGroup`] if a run has nothing to compare, [`ContinuumError::NoGratings`] if its shifts are needed and the file
/// does not say how they become tensions, [`ContinuumError::TooShort`], [`ContinuumError::OverCapacity`], or [`ContinuumError::NotIdentified`] if the
/// model has no shapes for the runs or the work was stopped.
pub fn identify(
    file: &ManipulatorFile,
    runs: &[Run],
    names: &[String],
    options: &TendonFitOptions,
    progress: &Progress,
) -> Result<Identification, ContinuumError> {
    progress.begin(1);
    let (runs, base_noise): (Vec<Run>, Vec<Option<BaseNoise>>) = runs.iter().map(steadied).unzip();
    let (mut runs, mut common_steps) = (runs, Vec::new());
    if let Some(gratings) = Gratings::from_file(file)? {
        let steadied = runs.into_iter().map(|run| guard::steadied(run, &gratings));
        (runs, common_steps) = steadied.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
    }
    let counts = Runs::new(file, &runs, None)?.sample_counts();
    let count = counts.iter().sum();
    if count < LEAST_SAMPLES {
        return Err(ContinuumError::TooShort { count, needed: LEAST_SAMPLES });
    }
    let given = file.tables();
    let has_markers = runs.iter().any(Run::has_markers);
    let mut quantities = options.quantities.clone().unwrap_or_else(|| Quantity::usual(given, has_markers));
    let mut kept = Vec::new();
    if options.quantities.is_none() && !has_markers {
        let with_markers = Quantity::usual(given, true).into_iter();
        kept.push(Undetermined::unseen(with_markers.filter(|one| !quantities.contains(one))));
    }
    kept.extend(quantities.iter().filter(|one| one.is_impossible(given)).map(|one| Undetermined::impossible(*one)));
    let step_count = common_steps.iter().map(Vec::len).sum();
    let attempt = |quantities: &[Quantity]| Attempt::new(file, &runs, quantities, step_count, progress);
    let mut found = attempt(&quantities)?;
    if let Some(worse) = found.worse {
        // Numbers that move a disk away from its marker stand for something else. Friction may still be found.
        let friction: Vec<Quantity> = quantities.iter().copied().filter(|one| one.is_friction()).collect();
        let without = if friction.len() < quantities.len() { Some(attempt(&friction)?) } else { None };
        let better = without.filter(|without| without.worse.is_none() && !without.misfit.any());
        let left = if better.is_some() { friction } else { Vec::new() };
        found = better.map_or_else(|| attempt(&[]), Ok)?;
        kept.push(Undetermined::worse(quantities.iter().filter(|one| !left.contains(one)), &worse));
        quantities = left;
    }
    found.undetermined.splice(0..0, kept);
    let mut wanted = found.solution.state.tables(&found.given);
    tidy(given, &mut wanted);
    let mut edit = ManipulatorEdit::between(given, &wanted);
    if quantities.contains(&Quantity::Calibration) {
        edit.lines = lines(file, &found.solution)?;
    }
    let result = TendonFitResult::new(given, names, &counts, found, &wanted, (base_noise, common_steps));
    progress.finish_one();
    Ok(Identification { result, edit })
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
