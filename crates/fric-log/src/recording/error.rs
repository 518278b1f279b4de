//! What can make a recording unreadable as a whole.
//!
//! Damage inside a recording that can be skipped is not an error; see [`Damage`](super::Damage).

use std::io;
use std::path::PathBuf;

/// Why a recording, or a part of it that was asked for, cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// No path was given.
    #[error("no recording was named; give at least one MCAP file")]
    NoFiles,
    /// There is no such file.
    #[error("there is no file `{}`; check the path", path.display())]
    Missing {
        /// The path as given.
        path: PathBuf,
    },
    /// The path is a directory.
    #[error("`{}` is a directory; name the MCAP file (or files) in it", path.display())]
    Directory {
        /// The path as given.
        path: PathBuf,
    },
    /// The path is a pipe or a device.
    #[error("`{}` is not a regular file; save the recording to a file first", path.display())]
    NotAFile {
        /// The path as given.
        path: PathBuf,
    },
    /// The file exists but may not be read.
    #[error("`{}` may not be read; check its permissions", path.display())]
    Forbidden {
        /// The path as given.
        path: PathBuf,
    },
    /// The file could not be opened for another reason, which is the source.
    #[error("`{}` could not be opened", path.display())]
    Open {
        /// The path as given.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The file has no bytes.
    #[error("`{}` is empty (0 bytes); the recorder wrote nothing, or the copy did not finish", path.display())]
    Empty {
        /// The path as given.
        path: PathBuf,
    },
    /// Nothing in the file looks like MCAP.
    #[error("`{}` is not an MCAP recording; {hint}", path.display())]
    NotMcap {
        /// The path as given.
        path: PathBuf,
        /// What the file looks like instead and what to do.
        hint: &'static str,
    },
    /// The operating system failed to read bytes it had promised.
    #[error("`{}` could not be read at byte {offset_bytes}; check the disk, or copy the file and try again", path.display())]
    Read {
        /// The path as given.
        path: PathBuf,
        /// Where reading failed.
        offset_bytes: u64,
        /// What the operating system said.
        source: io::Error,
    },
    /// The content of an attachment does not fit its checksum.
    #[error(
        "the attachment `{name}` at byte {offset_bytes} of `{}` is damaged (checksum {found:#010x} instead of {expected:#010x}); take it from another copy of the recording",
        path.display()
    )]
    AttachmentChecksum {
        /// The attachment's name.
        name: String,
        /// The file it is in.
        path: PathBuf,
        /// Where its record starts.
        offset_bytes: u64,
        /// The checksum in the file.
        expected: u32,
        /// The checksum of the bytes in the file.
        found: u32,
    },
    /// An attachment is too large to be held in memory.
    #[error(
        "the attachment `{name}` at byte {offset_bytes} of `{}` has {size_bytes} bytes, more than the {limit_bytes} that can be read; extract it with another tool",
        path.display()
    )]
    AttachmentTooLarge {
        /// The attachment's name.
        name: String,
        /// The file it is in.
        path: PathBuf,
        /// Where its record starts.
        offset_bytes: u64,
        /// Its size.
        size_bytes: u64,
        /// The most that is read.
        limit_bytes: u64,
    },
    /// The thread that reads ahead could not be started.
    #[error("the thread that reads ahead could not be started; free some memory or raise the process limit")]
    StartReader {
        /// What the operating system said.
        source: io::Error,
    },
    /// The thread that reads ahead ended by a bug.
    #[error(
        "the thread that reads ahead ended unexpectedly; this is a bug in fric, please report it with the recording"
    )]
    ReaderStopped,
}
