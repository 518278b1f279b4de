//! Errors of writing a log.

use std::path::PathBuf;

use mcap::McapError;
use thiserror::Error;

use crate::output::OutputError;

/// The error of a log that cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The log cannot be put in its place.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The MCAP library reports an error.
    #[error("`{}` cannot be written as MCAP", path.display())]
    Mcap {
        /// Path of the log.
        path: PathBuf,
        /// The cause.
        #[source]
        source: McapError,
    },
    /// Two channels have one topic.
    #[error("topic `{topic}` is written by another channel already; give each channel its own topic")]
    Topic {
        /// The topic.
        topic: String,
    },
    /// A stamp does not fit into the 32 bits of seconds of a ROS 2 header.
    #[error("topic `{topic}`: stamp {stamp_nanos} ns is later than a ROS 2 header can hold (2038-01-19)")]
    Stamp {
        /// The topic.
        topic: String,
        /// The stamp.
        stamp_nanos: u64,
    },
    /// A stamp is too early for messages.
    #[error("a cable message has the stamp {stamp_nanos} ns, before 1970, with which no log can be written")]
    EarlyStamp {
        /// The stamp.
        stamp_nanos: i64,
    },
    /// There is not one number per name.
    #[error("topic `{topic}`: {found} elements of `{field}` for {expected} names")]
    Length {
        /// The topic.
        topic: String,
        /// The message's field.
        field: &'static str,
        /// Number of names of the channel.
        expected: usize,
        /// Number of given elements.
        found: usize,
    },
    /// A name cannot be a constant in a message definition.
    #[error(
        "flag name `{name}` cannot be a constant in a message definition; use letters, digits and `_`, a letter first"
    )]
    FlagName {
        /// The name.
        name: String,
    },
    /// A name cannot be a field in a message definition.
    #[error("`{name}` cannot be a field of a message; use lower-case letters, digits and `_`, a letter first")]
    FieldName {
        /// The name.
        name: String,
    },
    /// A text or list is longer than 32 bits can count.
    #[error("a text or list of {length} entries is too long for a message")]
    TooLong {
        /// Its length.
        length: usize,
    },
}
