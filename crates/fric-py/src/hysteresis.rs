//! `hysteresis`: what is left of the wrench's hysteresis.

use fric_lab::hysteresis::{AxisResult, Hysteresis, HysteresisResult as LabResult, Survey, WidthResult};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::errors::Outcome;
use crate::log::{self, Log};
use crate::robot::Robot;
use crate::watch::Watch;

/// Width of a hysteresis.
#[pyclass(module = "fric", frozen)]
pub struct Width {
    /// Difference of the means in either direction.
    #[pyo3(get)]
    width: f64,
    /// Its standard error; None with a single pass in a direction.
    #[pyo3(get)]
    standard_error: Option<f64>,
}

/// The hysteresis along, or about, one axis.
#[pyclass(module = "fric", frozen)]
pub struct AxisHysteresis(AxisResult);

/// Outcome of `hysteresis`. `print(result.summary())` shows all of it.
#[pyclass(module = "fric", frozen)]
pub struct HysteresisResult {
    result: LabResult,
    axes: Vec<Py<AxisHysteresis>>,
}

impl Width {
    fn new(width: &WidthResult) -> Self {
        Self { width: width.width, standard_error: width.standard_error }
    }
}

#[pymethods]
impl Width {
    fn __repr__(&self) -> String {
        let error = self.standard_error.map_or_else(|| "None".to_owned(), |error| format!("{error:?}"));
        format!("Width(width={:?}, standard_error={error})", self.width)
    }
}

#[pymethods]
impl AxisHysteresis {
    /// "x", "y", "z" along the axes of the base, "a", "b", "c" about them.
    #[getter]
    fn axis(&self) -> &str {
        self.0.axis
    }

    /// Unit of the widths.
    #[getter]
    fn unit(&self) -> &str {
        self.0.unit
    }

    /// Passes in both directions together; 0 for an axis that is not crossed.
    #[getter]
    fn passes(&self) -> u64 {
        self.0.passes
    }

    /// From forces without compensation; None for an axis that is not crossed.
    #[getter]
    fn without(&self) -> Option<Width> {
        self.0.without.as_ref().map(Width::new)
    }

    /// From compensated forces; None for an axis that is not crossed.
    #[getter]
    fn compensated(&self) -> Option<Width> {
        self.0.with.as_ref().map(Width::new)
    }

    /// Width with compensation per width without; None where the latter is none but scatter.
    #[getter]
    fn lasting_ratio(&self) -> Option<f64> {
        self.0.lasting_ratio
    }

    /// Whether the log's own outside wrench was taken off.
    #[getter]
    fn applied_subtracted(&self) -> Option<bool> {
        self.0.applied_subtracted
    }

    fn __repr__(&self) -> String {
        format!("<AxisHysteresis {}: {} passes>", self.0.axis, self.0.passes)
    }
}

result_methods!(HysteresisResult, "hysteresis");

#[pymethods]
impl HysteresisResult {
    /// The axes x, y, z, a, b, c.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.axes)
    }

    /// The position that is crossed, base frame, m.
    #[getter]
    fn position_m(&self) -> (f64, f64, f64) {
        self.result.position_m.into()
    }

    fn __repr__(&self) -> String {
        let crossed: Vec<&str> = self.result.axes.iter().filter(|axis| axis.passes > 0).map(|axis| axis.axis).collect();
        format!("<HysteresisResult of {:?}: axes {}>", self.result.robot, crossed.join(", "))
    }
}

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
    robot: &Bound<'_, Robot>,
    log: &Bound<'_, PyAny>,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<HysteresisResult> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    watch.part(0, 3);
    let log = match log.cast::<Log>() {
        Ok(log) => log.clone(),
        Err(_) => Bound::new(py, log::read(py, log, Some(robot), None, &mut watch)?)?,
    };
    let (log, file) = (log.get(), robot.borrow().file.clone());
    log.check_cables(&file.cable_names())?;
    let mut survey = Survey::new(&file)?;
    let mut cables = Vec::new();
    watch.part(1, 3);
    log.with_rows(py, |rows| {
        watch.work(rows.len(), |range| {
            for row in range {
                let Some(sample) = rows.sample(row, &mut cables) else { break };
                survey.add(&sample);
            }
            Ok(())
        })
    })?;
    let crossed = survey.finish()?;
    let mut hysteresis = Hysteresis::new(&file, &crossed)?;
    watch.part(2, 3);
    log.with_rows(py, |rows| {
        watch.work(rows.len(), |range| {
            for row in range {
                let Some(sample) = rows.sample(row, &mut cables) else { break };
                hysteresis.step(&sample);
            }
            Ok(())
        })
    })?;
    log::warn(py, &file.warnings())?;
    log::warn(py, &hysteresis.replay().cable_warnings(&file))?;
    let result = LabResult::new(&file, &crossed, &hysteresis.axes()?);
    let axes = result.axes.iter().map(|axis| Py::new(py, AxisHysteresis(axis.clone()))).collect::<PyResult<_>>()?;
    Ok(HysteresisResult { result, axes })
}
