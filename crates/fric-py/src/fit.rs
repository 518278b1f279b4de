//! `fit`: the parameters of the friction model from logs.

use fric_lab::fit::readiness;
use fric_lab::fit::result::{self, FitCableResult, Fits, Numbers};
use fric_lab::fit::{
    self as lab, FitOptions, Measurements, Reference, Weighing, fit_cables, fit_wrench, residuals_n, rewritten,
};
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{array, fixed};
use crate::errors::{Fault, Outcome};
use crate::log;
use crate::replay::{ForceError, WrenchError};
use crate::results;
use crate::robot::Robot;
use crate::runs::{Runs, named_parameters};
use crate::watch::Watch;

/// Where the robot is from, in what is said about it.
pub const ORIGIN: &str = "the robot";

/// What a fit found for a cable.
#[pyclass(module = "fric", frozen)]
pub struct CableFit {
    fit: lab::CableFit,
    result: FitCableResult,
    /// Covariance of the fitted parameters in their units, in the order of `parameters`.
    #[pyo3(get)]
    covariance: Py<PyArrayDyn<f64>>,
    /// Compensated force less reference with these values, N, for every row of the logs one after the other; NaN where
    /// there is no reference, as everywhere in a fit to the wrench.
    #[pyo3(get)]
    residuals_n: Py<PyArray1<f64>>,
}

/// Outcome of a fit. `print(result.summary())` shows all of it.
#[pyclass(module = "fric", frozen)]
pub struct FitResult {
    result: result::FitResult,
    /// The robot with the fitted values; all else, comments included, is as in the robot given.
    #[pyo3(get)]
    robot: Py<Robot>,
    cables: Vec<Py<CableFit>>,
    wrench: Option<(Py<WrenchError>, Py<WrenchError>)>,
    held_out: Option<Py<WrenchError>>,
}

#[pymethods]
impl CableFit {
    /// Name of the cable.
    #[getter]
    fn name(&self) -> &str {
        &self.result.name
    }

    /// Samples that were learned from.
    #[getter]
    fn samples(&self) -> usize {
        self.result.samples
    }

    /// Samples that were not learned from, by the reason.
    #[getter]
    fn left_out<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.left_out)
    }

    /// Why the search has ended: "converged", or why not.
    #[getter]
    fn termination(&self) -> &str {
        self.result.termination
    }

    /// How often the model was evaluated with its derivatives.
    #[getter]
    fn evaluations(&self) -> usize {
        self.result.evaluations
    }

    /// Values by the robot file's keys, fitted or kept.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dict(py, &self.result.parameters)
    }

    /// Standard errors of the fitted values.
    #[getter]
    fn standard_errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dict(py, &self.result.standard_errors)
    }

    /// What the samples do not determine: these values are kept as they were.
    #[getter]
    fn undetermined(&self) -> Vec<String> {
        self.result.undetermined.clone()
    }

    /// Combinations that the samples leave open, a list of parts each: `cable`, `parameter` and the `step` by which it changes
    /// with the others; the first part is what is kept of this cable.
    #[getter]
    fn open<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
        results::plain(py, &self.result.open)
    }

    /// What is at an end of its range, where the samples would have it beyond.
    #[getter]
    fn at_bound(&self) -> Vec<String> {
        self.result.at_bound.clone()
    }

    /// What was fitted, in the order of `covariance`.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.fit.fitted.iter().map(ToString::to_string))
    }

    /// Error of the sensor force turned into tension as if nothing rubbed; None without a reference.
    #[getter]
    fn before(&self) -> Option<ForceError> {
        ForceError::new(&self.fit.errors.before_n)
    }

    /// Error of the force compensated with these values; None without a reference.
    #[getter]
    fn after(&self) -> Option<ForceError> {
        ForceError::new(&self.fit.errors.after_n)
    }

    fn __repr__(&self) -> String {
        let FitCableResult { name, samples, termination, .. } = &self.result;
        format!("<CableFit {name:?}: {} values from {samples} samples, {termination}>", self.fit.fitted.len())
    }
}

result_methods!(FitResult, "fit");

#[pymethods]
impl FitResult {
    /// What was compared with: "forces", "wrench", or "mass" where the wrench is that of the platform's mass.
    #[getter]
    fn reference(&self) -> &str {
        self.result.reference
    }

    /// What was found for each cable, in the robot's order.
    #[getter]
    fn cables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.cables)
    }

    /// What was found for the cable of a name.
    fn cable(&self, py: Python<'_>, name: &str) -> Outcome<Py<CableFit>> {
        of_cable(py, &self.robot, &self.cables, name)
    }

    /// Error of the wrench before and after; None in a fit to forces.
    #[getter]
    fn wrench(&self, py: Python<'_>) -> Option<(Py<WrenchError>, Py<WrenchError>)> {
        self.wrench.as_ref().map(|(before, after)| (before.clone_ref(py), after.clone_ref(py)))
    }

    /// Error of the wrench on blocks of the log held out, with parameters from the other blocks; None in a fit to forces.
    #[getter]
    fn held_out(&self, py: Python<'_>) -> Option<Py<WrenchError>> {
        self.held_out.as_ref().map(|error| error.clone_ref(py))
    }

    fn __repr__(&self) -> String {
        let result::FitResult { robot, reference, cables, .. } = &self.result;
        format!("<FitResult of {robot:?}: {} cables, by {reference}>", cables.len())
    }
}

