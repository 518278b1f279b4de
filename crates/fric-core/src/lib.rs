//! Pulley friction compensation for cable-driven robots, made for the inside of a 1 ms control loop.
#![no_std]

#[cfg(feature = "robot-file")]
extern crate std;

pub mod cable;
mod columns;
mod compensator;
mod cycle;
pub mod dahl;
pub mod effects;
mod lanes;
pub mod platform;
pub mod pulley;
pub mod robot;
pub mod scalar;
mod status;
pub mod swivel;

pub use compensator::{Compensator, Snapshot};
pub use cycle::{CableInput, CableOutput, CycleInput, CycleOutput};
pub use lanes::{LANES, Lanes};
pub use platform::{Pose, Wrench};
pub use robot::{CableParams, ParamError, RobotParams};
pub use status::CableStatus;
