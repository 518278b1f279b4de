//! `shape`: shapes by four friction models.

use fric_core::robot::unknown_name;
use fric_tendon_lab::comparison::{Selection, WayShapes, compare};
use fric_tendon_lab::gratings::Gratings;
use fric_tendon_lab::result::ShapeResult;
use fric_tendon_lab::shape_errors::{ComputedShape, Way};
use fric_work::provenance::Provenance;
use fric_work::report::continuum as report;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{Manipulator, TendonRun, guarded, in_base_frame};
use crate::arguments::{argument, frozen};
use crate::arrays::{array, fixed, fixed_rows};
use crate::errors::{Fault, Outcome};
use crate::log;
use crate::results;

/// The shapes of a run by all friction models whose inputs it contains, compared with the markers.
///
/// `shapes` is the number of shapes to pick, spread over the run; with `mixed`, from the samples in which the gratings show friction in both
/// directions; with `at_s`, those at these times. `ways` names the friction models to compute: "none", "coulomb", "measured", "history"; all by
/// default.
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
#[pyo3(signature = (manipulator, run, *, shapes=6, at_s=None, mixed=false, ways=None))]
pub fn continuum_shape(
    py: Python<'_>,
    #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
    #[pyo3(from_py_with = frozen)] run: &TendonRun,
    #[pyo3(from_py_with = argument)] shapes: usize,
    #[pyo3(from_py_with = argument)] at_s: Option<Vec<f64>>,
    #[pyo3(from_py_with = argument)] mixed: bool,
    #[pyo3(from_py_with = argument)] ways: Option<Vec<String>>,
) -> Outcome<Py<PyAny>> {
    let files = run.files();
    let run = &in_base_frame(manipulator, &run.run)?;
    let params = manipulator.file.params();
    let selection = match at_s {
        Some(times_s) => Selection::At(times_s),
        None if mixed => Selection::Mixed(shapes),
        None => Selection::Spread(shapes),
    };
    let wanted = wanted_ways(ways)?;
    let guarded = py.detach(|| guarded(manipulator, run))?;
    let measured = guarded.as_ref().map(|guarded| guarded.measured.as_slice());
    let ways = py.detach(|| compare(params, run, measured, &wanted))?;
    let picked = selection.places(run, measured)?;
    let name = &manipulator.file.tables().name;
    let result = ShapeResult::new(name, params, run, guarded.as_ref(), &ways, &picked);
    let greatest_rad = result.greatest_bend_rad();
    if let Some(gratings) = Gratings::from_file(&manipulator.file)? {
        gratings.check_travel(params, greatest_rad)?;
    }
    log::warn(py, &result.warnings(&ways))?;
    let provenance = manipulator.provenance("fric.continuum.shape", &files);
    let page = |provenance: &Provenance| report::shape(&result, run, &ways, provenance);
    let shown = results::shown(py, result.summary(), &result, page, report::shape_table(&result), &provenance)?;
    let series = PyDict::new(py);
    for way in &ways {
        series.set_item(way.way.name(), series_of(py, way, run.disk_count())?)?;
    }
    Ok(results::of(py, "ShapeResult", (shown, fixed(py, result.time_s.clone()), series))?.unbind())
}

/// Returns the friction models of these names; all if none are named.
fn wanted_ways(names: Option<Vec<String>>) -> Outcome<Vec<Way>> {
    let Some(names) = names else { return Ok(Way::ALL.to_vec()) };
    let of_name = |name: &String| {
        Way::of_name(name).ok_or_else(|| Fault::config(unknown_name("way", name, Way::ALL.into_iter().map(Way::name))))
    };
    names.iter().map(of_name).collect()
}

/// Returns the arrays of a friction model by name.
fn series_of<'py>(py: Python<'py>, way: &WayShapes, disks: usize) -> Outcome<Bound<'py, PyDict>> {
    let shapes = &way.shapes;
    let rows = |of: fn(&ComputedShape) -> &[f64]| fixed_rows(py, shapes.iter().flat_map(of).copied().collect(), disks);
    let positions = shapes.iter().flat_map(|shape| shape.disk_position_m.as_flattened()).copied().collect();
    let series = PyDict::new(py);
    series.set_item("disk_position_m", array(py, positions, &[shapes.len(), disks, 2])?)?;
    series.set_item("friction_n", rows(|shape| &shape.friction_n)?)?;
    series.set_item("tension_n", rows(|shape| &shape.tension_n)?)?;
    series.set_item("bend_rad", fixed(py, shapes.iter().map(|shape| shape.bend_rad).collect()))?;
    Ok(series)
}
