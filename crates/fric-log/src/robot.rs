//! What a robot file has to do with a log: it may be attached, and it says where the signals are.

use std::sync::Arc;

use fric_core::robot::file::{LogTable, ReferenceTable, RobotFile, RobotFileError};
use thiserror::Error;

use crate::log::Log;
use crate::path::{MessagePath, PathError};
use crate::recording::RecordingError;
use crate::signals::{Role, SignalPaths};

/// Name of the attachment that holds the robot file.
pub const ROBOT_FILE: &str = "fric-robot.toml";
/// Where an attached robot file is from, for people.
pub const ATTACHED: &str = "fric-robot.toml attached to the log";

/// A robot file and the text it was read from.
#[derive(Clone, Debug)]
pub struct AttachedRobot {
    /// The file, checked.
    pub robot: RobotFile,
    /// Its text, comments included.
    pub text: String,
}

/// Why an attached robot file cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AttachedRobotError {
    /// The attachment cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// It is no text.
    #[error("{ATTACHED} is not UTF-8 text")]
    NotText,
    /// It is no robot file.
    #[error(transparent)]
    Robot(#[from] RobotFileError),
}

/// A signal's path in the robot file that is none.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{}` under [log]: {source}", role.key())]
pub struct SignalPathError {
    /// The signal.
    pub role: Role,
    /// What is wrong with its path.
    pub source: PathError,
}

impl AttachedRobot {
    /// The robot file attached to a log; `None` if there is none.
    ///
    /// # Errors
    /// [`AttachedRobotError`] if it cannot be read or is not right.
    pub fn find(log: &Log) -> Result<Option<Self>, AttachedRobotError> {
        let Some(attachment) = log.attachment(ROBOT_FILE)? else { return Ok(None) };
        let text = String::from_utf8(attachment.data).map_err(|_| AttachedRobotError::NotText)?;
        Ok(Some(Self { robot: RobotFile::parse(&text, ATTACHED)?, text }))
    }
}

impl SignalPaths {
    /// The paths that a robot file names under `[log]`, with the reference that is known and the pose that comes from the lengths, where they do.
    ///
    /// # Errors
    /// [`SignalPathError`] for the first that is no path.
    pub fn of_robot(robot: &RobotFile) -> Result<Self, SignalPathError> {
        let LogTable { cable, length, speed, reference, pose, wrench, columns } = &robot.options().log;
        let reference = match reference {
            ReferenceTable::Signal(path) => Some(path),
            ReferenceTable::Known(_) => None,
        };
        let paths = [
            (Role::Cable, Some(cable)),
            (Role::Length, length.as_ref()),
            (Role::Speed, speed.as_ref()),
            (Role::Reference, reference),
            (Role::Pose, Some(pose).filter(|_| !robot.options().log.pose_is_from_lengths())),
            (Role::Wrench, Some(wrench)),
        ];
        let mut signals = Self::default().with_columns(columns.clone());
        for (role, text) in paths {
            let path = text.map(|text| text.parse::<MessagePath>()).transpose();
            signals = signals.with(role, path.map_err(|source| SignalPathError { role, source })?);
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
