//! `libfric`: the compensator of `fric-core`, and its static model of continuum manipulators, for C and C++.
//!
//! For: control loops that are not written in Rust. Nothing is computed here; a cycle has the bits of
//! [`fric_core::Compensator`], a shape and a command those of [`fric_tendon::StaticModel`]. What a C programmer reads is `include/fric.h`, made from these sources by cbindgen; the
//! C++ interface is `include/fric.hpp`.
//!
//! - **Set-up** may fail: it returns a code and one sentence. Panics, which indicate a bug, are caught (`catch_unwind`), so that a bug at set-up does
//!   not stop a machine.
//! - **The cycle** ([`fric_step`], [`fric_static_model_solve`], [`fric_static_model_tension_for`]) does not allocate, lock, or fail on any signal. A
//!   wrong pointer or size gives a code. The cycle cannot panic; if it could, a function of `extern "C"` would end the process and never unwind into
//!   C. Therefore the cycle needs no `catch_unwind`, and the release profile no `panic = "abort"`, which would deprive Python of its exceptions.
//!
//! Non-finite input is flagged as in [`fric_core::CableStatus`], [`fric_tendon::ShapeStatus`] and
//! [`fric_tendon::GoalStatus`]; no number that comes out is non-finite.
#![allow(clippy::doc_markdown, reason = "the documentation is for C, where names stand bare")]

mod abi;
mod change;
mod cycle;
mod handle;
mod load;
mod outcome;
mod static_model;
mod status;
mod text_buffer;

pub use abi::FRIC_ABI_VERSION;
pub use change::{fric_change_file, fric_change_text};
pub use cycle::{
    CableResult, CableSignals, CycleResult, CycleSignals, PlatformPose, PlatformWrench, fric_reset, fric_step,
};
pub use handle::{Handle, fric_cable_count, fric_cable_name, fric_cycle_s, fric_free, fric_robot_name};
pub use load::{fric_load_file, fric_load_text};
pub use outcome::{Outcome, fric_abi_version, fric_version};
pub use static_model::*;
pub use status::*;
