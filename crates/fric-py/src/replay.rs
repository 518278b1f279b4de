//! `replay`: the compensator over a log, as the control loop would run it.

use std::path::PathBuf;

use fric_lab::columns::OutputColumns;
use fric_lab::errors::{self, WrenchResult};
use fric_lab::replay::{CableErrors as ReplayErrors, Deviation, Replay};
use fric_log::write::ReplayedLog;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::compensator::Compensation;
use crate::errors::{Fault, Outcome};
use crate::log::{self, Log};
use crate::robot::Robot;
use crate::watch::Watch;

/// Deviation of a force from the reference.
#[pyclass(module = "fric", frozen)]
pub struct ForceError {
    /// Root mean square, N.
    #[pyo3(get)]
    rms_n: f64,
    /// Mean of the magnitude, N.
    #[pyo3(get)]
    mae_n: f64,
}

/// Deviation of the wrench from the one in the log.
#[pyclass(module = "fric", frozen)]
pub struct WrenchError {
    /// Root mean square of the force deviation's length, N.
    #[pyo3(get)]
    force_rms_n: f64,
    /// The same of the torque, N m.
    #[pyo3(get)]
    torque_rms_nm: f64,
}

/// What a replay found for a cable.
#[pyclass(module = "fric", frozen)]
pub struct CableErrors {
    /// Name of the cable.
    #[pyo3(get)]
    name: String,
    /// Cycles run.
    #[pyo3(get)]
    samples: u64,
    errors: ReplayErrors,
}

/// Outcome of a replay; the arrays have a row per row of the log.
#[pyclass(module = "fric", frozen)]
pub struct ReplayResult {
    /// Name of the robot.
    #[pyo3(get)]
    robot: String,
    cables: Vec<Py<CableErrors>>,
    wrench: Option<(Py<WrenchError>, Py<WrenchError>)>,
    /// What the wrench is compared with: "wrench" in the log, or "mass" of the platform.
    #[pyo3(get)]
    wrench_reference: Option<&'static str>,
    compensation: Compensation,
}

impl ForceError {
    pub fn new(deviation: &Deviation) -> Option<Self> {
        errors::ForceError::of(deviation).map(Self::from)
    }
}

impl From<errors::ForceError> for ForceError {
    fn from(errors::ForceError { rms_n, mae_n }: errors::ForceError) -> Self {
        Self { rms_n, mae_n }
    }
}

impl WrenchError {
    /// Before and after.
    pub fn pair(py: Python<'_>, wrench: &WrenchResult) -> PyResult<(Py<Self>, Py<Self>)> {
        Ok((Py::new(py, Self::from(wrench.before))?, Py::new(py, Self::from(wrench.after))?))
    }
}

impl From<errors::WrenchError> for WrenchError {
    fn from(errors::WrenchError { force_rms_n, torque_rms_nm }: errors::WrenchError) -> Self {
        Self { force_rms_n, torque_rms_nm }
    }
}

#[pymethods]
impl ForceError {
    fn __repr__(&self) -> String {
        format!("ForceError(rms_n={:?}, mae_n={:?})", self.rms_n, self.mae_n)
    }
}

#[pymethods]
impl WrenchError {
    fn __repr__(&self) -> String {
        format!("WrenchError(force_rms_n={:?}, torque_rms_nm={:?})", self.force_rms_n, self.torque_rms_nm)
    }
}

#[pymethods]
impl CableErrors {
    /// Cycles with any flag.
    #[getter]
    fn flagged(&self) -> u64 {
        self.errors.flagged_count
    }

    /// Each flag of `Status` that was raised, as bits.
    #[getter]
    fn flags(&self) -> u32 {
        self.errors.flags
    }

    /// Error of the sensor force turned into tension as if nothing rubbed; None without a reference.
    #[getter]
    fn before(&self) -> Option<ForceError> {
        ForceError::new(&self.errors.before_n)
    }

    /// Error of the compensated force; None without a reference.
    #[getter]
    fn after(&self) -> Option<ForceError> {
        ForceError::new(&self.errors.after_n)
    }

    fn __repr__(&self) -> String {
        let error = |error: Option<ForceError>| error.map_or_else(|| "None".to_owned(), |error| error.__repr__());
        format!(
            "CableErrors(name={:?}, samples={}, flagged={}, before={}, after={})",
            self.name,
            self.samples,
            self.flagged(),
            error(self.before()),
            error(self.after())
        )
    }
}

