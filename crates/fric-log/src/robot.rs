//! The relation between a robot file and a log: the file may be attached to the log, and it states where the signals are.

use std::sync::Arc;

use fric_core::robot::file::{LogTable, ReferenceTable, RobotFile, RobotFileError};
use thiserror::Error;

use crate::log::Log;
use crate::path::{MessagePath, PathError};
use crate::recording::RecordingError;
use crate::signals::{Role, SignalPaths};

/// Name of the attachment that holds the robot file.
pub const ROBOT_FILE: &str = "fric-robot.toml";
/// Origin of an attached robot file, for people.
pub const ATTACHED: &str = "fric-robot.toml attached to the log";

/// A robot file and its text.
#[derive(Clone, Debug)]
pub struct AttachedRobot {
    /// The file, checked.
    pub robot: RobotFile,
    /// Its text, comments included.
    pub text: String,
}

/// The reason why an attached robot file cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AttachedRobotError {
    /// The attachment cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The attachment is not text.
    #[error("{ATTACHED} is not UTF-8 text")]
    NotText,
    /// Files of the log have different ones.
    #[error(
        "the files of the log have different robot files attached; read the recording of each robot by itself, or name the robot \
         file of all"
    )]
    Different,
    /// The attachment is not a valid robot file.
    #[error(transparent)]
    Robot(#[from] RobotFileError),
}

/// The error of an invalid signal path in the robot file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{}` under [log]: {source}", role.key())]
pub struct SignalPathError {
    /// The signal.
    pub role: Role,
    /// The error of its path.
    pub source: PathError,
}

impl AttachedRobot {
    /// Returns the robot file attached to a log; `None` if there is none.
    ///
    /// # Errors
    /// Returns an [`AttachedRobotError`] if it cannot be read or is invalid, or if files of the log have different ones.
    pub fn find(log: &Log) -> Result<Option<Self>, AttachedRobotError> {
        let mut attachments = log.attachments_named(ROBOT_FILE)?;
        let Some(attachment) = attachments.pop() else { return Ok(None) };
        if attachments.iter().any(|other| other.data != attachment.data) {
            return Err(AttachedRobotError::Different);
        }
        let text = String::from_utf8(attachment.data).map_err(|_| AttachedRobotError::NotText)?;
        Ok(Some(Self { robot: RobotFile::parse(&text, ATTACHED)?, text }))
    }
}

impl SignalPaths {
    /// Returns the paths that a robot file states under `[log]`, with a known reference, and a pose and speeds from the lengths if it states
    /// them.
    ///
    /// # Errors
    /// Returns a [`SignalPathError`] for the first invalid path.
    pub fn of_robot(robot: &RobotFile) -> Result<Self, SignalPathError> {
        let LogTable { cable, length, speed, reference, pose, wrench, columns } = &robot.options().log;
        let reference = match reference {
            ReferenceTable::Signal(path) => Some(path),
            ReferenceTable::Known(_) => None,
        };
        let paths = [
            (Role::Cable, Some(cable)),
            (Role::Length, length.as_ref()),
            (Role::Speed, speed.as_ref().filter(|_| !robot.options().log.speed_is_from_lengths())),
            (Role::Reference, reference),
            (Role::Pose, Some(pose).filter(|_| !robot.options().log.pose_is_from_lengths())),
            (Role::Wrench, Some(wrench)),
        ];
        let mut signals = Self::default().with_columns(columns.clone());
        for (role, text) in paths {
            let path = text.map(|text| text.parse::<MessagePath>()).transpose();
            signals = signals.with(role, path.map_err(|source| SignalPathError { role, source })?);
        }
        if robot.options().log.speed_is_from_lengths() {
            signals = signals.with_speed_from_lengths();
        }
        if robot.options().log.pose_is_from_lengths() {
            signals = signals.with_pose_from_lengths(Arc::new(robot.clone()));
        }
        Ok(match robot.params().known_reference() {
            Some(known) => signals.with_known_reference(known),
            None => signals,
        })
    }
}
