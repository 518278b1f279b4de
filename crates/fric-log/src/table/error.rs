//! Errors of tables.

use std::io;
use std::path::PathBuf;

use miette::Diagnostic;
use thiserror::Error;

use crate::recording::RecordingError;
use crate::schema::SchemaError;

/// The reason why a table was refused.
#[derive(Debug, Diagnostic, Error)]
#[non_exhaustive]
pub enum TableError {
    /// The operating system cannot read the file.
    #[error("cannot read {}: {source}", path.display())]
    #[diagnostic(help("Check the path."))]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// The file is empty.
    #[error("{} has no row of numbers below its header", path.display())]
    #[diagnostic(help("Record again."))]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Its only row has no line end, so its last number may be incomplete.
    #[error("{} has no whole row of numbers below its header: its last line has no line end and is left out", path.display())]
    #[diagnostic(help("If that line is whole, put a line end behind it."))]
    CutOff {
        /// The file.
        path: PathBuf,
    },
    /// The file is not text.
    #[error("{} is neither CSV nor MCAP: line {line} is no UTF-8 text", path.display())]
    #[diagnostic(help("Name another file."))]
    NotText {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
    },
    /// The file begins with numbers instead of a header.
    #[error("{}, line {line}: there are numbers where the names of the columns should be",
        path.display())]
    #[diagnostic(help("Put a line with the names in front."))]
    NoHeader {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
    },
    /// A column occurs twice.
    #[error("{}: column `{column}` stands there twice", path.display())]
    #[diagnostic(help("Take one of the two out."))]
    Repeated {
        /// The file.
        path: PathBuf,
        /// Its name.
        column: String,
    },
    /// A row has too many or too few cells.
    #[error("{}, line {line}: {found} cells under a header of {expected}", path.display())]
    #[diagnostic(help("Complete the row or take it out."))]
    Length {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// Number of cells in the row.
        found: u64,
        /// Number of columns in the header.
        expected: u64,
    },
    /// A cell is not a number.
    #[error("{}, line {line}, column `{column}`: `{text}` is no number", path.display())]
    #[diagnostic(help("Write digits, without thousands separators, or leave the cell empty where there is no value."))]
    Cell {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// The column.
        column: String,
        /// Its content.
        text: String,
    },
    /// A log has none of the wanted fields.
    #[error("{}: no topic has messages with a field `{example}` or another column of a run (topics: {found})", path.display())]
    #[diagnostic(help("Record one message a sample, with the columns as its fields."))]
    NoTopic {
        /// The file.
        path: PathBuf,
        /// A wanted field.
        example: String,
        /// The existing topics, and unreadable parts of the file.
        found: String,
    },
    /// A log has only invalid messages with the wanted fields.
    #[error("{}: no message on `{topic}` can be used ({problem})", path.display())]
    #[diagnostic(help("Record again."))]
    NoUsableMessage {
        /// The file.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// The problem of the first one.
        problem: String,
    },
    /// Several topics have wanted fields.
    #[error("{}: columns of a run are on several topics ({topics})", path.display())]
    #[diagnostic(help("Put them into the messages of one."))]
    SeveralTopics {
        /// The file.
        path: PathBuf,
        /// Their names.
        topics: String,
    },
    /// The log cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingError),
    /// A wanted field is not a number.
    #[error("{}, topic `{topic}`: {source}", path.display())]
    #[diagnostic(help("Record numbers."))]
    Schema {
        /// The file.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// The problem.
        source: Box<SchemaError>,
    },
}
