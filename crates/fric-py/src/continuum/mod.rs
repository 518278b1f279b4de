//! `fric.continuum`: tendons through disks. The functions here have a prefix that the Python module removes.

mod calibration;
mod discover;
mod fit;
mod friction;
mod manipulator;
mod run;
mod shape;
mod simulate;
mod static_model;
mod static_rows;
mod track;

pub use calibration::continuum_calibrate;
pub use discover::continuum_discover;
pub use fit::continuum_fit;
pub use friction::{continuum_friction, continuum_hole};
pub use manipulator::Manipulator;
pub use run::{TendonRun, continuum_read_loads, continuum_read_run};
pub use shape::continuum_shape;
pub use simulate::continuum_simulate;
pub use static_model::{StaticModel, StaticSnapshot};
pub use track::continuum_track;

use fric_tendon_lab::gratings::Gratings;
use fric_tendon_lab::guard::Guarded;
use fric_tendon_lab::{ContinuumError, Run, corrected};

use crate::errors::Outcome;

/// The name of a run that does not come from a file.
const ARRAYS: &str = "arrays";

/// Returns the tensions of a manipulator's gratings in a run after all guards; `None` if either has none.
fn guarded(manipulator: &Manipulator, run: &Run) -> Result<Option<Guarded>, ContinuumError> {
    match Gratings::from_file(&manipulator.file)? {
        Some(gratings) if run.has_shifts() => Guarded::read(manipulator.file.params(), &gratings, run).map(Some),
        _ => Ok(None),
    }
}

/// Concatenates rows.
fn flat(rows: &[Vec<f64>]) -> Vec<f64> {
    rows.iter().flatten().copied().collect()
}

/// Returns the run corrected for the frame and the base sensor stated in the manipulator's file.
fn in_base_frame(manipulator: &Manipulator, run: &Run) -> Outcome<Run> {
    check_disks(manipulator, run)?;
    Ok(corrected(run, &manipulator.file)?)
}

/// Checks that a run belongs to a manipulator.
fn check_disks(manipulator: &Manipulator, run: &Run) -> Outcome {
    let (count, needed) = (run.disk_count(), manipulator.file.params().disk_count());
    if count == needed {
        Ok(())
    } else {
        Err(ContinuumError::WrongCount { what: "disks in the run", count, needed }.into())
    }
}
