//! Loads one segment: reads, decompresses and checks it, and determines the order of its messages.

use std::fs::File;
use std::io;

use super::damage::DamageKind;
use super::decompress::Decompressor;
use super::record::{Compression, MessageFields, framed_at, op};
use super::segment::{CHUNK_LIMIT_BYTES, Segment};
use super::window::read_into;

/// Log time and position in the content of a message.
pub(super) type MessagePlace = (u64, u32);

/// A segment in memory.
pub(super) struct Loaded {
    /// Index of the segment in the loading order.
    pub(super) segment: usize,
    /// Complete records.
    pub(super) content: Vec<u8>,
    /// The messages sorted by time, if they are not stored in that order.
    pub(super) order: Option<Vec<MessagePlace>>,
    /// Positions of the schemas and channels.
    pub(super) definitions: Vec<u32>,
    pub(super) message_count: u64,
    /// Time of the last message before a break.
    pub(super) last_time_nanos: Option<u64>,
    pub(super) problem: Option<DamageKind>,
}

impl Loaded {
    /// Returns the memory it takes.
    pub(super) fn memory_len(&self) -> u64 {
        let order = self.order.as_ref().map_or(0, Vec::len);
        (self.content.len() + order * size_of::<MessagePlace>()) as u64
    }
}

/// Loads segments, reusing its buffers.
pub(super) struct Loader {
    stored: Vec<u8>,
    decompressor: Decompressor,
}

impl Loader {
    /// Maximum size of a read buffer that is kept for the next chunk.
    const KEPT_LEN: usize = 8 * 1024 * 1024;

    pub(super) fn new() -> Self {
        Self { stored: Vec::new(), decompressor: Decompressor::new() }
    }

    /// Loads a segment into `buffer`.
    pub(super) fn load(
        &mut self,
        file: &File,
        place: usize,
        segment: &Segment,
        mut buffer: Vec<u8>,
    ) -> io::Result<Loaded> {
        let problem = self.read(file, segment, &mut buffer)?;
        if self.stored.capacity() > Self::KEPT_LEN {
            self.stored = Vec::new();
        }
        let mut loaded = Loaded {
            segment: place,
            content: buffer,
            order: None,
            definitions: Vec::new(),
            message_count: 0,
            last_time_nanos: None,
            problem,
        };
        if problem.is_some() {
            loaded.content.clear();
        } else {
            examine(&mut loaded);
            if segment.is_cut {
                loaded.problem = Some(DamageKind::ChunkCut);
            }
        }
        Ok(loaded)
    }

    fn read(&mut self, file: &File, segment: &Segment, content: &mut Vec<u8>) -> io::Result<Option<DamageKind>> {
        if segment.content_len > CHUNK_LIMIT_BYTES {
            return Ok(Some(DamageKind::ChunkTooLarge));
        }
        let (Ok(stored_len), Ok(content_len)) =
            (usize::try_from(segment.stored_len), usize::try_from(segment.content_len))
        else {
            return Ok(Some(DamageKind::ChunkTooLarge));
        };
        // No compressor enlarges data much, so the content size bounds the stored size.
        let slack = match segment.compression {
            Compression::None => 0,
            Compression::Lz4 | Compression::Zstd => content_len / 64 + 64 * 1024,
        };
        let is_short = segment.compression == Compression::None && stored_len < content_len;
        if stored_len > content_len + slack || (is_short && !segment.is_cut) {
            return Ok(Some(DamageKind::ChunkSize));
        }
        let offset = segment.content_offset_bytes;
        if segment.compression == Compression::None {
            read_into(file, content, offset, stored_len)?;
        } else {
            read_into(file, &mut self.stored, offset, stored_len)?;
            let result =
                self.decompressor.decompress(segment.compression, &self.stored, content_len, segment.is_cut, content);
            if let Err(problem) = result {
                return Ok(Some(problem));
            }
        }
        let has_checksum = segment.checksum != 0 && !segment.is_cut;
        if has_checksum && crc32fast::hash(content) != segment.checksum {
            return Ok(Some(DamageKind::ChunkChecksum));
        }
        Ok(None)
    }
}

/// Scans the records, cuts off broken ones, and determines the order of the messages.
fn examine(loaded: &mut Loaded) {
    let mut offset = 0;
    let mut last_time = 0;
    let mut is_sorted = true;
    while let Some(record) = framed_at(&loaded.content, offset) {
        match record.opcode {
            op::MESSAGE => {
                let Some(message) = MessageFields::parse(record.body) else {
                    break;
                };
                is_sorted &= message.log_time_nanos >= last_time;
                last_time = message.log_time_nanos;
                loaded.message_count += 1;
            }
            op::SCHEMA | op::CHANNEL => loaded.definitions.extend(u32::try_from(offset)),
            _ => {}
        }
        offset = record.next;
    }
    if loaded.message_count > 0 {
        loaded.last_time_nanos = Some(last_time);
    }
    if offset < loaded.content.len() {
        loaded.content.truncate(offset);
        loaded.problem = Some(DamageKind::ChunkRecords);
    }
    if !is_sorted {
        loaded.order = Some(sorted_messages(&loaded.content));
    }
}

fn sorted_messages(content: &[u8]) -> Vec<MessagePlace> {
    let mut places = Vec::new();
    let mut offset = 0;
    while let Some(record) = framed_at(content, offset) {
        if record.opcode == op::MESSAGE
            && let Some(message) = MessageFields::parse(record.body)
            && let Ok(place) = u32::try_from(offset)
        {
            places.push((message.log_time_nanos, place));
        }
        offset = record.next;
    }
    // The position breaks ties, so that messages of the same time keep their order.
    places.sort_unstable();
    places
}
