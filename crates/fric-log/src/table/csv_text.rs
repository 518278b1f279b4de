//! Tables as text, RFC 4180, with a header.

use std::fs;
use std::path::Path;

use csv::{ErrorKind, ReaderBuilder, StringRecord, Trim};

use super::{NumberTable, TableError};

/// Reads all columns. Blanks around cells and a byte order mark are ignored.
///
/// A last row without a line end is left out, with a warning, even if it has all its cells, because its last number may be incomplete.
pub(super) fn read(path: &Path) -> Result<NumberTable, TableError> {
    let refused = |error: csv::Error| refusal(path, error);
    let text = fs::read(path).map_err(|source| TableError::File { path: path.to_owned(), source })?;
    let (whole, is_cut) = whole_lines(&text);
    let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(whole);
    let names = header(path, reader.headers().map_err(refused)?)?;
    let mut columns: Vec<(String, Vec<f64>)> = names.into_iter().map(|name| (name, Vec::new())).collect();
    let mut row = StringRecord::new();
    while reader.read_record(&mut row).map_err(refused)? {
        let line = row.position().map_or(0, csv::Position::line);
        for ((name, numbers), text) in columns.iter_mut().zip(&row) {
            numbers.push(number(text).ok_or_else(|| TableError::Cell {
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

fn header(path: &Path, row: &StringRecord) -> Result<Vec<String>, TableError> {
    let names: Vec<String> = row.iter().map(|name| name.trim_start_matches('\u{feff}').trim().to_owned()).collect();
    if let [only] = names.as_slice()
        && let Some(separator) = [';', '\t'].into_iter().find(|separator| only.contains(*separator))
    {
        return Err(TableError::Separator { path: path.to_owned(), separator });
    }
    let is_repeated = |(place, name): (usize, &String)| names.iter().take(place).any(|other| other == name);
    match names.iter().enumerate().find(|entry| is_repeated(*entry)) {
        Some((_, column)) => Err(TableError::Repeated { path: path.to_owned(), column: column.clone() }),
        None => Ok(names),
    }
}

fn number(text: &str) -> Option<f64> {
    if text.is_empty() { Some(f64::NAN) } else { text.parse().ok() }
}

fn refusal(path: &Path, error: csv::Error) -> TableError {
    let path = path.to_owned();
    let line = error.position().map_or(1, csv::Position::line);
    match error.into_kind() {
        ErrorKind::Io(source) => TableError::File { path, source },
        ErrorKind::UnequalLengths { expected_len, len, .. } => {
            TableError::Length { path, line, found: len, expected: expected_len }
        }
        // The text is not UTF-8; nothing is deserialised or sought.
        _ => TableError::NotText { path, line },
    }
}
