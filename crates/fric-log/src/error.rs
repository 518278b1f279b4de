//! Formats errors for people.

use std::error::Error;
use std::io;

/// Returns the text of an error and of its sources.
#[must_use]
pub fn in_full(error: &dyn Error) -> String {
    with_sources(error.to_string(), error)
}

/// Returns a text in place of the error's own, with the texts of its sources.
#[must_use]
pub fn with_sources(mut text: String, error: &dyn Error) -> String {
    let mut source = error.source();
    while let Some(error) = source {
        let reason = error.to_string();
        if !text.contains(&reason) {
            text = format!("{text}: {reason}");
        }
        source = error.source();
    }
    text
}

/// Returns the message of the operating system, without the name of a temporary file, which means nothing to people.
#[must_use]
pub fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" at path ").next().map_or_else(String::new, ToOwned::to_owned)
}
