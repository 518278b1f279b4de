//! Effects and disturbances in text form, `kind:key=value,…`, read and checked against a catalogue.

use std::fmt;

use fric_core::robot::nearest_name;

use super::error::{HiddenError, with_unit};
use super::hidden::list;

/// An allowed parameter.
#[derive(Clone, Copy, Debug)]
pub struct Allowed {
    pub key: &'static str,
    pub unit: &'static str,
    pub min: f64,
    pub max: f64,
}

/// A kind that can be hidden.
#[derive(Clone, Debug)]
pub struct Kind {
    /// `effect` or `disturbance`.
    pub noun: &'static str,
    pub name: &'static str,
    pub parameters: Vec<Allowed>,
}

/// Splits a text into kind and values.
pub fn split(text: &str) -> (&str, impl Iterator<Item = &str>) {
    let (kind, list) = text.split_once(':').unwrap_or((text, ""));
    (kind.trim(), list.split(',').map(str::trim).filter(|entry| !entry.is_empty()))
}

/// Returns the error for an unknown kind.
pub fn unknown(noun: &'static str, kind: &str, known: impl Iterator<Item = &'static str> + Clone) -> HiddenError {
    HiddenError::UnknownKind {
        noun,
        kind: kind.to_owned(),
        nearest: nearest_name(kind, known.clone()),
        known: list(known.map(|name| format!("`{name}`"))),
    }
}

impl Kind {
    /// Reads each entry as `key=value`.
    pub fn read<'a>(&self, entries: impl Iterator<Item = &'a str>) -> Result<Vec<(&'a str, f64)>, HiddenError> {
        let read = |entry: &'a str| {
            let value = entry.split_once('=').and_then(|(key, value)| Some((key.trim(), value.trim().parse().ok()?)));
            value.ok_or_else(|| HiddenError::NotAValue {
                noun: self.noun,
                kind: self.name,
                text: entry.to_owned(),
                known: self.keys(),
            })
        };
        entries.map(read).collect()
    }

    /// Returns the values with the keys of the catalogue. There must be at least one, none repeated, and all in range.
    pub fn check(&self, values: &[(&str, f64)]) -> Result<Vec<(&'static str, f64)>, HiddenError> {
        let &Self { noun, name: kind, .. } = self;
        if values.is_empty() {
            return Err(HiddenError::NoParameter { noun, kind, known: self.keys() });
        }
        let mut checked: Vec<(&'static str, f64)> = Vec::with_capacity(values.len());
        for &(key, value) in values {
            let Some(&Allowed { key, unit, min, max }) = self.parameters.iter().find(|allowed| allowed.key == key)
            else {
                return Err(HiddenError::UnknownKey {
                    noun,
                    kind,
                    key: key.to_owned(),
                    nearest: nearest_name(key, self.parameters.iter().map(|allowed| allowed.key)),
                    known: self.keys(),
                });
            };
            if checked.iter().any(|(other, _)| *other == key) {
                return Err(HiddenError::RepeatedKey { noun, kind, key });
            }
            if !(min..=max).contains(&value) {
                return Err(HiddenError::OutOfRange { noun, kind, key, value, min, max, unit });
            }
            checked.push((key, value));
        }
        Ok(checked)
    }

    fn keys(&self) -> String {
        list(
            self.parameters
                .iter()
                .map(|Allowed { key, unit, min, max }| format!("`{key}` ({min} to {max}{})", with_unit(unit))),
        )
    }
}

/// Writes the text form.
pub fn write(formatter: &mut fmt::Formatter<'_>, kind: &str, values: &[(&str, f64)]) -> fmt::Result {
    write!(formatter, "{kind}:")?;
    for (place, (key, value)) in values.iter().enumerate() {
        write!(formatter, "{}{key}={value}", if place > 0 { "," } else { "" })?;
    }
    Ok(())
}
