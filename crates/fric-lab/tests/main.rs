//! Public behaviour of `fric-lab`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod discover;
mod excite;
mod fit;
mod hysteresis;
mod replay;
mod simulate;
mod trajectory;