/// What was found for the cable of a name.
pub fn of_cable<T>(py: Python<'_>, robot: &Py<Robot>, cables: &[Py<T>], name: &str) -> Outcome<Py<T>> {
    let place = robot.borrow(py).cable_index(name)?;
    let cable = cables.get(place).map(|cable| cable.clone_ref(py));
    cable.ok_or_else(|| Fault::config(format!("there is no result for cable `{name}`")))
}

/// Numbers by name.
pub fn dict<'py>(py: Python<'py>, numbers: &Numbers) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in &numbers.0 {
        dict.set_item(name, value)?;
    }
    Ok(dict)
}

/// Identifies the friction of a robot's cables from logs: `fric-cli fit`.
///
/// `log` is a Log, a path, or a list of them, each a run of its own. `reference` is what the model is compared with: the
/// cable forces measured at the platform, or the wrench on the platform (measured, else that of its mass), for all cables
/// at once. `parameters` are varied, such as "mu" or "stribeck.ratio"; without, it is the friction and each effect that
/// the cable has. `huber` weighs deviations that are far out linearly. Data that allow no fit raise FitError.
///
/// >>> robot = Robot.read("examples/mini-ipanema.toml")
/// >>> robot.cable("cable1").friction.mu = 0.03
/// >>> result = fit(robot, simulate(robot, duration_s=20.0))
/// >>> cable = result.cable("cable1")
/// >>> abs(cable.values["mu"] - 0.03) < 5 * cable.standard_errors["mu"]
/// True
/// >>> result.robot.cable("cable1").friction.mu == cable.values["mu"]
/// True
#[pyfunction]
#[pyo3(
    signature = (robot, log, *, reference="forces", parameters=None, huber=false, progress=None),
    text_signature = "(robot, log, *, reference=\"forces\", parameters=None, huber=False, progress=False)"
)]
pub fn fit(
    robot: &Bound<'_, Robot>,
    log: &Bound<'_, PyAny>,
    reference: &str,
    parameters: Option<Vec<String>>,
    huber: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<FitResult> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    let mut known = Reference::ALL.into_iter();
    let reference = known.find(|known| known.name() == reference).ok_or_else(|| {
        let names = Reference::ALL.into_iter().map(Reference::name);
        Fault::config(fric_core::robot::unknown_name("reference", reference, names))
    })?;
    let options = FitOptions {
        parameters: parameters.as_deref().map(named_parameters).transpose()?,
        weighing: if huber { Weighing::Huber } else { Weighing::LeastSquares },
    };
    let runs = Runs::new(log)?;
    let given = robot.borrow().clone();
    let file = &given.file;
    log::warn(py, &file.warnings())?;
    let lack = readiness::geometry(file, ORIGIN).filter(|_| reference == Reference::Wrench);
    lack.map_or(Ok(()), |lack| Err(lack.error()))?;
    let mut measurements = Measurements::new(&file.params(), reference);
    let holdings = runs.read(robot, &mut measurements, &mut watch)?;
    let readiness = match reference {
        Reference::Forces => readiness::by_forces(file, &holdings),
        Reference::Wrench => readiness::by_wrench(file, ORIGIN, &holdings),
    };
    log::warn(py, &readiness.check()?)?;
    let fits = watch.fit(|progress| match reference {
        Reference::Forces => Ok(Fits::Forces(fit_cables(&measurements, &options, progress))),
        Reference::Wrench => fit_wrench(&measurements, &options, progress).map(Fits::Wrench),
    })??;
    let result = result::FitResult::new(file, &fits);
    result.check_used()?;
    log::warn(py, &result.warnings(&fits, &readiness))?;
    let residuals_n = py.detach(|| residuals_n(&measurements, fits.cables()));
    let held_out = result.wrench.and_then(|wrench| wrench.held_out);
    let text = rewritten(&given.to_toml()?, ORIGIN, fits.cables())?;
    let cables = fits.cables().iter().zip(&result.cables).zip(residuals_n);
    let cable = |((fit, result), residuals_n): ((&lab::CableFit, &FitCableResult), Vec<f64>)| {
        let count = fit.fitted.len();
        let covariance = array(py, fit.covariance.transpose().as_slice().to_vec(), &[count, count])?;
        let residuals_n = fixed(py, residuals_n);
        Ok(Py::new(py, CableFit { fit: fit.clone(), result: result.clone(), covariance, residuals_n })?)
    };
    Ok(FitResult {
        robot: Py::new(py, Robot::parse(text, ORIGIN)?)?,
        cables: cables.map(cable).collect::<Outcome<_>>()?,
        wrench: result.wrench.as_ref().map(|wrench| WrenchError::pair(py, wrench)).transpose()?,
        held_out: held_out.map(|error| Py::new(py, WrenchError::from(error))).transpose()?,
        result,
    })
}
