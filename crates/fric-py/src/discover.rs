//! `discover`: what a model lacks, from logs.

use fric_lab::discover::result::{self, DiscoverCableResult};
use fric_lab::discover::{CableDiscovery as Discovery, discover as discover_cables, extended};
use fric_lab::fit::readiness;
use fric_lab::fit::{Measurements, Reference};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::fixed;
use crate::errors::Outcome;
use crate::fit::{ORIGIN, dict, of_cable};
use crate::log;
use crate::replay::ForceError;
use crate::results;
use crate::robot::Robot;
use crate::runs::Runs;
use crate::watch::Watch;

/// What a discovery found for a cable. Dicts and lists are as in the result of `fric-cli discover --json`.
///
/// Arrays have an entry for every row of the logs one after the other; they are empty where nothing can be told.
#[pyclass(module = "fric", frozen)]
pub struct CableDiscovery {
    result: DiscoverCableResult,
    /// Time since the first row, s; several logs one after the other.
    #[pyo3(get)]
    time_s: Py<PyArray1<f64>>,
    /// Residual of the given model, fitted, N; NaN where a row does not count.
    #[pyo3(get)]
    residual_before_n: Py<PyArray1<f64>>,
    /// Residual of the extended model, N.
    #[pyo3(get)]
    residual_after_n: Py<PyArray1<f64>>,
}

/// Outcome of a discovery. `print(result.summary())` shows all of it, `result.plot("cable1")` a cable.
#[pyclass(module = "fric", frozen)]
pub struct DiscoverResult {
    result: result::DiscoverResult,
    /// The robot with what was found; all else, comments included, is as in the robot given.
    #[pyo3(get)]
    robot: Py<Robot>,
    cables: Vec<Py<CableDiscovery>>,
}

#[pymethods]
impl CableDiscovery {
    /// Name of the cable.
    #[getter]
    fn name(&self) -> &str {
        &self.result.name
    }

    /// Samples that count.
    #[getter]
    fn samples(&self) -> usize {
        self.result.samples
    }

    /// Samples that do not count, by the reason.
    #[getter]
    fn left_out<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.left_out)
    }

    /// Rows that judge and were not learned from, `[from, to]` without the last.
    #[getter]
    fn held_out_samples(&self) -> Vec<[usize; 2]> {
        self.result.held_out_samples.clone()
    }

    /// When they are, s since the first row.
    #[getter]
    fn held_out_s(&self) -> Vec<[f64; 2]> {
        self.result.held_out_s.clone()
    }

    /// Standard deviation of the white noise, N.
    #[getter]
    fn noise_floor_n(&self) -> Option<f64> {
        self.result.noise_floor_n
    }

    /// Standard deviation of slow noise that has nothing to do with the motion, N.
    #[getter]
    fn wander_n(&self) -> Option<f64> {
        self.result.wander_n
    }

    /// Error of the given model, fitted, on the samples held out.
    #[getter]
    fn before(&self) -> Option<ForceError> {
        self.result.before.map(ForceError::from)
    }

    /// Error of the extended model on the same samples.
    #[getter]
    fn after(&self) -> Option<ForceError> {
        self.result.after.map(ForceError::from)
    }

    /// Share of the gap, what is above the noise, that the extended model has closed; None where there is no gap.
    #[getter]
    fn gap_closed(&self) -> Option<f64> {
        self.result.gap_closed
    }

    /// "complete", "extended" by an effect with which what is left is noise, "unexplained", or None where the log does not
    /// allow to tell.
    #[getter]
    fn verdict(&self) -> Option<&str> {
        Some(self.result.verdict).filter(|_| self.result.missing.is_none())
    }

    /// What the log lacks for a verdict, cause and advice; None if nothing.
    #[getter]
    fn missing<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.missing)
    }

    /// Ranges of the conditions in which the given model disagrees, what tells most first.
    #[getter]
    fn r#where<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.places)
    }

    /// The same ranges in words, such as "at speeds below 20 mm/s".
    #[getter]
    fn where_in_words(&self) -> Vec<String> {
        self.result.places.iter().map(result::WhereResult::range_in_words).collect()
    }

    /// Effects that were found, in the order in which they entered: kind, parameters, standard_errors, gap_closed, evidence
    /// and runner_up.
    #[getter]
    fn effects<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.effects)
    }

    /// Every effect by itself beside the given model, the best first.
    #[getter]
    fn candidates<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.candidates)
    }

    /// Candidates that help the extended model and do not suffice, the best first: kind, evidence and reason.
    #[getter]
    fn tried<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.tried)
    }

    /// Standard deviation of the reference over the samples that judge, N: the error of a model that predicts a constant.
    #[getter]
    fn reference_variation_n(&self) -> Option<f64> {
        self.result.reference_variation_n
    }

    /// Values of the extended model by the robot file's keys, those of an effect as "stribeck.ratio".
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dict(py, &self.result.parameters)
    }

    /// Standard errors of those fitted.
    #[getter]
    fn standard_errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dict(py, &self.result.standard_errors)
    }

    /// What no effect accounts for; None if nothing.
    #[getter]
    fn unexplained<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.unexplained)
    }

    fn __repr__(&self) -> String {
        let DiscoverCableResult { name, verdict, effects, .. } = &self.result;
        let kinds: Vec<&str> = effects.iter().map(|effect| effect.kind).collect();
        let found = if kinds.is_empty() { String::new() } else { format!(", {}", kinds.join(", ")) };
        format!("<CableDiscovery {name:?}: {verdict}{found}>")
    }
}

