//! What a fit gives.

use fric_core::parameters::Values;
use nalgebra::DMatrix;

use crate::replay::{Deviation, WrenchErrors, WrenchReference};
use crate::samples::selection::SampleCounts;
use crate::search::optimizer::Termination;
use crate::search::vector::Parameter;

/// Errors of a cable's force at the platform.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceErrors {
    /// The reference itself, N.
    pub reference_n: Deviation,
    /// Frictionless force less reference, N.
    pub before_n: Deviation,
    /// Compensated force less reference, N.
    pub after_n: Deviation,
}

/// A combination of parameters that the samples leave open: changed together, by these steps, they do the same.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenCombination {
    /// What changes.
    pub parts: Vec<OpenPart>,
}

/// A parameter in a combination.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenPart {
    /// Which cable of the robot.
    pub cable: usize,
    /// Which parameter.
    pub parameter: Parameter,
    /// Its part of a step of 1.96 standard errors, in its unit; not finite for one that has no effect at all.
    pub step: f64,
}

/// One cable's parameters, and how sure they are.
#[derive(Clone, Debug)]
pub struct CableFit {
    /// Samples by what was done with them.
    pub samples: SampleCounts,
    /// All parameters, the fitted ones and the others.
    pub values: Values,
    /// What was fitted, in the order of the covariance.
    pub fitted: Vec<Parameter>,
    /// What the samples do not determine; `values` holds what was given.
    pub undetermined: Vec<Parameter>,
    /// For each of these the combination that the samples leave open, its own part first.
    pub open: Vec<OpenCombination>,
    /// What the samples would have beyond the end of its range that `values` holds.
    pub at_bound: Vec<Parameter>,
    /// Covariance of the fitted parameters, in their units.
    pub covariance: DMatrix<f64>,
    /// Why the search has ended.
    pub termination: Termination,
    /// How often the model was evaluated with its derivatives.
    pub evaluation_count: usize,
    /// Errors against the reference, where there is one.
    pub errors: ForceErrors,
}

/// What a fit to the wrench gives.
#[derive(Clone, Debug)]
pub struct WrenchFit {
    /// The cables in the robot's order.
    pub cables: Vec<CableFit>,
    /// What the forces were compared with.
    pub reference: WrenchReference,
    /// Wrench by the frictionless forces less the outside wrench, over every sample where that is known.
    pub before: WrenchErrors,
    /// The same by the compensated forces.
    pub after: WrenchErrors,
    /// The same on blocks of the log held out, with parameters from the other blocks; empty for a log too short for it.
    pub held_out: WrenchErrors,
}

impl CableFit {
    /// Standard error of a parameter, in its unit; `None` where it was not fitted.
    #[must_use]
    pub fn standard_error(&self, parameter: &Parameter) -> Option<f64> {
        let place = self.fitted.iter().position(|fitted| fitted == parameter)?;
        Some(self.covariance.get((place, place))?.sqrt())
    }

    /// Correlations of the fitted parameters, −1 to 1, in the order of the covariance; NaN for one of which there is no error.
    #[must_use]
    pub fn correlation(&self) -> DMatrix<f64> {
        let errors: Vec<f64> = self.covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
        let mut correlation = self.covariance.clone();
        for (mut column, of_column) in correlation.column_iter_mut().zip(&errors) {
            for (value, of_row) in column.iter_mut().zip(&errors) {
                *value /= of_column * of_row;
            }
        }
        correlation
    }
}
