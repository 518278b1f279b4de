//! `TendonRun`: the measurements on a manipulator; `read_run`, `read_loads`.

use std::path::PathBuf;

use fric_log::table::NumberTable;
use fric_tendon_lab::gratings::Gratings;
use fric_tendon_lab::{Run, RunSample, columns, load_steps};
use fric_work::verdict::counted;
use numpy::{PyArray1, PyArray2, PyArrayDyn};
use pyo3::prelude::*;

use super::{ARRAYS, Manipulator};
use crate::arguments::{argument, frozen};
use crate::arrays::{Axis, Wanted, array, fixed, fixed_rows, numbers};
use crate::errors::Outcome;
use crate::log;
use crate::travel::Reduced;

/// The run of a manipulator, sample by sample. Groups that were not measured are None.
///
/// >>> import numpy as np
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> run = continuum.TendonRun.from_arrays(arm, time_s=np.arange(3) * 0.1, tension_base_n=[0.0, 0.5, 1.0])
/// >>> len(run), run.shift_nm is None
/// (3, True)
#[pyclass(module = "fric.continuum", frozen)]
pub struct TendonRun {
    pub run: Run,
    /// The file it was read from.
    source: Option<String>,
}

#[pymethods]
impl TendonRun {
    /// A run from arrays: `shift_nm` (N, disks), NaN if a grating is dead; `marker_m` (N, disks, 2), centres of the disks in the base frame;
    /// `shift_reference_nm` (N,) of an unloaded grating. Any array except the time may be left out.
    #[staticmethod]
    #[pyo3(signature = (manipulator, *, time_s, tension_base_n=None, shift_nm=None, shift_reference_nm=None, marker_m=None))]
    fn from_arrays(
        #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
        time_s: &Bound<'_, PyAny>,
        tension_base_n: Option<&Bound<'_, PyAny>>,
        shift_nm: Option<&Bound<'_, PyAny>>,
        shift_reference_nm: Option<&Bound<'_, PyAny>>,
        marker_m: Option<&Bound<'_, PyAny>>,
    ) -> Outcome<Self> {
        let count = manipulator.file.params().disk_count();
        let one = |name, entries| Wanted { name, shape: &[Axis::Rows], entries };
        let time_s = numbers(&one("time_s", "one time a sample"), time_s)?;
        let rows = Axis::Exactly(time_s.len());
        let column = |name: &'static str, value: Option<&Bound<'_, PyAny>>| {
            let wanted = Wanted { name, shape: &[rows], entries: "one number a sample" };
            value.map(|value| numbers(&wanted, value)).transpose()
        };
        let tension_n = column("tension_base_n", tension_base_n)?;
        let reference_nm = column("shift_reference_nm", shift_reference_nm)?;
        let shift_shape = [rows, Axis::Exactly(count)];
        let wanted = Wanted { name: "shift_nm", shape: &shift_shape, entries: "one shift for each grating" };
        let shift_nm = shift_nm.map(|value| numbers(&wanted, value)).transpose()?;
        let marker_shape = [rows, Axis::Exactly(count), Axis::Exactly(2)];
        let wanted = Wanted { name: "marker_m", shape: &marker_shape, entries: "x and y of each disk" };
        let marker_m = marker_m.map(|value| numbers(&wanted, value)).transpose()?;
        let row_of = |all: &Option<Vec<f64>>, width: usize, row: usize| -> Vec<f64> {
            all.as_ref().and_then(|all| all.get(row * width..(row + 1) * width)).unwrap_or_default().to_vec()
        };
        let of =
            |all: &Option<Vec<f64>>, row: usize| all.as_ref().and_then(|all| all.get(row)).copied().unwrap_or(f64::NAN);
        let sample = |(row, time_s): (usize, &f64)| RunSample {
            time_s: *time_s,
            tension_base_n: of(&tension_n, row),
            shift_nm: row_of(&shift_nm, count, row),
            shift_reference_nm: of(&reference_nm, row),
            marker_m: row_of(&marker_m, 2 * count, row).as_chunks().0.to_vec(),
        };
        let samples = time_s.iter().enumerate().map(sample).collect();
        Ok(Self::new(Run::new(samples, count)?))
    }

    /// Time, s, (N,).
    #[getter]
    fn time_s(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.column(py, |sample| sample.time_s)
    }

    /// Tension of the tendon at the base, N, (N,).
    #[getter]
    fn tension_base_n(&self, py: Python<'_>) -> Option<Py<PyArray1<f64>>> {
        self.run.has_tension().then(|| self.column(py, |sample| sample.tension_base_n))
    }

    /// Wavelength shift of the grating in each segment, nm, (N, disks).
    #[getter]
    fn shift_nm(&self, py: Python<'_>) -> Outcome<Option<Py<PyArray2<f64>>>> {
        let all = || self.run.samples().iter().flat_map(|sample| &sample.shift_nm).copied().collect();
        self.run.has_shifts().then(|| fixed_rows(py, all(), self.run.disk_count())).transpose()
    }

    /// Shift of the unloaded grating, nm, (N,).
    #[getter]
    fn shift_reference_nm(&self, py: Python<'_>) -> Option<Py<PyArray1<f64>>> {
        self.run.has_reference().then(|| self.column(py, |sample| sample.shift_reference_nm))
    }

    /// Centre of each disk in the base frame, m, (N, disks, 2).
    #[getter]
    fn marker_m(&self, py: Python<'_>) -> Outcome<Option<Py<PyArrayDyn<f64>>>> {
        let all = || self.run.samples().iter().flat_map(|sample| sample.marker_m.as_flattened()).copied().collect();
        let shape = [self.run.samples().len(), self.run.disk_count(), 2];
        self.run.has_markers().then(|| array(py, all(), &shape)).transpose()
    }

