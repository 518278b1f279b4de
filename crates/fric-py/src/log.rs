//! `Log`: the samples of a log as arrays; `read_log`.

mod pickling;

use std::path::PathBuf;
use std::sync::Arc;

use fric_core::Pose;
use fric_core::robot::unknown_name;
use fric_lab::columns::{SampleColumns, SampleRows};
use fric_log::cycle_warning;
use fric_log::log::Log as LogSource;
use fric_log::robot::{AttachedRobot, ROBOT_FILE};
use fric_log::signals::{LengthWindow, Role, SignalPaths, SignalReader, StatedSignals};
use fric_work::replay::PoseResult;
use fric_work::source::{About, RowSource, read as read_samples, read_and_warn};
use fric_work::verdict::counted;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyKeyError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyIterator, PySlice, PyTuple};

use crate::arguments::{argument, refused};
use crate::arrays::{Axis, Wanted, fixed, fixed_rows, numbers, stamps_nanos};
use crate::errors::{Fault, Outcome, legible};
use crate::robot::{Robot, cables_in_words};
use crate::watch::Watch;

/// The samples of a log, joined on the times of the cable signal: read-only arrays with one row per sample.
///
/// Columns of cable arrays are the cables in the order of `cable_names`. Unknown values are NaN. `log[2.0:8.5]` is the part between two times, s since
/// the first row, which are 0 or more; `log[log.time_s[-1] - 1.0:]` is the last second. `len(log)` is the number of rows; `"position_m" in log` says whether a signal is known, and iteration gives the names of the known ones.
///
/// >>> import numpy as np
/// >>> log = Log.from_arrays(
/// ...     cable_names=["winch"],
/// ...     stamp_nanos=np.arange(3) * 1_000_000,
/// ...     sensor_force_n=np.full((3, 1), 20.0),
/// ...     length_m=np.array([[0.0], [0.001], [0.002]]),
/// ... )
/// >>> log.speed_m_per_s[:, 0]
/// array([1., 1., 1.])
#[pyclass(module = "fric", frozen)]
pub struct Log {
    /// Time, ns since 1970.
    #[pyo3(get)]
    stamp_nanos: Py<PyArray1<i64>>,
    /// Time since the first row, s.
    #[pyo3(get)]
    time_s: Py<PyArray1<f64>>,
    /// Force shown by the sensor, N, one column per cable.
    #[pyo3(get)]
    sensor_force_n: Py<PyArray2<f64>>,
    /// Cable length, m, which grows when the cable pays out.
    #[pyo3(get)]
    length_m: Py<PyArray2<f64>>,
    /// Rate of the length, m/s.
    #[pyo3(get)]
    speed_m_per_s: Py<PyArray2<f64>>,
    /// Cable force measured at the platform, N; NaN if there is none.
    #[pyo3(get)]
    reference_force_n: Py<PyArray2<f64>>,
    /// Position of the platform in the base frame, m, (N, 3); NaN if it is unknown.
    #[pyo3(get)]
    position_m: Py<PyArray2<f64>>,
    /// Orientation of the platform as a unit quaternion x, y, z, w, (N, 4); NaN if it is unknown.
    #[pyo3(get)]
    orientation_xyzw: Py<PyArray2<f64>>,
    /// External force on the platform including gravity, N, (N, 3); NaN if it is unknown.
    #[pyo3(get)]
    outside_force_n: Py<PyArray2<f64>>,
    /// External torque on the platform about its origin, N m, (N, 3); NaN if it is unknown.
    #[pyo3(get)]
    outside_torque_nm: Py<PyArray2<f64>>,
    /// The robot: the one that the log was read for, else the one attached to the log; None for arrays.
    #[pyo3(get)]
    robot: Option<Py<Robot>>,
    cable_names: Vec<String>,
    /// Shared by all parts of one log.
    origin: Arc<()>,
    /// What was learned when it was read.
    about: About,
    /// The files that it was read from, which no output may overwrite.
    pub sources: Vec<PathBuf>,
}

