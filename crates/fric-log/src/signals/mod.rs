//! From messages to the robot's signals: what the cycle needs, joined on the time of the cable signals.
//!
//! [`SignalReader`] takes a [`Log`](crate::log::Log) and the paths of the robot file and gives one
//! [`Sample`](fric_core::Sample), a row, per cable message, as a stream: memory does not grow with the length of the log.
//! Of CSV, the filled cells of a row are the messages, so that all that follows holds of it too.
//!
//! # Time
//!
//! A message's time is its `header.stamp` (else a `stamp` or `timestamp` beside the data, or nearer to the root), else
//! (none, or zero) its log time. The rows have the times of the cable signal; pose, wrench, reference and, where they come
//! on topics of their own, length and speed are interpolated linearly between the two messages around it; a message of
//! the row's very time is passed bit by bit. Nothing is extrapolated past the first and the last message, nor bridged over
//! a gap: an interval of more than ten times the longest usual one. Usual are the last 32 intervals, the longest eighth
//! left out; the first eight are judged by one another.
//!
//! | what a topic does | what is done | counted as |
//! |---|---|---|
//! | same stamp again, of cables not named there yet | the messages are one | nothing |
//! | same stamp again | the first counts | `duplicate_count` |
//! | names now these, now those cables at different stamps | the others are NaN in that row | `partial_count` |
//! | one or a few messages with earlier stamps, then on as before | they are left out | `late_count` |
//! | goes on with earlier stamps ([`CLOCK_STEP_MESSAGES`] that follow one another) | the clock was set back: the stream goes on in the new time | `clock_step_count` |
//! | pauses | rows in between lack that signal; cable signal: no rows | `gap_count` |
//! | a message that does not agree with its schema, has not one number per name, or a name twice | it is left out | `undecodable_count` |
//! | a message about other cables, or without what the path selects | it is left out | nothing |
//!
//! A row waits for the messages of other topics that come later in the log: for [`WAIT_NANOS`] of log time, and while no
//! topic has more than [`WAITING_LIMIT`] messages waiting. What comes later still is as if it had not come. When several
//! topics' clocks are set back together, each is followed when the rows get there, whichever notices first; once the cable
//! signal's is known to be, one message of another topic is enough.
//!
//! # Numbers
//!
//! NaN and infinities pass through: the core flags them for the cable concerned. A cable that a message does not name is
//! NaN in that row. A quaternion that is none, such as all zeros, gives no pose; the sign of a quaternion does not matter.
//!
//! Speed that a message does not have (an empty `velocity`, or NaN in it) is the derivative of the parabola through the lengths last
//! known before, in, and first known after the row ([`KnownLength::speed_m_per_s`]), also over a gap.
//!
//! A pose that is computed from the cable lengths ([`SignalPaths::with_pose_from_lengths`], [`fric_core::forward`]) is that of the lengths of each row; a row whose lengths
//! give none has none.
//!
//! A reference that is known and not measured ([`SignalPaths::with_known_reference`]) is that of every cable in each row in
//! which the cable has a sensor force; under a hanging mass only while the cable is in quiet motion.

mod apart;
mod channel;
mod error;
mod hanging;
mod layout;
mod lengths;
mod order;
mod pace;
mod part;
mod reader;
mod row;
mod speed;
mod track;
mod waiting;

pub use apart::TimesApart;
pub use error::SignalError;
pub(crate) use layout::{Probe, STAMPS};
pub use lengths::LengthPoses;
pub use part::Part;
pub use reader::SignalReader;
pub use speed::KnownLength;
pub use track::CLOCK_STEP_MESSAGES;

use std::collections::BTreeMap;
use std::sync::Arc;

use fric_core::KnownReference;
use fric_core::robot::file::{ColumnTable, RobotFile};

use crate::path::MessagePath;

/// How long a row waits for messages of other topics, in log time.
pub const WAIT_NANOS: u64 = 10_000_000_000;
/// How many messages of a topic wait at most: for rows, or rows for them.
pub const WAITING_LIMIT: usize = 16_384;

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
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SignalPaths {
    paths: [Option<MessagePath>; 6],
    known_reference: Option<KnownReference>,
    columns: BTreeMap<String, ColumnTable>,
    pose_robot: Option<Arc<RobotFile>>,
}

impl SignalPaths {
    /// Sets the path of a role; that of the reference takes the place of a known one, that of the pose of one from the lengths.
    #[must_use]
    pub fn with(mut self, role: Role, path: Option<MessagePath>) -> Self {
        self.paths[role as usize] = path;
        if role == Role::Reference {
            self.known_reference = None;
        }
        if role == Role::Pose {
            self.pose_robot = None;
        }
        self
    }

    /// Sets a reference that is known, in place of one in the log.
    #[must_use]
    pub fn with_known_reference(self, reference: KnownReference) -> Self {
        Self { known_reference: Some(reference), ..self.with(Role::Reference, None) }
    }

    /// The reference that is known and not looked for in the log.
    #[must_use]
    pub fn known_reference(&self) -> Option<KnownReference> {
        self.known_reference
    }

    /// Has the pose computed from the cable lengths, by the geometry of this robot, in place of one in the log.
    #[must_use]
    pub fn with_pose_from_lengths(self, robot: Arc<RobotFile>) -> Self {
        Self { pose_robot: Some(robot), ..self.with(Role::Pose, None) }
    }

    /// The robot by whose geometry the pose is computed from the cable lengths; `None` where it is looked for in the log.
    #[must_use]
    pub fn pose_robot(&self) -> Option<&Arc<RobotFile>> {
        self.pose_robot.as_ref()
    }

    /// Sets the columns that a CSV log calls otherwise than by default, by the keys of `[log.columns]`.
    #[must_use]
    pub fn with_columns(self, columns: BTreeMap<String, ColumnTable>) -> Self {
        Self { columns, ..self }
    }

    /// The columns that a CSV log calls otherwise than by default.
    #[must_use]
    pub fn columns(&self) -> &BTreeMap<String, ColumnTable> {
        &self.columns
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
    /// Messages with the stamp of the one before, and nothing new.
    pub duplicate_count: u64,
    /// Times at which messages named only some of the cables that the topic has named.
    pub partial_count: u64,
    /// Single messages behind the time.
    pub late_count: u64,
    /// Times the clock was set back.
    pub clock_step_count: u64,
    /// Pauses.
    pub gap_count: u64,
    /// Messages that could not be used.
    pub undecodable_count: u64,
    /// First and last stamp, in nanoseconds.
    pub stamps_nanos: Option<(i64, i64)>,
    /// The usual interval (median of the last 32), in nanoseconds.
    pub interval_nanos: f64,
}
