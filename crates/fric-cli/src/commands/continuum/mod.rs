//! `continuum`: one file per subcommand, and their common functions.

mod calibrate;
pub mod discover;
mod fit;
mod friction;
mod hole;
pub mod info;
mod rows;
mod shape;
mod simulate;
mod track;

use std::fs::{self, File, Metadata};
use std::io::Read as _;
use std::path::Path;

use fric_core::text_file;
use fric_log::table::NumberTable;
use fric_tendon::file::{FORMAT, ManipulatorFile};
use fric_tendon_lab::gratings::Gratings;
use fric_tendon_lab::guard::Guarded;
use fric_tendon_lab::{ContinuumError, Run, columns, corrected};

use crate::arguments::continuum::{ContinuumCommand, RunArguments};
use crate::failure::{Failure, Outcome};
use crate::model::{has_format, read_text};
use crate::warnings::warn_all;

/// Maximum length of a text run's header, in bytes.
const LONGEST_HEADER: u64 = 4096;

/// Runs the command.
pub fn run(command: &ContinuumCommand) -> Outcome {
    match command {
        ContinuumCommand::Calibrate(arguments) => calibrate::run(arguments),
        ContinuumCommand::Fit(arguments) => fit::run(arguments),
        ContinuumCommand::Friction(arguments) => friction::run(arguments),
        ContinuumCommand::Hole(arguments) => hole::run(arguments),
        ContinuumCommand::Shape(arguments) => shape::run(arguments),
        ContinuumCommand::Simulate(arguments) => simulate::run(arguments),
        ContinuumCommand::Track(arguments) => track::run(arguments),
    }
}

/// Whether a model is a manipulator file rather than a robot file.
pub fn is_manipulator(model: Option<&Path>) -> bool {
    model.is_some_and(|model| text_file::read(model).is_ok_and(|text| has_format(&text, FORMAT)))
}

/// Whether a log is text with a header that has a column of a manipulator's run.
pub fn is_text_run(log: &Path) -> bool {
    let begin = || {
        // Reading from a pipe would block.
        fs::metadata(log).ok().filter(Metadata::is_file)?;
        let mut begin = Vec::new();
        File::open(log).ok()?.take(LONGEST_HEADER).read_to_end(&mut begin).ok()?;
        String::from_utf8(begin).ok()
    };
    let is_of_manipulator = |header: &str| {
        let is_there = |column: &str| header.contains(column);
        is_there(columns::TIME) && columns::MARKS.into_iter().any(is_there)
    };
    begin().is_some_and(|text| text.lines().next().is_some_and(is_of_manipulator))
}

/// A manipulator and the text of its file.
pub struct Model {
    pub file: ManipulatorFile,
    pub text: String,
    pub origin: String,
}

impl Model {
    /// Reads the manipulator file at a path.
    pub fn read(path: &Path) -> Outcome<Self> {
        let (text, origin) = read_text(path, "manipulator")?;
        let file = ManipulatorFile::parse(&text, &origin)?;
        Ok(Self { file, text, origin })
    }

    pub fn name(&self) -> &str {
        &self.file.tables().name
    }

    pub fn disk_count(&self) -> usize {
        self.file.params().disk_count()
    }
}

/// Reads the columns of a file and prints warnings about it.
pub fn read_table(path: &Path, wanted: &[String]) -> Outcome<Vec<(String, Vec<f64>)>> {
    let table = NumberTable::read(path, wanted)?;
    warn_all(&table.warnings);
    Ok(table.columns)
}

/// Returns a failure that names its file.
fn about(path: &Path, error: ContinuumError) -> Failure {
    Failure::from(error).in_file(path)
}

/// Reads a run, corrected for the frame and the base sensor stated in the file of its manipulator, and that manipulator.
fn read_run(arguments: &RunArguments) -> Outcome<(Model, Run)> {
    let model = Model::read(&arguments.model)?;
    let columns = read_table(&arguments.run, &columns::of_run(model.disk_count()))?;
    let run = Run::from_columns(&columns, model.disk_count()).map_err(|error| about(&arguments.run, error))?;
    let run = corrected(&run, &model.file).map_err(|error| about(&arguments.run, error))?;
    Ok((model, run))
}

/// Returns the tensions of the gratings in a run after all guards; `None` if it has no shifts, or the file no gratings.
fn read_gratings(path: &Path, model: &Model, run: &Run) -> Outcome<Option<Guarded>> {
    let gratings = Gratings::from_file(&model.file)?;
    match gratings {
        Some(gratings) if run.has_shifts() => {
            if run.has_reference() && gratings.wavelengths_nm().is_none() {
                warn_all(&["the temperature stays in the shifts: there is a reference, but no `wavelength_nm` under \
                            `[gratings]` in the manipulator file"
                    .to_owned()]);
            }
            Ok(Some(Guarded::read(model.file.params(), &gratings, run).map_err(|error| about(path, error))?))
        }
        _ => Ok(None),
    }
}
