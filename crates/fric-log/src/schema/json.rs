//! Messages of encoding `json`.
//!
//! The schema is ignored, because Foxglove's JSON Schemas leave too much open to determine a field's type. Numbers may be written as such, as `true`
//! and `false`, as `null` (NaN), or as text (`"NaN"`, `"-Infinity"`, or 64-bit integers as in protobuf's JSON mapping). Times may be `{"sec": …,
//! "nanosec": …}` (or `nsec`), RFC 3339 texts, or numbers of seconds.

use std::borrow::Cow;

use serde_json::Value;

use super::error::DecodeError;
use super::field::Wanted;
use super::node::{self, Node};
use super::time::{self, OutOfRange};
use super::values::Values;

pub(super) fn read(data: &[u8], wanted: &[Wanted], values: &mut Values) -> Result<(), DecodeError> {
    let root: Value = serde_json::from_slice(data).map_err(|error| DecodeError::Json { cause: error.to_string() })?;
    for (slot, wanted) in values.begin().iter_mut().zip(wanted) {
        node::read(&root, wanted, slot)?;
    }
    values.finish();
    Ok(())
}

impl Node for Value {
    fn member(&self, name: &str) -> Option<Cow<'_, Self>> {
        self.get(name).map(Cow::Borrowed)
    }

    fn elements(&self) -> Option<&[Self]> {
        self.as_array().map(Vec::as_slice)
    }

    fn number(&self) -> Option<f64> {
        match self {
            Self::Null => Some(f64::NAN),
            Self::Bool(value) => Some(f64::from(u8::from(*value))),
            Self::Number(number) => number.as_f64(),
            Self::String(text) => text.parse().ok(),
            Self::Array(_) | Self::Object(_) => None,
        }
    }

    fn text(&self) -> Option<&str> {
        self.as_str()
    }

    fn time_nanos(&self) -> Option<Result<i64, OutOfRange>> {
        match self {
            Self::Object(members) => {
                let nanos = members.get("nanosec").or_else(|| members.get("nsec"))?;
                Some(time::from_parts(integer(members.get("sec")?)?, integer(nanos)?))
            }
            Self::String(text) => time::from_rfc3339(text),
            Self::Number(number) => match number.as_i64() {
                Some(seconds) => Some(time::from_parts(seconds, 0)),
                None => Some(time::from_seconds(number.as_f64()?)),
            },
            _ => None,
        }
    }

    fn describe(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "a truth value",
            Self::Number(_) => "a number",
            Self::String(_) => "a text",
            Self::Array(_) => "an array",
            Self::Object(_) => "an object",
        }
    }
}

/// Returns an integer, which may be written as text.
fn integer(value: &Value) -> Option<i64> {
    match value {
        Value::String(text) => text.parse().ok(),
        value => value.as_i64(),
    }
}
