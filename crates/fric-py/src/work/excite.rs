//! `excite`: the identification run, or one that was designed for a question, as set points.

use std::path::PathBuf;

use fric_lab::excite::{Excitation, ExcitationOptions, ExcitedCycle, Experiment, STANDARD_DURATION_S, design};
use fric_log::output::OutputFile;
use fric_work::excite::{describe, expectations};
use fric_work::provenance::Provenance;
use fric_work::questions::{Request, questions};
use fric_work::report::RunSeries;
use fric_work::report::preview::{self, Purpose};
use fric_work::set_points::SetPointTable;
use fric_work::supervisor::Supervisor as _;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::{argument, object, refused};
use crate::arrays::{fixed, fixed_rows};
use crate::errors::{Fault, Outcome};
use crate::log;
use crate::results;
use crate::robot::Robot;
use crate::watch::{STRIDE, Watch};

/// Set points, one column per quantity.
#[derive(Default)]
struct SetPoints {
    /// Names of the phases in the order of their first occurrence.
    phases: Vec<&'static str>,
    phase: Vec<u8>,
    time_s: Vec<f64>,
    position_m: Vec<f64>,
    orientation_xyzw: Vec<f64>,
    velocity_m_per_s: Vec<f64>,
    acceleration_m_per_s2: Vec<f64>,
    length_m: Vec<f64>,
    speed_m_per_s: Vec<f64>,
    tension_n: Vec<f64>,
}

impl SetPoints {
    fn push(&mut self, cycle: &ExcitedCycle<'_>) {
        let name = cycle.phase.name();
        let place = self.phases.iter().position(|phase| *phase == name).unwrap_or_else(|| {
            self.phases.push(name);
            self.phases.len() - 1
        });
        self.phase.push(u8::try_from(place).unwrap_or(u8::MAX));
        self.time_s.push(cycle.time_s);
        if let Some(set_point) = &cycle.platform {
            self.position_m.extend(set_point.position_m.iter());
            self.orientation_xyzw.extend(set_point.orientation.coords.iter());
            self.velocity_m_per_s.extend(set_point.velocity_m_per_s.iter());
            self.acceleration_m_per_s2.extend(set_point.acceleration_m_per_s2.iter());
        }
        self.length_m.extend(cycle.cables.iter().map(|cable| cable.length_m));
        self.speed_m_per_s.extend(cycle.cables.iter().map(|cable| cable.speed_m_per_s));
        self.tension_n.extend(cycle.tensions_n.unwrap_or_default());
    }
}

