//! The sections of a schema text, each the definition of one type.

use std::collections::HashSet;

use super::line::{self, FieldLine, Line, LineError};
use super::short_name;
use crate::schema::error::SchemaError;

/// One type as written.
pub(super) struct Definition<'a> {
    /// `package/Type`.
    pub name: String,
    /// Fields with their line numbers.
    pub fields: Vec<(FieldLine<'a>, usize)>,
}

/// Maximum number of fields and types of a schema; real messages have some hundreds.
const MAX_LINES: usize = 50_000;

/// Splits the text into its definitions; the first one is that of `schema_name`.
pub(super) fn split<'a>(schema_name: &str, text: &'a str) -> Result<Vec<Definition<'a>>, SchemaError> {
    let syntax = |line, LineError(expected, found): LineError<'_>| SchemaError::Syntax {
        name: schema_name.to_owned(),
        line,
        expected,
        found: found.to_owned(),
    };
    let duplicate =
        |line, twice: &str| SchemaError::Duplicate { name: schema_name.to_owned(), line, twice: twice.to_owned() };
    let mut current = Definition { name: short_name(schema_name), fields: Vec::new() };
    let mut done = Vec::new();
    let mut type_names = HashSet::from([current.name.clone()]);
    let mut field_names = HashSet::new();
    let mut left = MAX_LINES;
    let mut count = || {
        left = left.checked_sub(1).ok_or_else(|| SchemaError::TooLarge {
            name: schema_name.to_owned(),
            limit: MAX_LINES,
            what: "fields and types",
        })?;
        Ok(())
    };
    let mut lines = (1..).zip(text.trim_start_matches('\u{feff}').lines());
    while let Some((number, text)) = lines.next() {
        if is_separator(text) {
            count()?;
            let heading = lines.by_ref().find(|(_, text)| !text.trim().is_empty());
            let (number, heading) = heading.unwrap_or((number, text));
            if heading.starts_with("IDL:") {
                return Err(SchemaError::Idl { name: schema_name.to_owned() });
            }
            let name = short_name(type_name(heading).map_err(|error| syntax(number, error))?);
            if !type_names.insert(name.clone()) {
                return Err(duplicate(number, &name));
            }
            field_names.clear();
            done.push(std::mem::replace(&mut current, Definition { name, fields: Vec::new() }));
            continue;
        }
        if let Line::Field(field) = line::parse(text).map_err(|error| syntax(number, error))? {
            count()?;
            if !field_names.insert(field.name) {
                return Err(duplicate(number, field.name));
            }
            current.fields.push((field, number));
        }
    }
    done.push(current);
    Ok(done)
}

/// Returns the type that the line after a separator names.
fn type_name(heading: &str) -> Result<&str, LineError<'_>> {
    match heading.trim().strip_prefix("MSG:").map(str::trim) {
        Some(name) if !name.is_empty() => Ok(name),
        _ => Err(LineError("`MSG: package/Type` after the line of `=`", heading)),
    }
}

fn is_separator(line: &str) -> bool {
    let line = line.trim_end();
    line.len() >= 3 && line.bytes().all(|byte| byte == b'=')
}
