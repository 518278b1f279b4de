//! Offline analysis of samples of cable robots with pulley friction.
//!
//! - [`replay`] runs the control loop's cycle over samples and sums up the errors; [`hysteresis`] measures what remains of the wrench's hysteresis.
//! - [`fit`] identifies the parameters of the friction model, with intervals.
//! - [`discover`] finds where model and measurement disagree, names the missing effect and extends the model.
//! - [`excite`] designs a run as set points for a real robot: for identification, or to answer what a log leaves open.
//! - [`simulate`] streams the samples of a robot with known friction and hidden effects. Its friction is computed independently of the compensator,
//!   so that each verifies the other. [`trajectory`] holds the movements.
//!
//! [`columns`] keeps the samples of a whole log in memory; results for machines and people share [`errors`] and [`text`]. [`statistics`] and
//! [`random`] also serve crates with other models.
//!
//! # Example
//!
//! ```
//! use fric_core::robot::file::RobotFile;
//! use fric_lab::replay::Replay;
//! use fric_lab::simulate::{Simulation, SimulationOptions};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = r#"
//!     format = "fric-robot/1"
//!     name = "bench"
//!     cycle_s = 0.001
//!     [[cable]]
//!     name = "winch"
//!     pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]
//!     friction = { mu = 0.02, sigma_n_per_m = 1000.0 }
//! "#;
//! let robot = RobotFile::parse(text, "example")?;
//! let options = SimulationOptions { duration_s: Some(5.0), ..SimulationOptions::default() };
//! let mut simulation = Simulation::new(&robot, &options)?;
//! let mut replay = Replay::new(&robot.params())?;
//! while let Some(sample) = simulation.next_cycle() {
//!     replay.step(&sample);
//! }
//! let errors = replay.cables()[0];
//! assert!(errors.after_n.rms() < errors.before_n.rms());
//! # Ok(())
//! # }
//! ```
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
pub mod numbers;
pub mod random;
pub mod recording_fault;
pub mod replay;
mod samples;
mod search;
mod set_up;
pub mod simulate;
pub mod statistics;
pub mod text;
pub mod trajectory;
mod weight;
pub mod words;

pub use axis::CartesianAxis;
