//! `CATALOGUE`: every effect with its parameters, cause and remedy, as plain Python values.

use fric_core::effects::{Effect, EffectRow};
use fric_core::parameters::ParameterRow;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Returns the rows of the catalogue in order, starting with the friction that every model has.
pub fn catalogue(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    Effect::ALL.iter().filter(|effect| !effect.is_second()).map(|effect| entry(py, *effect)).collect()
}

fn entry(py: Python<'_>, effect: Effect) -> PyResult<Bound<'_, PyDict>> {
    let EffectRow { kind, cause, remedy, parameters, example, .. } = *effect.row();
    let entry = PyDict::new(py);
    entry.set_item("kind", kind)?;
    entry.set_item("is_friction", effect.is_friction())?;
    entry.set_item("cause", cause)?;
    entry.set_item("remedy", remedy)?;
    let parameters = parameters.iter().map(|row| parameter(py, row)).collect::<PyResult<Vec<_>>>()?;
    entry.set_item("parameters", parameters)?;
    entry.set_item("example", example.to_vec())?;
    Ok(entry)
}

fn parameter<'py>(py: Python<'py>, row: &ParameterRow) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("key", row.key)?;
    entry.set_item("unit", row.unit)?;
    entry.set_item("neutral", row.neutral)?;
    entry.set_item("min", row.min)?;
    entry.set_item("max", row.max)?;
    entry.set_item("fitted", row.fitted)?;
    entry.set_item("excitation", row.excitation)?;
    Ok(entry)
}
