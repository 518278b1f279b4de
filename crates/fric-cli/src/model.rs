//! The robot file of a log: named on the command line, or attached to the log.

use std::path::Path;
use std::str::FromStr as _;

use fric_core::robot::file::{LogTable, RobotFile};
use fric_log::path::MessagePath;
use fric_log::recording::Recording;
use fric_log::signals::{Role, SignalPaths};
use fric_log::write::ROBOT_FILE;

use crate::failure::{Failure, Outcome};

/// A robot and the text it was read from.
#[derive(Debug)]
pub struct Model {
    pub robot: RobotFile,
    pub text: String,
    /// For people: where it is from.
    pub origin: String,
}

impl Model {
    /// The robot file at a path.
    pub fn read(path: &Path) -> Outcome<Self> {
        let origin = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| {
            Failure::new(format!("cannot read the robot file {origin}: {error}"))
                .advise("Check the path given with --model.")
        })?;
        Self::parse(text, origin)
    }

    /// The robot file named, or else the one attached to the recording; `None` where there is neither.
    pub fn find(named: Option<&Path>, recording: &Recording) -> Outcome<Option<Self>> {
        if let Some(path) = named {
            return Self::read(path).map(Some);
        }
        let advice = "Name a robot file with --model.";
        let attachment = recording.attachment(ROBOT_FILE).map_err(|error| Failure::new(error).advise(advice))?;
        let Some(attachment) = attachment else { return Ok(None) };
        let origin = format!("{ROBOT_FILE} attached to the log");
        let text = String::from_utf8(attachment.data)
            .map_err(|_| Failure::new(format!("{origin} is not UTF-8 text")).advise(advice))?;
        Self::parse(text, origin).map(Some)
    }

    fn parse(text: String, origin: String) -> Outcome<Self> {
        let robot = RobotFile::parse(&text, &origin)?;
        Ok(Self { robot, text, origin })
    }

    /// The signals' paths as the robot file has them.
    pub fn signal_paths(&self) -> Outcome<SignalPaths> {
        let LogTable { cable, length, speed, reference, pose, wrench } = &self.robot.options().log;
        let paths = [
            (Role::Cable, Some(cable)),
            (Role::Length, length.as_ref()),
            (Role::Speed, speed.as_ref()),
            (Role::Reference, Some(reference)),
            (Role::Pose, Some(pose)),
            (Role::Wrench, Some(wrench)),
        ];
        let mut signals = SignalPaths::default();
        for (role, text) in paths {
            let path = text.map(|text| MessagePath::from_str(text)).transpose().map_err(|error| {
                Failure::new(format!("{}: `{}` under [log]: {error}", self.origin, role.key()))
                    .advise("A signal is a topic, or a path to a field such as /joints.effort[:].")
            })?;
            signals = signals.with(role, path);
        }
        Ok(signals)
    }
}

/// What to say where a command needs a robot and has none.
pub fn missing() -> Failure {
    Failure::new(format!("the log has no robot file attached ({ROBOT_FILE}), and none is named"))
        .advise("Name one with --model robot.toml; examples/mini-ipanema.toml shows the format.")
}
