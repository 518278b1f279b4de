//! What is worth knowing, on stderr.

use crate::terminal::{self, Label};

/// One line on stderr, unless `--quiet` is given.
pub fn warn(text: &str) {
    if !terminal::is_quiet() {
        terminal::say(Label::Warning, text, None);
    }
}

/// A line each.
pub fn warn_all(texts: &[String]) {
    for text in texts {
        warn(text);
    }
}
