//! A stretch of a file that is loaded at once, and what is known about it beforehand.

use super::record::Compression;

/// Maximum decompressed size of a chunk; a larger one counts as damaged.
pub const CHUNK_LIMIT_BYTES: u64 = 128 * 1024 * 1024;

/// A chunk, or a run of messages that are not in chunks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Segment {
    /// Index of the file in the recording.
    pub(super) file: u32,
    /// Index among all segments in the order of the files; breaks ties between messages of the same time.
    pub(super) rank: u32,
    /// Position of its first record.
    pub(super) offset_bytes: u64,
    /// Position of its content.
    pub(super) content_offset_bytes: u64,
    /// Size of the content in the file, as far as the file goes.
    pub(super) stored_len: u64,
    /// Stated size of the decompressed content, which is never exceeded.
    pub(super) content_len: u64,
    /// The log time at which it must be loaded: not later than its messages begin.
    pub(super) load_time_nanos: u64,
    pub(super) start_time_nanos: u64,
    pub(super) end_time_nanos: u64,
    /// Checksum; zero if there is none.
    pub(super) checksum: u32,
    pub(super) compression: Compression,
    /// Whether the file ends inside the content.
    pub(super) is_cut: bool,
    /// Whether it is a chunk record rather than a run of messages.
    pub(super) is_chunk: bool,
}

impl Segment {
    /// Returns the end of its content in the file.
    pub(super) fn end_offset_bytes(&self) -> u64 {
        self.content_offset_bytes.saturating_add(self.stored_len)
    }

    /// Returns its size in the file.
    pub(super) fn file_len(&self) -> u64 {
        self.end_offset_bytes().saturating_sub(self.offset_bytes)
    }

    /// Whether it states to be empty; its times are meaningless then.
    pub(super) fn is_blank(&self) -> bool {
        self.content_len == 0 || (self.start_time_nanos == 0 && self.end_time_nanos == 0)
    }

    /// Returns the greatest memory that loading it takes: none if it is too large to be loaded at all.
    pub(super) fn memory_len(&self) -> u64 {
        if self.content_len > CHUNK_LIMIT_BYTES { 0 } else { self.content_len }
    }

    /// Returns the key of the loading order.
    pub(super) fn load_key(&self) -> (u64, u32) {
        (self.load_time_nanos, self.rank)
    }
}