#[pymethods]
impl Log {
    /// A log from arrays, which are copied and checked.
    ///
    /// `stamp_nanos` must ascend; it may be of dates (datetime64). Without `speed_m_per_s` the speed is derived from the length, as for a log file without speed. A row without
    /// reference, pose or wrench is NaN; a pose or wrench must be complete or absent.
    #[staticmethod]
    #[pyo3(signature = (*, cable_names, stamp_nanos, sensor_force_n, length_m, speed_m_per_s=None, reference_force_n=None, position_m=None, orientation_xyzw=None, outside_force_n=None, outside_torque_nm=None))]
    fn from_arrays(
        py: Python<'_>,
        #[pyo3(from_py_with = argument)] cable_names: Vec<String>,
        stamp_nanos: &Bound<'_, PyAny>,
        sensor_force_n: &Bound<'_, PyAny>,
        length_m: &Bound<'_, PyAny>,
        speed_m_per_s: Option<&Bound<'_, PyAny>>,
        reference_force_n: Option<&Bound<'_, PyAny>>,
        position_m: Option<&Bound<'_, PyAny>>,
        orientation_xyzw: Option<&Bound<'_, PyAny>>,
        outside_force_n: Option<&Bound<'_, PyAny>>,
        outside_torque_nm: Option<&Bound<'_, PyAny>>,
    ) -> Outcome<Self> {
        check_names(&cable_names)?;
        let stamp_nanos = ascending(stamp_nanos)?;
        let (row_count, cable_count) = (stamp_nanos.len(), cable_names.len());
        let read = |name, width, entries, value: Option<&Bound<'_, PyAny>>| {
            let shape = [Axis::Exactly(row_count), Axis::Exactly(width)];
            let unknown = || Ok(vec![f64::NAN; row_count * width]);
            value.map_or_else(unknown, |value| numbers(&Wanted { name, shape: &shape, entries }, value))
        };
        let of_cables = |name, value| read(name, cable_count, "a row per stamp, a column per cable", value);
        let of_axes = |name, value| read(name, 3, "a row per stamp: x, y, z", value);
        let length_m = of_cables("length_m", Some(length_m))?;
        let speed_m_per_s = match speed_m_per_s {
            Some(speed_m_per_s) => of_cables("speed_m_per_s", Some(speed_m_per_s))?,
            None => derived_speed_m_per_s(&stamp_nanos, &length_m, cable_count),
        };
        let mut columns = SampleColumns {
            sensor_force_n: of_cables("sensor_force_n", Some(sensor_force_n))?,
            length_m,
            speed_m_per_s,
            reference_force_n: of_cables("reference_force_n", reference_force_n)?,
            position_m: of_axes("position_m", position_m)?,
            orientation_xyzw: read("orientation_xyzw", 4, "a row per stamp: x, y, z, w", orientation_xyzw)?,
            outside_force_n: of_axes("outside_force_n", outside_force_n)?,
            outside_torque_nm: of_axes("outside_torque_nm", outside_torque_nm)?,
            stamp_nanos,
        };
        check_poses(&mut columns)?;
        check_wrenches(&columns)?;
        let names: Vec<&str> = cable_names.iter().map(String::as_str).collect();
        warn(py, &too_great(&columns, &names))?;
        Self::new(py, columns, &names, None, Vec::new())
    }

    /// Names of the cables in the order of the columns.
    #[getter]
    fn cable_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.cable_names)
    }

    /// The log as a polars data frame, with one column per cable and coordinate; needs polars.
    fn to_polars<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("fric._frames")?.call_method1("frame", (slf, "polars"))
    }

    /// The log as a pandas data frame, with one column per cable and coordinate; needs pandas.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("fric._frames")?.call_method1("frame", (slf, "pandas"))
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.stamp_nanos.bind(py).len()
    }

    /// The part between two times, s since the first row, the second one excluded; or the array of a signal.
    ///
    /// The rows are those of the whole log: a derived speed is unchanged.
    fn __getitem__<'py>(slf: &Bound<'py, Self>, key: &Bound<'py, PyAny>) -> Outcome<Bound<'py, PyAny>> {
        let (py, log) = (slf.py(), slf.get());
        if let Ok(slice) = key.cast::<PySlice>() {
            return Ok(Bound::new(py, log.part(py, slice)?)?.into_any());
        }
        let Ok(name) = key.extract::<String>() else {
            let class = key.get_type();
            return Err(PyTypeError::new_err(format!(
                "a log is cut by seconds, log[2.0:8.5], or asked for a signal, log[\"length_m\"], not by {class}"
            ))
            .into());
        };
        match SIGNALS.iter().find(|signal| **signal == name) {
            Some(signal) => Ok(slf.getattr(*signal)?),
            None => Err(PyKeyError::new_err(unknown_name("signal", &name, SIGNALS.into_iter())).into()),
        }
    }

    /// The log as a table of its cables, for notebooks.
    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("fric._frames")?.call_method1("table", (slf,))
    }

    /// Whether the log has a signal of this name.
    fn __contains__(&self, py: Python<'_>, name: &Bound<'_, PyAny>) -> Outcome<bool> {
        let signals = self.signals(py)?;
        Ok(name.extract::<&str>().is_ok_and(|name| signals.contains(&name)))
    }

    /// The names of the signals that are known at any time of the log.
    fn __iter__<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyIterator>> {
        Ok(PyTuple::new(py, self.signals(py)?)?.try_iter()?)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<Log: {}, {}>", counted(self.__len__(py)?, "row"), cables_in_words(&self.cable_names)))
    }
}

