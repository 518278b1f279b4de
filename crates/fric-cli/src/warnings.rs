//! What is worth knowing, on stderr.

use std::io::Write as _;

use fric_core::text_file::printable;

/// One line on stderr.
pub fn warn(text: &str) {
    // Nothing can be done about a stderr that is gone.
    let _ = writeln!(std::io::stderr(), "warning: {}", printable(text));
}

/// A line each.
pub fn warn_all(texts: &[String]) {
    for text in texts {
        warn(text);
    }
}
