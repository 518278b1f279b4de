//! The editor of TOML texts: it changes values and leaves every other byte as it is.
//!
//! Comments, order, indentation, line endings (mixed ones too) and a byte order mark stay. A new entry is written like its neighbours: in the same
//! braces, or on a line of its own with the neighbour's indentation and line ending. The robot file ([`crate::robot::edit`]) and the files of other
//! models ([`set`]) are written with it. Needs the feature `robot-file`; not for the cycle.

use std::borrow::ToOwned;
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

use toml_edit::{Document, InlineTable, Item, Table, TableLike, Value};

pub(crate) mod splice;

pub(crate) use splice::{Entry, Splice};

/// A value to be written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Numbers<'a> {
    /// A number.
    One(f64),
    /// A list of numbers.
    List(&'a [f64]),
}

/// Sets a value of a top-level table of a TOML text; an empty table name denotes the document itself.
///
/// An existing value is replaced in place, and stays as it is written if it already has the same bits. A new key is written after the last entry of
/// its table, and a missing table at the end of the text.
///
/// ```
/// use fric_core::toml_editor::{Numbers, set};
/// let mut text = String::from("name = \"arm\"  # left\r\n\r\n[tip]\r\n  mass_kg = 1e-3\r\n");
/// set(&mut text, "tip", "mass_kg", Numbers::One(0.001))?;
/// set(&mut text, "tip", "force_n", Numbers::List(&[0.0, 0.5]))?;
/// assert_eq!(text, "name = \"arm\"  # left\r\n\r\n[tip]\r\n  mass_kg = 1e-3\r\n  force_n = [0.0, 0.5]\r\n");
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
/// Returns a sentence if the text is not TOML, or if the table is written in a way that takes no new entry, and then changes nothing.
pub fn set(text: &mut String, table: &str, key: &str, value: Numbers<'_>) -> Result<(), String> {
    let document = Document::parse(text.as_str()).map_err(|error| error.to_string())?;
    let splices = match document.get(table) {
        _ if table.is_empty() => Body::Lines(&document).set(text, "", key, value),
        Some(item) => Body::of_item(item).and_then(|body| body.set(text, table, key, value)),
        None => Some(splice::table_at_end(text, table, &entry(key, value))),
    };
    let splices = splices.ok_or_else(|| refusal(table))?;
    splice::apply(text, splices);
    Ok(())
}

/// Returns the sentence for a table that takes no new entry.
pub(crate) fn refusal(table: &str) -> String {
    format!("`{table}` is written in a way that cannot be added to; write it in one table")
}

/// A table under a header or with dotted keys, or an inline table.
#[derive(Clone, Copy)]
pub(crate) enum Body<'a> {
    Lines(&'a Table),
    Braces(&'a InlineTable),
}

impl<'a> Body<'a> {
    pub(crate) fn of_item(item: &'a Item) -> Option<Self> {
        match item {
            Item::Table(table) => Some(Self::Lines(table)),
            Item::Value(Value::InlineTable(table)) => Some(Self::Braces(table)),
            _ => None,
        }
    }

    pub(crate) fn table(self) -> &'a dyn TableLike {
        match self {
            Self::Lines(table) => table,
            Self::Braces(table) => table,
        }
    }

    /// Appends an entry after the last one; `dotted` is the prefix of its key if the keys are dotted.
    pub(crate) fn append(self, text: &str, dotted: &str, entry: &str) -> Option<Vec<Splice>> {
        let last = splice::last_entry(self.table());
        let entry = if self.table().is_dotted() { format!("{dotted}.{entry}") } else { entry.to_owned() };
        match self {
            Self::Braces(table) if table.is_dotted() => Some(splice::beside(&last?, &entry)),
            Self::Braces(table) => Some(splice::in_list(text, &table.span()?, last.as_ref(), &entry)),
            Self::Lines(table) => {
                let place = last.or_else(|| Some(Entry::from(table.span()?)))?;
                Some(splice::below(text, &place, &entry))
            }
        }
    }

    /// Sets a value: in place, or after the last entry.
    pub(crate) fn set(self, text: &str, dotted: &str, key: &str, value: Numbers<'_>) -> Option<Vec<Splice>> {
        match self.table().get(key) {
            Some(item) => replaced(item, value),
            None => self.append(text, dotted, &entry(key, value)),
        }
    }
}

/// Replaces a value, unless it has the same bits.
pub(crate) fn replaced(item: &Item, value: Numbers<'_>) -> Option<Vec<Splice>> {
    if value.is_written_in(item) {
        return Some(Vec::new());
    }
    Some(Vec::from([Splice { range: item.span()?, with: value.to_toml() }]))
}

/// Returns an entry of a table.
pub(crate) fn entry(key: &str, value: Numbers<'_>) -> String {
    format!("{key} = {}", value.to_toml())
}

impl Numbers<'_> {
    fn to_toml(self) -> String {
        match self {
            Self::One(value) => number(value),
            Self::List(values) => {
                format!("[{}]", values.iter().copied().map(number).collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// Tells whether an item already has this value, to the bit.
    fn is_written_in(self, item: &Item) -> bool {
        let is = |written: &Value, value: f64| read(written).is_some_and(|read| read.to_bits() == value.to_bits());
        match (self, item.as_value()) {
            (Self::One(value), Some(written)) => is(written, value),
            (Self::List(values), Some(Value::Array(written))) => {
                written.len() == values.len() && written.iter().zip(values).all(|(written, value)| is(written, *value))
            }
            _ => false,
        }
    }
}

/// Returns the number that a value is read as.
fn read(value: &Value) -> Option<f64> {
    #[expect(clippy::cast_precision_loss, reason = "as the file is read")]
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Returns the shortest text that reads back to the same bits, with a point or an exponent, as in TOML.
fn number(value: f64) -> String {
    if value.is_nan() { "nan".to_owned() } else { format!("{value:?}") }
}
