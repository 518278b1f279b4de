//! Pickling of logs. A pickle contains the arrays, not the file they were read from: at the destination the file may be elsewhere or different, and a
//! log need not come from a file.

use std::path::PathBuf;

use fric_core::robot::file::FROM_LENGTHS;
use fric_lab::columns::SampleColumns;
use fric_work::replay::PoseResult;
use fric_work::source::About;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use super::Log;
use crate::arrays::{Axis, Wanted, integers, numbers};
use crate::errors::Outcome;
use crate::robot::Robot;
use crate::travel::Reduced;

/// Names of the cables, stamps, the other arrays in the order of `ARRAYS`, robot, files, and what was learned when they were read.
type Pickled<'py> =
    (Vec<String>, Py<PyArray1<i64>>, [Py<PyArray2<f64>>; ARRAYS.len()], Option<Py<Robot>>, Vec<PathBuf>, Learned);

/// Whether the signals are columns of rows; of computed poses, the number of rows with one and without one, and the error of the lengths, m.
type Learned = (bool, Option<(u64, u64, Option<f64>)>);

/// The arrays of numbers, and their numbers of columns; 0 means one per cable.
const ARRAYS: [(&str, usize); 8] = [
    ("sensor_force_n", 0),
    ("length_m", 0),
    ("speed_m_per_s", 0),
    ("reference_force_n", 0),
    ("position_m", 3),
    ("orientation_xyzw", 4),
    ("outside_force_n", 3),
    ("outside_torque_nm", 3),
];

#[pymethods]
impl Log {
    fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> Outcome<bool> {
        let Ok(other) = other.cast::<Self>() else { return Ok(false) };
        let other = other.get();
        // Compares bits, so that NaN equals NaN.
        let bits = |log: &Self| {
            log.with_rows(py, |rows| {
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
                let bits = columns.map(|column| column.iter().map(|number| number.to_bits()).collect::<Vec<u64>>());
                Ok((rows.stamp_nanos.to_vec(), bits))
            })
        };
        let robot = |log: &Self| log.robot.as_ref().map(|robot| robot.borrow(py).file.clone());
        let is_same = self.cable_names == other.cable_names && self.sources == other.sources;
        Ok(is_same && robot(self) == robot(other) && bits(self)? == bits(other)?)
    }

    /// Pickles, and copies, its arrays.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py, Pickled<'py>>> {
        let (py, log) = (slf.py(), slf.get());
        let arrays = [
            &log.sensor_force_n,
            &log.length_m,
            &log.speed_m_per_s,
            &log.reference_force_n,
            &log.position_m,
            &log.orientation_xyzw,
            &log.outside_force_n,
            &log.outside_torque_nm,
        ];
        let state = (
            log.cable_names.clone(),
            log.stamp_nanos.clone_ref(py),
            arrays.map(|array| array.clone_ref(py)),
            log.robot.as_ref().map(|robot| robot.clone_ref(py)),
            log.sources.clone(),
            (log.about.has_columns, log.about.poses.map(|poses| (poses.samples, poses.missing, poses.residual_rms_m))),
        );
        Ok((slf.getattr("_unpickled")?, state))
    }

    /// Creates the pickled log.
    #[staticmethod]
    fn _unpickled(
        py: Python<'_>,
        cable_names: Vec<String>,
        stamp_nanos: &Bound<'_, PyAny>,
        arrays: [Bound<'_, PyAny>; ARRAYS.len()],
        robot: Option<&Robot>,
        sources: Vec<PathBuf>,
        learned: Learned,
    ) -> Outcome<Self> {
        let entries = "an array of a pickle";
        let stamp_nanos = integers(&Wanted { name: "stamp_nanos", shape: &[Axis::Rows], entries }, stamp_nanos)?;
        let mut columns = Vec::with_capacity(ARRAYS.len());
        for ((name, width), array) in ARRAYS.iter().zip(&arrays) {
            let width = if *width == 0 { cable_names.len() } else { *width };
            let shape = [Axis::Exactly(stamp_nanos.len()), Axis::Exactly(width)];
            columns.push(numbers(&Wanted { name, shape: &shape, entries }, array)?);
        }
        let mut columns = columns.into_iter();
        let mut next = || columns.next().unwrap_or_default();
        let columns = SampleColumns {
            stamp_nanos,
            sensor_force_n: next(),
            length_m: next(),
            speed_m_per_s: next(),
            reference_force_n: next(),
            position_m: next(),
            orientation_xyzw: next(),
            outside_force_n: next(),
            outside_torque_nm: next(),
        };
        let names: Vec<&str> = cable_names.iter().map(String::as_str).collect();
        let (has_columns, poses) = learned;
        let poses = poses.map(|(samples, missing, residual_rms_m)| PoseResult {
            source: FROM_LENGTHS,
            samples,
            missing,
            residual_rms_m,
        });
        let log = Self::new(py, columns, &names, robot.cloned(), sources)?;
        Ok(Self { about: About { has_columns, poses, ..About::default() }, ..log })
    }
}