/// The possible signals of a log, by the names of their arrays.
const SIGNALS: [&str; 8] = [
    "sensor_force_n",
    "length_m",
    "speed_m_per_s",
    "reference_force_n",
    "position_m",
    "orientation_xyzw",
    "outside_force_n",
    "outside_torque_nm",
];

impl Log {
    /// Returns the signals with any known value.
    fn signals(&self, py: Python<'_>) -> Outcome<Vec<&'static str>> {
        self.with_rows(py, |rows| {
            let columns = [
                rows.sensor_force_n,
                rows.length_m,
                rows.speed_m_per_s,
                rows.reference_force_n,
                rows.position_m,
                rows.orientation_xyzw,
                rows.outside_force_n,
                rows.outside_torque_nm,
            ];
            let is_known = |column: &[f64]| column.iter().any(|number| !number.is_nan());
            let known = SIGNALS.into_iter().zip(columns).filter(|(_, column)| is_known(column));
            Ok(known.map(|(name, _)| name).collect())
        })
    }

    /// Returns the rows from one time up to another.
    fn part(&self, py: Python<'_>, slice: &Bound<'_, PySlice>) -> Outcome<Self> {
        let bound = |name: &str| {
            let value = slice.getattr(name)?;
            let refused = |_| refused(name, "a number or None, as a log is cut by seconds", &value);
            if value.is_none() {
                return Ok(None);
            }
            let time_s: f64 = value.extract().map_err(refused)?;
            // A negative number would be a time before the first row here, and one before the end for lists.
            if time_s < 0.0 || time_s.is_nan() {
                let text = format!(
                    "a log is cut by seconds from its first row, 0 or more, not by {time_s}; its last second is"
                );
                return Err(Fault::config(format!("{text} log[log.time_s[-1] - 1.0:]")));
            }
            Ok(Some(time_s))
        };
        let step = slice.getattr("step")?;
        if !step.is_none() {
            return Err(refused("step", "None, as a log is cut without a step: log[2.0:8.5]", &step));
        }
        let (start_s, end_s) = (bound("start")?, bound("stop")?);
        let times = self.time_s.bind(py).readonly();
        let is_within =
            |time_s: f64| start_s.is_none_or(|start_s| time_s >= start_s) && end_s.is_none_or(|end_s| time_s < end_s);
        let times_s = times.as_slice()?;
        let start = times_s.iter().position(|time_s| is_within(*time_s)).unwrap_or(times_s.len());
        let within = times_s.iter().skip(start).take_while(|time_s| end_s.is_none_or(|end_s| **time_s < end_s));
        let columns = self.with_rows(py, |rows| Ok(rows.copied(start..start + within.count())))?;
        let names: Vec<&str> = self.cable_names.iter().map(String::as_str).collect();
        let robot = self.robot.as_ref().map(|robot| robot.borrow(py).clone());
        let (rows, missing) = (columns.stamp_nanos.len() as u64, poseless_count(&columns));
        let poses = self.about.poses.map(|poses| poses.of_part(rows, missing));
        let part = Self::new(py, columns, &names, robot, self.sources.clone())?;
        Ok(Self { origin: Arc::clone(&self.origin), about: About { poses, ..self.about.clone() }, ..part })
    }

    /// Whether both are one log or parts of one.
    pub fn shares_origin(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.origin, &other.origin)
    }

