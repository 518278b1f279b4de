//! Tests of what `fric-log` does as seen from outside.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking, its helpers too"
)]
#![allow(clippy::format_push_string, clippy::format_collect, reason = "texts of tests are put together as they read")]

mod bag;
mod csv_log;
mod path;
mod recording;
mod schema;
mod signals;
mod table;
mod write;
