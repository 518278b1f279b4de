//! `StaticModel`: shapes and commands of a manipulator, one at a time or over arrays.

use fric_core::robot::unknown_name;
use fric_tendon::{AnyStaticModel, Direction, Drive, DriveOptions, Friction, Goal};
use fric_work::verdict::counted;
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

use super::Manipulator;
use super::static_rows::{CommandRows, ShapeRows};
use crate::arguments::{argument, frozen, object, text};
use crate::arrays::{Axis, Wanted, numbers};
use crate::errors::{Fault, Outcome};
use crate::exclusive::Exclusive;
use crate::travel::{self, Reduced, counted_words};
use crate::watch::Watch;

/// Static model of a manipulator, as in the control loop: the same code, the same bits.
///
/// `solve` is one step: it computes the shape for tensions at the base. `tension_for` is the inverse: it computes the tension at the base for a bend,
/// or for a position of the tip. `run` and `follow` do the same over arrays. With `friction="history"`, the default, each hole remembers the motion
/// of the tendon through it, so pass every step of the run, starting with the relaxed tendon. The other friction models are "none", Coulomb friction
/// with every hole sliding as in pulling ("pulling") or in the opposite direction ("releasing"), and "measured" by `tension_n` in the segments.
///
/// Tensions at the base are numbers for the first tendon alone, or pairs for both. They are those of the tendons; `[base_sensor]` of the file is not
/// applied. Non-finite input is flagged in `status` and leaves the model unchanged.
///
/// The drive: `least_tension_n` is the tension that each tendon keeps while the other one is pulled, `greatest_tension_n` the greatest tension of
/// each (by default the first tendon's capacity, and nothing for the second). A goal nearer than `hold_rad` (for the tip: relative to the
/// manipulator's length) keeps the tensions.
///
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> model = continuum.StaticModel(arm)
/// >>> for bend_rad in [0.2, 0.6, 0.59]:
/// ...     command = model.tension_for(bend_rad=bend_rad)
/// ...     shape = model.solve(command.base_tension_n)
/// >>> round(float(shape.bend_rad), 6), continuum.GoalStatus(int(command.status))
/// (0.59, <GoalStatus.REVERSAL|DEAD_BAND: 48>)
/// >>> model.run([0.4, 0.8, 0.7]).disk_position_m.shape
/// (3, 8, 2)
#[pyclass(module = "fric.continuum", frozen)]
pub struct StaticModel {
    model: Exclusive<AnyStaticModel>,
    drive: Drive,
    options: DriveOptions,
    manipulator: Py<Manipulator>,
}

/// The state of a static model at one time: the last shape and the memory of the holes.
#[pyclass(module = "fric.continuum", frozen, eq)]
#[derive(PartialEq)]
pub struct StaticSnapshot {
    /// The full state, bit for bit; the number of disks first.
    words: Vec<u64>,
}

/// The friction model of a call.
enum Way {
    Given(Friction<'static>),
    /// Tensions in the segments, row by row, of one tendon or of both.
    Measured {
        tension_n: Vec<f64>,
        tendons: usize,
    },
}

const HISTORY: &str = "history";
const MEASURED: &str = "measured";

/// Returns the friction model of a name.
fn friction_of(name: &str) -> Option<Friction<'static>> {
    match name {
        HISTORY => Some(Friction::History),
        "none" => Some(Friction::None),
        "pulling" => Some(Friction::Coulomb(Direction::Pulling)),
        "releasing" => Some(Friction::Coulomb(Direction::Releasing)),
        _ => None,
    }
}

fn unknown_friction(name: &str, known: &[&str]) -> Fault {
    Fault::config(unknown_name("friction", name, known.iter().copied()))
}

/// Returns the number of axes of an argument; 0 for one that is no array, which `numbers` refuses.
fn axis_count(value: &Bound<'_, PyAny>) -> Outcome<usize> {
    let Ok(array) = value.py().import("numpy")?.call_method1("asarray", (value,)) else { return Ok(0) };
    Ok(array.cast::<PyUntypedArray>()?.ndim())
}

