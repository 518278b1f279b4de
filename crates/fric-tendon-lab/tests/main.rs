//! The model of a manipulator against a truth that is not the model, and what gratings tell.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod discover;
mod experiments;
mod gratings;
mod guards;
mod identify;
mod runs;
mod shapes;
mod track;
