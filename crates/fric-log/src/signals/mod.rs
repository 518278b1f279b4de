//! Converts messages to the robot's signals: the inputs of the cycle, joined on the times of the cable signals.
//!
//! [`SignalReader`] takes a [`Log`](crate::log::Log) and the paths of the robot file and streams one [`Sample`](fric_core::Sample), a row, per cable
//! message; memory does not grow with the length of the log. In CSV, the filled cells of a row act as messages, so everything below applies to it
//! too.
//!
//! # Time
//!
//! A message's time is its `header.stamp` (or a `stamp` or `timestamp` beside the data, or nearer to the root), else (if there is none, or it is
//! zero) its log time. The rows have the times of the cable signal. Pose, wrench, reference and, if they have their own topics, length and speed are
//! interpolated linearly between the two surrounding messages; a message with exactly the row's time is passed on unchanged. Values are neither
//! extrapolated past the first and the last message nor interpolated over a gap: an interval of more than ten times the longest usual one. The usual
//! ones are the last 32 intervals without the longest eighth; the first eight are judged by one another.
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
//! A row waits for later messages of other topics: for [`WAIT_NANOS`] of log time, and while no topic has more than [`WAITING_LIMIT`] waiting
//! messages. Messages that come even later are ignored. If the clocks of several topics are set back together, each topic follows when the rows reach
//! that time, whichever is noticed first; once the step of the cable signal is known, one message of another topic suffices.
//!
//! # Numbers
//!
//! NaN and infinities are passed on: the core flags them for the cable concerned. A cable that a message does not name is NaN in that row. An invalid
//! quaternion, such as all zeros, gives no pose; the sign of a quaternion does not matter.
//!
//! A missing speed (an empty `velocity`, or NaN in it) is the slope of the known lengths of the cable around the row, one to twenty on each side, as
//! many as their noise asks for ([`LengthWindow`]). With [`SignalPaths::with_speed_from_lengths`] every speed is.
//!
//! With a pose from the cable lengths ([`SignalPaths::with_pose_from_lengths`], [`fric_core::forward`]), each row has the pose of its own lengths; a
//! row whose lengths give no pose has none.
//!
//! A known reference ([`SignalPaths::with_known_reference`]) applies to every cable in each row in which the cable has a sensor force; under a
//! hanging mass only while the cable is in quiet motion.

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
mod stated;
mod track;
mod waiting;

pub use apart::TimesApart;
pub use error::SignalError;
pub(crate) use layout::{Probe, STAMPS};
pub use lengths::LengthPoses;
pub use part::Part;
pub use reader::SignalReader;
pub use speed::LengthWindow;
pub use stated::StatedSignals;
pub use track::CLOCK_STEP_MESSAGES;

use std::collections::BTreeMap;
use std::sync::Arc;

use fric_core::KnownReference;
use fric_core::robot::file::{ColumnTable, RobotFile};

use crate::path::MessagePath;

/// Maximum time that a row waits for messages of other topics, in log time.
pub const WAIT_NANOS: u64 = 10_000_000_000;
/// Maximum number of waiting messages of a topic: for rows, or rows for them.
pub const WAITING_LIMIT: usize = 16_384;

/// The signals of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// Sensor force, and length and speed unless they have their own paths.
    Cable,
    /// Cable length.
    Length,
    /// Cable speed.
    Speed,
    /// Cable force measured at the platform.
    Reference,
    /// Pose of the platform.
    Pose,
    /// External wrench on the platform.
    Wrench,
}

impl Role {
    /// All roles.
    pub const ALL: [Self; 6] = [Self::Cable, Self::Length, Self::Speed, Self::Reference, Self::Pose, Self::Wrench];

    /// Returns its key under `[log]` in the robot file.
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

/// The location of each signal; `None` for a signal that is not read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SignalPaths {
    paths: [Option<MessagePath>; 6],
    known_reference: Option<KnownReference>,
    columns: BTreeMap<String, ColumnTable>,
    pose_robot: Option<Arc<RobotFile>>,
    speed_is_from_lengths: bool,
}

