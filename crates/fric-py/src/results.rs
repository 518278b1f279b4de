//! What all results have in common: what the command line prints and writes of them.

use pyo3::prelude::*;
use serde::Serialize;

use crate::errors::{Fault, Outcome};

/// `summary`, `to_json` and `to_dict` of a class whose field `result` is that of a command.
macro_rules! result_methods {
    ($class:ident, $command:literal) => {
        #[pyo3::pymethods]
        impl $class {
            #[doc = concat!("What `fric-cli ", $command, "` prints.")]
            fn summary(&self) -> String {
                self.result.summary()
            }

            #[doc = concat!("The text that `fric-cli ", $command, " --json` writes.")]
            fn to_json(&self) -> $crate::errors::Outcome<String> {
                $crate::results::json(&self.result)
            }

            /// The same as a dict.
            fn to_dict<'py>(&self, py: pyo3::Python<'py>) -> $crate::errors::Outcome<pyo3::Bound<'py, pyo3::PyAny>> {
                $crate::results::plain(py, &self.result)
            }
        }
    };
}

/// A result as the command line writes it.
pub fn json(result: &impl Serialize) -> Outcome<String> {
    let text = serde_json::to_string_pretty(result);
    text.map(|text| text + "\n").map_err(|error| Fault::output(format!("cannot write the result as JSON: {error}")))
}

/// The same as Python has it: dicts, lists and numbers.
pub fn plain<'py>(py: Python<'py>, result: &impl Serialize) -> Outcome<Bound<'py, PyAny>> {
    Ok(py.import("json")?.call_method1("loads", (json(result)?,))?)
}
