//! Errors of opening a log.

use std::path::PathBuf;

use thiserror::Error;

use crate::csv_log::CsvError;
use crate::recording::RecordingError;

const APART: &str = "name files of one kind, or each in a run of its own";

/// The reason why a log cannot be opened.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LogError {
    /// The files cannot be opened as a recording of messages.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The files cannot be opened as a table.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// Several files, which should be the parts of one log, are of different kinds.
    #[error("`{}` is CSV and `{}` is not, and several files are the parts of one log; {APART}", csv.display(), other.display())]
    Mixed {
        /// A CSV file.
        csv: PathBuf,
        /// A file of another kind.
        other: PathBuf,
    },
}

impl LogError {
    /// Returns the advice that ends the error's sentence, if there is any.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Recording(error) => error.advice(),
            Self::Csv(error) => Some(error.advice()),
            Self::Mixed { .. } => Some(APART),
        }
    }
}
