//! Where in a TOML text something stands, and what a misspelt key may have meant.

use std::borrow::ToOwned;
use std::format;
use std::string::String;
use std::vec::Vec;

use toml::de::{DeTable, DeValue};

/// One step into a TOML document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Into a table.
    Key(&'static str),
    /// Into an array.
    Index(usize),
}

/// The line (from 1) of the innermost thing on a path that the text has.
pub fn line_of(text: &str, path: &[Step]) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let mut offset = None;
    let mut value = &DeValue::Table(root.get_ref().clone());
    for step in path {
        let next = match (step, value) {
            (Step::Key(key), DeValue::Table(table)) => table.get_key_value(*key).map(|(key, value)| {
                // A table header has no span of its own value; its key has.
                (key.span().start.max(value.span().start), value.get_ref())
            }),
            (Step::Index(index), DeValue::Array(array)) => {
                array.get(*index).map(|value| (value.span().start, value.get_ref()))
            }
            _ => None,
        };
        let Some((start, inner)) = next else { break };
        offset = Some(start);
        value = inner;
    }
    let before = text.get(..offset?)?;
    Some(before.matches('\n').count() + 1)
}

/// The parser's message in one line, and for a misspelt name the nearest one that exists.
pub fn describe(error: &toml::de::Error) -> String {
    let message = error.message().trim().replace('\n', "; ");
    // serde words it "unknown field `x`, expected one of `a`, `b`" (or "variant"): the names stand in backticks.
    if !message.starts_with("unknown ") {
        return message;
    }
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    match names.split_first() {
        Some((unknown, known)) => unknown_name("key", unknown, known.iter().copied()),
        None => message,
    }
}

/// "unknown key `x`; did you mean `y`?" with all names there are.
pub fn unknown_name<'a>(what: &str, unknown: &str, known: impl Iterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.collect();
    let nearest = known
        .iter()
        .map(|name| (strsim::normalized_damerau_levenshtein(unknown, name), *name))
        .max_by(|(one, _), (other, _)| one.total_cmp(other));
    let list = known.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let hint = match nearest {
        Some((likeness, name)) if likeness > 0.4 => format!("did you mean `{name}`? "),
        _ => String::new(),
    };
    if known.is_empty() {
        return format!("unknown {what} `{unknown}`: none belongs here").to_owned();
    }
    format!("unknown {what} `{unknown}`; {hint}Known: {list}")
}
