//! Message payloads: from schemas and bytes to the few numbers that are wanted.
//!
//! A [`MessageType`] is read from a schema once; it answers what a field is. Its [`Decoder`] is
//! compiled once for the wanted fields and then reads them from one message after the other.
//!
//! | messages | schemas | |
//! |---|---|---|
//! | `cdr` | `ros2msg` | straight from the bytes, nothing allocated per message |
//! | `json` | any or none | the schema is not looked at: what is wanted must be in the messages |
//! | `protobuf` | `protobuf` | members that are not sent have their default values |
//!
//! Nothing here knows what a signal means, nor which topic it comes from. Numbers pass as they are, NaN and
//! infinities included; JSON's `null` is NaN.

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
