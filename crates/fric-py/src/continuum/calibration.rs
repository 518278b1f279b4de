//! `calibrate`: fits the lines of the gratings to load steps.

use fric_tendon::edit::{ManipulatorEdit, rewrite};
use fric_tendon_lab::fbg::{Calibration, LoadStep};
use fric_tendon_lab::result::CalibrationResult;
use fric_work::provenance::Provenance;
use fric_work::report::continuum as report;
use pyo3::prelude::*;

use super::Manipulator;
use crate::arguments::frozen;
use crate::arrays::{Axis, Wanted, numbers};
use crate::errors::Outcome;
use crate::results;

/// Calibrates the gratings of a manipulator: loads on the fibre, N, (N,), and the shift of each grating, nm, (N, disks).
///
/// >>> import numpy as np
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> load_n = np.linspace(0.2, 2.0, 10)
/// >>> result = continuum.calibrate(arm, load_n, np.tile(load_n[:, None] / 11.4, (1, 8)))
/// >>> result.newton_per_nm.round(6), result.manipulator.has_gratings
/// (array([11.4, 11.4, 11.4, 11.4, 11.4, 11.4, 11.4, 11.4]), True)
#[pyfunction]
pub fn continuum_calibrate(
    py: Python<'_>,
    #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
    load_n: &Bound<'_, PyAny>,
    shift_nm: &Bound<'_, PyAny>,
) -> Outcome<Py<PyAny>> {
    let count = manipulator.file.params().disk_count();
    let loads = numbers(&Wanted { name: "load_n", shape: &[Axis::Rows], entries: "one load a step" }, load_n)?;
    let shape = [Axis::Exactly(loads.len()), Axis::Exactly(count)];
    let shifts = numbers(&Wanted { name: "shift_nm", shape: &shape, entries: "one shift for each grating" }, shift_nm)?;
    let rows = loads.iter().zip(shifts.chunks_exact(count));
    let steps: Vec<LoadStep> =
        rows.map(|(load_n, shift_nm)| LoadStep { load_n: *load_n, shift_nm: shift_nm.to_vec() }).collect();
    let lines = Calibration::fit_all(&steps)?;
    let result = CalibrationResult::new(&manipulator.file.tables().name, &steps, &lines);
    let edit = ManipulatorEdit { lines: result.lines(), ..ManipulatorEdit::default() };
    let text = rewrite(&manipulator.text, "manipulator", &edit)?;
    let provenance = manipulator.provenance("fric.continuum.calibrate", &[]);
    let page = |provenance: &Provenance| report::calibration(&result, provenance);
    let shown = results::shown(py, result.summary(), &result, page, report::calibration_table(&result), &provenance)?;
    let calibrated = Py::new(py, Manipulator::parse(text, "manipulator")?)?;
    Ok(results::of(py, "CalibrationResult", (shown, calibrated))?.unbind())
}
