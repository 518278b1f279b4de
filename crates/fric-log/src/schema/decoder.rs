//! The decoder of one channel, for any encoding.

use prost_reflect::MessageDescriptor;

use super::cdr::CdrReader;
use super::error::{DecodeError, SchemaError};
use super::field::Wanted;
use super::types::TypeTable;
use super::values::Values;
use super::{json, protobuf};

/// Reads the wanted fields of one channel's messages; made by [`MessageType::decoder`](super::MessageType::decoder).
///
/// It owns its buffers, which are about as large as the wanted data of the largest message so far.
#[derive(Debug, Clone)]
pub struct Decoder {
    reader: Reader,
    values: Values,
}

/// Greatest size of a message that is read, bytes: thousands of times that of a robot's signals. What is read of JSON takes many times its size.
const MOST_BYTES: usize = 16 << 20;
const MOST_JSON_BYTES: usize = 4 << 20;

#[derive(Debug, Clone)]
enum Reader {
    Cdr(Box<CdrReader>),
    Json(Vec<Wanted>),
    Protobuf(MessageDescriptor, Vec<Wanted>),
}

impl Decoder {
    /// Reads one message. The values belong to this message only, except for [`Texts::revision`](super::Texts::revision).
    ///
    /// # Errors
    /// Returns a [`DecodeError`] if the bytes do not agree with the schema. The next message can still be read.
    pub fn read(&mut self, data: &[u8]) -> Result<&Values, DecodeError> {
        let most_bytes = if matches!(self.reader, Reader::Json(_)) { MOST_JSON_BYTES } else { MOST_BYTES };
        if data.len() > most_bytes {
            return Err(DecodeError::Large { bytes: data.len(), most_bytes });
        }
        match &mut self.reader {
            Reader::Cdr(reader) => reader.read(data, &mut self.values)?,
            Reader::Json(wanted) => json::read(data, wanted, &mut self.values)?,
            Reader::Protobuf(descriptor, wanted) => {
                protobuf::read(descriptor, data, wanted, &mut self.values)?;
            }
        }
        Ok(&self.values)
    }

    pub(super) fn cdr(types: &TypeTable, wanted: &[Wanted]) -> Result<Self, SchemaError> {
        let (reader, slots) = CdrReader::new(types, wanted)?;
        Ok(Self { reader: Reader::Cdr(Box::new(reader)), values: Values::new(wanted.len(), slots) })
    }

    pub(super) fn json(wanted: &[Wanted]) -> Self {
        Self { reader: Reader::Json(wanted.to_vec()), values: Values::new(wanted.len(), wanted.len()) }
    }

    pub(super) fn protobuf(descriptor: MessageDescriptor, wanted: &[Wanted]) -> Self {
        Self { reader: Reader::Protobuf(descriptor, wanted.to_vec()), values: Values::new(wanted.len(), wanted.len()) }
    }
}
