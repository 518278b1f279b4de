//! Sensors with a zero of their own in each log, changed in the signals before the discovery.
//!
//! Every fit eliminates these zeros, but friction in presliding is not quite linear in them. So those of the given model are changed in the signals
//! first, and only what an extended model would change of them is left to its linear part.

use std::sync::atomic::AtomicBool;

use super::given::given_to;
use super::workbench::Workbench;
use crate::fit::{CableRecord, LogZero};
use crate::samples::cable::Zeroed;
use crate::samples::interpolated::measured;
use crate::samples::record::PerLog;
use crate::samples::split::split;

/// Number of fits of the given model. What each leaves is of second order in its change of the zeros.
const ROUNDS: usize = 3;

/// Returns the cycles with the zeros of the given model changed in the signals, and by how much in each log, N. Returns `None` if the sensor has the same
/// zero in all logs, or if the log does not allow a fit.
pub fn tared<'a>(record: &CableRecord<'a>, stop: &AtomicBool) -> Option<(Zeroed<'a>, Vec<f64>)> {
    let Some(PerLog { zero: LogZero::Sensor, .. }) = record.per_log else { return None };
    let (counts, start) = given_to(record, stop)?;
    let (blocks, measured) = (split(record), measured(record));
    let mut changed_n = vec![0.0; record.logs().count()];
    for _ in 0..ROUNDS {
        let zeroed = record.with_zeros(&changed_n);
        let record = record.zeroed(&zeroed);
        let bench = Workbench { record, blocks: &blocks, counts: &counts, measured: &measured, stop };
        let given = bench.try_one(&start);
        let steps_n = bench.problem(&given.free, None).zero_changes_n(&given.values);
        for (changed_n, step_n) in changed_n.iter_mut().zip(steps_n) {
            *changed_n += step_n.unwrap_or(0.0);
        }
    }
    Some((record.with_zeros(&changed_n), changed_n))
}
