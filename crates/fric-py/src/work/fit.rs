//! `fit`: identifies the parameters of the friction model from logs.

use fric_lab::fit::{CableFit, FitOptions, Reference, Weighing};
use fric_work::provenance::Provenance;
use fric_work::{fit::run, fit_report, report};
use pyo3::prelude::*;

use crate::arguments::{argument, object, text};
use crate::arrays::{array, fixed};
use crate::errors::{Fault, Outcome};
use crate::results;
use crate::robot::Robot;
use crate::watch::Watch;
use crate::work::runs::{Runs, named_parameters, named_zero};

/// The origin of the robot in messages.
pub const ORIGIN: &str = "the robot";

/// Returns the reference of a name.
pub fn named_reference(name: &str) -> Outcome<Reference> {
    Reference::ALL.into_iter().find(|known| known.name() == name).ok_or_else(|| {
        let names = Reference::ALL.into_iter().map(Reference::name);
        Fault::config(fric_core::robot::unknown_name("reference", name, names))
    })
}

/// Identifies the friction of a robot's cables from logs: `fric-cli fit`.
///
/// `log` is a Log, a path, or a list of them, each a run of its own. `reference` is what the model is compared with: the cable forces measured at the
/// platform, or the wrench on the platform (measured, else that of its mass), for all cables at once. `parameters` names those to vary, such as "mu"
/// or "stribeck.ratio"; by default the friction and each effect of the cable. `per_log` names the zero of which each of several logs has its own value,
/// because sensors are tared anew: "offset_n" at the platform or "sensor_offset.offset_n" at the sensor; the robot gets that of the last log. `huber` weights large deviations linearly. Data that allow no fit raise
/// FitError.
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
    signature = (robot, log, *, reference="forces", parameters=None, per_log=None, huber=false, progress=None),
    text_signature = "(robot, log, *, reference=\"forces\", parameters=None, per_log=None, huber=False, progress=False)"
)]
pub fn fit(
    #[pyo3(from_py_with = object)] robot: &Bound<'_, Robot>,
    log: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = text)] reference: &str,
    #[pyo3(from_py_with = argument)] parameters: Option<Vec<String>>,
    #[pyo3(from_py_with = argument)] per_log: Option<Vec<String>>,
    #[pyo3(from_py_with = argument)] huber: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<Py<PyAny>> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    let reference = named_reference(reference)?;
    let options = FitOptions {
        parameters: parameters.as_deref().map(named_parameters).transpose()?,
        weighing: if huber { Weighing::Huber } else { Weighing::LeastSquares },
    };
    let runs = Runs::new(log)?;
    let zero = named_zero(per_log.as_deref(), &runs, reference)?;
    let given = robot.borrow().clone();
    let file = &given.file;
    let read = runs.read(robot, file, reference, zero, &mut watch)?;
    let mut residuals_n = Vec::new();
    let fitted = run(&read, &options, Some(&mut residuals_n), &mut watch)?;
    let (result, fits) = (&fitted.result, fitted.fits.cables());
    let text = fitted.rewritten(&given.to_toml()?, ORIGIN)?;
    let cable = |(fit, residuals_n): (&CableFit, Vec<f64>)| {
        let count = fit.fitted.len();
        // Matrices are stored by columns, arrays by rows.
        let [covariance, correlation] = [fit.covariance.transpose(), fit.correlation().transpose()]
            .map(|matrix| array(py, matrix.as_slice().to_vec(), &[count, count]));
        let names: Vec<String> = fit.fitted.iter().map(ToString::to_string).collect();
        Ok((names, covariance?, correlation?, fixed(py, residuals_n)))
    };
    let cables = fits.iter().zip(residuals_n).map(cable).collect::<Outcome<Vec<_>>>()?;
    let provenance = Provenance::of_call("fric.fit", &runs.files(), Some((&result.robot, &given.to_toml()?)));
    let page = |provenance: &Provenance| report::fit::page(result, fits, provenance);
    let shown = results::shown(py, fit_report::summary(result), result, page, report::fit::table(result), &provenance)?;
    let fields = (shown, fit_report::fit_report(result, fits), Py::new(py, Robot::parse(text, ORIGIN)?)?, cables);
    Ok(results::of(py, "FitResult", fields)?.unbind())
}
