//! `replay`: runs the compensator over a log, as the control loop would.

use std::path::PathBuf;

use fric_core::RobotParams;
use fric_lab::columns::OutputColumns;
use fric_lab::discover::{self, Corrections};
use fric_lab::fit::{Reference, SampleStore};
use fric_lab::replay::Replay;
use fric_log::write::ReplayedLog;
use fric_work::provenance::Provenance;
use fric_work::recording_name;
use fric_work::replay::{CycleTimes, ReplayResult};
use fric_work::report::{Series, errors};
use pyo3::exceptions::PyRuntimeError;
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
    let corrections = correct.then(|| corrections(py, log, &file.params(), &mut watch)).transpose()?;
    let params = match corrections.as_ref().and_then(Corrections::length_noise_m) {
        Some(length_noise_m) => file.params().with_length_noise_m(length_noise_m)?,
        None => file.params(),
    };
    let mut replay = Replay::new(&params)?;
    let mut room = Vec::new();
    let mut times = CycleTimes::new()
        .map_err(|error| PyRuntimeError::new_err(format!("cannot set up the histogram of cycle times: {error}")))?;
    let mut series = Series::new(names.len());
    let (mut columns, mut cables) = (OutputColumns::default(), Vec::new());
    let row_count = log.with_rows(py, |rows| {
        watch.work(rows.len(), |range| {
            for row in range {
                let Some(sample) = rows.sample(row, &mut cables) else { break };
                let sample = match &corrections {
                    Some(corrections) => corrections.corrected(row, &sample, &mut room),
                    None => sample,
                };
                let cycle = replay.step(&sample);
                times.add(cycle.cycle_ns);
                if let Some(writer) = &mut writer {
                    writer.write(sample.stamp_nanos, cycle.cables, cycle.outside_wrench.as_ref())?;
                }
                series.add(&sample, &cycle);
                columns.push(cycle.cables, cycle.outside_wrench.as_ref());
            }
            Ok(())
        })?;
        Ok(rows.len())
    })?;
    if let Some(writer) = writer {
        py.detach(|| writer.finish())?;
    }
    log::warn(py, &replay.warnings(&file, false))?;
    let result = ReplayResult::new(&file, &replay, &times).with_corrections(corrections.as_ref());
    let provenance = Provenance::of_call("fric.replay", &log.sources, Some((&result.robot, &text)));
    let page = |provenance: &Provenance| errors::page(&result, &series, provenance);
    let shown = results::shown(py, result.summary(), &result, page, errors::table(&result), &provenance)?;
    let flags: Vec<u32> = replay.cables().iter().map(|errors| errors.flags).collect();
    let cycles = compensation(py, columns, Some(row_count), names.len())?;
    Ok(results::of(py, "ReplayResult", (shown, flags, cycles))?.unbind())
}

/// Returns the corrections of a log before it is compared with its reference.
fn corrections(py: Python<'_>, log: &Log, params: &RobotParams<'_>, watch: &mut Watch<'_>) -> Outcome<Corrections> {
    let mut samples = SampleStore::new(params, Reference::Forces);
    let mut cables = Vec::new();
    log.with_rows(py, |rows| {
        watch.work(rows.len(), |range| {
            for row in range {
                let Some(sample) = rows.sample(row, &mut cables) else { break };
                samples.add(&sample)?;
            }
            Ok(())
        })
    })?;
    Ok(watch.fit(|progress| discover::corrections(&samples, progress))??)
}