impl CableDiscovery {
    fn new(py: Python<'_>, found: Discovery, result: DiscoverCableResult) -> PyResult<Py<Self>> {
        let [time_s, residual_before_n, residual_after_n] =
            [found.times_s, found.residual_before_n, found.residual_after_n].map(|numbers| fixed(py, numbers));
        Py::new(py, Self { result, time_s, residual_before_n, residual_after_n })
    }
}

result_methods!(DiscoverResult, "discover");

#[pymethods]
impl DiscoverResult {
    /// What was found for each cable, in the robot's order.
    #[getter]
    fn cables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.cables)
    }

    /// What was found for the cable of a name.
    fn cable(&self, py: Python<'_>, name: &str) -> Outcome<Py<CableDiscovery>> {
        of_cable(py, &self.robot, &self.cables, name)
    }

    /// Effects that several cables have, with the mean of their parameters over these.
    #[getter]
    fn common_effects<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.common_effects)
    }

    /// Draws a cable: `fric.plot.gap_ladder`, `where` and `candidates` in one figure, which it returns; needs matplotlib.
    fn plot<'py>(slf: &Bound<'py, Self>, cable: &str) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("fric.plot")?.call_method1("_discovery", (slf, cable))
    }

    fn __repr__(&self) -> String {
        let result::DiscoverResult { robot, cables, .. } = &self.result;
        let extended = cables.iter().filter(|cable| !cable.effects.is_empty()).count();
        format!("<DiscoverResult of {robot:?}: {} cables, effects found on {extended}>", cables.len())
    }
}

/// Looks where the model and logs disagree, and for the effect that is missing: `fric-cli discover`.
///
/// `log` is a Log, a path, or a list of them, each a run of its own, with forces measured at the platform. Half of it, in
/// blocks, judges what was learned from the other. A cable of which the log tells too little says so in its verdict; a log
/// that tells nothing of any cable raises FitError.
///
/// >>> robot = Robot.from_toml('''
/// ... format = "fric-robot/1"
/// ... name = "bench"
/// ... cycle_s = 0.004
/// ... [[cable]]
/// ... name = "winch"
/// ... pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]
/// ... friction = { mu = 0.02, sigma_n_per_m = 900.0, viscous_n_s_per_m = 0.3 }
/// ... ''')
/// >>> log = simulate(robot, duration_s=20.0, effects=["sensor_gain:gain=1.05"])
/// >>> result = discover(robot, log)
/// >>> winch = result.cable("winch")
/// >>> winch.verdict, [effect["kind"] for effect in winch.effects]
/// ('extended', ['sensor_gain'])
/// >>> result.robot.cable("winch").effects == ({"kind": "sensor_gain", **winch.effects[0]["parameters"]},)
/// True
#[pyfunction]
#[pyo3(signature = (robot, log, *, progress=None), text_signature = "(robot, log, *, progress=False)")]
pub fn discover(
    robot: &Bound<'_, Robot>,
    log: &Bound<'_, PyAny>,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<DiscoverResult> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    let runs = Runs::new(log)?;
    let given = robot.borrow().clone();
    let file = &given.file;
    log::warn(py, &file.warnings())?;
    let mut measurements = Measurements::new(&file.params(), Reference::Forces);
    let holdings = runs.read(robot, &mut measurements, &mut watch)?;
    let readiness = readiness::to_discover(file, &holdings);
    // What is missing for some cables only stands beside their verdicts.
    readiness.check()?;
    let discoveries = watch.fit(|progress| discover_cables(&measurements, progress))?;
    let logs: Vec<(String, f64)> = runs.names().into_iter().zip(measurements.log_starts_s()).collect();
    let result = result::DiscoverResult::new(file, &logs, &readiness, &discoveries);
    result.check_told()?;
    let text = extended(&given.to_toml()?, ORIGIN, &discoveries)?;
    let cables = discoveries.into_iter().zip(&result.cables);
    Ok(DiscoverResult {
        robot: Py::new(py, Robot::parse(text, ORIGIN)?)?,
        cables: cables
            .map(|(found, result)| CableDiscovery::new(py, found, result.clone()))
            .collect::<PyResult<_>>()?,
        result,
    })
}
