//! What the logged lengths say against a corrected point of a cable.

use fric_core::{CableParams, Pose};

use super::geometry::{Changes, Description, Geometry};
use crate::fit::CableRecord;

/// A correction is contradicted if it raises the variance of the lengths by more than this factor. On the recording of a real robot, whose poses come from
/// lengths and an inclinometer by the points of its file, points that halve the rest of the torque raise it 4 to 40 times; in logs of an independent
/// simulator with forces from outside false points raise it 10⁴ times and more. Half and twice this factor give the same.
const CONTRADICTED: f64 = 100.0;
/// Deviation of the lengths, m, below which nothing is contradicted.
const EXACT_M: f64 = 1e-5;

impl Description<'_> {
    /// Whether the lengths of the log contradict the correction of a cable's point: with it they differ from those of the poses by far more than without. A
    /// force from outside that goes with the pose looks like a wrong point to the wrench, but not to the lengths.
    pub fn is_contradicted(&self, of: Geometry, changes: &Changes, records: &[CableRecord<'_>]) -> bool {
        let Some((cable, record)) = of.cable().and_then(|cable| Some((cable, records.get(cable)?))) else {
            return false;
        };
        let mut without = changes.clone();
        without.remove(&of);
        let variance_m2 = |changes: &Changes| {
            let params = self.moved(cable, changes).or_else(|| self.robot.cables().get(cable).copied())?;
            length_variance_m2(&params, record, self.poses)
        };
        let with_and_without = variance_m2(changes).zip(variance_m2(&without));
        with_and_without.is_some_and(|(with, without)| with > CONTRADICTED * without.max(EXACT_M * EXACT_M))
    }
}

/// Returns the variance of the logged length minus that of the poses, m², each stretch without a gap about its own mean: the zero of a length is not known.
/// `None` if nothing can be compared.
fn length_variance_m2(params: &CableParams, record: &CableRecord<'_>, poses: &[Option<Pose>]) -> Option<f64> {
    let (mut squares, mut total) = (0.0, 0.0);
    for (start, rows) in record.logs() {
        let (mut sum, mut sum_of_squares, mut count, mut shown_m) = (0.0, 0.0, 0.0, 0.0);
        let mut end = |[sum, sum_of_squares, count]: [f64; 3]| {
            if count > 1.0 {
                squares += sum_of_squares - sum * sum / count;
                total += count;
            }
        };
        for (row, pose) in rows.iter().zip(poses.iter().skip(start)) {
            shown_m += row.signals.displacement_m;
            let known_m = pose.as_ref().filter(|_| row.is_sound()).and_then(|pose| params.length_m(pose));
            let Some(apart_m) = known_m.map(|known_m| shown_m - known_m).filter(|apart_m| apart_m.is_finite()) else {
                end([sum, sum_of_squares, count]);
                (sum, sum_of_squares, count, shown_m) = (0.0, 0.0, 0.0, 0.0);
                continue;
            };
            (sum, sum_of_squares, count) = (sum + apart_m, sum_of_squares + apart_m * apart_m, count + 1.0);
        }
        end([sum, sum_of_squares, count]);
    }
    (total > 0.0).then(|| squares / total)
}
