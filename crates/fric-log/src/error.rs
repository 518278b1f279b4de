//! Formats errors for people.

use std::error::Error;
use std::io;

use miette::Diagnostic;

/// Returns the text of an error and of its sources.
#[must_use]
pub fn in_full(error: &dyn Error) -> String {
    let mut text = error.to_string();
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

/// Returns the text of an error and of its sources, and then what to do.
#[must_use]
pub fn with_advice(error: &impl Diagnostic) -> String {
    let cause = in_full(error);
    error.help().map_or_else(|| cause.clone(), |advice| format!("{cause}. {advice}"))
}

/// Returns the message of the operating system, without the name of a temporary file, which means nothing to people.
#[must_use]
pub fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" at path ").next().map_or_else(String::new, ToOwned::to_owned)
}
