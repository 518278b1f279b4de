//! Offline work on the runs of a continuum manipulator ([`fric_core::continuum`]).
//!
//! [`fbg`] turns the shifts of gratings into tensions, [`friction`] tensions into the friction at every hole and into the μ of
//! a single one. [`shape_errors`] compares computed shapes with markers, by the four ways of friction. [`simulate`] is a
//! manipulator whose truth is another one than the model's.
//!
//! \[C\] is the paper that [`fric_core::continuum`] names.

mod error;
pub mod fbg;
pub mod friction;
mod run;
pub mod shape_errors;
pub mod simulate;

pub use error::ContinuumError;
pub use run::{RunSample, check_run};
