//! Offline work on the runs of a continuum manipulator ([`fric_tendon`]).
//!
//! A run comes as named [`columns`] and becomes a checked [`Run`]. [`fbg`] converts the shifts of gratings to tensions; [`gratings`] does so for a
//! whole run and finds dead ones, [`guard`] what they contradict. [`friction`] computes the friction at every hole from tensions, and the μ of a single hole. [`comparison`] computes
//! shapes by the four friction models, and [`shape_errors`] compares them with markers. [`result`] holds the results for machines and people.
//! [`follow`] finds the tensions for a path of goals. [`simulate`] is a manipulator whose true physics differ from the model.
//!
//! \[C\] is the paper that [`fric_tendon`] names.

#![allow(clippy::doc_markdown, reason = "symbols of equations are no code items")]

mod base_noise;
mod begin;
pub mod columns;
pub mod comparison;
pub mod discover;
mod error;
pub mod fbg;
pub mod follow;
pub mod friction;
pub mod gratings;
pub mod guard;
pub mod identify;
mod loads;
mod measuring;
pub mod result;
mod run;
pub mod shape_errors;
pub mod simulate;
mod trend;

pub use base_noise::{BaseNoise, steadied};
pub use begin::{Begin, BeginSource};
pub use error::ContinuumError;
pub use loads::{hole_loads, load_steps};
pub use measuring::{as_measured, corrected};
pub use run::{Run, RunSample};