impl SignalPaths {
    /// Sets the path of a role. A path of the reference replaces a known one, a path of the pose or the speed replaces one from the lengths.
    #[must_use]
    pub fn with(mut self, role: Role, path: Option<MessagePath>) -> Self {
        self.paths[role as usize] = path;
        if role == Role::Reference {
            self.known_reference = None;
        }
        if role == Role::Pose {
            self.pose_robot = None;
        }
        if role == Role::Speed {
            self.speed_is_from_lengths = false;
        }
        self
    }

    /// Sets a known reference, which replaces one in the log.
    #[must_use]
    pub fn with_known_reference(self, reference: KnownReference) -> Self {
        Self { known_reference: Some(reference), ..self.with(Role::Reference, None) }
    }

    /// Returns the known reference, which is not read from the log.
    #[must_use]
    pub fn known_reference(&self) -> Option<KnownReference> {
        self.known_reference
    }

    /// Returns the known reference if it is the same in every row, N.
    pub(self) fn constant_reference_n(&self) -> Option<f64> {
        self.known_reference.and_then(|known| match known {
            KnownReference::Constant { force_n } => Some(force_n),
            KnownReference::HangingMass { .. } => None,
        })
    }

    /// Lets the pose be computed from the cable lengths with the geometry of this robot, which replaces one in the log.
    #[must_use]
    pub fn with_pose_from_lengths(self, robot: Arc<RobotFile>) -> Self {
        Self { pose_robot: Some(robot), ..self.with(Role::Pose, None) }
    }

    /// Returns the robot with whose geometry the pose is computed from the cable lengths; `None` if it is read from the log.
    #[must_use]
    pub fn pose_robot(&self) -> Option<&Arc<RobotFile>> {
        self.pose_robot.as_ref()
    }

    /// Lets the speed be derived from the cable lengths, even if the log has speeds.
    #[must_use]
    pub fn with_speed_from_lengths(self) -> Self {
        Self { speed_is_from_lengths: true, ..self.with(Role::Speed, None) }
    }

    /// Whether the speed is derived from the cable lengths even if the log has speeds.
    #[must_use]
    pub fn speed_is_from_lengths(&self) -> bool {
        self.speed_is_from_lengths
    }

    /// Returns the paths for a table, whose rows contain lengths and speeds with the forces.
    pub(self) fn of_table(mut self) -> Self {
        self.paths[Role::Length as usize] = None;
        self.paths[Role::Speed as usize] = None;
        self
    }

    /// Sets the columns of a CSV log whose names differ from the defaults, by the keys of `[log.columns]`.
    #[must_use]
    pub fn with_columns(self, columns: BTreeMap<String, ColumnTable>) -> Self {
        Self { columns, ..self }
    }

    /// Returns the columns of a CSV log whose names differ from the defaults.
    #[must_use]
    pub fn columns(&self) -> &BTreeMap<String, ColumnTable> {
        &self.columns
    }

    /// Returns the path of a role.
    #[must_use]
    pub fn get(&self, role: Role) -> Option<&MessagePath> {
        self.paths[role as usize].as_ref()
    }
}

/// Counts of one topic's messages.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrackCounts {
    /// Used messages.
    pub message_count: u64,
    /// Messages with the stamp of the one before and nothing new.
    pub duplicate_count: u64,
    /// Times at which messages named only some of the cables that the topic has named.
    pub partial_count: u64,
    /// Single late messages.
    pub late_count: u64,
    /// Number of times that the clock was set back.
    pub clock_step_count: u64,
    /// Gaps.
    pub gap_count: u64,
    /// Unusable messages.
    pub undecodable_count: u64,
    /// First and last stamp, in nanoseconds.
    pub stamps_nanos: Option<(i64, i64)>,
    /// Usual interval (median of the last 32), in nanoseconds.
    pub interval_nanos: f64,
}
