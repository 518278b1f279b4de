//! Errors of reading rows.

use std::fmt;
use std::path::PathBuf;

use miette::Diagnostic;
use thiserror::Error;

use super::Part;
use crate::csv_log::CsvError;
use crate::recording::RecordingError;
use crate::schema::SchemaError;

/// The reason why there are no rows.
#[derive(Debug, Diagnostic, Error)]
#[non_exhaustive]
pub enum SignalError {
    /// The recording cannot be read any further.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingError),
    /// The CSV file cannot be read, or lacks required data.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Csv(#[from] CsvError),
    /// The recording has no cable signal.
    #[error("the log has no messages on `{topic}`, the topic of the cable signals; it has {}", available(topics, *other_count))]
    #[diagnostic(help("{}", if topics.is_empty() {
        "Name another recording."
    } else {
        "Name the right one as `cable` under `[log]` in the robot file."
    }))]
    NoCableTopic {
        /// The wanted topic.
        topic: String,
        /// The first of the existing topics.
        topics: Vec<String>,
        /// Number of existing topics beyond these.
        other_count: usize,
    },
    /// The recording has no cable signal, and the beginning of a file, which defines its channels, is lost.
    #[error("the beginning of `{}` is missing, and with it the channels and schemas that say on which topics its messages \
         are: the cable signals on `{topic}` cannot be told from others",
        path.display())]
    #[diagnostic(help("Use a complete copy of the recording."))]
    NoBeginning {
        /// The wanted topic.
        topic: String,
        /// The file.
        path: PathBuf,
    },
    /// The cable signal cannot be found in its messages.
    #[error("the messages on `{topic}` cannot be read as cable signals: {source}")]
    #[diagnostic(help("Name the right topic, or the path to the forces, as `cable` under `[log]` in the robot file."))]
    CableFields {
        /// The topic.
        topic: String,
        /// The reason.
        source: SchemaError,
    },
    /// No message on the cable topic is usable.
    #[error("no message on `{topic}`, the topic of the cable signals, can be used; the first: {reason}")]
    #[diagnostic(help("Compare cables and topics in the robot file with what `fric-cli info` shows of the log."))]
    NoUsableMessage {
        /// The topic.
        topic: String,
        /// The problem of the first one.
        reason: String,
    },
    /// The requested part contains no row.
    #[error("no row of the log is {}: its {} is {row_s:.3} s after its first",
        Between(part),
        if *is_followed { "next" } else { "last" })]
    #[diagnostic(help("Choose a part that it has."))]
    NothingInPart {
        /// The part.
        part: Part,
        /// Time of the last row that was read, s after the first.
        row_s: f64,
        /// Whether this row is after the part, which lies between two rows.
        is_followed: bool,
    },
    /// There is a force but no length.
    #[error("the messages on `{topic}` bring forces but no cable lengths (`position`)")]
    #[diagnostic(help("Name the topic or path of the lengths as `length` under `[log]` in the robot file."))]
    NoLength {
        /// The topic.
        topic: String,
    },
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
        return "no other topics either".to_owned();
    }
    let others = if other_count == 0 { String::new() } else { format!(" and {other_count} others") };
    format!("{}{others}", topics.join(", "))
}
