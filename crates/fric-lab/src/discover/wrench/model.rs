//! A model of all cables and the numbers in it that a fit varies.

use fric_core::parameters::Values;

use super::geometry::{Changes, Geometry};
use crate::fit::Parameter;

/// A model of all cables.
#[derive(Clone, Debug)]
pub struct Model {
    /// Parameter values of each cable.
    pub values: Vec<Values>,
    /// Parameters that are varied for each cable separately.
    pub free: Vec<Vec<Parameter>>,
    /// Parameters that are varied with one value for all cables.
    pub alike: Vec<Parameter>,
    /// Corrections of the robot file.
    pub changes: Changes,
}

/// A number that a fit varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// A parameter of one cable.
    Own(usize, Parameter),
    /// A parameter with one value for all cables.
    Alike(Parameter),
    /// One of a geometry's numbers.
    Geometry(Geometry, usize),
}

impl Model {
    /// Returns the numbers that are varied, in the order of the columns.
    pub fn unknowns(&self) -> Vec<Unknown> {
        let own =
            self.free.iter().enumerate().flat_map(|(cable, free)| free.iter().map(move |of| Unknown::Own(cable, *of)));
        let alike = self.alike.iter().copied().map(Unknown::Alike);
        let of_geometry =
            self.changes.iter().flat_map(|(of, numbers)| (0..numbers.len()).map(|place| Unknown::Geometry(*of, place)));
        own.chain(alike).chain(of_geometry).collect()
    }

    /// Returns the value of a number.
    pub(super) fn number(&self, unknown: &Unknown) -> f64 {
        let value = |cable: usize, of: &Parameter| self.values.get(cable).map_or(f64::NAN, |values| values[of.place()]);
        match unknown {
            Unknown::Own(cable, of) => value(*cable, of),
            Unknown::Alike(of) => value(0, of),
            Unknown::Geometry(of, place) => {
                self.changes.get(of).and_then(|numbers| numbers.get(*place)).copied().unwrap_or(0.0)
            }
        }
    }

    /// Returns the model with other numbers, in the order of the unknowns.
    pub(super) fn moved(&self, numbers: &[f64]) -> Self {
        let mut moved = self.clone();
        for (unknown, number) in self.unknowns().iter().zip(numbers) {
            match unknown {
                Unknown::Own(cable, of) => {
                    moved.values.iter_mut().skip(*cable).take(1).for_each(|values| values[of.place()] = *number);
                }
                Unknown::Alike(of) => moved.values.iter_mut().for_each(|values| values[of.place()] = *number),
                Unknown::Geometry(of, place) => {
                    if let Some(entry) = moved.changes.get_mut(of).and_then(|numbers| numbers.get_mut(*place)) {
                        *entry = *number;
                    }
                }
            }
        }
        moved
    }
}
