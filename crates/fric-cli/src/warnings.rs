//! Warnings on stderr.

use crate::terminal::{self, Label};

/// Prints one line on stderr, unless `--quiet` is given.
pub fn warn(text: &str) {
    if !terminal::is_quiet() {
        terminal::say(Label::Warning, text, None);
    }
}

/// Prints one line per text.
pub fn warn_all(texts: &[String]) {
    for text in texts {
        warn(text);
    }
}
