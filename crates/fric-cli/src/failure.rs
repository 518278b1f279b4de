//! The reason why a command stopped, for people: one line with the cause, one with what to do.

use std::fmt::Display;
use std::io::{self, ErrorKind};
use std::path::Path;

use fric_core::ParamError;
use fric_core::robot::file::RobotFileError;
use fric_lab::discover::DiscoverError;
use fric_lab::excite::ExcitationError;
use fric_lab::fit::{FitError, StoreError};
use fric_lab::hysteresis::HysteresisError;
use fric_lab::simulate::SimulationError;
use fric_log::log::LogError;
use fric_log::output::{OutputError, directory_of};
use fric_log::recording::RecordingError;
use fric_log::signals::{SignalError, TimesApart};
use fric_log::table::TableError;
use fric_log::write::WriteError;
use fric_log::{in_full, reason};
use fric_tendon::file::ManipulatorFileError;
use fric_tendon_lab::ContinuumError;
use fric_work::replay::NoHistogram;
use miette::Diagnostic;

use crate::terminal::{self, Label};

/// The failure of a command, which `main` converts to an exit code.
#[derive(Debug)]
pub struct Failure {
    cause: String,
    advice: Option<String>,
    is_usage: bool,
}

/// The result of a command.
pub type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// Creates a failure of the work: exit code 1.
    pub fn new(cause: impl Display) -> Self {
        Self { cause: cause.to_string(), advice: None, is_usage: false }
    }

    /// Creates a failure of the command line: exit code 2.
    pub fn usage(cause: impl Display) -> Self {
        Self { is_usage: true, ..Self::new(cause) }
    }

    /// Creates a failure of the work from an error with or without advice.
    fn of(error: &impl Diagnostic) -> Self {
        Self { advice: error.help().map(|advice| advice.to_string()), ..Self::new(in_full(error)) }
    }

    /// Adds what to do.
    pub fn advise(mut self, advice: impl Display) -> Self {
        self.advice = Some(advice.to_string());
        self
    }

    /// Makes it a failure of the command line, at an option.
    pub fn of_option(self, option: &str) -> Self {
        Self { cause: format!("{option}: {}", self.cause), is_usage: true, ..self }
    }

    /// Adds the file.
    pub fn in_file(mut self, path: &Path) -> Self {
        self.cause = format!("{}: {}", path.display(), self.cause);
        self
    }

    /// Adds which outputs were written nevertheless.
    pub fn although_written(mut self, paths: &[String]) -> Self {
        if !paths.is_empty() {
            self.cause = format!("{}; written before: {}", self.cause, paths.join(", "));
        }
        self
    }

    pub fn exit_code(&self) -> u8 {
        if self.is_usage { 2 } else { 1 }
    }

    pub fn print(&self) {
        terminal::say(Label::Error, &self.cause, self.advice.as_deref());
    }
}

macro_rules! failure_of {
    ($($error:ty),* $(,)?) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::of(&error)
            }
        }
    )*};
}

failure_of!(
    ContinuumError,
    ExcitationError,
    HysteresisError,
    LogError,
    RecordingError,
    SignalError,
    SimulationError,
    TableError,
);

impl From<TimesApart> for Failure {
    fn from(apart: TimesApart) -> Self {
        Self::new(apart.cause()).advise(TimesApart::ADVICE)
    }
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        let advice = error.advice(|reference| format!("--reference {}", reference.name()));
        let failure = Self::new(error);
        match advice {
            Some(advice) => failure.advise(advice),
            None => failure,
        }
    }
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        Self { cause: format!("{error}: {}", reason(&error.source)), ..Self::of(&error) }
    }
}

impl From<NoHistogram> for Failure {
    fn from(error: NoHistogram) -> Self {
        Self::new(error)
    }
}

impl From<DiscoverError> for Failure {
    fn from(error: DiscoverError) -> Self {
        match error {
            DiscoverError::Fit(error) => error.into(),
            DiscoverError::Store(error) => error.into(),
        }
    }
}

impl From<ManipulatorFileError> for Failure {
    fn from(error: ManipulatorFileError) -> Self {
        match error {
            ManipulatorFileError::Read { .. } => Self::new(error).advise("Check the path."),
            error => Self::new(error).advise("Correct the manipulator file, or name another one with --model."),
        }
    }
}

impl From<RobotFileError> for Failure {
    fn from(error: RobotFileError) -> Self {
        match error {
            RobotFileError::Read { .. } => Self::new(error).advise("Check the path."),
            error => Self::new(error).advise("Correct the robot file, or name another one with --model."),
        }
    }
}

impl From<ParamError> for Failure {
    fn from(error: ParamError) -> Self {
        Self::new(error).advise("Change it in the robot file.")
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::Exists { path } => Self::new(format!("{} exists already", path.display()))
                .advise("Name another output file, or replace it with --force."),
            OutputError::NotRegular { path } => {
                let failure = Failure::new(format!("{} is no regular file, and is never replaced", path.display()));
                if STREAMS.iter().any(|stream| path == Path::new(stream)) {
                    failure.advise("Name another output file; only JSON goes to stdout, with `--json -`.")
                } else {
                    failure.advise("Name another output file.")
                }
            }
            OutputError::Input { path, .. } => {
                Self::new(format!("{} is an input of this command and would be overwritten", path.display()))
                    .advise("Name another output file.")
            }
            OutputError::File { path, source } => unwritable(&path, &source),
            _ => Self::new(in_full(&error)),
        }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Output(error) => error.into(),
            WriteError::EarlyStamp { .. } => Self::new(error).advise("Replay it without -o."),
            error => Self::new(in_full(&error)),
        }
    }
}

/// The names of a process's streams.
const STREAMS: [&str; 4] = ["/dev/stdout", "/dev/stderr", "/dev/fd/1", "/dev/fd/2"];

/// Creates the failure of an output that the operating system refuses.
fn unwritable(path: &Path, error: &io::Error) -> Failure {
    let failure = Failure::new(format!("cannot write {}: {}", path.display(), reason(error)));
    match error.kind() {
        ErrorKind::IsADirectory => {
            failure.advise(format!("Name a file in it, such as {}.", path.join("result").display()))
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            failure.advise("Make some space free, or name a file on another disk.")
        }
        ErrorKind::NotFound
        | ErrorKind::NotADirectory
        | ErrorKind::PermissionDenied
        | ErrorKind::ReadOnlyFilesystem
        | ErrorKind::InvalidFilename => {
            failure.advise(format!("Check that the directory {} exists and is writable.", directory_of(path).display()))
        }
        _ => failure.advise("Try again, or name a file on another disk."),
    }
}
