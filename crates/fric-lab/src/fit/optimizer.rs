//! The optimiser: Levenberg–Marquardt after MINPACK, by the crate `levenberg-marquardt`.
//!
//! The problem comes to it reduced ([`Triangle`]), which leaves every one of its decisions as it would be on the long one.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
// The crate's own, which need not be the version that the rest of the workspace uses.
use nalgebra_of_optimizer::storage::Owned;
use nalgebra_of_optimizer::{DMatrix, DVector, Dyn};

use super::gram::Triangle;

/// Relative change of the parameters at which a search ends in any case: they have standard errors of 1e-4 of their value and
/// more.
const STEP_TOLERANCE: f64 = 1e-8;
/// Evaluations per parameter before giving up.
const PATIENCE: usize = 20;

/// Why a search has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Termination {
    /// At a minimum: neither the sum of squares nor the parameters change any more.
    Converged,
    /// After the most evaluations allowed; the values are the best so far.
    OutOfPatience,
    /// The model gave numbers that are not finite, or no step made it better.
    Stalled,
    /// There was nothing to vary, or no sample to learn from.
    NothingToFit,
    /// On request.
    Stopped,
}

impl Termination {
    /// In a word or two, as in the result's JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::OutOfPatience => "out of patience",
            Self::Stalled => "stalled",
            Self::NothingToFit => "nothing to fit",
            Self::Stopped => "stopped",
        }
    }
}

/// Where a search has ended.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The coordinates.
    pub coordinates: Vec<f64>,
    /// Why there.
    pub termination: Termination,
    /// How often the model was evaluated.
    pub evaluation_count: usize,
    /// Sum of squares there.
    pub squares: f64,
}

/// Minimises the sum of squares of `evaluate`, which gives `None` to stop.
///
/// The search has arrived where the sum cannot fall by more than `negligible_ratio` of itself, by the linear model there: nothing
/// is evaluated any more to confirm it.
pub fn minimize(start: &[f64], negligible_ratio: f64, evaluate: impl FnMut(&[f64]) -> Option<Triangle>) -> Minimum {
    if start.is_empty() {
        let termination = Termination::NothingToFit;
        return Minimum { coordinates: Vec::new(), termination, evaluation_count: 0, squares: f64::NAN };
    }
    let mut adapter =
        Adapter { evaluate, coordinates: DVector::from_row_slice(start), current: None, negligible_ratio };
    adapter.update();
    let (adapter, report) =
        LevenbergMarquardt::new().with_xtol(STEP_TOLERANCE).with_patience(PATIENCE).minimize(adapter);
    let termination = match report.termination {
        TerminationReason::ResidualsZero
        | TerminationReason::Orthogonal
        | TerminationReason::Converged { .. }
        | TerminationReason::NoImprovementPossible(_) => Termination::Converged,
        TerminationReason::LostPatience => Termination::OutOfPatience,
        TerminationReason::User(_) if adapter.has_arrived() => Termination::Converged,
        TerminationReason::User(_) => Termination::Stopped,
        _ => Termination::Stalled,
    };
    Minimum {
        coordinates: adapter.coordinates.iter().copied().collect(),
        termination,
        evaluation_count: report.number_of_evaluations,
        squares: 2.0 * report.objective_function,
    }
}

struct Adapter<E> {
    evaluate: E,
    coordinates: DVector<f64>,
    current: Option<Triangle>,
    negligible_ratio: f64,
}

impl<E: FnMut(&[f64]) -> Option<Triangle>> Adapter<E> {
    fn update(&mut self) {
        self.current = (self.evaluate)(self.coordinates.as_slice());
    }

    fn has_arrived(&self) -> bool {
        self.current.as_ref().is_some_and(|triangle| triangle.reducible_ratio() <= self.negligible_ratio)
    }
}

impl<E: FnMut(&[f64]) -> Option<Triangle>> LeastSquaresProblem<f64, Dyn, Dyn> for Adapter<E> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, coordinates: &DVector<f64>) {
        if self.coordinates != *coordinates {
            self.coordinates.copy_from(coordinates);
            self.update();
        }
    }

    fn params(&self) -> DVector<f64> {
        self.coordinates.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.current.as_ref().map(|triangle| DVector::from_row_slice(triangle.residuals.as_slice()))
    }

    /// None where the search has arrived: that ends it.
    fn jacobian(&self) -> Option<DMatrix<f64>> {
        if self.has_arrived() {
            return None;
        }
        let jacobian = &self.current.as_ref()?.jacobian;
        Some(DMatrix::from_column_slice(jacobian.nrows(), jacobian.ncols(), jacobian.as_slice()))
    }
}
