//! Predicts the noise-free log of a robot on a run, by the cycle's own model.
//!
//! Movements and forces at the platform are those of the run. The sensor force is the one for which the model, run cycle by cycle, gives this force
//! at the platform: the cycle's equations are solved for their input. In each cycle the platform force is nearly linear in the sensor force, so one
//! or two secant steps give it to rounding.

use fric_core::parameters::{OFFSET, Values};
use fric_core::robot::RobotParams;
use fric_core::{CableCycle, CableGroup, CableInput, Pose, Sample};

use crate::excite::{Excitation, ExcitationError};
use crate::fit::{CableRecord, Measurements, Reference, Row};
use crate::trajectory::SetPoint;

/// Maximum number of secant steps per cycle.
const SECANTS: usize = 6;
/// Relative tolerance of the force at the platform.
const MET_RATIO: f64 = 1e-10;
/// A sensor without any noise under a constant load would be taken for a frozen one.
const TREMBLING_RATIO: f64 = 1e-9;

/// The samples of a run, with the sensor forces of a frictionless cable.
#[derive(Default)]
pub struct Samples {
    cable_count: usize,
    stamps_nanos: Vec<i64>,
    poses: Vec<Option<Pose>>,
    /// The inputs of all cables in a cycle, then in the next.
    inputs: Vec<CableInput>,
    forces_n: Vec<f64>,
}

impl Samples {
    /// Adds the samples as a log of their own.
    pub fn enter(&self, measurements: &mut Measurements<'_>) {
        measurements.start_log();
        let cables = self.inputs.chunks_exact(self.cable_count).zip(self.forces_n.chunks_exact(self.cable_count));
        for ((stamp_nanos, pose), (cables, reference_force_n)) in self.stamps_nanos.iter().zip(&self.poses).zip(cables)
        {
            let (stamp_nanos, pose) = (*stamp_nanos, *pose);
            measurements.add(&Sample { stamp_nanos, cables, reference_force_n, pose, outside_wrench: None });
        }
    }
}

/// Returns the samples of a run.
pub fn samples(robot: &RobotParams<'_>, run: &mut Excitation) -> Result<Samples, ExcitationError> {
    let mut samples = Samples { cable_count: robot.cables().len(), ..Samples::default() };
    let mut trembling = TREMBLING_RATIO;
    while let Some(cycle) = run.next_cycle()? {
        trembling = -trembling;
        let cables = robot.cables().iter().zip(cycle.cables).zip(cycle.expected_n);
        samples.inputs.extend(cables.map(|((params, motion), force_n)| CableInput {
            sensor_force_n: force_n * (1.0 + trembling) / params.frictionless_gain(),
            length_m: motion.length_m,
            speed_m_per_s: motion.speed_m_per_s,
        }));
        samples.forces_n.extend(cycle.expected_n);
        #[expect(clippy::cast_possible_truncation, reason = "at most an hour")]
        samples.stamps_nanos.push(libm::round(cycle.time_s * 1e9) as i64);
        samples.poses.push(cycle.platform.as_ref().map(SetPoint::pose));
    }
    Ok(samples)
}

/// Returns the same as a log.
pub fn frictionless<'a>(robot: &RobotParams<'a>, run: &mut Excitation) -> Result<Measurements<'a>, ExcitationError> {
    let mut measurements = Measurements::new(robot, Reference::Forces);
    samples(robot, run)?.enter(&mut measurements);
    Ok(measurements)
}

/// Returns the rows of a cable with the sensor forces of a model, and its references; `None` if the model gives a non-finite force.
pub fn sensed(record: &CableRecord<'_>, values: &Values) -> Option<(Vec<Row>, Vec<f64>)> {
    let mut rows = record.rows.to_vec();
    let references_n: Vec<f64> = record.references_n.iter().map(|reference_n| reference_n + values[OFFSET]).collect();
    for (start, log) in record.logs() {
        let mut group = CableGroup::<f64>::new(&[record.params], values, record.cycle_s, |_| false)?;
        for (row, reference_n) in rows.iter_mut().zip(&references_n).skip(start).take(log.len()) {
            sense(&mut group, row, *reference_n)?;
        }
    }
    Some((rows, references_n))
}

/// Finds the sensor force of a cycle that makes the wanted force at the platform, and steps the model with it.
fn sense(group: &mut CableGroup<f64>, row: &mut Row, wanted_n: f64) -> Option<()> {
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

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use fric_core::effects::Effect;
    use fric_core::robot::file::RobotFile;

    use super::*;
    use crate::excite::ExcitationOptions;
    use crate::excite::design::hypothesis::with_typical;
    use crate::search::gang::forces_of;
    use crate::search::pass::Part;

    /// For every model, the cycle computes the run's platform force from the predicted sensor force.
    #[test]
    fn the_cycle_makes_the_force_at_the_platform_of_what_is_predicted() {
        let text = "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = 0.004\n[platform]\nmass_kg = 0.5\n[[cable]]\n\
                    name = \"drive\"\npulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]\n\
                    friction = { mu = 0.019, sigma_n_per_m = 950.0, viscous_n_s_per_m = 0.2, offset_n = 0.1 }\n";
        let robot = RobotFile::parse(text, "bench").unwrap();
        let mut run = Excitation::new(&robot, &ExcitationOptions::default()).unwrap();
        let measurements = frictionless(&robot.params(), &mut run).unwrap();
        let record = measurements.cable(0).unwrap();
        let (stop, base) = (AtomicBool::new(false), record.params.values());
        for effect in Effect::CATALOGUE {
            let values = with_typical(&record, &base, *effect, 20.0).unwrap();
            let (rows, references_n) = sensed(&record, &values).unwrap();
            let record = CableRecord { rows: &rows, references_n: &references_n, ..record };
            let part = Part { record, values, free: Vec::new() };
            let forces = forces_of(&[part], &stop).unwrap();
            for (cycle, (row, reference_n)) in rows.iter().zip(&references_n).enumerate() {
                let force_n = forces[0].at(cycle).0;
                assert!((force_n - reference_n).abs() < 1e-6, "{} at {cycle}: {force_n}", effect.kind());
                assert!(row.is_sound(), "{} at {cycle}", effect.kind());
            }
        }
    }
}
