//! Public behaviour of `fric-core`, one binary.
//!
//! Oracles here are written from the equations of the papers, never from the code under test.
#![allow(clippy::float_cmp, reason = "bit for bit is what many of these tests are about")]

#[cfg(test)]
mod admittance;
#[cfg(test)]
mod any;
#[cfg(test)]
mod bits;
#[cfg(test)]
mod builds;
mod chain;
#[cfg(test)]
mod cycle;
#[cfg(test)]
mod dahl;
#[cfg(test)]
mod delay;
#[cfg(test)]
mod doubt;
#[cfg(test)]
mod edit;
#[cfg(test)]
mod effects;
#[cfg(test)]
mod faults;
#[cfg(test)]
mod forward;
#[cfg(test)]
mod oracle;
#[cfg(test)]
mod platform;
#[cfg(test)]
mod programs;
#[cfg(test)]
mod properties;
#[cfg(test)]
mod random;
#[cfg(test)]
mod robot_file;
#[cfg(test)]
mod scalar;
#[cfg(test)]
mod soak;
#[cfg(test)]
mod state_words;
#[cfg(test)]
mod status;
#[cfg(test)]
mod support;
#[cfg(test)]
mod swivel;
mod tunable;
