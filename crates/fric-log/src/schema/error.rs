//! Errors of schemas, wanted fields, and messages.

use thiserror::Error;

/// The error of an unusable schema, or of a field that its messages do not have.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SchemaError {
    /// The messages, or their schema, are encoded in a way that is not supported.
    #[error(
        "messages of encoding `{message}` with a schema of encoding `{schema}` are not supported; \
         supported are `cdr` with `ros2msg`, `json`, and `protobuf` with `protobuf`"
    )]
    Encoding {
        /// The message encoding in the log.
        message: String,
        /// The schema encoding in the log.
        schema: String,
    },
    /// The schema is IDL, which rosbag2 writes only where it finds no `.msg` definition.
    #[error(
        "schema `{name}` is written in IDL (`ros2idl`), which is not supported; \
         record again on a system where the `.msg` definition is installed, so that `ros2msg` is written"
    )]
    Idl {
        /// The schema's name.
        name: String,
    },
    /// A line of a `ros2msg` schema is not a message definition.
    #[error("schema `{name}`, line {line}: expected {expected}, found `{found}`")]
    Syntax {
        /// The schema's name.
        name: String,
        /// Line, counted from 1 over the whole schema text.
        line: usize,
        /// What is expected there.
        expected: &'static str,
        /// What is there instead.
        found: String,
    },
    /// A `ros2msg` schema uses a type it does not define.
    #[error(
        "schema `{name}`, line {line}: type `{type_name}` is not defined in the schema; \
         the log's writer must append its definition"
    )]
    UnknownType {
        /// The schema's name.
        name: String,
        /// Line that uses the type.
        line: usize,
        /// The type as written.
        type_name: String,
    },
    /// The same type, or the same field of a type, is defined twice.
    #[error("schema `{name}`, line {line}: `{twice}` is defined a second time; remove one of the two")]
    Duplicate {
        /// The schema's name.
        name: String,
        /// Line of the second definition.
        line: usize,
        /// The type or field.
        twice: String,
    },
    /// A type contains itself.
    #[error("schema `{name}`, line {line}: type `{type_name}` contains itself, so no message of it can end")]
    Recursive {
        /// The schema's name.
        name: String,
        /// Line of the field that closes the cycle.
        line: usize,
        /// The type.
        type_name: String,
    },
    /// The schema is nested too deeply or unrolls into too many fields.
    #[error("schema `{name}` is too large: more than {limit} {what}")]
    TooLarge {
        /// The schema's name.
        name: String,
        /// The limit.
        limit: usize,
        /// What is limited.
        what: &'static str,
    },
    /// A `protobuf` schema is not a usable `FileDescriptorSet`.
    #[error("schema `{name}` is not a usable protobuf FileDescriptorSet: {cause}")]
    Protobuf {
        /// The schema's name.
        name: String,
        /// What the protobuf library found.
        cause: String,
    },
    /// A path names a member that the type does not have.
    #[error("`{path}`: {type_name} has no member `{member}`; it has {available}")]
    NoMember {
        /// The whole field path.
        path: String,
        /// The type at that point.
        type_name: String,
        /// The requested name.
        member: String,
        /// The existing names.
        available: String,
    },
    /// A path continues in a way that the field does not allow.
    #[error("`{path}`: {found} is at this place, which needs {expected}")]
    Path {
        /// The whole field path.
        path: String,
        /// What the path has reached, with the part of the path that leads to it.
        found: String,
        /// How the path must continue.
        expected: &'static str,
    },
    /// A field is not of the wanted kind.
    #[error("`{path}` is {found}, but {wanted} is wanted there")]
    Kind {
        /// The whole field path.
        path: String,
        /// The field's type.
        found: String,
        /// The wanted kind.
        wanted: &'static str,
    },
    /// A wanted field is, or comes after, a `wstring`.
    #[error(
        "`{path}` is or follows the wstring `{wide}`, whose width in bytes differs between middlewares \
         and is not recorded; use a field before it"
    )]
    WideText {
        /// The wanted field.
        path: String,
        /// The `wstring` field.
        wide: String,
    },
}

/// The error of a message whose bytes do not agree with its schema.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// The message has no encapsulation header of a supported kind.
    #[error(
        "the message starts with the CDR representation {found}; supported are plain CDR and plain CDR2 \
         in either byte order"
    )]
    Representation {
        /// The two identifying bytes, or what is missing.
        found: String,
    },
    /// The message ends within a field.
    #[error(
        "the message ends within field `{field}`, at byte {offset} of {length}; it is cut short or not of its schema"
    )]
    Truncated {
        /// The field, or the first of several unread ones in a row.
        field: String,
        /// Position of the field, or of its missing part.
        offset: usize,
        /// Length of the message, in bytes.
        length: usize,
    },
    /// An array or text states a length that exceeds the rest of the message.
    #[error(
        "field `{field}`, byte {offset}: {count} elements are announced, but the message has only {remaining} bytes left; \
         it is damaged or not of its schema"
    )]
    Count {
        /// The field.
        field: String,
        /// Position of the count.
        offset: usize,
        /// The count.
        count: usize,
        /// Bytes left after the count.
        remaining: usize,
    },
    /// A text is not UTF-8.
    #[error("field `{field}`, byte {offset}: the text is not UTF-8")]
    Text {
        /// The field.
        field: String,
        /// Position of the text.
        offset: usize,
    },
    /// The message is larger than any of signals.
    #[error("the message has {bytes} bytes, where signals have {most_bytes} at most")]
    Large {
        /// Its size.
        bytes: usize,
        /// The greatest size that is read.
        most_bytes: usize,
    },
    /// The message is not JSON.
    #[error("the message is not valid JSON: {cause}")]
    Json {
        /// What the JSON library found.
        cause: String,
    },
    /// The message is not protobuf.
    #[error("the message is not valid protobuf: {cause}")]
    Protobuf {
        /// What the protobuf library found.
        cause: String,
    },
    /// A JSON message lacks a member.
    #[error("field `{field}` is missing in the message: {place} has no member `{member}`")]
    Missing {
        /// The wanted field.
        field: String,
        /// What was searched.
        place: &'static str,
        /// The missing name.
        member: String,
    },
    /// A value is not of the wanted kind.
    #[error("field `{field}` holds {found}, but {wanted} is wanted there")]
    Kind {
        /// The wanted field.
        field: String,
        /// What the message contains.
        found: &'static str,
        /// The wanted kind.
        wanted: &'static str,
    },
    /// A time does not fit into 64 bits of nanoseconds, or its nanoseconds are a second or more.
    #[error(
        "field `{field}`: the time is out of range (64 bits of nanoseconds, less than a second of them in `nanosec`)"
    )]
    TimeRange {
        /// The wanted field.
        field: String,
    },
}
