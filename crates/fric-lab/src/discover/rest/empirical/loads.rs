//! The load that a table over it may go by.
//!
//! Under a few loads the force of the sensor tells which of them hangs there. A table over the sensor's own force then has each of them by heart: it
//! shows the load itself whatever the sensor reads, and so removes every error, of the sensor, of the friction and of the model. What depends on the load
//! shows as much if the table goes by what the sensor would show if the model were right: the reference and the modelled friction. The mean of
//! the two neighbouring samples is taken, because the noise of the sample itself is in the error.

use fric_core::effects::empirical::Over;

use super::layout::condition;
use crate::discover::workbench::Workbench;

/// Returns the load in each cycle, from a model's residuals. It is the sensor's own where there is no residual beside it.
pub fn told(bench: &Workbench<'_>, residual_n: &[f64]) -> Vec<f64> {
    let shown_n = condition(bench, Over::Load);
    let told_n = |cycle: usize| Some(shown_n.get(cycle)? - residual_n.get(cycle).filter(|number| number.is_finite())?);
    let of = |cycle: usize| match (cycle.checked_sub(1).and_then(told_n), told_n(cycle + 1)) {
        (Some(before_n), Some(after_n)) => f64::midpoint(before_n, after_n),
        (Some(one_n), None) | (None, Some(one_n)) => one_n,
        (None, None) => shown_n[cycle],
    };
    (0..shown_n.len()).map(of).collect()
}
