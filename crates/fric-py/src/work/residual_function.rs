//! `residual_function`: the fit's problem, for other optimisers.

use fric_lab::fit::readiness;
use fric_lab::fit::{self, FitOptions, KeptFunction, Reference};
use fric_work::supervisor::Supervisor as _;
use fric_work::verdict::counted;
use numpy::{PyArray1, PyArray2, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arguments::{argument, object, text};
use crate::arrays::{Axis, Wanted, array, fixed, fixed_rows, numbers};
use crate::errors::{Fault, Outcome};
use crate::robot::Robot;
use crate::travel::{self, Reduced};
use crate::watch::Watch;
use crate::work::runs::{Runs, named_parameters};

/// Compensated force minus reference, N, of a cable's usable samples, as a function of its parameters.
///
/// It can be passed to `scipy.optimize.least_squares(f, f.x0, jac=f.jac, bounds=f.bounds, x_scale="jac")` and `lmfit.minimize(f,
/// f.lmfit_parameters(), method="least_squares", jac=f.jac, x_scale="jac")`. It owns its samples. The length of the warm-up at the start of the log
/// is estimated with `x0`; if `fit` estimates it again with the fitted values, it uses other samples.
#[pyclass(module = "fric", frozen)]
pub struct ResidualFunction {
    function: fit::ResidualFunction,
    /// The given robot, and its cable.
    robot: Robot,
    cable: String,
}

#[pymethods]
impl ResidualFunction {
    /// The free parameters, in the order of `x`.
    #[getter]
    fn names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.names_of())
    }

    /// Start values from the data.
    #[getter]
    fn x0(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        fixed(py, self.function.start())
    }

    /// Least and greatest values, as two arrays.
    #[getter]
    fn bounds(&self, py: Python<'_>) -> (Py<PyArray1<f64>>, Py<PyArray1<f64>>) {
        let (least, greatest) = self.function.bounds().into_iter().unzip();
        (fixed(py, least), fixed(py, greatest))
    }

    /// Row of each residual in the concatenated logs.
    #[getter]
    fn rows(&self, py: Python<'_>) -> Py<PyArray1<i64>> {
        #[expect(clippy::cast_possible_wrap, reason = "a row of a log in memory")]
        let rows = self.function.samples().map(|row| row as i64).collect();
        fixed(py, rows)
    }

    /// The parameters for lmfit, with names that are identifiers (`stribeck_ratio`); needs lmfit.
    fn lmfit_parameters<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("fric._lmfit")?.call_method1("parameters", (slf,))
    }

    /// The residuals, N, at `x`: an array in the order of `names`, or parameters of lmfit.
    fn __call__(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> Outcome<Py<PyArrayDyn<f64>>> {
        let x = self.values(x)?;
        let residuals = py.detach(|| self.function.residuals(&x));
        let count = residuals.len();
        array(py, residuals, &[count])
    }

    /// The derivatives of the residuals, N per unit: one row per residual, one column per parameter.
    fn jac(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> Outcome<Py<PyArrayDyn<f64>>> {
        let x = self.values(x)?;
        let rows = py.detach(|| self.function.jacobian(&x));
        array(py, rows, &[self.function.count(), x.len()])
    }

    fn __len__(&self) -> usize {
        self.function.count()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let kept = |one: &Self| {
            let KeptFunction { free, start, rows, log_starts, cycle_s, interval_s, reference_is_known } =
                one.function.kept();
            // Compares bits, so that NaN equals NaN.
            let bits: Vec<u64> = rows.as_flattened().iter().chain(&start).map(|number| number.to_bits()).collect();
            (free, bits, log_starts, cycle_s.to_bits(), interval_s.to_bits(), reference_is_known)
        };
        other.cast::<Self>().is_ok_and(|other| {
            let other = other.get();
            self.robot.file == other.robot.file && self.cable == other.cable && kept(self) == kept(other)
        })
    }

    fn __repr__(&self) -> String {
        let (names, residuals) = (self.names_of().join(", "), counted(self.function.count(), "residual"));
        format!("<ResidualFunction of {:?}: {names}; {residuals}>", self.cable)
    }

    /// Pickles, and copies, its samples.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Outcome<Reduced<'py, Pickled>> {
        let (py, one) = (slf.py(), slf.get());
        let kept = one.function.kept();
        let context = (kept.log_starts, kept.cycle_s, kept.interval_s, kept.reference_is_known);
        let rows = fixed_rows(py, kept.rows.into_flattened(), KeptFunction::WIDTH)?;
        let state = (
            travel::VERSION.to_owned(),
            one.robot.clone(),
            one.cable.clone(),
            one.names_of(),
            kept.start,
            context,
            rows,
        );
        Ok((slf.getattr("_unpickled")?, state))
    }

    /// Creates the pickled function.
    #[staticmethod]
    fn _unpickled(
        version: &str,
        robot: &Robot,
        cable: String,
        names: Vec<String>,
        start: Vec<f64>,
        context: Context,
        rows: &Bound<'_, PyAny>,
    ) -> Outcome<Self> {
        travel::check_version(version)?;
        let shape = [Axis::Rows, Axis::Exactly(KeptFunction::WIDTH)];
        let rows = numbers(&Wanted { name: "rows", shape: &shape, entries: "the samples of a pickle" }, rows)?;
        let (log_starts, cycle_s, interval_s, reference_is_known) = context;
        let free = named_parameters(&names)?;
        let rows = rows.as_chunks().0.to_vec();
        let kept = KeptFunction { free, start, rows, log_starts, cycle_s, interval_s, reference_is_known };
        let place = robot.cable_index(&cable)?;
        let params = robot.file.params();
        let function = params.cables().get(place).and_then(|params| fit::ResidualFunction::from_kept(params, kept));
        let function = function.ok_or_else(|| Fault::config("the pickle of a ResidualFunction is damaged"))?;
        Ok(Self { function, robot: robot.clone(), cable })
    }
}

