//! Errors in a log for the wrench hysteresis.

use fric_core::ParamError;
use miette::Diagnostic;
use thiserror::Error;

/// The reason why the hysteresis cannot be computed.
#[derive(Clone, Debug, PartialEq, Diagnostic, Error)]
#[non_exhaustive]
pub enum HysteresisError {
    /// The parameters of the robot file are invalid.
    #[error("the robot's parameters are not right: {0}")]
    Robot(#[from] ParamError),
    /// A cable has no geometry, so there is no wrench.
    #[error("{cable} has no `base_m` and `platform_m` in the robot file, so there is no wrench")]
    #[diagnostic(help("Give every cable both."))]
    NoGeometry {
        /// The first such cable.
        cable: String,
    },
    /// No sample has a pose.
    #[error("the log has no pose of the platform, so there is no wrench")]
    #[diagnostic(help("Name the pose's topic as `pose` under `[log]` in the robot file, or record it."))]
    NoPose,
    /// The platform does not move.
    #[error("the platform does not move in this log")]
    #[diagnostic(help(
        "Record it going to and fro across one position, along x, y, z and about them, one after the other."
    ))]
    NoMovement,
    /// The axes of the movements cannot be distinguished.
    #[error("the platform moves along several axes at once, never along or about one base axis alone")]
    #[diagnostic(help(
        "Record it going to and fro across one position, along x, y, z and about them, one after the other."
    ))]
    SeveralAxes,
    /// There are straight movements, but no position is crossed in both directions.
    #[error("the platform passes no position in both directions of an axis")]
    #[diagnostic(help(
        "Record it going to and fro across one position, along x, y, z and about them, one after the other."
    ))]
    NoCrossing,
    /// The crossings have no wrench.
    #[error("at every crossing the force of a cable is missing or the platform is out of reach, so there is no wrench")]
    #[diagnostic(help("See what `fric-cli replay` says about the cables."))]
    NoWrench,
}
