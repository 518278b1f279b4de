//! `Compensator`: the control loop's cycle, one at a time or over arrays.

use fric_core::{AnyCompensator, CableInput, Pose};
use fric_lab::columns::OutputColumns;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arguments::{argument, frozen, object, text};
use crate::arrays::{Axis, Wanted, array, numbers};
use crate::errors::{Fault, Outcome};
use crate::exclusive::Exclusive;
use crate::results;
use crate::robot::{Robot, cables_in_words};
use crate::travel::{self, Reduced, counted_words};
use crate::watch::Watch;

/// Friction compensation, as in the control loop: the same code, the same bits.
///
/// It is built for the robot as it is now; later changes of the robot do not affect it. Signals may be NaN or infinite: `status` reports the fault of
/// a signal, which affects no other cable. The speed is required; if none is measured, `Log.from_arrays` derives it from the length.
///
/// >>> import numpy as np
/// >>> compensator = Compensator(Robot.read("examples/mini-ipanema.toml"))
/// >>> cycle = compensator.step(np.full(8, 15.2), np.full(8, 0.83), np.zeros(8))
/// >>> cycle.force_at_platform_n[0], Status(int(cycle.status[0]))
/// (np.float64(7.6), <Status.POSE_MISSING: 128>)
/// >>> run = compensator.run(np.full((500, 8), 15.2), np.full((500, 8), 0.83), np.zeros((500, 8)))
/// >>> run.friction_n.shape
/// (500, 8)
#[pyclass(module = "fric", frozen)]
pub struct Compensator {
    cycles: Exclusive<AnyCompensator>,
    /// The robot at set-up.
    robot: Robot,
    /// Names of the cables and their numbers of pulleys.
    cables: Vec<(String, usize)>,
}

/// The state of a compensator at one time.
#[pyclass(module = "fric", frozen, eq)]
#[derive(PartialEq)]
pub struct Snapshot {
    /// The full state, bit for bit.
    words: Vec<u64>,
}

impl Compensator {
    fn of(robot: Robot) -> Outcome<Self> {
        let params = robot.file.params();
        let pulley_counts = params.cables().iter().map(fric_core::CableParams::pulley_count);
        let names = robot.file.cable_names().into_iter().map(ToOwned::to_owned);
        let cables = names.zip(pulley_counts).collect();
        let cycles = Exclusive::new(AnyCompensator::new(&params)?, "Compensator");
        Ok(Self { cycles, robot, cables })
    }

    /// Returns the full state, bit for bit.
    fn state_words(&self) -> Outcome<Vec<u64>> {
        Ok(self.cycles.borrow()?.state_words())
    }
}

/// Returns a `Compensation`: arrays with one row per cycle, or a single row if `row_count` is `None`.
pub fn compensation(
    py: Python<'_>,
    columns: OutputColumns,
    row_count: Option<usize>,
    cable_count: usize,
) -> Outcome<Py<PyAny>> {
    let shape = |width: usize| row_count.into_iter().chain([width]).collect::<Vec<_>>();
    let cables = shape(cable_count);
    let has_wrench = columns.has_wrench();
    let fields = (
        array(py, columns.force_at_platform_n, &cables)?,
        array(py, columns.friction_n, &cables)?,
        array(py, columns.frictionless_n, &cables)?,
        array(py, columns.status, &cables)?,
        has_wrench.then(|| array(py, columns.outside_wrench, &shape(6))).transpose()?,
    );
    Ok(results::new(py, "Compensation", fields)?.unbind())
}

#[pymethods]
impl Compensator {
    #[new]
    fn new(#[pyo3(from_py_with = object)] robot: &Bound<'_, Robot>) -> Outcome<Self> {
        Self::of(robot.borrow().clone())
    }

