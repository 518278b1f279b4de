//! Reads the TOML text of a model's file, and finds the line of an error and the nearest name to a misspelt one. For robot files and the files of other
//! models.

use core::fmt;
use std::borrow::ToOwned;
use std::format;
use std::string::String;
use std::vec::Vec;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use crate::text_file;

/// One step into a TOML document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Into a table.
    Key(&'static str),
    /// Into an array by index, or into a table with user-defined keys by alphabetical index.
    Index(usize),
}

/// A line number for a sentence, if it is known.
pub struct Line(pub Option<usize>);

impl fmt::Display for Line {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |line| write!(formatter, ", line {line}"))
    }
}

/// The line (from 1) of the innermost thing on a path that the text has.
#[must_use]
pub fn line_of(text: &str, path: &[Step]) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let mut offset = None;
    let mut value = &DeValue::Table(root.get_ref().clone());
    for step in path {
        let next = match (step, value) {
            (Step::Key(key), DeValue::Table(table)) => table.get_key_value(*key).map(|(key, value)| {
                // A table header has no span of its own value, but its key has one.
                (key.span().start.max(value.span().start), value.get_ref())
            }),
            (Step::Index(index), DeValue::Table(table)) => {
                table.iter().nth(*index).map(|(key, value)| (key.span().start, value.get_ref()))
            }
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

/// Reads the tables of a model's file; `format` is the value that the key `format` of the file should have.
///
/// # Errors
/// Returns the line (from 1, if it is known) and the problem in the words of the file, if the text is too long, not TOML or has other keys or types.
pub fn read_tables<T: DeserializeOwned>(text: &str, format: &str) -> Result<T, (Option<usize>, String)> {
    if let Some(problem) = text_file::excess(text) {
        return Err((None, problem));
    }
    toml::from_str(text).map_err(|error| {
        other_format(text, format).unwrap_or_else(|| (error_line(text, &error), describe(text, &error, format)))
    })
}

/// Returns the line and the problem of a text that states another format, whose keys are then no matter of spelling.
fn other_format(text: &str, format: &str) -> Option<(Option<usize>, String)> {
    let root = DeTable::parse(text).ok()?.into_inner();
    let (_, stated) = root.iter().find(|(key, _)| key.get_ref() == "format")?;
    let line = text.get(..stated.span().start)?.matches('\n').count() + 1;
    let stated = stated.get_ref().as_str().filter(|stated| *stated != format)?;
    Some((Some(line), format!("`format` is \"{stated}\"; this version reads \"{format}\"")))
}

/// The line (from 1) in which an error of the parser stands; one at the end of the text is in the last line with anything in it.
fn error_line(text: &str, error: &toml::de::Error) -> Option<usize> {
    let end = text.trim_end().len();
    error.span().map(|span| text.get(..span.start.min(end)).unwrap_or(text).matches('\n').count() + 1)
}

/// The value of a key that is a number with a decimal comma, in a line that is not valid.
fn decimal_comma(line: &str) -> Option<&str> {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    line.split('=').skip(1).find_map(|value| {
        let number = value.trim_start().split([' ', '}', '#', ']']).next()?.trim_end_matches(',');
        let (whole, decimals) = number.split_once(',')?;
        (is_number(whole.trim_start_matches('-')) && is_number(decimals)).then_some(number)
    })
}

/// What is wrong with a text that did not become options, in one line and in the words of the file; `format` is what the file's
/// `format` should be.
fn describe(text: &str, error: &toml::de::Error, format: &str) -> String {
    let message = error.message().trim().replace('\n', "; ");
    let Ok(root) = DeTable::parse(text) else {
        let line = error_line(text, error).and_then(|line| text.lines().nth(line - 1)).unwrap_or_default();
        return match decimal_comma(line) {
            Some(number) => format!("`{number}` is no number; write it with a decimal point"),
            None => format!("is not valid TOML: {message}"),
        };
    };
    let start = error.span().map_or(0, |span| span.start);
    let keys = keys_around(root.into_inner(), start);
    let key = keys.last().map_or("the file", String::as_str);
    // serde writes "unknown field `x`, expected one of `a`, `b`" (or "variant"): the names are in backticks.
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if let ("unknown field", Some((unknown, known))) = (first_words(&message), names.split_first()) {
        return unknown_name("key", unknown, known.iter().copied());
    }
    if let ("unknown variant", Some((unknown, known))) = (first_words(&message), names.split_first()) {
        return format!("`{key}` has an {}", unknown_name("value", unknown, known.iter().copied()));
    }
    if let ("missing field", Some(missing)) = (first_words(&message), names.first()) {
        return match (*missing, keys.last()) {
            ("format", _) => format!("`format` is missing; write format = \"{format}\""),
            ("cable", _) => "`cable` is missing; give each cable a table [[cable]]".to_owned(),
            // A missing key of the root is reported at the start of the text.
            _ if start == 0 => format!("`{missing}` is missing"),
            (_, None) => format!("`{missing}` is missing"),
            (_, Some(table)) if table == "cable" => format!("`{missing}` is missing in this [[cable]]"),
            (_, Some(table)) => format!("`{missing}` is missing in `{table}`"),
        };
    }
    let stripped = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "));
    match (stripped.unwrap_or(&message).split_once(", expected "), stripped) {
        (Some((found, expected)), Some(_)) => {
            format!("`{key}` is {}; it must be {}", plain_value(found), plain_words(expected))
        }
        (Some((found, expected)), None) if found.starts_with("invalid length ") => {
            let count = found.trim_start_matches("invalid length ");
            format!("`{key}` has {count} entries; it must be {}", plain_words(expected))
        }
        _ => format!("`{key}`: {message}"),
    }
}

/// Returns the first two words.
fn first_words(message: &str) -> &str {
    let end = message.match_indices(' ').nth(1).map_or(message.len(), |(place, _)| place);
    message.get(..end).unwrap_or(message)
}

/// Returns a value in the terms of the file's author: serde writes "string "fast"", "floating point `0.55`", "map".
fn plain_value(found: &str) -> String {
    match found.split_once(['"', '`']) {
        Some(("string ", text)) => format!("the text \"{text}"),
        Some((_, value)) => value.trim_end_matches('`').to_owned(),
        None if found == "map" => "a table".to_owned(),
        None if found == "sequence" => "a list".to_owned(),
        None => found.to_owned(),
    }
}

/// Returns serde's type names in the terms of the file's author.
fn plain_words(expected: &str) -> &str {
    match expected {
        "f64" => "a number",
        "u32" | "usize" => "a whole number, 0 or greater",
        "a string" => "text in quotes",
        "a boolean" => "true or false",
        "an array of length 2" => "2 numbers in brackets",
        "an array of length 3" => "3 numbers in brackets",
        "a sequence" => "a list; a cable is a table [[cable]], a pulley an entry of `pulleys = [ … ]`",
        other if other.starts_with("struct ") => "a table",
        other => other,
    }
}

/// Returns the keys from the root to the innermost value at an offset.
///
/// Every table is searched, because the span of a table under a header covers only the header.
fn keys_around(table: DeTable<'_>, offset: usize) -> Vec<String> {
    let mut keys = Vec::new();
    for (key, value) in table {
        let here = key.span().contains(&offset) || value.span().contains(&offset);
        let within = keys_within(value.into_inner(), offset);
        if here || !within.is_empty() {
            keys = Vec::from([key.into_inner().into_owned()]);
            keys.extend(within);
        }
    }
    keys
}

fn keys_within(value: DeValue<'_>, offset: usize) -> Vec<String> {
    match value {
        DeValue::Table(table) => keys_around(table, offset),
        DeValue::Array(array) => array
            .into_iter()
            .map(|value| keys_within(value.into_inner(), offset))
            .max_by_key(Vec::len)
            .unwrap_or_default(),
        _ => Vec::new(),
    }
}

/// Number of names that a sentence lists, and number of the nearest ones that it lists of more.
const MOST_LISTED: usize = 12;
const NEAREST_LISTED: usize = 6;

/// Returns "unknown key `x`; did you mean `y`?" with the known names, of many those that are nearest; `what` says what the names denote.
#[must_use]
pub fn unknown_name<'a>(what: &str, unknown: &str, known: impl Iterator<Item = &'a str>) -> String {
    let mut known: Vec<&str> = known.collect();
    if known.is_empty() {
        return format!("unknown {what} `{unknown}`: none belongs here");
    }
    let nearest = nearest_name(unknown, known.iter().copied());
    let count = known.len();
    if count > MOST_LISTED {
        known.sort_by(|one, other| likeness(unknown, other).total_cmp(&likeness(unknown, one)));
        known.truncate(NEAREST_LISTED);
    }
    let list = known.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let more = if count > known.len() { format!(" and {} more", count - known.len()) } else { String::new() };
    match nearest {
        Some(name) => format!("unknown {what} `{unknown}`; did you mean `{name}`? (known here: {list}{more})"),
        None => format!("unknown {what} `{unknown}`; known here: {list}{more}"),
    }
}

/// Returns the name that was probably meant; `None` if none is similar.
#[must_use]
pub fn nearest_name<'a>(unknown: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|name| (likeness(unknown, name), name))
        .filter(|(likeness, _)| *likeness > 0.4)
        .max_by(|(one, _), (other, _)| one.total_cmp(other))
        .map(|(_, name)| name)
}

