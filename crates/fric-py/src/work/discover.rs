//! `discover`: finds what a model lacks, from logs.

use fric_lab::discover::result::{DiscoverCableResult, WhereResult};
use fric_lab::discover::{CableDiscovery, DiscoverOptions};
use fric_work::discover::run;
use fric_work::provenance::Provenance;
use fric_work::report::discovery;
use pyo3::prelude::*;

use crate::arguments::{argument, object, text};
use crate::arrays::fixed;
use crate::errors::Outcome;
use crate::results;
use crate::robot::Robot;
use crate::watch::Watch;
use crate::work::fit::{ORIGIN, named_reference};
use crate::work::runs::{Runs, named_zero};

/// Finds where the model and logs disagree, and the missing effect: `fric-cli discover`.
///
/// `log` is a Log, a path, or a list of them, each a run of its own. `reference` is what the model is compared with: the cable forces measured at the
/// platform, or the wrench on the platform (measured, else that of its mass), for all cables at once. Half of the log, in blocks, judges what was
/// learned from the other half. A cable with too little information in the log says so in its verdict; a log without information about any cable
/// raises FitError.
///
/// `per_log` names the zero of which each of several logs has its own value, because sensors are tared anew: "offset_n" at the platform or
/// "sensor_offset.offset_n" at the sensor. Held-out samples are judged with the value that the other samples of their log determine; the robot gets
/// that of the last log.
///
/// A rest without a name that depends on the speed, the length or the load of the cable becomes a table, the effect `empirical`, reported as unnamed;
/// `empirical=False` turns this off.
///
/// >>> robot = Robot.from_toml('''
/// ... format = "fric-robot/1"
/// ... name = "bench"
/// ... cycle_s = 0.004
/// ... [[cable]]
/// ... name = "winch"
/// ... pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]
/// ... friction = { mu = 0.02, sigma_n_per_m = 900.0, viscous_n_s_per_m = 0.3 }
/// ... ''')
/// >>> log = simulate(robot, duration_s=20.0, effects=["sensor_gain:gain=1.05"])
/// >>> result = discover(robot, log)
/// >>> winch = result.cable("winch")
/// >>> winch.verdict, [effect["kind"] for effect in winch.effects]
/// ('extended', ['sensor_gain'])
/// >>> result.robot.cable("winch").effects == ({"kind": "sensor_gain", **winch.effects[0]["parameters"]},)
/// True
#[pyfunction]
#[pyo3(
    signature = (robot, log, *, reference="forces", per_log=None, empirical=true, progress=None),
    text_signature = "(robot, log, *, reference=\"forces\", per_log=None, empirical=True, progress=False)"
)]
pub fn discover(
    #[pyo3(from_py_with = object)] robot: &Bound<'_, Robot>,
    log: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = text)] reference: &str,
    #[pyo3(from_py_with = argument)] per_log: Option<Vec<String>>,
    #[pyo3(from_py_with = argument)] empirical: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<Py<PyAny>> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    let runs = Runs::new(log)?;
    let given = robot.borrow().clone();
    let file = &given.file;
    let reference = named_reference(reference)?;
    let zero = named_zero(per_log.as_deref(), &runs, reference)?;
    let read = runs.read(robot, file, reference, zero, &mut watch)?;
    let options = DiscoverOptions { empirical, ..DiscoverOptions::default() };
    let (result, found) = run(&read, &options, &mut watch)?;
    let text = found.extended(&given.to_toml()?, ORIGIN)?;
    let provenance = Provenance::of_call("fric.discover", &runs.files(), Some((&result.robot, &given.to_toml()?)));
    let page = |provenance: &Provenance| discovery::page(&result, found.cables(), provenance);
    let shown = results::shown(py, result.summary(), &result, page, discovery::table(&result), &provenance)?;
    let cable = |(found, result): (&CableDiscovery, &DiscoverCableResult)| {
        let words: Vec<String> = result.places.iter().map(WhereResult::range_in_words).collect();
        let arrays = [&*found.times_s, &found.residual_before_n, &found.residual_after_n]
            .map(|numbers| fixed(py, numbers.clone()));
        let [time_s, before_n, after_n] = arrays;
        (words, time_s, before_n, after_n)
    };
    let cables: Vec<_> = found.cables().iter().zip(&result.cables).map(cable).collect();
    Ok(results::of(py, "DiscoverResult", (shown, Py::new(py, Robot::parse(text, ORIGIN)?)?, cables))?.unbind())
}
