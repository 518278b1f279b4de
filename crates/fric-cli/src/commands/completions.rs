//! `completions`: a shell's completion script for commands, options and their values.

use clap::CommandFactory as _;

use crate::arguments::{Arguments, CompletionsArguments};
use crate::failure::Outcome;
use crate::output;

/// The name under which shells know the program.
const PROGRAM: &str = "fric-cli";

/// Runs the command.
pub fn run(arguments: &CompletionsArguments) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), PROGRAM, &mut script);
    output::print(&script)
}