/// Returns the tensions at the base of both tendons, row by row.
fn base_tensions(value: &Bound<'_, PyAny>, rows: &[Axis]) -> Outcome<Vec<[f64; 2]>> {
    let entries = "of the first tendon, or pairs of both";
    if axis_count(value)? > rows.len() {
        let shape: Vec<Axis> = rows.iter().copied().chain([Axis::Exactly(2)]).collect();
        let pairs = numbers(&Wanted { name: "base_tension_n", shape: &shape, entries }, value)?;
        Ok(pairs.as_chunks().0.to_vec())
    } else {
        let first = numbers(&Wanted { name: "base_tension_n", shape: rows, entries }, value)?;
        Ok(first.into_iter().map(|first_n| [first_n, 0.0]).collect())
    }
}

impl Way {
    fn read(name: &str, tension_n: Option<&Bound<'_, PyAny>>, rows: &[Axis], disk_count: usize) -> Outcome<Self> {
        match (name, tension_n) {
            (MEASURED, Some(value)) => {
                let has_both = axis_count(value)? > rows.len() + 1;
                let tendons = if has_both { 2 } else { 1 };
                let pair = if has_both { &[Axis::Exactly(2)][..] } else { &[] };
                let shape: Vec<Axis> = rows.iter().chain(pair).copied().chain([Axis::Exactly(disk_count)]).collect();
                let entries = "one tension per segment";
                Ok(Self::Measured {
                    tension_n: numbers(&Wanted { name: "tension_n", shape: &shape, entries }, value)?,
                    tendons,
                })
            }
            (MEASURED, None) => {
                Err(Fault::shape("friction=\"measured\" needs `tension_n`, the tension in each segment"))
            }
            (_, Some(_)) => Err(Fault::shape("`tension_n` goes with friction=\"measured\" alone; leave it out")),
            (name, None) => friction_of(name)
                .map(Self::Given)
                .ok_or_else(|| unknown_friction(name, &[HISTORY, "none", "pulling", "releasing", MEASURED])),
        }
    }

    /// Returns the friction of a row.
    fn of_row(&self, row: usize, disk_count: usize) -> Friction<'_> {
        match self {
            Self::Given(friction) => *friction,
            Self::Measured { tension_n, tendons } => {
                let of_tendon = |tendon: usize| {
                    let begin = (row * tendons + tendon) * disk_count;
                    tension_n.get(begin..begin + disk_count).filter(|_| tendon < *tendons).unwrap_or_default()
                };
                Friction::Measured([of_tendon(0), of_tendon(1)])
            }
        }
    }
}

/// Returns the goals, row by row: bends or positions of the tip.
pub(super) fn goals(
    bend_rad: Option<&Bound<'_, PyAny>>,
    tip_m: Option<&Bound<'_, PyAny>>,
    rows: &[Axis],
) -> Outcome<Vec<Goal>> {
    match (bend_rad, tip_m) {
        (Some(value), None) => {
            let wanted = Wanted { name: "bend_rad", shape: rows, entries: "a bend of the whole manipulator" };
            Ok(numbers(&wanted, value)?.into_iter().map(Goal::BendRad).collect())
        }
        (None, Some(value)) => {
            let shape: Vec<Axis> = rows.iter().copied().chain([Axis::Exactly(2)]).collect();
            let tips = numbers(&Wanted { name: "tip_m", shape: &shape, entries: "x, y in the base frame" }, value)?;
            Ok(tips.as_chunks().0.iter().copied().map(Goal::TipM).collect())
        }
        _ => Err(Fault::shape("a goal is `bend_rad` or `tip_m`; give one of them")),
    }
}

/// Returns the friction of a goal.
fn goal_friction(name: &str) -> Outcome<Friction<'static>> {
    friction_of(name).ok_or_else(|| unknown_friction(name, &[HISTORY, "none", "pulling", "releasing"]))
}

impl StaticModel {
    fn disk_count(&self) -> usize {
        self.manipulator.get().file.params().disk_count()
    }

    fn of(manipulator: Py<Manipulator>, options: DriveOptions) -> Outcome<Self> {
        let params = manipulator.get().file.params();
        let model = Exclusive::new(AnyStaticModel::new(params)?, "StaticModel");
        let drive = Drive::new(params, &options)?;
        Ok(Self { model, drive, options, manipulator })
    }

