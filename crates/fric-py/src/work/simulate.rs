//! `simulate`: the log of a robot with known friction.

use fric_core::robot::unknown_name;
use fric_lab::columns::SampleColumns;
use fric_lab::simulate::{Disturbance, HiddenEffect, HiddenError, Run, Simulation, SimulationOptions};
use fric_work::supervisor::Supervisor as _;
use pyo3::prelude::*;
use pyo3::types::{PyMapping, PyString};

use crate::arguments::{argument, object, refused, text};
use crate::errors::{Fault, Outcome};
use crate::log::{self, Log};
use crate::robot::Robot;
use crate::watch::{STRIDE, Watch};

/// The log of a simulated robot. Its friction is that of the robot file, computed independently of the compensator.
///
/// `run` is the movement of the platform, `"identification"` or `"crossing"`: one position crossed along and about all axes, for the hysteresis of
/// the wrench. `effects` are hidden in all cables, each a dict as in the robot file or a text as for `fric-cli simulate`; `disturbances`, which are
/// not in the catalogue of effects, have the same form. Noise is white; drifts have the correlation time `wander_s`; a hand pushes the platform with
/// at most `hand_n`. With `length_noise_m` or `length_resolution_m` the speed is the difference of two lengths. Equal `seed`s give equal bits, which
/// are those of `fric-cli simulate`, except that this log has pose and wrench in every row, whereas the file has them every 4 ms. The default
/// duration is one run. Anything that no real robot could do is reported as LogWarning.
///
/// >>> robot = Robot.read("examples/mini-ipanema.toml")
/// >>> log = simulate(robot, seed=7, duration_s=0.5, effects=[{"kind": "stribeck", "ratio": 0.5}])
/// >>> len(log), log.sensor_force_n.shape
/// (500, (500, 8))
#[pyfunction]
#[pyo3(
    signature = (robot, *, run="identification", seed=0, duration_s=None, effects=None, disturbances=None, sensor_noise_n=0.02, reference_noise_n=0.01, mu_spread_ratio=0.0, sensor_wander_n=0.0, reference_wander_n=0.0, wander_s=2.0, hand_n=0.0, length_noise_m=0.0, length_resolution_m=0.0, progress=None),
    text_signature = "(robot, *, run=\"identification\", seed=0, duration_s=None, effects=(), disturbances=(), sensor_noise_n=0.02, reference_noise_n=0.01, mu_spread_ratio=0.0, sensor_wander_n=0.0, reference_wander_n=0.0, wander_s=2.0, hand_n=0.0, length_noise_m=0.0, length_resolution_m=0.0, progress=False)"
)]
pub fn simulate(
    #[pyo3(from_py_with = object)] robot: &Bound<'_, Robot>,
    #[pyo3(from_py_with = text)] run: &str,
    #[pyo3(from_py_with = argument)] seed: u64,
    #[pyo3(from_py_with = argument)] duration_s: Option<f64>,
    effects: Option<&Bound<'_, PyAny>>,
    disturbances: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = argument)] sensor_noise_n: f64,
    #[pyo3(from_py_with = argument)] reference_noise_n: f64,
    #[pyo3(from_py_with = argument)] mu_spread_ratio: f64,
    #[pyo3(from_py_with = argument)] sensor_wander_n: f64,
    #[pyo3(from_py_with = argument)] reference_wander_n: f64,
    #[pyo3(from_py_with = argument)] wander_s: f64,
    #[pyo3(from_py_with = argument)] hand_n: f64,
    #[pyo3(from_py_with = argument)] length_noise_m: f64,
    #[pyo3(from_py_with = argument)] length_resolution_m: f64,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<Log> {
    let py = robot.py();
    let effects = all_hidden(effects, &EFFECT)?;
    let disturbances = all_hidden(disturbances, &DISTURBANCE)?;
    let run = named(run)?;
    let options = SimulationOptions {
        run,
        seed,
        duration_s,
        sensor_noise_n,
        reference_noise_n,
        mu_spread_ratio,
        sensor_wander_n,
        reference_wander_n,
        wander_s,
        hand_n,
        length_noise_m,
        length_resolution_m,
        effects,
        disturbances,
    };
    let robot = robot.borrow().clone();
    let file = robot.file.clone();
    let mut simulation = py.detach(|| Simulation::new(&file, &options))?;
    let mut columns = SampleColumns::default();
    let mut watch = Watch::new(py, progress)?;
    let total = simulation.total_cycles();
    loop {
        let done = columns.stamp_nanos.len() as u64;
        watch.look(done, total)?;
        if done >= total {
            break;
        }
        py.detach(|| {
            for _ in 0..STRIDE {
                let Some(sample) = simulation.next_cycle() else { break };
                columns.push(&sample);
            }
        });
    }
    log::warn(py, &simulation.warnings())?;
    Log::new(py, columns, &file.cable_names(), Some(robot), Vec::new())
}