/// Returns how like a name is to an unknown one, from 0 to 1 for an equal one. One that begins with it is beyond 1, the shortest most.
fn likeness(unknown: &str, name: &str) -> f64 {
    let likeness = strsim::normalized_damerau_levenshtein(unknown, name);
    if !unknown.is_empty() && name.starts_with(unknown) { 1.0 + likeness } else { likeness }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_begins_so_comes_first_and_few_are_listed() {
        let known = ["mu", "signal", "sigma_n_per_m", "viscous_nonlinearity.quadratic", "viscous_n_s_per_m"];
        let nearest = |unknown| nearest_name(unknown, known.into_iter());
        assert_eq!(nearest("sigma"), Some("sigma_n_per_m"));
        assert_eq!(nearest("viscous"), Some("viscous_n_s_per_m"));
        assert_eq!([nearest("sigmal"), nearest("qqqqqqqq"), nearest("")], [Some("signal"), None, None]);
        let short = unknown_name("key", "nu", known.into_iter());
        assert!(
            short.contains("did you mean `mu`? (known here: `mu`, `signal`,") && !short.contains("more"),
            "{short}"
        );
        let many: Vec<String> = (0..70).map(|place| format!("key_{place}")).chain(known.map(String::from)).collect();
        let long = unknown_name("parameter", "sigma", many.iter().map(String::as_str));
        assert!(long.contains("did you mean `sigma_n_per_m`? (known here: `sigma_n_per_m`, `signal`, "), "{long}");
        assert!(long.ends_with(" and 69 more)"), "{long}");
    }
}
