//! Errors of reading rows.

use std::fmt;
use std::path::PathBuf;

use thiserror::Error;

use super::Part;
use crate::csv_log::CsvError;
use crate::recording::RecordingError;
use crate::schema::SchemaError;

/// Advice, each the end of a sentence.
mod advice {
    pub const TOPIC: &str = "Name the right one as `cable` under `[log]` in the robot file";
    pub const TOPIC_OR_PATH: &str =
        "Name the right topic, or the path to the forces, as `cable` under `[log]` in the robot file";
    pub const LENGTH: &str = "name the topic or path of the lengths as `length` under `[log]` in the robot file";
    pub const PART: &str = "choose a part that it has";
    pub const NAMES: &str = "compare cables and topics in the robot file with what `fric-cli info` shows of the log";
    pub const OTHER: &str = "name another recording";
    pub const BEGINNING: &str = "use a complete copy of the recording";
}

/// The reason why there are no rows.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SignalError {
    /// The recording cannot be read any further.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The CSV file cannot be read, or lacks required data.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// The recording has no cable signal.
    #[error("the log has no messages on `{topic}`, the topic of the cable signals; {}", available(topics, *other_count))]
    NoCableTopic {
        /// The wanted topic.
        topic: String,
        /// The first of the existing topics.
        topics: Vec<String>,
        /// Number of existing topics beyond these.
        other_count: usize,
    },
    /// The recording has no cable signal, and the beginning of a file, which defines its channels, is lost.
    #[error(
        "the beginning of `{}` is missing, and with it the channels and schemas that say on which topics its messages \
         are: the cable signals on `{topic}` cannot be told from others; {}",
        path.display(), advice::BEGINNING
    )]
    NoBeginning {
        /// The wanted topic.
        topic: String,
        /// The file.
        path: PathBuf,
    },
    /// The cable signal cannot be found in its messages.
    #[error("the messages on `{topic}` cannot be read as cable signals: {source}. {}", advice::TOPIC_OR_PATH)]
    CableFields {
        /// The topic.
        topic: String,
        /// The reason.
        source: SchemaError,
    },
    /// No message on the cable topic is usable.
    #[error(
        "no message on `{topic}`, the topic of the cable signals, can be used; the first: {reason}; {}",
        advice::NAMES
    )]
    NoUsableMessage {
        /// The topic.
        topic: String,
        /// The problem of the first one.
        reason: String,
    },
    /// The requested part contains no row.
    #[error(
        "no row of the log is {}: its {} is {row_s:.3} s after its first; {}",
        Between(part),
        if *is_followed { "next" } else { "last" },
        advice::PART
    )]
    NothingInPart {
        /// The part.
        part: Part,
        /// Time of the last row that was read, s after the first.
        row_s: f64,
        /// Whether this row is after the part, which lies between two rows.
        is_followed: bool,
    },
    /// There is a force but no length.
    #[error("the messages on `{topic}` bring forces but no cable lengths (`position`); {}", advice::LENGTH)]
    NoLength {
        /// The topic.
        topic: String,
    },
}

impl SignalError {
    /// Returns the advice that ends the error's sentence, if there is any.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Recording(error) => error.advice(),
            Self::Csv(error) => Some(error.advice()),
            Self::NoCableTopic { topics, .. } => Some(if topics.is_empty() { advice::OTHER } else { advice::TOPIC }),
            Self::NoBeginning { .. } => Some(advice::BEGINNING),
            Self::CableFields { .. } => Some(advice::TOPIC_OR_PATH),
            Self::NoUsableMessage { .. } => Some(advice::NAMES),
            Self::NothingInPart { .. } => Some(advice::PART),
            Self::NoLength { .. } => Some(advice::LENGTH),
        }
    }
}

/// Formats a part in words.
struct Between<'a>(&'a Part);

impl fmt::Display for Between<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self.0 {
            Part { start_s: Some(start_s), end_s: Some(end_s) } => write!(f, "from {start_s} s to before {end_s} s"),
            Part { start_s: Some(start_s), end_s: None } => write!(f, "from {start_s} s on"),
            Part { start_s: None, end_s: Some(end_s) } => write!(f, "before {end_s} s"),
            Part { start_s: None, end_s: None } => write!(f, "there"),
        }
    }
}

fn available(topics: &[String], other_count: usize) -> String {
    if topics.is_empty() {
        return format!("it has no other topics either; {}", advice::OTHER);
    }
    let others = if other_count == 0 { String::new() } else { format!(" and {other_count} others") };
    format!("it has {}{others}. {}", topics.join(", "), advice::TOPIC)
}
