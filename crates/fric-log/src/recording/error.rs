//! Errors that make a recording unreadable as a whole.
//!
//! Damage inside a recording that can be skipped is not an error; see [`Damage`](super::Damage).

use std::io;
use std::path::PathBuf;

/// Advice, each the end of a sentence.
mod advice {
    pub const NAME: &str = "give at least one MCAP file";
    pub const PATH: &str = "check the path";
    pub const DIRECTORY: &str = "name the log in it";
    pub const PIPE: &str = "save the recording to a file first";
    pub const PERMISSIONS: &str = "check its permissions";
    pub const EMPTY: &str = "copy the recording again, or name another one";
    pub const ONE: &str = "name the files of one of them";
    pub const OPEN: &str = "try again, or check the disk and the limit of open files (`ulimit -n`)";
    pub const DISK: &str = "check the disk, or copy the file and try again";
    pub const COPY: &str = "take it from another copy of the recording";
    pub const EXTRACT: &str = "extract it with another tool";
    pub const MEMORY: &str = "free some memory or raise the process limit";
    pub const REPORT: &str = "please report it with the recording";
}

/// The reason why a recording, or a requested part of it, cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// No path was given.
    #[error("no recording was named; {}", advice::NAME)]
    NoFiles,
    /// The file does not exist.
    #[error("there is no file `{}`; {}", path.display(), advice::PATH)]
    Missing {
        /// The path as given.
        path: PathBuf,
    },
    /// The path is a directory.
    #[error("`{}` is a directory without a recording (`.mcap`, `.db3`); {}", path.display(), advice::DIRECTORY)]
    Directory {
        /// The path as given.
        path: PathBuf,
    },
    /// The path is a pipe or a device.
    #[error("`{}` is not a regular file; {}", path.display(), advice::PIPE)]
    NotAFile {
        /// The path as given.
        path: PathBuf,
    },
    /// The file exists but may not be read.
    #[error("`{}` may not be read; {}", path.display(), advice::PERMISSIONS)]
    Forbidden {
        /// The path as given.
        path: PathBuf,
    },
    /// The file could not be opened for another reason, which is the source.
    #[error("`{}` could not be opened; {}", path.display(), advice::OPEN)]
    Open {
        /// The path as given.
        path: PathBuf,
        /// Message of the operating system.
        source: io::Error,
    },
    /// The file has no bytes.
    #[error("`{}` is empty (0 bytes): the recorder wrote nothing, or the copy did not finish; {}", path.display(), advice::EMPTY)]
    Empty {
        /// The path as given.
        path: PathBuf,
    },
    /// Nothing in the file looks like MCAP.
    #[error("`{}` is not an MCAP recording, and no CSV table or rosbag2 either: {found}; {advice}", path.display())]
    NotMcap {
        /// The path as given.
        path: PathBuf,
        /// What the file looks like instead.
        found: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// An SQLite file is not a bag, or cannot be read at all.
    #[error("`{}` cannot be read as a rosbag2 database: {reason}; {}", path.display(), advice::EMPTY)]
    NotBag {
        /// The path as given.
        path: PathBuf,
        /// The problem.
        reason: String,
    },
    /// A folder contains files of both kinds.
    #[error("`{}` holds a bag of MCAP files and one of SQLite files; {}", path.display(), advice::ONE)]
    SeveralStorages {
        /// The folder.
        path: PathBuf,
    },
    /// The operating system failed to read bytes that should exist.
    #[error("`{}` could not be read at byte {offset_bytes}; {}", path.display(), advice::DISK)]
    Read {
        /// The path as given.
        path: PathBuf,
        /// Position at which reading failed.
        offset_bytes: u64,
        /// Message of the operating system.
        source: io::Error,
    },
    /// The content of an attachment does not match its checksum.
    #[error(
        "the attachment `{name}` at byte {offset_bytes} of `{}` is damaged (checksum {found:#010x} instead of {expected:#010x}); {}",
        path.display(), advice::COPY
    )]
    AttachmentChecksum {
        /// The attachment's name.
        name: String,
        /// The file it is in.
        path: PathBuf,
        /// Start of its record.
        offset_bytes: u64,
        /// The checksum in the file.
        expected: u32,
        /// The checksum of the bytes in the file.
        found: u32,
    },
    /// An attachment is too large for memory.
    #[error(
        "the attachment `{name}` at byte {offset_bytes} of `{}` has {size_bytes} bytes, more than the {limit_bytes} that can be read; {}",
        path.display(), advice::EXTRACT
    )]
    AttachmentTooLarge {
        /// The attachment's name.
        name: String,
        /// The file it is in.
        path: PathBuf,
        /// Start of its record.
        offset_bytes: u64,
        /// Its size.
        size_bytes: u64,
        /// Greatest readable size.
        limit_bytes: u64,
    },
    /// The thread that reads ahead could not be started.
    #[error("the thread that reads ahead could not be started; {}", advice::MEMORY)]
    StartReader {
        /// Message of the operating system.
        source: io::Error,
    },
    /// The read-ahead thread ended because of a bug.
    #[error("the thread that reads ahead ended unexpectedly, by a bug in fric; {}", advice::REPORT)]
    ReaderStopped,
}

impl RecordingError {
    /// Returns the advice that ends the error's sentence, if there is any.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        Some(match self {
            Self::NoFiles => advice::NAME,
            Self::Missing { .. } => advice::PATH,
            Self::Directory { .. } => advice::DIRECTORY,
            Self::NotAFile { .. } => advice::PIPE,
            Self::Forbidden { .. } => advice::PERMISSIONS,
            Self::Open { .. } => advice::OPEN,
            Self::Empty { .. } | Self::NotBag { .. } => advice::EMPTY,
            Self::NotMcap { advice, .. } => advice,
            Self::SeveralStorages { .. } => advice::ONE,
            Self::Read { .. } => advice::DISK,
            Self::AttachmentChecksum { .. } => advice::COPY,
            Self::AttachmentTooLarge { .. } => advice::EXTRACT,
            Self::StartReader { .. } => advice::MEMORY,
            Self::ReaderStopped => advice::REPORT,
        })
    }
}
