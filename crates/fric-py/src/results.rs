//! Converts results to the classes of `fric._results`.

use fric_work::provenance::Provenance;
use pyo3::call::PyCallArgs;
use pyo3::prelude::*;
use serde::Serialize;

use crate::errors::{Fault, Outcome};

/// Returns the presentations of a result, for people and machines.
pub fn shown<'py>(
    py: Python<'py>,
    summary: String,
    result: &impl Serialize,
    page: impl FnOnce(&Provenance) -> String,
    table: String,
    provenance: &Provenance,
) -> Outcome<Bound<'py, PyAny>> {
    let json = fric_work::json(result, provenance);
    let json = json.map_err(|error| Fault::output(format!("cannot write the result as JSON: {error}")))?;
    Ok(py.import("fric._results.base")?.getattr("Shown")?.call1((summary, json, page(provenance), table))?)
}

/// Creates an object of a class of `fric._results` with these fields.
pub fn new<'py>(py: Python<'py>, class: &str, fields: impl PyCallArgs<'py>) -> PyResult<Bound<'py, PyAny>> {
    py.import("fric._results")?.getattr(class)?.call1(fields)
}

/// Creates an object of a class that reads its fields from the JSON of its texts.
pub fn of<'py>(py: Python<'py>, class: &str, fields: impl PyCallArgs<'py>) -> PyResult<Bound<'py, PyAny>> {
    py.import("fric._results")?.getattr(class)?.call_method1("_of", fields)
}
