//! Messages of encoding `protobuf`, described by a `FileDescriptorSet`.
//!
//! A message is decoded as a whole and then searched; members that were not sent have their default values. `google.protobuf.Timestamp` and
//! `Duration` are times. Maps and `bytes` cannot be read.

use std::borrow::Cow;

use prost_reflect::{DescriptorPool, DynamicMessage, FieldDescriptor, Kind, MessageDescriptor, Value};

use super::error::{DecodeError, SchemaError};
use super::field::{FieldKind, TypeNode, Wanted};
use super::node::{self, Node};
use super::time::{self, OutOfRange};
use super::values::Values;

const TIME_TYPES: [&str; 2] = ["google.protobuf.Timestamp", "google.protobuf.Duration"];

/// Finds the message type `name` in an encoded `FileDescriptorSet`.
pub(super) fn descriptor(name: &str, data: &[u8]) -> Result<MessageDescriptor, SchemaError> {
    let error = |cause| SchemaError::Protobuf { name: name.to_owned(), cause };
    let pool = DescriptorPool::decode(data).map_err(|cause| error(cause.to_string()))?;
    pool.get_message_by_name(name).ok_or_else(|| error("it does not define this message".to_owned()))
}

pub(super) fn read(
    descriptor: &MessageDescriptor,
    data: &[u8],
    wanted: &[Wanted],
    values: &mut Values,
) -> Result<(), DecodeError> {
    let message = DynamicMessage::decode(descriptor.clone(), data)
        .map_err(|error| DecodeError::Protobuf { cause: error.to_string() })?;
    let root = Value::Message(message);
    for (slot, wanted) in values.begin().iter_mut().zip(wanted) {
        node::read(&root, wanted, slot)?;
    }
    values.finish();
    Ok(())
}

impl Node for Value {
    fn member(&self, name: &str) -> Option<Cow<'_, Self>> {
        self.as_message()?.get_field_by_name(name)
    }

    fn elements(&self) -> Option<&[Self]> {
        self.as_list()
    }

    fn number(&self) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "documented: nearest number beyond 2^53")]
        Some(match self {
            Self::Bool(value) => f64::from(u8::from(*value)),
            Self::I32(value) | Self::EnumNumber(value) => f64::from(*value),
            Self::I64(value) => *value as f64,
            Self::U32(value) => f64::from(*value),
            Self::U64(value) => *value as f64,
            Self::F32(value) => f64::from(*value),
            Self::F64(value) => *value,
            _ => return None,
        })
    }

    fn text(&self) -> Option<&str> {
        self.as_str()
    }

    fn time_nanos(&self) -> Option<Result<i64, OutOfRange>> {
        let seconds = self.member("seconds")?.as_i64()?;
        let nanos = self.member("nanos")?.as_i32()?;
        Some(time::from_parts(seconds, nanos.into()))
    }

    fn describe(&self) -> &'static str {
        match self {
            Self::Bool(_) => "a truth value",
            Self::String(_) => "a text",
            Self::Bytes(_) => "bytes",
            Self::Message(_) => "a message",
            Self::List(_) => "an array",
            Self::Map(_) => "a map",
            _ => "a number",
        }
    }
}

/// A protobuf type as seen by field lookup.
pub(super) enum ProtobufNode {
    Message(MessageDescriptor),
    Field { field: FieldDescriptor, array: bool },
}

impl ProtobufNode {
    fn message(&self) -> Option<MessageDescriptor> {
        match self {
            Self::Message(message) => Some(message.clone()),
            Self::Field { field, .. } => match field.kind() {
                Kind::Message(message) if !field.is_map() => Some(message),
                _ => None,
            },
        }
    }
}

impl TypeNode for ProtobufNode {
    fn kind(&self) -> FieldKind {
        if let Some(message) = self.message() {
            return if TIME_TYPES.contains(&message.full_name()) { FieldKind::Time } else { FieldKind::Message };
        }
        match self {
            Self::Field { field, .. } if !field.is_map() => match field.kind() {
                Kind::String => FieldKind::Text,
                Kind::Bytes => FieldKind::Other,
                _ => FieldKind::Number,
            },
            _ => FieldKind::Other,
        }
    }

    fn type_name(&self) -> String {
        match (self.message(), self) {
            (Some(message), _) => message.full_name().to_owned(),
            (None, Self::Field { field, .. }) if !field.is_map() => match field.kind() {
                Kind::Enum(kind) => kind.full_name().to_owned(),
                kind => format!("{kind:?}").to_lowercase(),
            },
            _ => "map".to_owned(),
        }
    }

    fn is_array(&self) -> bool {
        matches!(self, Self::Field { array: true, .. })
    }

    fn element(self) -> Self {
        match self {
            Self::Field { field, .. } => Self::Field { field, array: false },
            Self::Message(_) => self,
        }
    }

    fn member(&self, name: &str) -> Option<Self> {
        let field = self.message()?.get_field_by_name(name)?;
        let array = field.is_list();
        Some(Self::Field { field, array })
    }

    fn member_names(&self) -> Vec<String> {
        let message = self.message();
        let fields = message.iter().flat_map(MessageDescriptor::fields);
        fields.map(|field| field.name().to_owned()).collect()
    }
}
