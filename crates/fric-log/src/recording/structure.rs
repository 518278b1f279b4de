//! Decides whether the bytes at some offset are an MCAP record, and finds the next one after damage.
//!
//! Almost every record states its size twice: in its header, and by the lengths of its fields. A record whose two sizes agree is accepted; if they
//! differ, the one that leads to another record wins. Messages and unknown records have no inner size and are accepted if another record follows.

use std::io;

use super::record::{
    CHUNK_PREFIX_LEN, ChunkFields, Fields, HEADER_LEN, MESSAGE_FIELDS_LEN, MessageFields, RECORD_HEADER_LEN,
    RecordHeader, framed_at, op,
};
use super::window::Window;

/// Number of bytes of a body that are examined to find its size: enough for any sensible name before the last length.
const PREFIX_LEN: usize = 4096;

/// Number of bytes of a message that are examined to distinguish it from other records.
const MESSAGE_PREFIX_LEN: usize = 512;
/// Maximum size of records without variable fields, with room for fields of newer formats.
const SMALL_LEN: u64 = 1024;
/// Size above which a record is rejected.
const IMPOSSIBLE_LEN: u64 = 1 << 40;

/// The content at an offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// A record that ends within the file. `repaired`: its header was wrong and has been corrected.
    Whole { header: RecordHeader, repaired: bool },
    /// A chunk whose fields before its content are broken, but whose end is known.
    BrokenChunk { body_len: u64 },
    /// A record that is intact as far as the file goes.
    Cut(RecordHeader),
    /// A message that ends within the file, but nothing readable follows.
    Suspect(RecordHeader),
    /// No record.
    None,
}

/// One field of a record's layout.
#[derive(Clone, Copy)]
enum Field {
    /// This many bytes.
    Fixed(usize),
    /// Bytes preceded by a 32-bit length.
    Block,
    /// Bytes preceded by a 64-bit length.
    LongBlock,
}

/// Returns the fields of a record type that states its own size.
fn layout(opcode: u8) -> Option<&'static [Field]> {
    use Field::{Block, Fixed, LongBlock};
    Some(match opcode {
        op::HEADER | op::METADATA => &[Block, Block],
        op::FOOTER => &[Fixed(20)],
        op::SCHEMA => &[Fixed(2), Block, Block, Block],
        op::CHANNEL => &[Fixed(4), Block, Block, Block],
        op::CHUNK => &[Fixed(28), Block, LongBlock],
        op::MESSAGE_INDEX => &[Fixed(2), Block],
        op::CHUNK_INDEX => &[Fixed(32), Block, Fixed(8), Block, Fixed(16)],
        op::ATTACHMENT => &[Fixed(16), Block, Block, LongBlock, Fixed(4)],
        op::ATTACHMENT_INDEX => &[Fixed(40), Block, Block],
        op::STATISTICS => &[Fixed(42), Block],
        op::METADATA_INDEX => &[Fixed(16), Block],
        op::SUMMARY_OFFSET => &[Fixed(17)],
        op::DATA_END => &[Fixed(4)],
        _ => return None,
    })
}

/// Returns the size of a body according to its inner lengths; `None` if the prefix is too short or the record has none.
fn described_len(opcode: u8, prefix: &[u8]) -> Option<u64> {
    let mut total = 0_u64;
    for field in layout(opcode)? {
        let rest = prefix.get(usize::try_from(total).ok()?..);
        total = match field {
            Field::Fixed(length) => total.checked_add(*length as u64)?,
            Field::Block => {
                let length = Fields::new(rest?).u32()?;
                total.checked_add(4 + u64::from(length))?
            }
            Field::LongBlock => {
                let length = Fields::new(rest?).u64()?;
                total.checked_add(8)?.checked_add(length)?
            }
        };
    }
    Some(total)
}

/// Consecutive messages.
pub(super) struct MessageBatch {
    pub(super) len: usize,
    pub(super) count: u64,
    pub(super) start_time_nanos: u64,
    pub(super) end_time_nanos: u64,
}

