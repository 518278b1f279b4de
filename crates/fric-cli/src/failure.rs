//! Why a command stopped, for people: one line with the cause, one with what to do.

use std::error::Error;
use std::fmt::Display;
use std::io::{self, Write as _};

use fric_log::write::WriteError;

use crate::output;

/// What `main` turns into an exit code.
#[derive(Debug)]
pub struct Failure {
    cause: String,
    advice: Option<String>,
    is_usage: bool,
}

/// Result of a command.
pub type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// The work failed: exit code 1.
    pub fn new(cause: impl Display) -> Self {
        Self { cause: cause.to_string(), advice: None, is_usage: false }
    }

    /// The command line is wrong: exit code 2.
    pub fn usage(cause: impl Display) -> Self {
        Self { is_usage: true, ..Self::new(cause) }
    }

    /// The work failed, for a reason that ends with what to do after a semicolon, as the libraries word it.
    fn in_two_lines(text: &str) -> Self {
        match text.rsplit_once("; ") {
            Some((cause, advice)) => Self::new(cause).advise(advice),
            None => Self::new(text),
        }
    }

    /// Adds what to do.
    pub fn advise(mut self, advice: impl Display) -> Self {
        self.advice = Some(advice.to_string());
        self
    }

    pub fn exit_code(&self) -> u8 {
        if self.is_usage { 2 } else { 1 }
    }

    pub fn print(&self) {
        let mut stderr = std::io::stderr().lock();
        // There is nowhere left to report a broken stderr to.
        let _ = writeln!(stderr, "error: {}", self.cause);
        if let Some(advice) = &self.advice {
            let _ = writeln!(stderr, "  {advice}");
        }
    }
}

/// What an error says, and what its sources add.
fn in_full(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(error) = source {
        let reason = error.to_string();
        if !text.contains(&reason) {
            text = format!("{text}: {reason}");
        }
        source = error.source();
    }
    text
}

/// What the operating system said, without the name of a temporary file that means nothing to people.
pub fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" at path ").next().map_or_else(String::new, ToOwned::to_owned)
}

macro_rules! failure_from {
    ($($error:ty),* $(,)?) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::in_two_lines(&in_full(&error))
            }
        }
    )*};
}

failure_from!(
    fric_core::ParamError,
    fric_core::robot::file::RobotFileError,
    fric_log::recording::RecordingError,
    fric_log::signals::SignalError,
);

impl From<WriteError> for Failure {
    /// In the words of [`crate::output`], so that all outputs fail alike.
    fn from(error: WriteError) -> Self {
        match &error {
            WriteError::Exists { path } => output::exists(path),
            WriteError::Input { path, .. } => output::is_input(path),
            WriteError::File { path, source } => output::unwritable(path, source),
            _ => Self::new(in_full(&error)),
        }
    }
}
