//! `friction` at every hole, and `hole`: μ of a single one.

use fric_tendon_lab::ContinuumError;
use fric_tendon_lab::friction::{HoleLoad, hole_coefficient};
use fric_tendon_lab::result::{FrictionResult, HoleResult};
use fric_work::provenance::Provenance;
use fric_work::report::continuum as report;
use pyo3::prelude::*;

use super::{Manipulator, TendonRun, flat, guarded, in_base_frame};
use crate::arguments::frozen;
use crate::arrays::{Axis, Wanted, fixed, fixed_rows, numbers};
use crate::errors::Outcome;
use crate::log;
use crate::results;

/// The friction at every hole over a run, from its gratings. A dead grating is interpolated and causes a LogWarning.
///
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> tendon = continuum.simulate(arm, run="mixed")
/// >>> calibrated = continuum.calibrate(arm, tendon.load_n, tendon.load_shift_nm).manipulator
/// >>> result = continuum.friction(calibrated, tendon.run)
/// >>> result.friction_n.shape, bool(result.directions_differ.any())
/// ((178, 8), True)
#[pyfunction]
pub fn continuum_friction(
    py: Python<'_>,
    #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
    #[pyo3(from_py_with = frozen)] run: &TendonRun,
) -> Outcome<Py<PyAny>> {
    let files = run.files();
    let run = &in_base_frame(manipulator, &run.run)?;
    run.check_sizes(manipulator.file.params())?;
    let guarded = py.detach(|| guarded(manipulator, run))?.ok_or(if run.has_shifts() {
        ContinuumError::NoGratings
    } else {
        ContinuumError::MissingGroup {
            what: "gratings",
            consequence: "friction cannot be measured",
            remedy: "`shift_nm`; `shape` predicts friction from the tension at the base",
        }
    })?;
    let result = FrictionResult::new(&manipulator.file.tables().name, run, &guarded);
    log::warn(py, &result.grating_warnings())?;
    let provenance = manipulator.provenance("fric.continuum.friction", &files);
    let page = |provenance: &Provenance| report::friction(&result, provenance);
    let shown = results::shown(py, result.summary(), &result, page, report::friction_table(&result), &provenance)?;
    let (series, holes) = (&result.series, result.holes.len());
    let fields = (
        shown,
        fixed(py, series.time_s.clone()),
        fixed_rows(py, flat(&series.friction_n), holes)?,
        fixed_rows(py, flat(&series.standard_error_n), holes)?,
        fixed(py, series.directions_differ.clone()),
    );
    Ok(results::new(py, "FrictionResult", fields)?.unbind())
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
    py: Python<'_>,
    tension_1_n: &Bound<'_, PyAny>,
    tension_2_n: &Bound<'_, PyAny>,
    angle_1_rad: &Bound<'_, PyAny>,
    angle_2_rad: &Bound<'_, PyAny>,
) -> Outcome<Py<PyAny>> {
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
    let result = HoleResult::new(&hole_coefficient(&loads)?);
    log::warn(py, result.warning().as_slice())?;
    let provenance = Provenance::of_call("fric.continuum.hole", &[], None);
    let page = |provenance: &Provenance| report::hole(&result, provenance);
    let shown = results::shown(py, result.summary(), &result, page, report::hole_table(&result), &provenance)?;
    let fields = (shown, result.mu, result.standard_error, <(f64, f64)>::from(result.interval));
    Ok(results::new(py, "HoleResult", fields)?.unbind())
}
