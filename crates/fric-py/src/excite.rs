//! `excite`: the identification run as set points.

use std::path::PathBuf;

use fric_lab::excite::{Excitation, ExcitationOptions, ExcitedCycle};
use fric_log::output::OutputFile;
use fric_work::excite::describe;
use fric_work::provenance::Provenance;
use fric_work::report::{RunSeries, preview};
use fric_work::set_points::SetPointTable;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{fixed, fixed_rows};
use crate::errors::Outcome;
use crate::results;
use crate::robot::Robot;
use crate::watch::{STRIDE, Watch};

/// Set points, one quantity after the other.
#[derive(Default)]
struct SetPoints {
    /// Names of the phases in the order in which they come first.
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

/// The identification run for a robot, cycle by cycle: `fric-cli excite`.
///
/// `box_m` is two corners of the box in which the platform runs, base frame, m; the others cap its speed and acceleration and bound
/// the cable forces at the platform. What is left out is the run's own, as on the command line. With `output` the set points are
/// written to a CSV file, whole or not at all, with the units in its header; an existing file is replaced only with `force`.
///
/// >>> robot = Robot.read("examples/mini-ipanema.toml")
/// >>> run = excite(robot, max_speed_m_per_s=0.5)
/// >>> run.length_m.shape == (len(run), 8), float(abs(run.velocity_m_per_s).max()) <= 0.5
/// (True, True)
/// >>> run.phases[0]
/// 'stop_and_go'
#[pyfunction]
#[pyo3(
    signature = (robot, *, box_m=None, max_speed_m_per_s=None, max_acceleration_m_per_s2=None, min_tension_n=None, max_tension_n=None, output=None, force=false, progress=None),
    text_signature = "(robot, *, box_m=None, max_speed_m_per_s=None, max_acceleration_m_per_s2=None, min_tension_n=None, max_tension_n=None, output=None, force=False, progress=False)"
)]
pub fn excite(
    robot: &Bound<'_, Robot>,
    box_m: Option<[[f64; 3]; 2]>,
    max_speed_m_per_s: Option<f64>,
    max_acceleration_m_per_s2: Option<f64>,
    min_tension_n: Option<f64>,
    max_tension_n: Option<f64>,
    output: Option<PathBuf>,
    force: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<Py<PyAny>> {
    let py = robot.py();
    let mut watch = Watch::new(py, progress)?;
    let file = robot.borrow().file.clone();
    let options =
        ExcitationOptions { box_m, max_speed_m_per_s, max_acceleration_m_per_s2, min_tension_n, max_tension_n };
    let mut excitation = py.detach(|| Excitation::new(&file, &options))?;
    let inputs: [PathBuf; 0] = [];
    let created = output.map(|path| OutputFile::create(&path, &inputs, force)).transpose()?;
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
    let page = preview::page(&file, &excitation, &series, &provenance);
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
        (describe(&excitation, &series), page),
    );
    Ok(results::of(py, "ExciteResult", fields)?.unbind())
}
