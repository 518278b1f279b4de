//! What a robot would log on a run, without noise, by the cycle's own model.
//!
//! Movements and forces at the platform are those of the run. The force that the sensor shows is the one that the model, run cycle by
//! cycle, makes the force at the platform of: the cycle's equations solved for their input. In each cycle the platform force is all but
//! linear in the sensor force, so that a secant or two gives it to rounding.

use fric_core::parameters::{OFFSET, Values};
use fric_core::robot::RobotParams;
use fric_core::{CableCycle, CableGroup, CableInput, Sample};

use crate::excite::{Excitation, ExcitationError};
use crate::fit::{CableRecord, Measurements, Reference, Row};

/// Secants in a cycle at most.
const SECANTS: usize = 6;
/// A force at the platform is met to this share of it.
const MET_RATIO: f64 = 1e-10;
/// A sensor without any noise under a constant load would pass for a frozen one.
const TREMBLING_RATIO: f64 = 1e-9;

/// The signals of several runs, one log each; the sensor of each cable as if nothing rubbed.
pub fn frictionless<'a>(
    robot: &RobotParams<'a>,
    runs: &mut [Excitation],
) -> Result<Measurements<'a>, ExcitationError> {
    let mut measurements = Measurements::new(robot, Reference::Forces);
    for run in runs {
        measurements.start_log();
        let mut inputs = Vec::new();
        let mut trembling = TREMBLING_RATIO;
        while let Some(cycle) = run.next_cycle()? {
            inputs.clear();
            trembling = -trembling;
            let cables = robot.cables().iter().zip(cycle.cables).zip(cycle.expected_n);
            inputs.extend(cables.map(|((params, motion), force_n)| CableInput {
                sensor_force_n: force_n * (1.0 + trembling) / params.frictionless_gain(),
                length_m: motion.length_m,
                speed_m_per_s: motion.speed_m_per_s,
            }));
            #[expect(clippy::cast_possible_truncation, reason = "at most an hour")]
            let stamp_nanos = libm::round(cycle.time_s * 1e9) as i64;
            measurements.add(&Sample {
                stamp_nanos,
                cables: &inputs,
                reference_force_n: cycle.expected_n,
                pose: cycle.platform.as_ref().map(crate::trajectory::SetPoint::pose),
                outside_wrench: None,
            });
        }
    }
    Ok(measurements)
}

/// The rows of a cable with the sensor forces that a model gives it; `None` where the model gives no finite force.
pub fn sensed(record: &CableRecord<'_>, values: &Values) -> Option<Vec<Row>> {
    let mut rows = record.rows.to_vec();
    for (start, log) in record.logs() {
        let mut group = CableGroup::<f64>::new(&[record.params], values, record.cycle_s, |_| false)?;
        for row in rows.iter_mut().skip(start).take(log.len()) {
            row.reference_n += values[OFFSET];
            sense(&mut group, row)?;
        }
    }
    Some(rows)
}

/// Finds the sensor force of a cycle and goes through it.
fn sense(group: &mut CableGroup<f64>, row: &mut Row) -> Option<()> {
    let wanted_n = row.reference_n;
    let deviation_n = |row: &Row| {
        let mut looked_at = group.clone();
        step(&mut looked_at, row) - wanted_n
    };
    let mut here = (row.signals.sensor_force_n, deviation_n(row));
    let mut there = {
        let mut other = *row;
        other.signals.sensor_force_n = here.0 * (1.0 + 1e-3) + 1e-6;
        (other.signals.sensor_force_n, deviation_n(&other))
    };
    for _ in 0..SECANTS {
        let slope = (there.1 - here.1) / (there.0 - here.0);
        if there.1.abs() <= MET_RATIO * wanted_n.abs() || !(slope.abs() > 0.0 && slope.is_finite()) {
            break;
        }
        row.signals.sensor_force_n = there.0 - there.1 / slope;
        here = there;
        there = (row.signals.sensor_force_n, deviation_n(row));
    }
    row.signals.sensor_force_n = there.0;
    let force_n = step(group, row);
    (force_n.is_finite() && there.0 > 0.0).then_some(())
}

fn step(group: &mut CableGroup<f64>, row: &Row) -> f64 {
    group.step(|_| CableCycle { signals: &row.signals, pose_wrap: row.pose_wrap, cycle: row.cycle }).platform_force_n
}
