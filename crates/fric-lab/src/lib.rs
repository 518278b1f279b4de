//! Offline analysis of samples of cable robots with pulley friction.
//!
//! [`trajectory`] holds the runs of a platform: identification, and crossing for the hysteresis of the wrench. [`simulate`] is a robot with known
//! friction that streams the samples of a log, with hidden effects on request. Its friction is computed independently of the compensator, so that
//! each verifies the other.
//!
//! [`excite`] gives the identification run as set points for a real robot; [`fit`] identifies the parameters of the
//! friction model from its log. [`replay`] runs the control loop's cycle over samples and sums up the errors, [`hysteresis`]
//! tells what is left of the wrench's hysteresis. [`columns`] keeps the samples of a whole log in memory;
//! [`errors`] and [`text`] are what results for machines and people share. [`statistics`] and [`random`] are for crates that do such
//! work on other models.
//!
//! This crate neither reads nor writes logs, and none of it is meant to run in a control cycle.

#![allow(clippy::doc_markdown, reason = "symbols of equations are no code items")]

mod axis;
mod candidates;
mod certainty;
mod clock;
pub mod columns;
pub mod discover;
mod effects;
pub mod errors;
pub mod excite;
pub mod fit;
pub mod hysteresis;
mod lateness;
pub mod random;
pub mod replay;
mod samples;
mod search;
mod set_up;
pub mod simulate;
pub mod statistics;
pub mod text;
pub mod trajectory;
mod weight;

pub use axis::CartesianAxis;
