//! The program as its users meet it: what they type, what they get, what is left behind.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking, its helpers too"
)]
#![allow(clippy::format_push_string, clippy::format_collect, reason = "texts of tests are put together as they read")]

mod cdr;
mod closed_stdout;
mod command_line;
mod continuum;
mod continuum_path;
mod convert;
mod correct;
mod csv_logs;
mod damage;
mod discover;
mod excite;
mod failing;
mod fit;
mod fit_inputs;
mod help;
mod hysteresis;
mod info;
mod init;
mod inputs;
mod interrupt;
mod known;
mod lengths;
mod logs;
mod outputs;
mod part;
mod per_log;
mod replay;
mod replay_output;
mod report;
mod robot_files;
mod simulate;
mod split;
mod support;
mod terminal;