/// The identification run for a robot, or a run designed for a question, cycle by cycle: `fric-cli excite`.
///
/// `box_m` is two corners of the box in which the platform runs, base frame, m; the other options limit its speed and acceleration and the cable
/// forces at the platform. Defaults are those of the run, as on the command line. With `output` the set points are written to a CSV file, completely
/// or not at all, with the units in its header; an existing file is replaced only with `force`.
///
/// One of these options designs the run: `separate` names two effects to distinguish, `determine` names parameters to determine, and `for_` is a
/// discovery with open questions (a DiscoverResult, or its JSON as a dict or text). Then `duration_s` is the duration of the run (20 s by default),
/// `cables` the names of the cables of the question (all by default), `noise_n` the standard deviation of the noise of the force at the platform.
/// `result.expectations` contains the expected result; if no run within the limits can answer the question, ConfigError says so.
///
/// >>> robot = Robot.read("examples/mini-ipanema.toml")
/// >>> run = excite(robot, max_speed_m_per_s=0.5)
/// >>> run.length_m.shape == (len(run), 8), float(abs(run.velocity_m_per_s).max()) <= 0.5
/// (True, True)
/// >>> run.phases[0]
/// 'stop_and_go'
#[pyfunction]
#[pyo3(
    signature = (robot, *, box_m=None, max_speed_m_per_s=None, max_acceleration_m_per_s2=None, min_tension_n=None, max_tension_n=None, for_=None, separate=None, determine=None, duration_s=None, cables=None, noise_n=None, output=None, force=false, progress=None),
    text_signature = "(robot, *, box_m=None, max_speed_m_per_s=None, max_acceleration_m_per_s2=None, min_tension_n=None, max_tension_n=None, for_=None, separate=None, determine=None, duration_s=None, cables=None, noise_n=None, output=None, force=False, progress=False)"
)]
pub fn excite(
    #[pyo3(from_py_with = object)] robot: &Bound<'_, Robot>,
    #[pyo3(from_py_with = argument)] box_m: Option<[[f64; 3]; 2]>,
    #[pyo3(from_py_with = argument)] max_speed_m_per_s: Option<f64>,
    #[pyo3(from_py_with = argument)] max_acceleration_m_per_s2: Option<f64>,
    #[pyo3(from_py_with = argument)] min_tension_n: Option<f64>,
    #[pyo3(from_py_with = argument)] max_tension_n: Option<f64>,
    for_: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = argument)] separate: Option<Vec<String>>,
    #[pyo3(from_py_with = argument)] determine: Option<Vec<String>>,
    #[pyo3(from_py_with = argument)] duration_s: Option<f64>,
    #[pyo3(from_py_with = argument)] cables: Option<Vec<String>>,
    #[pyo3(from_py_with = argument)] noise_n: Option<f64>,
    #[pyo3(from_py_with = argument)] output: Option<PathBuf>,
    #[pyo3(from_py_with = argument)] force: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<Py<PyAny>> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    let file = robot.borrow().file.clone();
    let options =
        ExcitationOptions { box_m, max_speed_m_per_s, max_acceleration_m_per_s2, min_tension_n, max_tension_n };
    let found = for_.map(found_text).transpose()?;
    let request = match (&found, &separate, &determine) {
        (None, None, None) => None,
        (Some(text), None, None) => Some(("for_", Request::Found(text))),
        (None, Some(kinds), None) => Some(("separate", Request::Separate(kinds))),
        (None, None, Some(names)) => Some(("determine", Request::Determine(names))),
        _ => return Err(Fault::config("`for_`, `separate` and `determine` are three questions; ask one of them")),
    };
    let unused = [("duration_s", duration_s.is_some()), ("cables", cables.is_some()), ("noise_n", noise_n.is_some())];
    let unused = unused.into_iter().find(|(_, given)| *given && request.is_none());
    if let Some((name, _)) = unused {
        return Err(Fault::config(format!("`{name}` needs a question; give `for_`, `separate` or `determine`")));
    }
    let inputs: [PathBuf; 0] = [];
    let created = output.map(|path| OutputFile::create(&path, &inputs, force)).transpose()?;
    let (mut excitation, purpose) = match request {
        Some((asked, request)) => {
            let command = request.command();
            let questions = questions(&file, request, cables.as_deref(), noise_n);
            let questions = questions.map_err(|error| Fault::config(format!("`{asked}`: {error}")))?;
            let duration_s = duration_s.unwrap_or(STANDARD_DURATION_S);
            let Experiment { excitation, forecasts } = watch.compute("designing", "steps", |progress| {
                design(&file, &options, duration_s, &questions, progress)
            })??;
            (excitation, Some(Purpose { expectations: expectations(&file.cable_names(), &forecasts), command }))
        }
        None => (py.detach(|| Excitation::new(&file, &options))?, None),
    };
    log::warn(py, excitation.warning().as_slice())?;
    let mut table = created.map(SetPointTable::new);
    if let Some(table) = &mut table {
        table.write_header(&file.cable_names(), &excitation)?;
    }
    let total = excitation.total_cycles();
    let (mut points, mut series) = (SetPoints::default(), RunSeries::new(total));
    loop {
        let done = points.time_s.len() as u64;
        watch.look(done, total)?;
        if done >= total {
            break;
        }
        py.detach(|| -> Outcome {
            for _ in 0..STRIDE {
                let Some(cycle) = excitation.next_cycle()? else { break };
                if let Some(table) = &mut table {
                    table.write(&cycle)?;
                }
                series.add(&cycle);
                points.push(&cycle);
            }
            Ok(())
        })?;
    }
    if let Some(table) = table {
        table.complete()?.place()?;
    }
    let text = robot.borrow().to_toml()?;
    let provenance = Provenance::of_call("fric.excite", &[], Some((&file.options().name, &text)));
    let page = preview::page(&file, &excitation, &series, purpose.as_ref(), &provenance);
    let expected = purpose.map_or_else(Vec::new, |purpose| purpose.expectations);
    let told: String = expected.iter().flat_map(|line| ["\n  ", line]).collect();
    let summary = format!("{}{told}", describe(&excitation, &series));
    let names = file.cable_names();
    let count = names.len();
    let of_platform =
        |numbers: Vec<f64>, width: usize| (!numbers.is_empty()).then(|| fixed_rows(py, numbers, width)).transpose();
    let place = [
        of_platform(points.position_m, 3)?,
        of_platform(points.orientation_xyzw, 4)?,
        of_platform(points.velocity_m_per_s, 3)?,
        of_platform(points.acceleration_m_per_s2, 3)?,
    ];
    let [position_m, orientation_xyzw, velocity_m_per_s, acceleration_m_per_s2] = place;
    let fields = (
        (file.options().name.clone(), PyTuple::new(py, &names)?, PyTuple::new(py, &points.phases)?),
        (fixed(py, points.phase), fixed(py, points.time_s)),
        (position_m, orientation_xyzw, velocity_m_per_s, acceleration_m_per_s2),
        (fixed_rows(py, points.length_m, count)?, fixed_rows(py, points.speed_m_per_s, count)?),
        of_platform(points.tension_n, count)?,
        PyTuple::new(py, &expected)?,
        (summary, page),
    );
    Ok(results::of(py, "ExciteResult", fields)?.unbind())
}

/// Returns the JSON of a discovery: from its result, from a dict, or as given.
fn found_text(found: &Bound<'_, PyAny>) -> Outcome<String> {
    if let Ok(text) = found.extract::<String>() {
        return Ok(text);
    }
    if found.hasattr("to_json")? {
        return Ok(found.call_method0("to_json")?.extract()?);
    }
    let dumped = found.py().import("json")?.call_method1("dumps", (found,));
    let text = dumped.and_then(|text| text.extract());
    text.map_err(|_| refused("for_", "a DiscoverResult, or its JSON as a dict or text", found))
}
