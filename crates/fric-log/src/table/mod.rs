//! Tables of numbers in named columns: CSV, or a topic of an MCAP log whose messages have fields of these names.
//!
//! For the runs of manipulators and for load steps on a bench, where one row is one measurement. What the columns mean is the
//! caller's. An empty cell, `nan` and JSON's `null` are NaN; infinities pass through. A whole table is held in memory, 8 bytes a number.
//!
//! In a log, the topic is the one whose messages have any of the wanted fields; it has to be one alone. It may be on several
//! channels; what the messages of one do not have of the columns is NaN there. Where no messages have a `time_s` of their own
//! it is put in front: from `header.stamp`, else the log time, in seconds since the first row.

mod csv_text;
mod error;
mod messages;

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

pub use error::TableError;

/// The column of times.
pub const TIME_COLUMN: &str = "time_s";

/// What an MCAP file begins with.
const MCAP_MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n'];

/// Columns of equal length, each with its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NumberTable {
    /// In the order of the file; of a log only those that were wanted. No name stands twice.
    pub columns: Vec<(String, Vec<f64>)>,
    /// What was out of the ordinary, a sentence each.
    pub warnings: Vec<String>,
}

impl NumberTable {
    /// Reads a file, whichever of the two it is.
    ///
    /// `wanted` are the fields that are looked for in the messages of a log; of CSV all columns are read.
    ///
    /// # Errors
    /// [`TableError`] if the file cannot be read, has no row, or one that is no list of numbers as long as the header.
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
    // By name first: opening a pipe would wait for its writer, and a device may never end.
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