/// Returns a run by its name.
fn named(name: &str) -> Outcome<Run> {
    let known = || Run::ALL.into_iter();
    known()
        .find(|run| run.name() == name)
        .ok_or_else(|| Fault::config(unknown_name("run", name, known().map(Run::name))))
}

/// A constructor from name and values by key.
type New<T> = fn(&str, &[(&str, f64)]) -> Result<T, HiddenError>;

/// A kind of content that can be hidden in a log.
struct Kind<T> {
    /// The argument that lists it.
    argument: &'static str,
    /// The noun with its article.
    noun: &'static str,
    /// An example as a dict.
    example: &'static str,
    parse: fn(&str) -> Result<T, HiddenError>,
    new: New<T>,
}

const EFFECT: Kind<HiddenEffect> = Kind {
    argument: "effects",
    noun: "an effect",
    example: "{\"kind\": \"stribeck\", \"ratio\": 0.5}",
    parse: HiddenEffect::parse,
    new: HiddenEffect::new,
};

const DISTURBANCE: Kind<Disturbance> = Kind {
    argument: "disturbances",
    noun: "a disturbance",
    example: "{\"kind\": \"hum\", \"amplitude_n\": 0.1}",
    parse: Disturbance::parse,
    new: Disturbance::new,
};

fn all_hidden<T>(given: Option<&Bound<'_, PyAny>>, kind: &Kind<T>) -> Outcome<Vec<T>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    let refuse = || refused(kind.argument, "a list of dicts or texts", given);
    if given.is_instance_of::<PyString>() || given.is_instance_of::<PyMapping>() {
        return Err(refuse());
    }
    let items = given.try_iter().map_err(|_| refuse())?;
    items.map(|item| hidden(&item?, kind)).collect()
}

/// Converts a dict, in the form of the robot file, or a text.
fn hidden<T>(item: &Bound<'_, PyAny>, kind: &Kind<T>) -> Outcome<T> {
    let Kind { noun, example, parse, new, .. } = kind;
    if let Ok(text) = item.cast::<PyString>() {
        return Ok(parse(text.to_str()?)?);
    }
    let malformed = || Fault::config(format!("{noun} is a dict such as {example}, or a text"));
    let items = item.cast::<PyMapping>().map_err(|_| malformed())?.items()?;
    let (mut name, mut values) = (None, Vec::new());
    for item in items {
        let (key, value): (String, Bound<'_, PyAny>) = item.extract().map_err(|_| malformed())?;
        if key == "kind" {
            name = Some(value.extract::<String>().map_err(|_| malformed())?);
        } else {
            let number = value.extract::<f64>();
            values.push((key.clone(), number.map_err(|_| Fault::config(format!("`{key}` of {noun} is no number")))?));
        }
    }
    let values: Vec<(&str, f64)> = values.iter().map(|(key, value)| (key.as_str(), *value)).collect();
    Ok(new(&name.ok_or_else(malformed)?, &values)?)
}
