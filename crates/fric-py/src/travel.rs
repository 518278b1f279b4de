//! What pickles hold: `__reduce__` gives a function and its arguments, by which `pickle` and `copy` make the object anew.

use pyo3::prelude::*;

use crate::errors::{Fault, Outcome};

/// What `__reduce__` gives.
pub type Reduced<'py, T> = (Bound<'py, PyAny>, T);

/// This version, which states of the inside are for.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Refuses the inside of another version.
pub fn check_version(version: &str) -> Outcome {
    if version == VERSION {
        return Ok(());
    }
    Err(Fault::config(format!(
        "the pickle is of fric {version}, this is {VERSION}, which keeps its state otherwise; make the object anew"
    )))
}
