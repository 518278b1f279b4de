//! Tendons through the disks of a planar continuum manipulator: friction along the tendon, and the shape.
//!
//! A tendon that runs through holes is the same chain of frictional contacts as a cable over pulleys. At every hole the tension drops or rises by the
//! friction; the tension in a segment bends the backbone there. [`StaticModel`] computes the shape from the base tensions, with friction in one of
//! four ways ([`Friction`]).
//!
//! The model can run inside a control cycle: no allocation, no panic, a bounded number of iterations. It does not cover bending out of the plane,
//! dynamics, and contact between disks. State: the last shape and two numbers per hole. Non-finite input gives a [`ShapeStatus`] and changes nothing.
//!
//! \[C\] stands for *A Novel Friction Measuring Method and Its Application to Improve the Static Modeling Accuracy of
//! Cable-Driven Continuum Manipulators*; numbers are its equations.
//!
//! The contact at a hole is that of the pulley's bearing in [`fric_core`]; work on recorded runs is in the crate `fric-tendon-lab`.
//!
//! # Features
//!
//! Both are off by default: `alloc` is for manipulators whose number of disks is known only at run time (`AnyStaticModel`);
//! `manipulator-file` reads and writes the TOML manipulator file (`file`) and needs `std`.
//!
//! # Convention
//!
//! The base frame has x along the straight manipulator and y towards the first tendon ([`Tendon::Agonist`]); its origin is the centre of the base
//! plate, in which the backbone is clamped. Bends are positive towards +y. Segment i (from 1 at the base) ends in disk i; hole i is at its beginning,
//! so hole 1 is in the base plate. The tendons end at the last disk and arrive at the base plate along x. `T_0` is the tension at the base, `T_i`
//! that in segment i. **Friction at a hole is `f_i = T_{i−1} − T_i`: positive if the base side is tighter**, as when the tendon slides towards the
//! base (pulling).
//!
//! ```
//! use fric_tendon::{Direction, Friction, ManipulatorOptions, ManipulatorParams, StaticModel, Tendon};
//! # fn main() -> Result<(), fric_tendon::ManipulatorError> {
//! let params = ManipulatorParams::new(&ManipulatorOptions::published())?;
//! let mut model = StaticModel::<8>::new(&params)?;
//! let status = model.solve([1.0, 0.0], Friction::Coulomb(Direction::Pulling));
//! assert!(status.is_ok());
//! let tension_n = model.shape().tension_n(Tendon::Agonist);
//! assert!(tension_n[7] < tension_n[0] && tension_n[0] < 1.0);
//! # Ok(())
//! # }
//! ```

#![no_std]
#![allow(clippy::doc_markdown, reason = "symbols of equations are no code items")]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(feature = "manipulator-file")]
extern crate std;

#[cfg(feature = "alloc")]
mod any;
mod friction;
mod inverse;
#[cfg(feature = "manipulator-file")]
mod manipulator_file;
mod model;
mod params;
mod shape;
mod solver;

#[cfg(feature = "alloc")]
pub use any::AnyStaticModel;
pub use friction::{Direction, Friction};
pub use inverse::{Command, Drive, DriveOptions, Goal, GoalStatus};
#[cfg(feature = "manipulator-file")]
pub use manipulator_file::{edit, file, gratings, measuring};
pub use model::{StateMismatch, StaticModel, StaticSnapshot};
pub use params::rectangle_bending_stiffness_n_m2;
pub use params::{MAX_DISKS, ManipulatorError, ManipulatorOptions, ManipulatorParams, Tendon, TendonOptions};
pub use shape::{Shape, ShapeStatus};
