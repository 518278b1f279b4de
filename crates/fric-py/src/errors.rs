//! Converts errors of the crates below to the exceptions of `fric._errors`.

use std::io;
use std::path::Path;

use fric_core::robot::file::RobotFileError;
use fric_core::text_file::harmless;
use fric_core::{ParamError, SnapshotMismatch};
use fric_lab::discover::DiscoverError;
use fric_lab::excite::ExcitationError;
use fric_lab::fit::StoreError;
use fric_lab::hysteresis::HysteresisError;
use fric_lab::simulate::{HiddenError, SimulationError};
use fric_log::output;
use fric_log::recording::RecordingError;
use fric_log::robot::{AttachedRobotError, SignalPathError};
use fric_log::signals::{SignalError, TimesApart};
use fric_log::table::TableError;
use fric_log::write::WriteError;
use fric_log::{in_full, reason, with_advice};
use fric_tendon::file::ManipulatorFileError;
use fric_tendon::{ManipulatorError, StateMismatch};
use fric_tendon_lab::ContinuumError;
use fric_work::replay::NoHistogram;
use miette::Diagnostic;
use numpy::AsSliceError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

pyo3::import_exception!(fric._errors, ArrayTypeError);
pyo3::import_exception!(fric._errors, ConfigError);
pyo3::import_exception!(fric._errors, ConfigFileNotFoundError);
pyo3::import_exception!(fric._errors, FitError);
pyo3::import_exception!(fric._errors, InUseError);
pyo3::import_exception!(fric._errors, LogError);
pyo3::import_exception!(fric._errors, LogFileNotFoundError);
pyo3::import_exception!(fric._errors, OutputError);
pyo3::import_exception!(fric._errors, ShapeError);

/// `errno.ENOENT`, which is the same on every system.
const NO_ENTRY: i32 = 2;

/// The exception of a failed call.
pub struct Fault(PyErr);

/// The result of a call.
pub type Outcome<T = ()> = Result<T, Fault>;

/// Length of a message, characters: a log may have thousands of names, and each may be long.
const MOST_CHARACTERS: usize = 4000;

/// Returns a message without what a log's text may do to a terminal, and of bounded length.
pub fn legible(text: String) -> String {
    let cut =
        text.char_indices().nth(MOST_CHARACTERS).map(|(at, _)| format!("{}…", text.get(..at).unwrap_or_default()));
    harmless(&cut.unwrap_or(text)).into_owned()
}

impl Fault {
    /// Creates the error of an invalid parameter, key or option.
    pub fn config(text: impl Into<String>) -> Self {
        Self(ConfigError::new_err(legible(text.into())))
    }

    /// Creates the error of a missing robot or manipulator file.
    fn no_config(text: String, path: &Path) -> Self {
        Self(ConfigFileNotFoundError::new_err((NO_ENTRY, legible(text), path.to_owned())))
    }

    /// Creates the error of a missing log.
    fn no_log(text: String, path: &Path) -> Self {
        Self(LogFileNotFoundError::new_err((NO_ENTRY, legible(text), path.to_owned())))
    }

    /// Creates the error of an argument that is not an array of numbers.
    pub fn array_type(text: impl Into<String>) -> Self {
        Self(ArrayTypeError::new_err(legible(text.into())))
    }

    /// Creates the error of data that allow no fit.
    pub fn fit(text: impl Into<String>) -> Self {
        Self(FitError::new_err(legible(text.into())))
    }

    /// Creates the error of an object that another call uses.
    pub fn in_use(text: impl Into<String>) -> Self {
        Self(InUseError::new_err(legible(text.into())))
    }

    /// Creates the error of an unusable log.
    pub fn log(text: impl Into<String>) -> Self {
        Self(LogError::new_err(legible(text.into())))
    }

    /// Creates the error of a file that cannot be written.
    pub fn output(text: impl Into<String>) -> Self {
        Self(OutputError::new_err(legible(text.into())))
    }

    /// Creates the error of an array with the wrong shape, type or content.
    pub fn shape(text: impl Into<String>) -> Self {
        Self(ShapeError::new_err(legible(text.into())))
    }
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        fault.0
    }
}

impl From<PyErr> for Fault {
    fn from(error: PyErr) -> Self {
        Self(error)
    }
}

impl From<pyo3::CastError<'_, '_>> for Fault {
    fn from(error: pyo3::CastError<'_, '_>) -> Self {
        Self(error.into())
    }
}

impl From<AsSliceError> for Fault {
    fn from(error: AsSliceError) -> Self {
        Self(error.into())
    }
}

macro_rules! fault_from {
    ($text:ident: $($error:ty => $kind:ident),* $(,)?) => {$(
        impl From<$error> for Fault {
            fn from(error: $error) -> Self {
                Self::$kind($text(&error))
            }
        }
    )*};
}

