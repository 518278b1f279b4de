//! The outside wrench where none was measured: weight and inertia of the platform, by its mass and its pose alone.
//!
//! `w = m·(g − a)` at the centre of mass. The acceleration comes from the pose: second difference of the centre of mass over
//! ± [`WINDOW_S`], which is its mean under a triangle of that width. Where it, or the rotation's, is not small the wrench
//! is not known well enough (jerk within the window; the robot file has no moments of inertia) and the sample is left out.

use fric_core::Pose;
use fric_core::robot::RobotParams;
use nalgebra::{Vector3, Vector6};

/// Half the width of the window, s.
const WINDOW_S: f64 = 0.02;
/// Beyond this the motion is not quasi-static: acceleration of the centre of mass, m/s².
const GREATEST_ACCELERATION_M_PER_S2: f64 = 0.5;
/// And of the rotation, rad/s².
const GREATEST_ROTATION_RAD_PER_S2: f64 = 2.0;

/// The outside wrench of each sample of one log, NaN where it is not known.
pub fn wrenches(robot: &RobotParams<'_>, poses: &[Option<Pose>]) -> Vec<Vector6<f64>> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
    let window = (WINDOW_S / robot.cycle_s()).ceil().max(1.0) as usize;
    #[expect(clippy::cast_precision_loss, reason = "a few samples")]
    let window_s = window as f64 * robot.cycle_s();
    let accelerations: Vec<Option<Vector3<f64>>> = (0..poses.len())
        .map(|place| {
            let pose = |place: usize| poses.get(place).copied().flatten();
            let (before, now, after) = (pose(place.checked_sub(window)?)?, pose(place)?, pose(place + window)?);
            let [before_m, now_m, after_m] = [&before, &now, &after].map(|pose| center_of_mass_m(robot, pose));
            let acceleration_m_per_s2 = (before_m - now_m * 2.0 + after_m) / (window_s * window_s);
            let turn_rad = |from: &Pose, to: &Pose| (to.orientation * from.orientation.inverse()).scaled_axis();
            let rotation = (turn_rad(&now, &after) - turn_rad(&before, &now)) / (window_s * window_s);
            let quiet = acceleration_m_per_s2.norm() <= GREATEST_ACCELERATION_M_PER_S2
                && rotation.norm() <= GREATEST_ROTATION_RAD_PER_S2;
            quiet.then_some(acceleration_m_per_s2)
        })
        .collect();
    let wrench = |place: usize| -> Option<Vector6<f64>> {
        // Quiet all around: a mean over the window may vanish by chance.
        let around = accelerations.get(place.checked_sub(window)?..=place + window)?;
        let acceleration_m_per_s2 = accelerations.get(place).copied().flatten()?;
        if around.iter().any(Option::is_none) {
            return None;
        }
        let pose = poses.get(place).copied().flatten()?;
        let force_n = (robot.gravity_m_per_s2() - acceleration_m_per_s2) * robot.mass_kg();
        let torque_nm = (pose.orientation * robot.center_of_mass_m()).cross(&force_n);
        Some(Vector6::new(force_n.x, force_n.y, force_n.z, torque_nm.x, torque_nm.y, torque_nm.z))
    };
    (0..poses.len()).map(|place| wrench(place).unwrap_or_else(|| Vector6::repeat(f64::NAN))).collect()
}

fn center_of_mass_m(robot: &RobotParams<'_>, pose: &Pose) -> Vector3<f64> {
    pose.position_m + pose.orientation * robot.center_of_mass_m()
}