impl MessageBatch {
    /// Finds those messages at the start of `bytes` that [`judge`] would accept, each followed by another one. `rest` is the length of the file from
    /// there on.
    pub(super) fn find(bytes: &[u8], rest: u64) -> Self {
        let mut batch = Self { len: 0, count: 0, start_time_nanos: u64::MAX, end_time_nanos: 0 };
        while let Some(record) = framed_at(bytes, batch.len)
            && record.opcode == op::MESSAGE
            && let Some(message) = MessageFields::parse(record.body)
            && let Some(next) = bytes.get(record.next..).and_then(RecordHeader::parse)
            && next.opcode == op::MESSAGE
            && (MESSAGE_FIELDS_LEN as u64..=rest).contains(&next.body_len)
            && disguised(record.body, record.body.len() as u64, false).is_none()
        {
            batch.len = record.next;
            batch.count += 1;
            batch.start_time_nanos = batch.start_time_nanos.min(message.log_time_nanos);
            batch.end_time_nanos = batch.end_time_nanos.max(message.log_time_nanos);
        }
        batch
    }
}

/// Returns the original opcode of a supposed message after a single bit flip, if its body matches that record to the byte.
///
/// Only opcodes that a message cannot resemble by chance are considered: a header is expected only at the start of the file, and a message would need
/// a very special time to resemble a channel.
fn disguised(prefix: &[u8], body_len: u64, is_first: bool) -> Option<u8> {
    let is_like = |opcode| described_len(opcode, prefix) == Some(body_len);
    if is_first && is_like(op::HEADER) {
        Some(op::HEADER)
    } else if is_like(op::CHANNEL) {
        Some(op::CHANNEL)
    } else {
        None
    }
}

/// Whether a supposed message has the structure of a message index.
pub(super) fn looks_like_message_index(prefix: &[u8], body_len: u64) -> bool {
    /// Length of an entry: log time and offset.
    const ENTRY_LEN: u64 = 16;
    described_len(op::MESSAGE_INDEX, prefix) == Some(body_len) && body_len % ENTRY_LEN == 6
}

fn is_known(opcode: u8) -> bool {
    (op::HEADER..=op::DATA_END).contains(&opcode)
}

/// Returns the end of a body of `body_len` after the record header at `offset`, if it is within `file_len`.
fn end_within(offset: u64, body_len: u64, file_len: u64) -> Option<u64> {
    offset.checked_add(RECORD_HEADER_LEN)?.checked_add(body_len).filter(|end| *end <= file_len)
}

/// Judges the record at `offset`.
pub(super) fn judge(window: &mut Window<'_>, offset: u64) -> io::Result<Verdict> {
    let file_len = window.file_len();
    let Some(header) = RecordHeader::parse(window.bytes(offset, HEADER_LEN)?) else {
        return Ok(Verdict::None);
    };
    let whole = |opcode, body_len, repaired| Verdict::Whole { header: RecordHeader { opcode, body_len }, repaired };
    let outer_end = end_within(offset, header.body_len, file_len);
    let body_offset = offset.saturating_add(RECORD_HEADER_LEN);
    if header.opcode == op::MESSAGE {
        let Some(end) = outer_end.filter(|_| header.body_len >= MESSAGE_FIELDS_LEN as u64) else {
            return Ok(Verdict::None);
        };
        let prefix = window.bytes(body_offset, MESSAGE_PREFIX_LEN)?;
        let is_first = offset == mcap::MAGIC.len() as u64;
        if let Some(opcode) = disguised(prefix, header.body_len, is_first) {
            return Ok(whole(opcode, header.body_len, true));
        }
        return Ok(if follows(window, end)? {
            whole(op::MESSAGE, header.body_len, false)
        } else {
            Verdict::Suspect(header)
        });
    }

    let prefix = window.bytes(body_offset, PREFIX_LEN)?;
    let described = described_len(header.opcode, prefix);
    let chunk = ChunkFields::parse(prefix.get(..CHUNK_PREFIX_LEN).unwrap_or(prefix));
    let chunk_len = chunk.as_ref().and_then(ChunkFields::body_len);

    if described == Some(header.body_len) && (header.opcode != op::CHUNK || chunk.is_some()) {
        return Ok(match outer_end {
            Some(_) => whole(header.opcode, header.body_len, false),
            None => Verdict::Cut(header),
        });
    }
    // A record that is a chunk in everything but its opcode counts as a chunk.
    if chunk_len == Some(header.body_len) && outer_end.is_some() {
        return Ok(whole(op::CHUNK, header.body_len, true));
    }
    if header.opcode == 0 {
        return Ok(Verdict::None);
    }
    let is_readable = header.opcode != op::CHUNK || chunk.is_some();
    let outer_leads_on = match outer_end {
        Some(end) => follows(window, end)?,
        None => false,
    };
    // Fields of a newer format follow the known ones, or the record is unknown.
    if outer_leads_on && is_readable && described.is_none_or(|length| length < header.body_len) {
        let is_damaged_chunk = match (header.opcode, described) {
            (op::CHUNK, Some(length)) => !leads_on(window, offset, length)?,
            _ => false,
        };
        return Ok(whole(header.opcode, header.body_len, is_damaged_chunk));
    }
    if is_readable
        && let Some(length) = described
        && leads_on(window, offset, length)?
    {
        return Ok(whole(header.opcode, length, true));
    }
    Ok(match (header.opcode, outer_leads_on, is_readable) {
        // The inner length is wrong, so the checksum decides about the content.
        (op::CHUNK, true, true) => whole(op::CHUNK, header.body_len, true),
        (op::CHUNK, true, false) => Verdict::BrokenChunk { body_len: header.body_len },
        _ => Verdict::None,
    })
}

