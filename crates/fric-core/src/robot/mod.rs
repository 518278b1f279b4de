//! Robot parameters: options as stated are checked into parameters that are valid by construction. With the feature `robot-file`, also the TOML file.

mod error;
mod known_reference;
mod params;

#[cfg(feature = "robot-file")]
pub mod edit;
#[cfg(feature = "robot-file")]
mod effect_table;
#[cfg(feature = "robot-file")]
pub mod file;
#[cfg(feature = "robot-file")]
pub mod locate;
#[cfg(feature = "robot-file")]
mod log_columns;
#[cfg(feature = "robot-file")]
mod options_error;
#[cfg(feature = "robot-file")]
pub mod read;
#[cfg(feature = "robot-file")]
pub(crate) mod reference;
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
