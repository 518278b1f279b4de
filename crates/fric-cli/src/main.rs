//! The program `fric-cli`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(fric_cli::run(std::env::args_os()))
}
