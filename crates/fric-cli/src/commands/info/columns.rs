//! The columns of a log of rows, and their signals.

use fric_core::text_file::printable;
use fric_lab::text::table;
use fric_log::log::Log;
use serde::Serialize;

use crate::model::Model;

/// A column of the header.
#[derive(Debug, Serialize)]
pub struct ColumnResult {
    column: String,
    /// Its use, in the words of `[log.columns]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    signal: Option<String>,
    /// Factor that converts its numbers to the signal's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    factor: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    offset: Option<f64>,
}

impl ColumnResult {
    /// Returns the cells for people.
    pub fn cells(&self) -> [String; 4] {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let signal = self.signal.clone().unwrap_or_else(|| "–".to_owned());
        [printable(&self.column), signal, number(self.factor), number(self.offset)]
    }
}

/// Returns the columns of a log that have a name, which a separator at the end of the lines makes without; empty for a log of messages.
pub fn results(log: &Log, model: Option<&Model>) -> Vec<ColumnResult> {
    let stated = model.map(|model| &model.robot.options().log.columns);
    let column = |name: &String| {
        let entry = stated.and_then(|columns| columns.iter().find(|(_, table)| table.column.trim() == name));
        let by_default = model.is_some_and(|model| model.robot.is_log_column(name));
        ColumnResult {
            column: name.clone(),
            signal: entry.map(|(key, _)| key.clone()).or_else(|| by_default.then(|| name.clone())),
            factor: entry.map(|(_, table)| table.factor),
            offset: entry.map(|(_, table)| table.offset),
        }
    };
    log.column_names().unwrap_or_default().iter().filter(|name| !name.is_empty()).map(column).collect()
}

/// Returns a table for people.
pub fn table_of(columns: &[ColumnResult]) -> String {
    let rows: Vec<_> = columns.iter().map(ColumnResult::cells).collect();
    table(&["column", "signal", "factor", "offset"], 2, &rows)
}
