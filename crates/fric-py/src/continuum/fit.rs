//! `fit`: identifies a manipulator's numbers from its runs.

use std::path::PathBuf;

use fric_tendon::edit::rewrite;
use fric_tendon_lab::Run;
use fric_tendon_lab::identify::{Quantity, TendonFitOptions, identify};
use fric_work::provenance::Provenance;
use fric_work::report::continuum as report;
use fric_work::supervisor::Supervisor as _;
use pyo3::prelude::*;

use super::{Manipulator, TendonRun, check_disks};
use crate::arguments::{argument, frozen, refused};
use crate::errors::{Fault, Outcome};
use crate::log;
use crate::results;
use crate::watch::Watch;

/// Identifies stiffness, geometry, loads and friction of a manipulator from runs that each have two of: tension at the base, gratings, markers.
/// `runs` is one or several runs, each starting with a relaxed tendon.
///
/// `parameters` names what to identify: "backbone_stiffness", "segment_stiffness", "pitch", "tendon_offset", "precurvature", "marker_frame", "tip_load",
/// "gravity_direction", "mu", "hole_mu", "sigma", "base_gain", "base_offset", "tension_lag", "calibration". Parameters that the runs do not determine
/// keep the manipulator's values and cause a LogWarning.
///
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> stiffer = continuum.Manipulator.from_toml(arm.to_toml().replace("200e9", "220e9"))
/// >>> run = continuum.simulate(stiffer, greatest_tension_n=1.0).run
/// >>> result = continuum.fit(arm, run, parameters=["backbone_stiffness"])
/// >>> round(result.parameters["bending_stiffness_n_m2"] / 0.0027, 1)
/// 1.1
#[pyfunction]
#[pyo3(signature = (manipulator, runs, *, parameters=None))]
pub fn continuum_fit(
    py: Python<'_>,
    #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
    runs: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = argument)] parameters: Option<Vec<String>>,
) -> Outcome<Py<PyAny>> {
    let all: Vec<Bound<'_, TendonRun>> = match runs.cast::<TendonRun>() {
        Ok(one) => vec![one.clone()],
        Err(_) => runs.extract().map_err(|_| refused("runs", "a TendonRun or a list of them", runs))?,
    };
    if all.is_empty() {
        return Err(Fault::config("`runs` is an empty list; give at least one run"));
    }
    for (place, run) in all.iter().enumerate() {
        for (before, other) in all.iter().take(place).enumerate() {
            if other.as_any().eq(run)? {
                let (before, place) = (before + 1, place + 1);
                let text =
                    format!("runs {before} and {place} of `runs` are the same, and its samples would count twice");
                return Err(Fault::config(text + "; give each run once"));
            }
        }
    }
    let named = |names: Vec<String>| {
        Quantity::all_named(names.iter().map(String::as_str))
            .map_err(|problem| Fault::config(format!("`parameters`: {problem}")))
    };
    let options = TendonFitOptions { quantities: parameters.map(named).transpose()? };
    let measured: Vec<Run> = all.iter().map(|run| run.get().run.clone()).collect();
    let sources: Vec<String> = all.iter().map(|run| run.get().name().to_owned()).collect();
    measured.iter().try_for_each(|run| check_disks(manipulator, run))?;
    let file = &manipulator.file;
    let found = Watch::new(py, None)?
        .compute("fitting", "searches", |progress| identify(file, &measured, &sources, &options, progress))??;
    log::warn(py, &measured.iter().filter_map(Run::begin_warning).collect::<Vec<_>>())?;
    log::warn(py, &found.result.warnings())?;
    let text = rewrite(&manipulator.text, "manipulator", &found.edit)?;
    let result = &found.result;
    let files: Vec<PathBuf> = all.iter().flat_map(|run| run.get().files()).collect();
    let provenance = manipulator.provenance("fric.continuum.fit", &files);
    let page = |provenance: &Provenance| report::fit(result, provenance);
    let shown = results::shown(py, result.summary(), result, page, report::fit_table(result), &provenance)?;
    let fields = (shown, Py::new(py, Manipulator::parse(text, "manipulator")?)?);
    Ok(results::of(py, "TendonFit", fields)?.unbind())
}
