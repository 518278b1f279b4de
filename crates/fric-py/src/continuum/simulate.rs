//! `simulate`: the run of a simulated manipulator.

use fric_core::robot::unknown_name;
use fric_tendon_lab::simulate::{Experiment, TendonSimulationOptions, TendonTruth, simulate as simulate_tendon};
use fric_tendon_lab::{Run, as_measured};
use pyo3::prelude::*;

use super::{Manipulator, TendonRun};
use crate::arguments::{argument, frozen, text};
use crate::arrays::{fixed, fixed_rows};
use crate::errors::{Fault, Outcome};
use crate::results;

/// A run of a simulated manipulator whose true physics differ from the model: an elastica of many links, with holes in which the tendon sticks and
/// slips.
///
/// `run` is "one_way" (pulled) or "mixed" (alternately pulled and released). Equal seeds give equal numbers.
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
    #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
    #[pyo3(from_py_with = text)] run: &str,
    #[pyo3(from_py_with = argument)] seed: u64,
    #[pyo3(from_py_with = argument)] greatest_tension_n: f64,
    #[pyo3(from_py_with = argument)] mu_spread_ratio: f64,
    #[pyo3(from_py_with = argument)] grating_noise_nm: f64,
    #[pyo3(from_py_with = argument)] marker_noise_m: f64,
) -> Outcome<Py<PyAny>> {
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
    let mut simulated = py.detach(|| simulate_tendon(params, &options))?;
    simulated.samples = as_measured(&simulated.samples, &manipulator.file);
    let disks = simulated.mu.len();
    let truths =
        |of: fn(&TendonTruth) -> &[f64]| fixed_rows(py, simulated.truth.iter().flat_map(of).copied().collect(), disks);
    let shifts = simulated.calibration.iter().flat_map(|step| &step.shift_nm).copied().collect();
    let fields = (
        Py::new(py, TendonRun::new(Run::new(simulated.samples.clone(), params.disk_count())?))?,
        fixed(py, simulated.calibration.iter().map(|step| step.load_n).collect()),
        fixed_rows(py, shifts, disks)?,
        fixed(py, simulated.mu.clone()),
        truths(|truth| &truth.friction_n)?,
        truths(|truth| &truth.bound_n)?,
        truths(|truth| &truth.tension_n)?,
    );
    Ok(results::new(py, "SimulatedTendon", fields)?.unbind())
}
