//! The byte layout of single MCAP records, parsed from slices in memory.
//!
//! The `mcap` crate's own `parse_record` is not used here: it reserves memory for the string lengths that it reads (up to 4 GiB each) and slices
//! attachments without checks, so a damaged file could abort the process. The functions below return `None` instead, and borrow from the slice rather
//! than allocating by a length found in it.

use std::collections::BTreeMap;

pub(super) use mcap::records::op;

/// Length of opcode and length field before every record.
pub(super) const RECORD_HEADER_LEN: u64 = 9;
/// [`RECORD_HEADER_LEN`] as an index.
pub(super) const HEADER_LEN: usize = 9;
/// Length of channel id, sequence, log time and publish time before a message's payload.
pub(super) const MESSAGE_FIELDS_LEN: usize = 22;
/// Length of the fields of a chunk record before its (compressed) content, without the name of the compression.
const CHUNK_FIXED_LEN: u64 = 40;
/// Length of a record's body that suffices to judge its structure.
pub(super) const CHUNK_PREFIX_LEN: usize = 48;
/// Greatest number of entries in the metadata of a channel or a metadata record; robots' logs have some dozens.
const MOST_ENTRIES: usize = 1 << 16;
/// What a record, or an entry of its metadata, takes in memory beside its own bytes, bytes.
pub(super) const ENTRY_COST: u64 = 128;

/// Takes little-endian fields from the front of a slice.
pub(super) struct Fields<'a> {
    rest: &'a [u8],
}

impl<'a> Fields<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    pub(super) fn bytes(&mut self, length: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(*taken)
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.array::<1>().map(|[byte]| byte)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// Takes bytes that are preceded by a 32-bit length.
    pub(super) fn block(&mut self) -> Option<&'a [u8]> {
        let length = self.u32()?;
        self.bytes(usize::try_from(length).ok()?)
    }

    pub(super) fn text(&mut self) -> Option<&'a str> {
        std::str::from_utf8(self.block()?).ok()
    }

    fn text_map(&mut self) -> Option<BTreeMap<String, String>> {
        let mut entries = Fields::new(self.block()?);
        let mut map = BTreeMap::new();
        while !entries.rest.is_empty() {
            if map.len() == MOST_ENTRIES {
                return None;
            }
            let key = entries.text()?;
            let value = entries.text()?;
            if map.insert(key.to_owned(), value.to_owned()).is_some() {
                return None;
            }
        }
        Some(map)
    }
}

/// Opcode and body length of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RecordHeader {
    pub(super) opcode: u8,
    pub(super) body_len: u64,
}

impl RecordHeader {
    pub(super) fn parse(bytes: &[u8]) -> Option<Self> {
        let mut fields = Fields::new(bytes);
        Some(Self { opcode: fields.u8()?, body_len: fields.u64()? })
    }

    /// Returns the length of header and body together; `None` if the sum overflows, which no file can contain.
    pub(super) fn total_len(self) -> Option<u64> {
        self.body_len.checked_add(RECORD_HEADER_LEN)
    }
}

/// One record inside a buffer: its opcode, its body, and the position of the next one.
pub(super) struct Framed<'a> {
    pub(super) opcode: u8,
    pub(super) body: &'a [u8],
    pub(super) next: usize,
}

/// Returns the record at `offset` of `data`, if it is complete.
#[inline]
pub(super) fn framed_at(data: &[u8], offset: usize) -> Option<Framed<'_>> {
    let (header, rest) = data.get(offset..)?.split_first_chunk::<HEADER_LEN>()?;
    let [opcode, length @ ..] = *header;
    let length = usize::try_from(u64::from_le_bytes(length)).ok()?;
    let body = rest.get(..length)?;
    Some(Framed { opcode, body, next: offset + HEADER_LEN + length })
}

/// The fields before a message's payload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MessageFields {
    pub(super) channel_id: u16,
    pub(super) sequence: u32,
    pub(super) log_time_nanos: u64,
    pub(super) publish_time_nanos: u64,
}

impl MessageFields {
    #[inline]
    pub(super) fn parse(body: &[u8]) -> Option<Self> {
        let [c0, c1, s0, s1, s2, s3, times @ ..] = *body.first_chunk::<MESSAGE_FIELDS_LEN>()?;
        let mut fields = Fields::new(&times);
        Some(Self {
            channel_id: u16::from_le_bytes([c0, c1]),
            sequence: u32::from_le_bytes([s0, s1, s2, s3]),
            log_time_nanos: fields.u64()?,
            publish_time_nanos: fields.u64()?,
        })
    }
}

/// The compression of a chunk's content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Compression {
    None,
    Lz4,
    Zstd,
}