fault_from!(with_advice: ExcitationError => config, SignalError => log, SimulationError => config);
fault_from!(
    in_full:
    HiddenError => config,
    ManipulatorError => config,
    ParamError => config,
    SignalPathError => config,
    SnapshotMismatch => shape,
    StateMismatch => shape,
);

impl From<RobotFileError> for Fault {
    fn from(error: RobotFileError) -> Self {
        match &error {
            RobotFileError::Read { path, source } if is_missing(source) => Self::no_config(in_full(&error), path),
            error => Self::config(in_full(error)),
        }
    }
}

impl From<ManipulatorFileError> for Fault {
    fn from(error: ManipulatorFileError) -> Self {
        match &error {
            ManipulatorFileError::Read { path, source } if is_missing(source) => Self::no_config(in_full(&error), path),
            error => Self::config(in_full(error)),
        }
    }
}

impl From<RecordingError> for Fault {
    fn from(error: RecordingError) -> Self {
        match &error {
            RecordingError::Missing { path } => Self::no_log(with_advice(&error), path),
            error => Self::log(with_advice(error)),
        }
    }
}

impl From<fric_log::log::LogError> for Fault {
    fn from(error: fric_log::log::LogError) -> Self {
        match error {
            fric_log::log::LogError::Recording(error) => error.into(),
            error => Self::log(with_advice(&error)),
        }
    }
}

impl From<TableError> for Fault {
    fn from(error: TableError) -> Self {
        match error {
            TableError::Recording(error) => error.into(),
            TableError::File { ref path, ref source } if is_missing(source) => Self::no_log(with_advice(&error), path),
            error => Self::log(with_advice(&error)),
        }
    }
}

fn is_missing(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::NotFound
}

impl From<fric_lab::fit::FitError> for Fault {
    fn from(error: fric_lab::fit::FitError) -> Self {
        let advice = error.advice(|reference| format!("reference=\"{}\"", reference.name()));
        Self::fit(advice.map_or_else(|| error.cause.clone(), |advice| format!("{}. {advice}", error.cause)))
    }
}

impl From<TimesApart> for Fault {
    fn from(apart: TimesApart) -> Self {
        Self::fit(format!("{}. {}", apart.cause(), TimesApart::ADVICE))
    }
}

impl From<NoHistogram> for Fault {
    fn from(error: NoHistogram) -> Self {
        Self(PyRuntimeError::new_err(error.to_string()))
    }
}

impl From<ContinuumError> for Fault {
    fn from(error: ContinuumError) -> Self {
        let text = with_advice(&error);
        match error {
            ContinuumError::OptionOutOfRange { .. }
            | ContinuumError::TooGreatTension { .. }
            | ContinuumError::Params(_)
            | ContinuumError::NotWithinRun { .. }
            | ContinuumError::NoGratings
            | ContinuumError::TravelTooLong { .. } => Self::config(text),
            ContinuumError::WrongCount { .. } => Self::shape(text),
            ContinuumError::TooFewLoads { .. }
            | ContinuumError::DeadGrating { .. }
            | ContinuumError::NoCoefficient(_) => Self::fit(text),
            _ => Self::log(text),
        }
    }
}

impl From<HysteresisError> for Fault {
    fn from(error: HysteresisError) -> Self {
        match error {
            HysteresisError::Robot(_) | HysteresisError::NoGeometry { .. } => Self::config(with_advice(&error)),
            _ => Self::log(with_advice(&error)),
        }
    }
}

impl From<output::OutputError> for Fault {
    fn from(error: output::OutputError) -> Self {
        match &error {
            output::OutputError::File { source, .. } => Self::output(format!("{error}: {}", reason(source))),
            output::OutputError::Exists { path } => {
                Self::output(format!("`{}` exists; choose another name, or replace it with force=True", path.display()))
            }
            error => Self::output(in_full(error)),
        }
    }
}

impl From<StoreError> for Fault {
    fn from(error: StoreError) -> Self {
        let advice = error.help().map_or_else(String::new, |advice| format!(". {advice}"));
        Self::output(format!("{error}: {}{advice}", reason(&error.source)))
    }
}

impl From<DiscoverError> for Fault {
    fn from(error: DiscoverError) -> Self {
        match error {
            DiscoverError::Fit(error) => error.into(),
            DiscoverError::Store(error) => error.into(),
        }
    }
}

impl From<WriteError> for Fault {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Output(error) => error.into(),
            error => Self::output(in_full(&error)),
        }
    }
}

impl From<AttachedRobotError> for Fault {
    fn from(error: AttachedRobotError) -> Self {
        match error {
            AttachedRobotError::Robot(error) => error.into(),
            error => Self::log(in_full(&error)),
        }
    }
}
