//! The content of pickles: `__reduce__` returns a function and its arguments, with which `pickle` and `copy` recreate the object.

use fric_work::verdict::counted;
use pyo3::prelude::*;

use crate::errors::{Fault, Outcome};

/// The return value of `__reduce__`.
pub type Reduced<'py, T> = (Bound<'py, PyAny>, T);

/// This version; internal states are valid only for it.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Returns the number of things whose state this is, for people; it is the first word.
pub fn counted_words(words: &[u64], thing: &str) -> String {
    counted(words.first().map_or(0, |count| usize::try_from(*count).unwrap_or(usize::MAX)), thing)
}

/// Refuses the internal state of another version.
pub fn check_version(version: &str) -> Outcome {
    if version == VERSION {
        return Ok(());
    }
    Err(Fault::config(format!(
        "the pickle is of fric {version}, this is {VERSION}, which keeps its state otherwise; make the object anew"
    )))
}
