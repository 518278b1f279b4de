//! `replay`: runs the compensator over a log, as the control loop would.

use std::path::PathBuf;

use fric_lab::columns::OutputColumns;
use fric_log::write::ReplayedLog;
use fric_work::provenance::Provenance;
use fric_work::recording_name;
use fric_work::replay::{Replayed, corrections as find_corrections, run};
use fric_work::report::{Series, errors};
use fric_work::source::RowSource;
use pyo3::prelude::*;

use crate::arguments::{argument, object};
use crate::compensator::compensation;
use crate::errors::{Fault, Outcome};
use crate::log::{self, Log};
use crate::results;
use crate::robot::Robot;
use crate::watch::Watch;

/// Runs the compensator over a log, as the control loop would, and compares with the reference: `fric-cli replay`.
///
/// `log` is a Log, a path or several paths of one split recording. With `output` the compensated forces, friction, wrench and status are written to
/// an MCAP file, completely or not at all; an existing file is replaced only with `force`. With `correct`, faults of the recording are corrected
/// before the comparison, and are listed in `faults` of each cable: a reference that is late or runs on another clock, noise of the lengths.
///
/// >>> robot = Robot.read("examples/mini-ipanema.toml")
/// >>> result = replay(robot, simulate(robot, duration_s=2.0))
/// >>> result.cable("cable1").after.rms_n < 0.2 * result.cable("cable1").before.rms_n
/// True
#[pyfunction]
#[pyo3(
    signature = (robot, log, *, output=None, force=false, correct=false, progress=None),
    text_signature = "(robot, log, *, output=None, force=False, correct=False, progress=False)"
)]
pub fn replay(
    #[pyo3(from_py_with = object)] robot: &Bound<'_, Robot>,
    log: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = argument)] output: Option<PathBuf>,
    #[pyo3(from_py_with = argument)] force: bool,
    #[pyo3(from_py_with = argument)] correct: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<Py<PyAny>> {
    let py = robot.py();
    let named_otherwise = output.as_ref().and_then(|path| Some((path.display(), recording_name::check(path).err()?)));
    if let Some((path, problem)) = named_otherwise {
        return Err(Fault::output(format!("`output` is `{path}`, and {problem}")));
    }
    let mut watch = Watch::new(py, progress)?;
    let is_read = log.is_instance_of::<Log>();
    if !is_read {
        watch.part(0, 2);
    }
    let log = log::of(log, robot, None, &mut watch)?;
    if !is_read {
        watch.part(1, 2);
    }
    let (log, file) = (log.get(), robot.borrow().file.clone());
    let names = file.cable_names();
    let text = robot.borrow().to_toml()?;
    let create = |path: PathBuf| ReplayedLog::create(&path, &log.sources, force, &text, &names);
    let mut writer = output.map(create).transpose()?;
    let mut corrections = |source: &mut RowSource<'_>| find_corrections(&file, source, &mut watch);
    let corrections = correct.then(|| log.with_source(py, &mut corrections)).transpose()?;
    let mut series = Series::new(names.len());
    let (mut columns, mut row_count) = (OutputColumns::default(), 0);
    let Replayed { result, flags } = log.with_source(py, |source| {
        run(&file, source, corrections.as_ref(), &mut watch, |sample, cycle| {
            row_count += 1;
            if let Some(writer) = &mut writer {
                writer.write(sample.stamp_nanos, cycle.cables, cycle.outside_wrench.as_ref())?;
            }
            series.add(sample, cycle);
            columns.push(cycle.cables, cycle.outside_wrench.as_ref());
            Ok(())
        })
    })?;
    if let Some(writer) = writer {
        py.detach(|| writer.finish())?;
    }
    let provenance = Provenance::of_call("fric.replay", &log.sources, Some((&result.robot, &text)));
    let page = |provenance: &Provenance| errors::page(&result, &series, provenance);
    let shown = results::shown(py, result.summary(), &result, page, errors::table(&result), &provenance)?;
    let cycles = compensation(py, columns, Some(row_count), names.len())?;
    Ok(results::of(py, "ReplayResult", (shown, flags, cycles))?.unbind())
}
