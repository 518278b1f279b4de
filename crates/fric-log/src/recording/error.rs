//! Errors that make a recording unreadable as a whole.
//!
//! Damage inside a recording that can be skipped is not an error; see [`Damage`](super::Damage).

use std::io;
use std::path::PathBuf;

use miette::Diagnostic;

/// The reason why a recording, or a requested part of it, cannot be read.
#[derive(Debug, Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// No path was given.
    #[error("no recording was named")]
    #[diagnostic(help("Give at least one MCAP file."))]
    NoFiles,
    /// The file does not exist.
    #[error("there is no file `{}`", path.display())]
    #[diagnostic(help("Check the path."))]
    Missing {
        /// The path as given.
        path: PathBuf,
    },
    /// The path is a directory.
    #[error("`{}` is a directory without a recording (`.mcap`, `.db3`)", path.display())]
    #[diagnostic(help("Name the log in it."))]
    Directory {
        /// The path as given.
        path: PathBuf,
    },
    /// The path is a pipe or a device.
    #[error("`{}` is not a regular file", path.display())]
    #[diagnostic(help("Save the recording to a file first."))]
    NotAFile {
        /// The path as given.
        path: PathBuf,
    },
    /// The file exists but may not be read.
    #[error("`{}` may not be read", path.display())]
    #[diagnostic(help("Check its permissions."))]
    Forbidden {
        /// The path as given.
        path: PathBuf,
    },
    /// The file could not be opened for another reason, which is the source.
    #[error("`{}` could not be opened", path.display())]
    #[diagnostic(help("Try again, or check the disk and the limit of open files (`ulimit -n`)."))]
    Open {
        /// The path as given.
        path: PathBuf,
        /// Message of the operating system.
        source: io::Error,
    },
    /// The file has no bytes.
    #[error("`{}` is empty (0 bytes): the recorder wrote nothing, or the copy did not finish", path.display())]
    #[diagnostic(help("Copy the recording again, or name another one."))]
    Empty {
        /// The path as given.
        path: PathBuf,
    },
    /// Nothing in the file looks like MCAP.
    #[error("`{}` is not an MCAP recording, and no CSV table or rosbag2 either: {found}", path.display())]
    NotMcap {
        /// The path as given.
        path: PathBuf,
        /// What the file looks like instead.
        found: &'static str,
        /// What to do.
        #[help]
        advice: &'static str,
    },
    /// An SQLite file is not a bag, or cannot be read at all.
    #[error("`{}` cannot be read as a rosbag2 database: {reason}", path.display())]
    #[diagnostic(help("Copy the recording again, or name another one."))]
    NotBag {
        /// The path as given.
        path: PathBuf,
        /// The problem.
        reason: String,
    },
    /// A folder contains files of both kinds.
    #[error("`{}` holds a bag of MCAP files and one of SQLite files", path.display())]
    #[diagnostic(help("Name the files of one of them."))]
    SeveralStorages {
        /// The folder.
        path: PathBuf,
    },
    /// The operating system failed to read bytes that should exist.
    #[error("`{}` could not be read at byte {offset_bytes}", path.display())]
    #[diagnostic(help("Check the disk, or copy the file and try again."))]
    Read {
        /// The path as given.
        path: PathBuf,
        /// Position at which reading failed.
        offset_bytes: u64,
        /// Message of the operating system.
        source: io::Error,
    },
    /// The content of an attachment does not match its checksum.
    #[error("the attachment `{name}` at byte {offset_bytes} of `{}` is damaged (checksum {found:#010x} instead of {expected:#010x})",
        path.display())]
    #[diagnostic(help("Take it from another copy of the recording."))]
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
    #[error("the attachment `{name}` at byte {offset_bytes} of `{}` has {size_bytes} bytes, more than the {limit_bytes} that can be read",
        path.display())]
    #[diagnostic(help("Extract it with another tool."))]
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
    #[error("the thread that reads ahead could not be started")]
    #[diagnostic(help("Free some memory or raise the process limit."))]
    StartReader {
        /// Message of the operating system.
        source: io::Error,
    },
    /// The read-ahead thread ended because of a bug.
    #[error("the thread that reads ahead ended unexpectedly, by a bug in fric")]
    #[diagnostic(help("Please report it with the recording."))]
    ReaderStopped,
}