    /// Returns the first and the last stamp, ns; `None` without rows.
    pub fn stamps_nanos(&self, py: Python<'_>) -> Outcome<Option<(i64, i64)>> {
        self.with_rows(py, |rows| Ok(rows.stamp_nanos.first().copied().zip(rows.stamp_nanos.last().copied())))
    }

    /// Creates a log for Python, without copying the samples.
    pub fn new(
        py: Python<'_>,
        columns: SampleColumns,
        cable_names: &[&str],
        robot: Option<Robot>,
        sources: Vec<PathBuf>,
    ) -> Outcome<Self> {
        let cable_count = cable_names.len();
        Ok(Self {
            time_s: fixed(py, columns.time_s()),
            stamp_nanos: fixed(py, columns.stamp_nanos),
            sensor_force_n: fixed_rows(py, columns.sensor_force_n, cable_count)?,
            length_m: fixed_rows(py, columns.length_m, cable_count)?,
            speed_m_per_s: fixed_rows(py, columns.speed_m_per_s, cable_count)?,
            reference_force_n: fixed_rows(py, columns.reference_force_n, cable_count)?,
            position_m: fixed_rows(py, columns.position_m, 3)?,
            orientation_xyzw: fixed_rows(py, columns.orientation_xyzw, 4)?,
            outside_force_n: fixed_rows(py, columns.outside_force_n, 3)?,
            outside_torque_nm: fixed_rows(py, columns.outside_torque_nm, 3)?,
            robot: robot.map(|robot| Py::new(py, robot)).transpose()?,
            cable_names: cable_names.iter().map(|name| (*name).to_owned()).collect(),
            origin: Arc::new(()),
            about: About::default(),
            sources,
        })
    }

