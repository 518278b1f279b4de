//! Tables as text with a header, in any [`Form`].

use std::path::Path;
use std::{fs, io};

use csv::{ErrorKind, StringRecord};

use super::{NumberTable, TableError};
use crate::csv_form::{Decimals, Form};

/// Number of bytes that contain the header and enough rows to tell where the table begins.
const BEGINNING_BYTES: usize = 1 << 18;

/// Greatest size of a table, bytes: an hour of a manipulator at 100 Hz.
const MOST_BYTES: u64 = 256 << 20;

/// Reads a regular file of at most [`MOST_BYTES`].
fn content(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = fs::metadata(path)?;
    if metadata.is_file() && metadata.len() > MOST_BYTES {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("it has more than {} MiB", MOST_BYTES >> 20)));
    }
    fs::read(path)
}

/// Reads all columns. Blanks around cells and a byte order mark are ignored.
///
/// A last row without a line end is left out, with a warning, even if it has all its cells, because its last number may be incomplete.
pub(super) fn read(path: &Path) -> Result<NumberTable, TableError> {
    let text = content(path).map_err(|source| TableError::File { path: path.to_owned(), source })?;
    // UTF-16, or no text at all.
    if text.contains(&0) {
        return Err(TableError::NotText { path: path.to_owned(), line: 1 });
    }
    let (whole, is_cut) = whole_lines(&text);
    let Some(form) = Form::find(whole.get(..BEGINNING_BYTES).unwrap_or(whole)) else {
        return Err(TableError::Empty { path: path.to_owned() });
    };
    if form.lacks_header {
        return Err(TableError::NoHeader { path: path.to_owned(), line: form.first_line });
    }
    if let (Some(text), Some(column)) = (form.units.first(), form.names.first()) {
        let (line, column, text) = (form.first_line - 1, column.clone(), text.clone());
        return Err(TableError::Cell { path: path.to_owned(), line, column, text });
    }
    let rows = usize::try_from(form.rows_at).ok().and_then(|at| whole.get(at..)).unwrap_or_default();
    let mut reader = form.reader(rows);
    let line_of = |position: Option<&csv::Position>| form.first_line - 1 + position.map_or(1, csv::Position::line);
    let mut columns = empty_columns(path, &form.names)?;
    let (mut decimals, mut row) = (Decimals::default(), StringRecord::new());
    while reader.read_record(&mut row).map_err(|error| refusal(path, line_of(error.position()), error))? {
        let line = line_of(row.position());
        if row.len() != columns.len() {
            let (found, expected) = (row.len() as u64, columns.len() as u64);
            return Err(TableError::Length { path: path.to_owned(), line, found, expected });
        }
        for ((name, numbers), text) in columns.iter_mut().zip(&row) {
            numbers.push(decimals.number(text).ok_or_else(|| TableError::Cell {
                path: path.to_owned(),
                line,
                column: name.clone(),
                text: text.to_owned(),
            })?);
        }
    }
    if is_cut && columns.first().is_some_and(|(_, numbers)| numbers.is_empty()) {
        return Err(TableError::CutOff { path: path.to_owned() });
    }
    let warning = || {
        format!(
            "`{}` is cut off: its last line has no line end and is left out; if that line is whole, put a line end behind it",
            path.display()
        )
    };
    Ok(NumberTable { columns, warnings: is_cut.then(warning).into_iter().collect() })
}

/// Returns the header and the complete lines, and whether anything followed them.
fn whole_lines(text: &[u8]) -> (&[u8], bool) {
    let end = text.iter().rposition(|byte| matches!(byte, b'\n' | b'\r'));
    match end.and_then(|end| text.split_at_checked(end + 1)) {
        Some((whole, rest)) => (whole, !rest.trim_ascii().is_empty()),
        None => (text, false),
    }
}

/// Returns a column without numbers for each name.
fn empty_columns(path: &Path, names: &[String]) -> Result<Vec<(String, Vec<f64>)>, TableError> {
    let is_repeated = |(place, name): (usize, &String)| names.iter().take(place).any(|other| other == name);
    match names.iter().enumerate().find(|entry| is_repeated(*entry)) {
        Some((_, column)) => Err(TableError::Repeated { path: path.to_owned(), column: column.clone() }),
        None => Ok(names.iter().map(|name| (name.clone(), Vec::new())).collect()),
    }
}

fn refusal(path: &Path, line: u64, error: csv::Error) -> TableError {
    let path = path.to_owned();
    match error.into_kind() {
        ErrorKind::Io(source) => TableError::File { path, source },
        // The text is not UTF-8; nothing is deserialised or sought, and rows may be of any length.
        _ => TableError::NotText { path, line },
    }
}
