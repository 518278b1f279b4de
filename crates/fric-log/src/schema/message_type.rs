//! The type of a channel's messages.

use std::str;

use prost_reflect::MessageDescriptor;

use crate::path::FieldPath;

use super::decoder::Decoder;
use super::error::SchemaError;
use super::field::{self, FieldKind, FieldType, Wanted};
use super::protobuf::{self, ProtobufNode};
use super::ros2msg::{self, RosNode};
use super::types::TypeTable;

/// The type of a channel's messages, as far as encoding and schema determine it.
///
/// ```
/// use fric_log::schema::{FieldKind, MessageType, Wanted};
///
/// let text = b"builtin_interfaces/Time stamp\nfloat64[] data";
/// let message_type = MessageType::new("cdr", "demo/msg/Forces", "ros2msg", text)?;
/// let data = message_type.field(&"data".parse()?)?;
/// assert_eq!((data.kind, data.many), (FieldKind::Number, true));
///
/// let mut decoder = message_type.decoder(&[
///     Wanted::times("stamp".parse()?),
///     Wanted::numbers("data[-1]".parse()?),
/// ])?;
/// let bytes = [
///     0, 1, 0, 0, // plain CDR, little endian
///     2, 0, 0, 0, 5, 0, 0, 0, // 2 s, 5 ns
///     1, 0, 0, 0, 0, 0, 0, 0, // one element, and padding
///     0, 0, 0, 0, 0, 0, 0x45, 0x40, // 42.0
/// ];
/// let values = decoder.read(&bytes)?;
/// assert_eq!(values.time_nanos(0), Some(2_000_000_005));
/// assert_eq!(values.number(1), Some(42.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MessageType {
    name: String,
    source: Source,
}

#[derive(Debug, Clone)]
enum Source {
    Cdr(TypeTable),
    Json,
    Protobuf(MessageDescriptor),
}

impl MessageType {
    /// Reads a schema. All four texts are those of the log: the channel's message encoding, and the schema's name, encoding and data, empty if a
    /// channel has no schema.
    ///
    /// # Errors
    /// Returns a [`SchemaError`] if the encodings are not supported or the schema is invalid.
    pub fn new(
        message_encoding: &str,
        schema_name: &str,
        schema_encoding: &str,
        schema_data: &[u8],
    ) -> Result<Self, SchemaError> {
        let source = match (message_encoding, schema_encoding) {
            ("cdr", "ros2msg") => {
                let text = str::from_utf8(schema_data).map_err(|error| not_text(schema_name, schema_data, error))?;
                Source::Cdr(ros2msg::parse(schema_name, text)?)
            }
            ("cdr", "ros2idl") => {
                return Err(SchemaError::Idl { name: schema_name.to_owned() });
            }
            ("json", _) => Source::Json,
            ("protobuf", "protobuf") => Source::Protobuf(protobuf::descriptor(schema_name, schema_data)?),
            (message, schema) => {
                return Err(SchemaError::Encoding { message: message.to_owned(), schema: schema.to_owned() });
            }
        };
        Ok(Self { name: schema_name.to_owned(), source })
    }

    /// Returns the schema's name as in the log, such as `sensor_msgs/msg/JointState`.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the type of a field; the empty path denotes the message itself.
    ///
    /// A filter or a slice in the path makes it `many`. For JSON any path gives [`FieldKind::Unknown`].
    ///
    /// # Errors
    /// Returns a [`SchemaError`] if messages of this type have no such field.
    pub fn field(&self, path: &FieldPath) -> Result<FieldType, SchemaError> {
        match &self.source {
            Source::Cdr(types) => field::lookup(RosNode::root(types), path),
            Source::Protobuf(descriptor) => field::lookup(ProtobufNode::Message(descriptor.clone()), path),
            Source::Json => Ok(FieldType { kind: FieldKind::Unknown, many: true, type_name: "JSON".to_owned() }),
        }
    }

    /// Returns a decoder that reads the wanted fields from messages of this type.
    ///
    /// # Errors
    /// Returns a [`SchemaError`] if a wanted field does not exist, is not of the wanted kind, or cannot be reached.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<Decoder, SchemaError> {
        match &self.source {
            Source::Cdr(types) => {
                for wanted in wanted {
                    field::check(RosNode::root(types), wanted)?;
                }
                Decoder::cdr(types, wanted)
            }
            Source::Protobuf(descriptor) => {
                for wanted in wanted {
                    field::check(ProtobufNode::Message(descriptor.clone()), wanted)?;
                }
                Ok(Decoder::protobuf(descriptor.clone(), wanted))
            }
            Source::Json => Ok(Decoder::json(wanted)),
        }
    }
}

fn not_text(name: &str, data: &[u8], error: str::Utf8Error) -> SchemaError {
    let before = data.get(..error.valid_up_to()).unwrap_or_default();
    let line = before.split(|&byte| byte == b'\n').count();
    SchemaError::Syntax {
        name: name.to_owned(),
        line,
        expected: "UTF-8 text",
        found: data.get(error.valid_up_to()).map_or_else(String::new, |byte| format!("byte 0x{byte:02x}")),
    }
}
