//! One line of a message definition.

use crate::schema::types::{Count, Primitive};

/// The declaration of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Line<'a> {
    /// Nothing: blank, a comment, or a constant.
    Nothing,
    Field(FieldLine<'a>),
}

/// A declared field, whose type is not yet resolved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FieldLine<'a> {
    pub type_name: &'a str,
    pub count: Count,
    pub name: &'a str,
}

/// The expected and the actual content.
pub(super) struct LineError<'a>(pub &'static str, pub &'a str);

const TYPE: &str = "a type, such as `float64`, `string<=8`, `int32[3]` or `geometry_msgs/Pose`";
const ARRAY: &str = "`[]`, `[count]` or `[<=count]` after the type";
const NAME: &str = "a field name of letters, digits and `_`";
const CONSTANT: &str = "a value after `=`, and no array";
const DEFAULT: &str = "nothing, a comment, or a default value of the field's type";

pub(super) fn parse(line: &str) -> Result<Line<'_>, LineError<'_>> {
    let line = line.trim();
    if line.is_empty() || line.starts_with('#') {
        return Ok(Line::Nothing);
    }
    let (type_text, rest) = split_at_first(line, |c: char| c.is_whitespace() || c == '#');
    let (type_name, count) = split_type(type_text)?;

    let rest = rest.trim_start();
    let (name, rest) = split_at_first(rest, |c: char| !(c.is_ascii_alphanumeric() || c == '_'));
    if !name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        return Err(LineError(NAME, line));
    }
    let after_name = rest.trim_start();
    if let Some(value) = after_name.strip_prefix('=') {
        // A text constant keeps its `#`; before any other value it would make an empty constant.
        let missing = value.trim().is_empty() || (!is_text(type_name) && without_comment(value).trim().is_empty());
        return if missing || count != Count::One { Err(LineError(CONSTANT, line)) } else { Ok(Line::Nothing) };
    }
    let separated = after_name.len() < rest.len() || after_name.starts_with('#');
    let is_well_ended = after_name.is_empty() || (separated && is_default(after_name, type_name, count));
    if !is_well_ended {
        return Err(LineError(DEFAULT, after_name));
    }
    Ok(Line::Field(FieldLine { type_name, count, name }))
}

fn split_at_first(text: &str, is_end: impl Fn(char) -> bool) -> (&str, &str) {
    text.split_at(text.find(is_end).unwrap_or(text.len()))
}

/// Returns the bare type and its count: `string<=8[<=3]` is a sequence of `string`.
fn split_type(text: &str) -> Result<(&str, Count), LineError<'_>> {
    let (element, array) = split_at_first(text, |c| c == '[');
    let count = if array.is_empty() {
        Count::One
    } else {
        let inside = array.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).ok_or(LineError(ARRAY, text))?;
        match inside.strip_prefix("<=") {
            _ if inside.is_empty() => Count::Sequence,
            Some(bound) => {
                number(bound).ok_or(LineError(ARRAY, text))?;
                Count::Sequence
            }
            None => Count::Fixed(number(inside).ok_or(LineError(ARRAY, text))?),
        }
    };
    let name = match element.split_once("<=") {
        Some((name, bound)) if is_text(name) && number(bound).is_some() => name,
        Some(_) => return Err(LineError(TYPE, text)),
        None => element,
    };
    let is_part = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_alphabetic())
            && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    if name.split('/').all(is_part) && name.split('/').count() <= 3 {
        Ok((name, count))
    } else {
        Err(LineError(TYPE, text))
    }
}

/// Parses a count of 1 to 2³² − 1, the greatest that CDR can state.
fn number(text: &str) -> Option<usize> {
    let count: u32 = text.trim().parse().ok()?;
    usize::try_from(count).ok().filter(|&count| count > 0)
}

fn is_text(type_name: &str) -> bool {
    matches!(type_name, "string" | "wstring")
}

fn without_comment(text: &str) -> &str {
    split_at_first(text, |c| c == '#').0
}

/// Whether the text after a field's name is a comment or a default value.
fn is_default(text: &str, type_name: &str, count: Count) -> bool {
    if text.starts_with('#') {
        return true;
    }
    if is_text(type_name) {
        // Texts may contain anything, including a `#`.
        return count == Count::One || text.starts_with('[');
    }
    let is_value = |value: &str| Primitive::named(type_name).is_some() && is_number(value.trim());
    let value = without_comment(text).trim();
    if count == Count::One {
        return is_value(value);
    }
    let inside = value.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    inside.is_some_and(|inside| inside.trim().is_empty() || inside.split(',').all(is_value))
}

/// Whether the text is a number in decimal, hexadecimal, octal or binary notation, or a boolean.
fn is_number(text: &str) -> bool {
    let with_radix = |prefix, radix| {
        let digits = text.trim_start_matches(['+', '-']).strip_prefix(prefix);
        digits.is_some_and(|digits| u64::from_str_radix(digits, radix).is_ok())
    };
    text.parse::<f64>().is_ok()
        || ["true", "false"].iter().any(|value| text.eq_ignore_ascii_case(value))
        || [("0x", 16), ("0o", 8), ("0b", 2)].iter().any(|&(prefix, radix)| with_radix(prefix, radix))
}
