//! A simulated cable robot that streams the samples of a log with known friction.
//!
//! The logs serve to test the compensator, identification and discovery, with effects hidden in them. [`Simulation`] yields one cycle after another
//! in bounded memory; the caller writes them.
//!
//! The simulation contains the following. The platform runs one of the runs of \[P\] ([`crate::trajectory`]). Its cables hold it with varying
//! tensions. A bristle on every pulley creates friction (\[P\] 4–7, 16, in a different form and solved by a different method). Winches move slightly
//! at standstill. Sensor and reference are noisy. On request, every effect of the catalogue ([`HiddenEffect`]) and [`Disturbance`]s outside the
//! catalogue are hidden in the log; a hand pushes, noise drifts, and lengths come from an encoder. [`sweep`] makes many such logs at random.
//! Sagging cables, slip on a pulley and waves along an elastic cable are not simulated.
//!
//! The friction values of the robot file are the true parameters. `offset_n` is added to the reference, so that a fit finds the same offset. The
//! input is checked at set-up ([`SimulationError`]); running cannot fail.
//!
//! The friction shares no code with the compensator, only the kinematics and the types, so their agreement is not by construction. Sign convention:
//! see [`fric_core::pulley`].

mod bristle;
mod disturbances;
mod error;
mod hidden;
mod idle;
pub(crate) mod mechanics;
mod options;
mod stated;
mod stream;
pub mod sweep;
pub(crate) mod truth;
mod warnings;

pub use disturbances::{DISTURBANCES, Disturbance, DisturbanceParameter, DisturbanceRow};
pub use error::{HiddenError, SimulationError};
pub use hidden::HiddenEffect;
pub use idle::{IdleError, IdleMotion, IdleOptions, idle};
pub use options::{Run, SimulationOptions};
pub use stream::{Imbalance, START_NANOS, Simulation};
