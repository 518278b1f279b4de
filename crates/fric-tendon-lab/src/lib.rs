//! Offline work on the runs of a continuum manipulator ([`fric_tendon`]).
//!
//! A run comes as named [`columns`] and becomes a checked [`Run`]. [`fbg`] turns the shifts of gratings into tensions,
//! [`gratings`] does so for a whole run and finds those that are dead; [`friction`] turns tensions into the friction at every hole
//! and into the μ of a single one. [`comparison`] computes shapes by the four ways of friction, [`shape_errors`] says how far
//! they are from markers. [`result`] is all that for machines and people. [`simulate`] is a manipulator whose truth is another
//! one than the model's.
//!
//! \[C\] is the paper that [`fric_tendon`] names.

#![allow(clippy::doc_markdown, reason = "symbols of equations are no code items")]

pub mod columns;
pub mod comparison;
pub mod discover;
mod error;
pub mod fbg;
pub mod friction;
pub mod gratings;
pub mod identify;
mod loads;
mod measuring;
pub mod result;
mod run;
pub mod shape_errors;
pub mod simulate;

pub use error::ContinuumError;
pub use loads::{hole_loads, load_steps};
pub use measuring::{as_measured, corrected};
pub use run::{Run, RunSample};
