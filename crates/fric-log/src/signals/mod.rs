//! From messages to the robot's signals: what the cycle needs, joined on the time of the cable signals.
//!
//! [`SignalReader`] takes a [`Recording`](crate::recording::Recording) and the paths of the robot file and gives one
//! [`Sample`](fric_core::Sample), a row, per cable message, as a stream: memory does not grow with the length of the log.
//!
//! # Time
//!
//! A message's time is its `header.stamp`, else (no header, or a stamp of zero) its log time. The rows have the times of
//! the cable signal; pose, wrench, reference and, where they come on topics of their own, length and speed are
//! interpolated linearly between the two messages around it. Nothing is extrapolated past the first and the last
//! message, nor bridged over a gap: an interval of more than ten times the usual one.
//!
//! | what a topic does | what is done | counted as |
//! |---|---|---|
//! | same stamp again | the first counts | `duplicate_count` |
//! | one or a few messages with earlier stamps, then on as before | they are left out | `late_count` |
//! | goes on with earlier stamps ([`CLOCK_STEP_MESSAGES`] in a row) | the clock was set back: the stream goes on in the new time | `clock_step_count` |
//! | pauses | rows in between lack that signal; cable signal: no rows | `gap_count` |
//! | a message that does not agree with its schema | it is left out | `undecodable_count` |
//!
//! Messages wait for those of slower topics for at most [`WAIT_NANOS`] of log.
//!
//! # Numbers
//!
//! NaN and infinities pass through: the core flags them for the cable concerned. A cable that a message does not name is
//! NaN in that row. Speed that a log does not have is the change of length over the time since the last row.

mod channel;
mod layout;
mod reader;
mod track;

pub use reader::{SignalError, SignalReader};
pub use track::CLOCK_STEP_MESSAGES;

use crate::path::MessagePath;

/// How long a row waits for messages of other topics, in time of the cable signal.
pub const WAIT_NANOS: i64 = 1_000_000_000;

/// The signals of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// Sensor force, and length and speed unless they have paths of their own.
    Cable,
    /// Cable length.
    Length,
    /// Cable speed.
    Speed,
    /// Cable force measured at the platform.
    Reference,
    /// Pose of the platform.
    Pose,
    /// Outside wrench on the platform.
    Wrench,
}

impl Role {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Cable, Self::Length, Self::Speed, Self::Reference, Self::Pose, Self::Wrench];

    /// Its key under `[log]` in the robot file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Cable => "cable",
            Self::Length => "length",
            Self::Speed => "speed",
            Self::Reference => "reference",
            Self::Pose => "pose",
            Self::Wrench => "wrench",
        }
    }
}

/// Where each signal is; `None` is a signal that is not looked for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SignalPaths {
    paths: [Option<MessagePath>; 6],
}

impl SignalPaths {
    /// Sets the path of a role.
    #[must_use]
    pub fn with(mut self, role: Role, path: Option<MessagePath>) -> Self {
        self.paths[role as usize] = path;
        self
    }

    /// The path of a role.
    #[must_use]
    pub fn get(&self, role: Role) -> Option<&MessagePath> {
        self.paths[role as usize].as_ref()
    }
}

/// What was counted on one topic's way into the rows.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrackCounts {
    /// Messages used.
    pub message_count: u64,
    /// Messages with the stamp of the one before.
    pub duplicate_count: u64,
    /// Single messages behind the time.
    pub late_count: u64,
    /// Times the clock was set back.
    pub clock_step_count: u64,
    /// Pauses.
    pub gap_count: u64,
    /// Messages that could not be decoded.
    pub undecodable_count: u64,
    /// First and last stamp, in nanoseconds.
    pub stamps_nanos: Option<(i64, i64)>,
    /// The usual interval, in nanoseconds.
    pub interval_nanos: f64,
}
