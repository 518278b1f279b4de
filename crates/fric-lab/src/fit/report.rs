//! Types that hold the result of a fit.

use fric_core::parameters::Values;
use nalgebra::DMatrix;

use crate::certainty::log_zeros::LogZeroEstimate;
use crate::replay::{Deviation, WrenchErrors, WrenchReference};
use crate::samples::cable::{CableRecord, Zeroed};
use crate::samples::record::LogZero;
use crate::samples::selection::SampleCounts;
use crate::search::optimizer::Termination;
use crate::search::solve::OpenCombination;
use crate::search::vector::Parameter;
use crate::set_up::SetUp;

/// Errors of a cable's force at the platform.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceErrors {
    /// The reference itself, N.
    pub reference_n: Deviation,
    /// The forces beside the reference.
    pub(crate) set_up: SetUp,
    /// Frictionless force minus reference, N.
    pub before_n: Deviation,
    /// Compensated force minus reference, N.
    pub after_n: Deviation,
}

/// The value of a parameter in one of several logs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogValue {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value, in its unit.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

impl LogValue {
    /// Returns the values of all logs from their zeros, which differ from the model's values and from what has been changed in the data already.
    pub(crate) fn of_logs(
        zero: LogZero,
        values: &Values,
        estimates: &[Option<LogZeroEstimate>],
        changed_n: &[f64],
    ) -> Vec<Option<Self>> {
        let parameter = Parameter::all().find(|parameter| parameter.place() == zero.place());
        let changed_n = changed_n.iter().copied().chain(std::iter::repeat(0.0));
        let of_log = |(estimate, changed_n): (&Option<LogZeroEstimate>, f64)| {
            let LogZeroEstimate { change_n, standard_error_n } = (*estimate)?;
            let value = values[zero.place()] + changed_n + change_n;
            Some(Self { parameter: parameter?, value, standard_error: standard_error_n })
        };
        estimates.iter().zip(changed_n).map(of_log).collect()
    }

    /// Returns the value that stands for all logs in a robot file: that of the last one, whose zero is the latest.
    pub(crate) fn last(logs: &[Option<Self>]) -> Option<Self> {
        logs.iter().rev().flatten().next().copied()
    }
}

/// One cable's parameters and their uncertainty.
#[derive(Clone, Debug)]
pub struct CableFit {
    /// Sample counts by use.
    pub samples: SampleCounts,
    /// All parameters, fitted or not. Of a parameter with a value per log it is that of the last log.
    pub values: Values,
    /// The value of each log of its own, in the order of the logs; `None` for a log without a sample that counts, and nothing if all logs share all
    /// parameters.
    pub per_log: Vec<Option<LogValue>>,
    /// The fitted parameters, in the order of the covariance.
    pub fitted: Vec<Parameter>,
    /// The parameters that the samples do not determine; `values` holds the given values.
    pub undetermined: Vec<Parameter>,
    /// The open combination of each of these parameters, starting with its own part.
    pub open: Vec<OpenCombination>,
    /// The parameters at a bound that the samples would move beyond it; `values` holds the bound.
    pub at_bound: Vec<Parameter>,
    /// Covariance of the fitted parameters, in their units.
    pub covariance: DMatrix<f64>,
    /// The reason why the search ended.
    pub termination: Termination,
    /// Number of model evaluations with derivatives.
    pub evaluation_count: usize,
    /// Errors against the reference, if there is one.
    pub errors: ForceErrors,
}

/// The result of a fit to the wrench.
#[derive(Clone, Debug)]
pub struct WrenchFit {
    /// The cables in the robot's order.
    pub cables: Vec<CableFit>,
    /// What the forces were compared with.
    pub reference: WrenchReference,
    /// Wrench of the frictionless forces minus the external wrench, over every sample in which that is known.
    pub before: WrenchErrors,
    /// The same with the compensated forces.
    pub after: WrenchErrors,
    /// The same on held-out blocks of the log, with parameters from the other blocks; empty if the log is too short.
    pub held_out: WrenchErrors,
}

impl CableFit {
    /// Returns the standard error of a parameter, in its unit; `None` if it was not fitted, or if the error exceeds the parameter's range.
    #[must_use]
    pub fn standard_error(&self, parameter: &Parameter) -> Option<f64> {
        if let Some(last) = LogValue::last(&self.per_log).filter(|last| last.parameter == *parameter) {
            return Some(last.standard_error);
        }
        let place = self.fitted.iter().position(|fitted| fitted == parameter)?;
        let row = parameter.row();
        Some(self.covariance.get((place, place))?.sqrt()).filter(|error| error.is_nan() || *error <= row.max - row.min)
    }

    /// Returns a cable's cycles with the zero of each log changed in the data, so that `values` hold for all; `None` if all logs have the same zero.
    pub(crate) fn tared<'a>(&self, record: &CableRecord<'a>) -> Option<Zeroed<'a>> {
        let last = LogValue::last(&self.per_log)?;
        let change_n = |log: &Option<LogValue>| log.map_or(0.0, |log| log.value - last.value);
        Some(record.with_zeros(&self.per_log.iter().map(change_n).collect::<Vec<_>>()))
    }

    /// Returns the correlations of the fitted parameters, −1 to 1, in the order of the covariance; NaN for a parameter without an error.
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
