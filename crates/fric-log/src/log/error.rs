//! Why a log cannot be opened.

use std::path::PathBuf;

use thiserror::Error;

use crate::csv_log::CsvError;
use crate::recording::RecordingError;

const APART: &str = "name files of one kind, or each in a run of its own";

/// Why a log cannot be opened.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LogError {
    /// As a recording of messages.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// As a table.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// Several files are the parts of one log, but not of one kind.
    #[error("`{}` is CSV and `{}` is not, and several files are the parts of one log; {APART}", csv.display(), other.display())]
    Mixed {
        /// The one.
        csv: PathBuf,
        /// The other.
        other: PathBuf,
    },
}

impl LogError {
    /// What to do: the words that end the error's sentence, where it has any.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Recording(error) => error.advice(),
            Self::Csv(error) => Some(error.advice()),
            Self::Mixed { .. } => Some(APART),
        }
    }
}
