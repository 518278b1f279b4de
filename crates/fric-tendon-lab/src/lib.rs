//! Offline work on the runs of a continuum manipulator ([`fric_tendon`]).
//!
//! A run comes as named [`columns`] and becomes a checked [`Run`].
//!
//! - [`fbg`] converts the shifts of gratings to tensions; [`gratings`] does so for a whole run and finds dead ones, [`guard`] what they contradict.
//! - [`friction`] is the friction at every hole from tensions, and the μ of a single hole.
//! - [`comparison`] computes the shapes of a run by the four friction models; [`shape_errors`] are their distances from the markers.
//! - [`identify`](mod@identify) fits the numbers of a manipulator file, [`discover`](mod@discover) finds what the file lacks or has wrong.
//! - [`follow`](mod@follow) finds the tensions for a path of goals.
//! - [`simulate`](mod@simulate) is a manipulator whose true physics differ from the model.
//!
//! [`result`] holds the results for machines and people.
//!
//! # Example
//!
//! ```
//! use fric_tendon_lab::fbg::{Calibration, LoadStep};
//! # fn main() -> Result<(), fric_tendon_lab::ContinuumError> {
//! // Ten weights on a tendon with two gratings.
//! let step = |load_n: f64| LoadStep { load_n, shift_nm: vec![11.0 * load_n, 12.0 * load_n + 0.5] };
//! let steps: Vec<LoadStep> = (1..=10).map(|weight| step(0.2 * f64::from(weight))).collect();
//! let gratings = Calibration::fit_all(&steps)?;
//! assert!((gratings[1].tension(12.5).value_n - 1.0).abs() < 1e-9);
//! # Ok(())
//! # }
//! ```
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
