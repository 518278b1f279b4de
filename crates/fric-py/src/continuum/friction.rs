//! `friction` at every hole, `hole`: μ of a single one.

use fric_core::continuum::Tendon;
use fric_lab::continuum::friction::{HoleLoad, hole_coefficient};
use fric_lab::continuum::{ContinuumError, result};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use super::{Manipulator, TendonRun, check_disks, flat, measured};
use crate::arrays::{Axis, Wanted, fixed, fixed_rows, numbers};
use crate::errors::Outcome;
use crate::log;

/// Outcome of `friction`: arrays with a row a sample and a column a hole, from the base plate. Friction is positive where the base side
/// is tighter, NaN where it is not known.
#[pyclass(module = "fric.continuum", frozen)]
pub struct FrictionResult {
    result: result::FrictionResult,
}

result_methods!(FrictionResult, "continuum friction");

#[pymethods]
impl FrictionResult {
    /// Time, s, (N,).
    #[getter]
    fn time_s(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        fixed(py, self.result.series.time_s.clone())
    }

    /// Friction, N, (N, holes).
    #[getter]
    fn friction_n(&self, py: Python<'_>) -> Outcome<Py<PyArray2<f64>>> {
        fixed_rows(py, flat(&self.result.series.friction_n), self.result.holes.len())
    }

    /// Its standard error, N, (N, holes).
    #[getter]
    fn standard_error_n(&self, py: Python<'_>) -> Outcome<Py<PyArray2<f64>>> {
        fixed_rows(py, flat(&self.result.series.standard_error_n), self.result.holes.len())
    }

    /// Whether friction has both directions beyond doubt, (N,).
    #[getter]
    fn directions_differ(&self, py: Python<'_>) -> Py<PyArray1<bool>> {
        fixed(py, self.result.series.directions_differ.clone())
    }

    fn __repr__(&self) -> String {
        format!("<FrictionResult of {} samples>", self.result.samples)
    }
}

/// The friction at every hole over a run, from its gratings; a dead one is bridged and a LogWarning.
///
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> tendon = continuum.simulate(arm, run="mixed")
/// >>> calibrated = continuum.calibrate(arm, tendon.load_n, tendon.load_shift_nm).manipulator
/// >>> result = continuum.friction(calibrated, tendon.run)
/// >>> result.friction_n.shape, bool(result.directions_differ.any())
/// ((178, 8), True)
#[pyfunction]
pub fn continuum_friction(py: Python<'_>, manipulator: &Manipulator, run: &TendonRun) -> Outcome<FrictionResult> {
    let run = &run.run;
    check_disks(manipulator, run)?;
    run.check_capacity(manipulator.file.params().capacity_n(Tendon::Agonist))?;
    let measured = py.detach(|| measured(manipulator, run))?.ok_or(if run.has_shifts() {
        ContinuumError::NoGratings
    } else {
        ContinuumError::MissingGroup {
            what: "gratings",
            consequence: "friction cannot be measured",
            remedy: "`shift_nm`; `shape` predicts friction from the tension at the base",
        }
    })?;
    let result = result::FrictionResult::new(&manipulator.file.tables().name, run, &measured);
    log::warn(py, &result.bridged.iter().map(|one| one.warning(result.samples)).collect::<Vec<_>>())?;
    Ok(FrictionResult { result })
}

/// Outcome of `hole`.
#[pyclass(module = "fric.continuum", frozen)]
pub struct HoleResult {
    result: result::HoleResult,
}

#[pymethods]
impl HoleResult {
    /// Friction coefficient.
    #[getter]
    fn mu(&self) -> f64 {
        self.result.mu
    }

    /// Its standard error.
    #[getter]
    fn standard_error(&self) -> f64 {
        self.result.standard_error
    }

    /// The interval that holds it in 95 of 100 cases.
    #[getter]
    fn interval(&self) -> (f64, f64) {
        self.result.interval.into()
    }

    /// The text that `fric-cli continuum hole` prints.
    fn summary(&self) -> String {
        self.result.summary()
    }

    fn __repr__(&self) -> String {
        format!("HoleResult(mu={:?}, standard_error={:?})", self.result.mu, self.result.standard_error)
    }
}

/// The friction coefficient of a single hole: tensions on both sides, N, and the angles between them and the normal force, rad.
///
/// >>> import numpy as np
/// >>> first_n = np.linspace(0.5, 2.0, 4)
/// >>> second_n = first_n * (1 - 0.2 * np.cos(1.0)) / (1 + 0.2 * np.cos(1.0))
/// >>> angle_rad = np.full(4, 1.0)
/// >>> round(continuum.hole(first_n, second_n, angle_rad, angle_rad).mu, 6)
/// 0.2
#[pyfunction]
pub fn continuum_hole(
    tension_1_n: &Bound<'_, PyAny>,
    tension_2_n: &Bound<'_, PyAny>,
    angle_1_rad: &Bound<'_, PyAny>,
    angle_2_rad: &Bound<'_, PyAny>,
) -> Outcome<HoleResult> {
    let wanted = |name, shape| Wanted { name, shape, entries: "one number a load" };
    let first_n = numbers(&wanted("tension_1_n", &[Axis::Rows]), tension_1_n)?;
    let rows = [Axis::Exactly(first_n.len())];
    let second_n = numbers(&wanted("tension_2_n", &rows), tension_2_n)?;
    let first_rad = numbers(&wanted("angle_1_rad", &rows), angle_1_rad)?;
    let second_rad = numbers(&wanted("angle_2_rad", &rows), angle_2_rad)?;
    let pairs = first_n.iter().zip(&second_n).zip(first_rad.iter().zip(&second_rad));
    let loads: Vec<HoleLoad> = pairs
        .map(|((first_n, second_n), (first_rad, second_rad))| HoleLoad {
            first_n: *first_n,
            second_n: *second_n,
            first_rad: *first_rad,
            second_rad: *second_rad,
        })
        .collect();
    Ok(HoleResult { result: result::HoleResult::new(&hole_coefficient(&loads)?) })
}
