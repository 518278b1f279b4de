//! An effect to hide in a log, as stated on the command line: `kind:key=value,…`.

use std::fmt;
use std::str::FromStr;

use fric_core::effects::{self, EffectParams, EffectRow};
use fric_core::parameters::ParameterRow;

use super::error::{HiddenEffectError, with_unit};

/// An effect of the catalogue with values, checked against its row.
///
/// A parameter that is not given has the value that the same file entry without it would have.
///
/// ```
/// use fric_lab::simulate::HiddenEffect;
/// # fn main() -> Result<(), fric_lab::simulate::HiddenEffectError> {
/// let effect = HiddenEffect::parse("stribeck:ratio=0.5,velocity_m_per_s=0.02")?;
/// assert_eq!(effect.kind(), "stribeck");
/// assert_eq!(effect.params().get("stribeck", "ratio"), Some(0.5));
/// let problem = HiddenEffect::parse("stribek:ratio=0.5").map_err(|error| error.to_string());
/// assert!(problem.is_err_and(|text| text.starts_with("there is no effect `stribek`; known are `stribeck`")));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HiddenEffect {
    kind: &'static str,
    values: Vec<(&'static str, f64)>,
    params: EffectParams,
}

impl HiddenEffect {
    /// Reads `kind:key=value,key=value`.
    ///
    /// # Errors
    /// [`HiddenEffectError`] names what is wrong and what is known or allowed.
    pub fn parse(text: &str) -> Result<Self, HiddenEffectError> {
        let (kind, list) = text.split_once(':').unwrap_or((text, ""));
        let row = find_row(kind.trim())?;
        let mut values = Vec::new();
        for entry in list.split(',').map(str::trim).filter(|entry| !entry.is_empty()) {
            let value = entry.split_once('=').and_then(|(key, value)| Some((key.trim(), value.trim().parse().ok()?)));
            let Some(value) = value else {
                return Err(HiddenEffectError::NotAValue { kind: row.kind, text: entry.to_owned(), known: keys(row) });
            };
            values.push(value);
        }
        Self::new(row.kind, &values)
    }

    /// An effect from its name and values by key.
    ///
    /// # Errors
    /// [`HiddenEffectError`] names what is wrong and what is known or allowed.
    pub fn new(kind: &str, values: &[(&str, f64)]) -> Result<Self, HiddenEffectError> {
        let row = find_row(kind)?;
        let kind = row.kind;
        if values.is_empty() {
            return Err(HiddenEffectError::NoParameter { kind, known: keys(row) });
        }
        let mut effect = Self { kind, values: Vec::with_capacity(values.len()), params: EffectParams::NEUTRAL };
        for &(key, value) in values {
            let parameter = row.parameters.iter().find(|parameter| parameter.key == key);
            let Some(&ParameterRow { key, unit, min, max, .. }) = parameter else {
                return Err(HiddenEffectError::UnknownKey { kind, key: key.to_owned(), known: keys(row) });
            };
            if effect.values.iter().any(|(other, _)| *other == key) {
                return Err(HiddenEffectError::RepeatedKey { kind, key });
            }
            effect.params.set(kind, key, value).map_err(|_| HiddenEffectError::OutOfRange {
                kind,
                key,
                value,
                min,
                max,
                unit,
            })?;
            effect.values.push((key, value));
        }
        Ok(effect)
    }

    /// Its name in the catalogue.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        self.kind
    }

    /// The values given, by key.
    #[must_use]
    pub fn values(&self) -> &[(&'static str, f64)] {
        &self.values
    }

    /// The effect as the compensator's parameters would state it; all other effects are neutral.
    #[must_use]
    pub fn params(&self) -> &EffectParams {
        &self.params
    }
}

impl FromStr for HiddenEffect {
    type Err = HiddenEffectError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::parse(text)
    }
}

/// As [`HiddenEffect::parse`] reads it.
impl fmt::Display for HiddenEffect {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}:", self.kind)?;
        for (place, (key, value)) in self.values.iter().enumerate() {
            write!(formatter, "{}{key}={value}", if place > 0 { "," } else { "" })?;
        }
        Ok(())
    }
}

fn find_row(kind: &str) -> Result<&'static EffectRow, HiddenEffectError> {
    effects::row(kind).ok_or_else(|| HiddenEffectError::UnknownKind {
        kind: kind.to_owned(),
        known: list(effects::CATALOGUE.iter().map(|row| format!("`{}`", row.kind))),
    })
}

fn keys(row: &EffectRow) -> String {
    list(
        row.parameters
            .iter()
            .map(|ParameterRow { key, unit, min, max, .. }| format!("`{key}` ({min} to {max}{})", with_unit(unit))),
    )
}

/// With commas between.
pub(super) fn list(names: impl Iterator<Item = String>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
