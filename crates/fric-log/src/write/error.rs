//! What can go wrong while a log is written.

use std::path::PathBuf;

use mcap::McapError;
use thiserror::Error;

use crate::output::OutputError;

/// A log that cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The log cannot be put in its place.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The MCAP library refuses.
    #[error("`{}` cannot be written as MCAP", path.display())]
    Mcap {
        /// Where the log was to be.
        path: PathBuf,
        /// The cause.
        #[source]
        source: McapError,
    },
    /// Two channels of one topic.
    #[error("topic `{topic}` is written by another channel already; give each channel its own topic")]
    Topic {
        /// The topic.
        topic: String,
    },
    /// A stamp that the 32 bits of seconds in a ROS 2 header cannot hold.
    #[error("topic `{topic}`: stamp {stamp_nanos} ns is later than a ROS 2 header can hold (2038-01-19)")]
    Stamp {
        /// The topic.
        topic: String,
        /// The stamp.
        stamp_nanos: u64,
    },
    /// A stamp that messages cannot hold.
    #[error("a cable message has the stamp {stamp_nanos} ns, before 1970, with which no log can be written")]
    EarlyStamp {
        /// The stamp.
        stamp_nanos: i64,
    },
    /// Not one number per name.
    #[error("topic `{topic}`: {found} elements of `{field}` for {expected} names")]
    Length {
        /// The topic.
        topic: String,
        /// The message's field.
        field: &'static str,
        /// How many names the channel has.
        expected: usize,
        /// How many elements were given.
        found: usize,
    },
    /// A name that cannot be a constant in a message definition.
    #[error(
        "flag name `{name}` cannot be a constant in a message definition; use letters, digits and `_`, a letter first"
    )]
    FlagName {
        /// The name.
        name: String,
    },
    /// A name that cannot be a field in a message definition.
    #[error("`{name}` cannot be a field of a message; use lower-case letters, digits and `_`, a letter first")]
    FieldName {
        /// The name.
        name: String,
    },
    /// A text or list longer than 32 bits can count.
    #[error("a text or list of {length} entries is too long for a message")]
    TooLong {
        /// Its length.
        length: usize,
    },
}
