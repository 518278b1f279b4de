//! `shape`: shapes by four ways of friction.

use fric_core::robot::unknown_name;
use fric_lab::continuum::comparison::{Selection, WayShapes, compare};
use fric_lab::continuum::gratings::Gratings;
use fric_lab::continuum::result;
use numpy::{PyArray1, PyArray2, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::{Manipulator, TendonRun, check_disks, measured};
use crate::arrays::{array, fixed, fixed_rows};
use crate::errors::{Fault, Outcome};
use crate::log;
use crate::results;

/// Outcome of `shape`. `ways` names the ways of friction that the run allows; arrays of a way have a row a sample.
#[pyclass(module = "fric.continuum", frozen)]
pub struct ShapeResult {
    result: result::ShapeResult,
    ways: Vec<WayShapes>,
}

impl ShapeResult {
    fn way(&self, name: &str) -> Outcome<&WayShapes> {
        self.ways.iter().find(|way| way.way.name() == name).ok_or_else(|| {
            let known = self.ways.iter().map(|way| way.way.name());
            Fault::config(unknown_name("way", name, known))
        })
    }

    fn disk_count(&self) -> usize {
        self.ways.iter().flat_map(|way| &way.shapes).map(|shape| shape.disk_position_m.len()).max().unwrap_or(1)
    }
}

result_methods!(ShapeResult, "continuum shape");

#[pymethods]
impl ShapeResult {
    /// Names of the ways: "none", "coulomb", "measured", "history".
    #[getter]
    fn ways<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.ways.iter().map(|way| way.way.name()))
    }

    /// Time, s, (N,).
    #[getter]
    fn time_s(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        fixed(py, self.result.time_s.clone())
    }

    /// The shapes that were picked, as dicts: time_s, tension_base_n, marker_m, and by each way errors, disk_position_m, friction_n …
    #[getter]
    fn shapes<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.shapes)
    }

    /// Errors of each way, as dicts: way, picked and all with max_mm and mean_mm, missing.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.ways)
    }

    /// Centres of the disks by a way, base frame, m, (N, disks, 2).
    fn disk_position_m(&self, py: Python<'_>, way: &str) -> Outcome<Py<PyArrayDyn<f64>>> {
        let shapes = &self.way(way)?.shapes;
        let all = shapes.iter().flat_map(|shape| shape.disk_position_m.as_flattened()).copied().collect();
        array(py, all, &[shapes.len(), self.disk_count(), 2])
    }

    /// Friction at each hole by a way, N, (N, holes).
    fn friction_n(&self, py: Python<'_>, way: &str) -> Outcome<Py<PyArray2<f64>>> {
        let all = self.way(way)?.shapes.iter().flat_map(|shape| &shape.friction_n).copied().collect();
        fixed_rows(py, all, self.disk_count())
    }

    /// Tension in each segment by a way, N, (N, disks).
    fn tension_n(&self, py: Python<'_>, way: &str) -> Outcome<Py<PyArray2<f64>>> {
        let all = self.way(way)?.shapes.iter().flat_map(|shape| &shape.tension_n).copied().collect();
        fixed_rows(py, all, self.disk_count())
    }

    /// Bend of the manipulator by a way, rad, (N,).
    fn bend_rad(&self, py: Python<'_>, way: &str) -> Outcome<Py<PyArray1<f64>>> {
        Ok(fixed(py, self.way(way)?.shapes.iter().map(|shape| shape.bend_rad).collect()))
    }

    fn __repr__(&self) -> String {
        let names: Vec<&str> = self.ways.iter().map(|way| way.way.name()).collect();
        format!("<ShapeResult of {} samples: {}>", self.result.samples, names.join(", "))
    }
}

/// The shapes of a run by all ways of friction for which it has what they need, compared with the markers.
///
/// `shapes` are picked, spread over the run; with `mixed`, from the samples in which the gratings show friction of both
/// directions; with `at_s` those at these times.
///
/// >>> import numpy as np
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> tension_n = np.concatenate([np.linspace(0.0, 1.2, 60), np.linspace(1.2, 1.0, 10)])
/// >>> run = continuum.TendonRun.from_arrays(arm, time_s=np.arange(70) * 0.1, tension_base_n=tension_n)
/// >>> result = continuum.shape(arm, run)
/// >>> result.ways
/// ('none', 'coulomb', 'history')
/// >>> friction_n = result.friction_n("history")[-1]
/// >>> bool(friction_n[0] < 0 < friction_n[-1])      # the base side has turned round, the tip not yet
/// True
#[pyfunction]
#[pyo3(signature = (manipulator, run, *, shapes=6, at_s=None, mixed=false))]
pub fn continuum_shape(
    py: Python<'_>,
    manipulator: &Manipulator,
    run: &TendonRun,
    shapes: usize,
    at_s: Option<Vec<f64>>,
    mixed: bool,
) -> Outcome<ShapeResult> {
    let run = &run.run;
    check_disks(manipulator, run)?;
    let params = manipulator.file.params();
    let selection = match at_s {
        Some(times_s) => Selection::At(times_s),
        None if mixed => Selection::Mixed(shapes),
        None => Selection::Spread(shapes),
    };
    let measured = py.detach(|| measured(manipulator, run))?;
    let ways = py.detach(|| compare(params, run, measured.as_deref()))?;
    let picked = selection.places(run, measured.as_deref())?;
    let name = &manipulator.file.tables().name;
    let result = result::ShapeResult::new(name, params, run, measured.as_deref(), &ways, &picked);
    let greatest_rad = result.greatest_bend_rad();
    if let Some(gratings) = Gratings::from_file(&manipulator.file)? {
        gratings.check_travel(params, greatest_rad)?;
    }
    log::warn(py, &result.warnings(&ways))?;
    Ok(ShapeResult { result, ways })
}
