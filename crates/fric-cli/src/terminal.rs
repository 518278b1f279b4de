//! Verbosity and colours: `--color`, `--quiet`, `--verbose`.

use std::ffi::OsString;
use std::fmt::Display;
use std::io::Write as _;
use std::sync::atomic::{AtomicU8, Ordering};

use anstream::ColorChoice;
use anstyle::{AnsiColor, Style};
use clap::ValueEnum as _;
use fric_core::text_file::printable;

use crate::arguments::terminal::{ColorName, TerminalArguments};

const QUIET: u8 = 0;
const NORMAL: u8 = 1;
const VERBOSE: u8 = 2;

/// The verbosity of this process, which runs one command.
static VOLUME: AtomicU8 = AtomicU8::new(NORMAL);

/// The label of a line on stderr.
#[derive(Clone, Copy, Debug)]
pub enum Label {
    Error,
    Warning,
    Note,
}

impl Label {
    fn word_and_style(self) -> (&'static str, Style) {
        match self {
            Self::Error => ("error", AnsiColor::Red.on_default().bold()),
            Self::Warning => ("warning", AnsiColor::Yellow.on_default().bold()),
            Self::Note => ("note", AnsiColor::Cyan.on_default().bold()),
        }
    }
}

/// Sets the colours before the command line is parsed, because its errors and `--help` have colours too.
///
/// Without `--color`, and with `auto`, colours are used on a terminal unless `NO_COLOR` is set.
pub fn set_color(words: &[OsString]) {
    let text = |word: &OsString| word.to_str().map(ToOwned::to_owned);
    let mut values = words.iter().enumerate().filter_map(|(place, word)| {
        let word = text(word)?;
        if word == "--color" {
            words.get(place + 1).and_then(text)
        } else {
            word.strip_prefix("--color=").map(Into::into)
        }
    });
    // The parser rejects invalid values.
    let choice = values.next_back().and_then(|value| ColorName::from_str(&value, false).ok());
    match choice.unwrap_or_default() {
        ColorName::Auto => ColorChoice::Auto,
        ColorName::Always => ColorChoice::AlwaysAnsi,
        ColorName::Never => ColorChoice::Never,
    }
    .write_global();
}

/// Sets the verbosity.
pub fn set_volume(arguments: &TerminalArguments) {
    let volume = if arguments.quiet { QUIET } else { NORMAL + u8::from(arguments.verbose) };
    VOLUME.store(volume, Ordering::Relaxed);
}

/// Whether only errors and the result are printed.
pub fn is_quiet() -> bool {
    VOLUME.load(Ordering::Relaxed) == QUIET
}

/// Prints one labelled line on stderr, in one piece, with `below` on a second line.
pub fn say(label: Label, text: &str, below: Option<&str>) {
    let (word, style) = label.word_and_style();
    let mut lines = format!("{style}{word}:{style:#} {}\n", printable(text));
    if let Some(below) = below {
        lines += "  ";
        lines += &printable(below);
        lines.push('\n');
    }
    // If stderr is gone, nothing can be done.
    let _ = anstream::stderr().write_all(lines.as_bytes());
}

/// Prints what a command does, with `--verbose`.
pub fn note(text: impl Display) {
    if VOLUME.load(Ordering::Relaxed) >= VERBOSE {
        say(Label::Note, &text.to_string(), None);
    }
}
