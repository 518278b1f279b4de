//! Message payloads: extracts the few wanted numbers from bytes by means of schemas.
//!
//! A [`MessageType`] is read from a schema once and describes its fields. Its [`Decoder`] is compiled once for the wanted fields and then reads them
//! from one message after the other.
//!
//! | messages | schemas | |
//! |---|---|---|
//! | `cdr` | `ros2msg` | straight from the bytes, nothing allocated per message |
//! | `json` | any or none | the schema is not looked at: what is wanted must be in the messages |
//! | `protobuf` | `protobuf` | members that are not sent have their default values |
//!
//! This module knows neither the meaning of a signal nor its topic. Numbers are passed on unchanged, including NaN and infinities; JSON's `null` is
//! NaN.

mod cdr;
mod decoder;
mod error;
mod field;
mod json;
mod message_type;
mod node;
mod protobuf;
mod ros2msg;
mod time;
mod types;
mod values;

pub use decoder::Decoder;
pub use error::{DecodeError, SchemaError};
pub use field::{FieldKind, FieldType, Wanted, WantedKind};
pub use message_type::MessageType;
pub use values::{Texts, Values};
