//! The words of the command line, which results state as their origin.

use std::ffi::OsString;
use std::sync::{Mutex, PoisonError};

static WORDS: Mutex<Vec<OsString>> = Mutex::new(Vec::new());

/// Stores the words of the command that begins.
pub fn remember(words: &[OsString]) {
    WORDS.lock().unwrap_or_else(PoisonError::into_inner).splice(.., words.iter().cloned());
}

/// Returns the words of the running command, the program's name first.
pub fn words() -> Vec<OsString> {
    WORDS.lock().unwrap_or_else(PoisonError::into_inner).clone()
}
