//! `hysteresis`: the remaining hysteresis of the wrench.

use fric_work::hysteresis::run;
use fric_work::provenance::Provenance;
use fric_work::report::hysteresis as report;
use pyo3::prelude::*;

use crate::arguments::object;
use crate::errors::Outcome;
use crate::log;
use crate::results;
use crate::robot::Robot;
use crate::watch::Watch;

/// The hysteresis of the wrench where the platform crosses a position, with and without compensation: `fric-cli hysteresis`.
///
/// `log` is a Log, a path or several paths of one split recording.
///
/// >>> robot = Robot.read("examples/mini-ipanema.toml")
/// >>> result = hysteresis(robot, simulate(robot, run="crossing", duration_s=20.0))
/// >>> x = result.axes[0]
/// >>> x.axis, x.unit, x.compensated.width < x.without.width
/// ('x', 'N', True)
#[pyfunction]
#[pyo3(signature = (robot, log, *, progress=None), text_signature = "(robot, log, *, progress=False)")]
pub fn hysteresis(
    #[pyo3(from_py_with = object)] robot: &Bound<'_, Robot>,
    log: &Bound<'_, PyAny>,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<Py<PyAny>> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    watch.part(0, 3);
    let log = log::of(log, robot, None, &mut watch)?;
    let (log, file) = (log.get(), robot.borrow().file.clone());
    watch.part(1, 3);
    let (result, loops) = log.with_source(py, |source| {
        let again = source.again();
        run(&file, source, &mut watch, |watch| {
            watch.part(2, 3);
            Ok(again)
        })
    })?;
    let text = robot.borrow().to_toml()?;
    let provenance = Provenance::of_call("fric.hysteresis", &log.sources, Some((&result.robot, &text)));
    let page = |provenance: &Provenance| report::page(&result, &loops, provenance);
    let shown = results::shown(py, result.summary(), &result, page, report::table(&result), &provenance)?;
    Ok(results::of(py, "HysteresisResult", (shown, <(f64, f64, f64)>::from(result.position_m)))?.unbind())
}
