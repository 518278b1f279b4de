//! `discover`: what a manipulator file lacks.

use fric_tendon::edit::rewrite;
use fric_tendon_lab::discover::discover;
use fric_work::provenance::{Provenance, shown_path};
use fric_work::report::continuum as report;
use fric_work::supervisor::Supervisor as _;
use pyo3::prelude::*;

use super::{ARRAYS, Manipulator, TendonRun, check_disks, flat};
use crate::arguments::frozen;
use crate::arrays::{fixed, fixed_rows};
use crate::errors::Outcome;
use crate::log;
use crate::results;
use crate::watch::Watch;

/// Finds what the file of a manipulator lacks, from a run with the tension at the base and gratings: friction at the holes, their memory, a drifting
/// grating, a hole with its own μ. With markers, it also finds wrong values of bending, loads and measurement.
#[pyfunction]
pub fn continuum_discover(
    py: Python<'_>,
    #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
    #[pyo3(from_py_with = frozen)] run: &TendonRun,
) -> Outcome<Py<PyAny>> {
    check_disks(manipulator, &run.run)?;
    let (file, files, run) = (&manipulator.file, run.files(), &run.run);
    let source = files.first().map_or_else(|| ARRAYS.to_owned(), |path| shown_path(path));
    let found =
        Watch::new(py, None)?.compute("searching", "searches", |progress| discover(file, run, &source, progress))??;
    let noise = found.base_noise.map(|noise| noise.warning());
    log::warn(py, &run.begin_warning().into_iter().chain(noise).collect::<Vec<_>>())?;
    let text = rewrite(&manipulator.text, "manipulator", &found.edit)?;
    let disks = file.params().disk_count();
    let provenance = manipulator.provenance("fric.continuum.discover", &files);
    let page = |provenance: &Provenance| report::discovery(&found, provenance);
    let table = report::discovery_table(&found.result);
    let shown = results::shown(py, found.result.summary(), &found.result, page, table, &provenance)?;
    let fields = (
        shown,
        Py::new(py, Manipulator::parse(text, "manipulator")?)?,
        fixed(py, found.time_s),
        fixed_rows(py, flat(&found.residual_before_n), disks)?,
        fixed_rows(py, flat(&found.residual_after_n), disks)?,
    );
    Ok(results::of(py, "TendonDiscovery", fields)?.unbind())
}
