//! Tables as text, RFC 4180, with a header.

use std::path::Path;

use csv::{ErrorKind, ReaderBuilder, StringRecord, Trim};

use super::{NumberTable, TableError};

/// Reads all columns. Blanks around cells and a byte order mark do not matter.
pub(super) fn read(path: &Path) -> Result<NumberTable, TableError> {
    let refused = |error: csv::Error| refusal(path, error);
    let mut reader = ReaderBuilder::new().trim(Trim::All).from_path(path).map_err(refused)?;
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
    Ok(NumberTable { columns, warnings: Vec::new() })
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
        // Text that is no UTF-8; nothing is deserialised or sought.
        _ => TableError::NotText { path, line },
    }
}
