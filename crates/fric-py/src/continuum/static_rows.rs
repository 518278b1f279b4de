//! Shapes and commands of a static model as arrays, with one row per step or a single row.

use fric_tendon::{AnyStaticModel, Command, ShapeStatus, Tendon};
use pyo3::prelude::*;

use crate::arrays::array;
use crate::errors::Outcome;
use crate::results;

/// Shapes, quantity by quantity.
#[derive(Default)]
pub struct ShapeRows {
    disk_position_m: Vec<f64>,
    segment_bend_rad: Vec<f64>,
    bend_rad: Vec<f64>,
    tension_n: Vec<f64>,
    friction_n: Vec<f64>,
    bound_n: Vec<f64>,
    status: Vec<u32>,
    is_new: Vec<bool>,
}

impl ShapeRows {
    /// Adds the shape of a model after a solution.
    pub fn push(&mut self, status: ShapeStatus, model: &AnyStaticModel) {
        self.disk_position_m.extend(model.disk_position_m().as_flattened());
        self.segment_bend_rad.extend(model.segment_bend_rad());
        self.bend_rad.push(model.bend_rad());
        for tendon in Tendon::BOTH {
            self.tension_n.extend(model.tension_n(tendon));
            self.friction_n.extend(model.friction_n(tendon));
            self.bound_n.extend(model.bound_n(tendon));
        }
        self.status.push(status.bits());
        self.is_new.push(status.has_shape());
    }

    /// Returns a `Shape`, with a single row if `row_count` is `None`.
    pub fn into_python(self, py: Python<'_>, row_count: Option<usize>, disk_count: usize) -> Outcome<Py<PyAny>> {
        let shape = |widths: &[usize]| row_count.iter().chain(widths).copied().collect::<Vec<_>>();
        let of_both = shape(&[2, disk_count]);
        let fields = (
            array(py, self.disk_position_m, &shape(&[disk_count, 2]))?,
            array(py, self.segment_bend_rad, &shape(&[disk_count]))?,
            array(py, self.bend_rad, &shape(&[]))?,
            array(py, self.tension_n, &of_both)?,
            array(py, self.friction_n, &of_both)?,
            array(py, self.bound_n, &of_both)?,
            array(py, self.status, &shape(&[]))?,
            array(py, self.is_new, &shape(&[]))?,
        );
        Ok(results::new(py, "Shape", fields)?.unbind())
    }
}

/// Commands, quantity by quantity.
#[derive(Default)]
pub struct CommandRows {
    base_tension_n: Vec<f64>,
    bend_rad: Vec<f64>,
    tip_m: Vec<f64>,
    status: Vec<u32>,
    is_reached: Vec<bool>,
}

impl CommandRows {
    /// Adds a command.
    pub fn push(&mut self, command: &Command) {
        self.base_tension_n.extend(command.base_tension_n);
        self.bend_rad.push(command.bend_rad);
        self.tip_m.extend(command.tip_m);
        self.status.push(command.status.bits());
        self.is_reached.push(command.status.is_reached());
    }

    /// Returns a `Command`, with a single row if `row_count` is `None`.
    pub fn into_python(self, py: Python<'_>, row_count: Option<usize>) -> Outcome<Py<PyAny>> {
        let shape = |widths: &[usize]| row_count.iter().chain(widths).copied().collect::<Vec<_>>();
        let fields = (
            array(py, self.base_tension_n, &shape(&[2]))?,
            array(py, self.bend_rad, &shape(&[]))?,
            array(py, self.tip_m, &shape(&[2]))?,
            array(py, self.status, &shape(&[]))?,
            array(py, self.is_reached, &shape(&[]))?,
        );
        Ok(results::new(py, "Command", fields)?.unbind())
    }
}
