//! Errors of CSV logs.

use std::io;
use std::path::PathBuf;

use fric_core::robot::nearest_name;
use miette::Diagnostic;
use thiserror::Error;

use super::units::TimeUnit;

/// The reason why a CSV log gives no rows.
#[derive(Debug, Diagnostic, Error)]
#[non_exhaustive]
pub enum CsvError {
    /// The operating system cannot read the file.
    #[error("`{}` could not be read", path.display())]
    #[diagnostic(help("Check the disk, or copy the file and try again."))]
    Read {
        /// The file.
        path: PathBuf,
        /// Message of the operating system.
        source: io::Error,
    },
    /// The text has another encoding.
    #[error("`{}` is text in UTF-16", path.display())]
    #[diagnostic(help("Save it as CSV in UTF-8."))]
    NotUtf8 {
        /// The file.
        path: PathBuf,
    },
    /// The file begins with numbers instead of a header.
    #[error("`{}`, line {line}: there are numbers where the names of the columns should be", path.display())]
    #[diagnostic(help("Put a line with the names of the columns in front."))]
    NoHeader {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
    },
    /// The names of the columns are longer than what is read of them.
    #[error("`{}`: the line with the names of the columns has more than {} KiB", path.display(), most_bytes >> 10)]
    #[diagnostic(help("Leave out the columns that are no signals of the robot."))]
    LongHeader {
        /// The file.
        path: PathBuf,
        /// What is read of the beginning, bytes.
        most_bytes: u64,
    },
    /// A line is longer than one of signals.
    #[error("`{}` has a line of more than {} MiB", path.display(), most_bytes >> 20)]
    #[diagnostic(help("Leave out the columns that are no signals of the robot."))]
    LongLine {
        /// The file.
        path: PathBuf,
        /// The greatest length of a line, bytes.
        most_bytes: usize,
    },
    /// A required signal has no column.
    #[error("`{}` has no column `{wanted}`; it has {}",
        path.display(), listed(columns))]
    #[diagnostic(help(
        "Name the right columns under `[log.columns]` in the robot file, such as \"cable1.force_n\" = {{ column = \"Load cell 1 [kg]\", factor = 9.80665 }}."
    ))]
    Missing {
        /// The file.
        path: PathBuf,
        /// The wanted column.
        wanted: String,
        /// The existing columns.
        columns: Vec<String>,
    },
    /// The robot file names a column that does not exist.
    #[error("`{}` has no column `{column}`, which the robot file names for `{key}` under `[log.columns]`; {}it has {}",
        path.display(), did_you_mean(column, columns), listed(columns))]
    #[diagnostic(help("Write the name there as it stands in the header."))]
    Misnamed {
        /// The file.
        path: PathBuf,
        /// The signal.
        key: String,
        /// The column that the robot file names.
        column: String,
        /// The existing columns.
        columns: Vec<String>,
    },
    /// Nothing separates the cells.
    #[error("`{}` has one column alone, `{name}`", path.display())]
    #[diagnostic(help(
        "Separate the cells by commas, semicolons, tabs or blanks, as many in each row as there are names."
    ))]
    OneColumn {
        /// The file.
        path: PathBuf,
        /// Its name.
        name: String,
    },
    /// Two columns have the name of a signal.
    #[error("`{}`: the column `{column}` stands there twice", path.display())]
    #[diagnostic(help("Take one of the two out, or give it another name."))]
    Repeated {
        /// The file.
        path: PathBuf,
        /// Its name.
        column: String,
    },
    /// A cell is not a number.
    #[error("`{}`, line {line}, column `{column}`: `{text}` is no number", path.display())]
    #[diagnostic(help("{}", cell_advice(column, text)))]
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
    /// A date stands in a column with a factor.
    #[error("`{}`, line {line}, column `{column}`: `{text}` is a date or a time of day", path.display())]
    #[diagnostic(help(
        "A date takes no factor and no offset: remove those of `time_s` under `[log.columns]` in the robot file."
    ))]
    DateWithFactor {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// The column.
        column: String,
        /// Its content.
        text: String,
    },
    /// A time is too large.
    #[error("`{}`, line {line}, column `{column}`: `{text}` is no time in seconds", path.display())]
    #[diagnostic(help("{}", time_advice(*unit)))]
    Time {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// The column.
        column: String,
        /// Its content.
        text: String,
        /// The unit that it looks like.
        unit: Option<TimeUnit>,
    },
    /// There are no rows below the header.
    #[error("`{}` has no whole row of numbers below its header", path.display())]
    #[diagnostic(help("Name a complete copy of it, or record again."))]
    NoRow {
        /// The file.
        path: PathBuf,
    },
    /// No row is usable.
    #[error("`{}` has no row that can be used; the first: {problem}", path.display())]
    #[diagnostic(help(
        "Give each row as many cells as the header; numbers with decimal commas need semicolons or tabs between them."
    ))]
    NoUsableRow {
        /// The file.
        path: PathBuf,
        /// The problem of the first one.
        problem: String,
    },
    /// No row has a force and a length.
    #[error("`{}`: no row has a number in a column of sensor forces or lengths", path.display())]
    #[diagnostic(help("Name a complete copy of it, or record again."))]
    NoNumber {
        /// The file.
        path: PathBuf,
    },
}

/// Maximum number of columns named in an error.
const MOST_LISTED: usize = 10;

fn time_advice(unit: Option<TimeUnit>) -> String {
    unit.map_or_else(
        || "Give the column of `time_s` the `factor` to seconds under `[log.columns]` in the robot file.".to_owned(),
        |unit| format!("If {}.", unit.advice()),
    )
}

fn cell_advice(column: &str, text: &str) -> &'static str {
    let has_digits = text.contains(|character: char| character.is_ascii_digit());
    let is_date = has_digits && (text.contains(['/', ':']) || text.matches('-').count() > 1);
    if text == column {
        "The header stands there again: give each recording a file of its own."
    } else if is_date {
        "Write a date with the year first, such as 2026-05-03T12:34:56.250, or as 03.05.2026 12:34:56, and hours from 0 to 23; \
         with slashes, day and month are not told apart."
    } else {
        "Write digits, without thousands separators, or leave the cell empty where there is no value."
    }
}

fn did_you_mean(column: &str, columns: &[String]) -> String {
    let nearest = nearest_name(column, columns.iter().map(String::as_str));
    nearest.map_or_else(String::new, |nearest| format!("did you mean `{nearest}`? "))
}

fn listed(columns: &[String]) -> String {
    let names: Vec<String> = columns.iter().take(MOST_LISTED).map(|name| format!("`{name}`")).collect();
    let more = columns.len().saturating_sub(MOST_LISTED);
    let names = names.join(", ");
    if more == 0 { names } else { format!("{names} and {more} more") }
}