    /// Works over rows. If Ctrl-C ends the work, the model is unchanged.
    fn work(
        &self,
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
        count: usize,
        mut row: impl FnMut(&mut AnyStaticModel, &Drive, usize) + Send,
    ) -> Outcome {
        let mut state = self.model.borrow()?;
        let before = state.clone();
        let (model, drive) = (&mut *state, &self.drive);
        let done = Watch::new(py, progress)?.work(count, |rows| {
            rows.for_each(|place| row(model, drive, place));
            Ok(())
        });
        if done.is_err() {
            *state = before;
        }
        done
    }

    fn state_words(&self) -> Outcome<Vec<u64>> {
        Ok(self.model.borrow()?.state_words())
    }
}

#[pymethods]
impl StaticModel {
    #[new]
    #[pyo3(
        signature = (manipulator, *, least_tension_n=None, greatest_tension_n=None, hold_rad=0.0),
        text_signature = "(manipulator, *, least_tension_n=(0.0, 0.0), greatest_tension_n=None, hold_rad=0.0)"
    )]
    fn new(
        #[pyo3(from_py_with = object)] manipulator: &Bound<'_, Manipulator>,
        #[pyo3(from_py_with = argument)] least_tension_n: Option<[f64; 2]>,
        #[pyo3(from_py_with = argument)] greatest_tension_n: Option<[f64; 2]>,
        #[pyo3(from_py_with = argument)] hold_rad: f64,
    ) -> Outcome<Self> {
        let params = manipulator.get().file.params();
        let usual = DriveOptions::first_tendon(params);
        let options = DriveOptions {
            least_tension_n: least_tension_n.unwrap_or(usual.least_tension_n),
            greatest_tension_n: greatest_tension_n.unwrap_or(usual.greatest_tension_n),
            hold_rad,
        };
        Self::of(manipulator.clone().unbind(), options)
    }

    /// Returns the shape for the tension at the base, N: a number for the first tendon, or a pair for both. With `friction="measured"`, `tension_n`
    /// contains the tension in each segment, (disks,) or (2, disks).
    #[pyo3(signature = (base_tension_n, *, friction="history", tension_n=None))]
    fn solve(
        &self,
        py: Python<'_>,
        base_tension_n: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = text)] friction: &str,
        tension_n: Option<&Bound<'_, PyAny>>,
    ) -> Outcome<Py<PyAny>> {
        let base_n = base_tensions(base_tension_n, &[])?;
        let way = Way::read(friction, tension_n, &[], self.disk_count())?;
        let mut rows = ShapeRows::default();
        let mut model = self.model.borrow()?;
        for base_n in base_n {
            rows.push(model.solve(base_n, way.of_row(0, self.disk_count())), &model);
        }
        rows.into_python(py, None, self.disk_count())
    }

    /// Runs as many steps as the array has rows; other threads run meanwhile.
    ///
    /// `base_tension_n` is (N,) or (N, 2), `tension_n` of `friction="measured"` (N, disks) or (N, 2, disks). If Ctrl-C ends the call, the model is
    /// unchanged.
    #[pyo3(
        signature = (base_tension_n, *, friction="history", tension_n=None, progress=None),
        text_signature = "(self, base_tension_n, *, friction='history', tension_n=None, progress=False)"
    )]
    fn run(
        &self,
        py: Python<'_>,
        base_tension_n: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = text)] friction: &str,
        tension_n: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Outcome<Py<PyAny>> {
        let base_n = base_tensions(base_tension_n, &[Axis::Rows])?;
        let disk_count = self.disk_count();
        let way = Way::read(friction, tension_n, &[Axis::Exactly(base_n.len())], disk_count)?;
        let mut rows = ShapeRows::default();
        self.work(py, progress, base_n.len(), |model, _, row| {
            let base_n = base_n.get(row).copied().unwrap_or([f64::NAN; 2]);
            let status = model.solve(base_n, way.of_row(row, disk_count));
            rows.push(status, model);
        })?;
        rows.into_python(py, Some(base_n.len()), disk_count)
    }

    /// Returns the tensions at the base that bring the manipulator to a bend, rad, or its tip to a position, base frame, m; pass one of them.
    ///
    /// The memory of the holes is unchanged: `solve`, with the tension that was then set or measured, advances it.
    #[pyo3(signature = (*, bend_rad=None, tip_m=None, friction="history"))]
    fn tension_for(
        &self,
        py: Python<'_>,
        bend_rad: Option<&Bound<'_, PyAny>>,
        tip_m: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = text)] friction: &str,
    ) -> Outcome<Py<PyAny>> {
        let (goals, friction) = (goals(bend_rad, tip_m, &[])?, goal_friction(friction)?);
        let mut rows = CommandRows::default();
        let mut model = self.model.borrow()?;
        for goal in goals {
            rows.push(&model.tension_for(goal, friction, &self.drive));
        }
        rows.into_python(py, None)
    }

    /// Returns the tensions at the base for a whole path: bends, (N,), or positions of the tip, (N, 2). Each goal starts from the result of the
    /// previous command. Other threads run meanwhile. If Ctrl-C ends the call, the model is unchanged.
    #[pyo3(
        signature = (*, bend_rad=None, tip_m=None, friction="history", progress=None),
        text_signature = "(self, *, bend_rad=None, tip_m=None, friction='history', progress=False)"
    )]
    fn follow(
        &self,
        py: Python<'_>,
        bend_rad: Option<&Bound<'_, PyAny>>,
        tip_m: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = text)] friction: &str,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Outcome<Py<PyAny>> {
        let (goals, friction) = (goals(bend_rad, tip_m, &[Axis::Rows])?, goal_friction(friction)?);
        let mut rows = CommandRows::default();
        self.work(py, progress, goals.len(), |model, drive, row| {
            let goal = goals.get(row).copied().unwrap_or(Goal::BendRad(f64::NAN));
            let command = model.tension_for(goal, friction, drive);
            rows.push(&command);
            // A fault of the shape is also one of the command.
            let _ = model.solve(command.base_tension_n, friction);
        })?;
        rows.into_python(py, Some(goals.len()))
    }

    /// Resets to the state after set-up: straight, without tension, with relaxed holes.
    fn reset(&self) -> Outcome {
        self.model.borrow()?.reset();
        Ok(())
    }

    /// Returns the present state.
    fn snapshot(&self) -> Outcome<StaticSnapshot> {
        Ok(StaticSnapshot { words: self.state_words()? })
    }

    /// Restores a snapshot of the same manipulator; the following steps have the same bits as after the snapshot.
    fn restore(&self, #[pyo3(from_py_with = frozen)] snapshot: &StaticSnapshot) -> Outcome {
        Ok(self.model.borrow()?.restore_words(&snapshot.words)?)
    }

    /// The manipulator.
    #[getter]
    fn manipulator(&self, py: Python<'_>) -> Py<Manipulator> {
        self.manipulator.clone_ref(py)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> Outcome<bool> {
        let Ok(other) = other.cast::<Self>() else { return Ok(false) };
        let other = other.get();
        let is_same_arm = self.manipulator.get().text == other.manipulator.get().text;
        Ok(is_same_arm && self.options == other.options && self.state_words()? == other.state_words()?)
    }

    fn __repr__(&self) -> String {
        let disks = counted(self.disk_count(), "disk");
        format!("<StaticModel of {:?}: {disks}>", self.manipulator.get().file.tables().name)
    }

    /// Pickles, and copies, the manipulator, the drive and the state; the copy continues with the same bits.
    #[expect(clippy::type_complexity, reason = "a tuple for Python")]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> Outcome<Reduced<'py, (String, Py<Manipulator>, [f64; 2], [f64; 2], f64, Vec<u64>)>> {
        let one = slf.get();
        let DriveOptions { least_tension_n, greatest_tension_n, hold_rad } = one.options;
        let manipulator = one.manipulator.clone_ref(slf.py());
        let state = (
            travel::VERSION.to_owned(),
            manipulator,
            least_tension_n,
            greatest_tension_n,
            hold_rad,
            one.state_words()?,
        );
        Ok((slf.getattr("_unpickled")?, state))
    }

    /// Creates the pickled model.
    #[staticmethod]
    fn _unpickled(
        version: &str,
        manipulator: Py<Manipulator>,
        least_tension_n: [f64; 2],
        greatest_tension_n: [f64; 2],
        hold_rad: f64,
        words: Vec<u64>,
    ) -> Outcome<Self> {
        travel::check_version(version)?;
        let one = Self::of(manipulator, DriveOptions { least_tension_n, greatest_tension_n, hold_rad })?;
        one.model.borrow()?.restore_words(&words)?;
        Ok(one)
    }
}

#[pymethods]
impl StaticSnapshot {
    fn __repr__(&self) -> String {
        format!("<StaticSnapshot: {}>", counted_words(&self.words, "disk"))
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