#[pymethods]
impl ReplayResult {
    /// What was found for each cable, in the robot's order.
    #[getter]
    fn cables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.cables)
    }

    /// What was found for the cable of a name.
    fn cable(&self, py: Python<'_>, name: &str) -> Outcome<Py<CableErrors>> {
        let names = || self.cables.iter().map(|cable| cable.get().name.as_str());
        let found = self.cables.iter().find(|cable| cable.get().name == name);
        found
            .map(|cable| cable.clone_ref(py))
            .ok_or_else(|| Fault::config(fric_core::robot::unknown_name("cable", name, names())))
    }

    /// Error of the wrench before and after; None without a wrench in the log.
    #[getter]
    fn wrench(&self, py: Python<'_>) -> Option<(Py<WrenchError>, Py<WrenchError>)> {
        self.wrench.as_ref().map(|(before, after)| (before.clone_ref(py), after.clone_ref(py)))
    }

    /// Cable forces at the platform, N.
    #[getter]
    fn force_at_platform_n(&self, py: Python<'_>) -> Py<PyArrayDyn<f64>> {
        self.compensation.force_at_platform_n.clone_ref(py)
    }

    /// Estimated friction, N.
    #[getter]
    fn friction_n(&self, py: Python<'_>) -> Py<PyArrayDyn<f64>> {
        self.compensation.friction_n.clone_ref(py)
    }

    /// Sensor forces turned into tension as if nothing rubbed, N.
    #[getter]
    fn frictionless_n(&self, py: Python<'_>) -> Py<PyArrayDyn<f64>> {
        self.compensation.frictionless_n.clone_ref(py)
    }

    /// Bits of `Status`.
    #[getter]
    fn status(&self, py: Python<'_>) -> Py<PyArrayDyn<u32>> {
        self.compensation.status.clone_ref(py)
    }

    /// Force and torque on the platform from outside, gravity included; NaN while the pose or a cable's force is not
    /// known, None if it never is.
    #[getter]
    fn outside_wrench(&self, py: Python<'_>) -> Option<Py<PyArrayDyn<f64>>> {
        self.compensation.outside_wrench.as_ref().map(|wrench| wrench.clone_ref(py))
    }

    fn __repr__(&self) -> String {
        let samples = self.cables.first().map_or(0, |cable| cable.get().samples);
        format!("<ReplayResult of {:?}: {} cables, {samples} cycles>", self.robot, self.cables.len())
    }
}

/// Runs the compensator over a log, as the control loop would, and compares with the reference: `fric-cli replay`.
///
/// `log` is a Log, a path or several paths of one split recording. With `output` the compensated forces, friction,
/// wrench and status are written to an MCAP file, whole or not at all; an existing file is replaced only with `force`.
///
/// >>> robot = Robot.read("examples/mini-ipanema.toml")
/// >>> result = replay(robot, simulate(robot, duration_s=2.0))
/// >>> result.cable("cable1").after.rms_n < 0.2 * result.cable("cable1").before.rms_n
/// True
#[pyfunction]
#[pyo3(
    signature = (robot, log, *, output=None, force=false, progress=None),
    text_signature = "(robot, log, *, output=None, force=False, progress=False)"
)]
pub fn replay(
    robot: &Bound<'_, Robot>,
    log: &Bound<'_, PyAny>,
    output: Option<PathBuf>,
    force: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<ReplayResult> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    let log = if let Ok(log) = log.cast::<Log>() {
        log.clone()
    } else {
        watch.part(0, 2);
        let log = log::read(py, log, Some(robot), None, &mut watch)?;
        watch.part(1, 2);
        Bound::new(py, log)?
    };
    let (log, file) = (log.get(), robot.borrow().file.clone());
    let names = file.cable_names();
    log.check_cables(&names)?;
    let text = robot.borrow().to_toml()?;
    let create = |path: PathBuf| ReplayedLog::create(&path, &log.sources, force, &text, &names);
    let mut writer = output.map(create).transpose()?;
    let mut replay = Replay::new(&file.params())?;
    let (mut columns, mut cables) = (OutputColumns::default(), Vec::new());
    let row_count = log.with_rows(py, |rows| {
        watch.work(rows.len(), |range| {
            for row in range {
                let Some(sample) = rows.sample(row, &mut cables) else { break };
                let cycle = replay.step(&sample);
                if let Some(writer) = &mut writer {
                    writer.write(sample.stamp_nanos, cycle.cables, cycle.outside_wrench.as_ref())?;
                }
                columns.push(cycle.cables, cycle.outside_wrench.as_ref());
            }
            Ok(())
        })?;
        Ok(rows.len())
    })?;
    if let Some(writer) = writer {
        py.detach(|| writer.finish())?;
    }
    log::warn(py, &replay.warnings(&file))?;
    let errors = names.iter().zip(replay.cables());
    let cable = |(name, errors): (&&str, &ReplayErrors)| {
        Py::new(py, CableErrors { name: (*name).to_owned(), samples: replay.cycle_count(), errors: *errors })
    };
    let (before, after) = replay.wrench();
    let wrench = WrenchResult::of(replay.wrench_reference(), before, after);
    Ok(ReplayResult {
        robot: file.options().name.clone(),
        cables: errors.map(cable).collect::<PyResult<_>>()?,
        wrench_reference: wrench.map(|wrench| wrench.reference),
        wrench: wrench.map(|wrench| WrenchError::pair(py, &wrench)).transpose()?,
        compensation: Compensation::new(py, columns, Some(row_count), names.len())?,
    })
}
