//! Tables of numbers in named columns: CSV, or a topic of an MCAP log whose messages have fields of these names.
//!
//! They serve the runs of manipulators and load steps on a bench, where one row is one measurement. The caller knows the meaning of the columns. An
//! empty cell, `nan` and JSON's `null` are NaN; infinities are passed on. A whole table is held in memory, 8 bytes per number.
//!
//! In a log, the topic is the only one whose messages have any of the wanted fields. It may be on several channels; columns that the messages of one
//! lack are NaN there. If no messages have a `time_s` of their own, it is added in front: from `header.stamp`, else the log time, in seconds since
//! the first row.

mod csv_text;
mod error;
mod messages;

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

pub use error::TableError;

/// The time column.
pub const TIME_COLUMN: &str = "time_s";

/// The first bytes of an MCAP file.
const MCAP_MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n'];

/// Columns of equal length, each with its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NumberTable {
    /// Columns in the order of the file; for a log only the wanted ones. Names are unique.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Warnings, one sentence each.
    pub warnings: Vec<String>,
}

impl NumberTable {
    /// Reads a file of either kind.
    ///
    /// `wanted` are the fields to find in the messages of a log; of CSV all columns are read.
    ///
    /// # Errors
    /// Returns a [`TableError`] if the file cannot be read, has no row, or has one that is not a list of numbers as long as the header.
    pub fn read(path: &Path, wanted: &[String]) -> Result<Self, TableError> {
        let table = if is_mcap(path)? { messages::read(path, wanted) } else { csv_text::read(path) }?;
        if table.columns.first().is_none_or(|(_, numbers)| numbers.is_empty()) {
            return Err(TableError::Empty { path: path.to_owned() });
        }
        Ok(table)
    }
}

fn is_mcap(path: &Path) -> Result<bool, TableError> {
    let file_error = |source| TableError::File { path: path.to_owned(), source };
    // The path is checked first, because opening a pipe would wait for its writer, and a device may never end.
    let metadata = fs::metadata(path).map_err(file_error)?;
    if !metadata.is_file() && !metadata.is_dir() {
        let reason = "it is no regular file (a pipe or a device)";
        return Err(file_error(io::Error::new(ErrorKind::InvalidInput, reason)));
    }
    let mut start = [0; MCAP_MAGIC.len()];
    match File::open(path).and_then(|mut file| file.read_exact(&mut start)) {
        Ok(()) => Ok(start == MCAP_MAGIC),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(file_error(error)),
    }
}
