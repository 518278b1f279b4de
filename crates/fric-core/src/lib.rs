//! Pulley friction compensation for cable-driven robots, for use inside a 1 ms control loop.
//!
//! A cable robot measures its cable forces at the winch. The pulleys between winch and platform have friction, so the sensor force differs from the
//! force on the platform, and the difference depends on the previous motion. Once per cycle, [`Compensator`] computes the platform forces and the
//! platform wrench from sensor forces, cable lengths, speeds and the pose.
//!
//! - **No allocation, no panic, no clock.** The crate is `no_std`. Set-up can fail; [`Compensator::step`] cannot.
//! - **Total.** Every input gives a finite output; [`CableStatus`] tells what is wrong with a signal.
//! - **Cables are separate.** No bit of a cable's force depends on another cable's signals.
//! - **Reproducible.** The cycle uses exactly rounded operations, and the functions of the `libm` crate for slip limits and set-up, never those of the
//!   platform. The bits therefore do not depend on platform, optimisation level or vector width.
//!
//! # Example
//!
//! ```
//! use fric_core::robot::{
//!     CableOptions, CableParams, FrictionOptions, MonitorOptions, PlatformOptions, PulleyOptions, RobotParams,
//! };
//! use fric_core::{CableInput, Compensator, CycleInput};
//!
//! # fn main() -> Result<(), fric_core::ParamError> {
//! let pulleys = [PulleyOptions::Fixed { wrap_rad: core::f64::consts::PI, sensor: true }];
//! let friction = FrictionOptions { mu: 0.02, sigma_n_per_m: Some(1000.0), ..FrictionOptions::default() };
//! let cables = [CableParams::new(&CableOptions { friction, ..CableOptions::new(&pulleys) })?];
//! // The signal below has no noise, so the check for a frozen sensor is switched off.
//! let monitor = MonitorOptions { frozen_cycles: 0, ..MonitorOptions::for_cycle(0.001) };
//! let robot = RobotParams::new(0.001, &PlatformOptions::default(), monitor, &cables)?;
//! let mut compensator = Compensator::<1>::new(&robot)?;
//!
//! let mut input = CycleInput::default();
//! for cycle in 0..1000 {
//!     input.cables[0] = CableInput {
//!         sensor_force_n: 20.0,
//!         length_m: 1e-4 * f64::from(cycle),
//!         speed_m_per_s: 0.1,
//!     };
//!     let output = compensator.step(&input);
//!     assert!(output.cables[0].status.is_ok());
//! }
//! // Paying out over a pulley of 180°: F_1 = F_s (1 + μ)/2 ([P] 14).
//! let force_n = compensator.step(&input).cables[0].force_at_platform_n;
//! assert!((force_n - 20.0 * 1.02 / 2.0).abs() < 1e-12);
//! # Ok(())
//! # }
//! ```
//!
//! # One cycle
//!
//! [`CycleInput`] → [`swivel`] (wrap of the last pulley, direction, moment arm) → signal checks → [`cable`] (the chain of
//! [`pulley`]s, [`dahl`] presliding, [`effects`]) → force at the platform → wrench → [`CycleOutput`].
//!
//! # Sources
//!
//! \[P\] is W. Kraus, M. Kessler, A. Pott, *Pulley friction compensation for winch-integrated cable force measurement and verification on a
//! cable-driven parallel robot*, ICRA 2015; numbers after it are its equations. Each function documents where it deviates from the paper, and why.
//!
//! # Features
//!
//! Both are off by default. `alloc` adds robots whose number of cables is known only at run time (`AnyCompensator`). `robot-file` reads and writes
//! the TOML robot file ([`robot::file`]) and needs `std`.
#![no_std]
#![allow(clippy::inline_always, reason = "a call inside the loop over lanes would pass vectors through memory")]
#![allow(clippy::doc_markdown, reason = "symbols of equations are not code items")]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(feature = "robot-file")]
extern crate std;

mod compensator;
pub mod effects;
mod friction;
mod geometry;
mod group;
mod numbers;
pub mod parameters;
pub mod robot;
pub mod signals;
#[cfg(feature = "robot-file")]
pub mod text_file;
#[cfg(feature = "robot-file")]
pub mod toml_editor;
pub mod words;

#[cfg(feature = "alloc")]
pub use compensator::any::{AnyCompensator, AnySnapshot, SnapshotMismatch};
pub use compensator::cycle::{CableInput, CableOutput, CycleInput, CycleOutput};
#[cfg(feature = "alloc")]
pub use compensator::exchange::{ParameterReceiver, ParameterSender, SendError, parameter_exchange};
pub use compensator::tunable::TunableCompensator;
pub use compensator::{Compensator, Snapshot};
pub use friction::{cable, cable_cycle, dahl, pulley};
pub use geometry::platform::{Pose, Wrench};
pub use geometry::{admittance, forward, platform, swivel};
pub use group::{CableCycle, CableGroup, PoseWrap};
pub use numbers::lanes::{LANES, Lanes};
pub use numbers::scalar;
pub use robot::{CableParams, KnownReference, ParamError, RobotParams};
pub use signals::sample::Sample;
pub use signals::status::CableStatus;

/// Compiles the example of the README.
#[cfg(all(doctest, feature = "robot-file"))]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// Runs the programs of the control engineer's tutorial.
#[cfg(all(doctest, feature = "robot-file"))]
#[doc = include_str!("../../../docs/tutorial-control.md")]
struct Tutorial;