/// The starts of the logs, cycle time, time between rows, and whether the reference is known rather than read.
type Context = (Vec<usize>, f64, f64, bool);

/// Version, robot, cable, names of the parameters, start, context and rows.
type Pickled = (String, Robot, String, Vec<String>, Vec<f64>, Context, Py<PyArray2<f64>>);

impl ResidualFunction {
    fn names_of(&self) -> Vec<String> {
        self.function.parameters().iter().map(ToString::to_string).collect()
    }

    fn values(&self, x: &Bound<'_, PyAny>) -> Outcome<Vec<f64>> {
        let names = self.names_of();
        let Ok(values) = x.getattr("valuesdict") else {
            let entries = format!("one number per parameter: {}", names.join(", "));
            let shape = [Axis::Exactly(names.len())];
            return numbers(&Wanted { name: "x", shape: &shape, entries: &entries }, x);
        };
        let values = values.call0()?;
        let values = values.cast::<PyDict>()?;
        let value = |name: &String| {
            let identifier = name.replace('.', "_");
            let value = values.get_item(&identifier)?;
            value
                .ok_or_else(|| Fault::config(format!("the parameters have no `{identifier}`")))?
                .extract()
                .map_err(Fault::from)
        };
        names.iter().map(value).collect()
    }
}

/// The residuals of a cable, for other optimisers; `log` and `parameters` are as in `fit`.
///
/// >>> robot = Robot.read("examples/mini-ipanema.toml")
/// >>> f = residual_function(robot, simulate(robot, duration_s=4.0), "cable1")
/// >>> f.names
/// ('mu', 'sigma_n_per_m', 'viscous_n_s_per_m', 'offset_n')
/// >>> f(f.x0).shape == (len(f),), f.jac(f.x0).shape == (len(f), 4)
/// (True, True)
#[pyfunction]
#[pyo3(
    signature = (robot, log, cable, *, parameters=None, progress=None),
    text_signature = "(robot, log, cable, *, parameters=None, progress=False)"
)]
pub fn residual_function(
    #[pyo3(from_py_with = object)] robot: &Bound<'_, Robot>,
    log: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = text)] cable: &str,
    #[pyo3(from_py_with = argument)] parameters: Option<Vec<String>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<ResidualFunction> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    let options =
        FitOptions { parameters: parameters.as_deref().map(named_parameters).transpose()?, ..FitOptions::default() };
    let runs = Runs::new(log)?;
    let place = robot.borrow().cable_index(cable)?;
    let file = robot.borrow().file.clone();
    let read = runs.read(robot, &file, Reference::Forces, None, &mut watch)?;
    let readiness = readiness::by_forces(&file, &read.holdings);
    readiness.lack_of(place).map_or(Ok(()), |lack| Err(lack.error()))?;
    let measurements = read.samples.load(place..place + 1)?;
    let function = watch.compute("preparing", "cables", |_| {
        measurements.cable(place).map(|record| fit::ResidualFunction::new(&record, &options))
    })?;
    let function = function.filter(|function| function.count() > 0);
    let nothing = || Fault::fit(format!("no sample of {cable} can be used; `fit` says why"));
    let given = robot.borrow().clone();
    Ok(ResidualFunction { function: function.ok_or_else(nothing)?, robot: given, cable: cable.to_owned() })
}