    /// Lends the samples to `work`, one after the other.
    pub fn with_source<T>(&self, py: Python<'_>, work: impl FnOnce(&mut RowSource<'_>) -> Outcome<T>) -> Outcome<T> {
        self.with_rows(py, |rows| work(&mut RowSource::new(rows, &self.about)))
    }

    /// Lends the samples to `work`.
    pub fn with_rows<T>(&self, py: Python<'_>, work: impl FnOnce(SampleRows<'_>) -> Outcome<T>) -> Outcome<T> {
        let stamp_nanos = self.stamp_nanos.bind(py).readonly();
        let [sensor, length, speed, reference, position, orientation, force, torque] = [
            &self.sensor_force_n,
            &self.length_m,
            &self.speed_m_per_s,
            &self.reference_force_n,
            &self.position_m,
            &self.orientation_xyzw,
            &self.outside_force_n,
            &self.outside_torque_nm,
        ]
        .map(|array| array.bind(py).readonly());
        work(SampleRows {
            stamp_nanos: stamp_nanos.as_slice()?,
            sensor_force_n: sensor.as_slice()?,
            length_m: length.as_slice()?,
            speed_m_per_s: speed.as_slice()?,
            reference_force_n: reference.as_slice()?,
            position_m: position.as_slice()?,
            orientation_xyzw: orientation.as_slice()?,
            outside_force_n: force.as_slice()?,
            outside_torque_nm: torque.as_slice()?,
        })
    }

    /// Returns a log of arrays with the signals that a robot's file states in place of measured ones; `None` if there are none, or if the log was read:
    /// it has those of the robot that it was read for.
    fn with_stated(
        &self,
        py: Python<'_>,
        robot: &Robot,
        unread: Option<Role>,
        watch: &mut Watch<'_>,
    ) -> Outcome<Option<Self>> {
        let mut paths = SignalPaths::of_robot(&robot.file)?;
        if let Some(unread) = unread {
            paths = paths.with(unread, None);
        }
        let stated = StatedSignals::of(&paths).filter(|_| self.robot.is_none());
        let Some(mut stated) = stated else { return Ok(None) };
        let mut columns = SampleColumns::default();
        let all = |source: &mut RowSource<'_>| {
            read_samples(source, watch, |sample| {
                stated.push(sample);
                while let Some(sample) = stated.next_sample() {
                    columns.push(&sample);
                }
                Ok(())
            })
        };
        self.with_source(py, all)??;
        stated.end();
        while let Some(sample) = stated.next_sample() {
            columns.push(&sample);
        }
        let poses = stated.length_poses();
        warn(py, &poses.map_or_else(Vec::new, |poses| poses.warnings()))?;
        let about = About { poses: poses.as_ref().map(PoseResult::of), ..About::default() };
        let names: Vec<&str> = self.cable_names.iter().map(String::as_str).collect();
        let stated = Self::new(py, columns, &names, None, self.sources.clone())?;
        Ok(Some(Self { origin: Arc::clone(&self.origin), about, ..stated }))
    }

    /// Returns a warning if the log was read with other stated signals than a robot's file has.
    fn read_otherwise(&self, py: Python<'_>, robot: &Robot) -> Vec<String> {
        let stated = |of: &Robot| {
            let log = &of.file.options().log;
            (of.file.params().known_reference(), log.pose_is_from_lengths(), log.speed_is_from_lengths())
        };
        let is_other = |own: &Py<Robot>| stated(&own.borrow(py)) != stated(robot);
        let warning = "the log was read with another known `reference`, `pose` or `speed` under `[log]` than this robot has, and its signals stay as they were \
                       read; read it again with `robot` for its own";
        self.robot.as_ref().filter(|own| is_other(own)).map(|_| warning.to_owned()).into_iter().collect()
    }

    /// Returns a warning if the stamps of a log of arrays differ from a robot's cycle; that of a log that was read is given when it is read.
    fn cycle_warning(&self, py: Python<'_>, robot: &Robot) -> Outcome<Option<String>> {
        if self.robot.is_some() {
            return Ok(None);
        }
        let mut intervals_nanos: Vec<i64> = self.with_rows(py, |rows| {
            let stamps = rows.stamp_nanos;
            Ok(stamps.iter().zip(stamps.iter().skip(1)).map(|(one, next)| next.saturating_sub(*one)).collect())
        })?;
        let middle = intervals_nanos.len() / 2;
        if intervals_nanos.is_empty() {
            return Ok(None);
        }
        #[expect(clippy::cast_precision_loss, reason = "an interval of samples")]
        let usual_nanos = *intervals_nanos.select_nth_unstable(middle).1 as f64;
        Ok(cycle_warning(usual_nanos, &robot.file))
    }

    /// Checks that the columns are a robot's cables, and that there are rows.
    fn check_usable(&self, py: Python<'_>, names: &[&str]) -> Outcome {
        if self.cable_names == names {
            let advice = "check its file, or the times by which it was cut";
            return match self.__len__(py)? {
                0 => Err(Fault::log(format!("the log has no rows: {advice}"))),
                _ => Ok(()),
            };
        }
        let (found, expected) = (self.cable_names.join(", "), names.join(", "));
        Err(Fault::shape(format!("the log has the cables {found}, the robot {expected}; they must be the same")))
    }
}

/// Reads an MCAP or CSV log, or the files of one split recording, for a robot: the given one, else the one attached to the log.
///
/// Unusual content of the log is reported as LogWarning. Samples are joined on the times of the cable signal; a missing speed is derived from the
/// length.
///
/// >>> log = read_log("examples/mini-ipanema.mcap")
/// >>> len(log), log.robot
/// (50000, <Robot "mini-ipanema": 8 cables, cycle 0.001 s>)
/// >>> log.cable_names[:2], log.length_m.shape
/// (('cable1', 'cable2'), (50000, 8))
#[pyfunction]
#[pyo3(
    signature = (paths, robot=None, *, progress=None),
    text_signature = "(paths, robot=None, *, progress=False)"
)]
pub fn read_log(
    py: Python<'_>,
    paths: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = argument)] robot: Option<Bound<'_, Robot>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> Outcome<Log> {
    read(py, "paths", paths, robot.as_ref(), None, &mut Watch::new(py, progress)?)
}

