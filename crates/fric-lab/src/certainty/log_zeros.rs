//! The zeros that the logs of a cable have of their own, with their standard errors.

use fric_core::parameters::Values;

use super::undetermined::reported_covariance;
use crate::search::problem::Problem;

/// The zero of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogZeroEstimate {
    /// By how much it differs from the common zero of the model, N.
    pub change_n: f64,
    /// Its standard error, N.
    pub standard_error_n: f64,
}

/// Returns the zero of each log at the minimum of a problem; `None` for a log without a sample that counts, and nothing if all logs have the same.
///
/// The errors are those of a problem in which each zero has a column of its own, so they cover all that the other parameters' errors cover.
pub fn log_zeros(problem: &Problem<'_>, values: &Values) -> Vec<Option<LogZeroEstimate>> {
    let changes_n = problem.zero_changes_n(values);
    if changes_n.is_empty() {
        return Vec::new();
    }
    let mut with_columns = problem.clone();
    let mut shared = 0;
    for member in &mut with_columns.members {
        shared = member.free.len();
        if let Some(per_log) = &mut member.record.per_log {
            per_log.in_columns = true;
        }
    }
    let covariance = reported_covariance(&with_columns, &[*values], &[]);
    let estimate = |(log, change_n): (usize, Option<f64>)| {
        let variance = covariance.get((shared + log, shared + log)).copied().unwrap_or(f64::INFINITY);
        change_n.map(|change_n| LogZeroEstimate { change_n, standard_error_n: variance.sqrt() })
    };
    changes_n.into_iter().enumerate().map(estimate).collect()
}
