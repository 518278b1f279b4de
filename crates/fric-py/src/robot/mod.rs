//! `Robot`: an editable robot file that is always valid.

mod edit;
mod tables;
mod values;

use std::path::PathBuf;
use std::sync::Arc;

use fric_core::robot::file::{RobotFile, RobotFileError};
use fric_core::robot::unknown_name;
use fric_log::output::OutputFile;
use fric_work::verdict::counted;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

use self::edit::Step;
pub use self::tables::{Cable, Friction, LogPaths, Monitor, Platform};
use self::tables::{Keys, Place, misspelt, pairs};
use crate::arguments::{argument, text};
use crate::errors::{Fault, Outcome};

/// A cable robot: the content of its robot file.
///
/// Its attributes are the keys of the file, including units. Setting one checks the whole robot; an invalid value raises ConfigError and leaves the
/// robot unchanged.
///
/// >>> robot = Robot.read("examples/mini-ipanema.toml")
/// >>> robot.name, robot.cycle_s, len(robot.cables)
/// ('mini-ipanema', 0.001, 8)
/// >>> robot.cable("cable1").friction.mu = 0.02
/// >>> robot.cable("cable1").friction
/// Friction(mu=0.02, sigma_n_per_m=1000.0, viscous_n_s_per_m=0.17, offset_n=0.0)
/// >>> robot.cable("cable1").friction.mu = 2
/// Traceback (most recent call last):
/// ...
/// fric.ConfigError: cable "cable1": `mu` is 2; allowed is 0 to 0.9
#[pyclass(module = "fric")]
#[derive(Clone)]
pub struct Robot {
    /// The file with all edits.
    pub file: RobotFile,
    /// Its text, as long as nothing is edited.
    text: Option<Arc<str>>,
}

const KEYS: Keys = Keys { class: "Robot", all: &["name", "cycle_s", "platform", "log", "monitor"], optional: &[] };

#[pymethods]
impl Robot {
    /// Reads a robot file.
    #[staticmethod]
    fn read(#[pyo3(from_py_with = argument)] path: PathBuf) -> Outcome<Self> {
        let text =
            fric_core::text_file::read(&path).map_err(|source| RobotFileError::Read { path: path.clone(), source })?;
        Self::parse(text, &path.display().to_string())
    }

    /// Creates a robot from the text of a robot file.
    #[staticmethod]
    fn from_toml(#[pyo3(from_py_with = text)] text: &str) -> Outcome<Self> {
        Self::parse(text.to_owned(), "text")
    }

    /// Returns the robot as the text of a robot file: as it was read, comments included, unless an attribute has been set since.
    pub fn to_toml(&self) -> Outcome<String> {
        if let Some(text) = &self.text {
            return Ok(text.as_ref().to_owned());
        }
        self.file.to_toml().map_err(|error| Fault::config(format!("the robot cannot be written as TOML: {error}")))
    }

    /// Writes the robot file, completely or not at all; an existing file is replaced only with `force`.
    #[pyo3(signature = (path, *, force = false))]
    fn write(
        &self,
        #[pyo3(from_py_with = argument)] path: PathBuf,
        #[pyo3(from_py_with = argument)] force: bool,
    ) -> Outcome {
        let text = self.to_toml()?;
        // The file that it was read from may be replaced like any other.
        let inputs: [PathBuf; 0] = [];
        Ok(OutputFile::create(&path, &inputs, force)?.finish_with(&text)?)
    }

    /// Name of the robot.
    #[getter]
    fn name(&self) -> &str {
        &self.file.options().name
    }

    /// Cycle time, s.
    #[getter]
    fn cycle_s(&self) -> f64 {
        self.file.options().cycle_s
    }