/// Returns the log of an argument for a robot: one that was read, one of arrays with what the robot's file states, or the log at its paths; see [`read`].
pub fn of<'py>(
    item: &Bound<'py, PyAny>,
    robot: &Bound<'py, Robot>,
    unread: Option<Role>,
    watch: &mut Watch<'_>,
) -> Outcome<Bound<'py, Log>> {
    let py = robot.py();
    let log = match item.cast::<Log>() {
        Ok(log) => log.clone(),
        Err(_) => Bound::new(py, read(py, "log", item, Some(robot), unread, watch)?)?,
    };
    let robot = robot.borrow();
    log.get().check_usable(py, &robot.file.cable_names())?;
    warn(py, &log.get().read_otherwise(py, &robot))?;
    warn(py, log.get().cycle_warning(py, &robot)?.as_slice())?;
    log.get().with_stated(py, &robot, unread, watch)?.map_or(Ok(log), |log| Ok(Bound::new(py, log)?))
}

/// Does the same as [`read_log`] for the paths of an argument, as a part of a longer call: for a fit, without the signal that it does not use, and without warnings that the fit
/// gives itself.
fn read(
    py: Python<'_>,
    argument: &str,
    paths: &Bound<'_, PyAny>,
    robot: Option<&Bound<'_, Robot>>,
    unread: Option<Role>,
    watch: &mut Watch<'_>,
) -> Outcome<Log> {
    let sources: Vec<PathBuf> = match paths.extract() {
        Ok(path) => vec![path],
        Err(_) => paths.extract().map_err(|_| refused(argument, "a path or a list of paths", paths))?,
    };
    let source = py.detach(|| LogSource::open(&sources))?;
    let robot = match robot {
        Some(robot) => robot.borrow().clone(),
        None => AttachedRobot::find(&source)?
            .map(|attached| Robot::new(attached.robot, attached.text))
            .ok_or_else(|| Fault::log(format!("the log has no robot file attached ({ROBOT_FILE}); give its robot")))?,
    };
    let file = robot.file.clone();
    let names = file.cable_names();
    let mut paths = SignalPaths::of_robot(&file)?;
    if let Some(unread) = unread {
        paths = paths.with(unread, None);
    }
    let mut columns = SampleColumns::default();
    let about = read_and_warn(&mut SignalReader::new(source, paths, &names), &file, watch, |sample| {
        columns.push(sample);
        Ok(())
    })?;
    match unread {
        Some(_) => warn(py, about.cycle.as_slice())?,
        None => warn(py, &about.robot)?,
    }
    warn(py, &too_great(&columns, &names))?;
    let log = Log::new(py, columns, &names, Some(robot), sources)?;
    Ok(Log { about, ..log })
}

/// The magnitude from which the sum of the squares of a log's numbers may overflow.
const TOO_GREAT: f64 = 1e145;

/// Returns a warning for each signal of a cable with numbers that no sums of squares can hold.
fn too_great(columns: &SampleColumns, names: &[&str]) -> Vec<String> {
    let signals = [
        ("sensor_force_n", &columns.sensor_force_n),
        ("length_m", &columns.length_m),
        ("speed_m_per_s", &columns.speed_m_per_s),
        ("reference_force_n", &columns.reference_force_n),
    ];
    let of_cable = |signal: &str, numbers: &[f64], cable: usize, name: &str| {
        let of_cable = numbers.iter().skip(cable).step_by(names.len());
        let is_too_great = |number: &f64| number.is_finite() && number.abs() > TOO_GREAT;
        let (row, number) = of_cable.enumerate().find(|(_, number)| is_too_great(number))?;
        Some(format!(
            "`{signal}` of {name} is {number:e} in row {row}, which no cable has: errors that contain it are infinite; make it NaN, a gap"
        ))
    };
    let of_signal = |(signal, numbers): (&'static str, &Vec<f64>)| {
        let warnings = names.iter().enumerate().map(|(cable, name)| of_cable(signal, numbers, cable, name));
        warnings.collect::<Vec<_>>()
    };
    signals.into_iter().flat_map(of_signal).flatten().collect()
}

/// Issues warnings.
pub fn warn(py: Python<'_>, texts: &[String]) -> Outcome {
    for text in texts {
        let category = py.import("fric._errors")?.getattr("LogWarning")?;
        py.import("warnings")?.call_method1("warn", (legible(text.clone()), category))?;
    }
    Ok(())
}