    /// Runs one cycle with one number per cable in each array. `elapsed_cycles` is more than 1 after skipped cycles.
    #[pyo3(signature = (sensor_force_n, length_m, speed_m_per_s, *, position_m=None, orientation_xyzw=None, elapsed_cycles=1.0))]
    fn step(
        &self,
        py: Python<'_>,
        sensor_force_n: &Bound<'_, PyAny>,
        length_m: &Bound<'_, PyAny>,
        speed_m_per_s: &Bound<'_, PyAny>,
        position_m: Option<&Bound<'_, PyAny>>,
        orientation_xyzw: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument)] elapsed_cycles: f64,
    ) -> Outcome<Py<PyAny>> {
        let signals = Signals::read(&[], self.cables.len(), [sensor_force_n, length_m, speed_m_per_s])?;
        let poses = Poses::read(&[], position_m, orientation_xyzw)?;
        let elapsed_cycles = checked_elapsed(vec![elapsed_cycles])?;
        let mut columns = OutputColumns::default();
        cycle(&mut *self.cycles.borrow()?, &mut columns, &signals, &poses, &elapsed_cycles, 0, &mut Vec::new());
        compensation(py, columns, None, self.cables.len())
    }

    /// Runs as many cycles as the arrays have rows, with one column per cable; other threads run meanwhile.
    ///
    /// A row of `position_m` and `orientation_xyzw` that is NaN is a cycle without pose. `elapsed_cycles` is one number for all cycles or one per
    /// cycle. If Ctrl-C ends the call, the compensator is unchanged.
    #[pyo3(
        signature = (sensor_force_n, length_m, speed_m_per_s, *, position_m=None, orientation_xyzw=None, elapsed_cycles=None, progress=None),
        text_signature = "(self, sensor_force_n, length_m, speed_m_per_s, *, position_m=None, orientation_xyzw=None, elapsed_cycles=1.0, progress=False)"
    )]
    fn run(
        &self,
        py: Python<'_>,
        sensor_force_n: &Bound<'_, PyAny>,
        length_m: &Bound<'_, PyAny>,
        speed_m_per_s: &Bound<'_, PyAny>,
        position_m: Option<&Bound<'_, PyAny>>,
        orientation_xyzw: Option<&Bound<'_, PyAny>>,
        elapsed_cycles: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Outcome<Py<PyAny>> {
        let cable_count = self.cables.len();
        let signals = Signals::read(&[Axis::Rows], cable_count, [sensor_force_n, length_m, speed_m_per_s])?;
        let row_count = signals.sensor_force_n.len() / cable_count;
        let rows = [Axis::Exactly(row_count)];
        let poses = Poses::read(&rows, position_m, orientation_xyzw)?;
        let elapsed_cycles = match elapsed_cycles {
            None => vec![1.0],
            Some(value) => {
                let is_one = value.extract::<f64>().is_ok();
                let shape = if is_one { &[][..] } else { &rows };
                let wanted = Wanted { name: "elapsed_cycles", shape, entries: "one number, or one per row" };
                checked_elapsed(numbers(&wanted, value)?)?
            }
        };
        let mut cycles = self.cycles.borrow()?;
        let before = cycles.snapshot();
        let (mut columns, mut cables) = (OutputColumns::default(), Vec::new());
        let compensator = &mut *cycles;
        let result = Watch::new(py, progress)?.work(row_count, |rows| {
            for row in rows {
                cycle(compensator, &mut columns, &signals, &poses, &elapsed_cycles, row, &mut cables);
            }
            Ok(())
        });
        if result.is_err() {
            compensator.restore(&before)?;
        }
        result?;
        compensation(py, columns, Some(row_count), cable_count)
    }

    /// Resets to the state after set-up: at rest, nothing stored, no pose.
    fn reset(&self) -> Outcome {
        self.cycles.borrow()?.reset();
        Ok(())
    }

    /// Returns the present state.
    fn snapshot(&self) -> Outcome<Snapshot> {
        Ok(Snapshot { words: self.state_words()? })
    }

    /// Restores a snapshot; the following cycles have the same bits as after the snapshot.
    fn restore(&self, #[pyo3(from_py_with = frozen)] snapshot: &Snapshot) -> Outcome {
        Ok(self.cycles.borrow()?.restore_words(&snapshot.words)?)
    }

    /// Friction stored at each pulley of a cable, from the winch, N; zeros with `lumped` presliding.
    fn pulley_friction_n(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = text)] cable: &str,
    ) -> Outcome<Py<PyArray1<f64>>> {
        let names = || self.cables.iter().map(|(name, _)| name.as_str());
        let Some(index) = names().position(|name| name == cable) else {
            return Err(Fault::config(fric_core::robot::unknown_name("cable", cable, names())));
        };
        let count = self.cables.get(index).map_or(0, |(_, pulley_count)| *pulley_count);
        let friction_n = self.cycles.borrow()?.pulley_friction_n(index);
        Ok(PyArray1::from_iter(py, friction_n.into_iter().take(count)).unbind())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> Outcome<bool> {
        let Ok(other) = other.cast::<Self>() else { return Ok(false) };
        let other = other.get();
        Ok(self.robot.file == other.robot.file && self.state_words()? == other.state_words()?)
    }

    fn __repr__(&self) -> String {
        let cables = cables_in_words(&self.robot.file.cable_names());
        format!("<Compensator of {:?}: {cables}>", self.robot.file.options().name)
    }

    /// Pickles, and copies, the robot and the state; the copy continues with the same bits.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Outcome<Reduced<'py, (String, Robot, Vec<u64>)>> {
        let one = slf.get();
        let state = (travel::VERSION.to_owned(), one.robot.clone(), one.state_words()?);
        Ok((slf.getattr("_unpickled")?, state))
    }

    /// Creates the pickled compensator.
    #[staticmethod]
    fn _unpickled(version: &str, robot: &Robot, words: Vec<u64>) -> Outcome<Self> {
        travel::check_version(version)?;
        let one = Self::of(robot.clone())?;
        one.cycles.borrow()?.restore_words(&words)?;
        Ok(one)
    }
}

