//! `calibrate`: load steps to the lines of the gratings.

use fric_core::continuum::edit::{ManipulatorEdit, rewrite};
use fric_lab::continuum::fbg::{Calibration, LoadStep};
use fric_lab::continuum::result;
use numpy::PyArray1;
use pyo3::prelude::*;

use super::Manipulator;
use crate::arrays::{Axis, Wanted, fixed, numbers};
use crate::errors::Outcome;

/// Outcome of `calibrate`: `T = a·Δλ + b` for each grating. Arrays have one entry for each grating; ratios are shares of the greatest load.
#[pyclass(module = "fric.continuum", frozen)]
pub struct CalibrationResult {
    result: result::CalibrationResult,
    /// The manipulator with these coefficients; all else, comments included, is as in the one given.
    #[pyo3(get)]
    manipulator: Py<Manipulator>,
}

impl CalibrationResult {
    fn each(&self, py: Python<'_>, of: fn(&result::GratingResult) -> f64) -> Py<PyArray1<f64>> {
        fixed(py, self.result.gratings.iter().map(of).collect())
    }
}

result_methods!(CalibrationResult, "continuum calibrate");

#[pymethods]
impl CalibrationResult {
    /// Slope a, N/nm.
    #[getter]
    fn newton_per_nm(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.each(py, |one| one.newton_per_nm)
    }

    /// Offset b, N.
    #[getter]
    fn offset_n(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.each(py, |one| one.offset_n)
    }

    /// Greatest standard error of a tension from one shift within the loads, N.
    #[getter]
    fn standard_error_n(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.each(py, |one| one.standard_error_n)
    }

    /// Largest residual.
    #[getter]
    fn largest_residual_ratio(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.each(py, |one| one.largest_residual_ratio)
    }

    /// Largest error at a load of the line through all others.
    #[getter]
    fn largest_left_out_ratio(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.each(py, |one| one.largest_left_out_ratio)
    }

    fn __repr__(&self) -> String {
        format!("<CalibrationResult of {} gratings>", self.result.gratings.len())
    }
}

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
    manipulator: &Manipulator,
    load_n: &Bound<'_, PyAny>,
    shift_nm: &Bound<'_, PyAny>,
) -> Outcome<CalibrationResult> {
    let count = manipulator.file.params().disk_count();
    let loads = numbers(&Wanted { name: "load_n", shape: &[Axis::Rows], entries: "one load a step" }, load_n)?;
    let shape = [Axis::Exactly(loads.len()), Axis::Exactly(count)];
    let shifts = numbers(&Wanted { name: "shift_nm", shape: &shape, entries: "one shift for each grating" }, shift_nm)?;
    let rows = loads.iter().zip(shifts.chunks_exact(count));
    let steps: Vec<LoadStep> =
        rows.map(|(load_n, shift_nm)| LoadStep { load_n: *load_n, shift_nm: shift_nm.to_vec() }).collect();
    let lines = Calibration::fit_all(&steps)?;
    let result = result::CalibrationResult::new(&manipulator.file.tables().name, &steps, &lines);
    let edit = ManipulatorEdit { lines: result.lines(), ..ManipulatorEdit::default() };
    let text = rewrite(&manipulator.text, "manipulator", &edit)?;
    Ok(CalibrationResult { manipulator: Py::new(py, Manipulator::parse(text, "manipulator")?)?, result })
}
