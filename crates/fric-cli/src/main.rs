//! `fric-cli`: friction compensation for cable robots on the command line.

mod arguments;
mod commands;
mod failure;
mod interrupt;
mod measurements;
mod model;
mod output;
mod progress;
mod report;
mod result;
mod set_points;
mod steps;
mod warnings;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    interrupt::listen();
    let result = match &arguments.command {
        Command::Fit(arguments) => commands::fit::run(arguments),
        Command::Convert(arguments) => commands::convert::run(arguments),
        Command::Discover(arguments) => commands::discover::run(arguments),
        Command::Replay(arguments) => commands::replay::run(arguments),
        Command::Info(arguments) => commands::info::run(arguments),
        Command::Simulate(arguments) => commands::simulate::run(arguments),
        Command::Excite(arguments) => commands::excite::run(arguments),
        Command::Hysteresis(arguments) => commands::hysteresis::run(arguments),
        Command::Continuum(command) => commands::continuum::run(command),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            ExitCode::from(failure.exit_code())
        }
    }
}
