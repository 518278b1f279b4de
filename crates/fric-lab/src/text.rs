//! Formats numbers and tables for people.

use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table, Width, presets};

/// Returns a table with a header. All columns but the first `left` are right-aligned. A line break in a heading makes the header two lines high.
#[must_use]
pub fn table(header: &[&str], left: usize, rows: &[impl AsRef<[String]>]) -> String {
    lines_of(&aligned(header, left, rows))
}

/// Least width of the last column of a [`table_with_text`].
const LEAST_TEXT: u16 = 24;

/// Returns the same with a text in the last column, which is left-aligned and wrapped so that the table is at most [`WIDTH`] wide. If it would be
/// narrower than 24 characters, the widest of the other columns is wrapped too.
#[must_use]
pub fn table_with_text(header: &[&str], left: usize, rows: &[impl AsRef<[String]>]) -> String {
    let mut table = aligned(header, left, rows);
    let width = u16::try_from(WIDTH).unwrap_or(u16::MAX);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(width);
    let last = header.len().saturating_sub(1);
    // Each column has a space on either side.
    let widths: Vec<u16> = table.column_max_content_widths().iter().map(|content| content.saturating_add(2)).collect();
    let others = widths.get(..last).unwrap_or_default();
    let surplus = others.iter().fold(LEAST_TEXT, |sum, width| sum.saturating_add(*width)).saturating_sub(width);
    let widest = others.iter().enumerate().max_by_key(|(_, width)| **width).map(|(place, _)| place);
    for (place, column) in table.column_iter_mut().enumerate() {
        if place == last {
            column.set_cell_alignment(CellAlignment::Left);
        } else if surplus > 0 && Some(place) == widest {
            let narrowed = widths.get(place).map_or(0, |width| width.saturating_sub(surplus)).max(LEAST_TEXT);
            column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(narrowed)));
        } else {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    lines_of(&table)
}

fn aligned(header: &[&str], left: usize, rows: &[impl AsRef<[String]>]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header);
    for row in rows {
        table.add_row(row.as_ref());
    }
    for column in table.column_iter_mut().skip(left) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn lines_of(table: &Table) -> String {
    let lines = table.lines().map(|line| line.trim_end().to_owned() + "\n");
    lines.collect()
}

/// Returns a coordinate rounded to the millimetre, without a negative zero.
#[must_use]
pub fn to_millimetre(part_m: f64) -> f64 {
    (part_m * 1e3).round() / 1e3 + 0.0
}

/// Formats a number without a negative zero.
#[must_use]
pub fn number(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(magnitude) if magnitude.chars().all(|digit| matches!(digit, '0' | '.')) => magnitude.to_owned(),
        _ => text,
    }
}

/// Returns the number of decimals that show two digits of an error.
#[must_use]
pub fn digits_of(error: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0 and 12")]
    let digits = (1.0 - error.log10().floor()).clamp(0.0, 12.0) as usize;
    digits
}

/// Formats a standard error with two significant digits, without an exponent if that is legible.
#[must_use]
pub fn plain(error: f64) -> String {
    if (1e-7..1e7).contains(&error) { number(error, digits_of(error)) } else { format!("{error:.1e}") }
}

/// Formats a value with its half interval, in a unit that suits its size; a unit of `1` is omitted.
///
/// ```
/// use fric_lab::text::quantity;
/// assert_eq!(quantity(0.006_104, Some(0.000_11), "s"), "6.10 ± 0.11 ms");
/// assert_eq!(quantity(0.48, Some(0.021), "1"), "0.480 ± 0.021");
/// assert_eq!(quantity(1010.0, None, "N/m"), "1.01 N/mm");
/// ```
#[must_use]
pub fn quantity(value: f64, half_interval: Option<f64>, unit: &str) -> String {
    let (factor, unit) = scaled_unit(value, unit);
    let value = value * factor;
    let text = match half_interval.map(|half| half * factor).filter(|half| half.is_finite() && *half > 0.0) {
        Some(half) => format!("{} ± {}", number(value, digits_of(half)), plain(half)),
        None => significant(value),
    };
    if unit == "1" { text } else { format!("{text} {unit}") }
}

/// Returns the factor to, and the name of, the unit in which a value is easy to read.
#[must_use]
pub fn scaled_unit(value: f64, unit: &str) -> (f64, &str) {
    let small = value.abs() < 0.1;
    match unit {
        "s" if small => (1e3, "ms"),
        "m" if value.abs() > 0.0 && value.abs() < 1e-4 => (1e6, "µm"),
        "m" if small => (1e3, "mm"),
        "m/s" if small => (1e3, "mm/s"),
        "kg" if small => (1e3, "g"),
        "N" | "N/s" if value.abs() < 1e-3 => (1e3, if unit == "N" { "mN" } else { "mN/s" }),
        "m/N" => (1e6, "µm/N"),
        "N/m" if value.abs() >= 100.0 => (1e-3, "N/mm"),
        _ => (1.0, unit),
    }
}

/// Formats three significant digits, without an exponent if that is legible.
#[must_use]
pub fn significant(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude > 0.0 && !(1e-5..1e6).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let digits = if magnitude > 0.0 { digits_of(magnitude) + 1 } else { 0 };
    let text = number(value, digits);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Formats a duration in the unit that suits its size.
///
/// ```
/// use fric_lab::text::duration;
/// assert_eq!([410, 31_599, 2_500_000].map(duration), ["0.41 µs", "31.6 µs", "2.50 ms"]);
/// ```
#[must_use]
pub fn duration(nanos: u64) -> String {
    #[expect(clippy::cast_precision_loss, reason = "for people")]
    let nanos = nanos as f64;
    let (value, unit) = match nanos {
        _ if nanos < 1e6 => (nanos * 1e-3, "µs"),
        _ if nanos < 1e9 => (nanos * 1e-6, "ms"),
        _ => (nanos * 1e-9, "s"),
    };
    format!("{} {unit}", number(value, if value < 10.0 { 2 } else { 1 }))
}

/// Joins names to one phrase.
#[must_use]
pub fn listed(names: &[impl AsRef<str>]) -> String {
    match names {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [first @ .., last] => {
            let first: Vec<&str> = first.iter().map(AsRef::as_ref).collect();
            format!("{} and {}", first.join(", "), last.as_ref())
        }
    }
}

/// Wraps a text to lines of at most [`WIDTH`] characters. The first line begins with `start`; the others are indented to the text.
#[must_use]
pub fn wrapped(start: &str, text: &str) -> String {
    let indent = start.chars().count();
    let (mut lines, mut line) = (String::new(), start.to_owned());
    let mut is_empty = true;
    for word in text.split_whitespace() {
        // A per cent sign stays with its number.
        if !is_empty && word != "%" && line.chars().count() + 1 + word.chars().count() + ROOM > WIDTH {
            lines += line.trim_end();
            lines.push('\n');
            line = " ".repeat(indent);
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line += word;
        is_empty = false;
    }
    lines + line.trim_end() + "\n"
}

/// Width of a terminal line, in characters.
pub const WIDTH: usize = 80;
/// Space reserved for a per cent sign after the last word.
const ROOM: usize = 3;
