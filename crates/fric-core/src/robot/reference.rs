//! `reference` under `[log]`: where the cable forces at the platform are measured, or their known value.

use core::fmt;
use std::borrow::ToOwned;
use std::format;
use std::string::String;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

use super::locate::Step;
use super::options_error::OptionsError;
use super::{KnownReference, ParamProblem};

/// `reference` as written.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ReferenceTable {
    /// The topic or field that has the forces.
    Signal(String),
    /// A value known without a sensor, the same for every cable.
    Known(KnownReferenceTable),
}

/// `{ constant_n = … }` or `{ hanging_mass_kg = … }`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownReferenceTable {
    /// The force, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constant_n: Option<f64>,
    /// The mass on each cable, kg.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hanging_mass_kg: Option<f64>,
}

impl ReferenceTable {
    /// Returns the checked reference; `None` if it is measured. `gravity_m_per_s2` is the magnitude of the robot's gravity.
    pub(super) fn check(&self, gravity_m_per_s2: f64) -> Result<Option<KnownReference>, OptionsError> {
        let Self::Known(table) = self else { return Ok(None) };
        let error = |key: Option<&'static str>, problem: String| {
            let path = [Step::Key("log"), Step::Key("reference")];
            let path: std::vec::Vec<Step> = path.into_iter().chain(key.map(Step::Key)).collect();
            OptionsError::new(&path, key.unwrap_or("reference"), problem)
        };
        let checked = |key: &'static str, value: f64, max: f64| {
            let in_range = value.is_finite() && (0.0..=max).contains(&value);
            let problem = ParamProblem::OutOfRange { value, min: 0.0, max };
            if in_range { Ok(value) } else { Err(error(Some(key), format!("{problem}"))) }
        };
        match (table.constant_n, table.hanging_mass_kg) {
            (Some(force_n), None) => {
                Ok(Some(KnownReference::Constant { force_n: checked("constant_n", force_n, 1e9)? }))
            }
            (None, Some(_)) if gravity_m_per_s2 <= 0.0 => {
                let problem = "has no weight, for `gravity_m_per_s2` under [platform] is zero".to_owned();
                Err(error(Some("hanging_mass_kg"), problem))
            }
            (None, Some(mass_kg)) => {
                let mass_kg = checked("hanging_mass_kg", mass_kg, 1e6)?;
                Ok(Some(KnownReference::HangingMass { mass_kg, gravity_m_per_s2 }))
            }
            (Some(_), Some(_)) => {
                let problem = "is given beside `constant_n`; a load is one or the other".to_owned();
                Err(error(Some("hanging_mass_kg"), problem))
            }
            (None, None) => Err(error(None, "is empty; give `constant_n` or `hanging_mass_kg`".to_owned())),
        }
    }
}

/// Writes the topic or field, or the known value, as in the file.
impl fmt::Display for ReferenceTable {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Signal(path) => formatter.write_str(path),
            Self::Known(KnownReferenceTable { constant_n: Some(force_n), .. }) => {
                write!(formatter, "constant_n = {force_n:?}")
            }
            Self::Known(KnownReferenceTable { hanging_mass_kg, .. }) => {
                write!(formatter, "hanging_mass_kg = {:?}", hanging_mass_kg.unwrap_or(f64::NAN))
            }
        }
    }
}

/// Implemented by hand, because the error for an untagged value that fits neither form says nothing about either.
impl<'de> Deserialize<'de> for ReferenceTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reference;

        impl<'de> Visitor<'de> for Reference {
            type Value = ReferenceTable;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a topic in quotes, or { constant_n = … } or { hanging_mass_kg = … }")
            }

            fn visit_str<E: Error>(self, path: &str) -> Result<ReferenceTable, E> {
                Ok(ReferenceTable::Signal(path.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<ReferenceTable, A::Error> {
                KnownReferenceTable::deserialize(MapAccessDeserializer::new(table)).map(ReferenceTable::Known)
            }
        }

        deserializer.deserialize_any(Reference)
    }
}
