//! Public behaviour of `fric-tendon`, one binary.
//!
//! Oracles here are written from the equations of the paper, never from the code under test.
#![allow(clippy::float_cmp, reason = "bit for bit is what many of these tests are about")]

#[cfg(test)]
mod builds;
#[cfg(test)]
mod file;
#[cfg(test)]
mod inverse;
#[cfg(test)]
mod state;
#[cfg(test)]
mod static_model;