    fn __len__(&self) -> usize {
        self.run.samples().len()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            let other = other.get();
            self.source == other.source
                && self.run.disk_count() == other.run.disk_count()
                && bits(&self.run) == bits(&other.run)
        })
    }

    fn __repr__(&self) -> String {
        format!("<TendonRun of {}: {}>", counted(self.run.samples().len(), "sample"), self.name())
    }

    /// Pickles, and copies, its numbers.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Outcome<Reduced<'py, Pickled>> {
        let run = &slf.get().run;
        let rows = run.samples().iter().flat_map(numbers_of).collect();
        let rows = fixed_rows(slf.py(), rows, 3 + 3 * run.disk_count())?;
        Ok((slf.getattr("_unpickled")?, (rows, run.disk_count(), slf.get().source.clone())))
    }

    /// Creates the pickled run.
    #[staticmethod]
    fn _unpickled(rows: &Bound<'_, PyAny>, disk_count: usize, source: Option<String>) -> Outcome<Self> {
        let width = 3 + 3 * disk_count;
        let shape = [Axis::Rows, Axis::Exactly(width)];
        let rows = numbers(&Wanted { name: "rows", shape: &shape, entries: "the samples of a pickle" }, rows)?;
        let samples = rows.chunks_exact(width).map(|row| sample_of(row, disk_count)).collect();
        Ok(Self { run: Run::new(samples, disk_count)?, source })
    }
}

impl TendonRun {
    /// Creates a run that does not come from a file.
    pub fn new(run: Run) -> Self {
        Self { run, source: None }
    }

    /// Returns its name for people: the path it was read from.
    pub fn name(&self) -> &str {
        self.source.as_deref().unwrap_or(ARRAYS)
    }

    /// Returns the file it was read from, if there is one.
    pub fn files(&self) -> Vec<PathBuf> {
        self.source.iter().map(PathBuf::from).collect()
    }

    fn column(&self, py: Python<'_>, of: fn(&RunSample) -> f64) -> Py<PyArray1<f64>> {
        fixed(py, self.run.samples().iter().map(of).collect())
    }
}

/// Samples (one row each), the number of disks, and the file.
type Pickled = (Py<PyArray2<f64>>, usize, Option<String>);

/// Returns a sample as numbers: time, tension, shift of the unloaded grating, then shifts and markers of the disks.
fn numbers_of(sample: &RunSample) -> Vec<f64> {
    let RunSample { time_s, tension_base_n, shift_nm, shift_reference_nm, marker_m } = sample;
    let known = [*time_s, *tension_base_n, *shift_reference_nm];
    known.into_iter().chain(shift_nm.iter().copied()).chain(marker_m.as_flattened().iter().copied()).collect()
}

fn sample_of(row: &[f64], disk_count: usize) -> RunSample {
    let at = |place: usize| row.get(place).copied().unwrap_or(f64::NAN);
    let (shifts, markers) = row.split_at_checked(3 + disk_count).unwrap_or_default();
    RunSample {
        time_s: at(0),
        tension_base_n: at(1),
        shift_reference_nm: at(2),
        shift_nm: shifts.iter().skip(3).copied().collect(),
        marker_m: markers.as_chunks().0.to_vec(),
    }
}

/// Returns the bits of a run, so that NaN equals NaN.
fn bits(run: &Run) -> Vec<u64> {
    run.samples().iter().flat_map(numbers_of).map(f64::to_bits).collect()
}

/// Reads a run: CSV, or MCAP with one message per sample. Unusual content of the file causes a LogWarning.
///
/// The columns are `time_s`, `tension_base_n`, `shift_1_nm` …, `shift_reference_nm`, `marker_1_x_m`, `marker_1_y_m` …; any group except the time may
/// be missing.
#[pyfunction]
pub fn continuum_read_run(
    py: Python<'_>,
    #[pyo3(from_py_with = argument)] path: PathBuf,
    #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
) -> Outcome<TendonRun> {
    let count = manipulator.file.params().disk_count();
    let table = py.detach(|| NumberTable::read(&path, &columns::of_run(count)))?;
    log::warn(py, &table.warnings)?;
    Ok(TendonRun { run: Run::from_columns(&table.columns, count)?, source: Some(path.display().to_string()) })
}

/// Reads load steps for `calibrate`: loads, N, (N,), and shifts, nm, (N, disks). The temperature effect is removed if the file has
/// `shift_reference_nm` and the manipulator the wavelengths. The columns are `load_g` or `load_n`, `shift_1_nm` …
#[pyfunction]
#[expect(clippy::type_complexity, reason = "a pair of arrays")]
pub fn continuum_read_loads(
    py: Python<'_>,
    #[pyo3(from_py_with = argument)] path: PathBuf,
    #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
) -> Outcome<(Py<PyArray1<f64>>, Py<PyArray2<f64>>)> {
    let count = manipulator.file.params().disk_count();
    let table = py.detach(|| NumberTable::read(&path, &columns::of_calibration(count)))?;
    log::warn(py, &table.warnings)?;
    let gratings = Gratings::from_file(&manipulator.file)?;
    let steps =
        load_steps(&table.columns, manipulator.file.params(), gratings.as_ref().and_then(Gratings::wavelengths_nm))?;
    let shift_nm = steps.iter().flat_map(|step| &step.shift_nm).copied().collect();
    Ok((fixed(py, steps.iter().map(|step| step.load_n).collect()), fixed_rows(py, shift_nm, count)?))
}
