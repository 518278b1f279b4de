//! Errors for people.

use std::error::Error;
use std::io;

/// What an error says, and what its sources add.
#[must_use]
pub fn in_full(error: &dyn Error) -> String {
    with_sources(error.to_string(), error)
}

/// A text that stands for what an error says, and what its sources add.
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

/// What the operating system said, without the name of a temporary file that means nothing to people.
#[must_use]
pub fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" at path ").next().map_or_else(String::new, ToOwned::to_owned)
}
