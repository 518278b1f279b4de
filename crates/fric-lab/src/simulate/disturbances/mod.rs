//! Disturbances of a log that are not in the catalogue of friction effects: faults of sensor, amplifier, winch and cable.
//!
//! They produce logs whose disagreement with the model must be found and located without a wrong name. To add one, create a file here that implements
//! [`TruthEffect`], and add its row to [`DISTURBANCES`].

mod bristle_damping;
mod clipped;
mod creep;
mod frozen;
mod hum;
mod local_defect;
mod quantised;
mod step;
mod vibration;
mod warming;

use std::fmt;
use std::str::FromStr;

use rand_chacha::ChaCha8Rng;

use super::error::HiddenError;
use super::stated::{self, Allowed, Kind};
use crate::effects::truth::{Build, Cause, TruthEffect};

/// A kind of disturbance.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct DisturbanceRow {
    /// Its name.
    pub kind: &'static str,
    /// Its cause, in one sentence.
    pub cause: &'static str,
    /// Its parameters.
    pub parameters: &'static [DisturbanceParameter],
    build: Build,
}

/// A parameter of a disturbance.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct DisturbanceParameter {
    /// Its key, including the unit.
    pub key: &'static str,
    /// Its unit; `1` for a ratio.
    pub unit: &'static str,
    /// Default value.
    pub usual: f64,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

/// Every disturbance.
pub const DISTURBANCES: &[DisturbanceRow] = &[
    hum::ROW,
    frozen::ROW,
    clipped::ROW,
    step::ROW,
    quantised::ROW,
    warming::ROW,
    local_defect::ROW,
    vibration::ROW,
    bristle_damping::ROW,
    creep::ROW,
];

/// A disturbance with values, checked against its row.
///
/// ```
/// use fric_lab::simulate::Disturbance;
/// # fn main() -> Result<(), fric_lab::simulate::HiddenError> {
/// let hum = Disturbance::parse("hum:amplitude_n=0.12")?;
/// assert_eq!(hum.kind(), "hum");
/// assert_eq!(hum.value("frequency_hz"), Some(50.0));
/// let problem = Disturbance::parse("hum:amplitude_n=-1").map_err(|error| error.to_string());
/// assert_eq!(problem, Err("`amplitude_n` of the disturbance `hum` is -1; allowed is 0 to 1000 N".to_owned()));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Disturbance {
    kind: &'static str,
    values: Vec<(&'static str, f64)>,
}

impl Disturbance {
    /// Reads `kind:key=value,key=value`. A parameter that is not given takes its default value.
    ///
    /// # Errors
    /// Returns a [`HiddenError`] that names the mistake and the known or allowed values.
    pub fn parse(text: &str) -> Result<Self, HiddenError> {
        let (kind, entries) = stated::split(text);
        let kind = find(kind)?;
        let values = kind.check(&kind.read(entries)?)?;
        Ok(Self { kind: kind.name, values })
    }

    /// Creates a disturbance from its name and values by key.
    ///
    /// # Errors
    /// Returns a [`HiddenError`] that names the mistake and the known or allowed values.
    pub fn new(kind: &str, values: &[(&str, f64)]) -> Result<Self, HiddenError> {
        let kind = find(kind)?;
        Ok(Self { kind: kind.name, values: kind.check(values)? })
    }

    /// Returns its name in [`DISTURBANCES`].
    #[must_use]
    pub fn kind(&self) -> &'static str {
        self.kind
    }

    /// Returns the given values, by key.
    #[must_use]
    pub fn values(&self) -> &[(&'static str, f64)] {
        &self.values
    }

    /// Returns the value of a parameter, given or default; `None` for an unknown key.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<f64> {
        let given = self.values.iter().find(|(other, _)| *other == key).map(|(_, value)| *value);
        given.or_else(|| Some(row(self.kind)?.parameters.iter().find(|parameter| parameter.key == key)?.usual))
    }

    /// Returns the parameters that were not given, by key, with their default values.
    #[must_use]
    pub fn defaults(&self) -> Vec<(&'static str, f64)> {
        let missing = |key: &str| self.values.iter().all(|(given, _)| *given != key);
        let all = row(self.kind).into_iter().flat_map(|row| row.parameters);
        all.filter(|parameter| missing(parameter.key)).map(|parameter| (parameter.key, parameter.usual)).collect()
    }

    /// Creates the disturbance of a cable.
    pub(super) fn build(&self, start_length_m: f64, random: &mut ChaCha8Rng) -> Box<dyn TruthEffect> {
        let value = |key: &str| self.value(key).unwrap_or_default();
        let mut cause = Cause { value: &value, start_length_m, sensor_ratio: 1.0, random };
        row(self.kind).map_or_else(|| Box::new(Nothing) as Box<dyn TruthEffect>, |row| (row.build)(&mut cause))
    }
}

impl FromStr for Disturbance {
    type Err = HiddenError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::parse(text)
    }
}

/// Writes the form that [`Disturbance::parse`] reads.
impl fmt::Display for Disturbance {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        stated::write(formatter, self.kind, &self.values)
    }
}

/// The effect of a kind without a row, which does not occur.
#[derive(Debug)]
struct Nothing;

impl TruthEffect for Nothing {}

fn row(kind: &str) -> Option<&'static DisturbanceRow> {
    DISTURBANCES.iter().find(|row| row.kind == kind)
}

fn find(kind: &str) -> Result<Kind, HiddenError> {
    const NOUN: &str = "disturbance";
    let row = row(kind).ok_or_else(|| stated::unknown(NOUN, kind, DISTURBANCES.iter().map(|row| row.kind)))?;
    let allowed =
        |&DisturbanceParameter { key, unit, min, max, .. }: &DisturbanceParameter| Allowed { key, unit, min, max };
    Ok(Kind { noun: NOUN, name: row.kind, parameters: row.parameters.iter().map(allowed).collect() })
}

/// Creates a parameter row.
const fn parameter(key: &'static str, unit: &'static str, usual: f64, [min, max]: [f64; 2]) -> DisturbanceParameter {
    DisturbanceParameter { key, unit, usual, min, max }
}

/// Whether a time lies in one of the stretches of `length_s` that start every `interval_s`, the first after `first_s`.
fn in_stretch(time_s: f64, first_s: f64, interval_s: f64, length_s: f64) -> bool {
    let since_s = time_s - first_s;
    since_s >= 0.0 && since_s - interval_s * libm::floor(since_s / interval_s) < length_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_values_are_allowed_and_kinds_and_keys_are_there_once() {
        for (place, row) in DISTURBANCES.iter().enumerate() {
            assert!(DISTURBANCES.iter().skip(place + 1).all(|other| other.kind != row.kind));
            assert!(fric_core::effects::Effect::of_kind(row.kind).is_none(), "{} is in the catalogue", row.kind);
            assert!(!row.cause.is_empty());
            for parameter in row.parameters {
                assert!((parameter.min..=parameter.max).contains(&parameter.usual), "{}", parameter.key);
                assert!(parameter.unit == "1" || parameter.key.contains('_'), "{}", parameter.key);
            }
        }
    }

    #[test]
    fn stretches_begin_at_intervals() {
        let within = [0.9, 1.0, 1.19, 1.21, 2.99, 3.0, 3.1, 5.05].map(|time_s| in_stretch(time_s, 1.0, 2.0, 0.2));
        assert_eq!(within, [false, true, true, false, false, true, true, true]);
    }
}
