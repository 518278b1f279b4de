//! The optimiser: Levenberg–Marquardt after MINPACK, by the crate `levenberg-marquardt`.
//!
//! The problem comes to it reduced ([`Triangle`]), which leaves every one of its decisions as it would be on the long one.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::gram::Triangle;

/// Relative reduction of the sum of squares at which a search ends in any case.
const SQUARES_TOLERANCE: f64 = 1e-10;
/// And relative change of the coordinates. They have standard errors of 1e-4 of their value and more.
const STEP_TOLERANCE: f64 = 1e-8;
/// Evaluations per parameter before giving up.
const PATIENCE: usize = 20;
/// And where a place several standard errors from the minimum would do.
const PATIENCE_AFAR: usize = 2;

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
    /// Those of the last evaluation, from which a short step led there.
    pub evaluated: Vec<f64>,
    /// Why there.
    pub termination: Termination,
    /// How often the model was evaluated.
    pub evaluation_count: usize,
    /// Sum of squares there.
    pub squares: f64,
}

/// Minimises the sum of squares of `evaluate`, which gives `None` to stop.
///
/// `residual_count` is that of the long problem: δ standard errors away from the minimum, in any direction, the sum of squares is
/// greater by δ² of so many parts of it. The search has arrived where δ is no more than `near_errors`; errors as they would be if
/// residuals did not remember: true ones are no smaller. Within one standard error a step that `is_straight`, over which a coordinate and its
/// parameter are all but proportional, is the last: what it misses the minimum by goes with its square, and is not evaluated any
/// more.
pub fn minimize(
    start: &[f64],
    residual_count: usize,
    near_errors: f64,
    is_straight: impl Fn(&[f64], &[f64]) -> bool,
    evaluate: impl FnMut(&[f64]) -> Option<Triangle>,
) -> Minimum {
    if start.is_empty() {
        let termination = Termination::NothingToFit;
        return Minimum {
            coordinates: Vec::new(),
            evaluated: Vec::new(),
            termination,
            evaluation_count: 0,
            squares: f64::NAN,
        };
    }
    let mut adapter = Adapter {
        evaluate,
        coordinates: DVector::from_row_slice(start),
        current: None,
        is_straight,
        residual_count,
        near_errors,
    };
    adapter.update();
    let (adapter, report) = LevenbergMarquardt::new()
        .with_ftol(SQUARES_TOLERANCE)
        .with_xtol(STEP_TOLERANCE)
        .with_patience(if near_errors > 1.0 { PATIENCE_AFAR } else { PATIENCE })
        .minimize(adapter);
    let arrival = adapter.arrival();
    let termination = match report.termination {
        TerminationReason::ResidualsZero
        | TerminationReason::Orthogonal
        | TerminationReason::Converged { .. }
        | TerminationReason::NoImprovementPossible(_) => Termination::Converged,
        TerminationReason::LostPatience => Termination::OutOfPatience,
        TerminationReason::User(_) if arrival.is_some() => Termination::Converged,
        TerminationReason::User(_) => Termination::Stopped,
        _ => Termination::Stalled,
    };
    let evaluated: Vec<f64> = adapter.coordinates.iter().copied().collect();
    Minimum {
        coordinates: arrival.unwrap_or_else(|| evaluated.clone()),
        evaluated,
        termination,
        evaluation_count: report.number_of_evaluations,
        squares: 2.0 * report.objective_function,
    }
}

struct Adapter<E, S> {
    evaluate: E,
    coordinates: DVector<f64>,
    current: Option<Triangle>,
    residual_count: usize,
    near_errors: f64,
    is_straight: S,
}

impl<E: FnMut(&[f64]) -> Option<Triangle>, S: Fn(&[f64], &[f64]) -> bool> Adapter<E, S> {
    fn update(&mut self) {
        self.current = (self.evaluate)(self.coordinates.as_slice());
    }

    /// The minimum where it is near, or here where hardly anything is to be gained; `None` where it is far.
    fn arrival(&self) -> Option<Vec<f64>> {
        let triangle = self.current.as_ref()?;
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let errors = (triangle.reducible_ratio() * self.residual_count as f64).sqrt();
        let here = self.coordinates.as_slice();
        let step = triangle.step().filter(|_| errors <= 1.0);
        let there = step.map(|step| here.iter().zip(step).map(|(coordinate, step)| coordinate - step).collect());
        let there = there.filter(|there: &Vec<f64>| (self.is_straight)(here, there));
        there.or_else(|| (errors <= self.near_errors).then(|| here.to_vec()))
    }
}

impl<E, S> LeastSquaresProblem<f64, Dyn, Dyn> for Adapter<E, S>
where
    E: FnMut(&[f64]) -> Option<Triangle>,
    S: Fn(&[f64], &[f64]) -> bool,
{
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
        if self.arrival().is_some() {
            return None;
        }
        let jacobian = &self.current.as_ref()?.jacobian;
        Some(DMatrix::from_column_slice(jacobian.nrows(), jacobian.ncols(), jacobian.as_slice()))
    }
}