    /// Names of the cables in order.
    #[getter]
    fn cable_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.file.cable_names())
    }

    /// Mass and gravity.
    #[getter]
    fn platform(slf: Bound<'_, Self>) -> Platform {
        Platform::new(Place::new(slf.unbind(), &[Step::Key("platform")]))
    }

    /// Limits beyond which a signal counts as faulty.
    #[getter]
    fn monitor(slf: Bound<'_, Self>) -> Monitor {
        Monitor::new(Place::new(slf.unbind(), &[Step::Key("monitor")]))
    }

    /// Location of the signals in a log.
    #[getter]
    fn log(slf: Bound<'_, Self>) -> LogPaths {
        LogPaths::new(Place::new(slf.unbind(), &[Step::Key("log")]))
    }

    /// The cables in order.
    #[getter]
    fn cables<'py>(slf: &Bound<'py, Self>) -> Outcome<Bound<'py, PyTuple>> {
        let count = slf.borrow().file.options().cable.len();
        Ok(PyTuple::new(slf.py(), (0..count).map(|index| cable_at(slf, index)))?)
    }

    /// Returns the cable with this name.
    fn cable(slf: &Bound<'_, Self>, #[pyo3(from_py_with = text)] name: &str) -> Outcome<Cable> {
        Ok(cable_at(slf, slf.borrow().cable_index(name)?))
    }

    /// Sets several keys at once, checked together.
    #[pyo3(signature = (**values))]
    fn set(slf: &Bound<'_, Self>, values: Option<&Bound<'_, PyDict>>) -> Outcome {
        edit_keys(slf, &pairs(values)?)
    }

    fn __setattr__(slf: &Bound<'_, Self>, name: String, value: Bound<'_, PyAny>) -> Outcome {
        KEYS.check(&name)?;
        edit_keys(slf, &[(name, value)])
    }

    fn __getattr__(slf: &Bound<'_, Self>, name: String) -> PyResult<Py<PyAny>> {
        Err(misspelt(slf.as_any(), &name))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.file == other.borrow().file)
    }

    fn __repr__(&self) -> String {
        let cables = counted(self.file.options().cable.len(), "cable");
        format!("<Robot {:?}: {cables}, cycle {} s>", self.name(), self.cycle_s())
    }

    /// The cables as a table, for notebooks.
    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("fric._html")?.call_method1("robot", (slf,))
    }

    /// Pickles, and copies, the text of its file.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Outcome<(Bound<'py, PyAny>, (String,))> {
        let class: Bound<'py, PyType> = slf.get_type();
        Ok((class.getattr("from_toml")?, (slf.borrow().to_toml()?,)))
    }
}

impl Robot {
    /// Creates the robot of a text; `origin` names its source in error messages.
    pub fn parse(text: String, origin: &str) -> Outcome<Self> {
        Ok(Self { file: RobotFile::parse(&text, origin)?, text: Some(text.into()) })
    }

    /// Creates a robot from a file and its text.
    pub fn new(file: RobotFile, text: String) -> Self {
        Self { file, text: Some(text.into()) }
    }

    /// Replaces the file by another one.
    fn edit(&mut self, file: RobotFile) {
        *self = Self { file, text: None };
    }

    /// Returns the index of the cable with this name.
    pub fn cable_index(&self, name: &str) -> Outcome<usize> {
        let names = self.file.cable_names();
        let place = names.iter().position(|other| *other == name);
        place.ok_or_else(|| Fault::config(unknown_name("cable", name, names.into_iter())))
    }
}

/// Returns the cables by their names, for people.
pub fn cables_in_words(names: &[impl AsRef<str>]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    format!("{} {}", if names.len() == 1 { "cable" } else { "cables" }, names.join(", "))
}

fn edit_keys(robot: &Bound<'_, Robot>, given: &[(String, Bound<'_, PyAny>)]) -> Outcome {
    // Reading the values may run Python code that accesses the robot.
    let given = KEYS.read(given, "")?;
    let file = edit::with(&robot.borrow().file, &[], given)?;
    robot.borrow_mut().edit(file);
    Ok(())
}

fn cable_at(robot: &Bound<'_, Robot>, index: usize) -> Cable {
    Cable::new(Place::new(robot.clone().unbind(), &[Step::Key("cable"), Step::Index(index)]))
}
