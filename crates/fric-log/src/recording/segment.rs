//! A stretch of a file that is loaded at once, and what is known of it before.

use super::record::Compression;

/// The most that one chunk may hold when decompressed; a larger one is counted as damaged.
pub const CHUNK_LIMIT_BYTES: u64 = 128 * 1024 * 1024;

/// A chunk, or a run of messages that are not in chunks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Segment {
    /// Place of the file in the recording.
    pub(super) file: u32,
    /// Place among all segments in the order of the files; breaks ties between messages of the same time.
    pub(super) rank: u32,
    /// Where its first record starts.
    pub(super) offset_bytes: u64,
    /// Where its content starts.
    pub(super) content_offset_bytes: u64,
    /// Size of the content in the file, as far as the file goes.
    pub(super) stored_len: u64,
    /// Size of the content when decompressed, as claimed: never is more than this kept.
    pub(super) content_len: u64,
    /// From this log time on it has to be loaded: not later than its messages begin.
    pub(super) load_time_nanos: u64,
    pub(super) start_time_nanos: u64,
    pub(super) end_time_nanos: u64,
    /// Zero if there is none.
    pub(super) checksum: u32,
    pub(super) compression: Compression,
    /// The file ends inside the content.
    pub(super) is_cut: bool,
    /// A chunk record, not a run of messages.
    pub(super) is_chunk: bool,
}

impl Segment {
    /// Where its content ends in the file.
    pub(super) fn end_offset_bytes(&self) -> u64 {
        self.content_offset_bytes.saturating_add(self.stored_len)
    }

    /// Its size in the file.
    pub(super) fn file_len(&self) -> u64 {
        self.end_offset_bytes().saturating_sub(self.offset_bytes)
    }

    /// Whether it claims to hold nothing; its times mean nothing then.
    pub(super) fn is_blank(&self) -> bool {
        self.content_len == 0 || (self.start_time_nanos == 0 && self.end_time_nanos == 0)
    }

    /// The most memory that loading it takes: none if it is too large to be loaded at all.
    pub(super) fn memory_len(&self) -> u64 {
        if self.content_len > CHUNK_LIMIT_BYTES { 0 } else { self.content_len }
    }

    /// The order in which segments have to be loaded.
    pub(super) fn load_key(&self) -> (u64, u32) {
        (self.load_time_nanos, self.rank)
    }
}