/// Whether another record follows a body of `body_len` after the record header at `offset`.
fn leads_on(window: &mut Window<'_>, offset: u64, body_len: u64) -> io::Result<bool> {
    match end_within(offset, body_len, window.file_len()) {
        Some(end) => follows(window, end),
        None => Ok(false),
    }
}

/// Whether a record, or the end of the file, can begin at `offset`. Examines only the header.
fn follows(window: &mut Window<'_>, offset: u64) -> io::Result<bool> {
    let rest = window.file_len().saturating_sub(offset);
    let bytes = window.bytes(offset, HEADER_LEN)?;
    if rest < RECORD_HEADER_LEN {
        // The end, the closing magic, or a truncated header.
        return Ok(bytes.first().is_none_or(|first| is_known(*first)) || mcap::MAGIC.starts_with(bytes));
    }
    let Some(header) = RecordHeader::parse(bytes) else {
        return Ok(false);
    };
    let fits = header.total_len().is_some_and(|total| total <= rest);
    // A known record may be truncated, but not by terabytes.
    Ok(match header.opcode {
        op::MESSAGE => header.body_len >= MESSAGE_FIELDS_LEN as u64 && (fits || header.body_len < IMPOSSIBLE_LEN),
        op::DATA_END => fits && (4..=SMALL_LEN).contains(&header.body_len),
        op::FOOTER => fits && (20..=SMALL_LEN).contains(&header.body_len),
        opcode if is_known(opcode) => fits || header.body_len < IMPOSSIBLE_LEN,
        opcode => opcode >= 0x80 && fits,
    })
}

/// Whether a record begins at `offset` beyond reasonable doubt, as a search through arbitrary bytes requires.
fn is_certain(window: &mut Window<'_>, offset: u64) -> io::Result<bool> {
    match judge(window, offset)? {
        Verdict::Whole { header, repaired: false } => {
            let Some(end) = end_within(offset, header.body_len, window.file_len()) else {
                return Ok(false);
            };
            if header.opcode != op::MESSAGE {
                return Ok(is_known(header.opcode) && follows(window, end)?);
            }
            // Messages are the least distinctive records, so a second one is required, unless the file ends there.
            let next = RecordHeader::parse(window.bytes(end, HEADER_LEN)?);
            match next.and_then(|next| end_within(end, next.body_len, window.file_len())) {
                Some(next_end) => follows(window, next_end),
                None => Ok(true),
            }
        }
        Verdict::Cut(header) => Ok(header.opcode == op::CHUNK && header.body_len < IMPOSSIBLE_LEN),
        _ => Ok(false),
    }
}

/// Returns the first offset from `start` on at which a record certainly begins, or the closing magic is found.
pub(super) fn find_record(window: &mut Window<'_>, start: u64) -> io::Result<Option<u64>> {
    let mut offset = start;
    loop {
        let bytes = window.buffered(offset)?;
        let candidate = bytes.windows(HEADER_LEN).position(is_candidate);
        if let Some(position) = candidate {
            offset += position as u64;
            if is_certain(window, offset)? {
                return Ok(Some(offset));
            }
            offset += 1;
            continue;
        }
        let searched = bytes.len().saturating_sub(HEADER_LEN - 1) as u64;
        if searched == 0 && window.bytes(offset, HEADER_LEN)?.len() < HEADER_LEN {
            break;
        }
        offset += searched;
    }
    let magic_at = window.file_len().saturating_sub(mcap::MAGIC.len() as u64);
    let is_magic = window.bytes(magic_at, mcap::MAGIC.len())? == mcap::MAGIC;
    Ok((is_magic && magic_at >= start).then_some(magic_at))
}

/// Whether the bytes are a known opcode and a length below a terabyte.
fn is_candidate(bytes: &[u8]) -> bool {
    matches!(bytes, [opcode, _, _, _, _, _, 0, 0, 0] if is_known(*opcode))
}
