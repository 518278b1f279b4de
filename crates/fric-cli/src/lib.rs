//! `fric-cli`: friction compensation for cable robots on the command line.
//!
//! The program is [`run`]: its own `main` calls it with the process's arguments, `python -m fric` with Python's.

mod arguments;
mod command;
mod commands;
mod failure;
mod interrupt;
mod measurements;
mod model;
mod output;
mod progress;
mod steps;
mod supervision;
mod terminal;
mod warnings;

use std::ffi::OsString;
use std::time::Instant;

use clap::Parser;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use arguments::{Arguments, Command};

/// Runs a command line, whose first word is the name of the program, and returns the exit code: 0, 1 if the work failed, 2 if the command line is
/// wrong.
///
/// Results go to stdout, errors and warnings to stderr. From then on Ctrl-C ends the command, and a second one the process.
#[must_use]
pub fn run(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words: Vec<OsString> = words.into_iter().collect();
    terminal::set_color(&words);
    command::remember(&words);
    let arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(mut error) => {
            // The command of that name is for both kinds of robots, and `continuum` has none.
            let is_discover =
                error.get(ContextKind::InvalidSubcommand).is_some_and(|word| word.to_string() == "discover");
            if error.kind() == ErrorKind::InvalidSubcommand && is_discover {
                let tip =
                    "a manipulator's run takes the same command as a robot's: fric-cli discover RUN --model M.toml";
                error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.to_owned().into()]));
            }
            // A broken stream cannot be reported anywhere.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    terminal::set_volume(&arguments.terminal);
    interrupt::listen();
    let start = Instant::now();
    let result = match &arguments.command {
        Command::Fit(arguments) => commands::fit::run(arguments),
        Command::Convert(arguments) => commands::convert::run(arguments),
        Command::Init(arguments) => commands::init::run(arguments),
        Command::Discover(arguments) => commands::discover::run(arguments),
        Command::Replay(arguments) => commands::replay::run(arguments),
        Command::Info(arguments) => commands::info::run(arguments),
        Command::Simulate(arguments) => commands::simulate::run(arguments),
        Command::Excite(arguments) => commands::excite::run(arguments),
        Command::Hysteresis(arguments) => commands::hysteresis::run(arguments),
        Command::Continuum(command) => commands::continuum::run(command),
        Command::Completions(arguments) => commands::completions::run(arguments),
        Command::Man(arguments) => commands::man::run(arguments),
    };
    match result {
        Ok(()) => {
            terminal::note(format_args!("done in {:.1} s", start.elapsed().as_secs_f64()));
            0
        }
        Err(failure) => {
            failure.print();
            failure.exit_code()
        }
    }
}