#[pymethods]
impl Snapshot {
    fn __repr__(&self) -> String {
        format!("<Snapshot: {}>", counted_words(&self.words, "cable"))
    }

    /// Pickles, and copies, the numbers of the state.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Outcome<Reduced<'py, (String, Vec<u64>)>> {
        Ok((slf.getattr("_unpickled")?, (travel::VERSION.to_owned(), slf.get().words.clone())))
    }

    /// Creates the pickled snapshot.
    #[staticmethod]
    fn _unpickled(version: &str, words: Vec<u64>) -> Outcome<Self> {
        travel::check_version(version)?;
        Ok(Self { words })
    }
}

/// Signals of all cables, row by row.
struct Signals {
    cable_count: usize,
    sensor_force_n: Vec<f64>,
    length_m: Vec<f64>,
    speed_m_per_s: Vec<f64>,
}

impl Signals {
    fn read(rows: &[Axis], cable_count: usize, values: [&Bound<'_, PyAny>; 3]) -> Outcome<Self> {
        let [sensor_force_n, length_m, speed_m_per_s] = values;
        let entries = "one number per cable";
        let read = |rows: &[Axis], name, value| {
            let shape: Vec<Axis> = rows.iter().copied().chain([Axis::Exactly(cable_count)]).collect();
            numbers(&Wanted { name, shape: &shape, entries }, value)
        };
        let sensor_force_n = read(rows, "sensor_force_n", sensor_force_n)?;
        let row_count = [Axis::Exactly(sensor_force_n.len() / cable_count)];
        let rows = if rows.is_empty() { rows } else { &row_count };
        Ok(Self {
            cable_count,
            sensor_force_n,
            length_m: read(rows, "length_m", length_m)?,
            speed_m_per_s: read(rows, "speed_m_per_s", speed_m_per_s)?,
        })
    }

    fn fill(&self, row: usize, cables: &mut Vec<CableInput>) {
        let range = row * self.cable_count..(row + 1) * self.cable_count;
        cables.clear();
        cables.extend(range.map_while(|place| {
            Some(CableInput {
                sensor_force_n: *self.sensor_force_n.get(place)?,
                length_m: *self.length_m.get(place)?,
                speed_m_per_s: *self.speed_m_per_s.get(place)?,
            })
        }));
    }
}

/// Poses, row by row; empty without any.
struct Poses {
    position_m: Vec<f64>,
    orientation_xyzw: Vec<f64>,
}

impl Poses {
    fn read(
        rows: &[Axis],
        position_m: Option<&Bound<'_, PyAny>>,
        orientation_xyzw: Option<&Bound<'_, PyAny>>,
    ) -> Outcome<Self> {
        let read = |name, width, entries, value| {
            let shape: Vec<Axis> = rows.iter().copied().chain([Axis::Exactly(width)]).collect();
            numbers(&Wanted { name, shape: &shape, entries }, value)
        };
        match (position_m, orientation_xyzw) {
            (None, None) => Ok(Self { position_m: Vec::new(), orientation_xyzw: Vec::new() }),
            (Some(position_m), Some(orientation_xyzw)) => Ok(Self {
                position_m: read("position_m", 3, "x, y, z", position_m)?,
                orientation_xyzw: read("orientation_xyzw", 4, "a quaternion x, y, z, w", orientation_xyzw)?,
            }),
            _ => Err(Fault::shape("a pose is `position_m` and `orientation_xyzw`; give both or neither")),
        }
    }

    fn get(&self, row: usize) -> Option<Pose> {
        let position_m = self.position_m.get(3 * row..3 * (row + 1))?;
        let orientation_xyzw = self.orientation_xyzw.get(4 * row..4 * (row + 1))?;
        Pose::from_parts(position_m.try_into().ok()?, orientation_xyzw.try_into().ok()?)
    }
}

fn checked_elapsed(elapsed_cycles: Vec<f64>) -> Outcome<Vec<f64>> {
    match elapsed_cycles.iter().position(|cycles| !cycles.is_finite()) {
        None => Ok(elapsed_cycles),
        Some(row) => {
            Err(Fault::shape(format!("`elapsed_cycles` is not finite in row {row}; 1 is a cycle after another")))
        }
    }
}

/// Runs one row through the compensator.
fn cycle(
    compensator: &mut AnyCompensator,
    columns: &mut OutputColumns,
    signals: &Signals,
    poses: &Poses,
    elapsed_cycles: &[f64],
    row: usize,
    cables: &mut Vec<CableInput>,
) {
    signals.fill(row, cables);
    let elapsed = elapsed_cycles.get(row).or(elapsed_cycles.first()).copied().unwrap_or(1.0);
    compensator.set_input(cables, poses.get(row), elapsed);
    let outside_wrench = compensator.step();
    columns.push(compensator.outputs(), outside_wrench.as_ref());
}
