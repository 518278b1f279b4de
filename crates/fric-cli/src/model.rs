//! The robot file of a log: named on the command line, or attached to the log.

use std::path::Path;

use fric_core::robot::file::{FORMAT as ROBOT_FORMAT, RobotFile};
use fric_core::text_file;
use fric_log::log::Log;
use fric_log::robot::{ATTACHED, AttachedRobot, AttachedRobotError, ROBOT_FILE};
use fric_log::signals::{Part, Role, SignalPaths, SignalReader};
use fric_tendon::file::FORMAT as MANIPULATOR_FORMAT;

use crate::failure::{Failure, Outcome};
use crate::terminal;

/// Returns the text of a model's file, and its origin; `kind` names the kind of file.
pub fn read_text(path: &Path, kind: &str) -> Outcome<(String, String)> {
    let origin = path.display().to_string();
    let text = text_file::read(path).map_err(|error| {
        let is_locked = error.kind() == std::io::ErrorKind::PermissionDenied;
        Failure::new(format!("cannot read the {kind} file {origin}: {error}")).advise(if is_locked {
            "Check its permissions."
        } else {
            "Check the path given with --model."
        })
    })?;
    let other = [("robot", ROBOT_FORMAT), ("manipulator", MANIPULATOR_FORMAT)]
        .into_iter()
        .find(|(other, format)| *other != kind && has_format(&text, format));
    match other {
        Some((other, format)) => Err(Failure::new(format!("{origin} is a {other} file (`{format}`)"))
            .advise(format!("Name a {kind} file with --model."))),
        None => Ok((text, origin)),
    }
}

/// Whether the text of a model's file states a format.
pub fn has_format(text: &str, format: &str) -> bool {
    text.lines().any(|line| line.trim_start().starts_with("format") && line.contains(format))
}

/// A robot and the text of its file.
#[derive(Debug)]
pub struct Model {
    pub robot: RobotFile,
    pub text: String,
    /// Its origin, for people.
    pub origin: String,
}

impl Model {
    /// Reads the robot file at a path.
    pub fn read(path: &Path) -> Outcome<Self> {
        let (text, origin) = read_text(path, "robot")?;
        Self::parse(text, origin)
    }

    /// Returns the named robot file, or else the one attached to the log; `None` if there is neither.
    pub fn find(named: Option<&Path>, log: &Log) -> Outcome<Option<Self>> {
        if let Some(path) = named {
            return Self::read(path).map(Some);
        }
        let attached = Self::attached(log)?;
        if let Some(model) = &attached {
            model.note();
        }
        Ok(attached)
    }

    /// Returns the robot file attached to a log, if there is one.
    pub fn attached(log: &Log) -> Outcome<Option<Self>> {
        match AttachedRobot::find(log) {
            Ok(attached) => Ok(attached.map(|of| Self { robot: of.robot, text: of.text, origin: ATTACHED.to_owned() })),
            Err(AttachedRobotError::Robot(error)) => Err(error.into()),
            Err(error) => Err(Failure::new(error).advise("Name a robot file with --model.")),
        }
    }

    /// Whether it was attached to a log.
    pub fn is_attached(&self) -> bool {
        self.origin == ATTACHED
    }

    fn parse(text: String, origin: String) -> Outcome<Self> {
        let model = Self { robot: RobotFile::parse(&text, &origin)?, text, origin };
        model.note();
        Ok(model)
    }

    fn note(&self) {
        terminal::note(format_args!("robot: {} from {}", self.robot.options().name, self.origin));
    }

    /// Returns a reader of the robot's signals in a part of a log, all but the unread one.
    pub fn reader(&self, log: Log, part: Part, unread: Option<Role>) -> Outcome<SignalReader> {
        let paths = self.signal_paths()?;
        let paths = unread.into_iter().fold(paths, |paths, role| paths.with(role, None));
        Ok(SignalReader::new(log, paths, &self.robot.cable_names()).within(part))
    }

    /// Returns the signals' paths from the robot file.
    pub fn signal_paths(&self) -> Outcome<SignalPaths> {
        SignalPaths::of_robot(&self.robot).map_err(|error| {
            Failure::new(format!("{}: {error}", self.origin))
                .advise("A signal is a topic, or a path to a field such as /joints.effort[:].")
        })
    }
}

/// Returns the failure of a command that needs a robot and has none.
pub fn missing() -> Failure {
    Failure::new(format!("the log has no robot file attached ({ROBOT_FILE}), and none is named"))
        .advise("Make one to start from (fric-cli init LOG -o robot.toml), and name it with --model robot.toml.")
}
