//! Errors in a log for the wrench hysteresis.

use fric_core::ParamError;
use thiserror::Error;

/// Advice, each the end of a sentence.
mod advice {
    pub const GEOMETRY: &str = "give every cable both";
    pub const POSE: &str = "name the pose's topic as `pose` under `[log]` in the robot file, or record it";
    pub const RECORD: &str =
        "record it going to and fro across one position, along x, y, z and about them, one after the other";
    pub const CABLES: &str = "see what `fric-cli replay` says about the cables";
}

/// The reason why the hysteresis cannot be computed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HysteresisError {
    /// The parameters of the robot file are invalid.
    #[error("the robot's parameters are not right: {0}")]
    Robot(#[from] ParamError),
    /// A cable has no geometry, so there is no wrench.
    #[error("{cable} has no `base_m` and `platform_m` in the robot file, so there is no wrench; {}", advice::GEOMETRY)]
    NoGeometry {
        /// The first such cable.
        cable: String,
    },
    /// No sample has a pose.
    #[error("the log has no pose of the platform, so there is no wrench; {}", advice::POSE)]
    NoPose,
    /// The platform does not move.
    #[error("the platform does not move in this log; {}", advice::RECORD)]
    NoMovement,
    /// The axes of the movements cannot be distinguished.
    #[error(
        "the platform moves along several axes at once, never along or about one base axis alone; {}",
        advice::RECORD
    )]
    SeveralAxes,
    /// There are straight movements, but no position is crossed in both directions.
    #[error("the platform passes no position in both directions of an axis; {}", advice::RECORD)]
    NoCrossing,
    /// The crossings have no wrench.
    #[error(
        "at every crossing the force of a cable is missing or the platform is out of reach, so there is no wrench; {}",
        advice::CABLES
    )]
    NoWrench,
}

impl HysteresisError {
    /// Returns the advice that ends the error's sentence, if there is any.
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
