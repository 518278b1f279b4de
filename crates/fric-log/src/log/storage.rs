//! The storage of a log: properties of its files that its signals do not show.

use super::{Content, Log};

/// The storage of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Storage {
    /// The kind of the files, for people.
    pub kind: &'static str,
    /// Size of all files.
    pub size_bytes: u64,
    /// The chunks of MCAP files; `None` for other files, and if all messages are outside chunks.
    pub chunks: Option<Chunks>,
}

/// The chunks of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Chunks {
    /// Number of chunks.
    pub count: u64,
    /// Their compressions, each once: `zstd`, `lz4` or `none`.
    pub compressions: Vec<&'static str>,
    /// Their size in the files.
    pub stored_bytes: u64,
    /// Their decompressed size, as stated in their headers.
    pub content_bytes: u64,
}

impl Log {
    /// Returns the storage, from the headers of the chunks.
    #[must_use]
    pub fn storage(&self) -> Storage {
        let (kind, chunks) = match &self.content {
            Content::Recording(recording) => ("MCAP", recording.chunks()),
            Content::Bag(_) => ("SQLite of rosbag2", None),
            Content::Csv(_) => ("CSV", None),
        };
        Storage { kind, size_bytes: self.total_bytes(), chunks }
    }
}
