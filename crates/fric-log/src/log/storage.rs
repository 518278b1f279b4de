//! How a log is kept: what of a file its signals do not say.

use super::{Content, Log};

/// How a log is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Storage {
    /// What the files are, for people.
    pub kind: &'static str,
    /// The size of all files.
    pub size_bytes: u64,
    /// The chunks of MCAP files; `None` for other files, and where messages stand outside chunks only.
    pub chunks: Option<Chunks>,
}

/// The chunks of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Chunks {
    /// How many there are.
    pub count: u64,
    /// Their compressions, each once: `zstd`, `lz4` or `none`.
    pub compressions: Vec<&'static str>,
    /// Their size in the files.
    pub stored_bytes: u64,
    /// Their size when decompressed, as their headers have it.
    pub content_bytes: u64,
}

impl Log {
    /// How it is kept, by the headers of its chunks.
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