impl Compression {
    /// Returns the name for people.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Lz4 => "lz4",
            Self::Zstd => "zstd",
        }
    }
}

/// A chunk record up to its content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ChunkFields {
    pub(super) start_time_nanos: u64,
    pub(super) end_time_nanos: u64,
    pub(super) uncompressed_len: u64,
    pub(super) uncompressed_crc: u32,
    pub(super) compression: Compression,
    pub(super) stored_len: u64,
    /// Offset of the content from the start of the record's body.
    pub(super) content_at: u64,
}

impl ChunkFields {
    /// Parses the first [`CHUNK_PREFIX_LEN`] bytes of a chunk's body.
    pub(super) fn parse(prefix: &[u8]) -> Option<Self> {
        let mut fields = Fields::new(prefix);
        let start_time_nanos = fields.u64()?;
        let end_time_nanos = fields.u64()?;
        let uncompressed_len = fields.u64()?;
        let uncompressed_crc = fields.u32()?;
        let (compression, name_len) = match fields.block()? {
            b"" => (Compression::None, 0),
            b"lz4" => (Compression::Lz4, 3),
            b"zstd" => (Compression::Zstd, 4),
            _ => return None,
        };
        Some(Self {
            start_time_nanos,
            end_time_nanos,
            uncompressed_len,
            uncompressed_crc,
            compression,
            stored_len: fields.u64()?,
            content_at: CHUNK_FIXED_LEN + name_len,
        })
    }

    /// Returns the length of the record's body according to its own fields.
    pub(super) fn body_len(&self) -> Option<u64> {
        self.content_at.checked_add(self.stored_len)
    }
}

/// A schema record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct SchemaFields<'a> {
    pub(super) id: u16,
    pub(super) name: &'a str,
    pub(super) encoding: &'a str,
    pub(super) data: &'a [u8],
}

impl<'a> SchemaFields<'a> {
    pub(super) fn parse(body: &'a [u8]) -> Option<Self> {
        let mut fields = Fields::new(body);
        Some(Self { id: fields.u16()?, name: fields.text()?, encoding: fields.text()?, data: fields.block()? })
    }
}

/// A channel record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ChannelFields<'a> {
    pub(super) id: u16,
    pub(super) schema_id: u16,
    pub(super) topic: &'a str,
    pub(super) message_encoding: &'a str,
    pub(super) metadata: BTreeMap<String, String>,
}

impl<'a> ChannelFields<'a> {
    pub(super) fn parse(body: &'a [u8]) -> Option<Self> {
        let mut fields = Fields::new(body);
        Some(Self {
            id: fields.u16()?,
            schema_id: fields.u16()?,
            topic: fields.text()?,
            message_encoding: fields.text()?,
            metadata: fields.text_map()?,
        })
    }
}

/// Parses name and entries of a metadata record.
pub(super) fn parse_metadata(body: &[u8]) -> Option<(&str, BTreeMap<String, String>)> {
    let mut fields = Fields::new(body);
    Some((fields.text()?, fields.text_map()?))
}

/// Parses the message count of a statistics record.
pub(super) fn parse_statistics(body: &[u8]) -> Option<u64> {
    Fields::new(body).u64()
}

/// Parses the start of the summary section and its checksum from a footer.
pub(super) fn parse_footer(body: &[u8]) -> Option<(u64, u32)> {
    let mut fields = Fields::new(body);
    let summary_start = fields.u64()?;
    let _summary_offset_start = fields.u64()?;
    Some((summary_start, fields.u32()?))
}

/// An attachment record up to its data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct AttachmentFields<'a> {
    pub(super) log_time_nanos: u64,
    pub(super) create_time_nanos: u64,
    pub(super) name: &'a str,
    pub(super) media_type: &'a str,
    pub(super) data_len: u64,
    /// Offset of the data from the start of the record's body.
    pub(super) data_at: u64,
}

impl<'a> AttachmentFields<'a> {
    /// Length of the checksum after the data.
    const CRC_LEN: u64 = 4;

    pub(super) fn parse(prefix: &'a [u8]) -> Option<Self> {
        let mut fields = Fields::new(prefix);
        let log_time_nanos = fields.u64()?;
        let create_time_nanos = fields.u64()?;
        let name = fields.text()?;
        let media_type = fields.text()?;
        let data_len = fields.u64()?;
        let data_at = prefix.len().checked_sub(fields.rest.len())?;
        Some(Self {
            log_time_nanos,
            create_time_nanos,
            name,
            media_type,
            data_len,
            data_at: u64::try_from(data_at).ok()?,
        })
    }

    /// Returns the length of the record's body according to its own fields.
    pub(super) fn body_len(&self) -> Option<u64> {
        self.data_at.checked_add(self.data_len)?.checked_add(Self::CRC_LEN)
    }
}
