//! What every command takes: colours, and how much is said.

use clap::{Args, ValueEnum};

/// Options of the terminal.
#[derive(Debug, Args)]
pub struct TerminalArguments {
    /// Colour errors, warnings and help
    #[arg(long, value_name = "WHEN", value_enum, default_value_t, global = true, help_heading = "Terminal")]
    pub color: ColorName,
    /// Print the result and errors alone: no progress, no warnings, no list of written files
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "Terminal")]
    pub quiet: bool,
    /// Say also which model is used, what has been read, and how long it took
    #[arg(short, long, global = true, help_heading = "Terminal")]
    pub verbose: bool,
}

/// When there are colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ColorName {
    /// On a terminal, unless `NO_COLOR` is set
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}
