//! `Manipulator`: a manipulator file.

use std::path::PathBuf;

use fric_log::output::OutputFile;
use fric_tendon::Tendon;
use fric_tendon::file::{ManipulatorFile, ManipulatorFileError};
use fric_work::provenance::Provenance;
use fric_work::verdict::counted;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arguments::{argument, text};
use crate::arrays::fixed;
use crate::errors::Outcome;
use crate::travel::Reduced;

/// A continuum manipulator: the content of its manipulator file.
///
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> arm.name, arm.disk_count, arm.has_gratings
/// ('tendon-prototype', 8, False)
/// >>> continuum.Manipulator.from_toml(arm.to_toml().replace("mu = 0.1753", "mu = 1.5"))
/// Traceback (most recent call last):
/// ...
/// fric.ConfigError: text, line 20: `mu` of the tendon at place 1 is 1.5; allowed is 0 to 0.9
#[pyclass(module = "fric.continuum", frozen)]
pub struct Manipulator {
    pub file: ManipulatorFile,
    pub text: String,
}

impl Manipulator {
    pub fn parse(text: String, origin: &str) -> Outcome<Self> {
        Ok(Self { file: ManipulatorFile::parse(&text, origin)?, text })
    }

    /// Returns the provenance of a function's result for this manipulator and runs of these files.
    pub fn provenance(&self, function: &str, files: &[PathBuf]) -> Provenance {
        Provenance::of_call(function, files, Some((&self.file.tables().name, &self.text)))
    }
}

#[pymethods]
impl Manipulator {
    /// Reads a manipulator file.
    #[staticmethod]
    fn read(#[pyo3(from_py_with = argument)] path: PathBuf) -> Outcome<Self> {
        let text = fric_core::text_file::read(&path)
            .map_err(|source| ManipulatorFileError::Read { path: path.clone(), source })?;
        Self::parse(text, &path.display().to_string())
    }

    /// Creates a manipulator from the text of a manipulator file.
    #[staticmethod]
    fn from_toml(#[pyo3(from_py_with = text)] text: &str) -> Outcome<Self> {
        Self::parse(text.to_owned(), "text")
    }

    /// Returns the text of the file, comments included.
    fn to_toml(&self) -> &str {
        &self.text
    }

    /// Writes the manipulator file, completely or not at all; an existing file is replaced only with `force`.
    #[pyo3(signature = (path, *, force = false))]
    fn write(
        &self,
        #[pyo3(from_py_with = argument)] path: PathBuf,
        #[pyo3(from_py_with = argument)] force: bool,
    ) -> Outcome {
        let inputs: [PathBuf; 0] = [];
        Ok(OutputFile::create(&path, &inputs, force)?.finish_with(&self.text)?)
    }

    /// Name of the manipulator.
    #[getter]
    fn name(&self) -> &str {
        &self.file.tables().name
    }

    /// Number of disks without the base plate, which is also the number of segments and holes.
    #[getter]
    fn disk_count(&self) -> usize {
        self.file.params().disk_count()
    }

    /// Friction coefficient of each hole of the first tendon.
    #[getter]
    fn mu(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        fixed(py, self.file.params().mu(Tendon::Agonist).to_vec())
    }

    /// Whether the file says how shifts become tensions.
    #[getter]
    fn has_gratings(&self) -> bool {
        self.file.tables().gratings.is_some()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.text == other.get().text)
    }

    /// Pickles, and copies, the text of its file.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py, (String,)>> {
        Ok((slf.getattr("from_toml")?, (slf.get().text.clone(),)))
    }

    fn __repr__(&self) -> String {
        format!("<Manipulator {:?}: {}>", self.name(), counted(self.disk_count(), "disk"))
    }
}
