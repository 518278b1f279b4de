//! Numbers and tables for people.

use comfy_table::{CellAlignment, Table, presets};

/// A table with a header; all columns but the first `left` are aligned right.
#[must_use]
pub fn table(header: &[&str], left: usize, rows: &[impl AsRef<[String]>]) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header);
    for row in rows {
        table.add_row(row.as_ref());
    }
    for column in table.column_iter_mut().skip(left) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let lines = table.lines().map(|line| line.trim_end().to_owned() + "\n");
    lines.collect()
}

/// A coordinate to the millimetre, without a minus before a zero.
#[must_use]
pub fn to_millimetre(part_m: f64) -> f64 {
    (part_m * 1e3).round() / 1e3 + 0.0
}
