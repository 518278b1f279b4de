//! `discover`: what a manipulator file lacks.

use fric_core::continuum::edit::rewrite;
use fric_lab::continuum::discover::{TendonDiscoverResult, discover};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use super::{Manipulator, TendonRun, check_disks, flat};
use crate::arrays::{fixed, fixed_rows};
use crate::errors::Outcome;
use crate::results;
use crate::watch::with_own_threads;

/// Outcome of `discover`. Arrays have a row for each sample that was compared: the run thinned, with every turn of the tension.
#[pyclass(module = "fric.continuum", frozen)]
pub struct TendonDiscovery {
    result: TendonDiscoverResult,
    /// The manipulator with what was found; all else, comments included, is as in the one given.
    #[pyo3(get)]
    manipulator: Py<Manipulator>,
    /// Time, s, (N,).
    #[pyo3(get)]
    time_s: Py<PyArray1<f64>>,
    /// Tension by the gratings less that of the given model, fitted, N, (N, disks); NaN where nothing was measured.
    #[pyo3(get)]
    residual_before_n: Py<PyArray2<f64>>,
    /// The same with the extended model, N, (N, disks).
    #[pyo3(get)]
    residual_after_n: Py<PyArray2<f64>>,
}

result_methods!(TendonDiscovery, "discover");

#[pymethods]
impl TendonDiscovery {
    /// "complete", "extended" by what was found, with which what is left is noise, or "unexplained".
    #[getter]
    fn verdict(&self) -> &str {
        self.result.cables.first().map_or("", |tendon| tendon.verdict)
    }

    /// What was found, as dicts: kind, parameters, standard_errors, gap_closed, evidence, runner_up.
    #[getter]
    fn effects<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.cables.first().map(|tendon| &tendon.effects))
    }

    /// Distances between disks and markers under the tensions that the gratings show, as a dict: noise_mm, calibration_error_mm, before,
    /// after; None where too few markers tell their noise.
    #[getter]
    fn markers<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.cables.first().and_then(|tendon| tendon.markers))
    }

    /// Candidates that helped and did not suffice, best first, as dicts: kind, parameters, evidence, reason.
    #[getter]
    fn tried<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.cables.first().map(|tendon| &tendon.tried))
    }

    /// Why the file keeps a μ that the run contradicts: shapes would be worse; None where it keeps none.
    #[getter]
    fn kept(&self) -> Option<&str> {
        self.result.cables.first().and_then(|tendon| tendon.kept.as_deref())
    }

    /// What no effect accounts for, as a dict: rms_n, rms_mm, where, goes_with; None where nothing is left.
    #[getter]
    fn unexplained<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.cables.first().and_then(|tendon| tendon.unexplained.as_ref()))
    }

    fn __repr__(&self) -> String {
        format!("<TendonDiscovery: {}>", self.verdict())
    }
}

/// Finds what the file of a manipulator lacks, from a run with the tension at the base and gratings: friction at the holes, their
/// memory, a grating that drifts, a hole with a μ of its own.
#[pyfunction]
pub fn continuum_discover(py: Python<'_>, manipulator: &Manipulator, run: &TendonRun) -> Outcome<TendonDiscovery> {
    check_disks(manipulator, &run.run)?;
    let (file, run) = (&manipulator.file, &run.run);
    let found = py.detach(|| with_own_threads(|| discover(file, run, "arrays")))??;
    let text = rewrite(&manipulator.text, "manipulator", &found.edit)?;
    let disks = file.params().disk_count();
    Ok(TendonDiscovery {
        result: found.result,
        manipulator: Py::new(py, Manipulator::parse(text, "manipulator")?)?,
        time_s: fixed(py, found.time_s),
        residual_before_n: fixed_rows(py, flat(&found.residual_before_n), disks)?,
        residual_after_n: fixed_rows(py, flat(&found.residual_after_n), disks)?,
    })
}
