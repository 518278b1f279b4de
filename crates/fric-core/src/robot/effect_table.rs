//! An effect of a cable as the robot file has it.

use std::collections::BTreeMap;
use std::fmt;
use std::string::String;

use serde::Serialize;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};

/// An entry of `effects`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectTable {
    /// Name in the catalogue.
    pub kind: String,
    /// Parameters by key.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, f64>,
}

/// Implemented by hand, because a flattened map loses the positions of its keys.
impl<'de> Deserialize<'de> for EffectTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Effect;

        impl<'de> Visitor<'de> for Effect {
            type Value = EffectTable;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a table with `kind` and the parameters of that effect")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<EffectTable, A::Error> {
                let (mut kind, mut parameters) = (None, BTreeMap::new());
                while let Some(key) = table.next_key::<String>()? {
                    if key == "kind" {
                        kind = Some(table.next_value()?);
                    } else {
                        parameters.insert(key, table.next_value()?);
                    }
                }
                Ok(EffectTable { kind: kind.ok_or_else(|| A::Error::missing_field("kind"))?, parameters })
            }
        }

        deserializer.deserialize_map(Effect)
    }
}
