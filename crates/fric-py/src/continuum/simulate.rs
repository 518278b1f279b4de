//! `simulate`: the run of a simulated manipulator.

use fric_core::robot::unknown_name;
use fric_lab::continuum::Run;
use fric_lab::continuum::simulate::{
    Experiment, SimulatedRun, TendonSimulationOptions, TendonTruth, simulate as simulate_tendon,
};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use super::{Manipulator, TendonRun};
use crate::arrays::{fixed, fixed_rows};
use crate::errors::{Fault, Outcome};

/// Outcome of `simulate`: what was measured, and what was really there.
#[pyclass(module = "fric.continuum", frozen)]
pub struct SimulatedTendon {
    simulated: SimulatedRun,
    /// What was measured.
    #[pyo3(get)]
    run: Py<TendonRun>,
}

impl SimulatedTendon {
    fn rows(&self, py: Python<'_>, of: fn(&TendonTruth) -> &[f64]) -> Outcome<Py<PyArray2<f64>>> {
        let all = self.simulated.truth.iter().flat_map(of).copied().collect();
        fixed_rows(py, all, self.simulated.mu.len())
    }
}

#[pymethods]
impl SimulatedTendon {
    /// Loads of a calibration of the same gratings, N, (10,).
    #[getter]
    fn load_n(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        fixed(py, self.simulated.calibration.iter().map(|step| step.load_n).collect())
    }

    /// Their shifts, nm, (10, disks).
    #[getter]
    fn load_shift_nm(&self, py: Python<'_>) -> Outcome<Py<PyArray2<f64>>> {
        let all = self.simulated.calibration.iter().flat_map(|step| &step.shift_nm).copied().collect();
        fixed_rows(py, all, self.simulated.mu.len())
    }

    /// True friction coefficient of each hole.
    #[getter]
    fn mu(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        fixed(py, self.simulated.mu.clone())
    }

    /// True friction at each hole, N, (N, holes).
    #[getter]
    fn friction_n(&self, py: Python<'_>) -> Outcome<Py<PyArray2<f64>>> {
        self.rows(py, |truth| &truth.friction_n)
    }

    /// What each hole could truly hold, N, (N, holes).
    #[getter]
    fn bound_n(&self, py: Python<'_>) -> Outcome<Py<PyArray2<f64>>> {
        self.rows(py, |truth| &truth.bound_n)
    }

    /// True tension in each segment, N, (N, disks).
    #[getter]
    fn tension_n(&self, py: Python<'_>) -> Outcome<Py<PyArray2<f64>>> {
        self.rows(py, |truth| &truth.tension_n)
    }

    fn __repr__(&self) -> String {
        format!("<SimulatedTendon of {} samples>", self.simulated.samples.len())
    }
}

/// A run of a simulated manipulator whose truth is not the model: an elastica of many links, holes in which the tendon sticks and slips.
///
/// `run` is "one_way" (pulled) or "mixed" (pulled and released by turns). The same seed gives the same numbers.
///
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> tendon = continuum.simulate(arm, greatest_tension_n=1.0)
/// >>> tendon.run.marker_m.shape, bool((tendon.friction_n >= 0).all())
/// ((67, 8, 2), True)
#[pyfunction]
#[pyo3(signature = (
    manipulator, *, run="one_way", seed=0, greatest_tension_n=1.7, mu_spread_ratio=0.1, grating_noise_nm=0.0005,
    marker_noise_m=0.00025,
))]
pub fn continuum_simulate(
    py: Python<'_>,
    manipulator: &Manipulator,
    run: &str,
    seed: u64,
    greatest_tension_n: f64,
    mu_spread_ratio: f64,
    grating_noise_nm: f64,
    marker_noise_m: f64,
) -> Outcome<SimulatedTendon> {
    let known = || Experiment::ALL.into_iter();
    let experiment = known()
        .find(|experiment| experiment.name() == run)
        .ok_or_else(|| Fault::config(unknown_name("run", run, known().map(Experiment::name))))?;
    let options = TendonSimulationOptions {
        experiment,
        greatest_tension_n,
        seed,
        mu_spread_ratio,
        grating_noise_nm,
        marker_noise_m,
        ..TendonSimulationOptions::default()
    };
    let params = manipulator.file.params();
    let simulated = py.detach(|| simulate_tendon(params, &options))?;
    let run = Run::new(simulated.samples.clone(), params.disk_count())?;
    Ok(SimulatedTendon { run: Py::new(py, TendonRun { run })?, simulated })
}
