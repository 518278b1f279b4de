//! What can be wrong with a log whose wrench hysteresis is wanted.

use fric_core::ParamError;
use thiserror::Error;

/// What to do, each the end of a sentence.
mod advice {
    pub const GEOMETRY: &str = "give every cable both";
    pub const POSE: &str = "name the pose's topic as `pose` under `[log]` in the robot file, or record it";
    pub const RECORD: &str =
        "record it going to and fro across one position, along x, y, z and about them, one after the other";
    pub const CABLES: &str = "see what `fric-cli replay` says about the cables";
}

/// Why there is no hysteresis to tell.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HysteresisError {
    /// The robot file's parameters are not right.
    #[error("the robot's parameters are not right: {0}")]
    Robot(#[from] ParamError),
    /// A cable that no wrench can be made of.
    #[error("{cable} has no `base_m` and `platform_m` in the robot file, so there is no wrench; {}", advice::GEOMETRY)]
    NoGeometry {
        /// The first such cable.
        cable: String,
    },
    /// No sample has a pose.
    #[error("the log has no pose of the platform, so there is no wrench; {}", advice::POSE)]
    NoPose,
    /// A platform at rest.
    #[error("the platform does not move in this log; {}", advice::RECORD)]
    NoMovement,
    /// Movements in which no axis can be told from another.
    #[error(
        "the platform moves along several axes at once, never along or about one base axis alone; {}",
        advice::RECORD
    )]
    SeveralAxes,
    /// Straight movements, but no place that is passed both ways.
    #[error("the platform passes no position in both directions of an axis; {}", advice::RECORD)]
    NoCrossing,
    /// Crossings without a wrench.
    #[error(
        "at every crossing the force of a cable is missing or the platform is out of reach, so there is no wrench; {}",
        advice::CABLES
    )]
    NoWrench,
}

impl HysteresisError {
    /// What to do: the words that end the error's sentence, where it has any.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Robot(_) => None,
            Self::NoGeometry { .. } => Some(advice::GEOMETRY),
            Self::NoPose => Some(advice::POSE),
            Self::NoMovement | Self::SeveralAxes | Self::NoCrossing => Some(advice::RECORD),
            Self::NoWrench => Some(advice::CABLES),
        }
    }
}
