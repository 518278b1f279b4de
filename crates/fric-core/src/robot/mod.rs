//! Robot parameters: options as stated, checked into parameters that are right by construction; and, with the feature
//! `robot-file`, the TOML file that people write.

mod error;
mod known_reference;
mod params;

#[cfg(feature = "robot-file")]
pub mod edit;
#[cfg(feature = "robot-file")]
pub mod file;
#[cfg(feature = "robot-file")]
pub mod locate;
#[cfg(feature = "robot-file")]
mod log_columns;
#[cfg(feature = "robot-file")]
pub mod read;
#[cfg(feature = "robot-file")]
pub(crate) mod reference;
#[cfg(feature = "robot-file")]
mod splice;
#[cfg(feature = "robot-file")]
mod table;
#[cfg(feature = "robot-file")]
mod warnings;

pub use error::{ParamError, ParamProblem, check};
pub use known_reference::KnownReference;
#[cfg(feature = "robot-file")]
pub use locate::{nearest_name, unknown_name};
pub use params::{
    CableOptions, CableParams, FrictionOptions, GeometryOptions, MAX_PULLEYS, MOST_CABLES, MonitorOptions,
    PlatformOptions, Presliding, PulleyOptions, RobotParams, ValidatedRange,
};
pub(crate) use params::{Geometry, Wrap};
