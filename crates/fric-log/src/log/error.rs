//! Errors of opening a log.

use std::path::PathBuf;

use miette::Diagnostic;
use thiserror::Error;

use crate::csv_log::CsvError;
use crate::recording::RecordingError;

/// The reason why a log cannot be opened.
#[derive(Debug, Diagnostic, Error)]
#[non_exhaustive]
pub enum LogError {
    /// The files cannot be opened as a recording of messages.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingError),
    /// The files cannot be opened as a table.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Csv(#[from] CsvError),
    /// Several files, which should be the parts of one log, are of different kinds.
    #[error("`{}` is CSV and `{}` is not, and several files are the parts of one log", csv.display(), other.display())]
    #[diagnostic(help("Name files of one kind, or each in a run of its own."))]
    Mixed {
        /// A CSV file.
        csv: PathBuf,
        /// A file of another kind.
        other: PathBuf,
    },
}
