//! Why there are no rows.

use thiserror::Error;

use crate::recording::RecordingError;
use crate::schema::SchemaError;

/// Why there are no rows.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SignalError {
    /// The recording cannot be read any further.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The recording has no cable signal.
    #[error("the log has no messages on `{topic}`, the topic of the cable signals; {}", available(topics))]
    NoCableTopic {
        /// The topic looked for.
        topic: String,
        /// Those there are.
        topics: Vec<String>,
    },
    /// The cable signal cannot be found in its messages.
    #[error(
        "the messages on `{topic}` cannot be read as cable signals: {source}. Name the right topic, or the path to the \
         forces, as `cable` under `[log]` in the robot file"
    )]
    CableFields {
        /// The topic.
        topic: String,
        /// Why.
        source: SchemaError,
    },
    /// Not one message on the cable topic could be used.
    #[error("no message on `{topic}`, the topic of the cable signals, can be used; the first: {reason}")]
    NoUsableMessage {
        /// The topic.
        topic: String,
        /// What is wrong with the first one.
        reason: String,
    },
    /// There is force but no length.
    #[error(
        "the messages on `{topic}` bring forces but no cable lengths (`position`); name the topic or path of the \
         lengths as `length` under `[log]` in the robot file"
    )]
    NoLength {
        /// The topic.
        topic: String,
    },
}

fn available(topics: &[String]) -> String {
    if topics.is_empty() {
        return "it has no other topics either".to_owned();
    }
    format!("it has {}. Name the right one as `cable` under `[log]` in the robot file", topics.join(", "))
}
