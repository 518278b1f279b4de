//! A simulated cable robot: the samples of a log with known friction, as a stream.
//!
//! For: logs to try the compensator, identification and discovery on, with effects hidden in them. [`Simulation`] yields
//! one cycle after another in bounded memory; the caller writes them where it likes.
//!
//! What is simulated: the platform runs one of the runs of \[P\] ([`crate::trajectory`]); its cables hold it with tensions
//! that wander; on every pulley a bristle rubs (\[P\] 4–7, 16, in a form and by a method of its own); winches move a
//! little in standstill; sensor and reference are noisy. On request every effect of the catalogue is hidden in it
//! ([`HiddenEffect`]), and [`Disturbance`]s that no catalogue has; a hand pushes, noise wanders, lengths are those of an
//! encoder. [`sweep`] makes many such logs at random. Turns are quasi-static: the robot file has no inertia tensor. What is not
//! simulated: sagging cables, slip on a pulley, waves along an elastic cable.
//!
//! Parameters are the robot file's friction values: they are the truth here. `offset_n` is added to the reference, so that
//! a fit finds the same offset. Input is checked at set-up ([`SimulationError`]); running cannot fail.
//!
//! The friction shares no code with the compensator's, only the kinematics and the types: where both agree, they have
//! not agreed by construction. Sign convention: see [`fric_core::pulley`].

mod bristle;
pub(crate) mod distribution;
mod disturbances;
mod encoder;
mod error;
mod hidden;
mod idle;
pub(crate) mod motion;
mod options;
pub(crate) mod platform;
mod presliding;
mod stated;
mod stream;
pub mod sweep;
pub(crate) mod tension;
pub(crate) mod truth;
mod wander;
mod warnings;
mod waves;
pub(crate) mod workspace;

pub use disturbances::{DISTURBANCES, Disturbance, DisturbanceParameter, DisturbanceRow};
pub use error::{HiddenError, SimulationError};
pub use hidden::HiddenEffect;
pub use idle::{IdleError, IdleMotion, IdleOptions, idle};
pub use options::{Run, SimulationOptions};
pub use stream::{Imbalance, START_NANOS, Simulation};