fn check_names(names: &[String]) -> Outcome {
    let is_repeated = |(place, name)| names.iter().take(place).any(|other| other == name);
    match names.iter().enumerate().find(|place| is_repeated(*place)) {
        Some((_, name)) => Err(Fault::shape(format!("`cable_names` has {name:?} twice; names must differ"))),
        None if names.is_empty() => Err(Fault::shape("`cable_names` is empty; name at least one cable")),
        None => Ok(()),
    }
}

fn ascending(stamp_nanos: &Bound<'_, PyAny>) -> Outcome<Vec<i64>> {
    let wanted = Wanted { name: "stamp_nanos", shape: &[Axis::Rows], entries: "nanoseconds since 1970, or datetime64" };
    let stamps = stamps_nanos(&wanted, stamp_nanos)?;
    match stamps.iter().zip(stamps.iter().skip(1)).position(|(one, next)| next <= one) {
        None => Ok(stamps),
        Some(row) => Err(Fault::shape(format!("`stamp_nanos` does not ascend from row {row} to row {}", row + 1))),
    }
}

/// Returns derived speeds, as for a log file without speed.
fn derived_speed_m_per_s(stamp_nanos: &[i64], length_m: &[f64], cable_count: usize) -> Vec<f64> {
    let mut speed_m_per_s = vec![f64::NAN; length_m.len()];
    for cable in 0..cable_count {
        let of_cable = || length_m.iter().skip(cable).step_by(cable_count);
        let mut window = LengthWindow::default();
        stamp_nanos.iter().zip(of_cable()).for_each(|(stamp_nanos, length_m)| window.push(*stamp_nanos, *length_m));
        let speeds = speed_m_per_s.iter_mut().skip(cable).step_by(cable_count);
        for (speed_m_per_s, _) in speeds.zip(of_cable()).filter(|(_, length_m)| length_m.is_finite()) {
            *speed_m_per_s = window.speed_m_per_s();
            window.advance();
        }
    }
    speed_m_per_s
}

/// Returns the number of rows without a pose.
fn poseless_count(columns: &SampleColumns) -> u64 {
    columns.position_m.chunks_exact(3).filter(|position_m| position_m.iter().any(|it| it.is_nan())).count() as u64
}

/// Normalises the quaternions. An invalid pose is refused unless all of it is NaN.
fn check_poses(columns: &mut SampleColumns) -> Outcome {
    let rows = columns.position_m.chunks_exact(3).zip(columns.orientation_xyzw.chunks_exact_mut(4));
    for (row, (position_m, orientation_xyzw)) in rows.enumerate() {
        if position_m.iter().chain(orientation_xyzw.iter()).all(|number| number.is_nan()) {
            continue;
        }
        let parts = position_m.try_into().ok().zip((&*orientation_xyzw).try_into().ok());
        let pose = parts.and_then(|(position_m, orientation_xyzw)| Pose::from_parts(position_m, orientation_xyzw));
        let Some(pose) = pose else {
            return Err(Fault::shape(format!(
                "`position_m` {position_m:?} and `orientation_xyzw` {orientation_xyzw:?} in row {row} are no pose: all \
                 numbers must be finite and the quaternion near norm 1, or all must be NaN where the pose is not known"
            )));
        };
        orientation_xyzw.copy_from_slice(pose.orientation.coords.as_slice());
    }
    Ok(())
}

/// Refuses partially known wrenches.
fn check_wrenches(columns: &SampleColumns) -> Outcome {
    let rows = columns.outside_force_n.chunks_exact(3).zip(columns.outside_torque_nm.chunks_exact(3));
    for (row, (force_n, torque_nm)) in rows.enumerate() {
        let known = force_n.iter().chain(torque_nm).filter(|number| number.is_finite()).count();
        let unknown = force_n.iter().chain(torque_nm).filter(|number| number.is_nan()).count();
        if known != 6 && unknown != 6 {
            return Err(Fault::shape(format!(
                "`outside_force_n` {force_n:?} and `outside_torque_nm` {torque_nm:?} in row {row} are no wrench: all \
                 numbers must be finite, or all NaN where the wrench is not known"
            )));
        }
    }
    Ok(())
}
