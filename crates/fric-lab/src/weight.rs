//! Computes the external wrench if it was not measured: weight and inertia of the platform, from its mass and pose alone.
//!
//! The wrench is `w = m·(g − a)` at the centre of mass. The acceleration is the second difference of the centre of mass over ± [`WINDOW_S`], which is
//! its mean under a triangular window of that width. If it or the angular acceleration is not small, the wrench is not known well enough (jerk within
//! the window; the robot file has no moments of inertia), and the sample is left out.

use std::collections::VecDeque;

use fric_core::robot::RobotParams;
use fric_core::{Pose, Wrench};
use nalgebra::Vector3;

/// Half the width of the window, s.
const WINDOW_S: f64 = 0.02;
/// Limits of quasi-static motion: acceleration of the centre of mass, m/s²,
const GREATEST_ACCELERATION_M_PER_S2: f64 = 0.5;
/// and angular acceleration, rad/s².
const GREATEST_ROTATION_RAD_PER_S2: f64 = 2.0;

/// The wrench computed from the mass, pose by pose, with a latency of [`delay`](Self::delay) poses.
#[derive(Clone, Debug)]
pub struct Weight {
    mass_kg: f64,
    gravity_m_per_s2: Vector3<f64>,
    center_of_mass_m: Vector3<f64>,
    /// Number of samples in half the window.
    window: usize,
    window_s: f64,
    /// The last poses, the newest at the back: one window.
    poses: VecDeque<Option<Pose>>,
    /// The last accelerations, the newest at the back; `None` if they are unknown or not small.
    accelerations: VecDeque<Option<Vector3<f64>>>,
}

impl Weight {
    /// Creates the computation for a robot's platform, before the first pose.
    pub fn new(robot: &RobotParams<'_>) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let window = (WINDOW_S / robot.cycle_s()).ceil().max(1.0) as usize;
        #[expect(clippy::cast_precision_loss, reason = "a few samples")]
        let window_s = window as f64 * robot.cycle_s();
        Self {
            mass_kg: robot.mass_kg(),
            gravity_m_per_s2: robot.gravity_m_per_s2(),
            center_of_mass_m: robot.center_of_mass_m(),
            window,
            window_s,
            poses: vec![None; 2 * window + 1].into(),
            accelerations: vec![None; 2 * window + 1].into(),
        }
    }

    /// Returns the latency in poses.
    pub fn delay(&self) -> usize {
        2 * self.window
    }

    /// Adds the next pose and returns the wrench of the one `delay` poses before; `None` if it is unknown.
    pub fn push(&mut self, pose: Option<Pose>) -> Option<Wrench> {
        self.poses.pop_front();
        self.poses.push_back(pose);
        let acceleration_m_per_s2 = self.quiet_acceleration();
        self.accelerations.pop_front();
        self.accelerations.push_back(acceleration_m_per_s2);
        // All accelerations must be small, because the mean over the window may vanish by chance.
        if self.accelerations.iter().any(Option::is_none) {
            return None;
        }
        let acceleration_m_per_s2 = (*self.accelerations.get(self.window)?)?;
        // The acceleration in the middle belongs to the pose at the front.
        let pose = (*self.poses.front()?)?;
        let force_n = (self.gravity_m_per_s2 - acceleration_m_per_s2) * self.mass_kg;
        Some(Wrench { force_n, torque_nm: (pose.orientation * self.center_of_mass_m).cross(&force_n) })
    }

    /// Returns the acceleration of the centre of mass at the pose in the middle, m/s²; `None` if it is not small.
    fn quiet_acceleration(&self) -> Option<Vector3<f64>> {
        let pose = |place: usize| self.poses.get(place).copied().flatten();
        let (before, now, after) = (pose(0)?, pose(self.window)?, pose(2 * self.window)?);
        let squared = self.window_s * self.window_s;
        let center_m = |pose: &Pose| pose.position_m + pose.orientation * self.center_of_mass_m;
        let acceleration_m_per_s2 = (center_m(&before) - center_m(&now) * 2.0 + center_m(&after)) / squared;
        let turn_rad = |from: &Pose, to: &Pose| (to.orientation * from.orientation.inverse()).scaled_axis();
        let rotation_rad_per_s2 = (turn_rad(&now, &after) - turn_rad(&before, &now)) / squared;
        let is_quiet = acceleration_m_per_s2.norm() <= GREATEST_ACCELERATION_M_PER_S2
            && rotation_rad_per_s2.norm() <= GREATEST_ROTATION_RAD_PER_S2;
        is_quiet.then_some(acceleration_m_per_s2)
    }
}

/// Returns the wrench of each pose of one log; `None` if it is unknown.
pub fn wrenches(robot: &RobotParams<'_>, poses: &[Option<Pose>]) -> Vec<Option<Wrench>> {
    let mut weight = Weight::new(robot);
    let delay = weight.delay();
    let all = poses.iter().copied().chain(std::iter::repeat_n(None, delay));
    all.map(|pose| weight.push(pose)).skip(delay).collect()
}

#[cfg(test)]
mod tests {
    use fric_core::robot::file::RobotFile;
    use nalgebra::UnitQuaternion;

    use super::*;

    fn robot() -> RobotFile {
        let text = "format = 'fric-robot/1'\nname = 'r'\ncycle_s = 0.004\n[platform]\nmass_kg = 2.0\n\
                    center_of_mass_m = [0.1, 0.0, 0.0]\n[[cable]]\nname = 'a'\npulleys = [{ wrap_deg = 90.0 }]\n";
        RobotFile::parse(text, "test").unwrap()
    }

    #[test]
    fn the_wrench_of_a_constant_acceleration_is_newtons_and_of_its_own_pose() {
        let robot = robot();
        let pose = |cycle: u32| {
            let time_s = f64::from(cycle) * 0.004;
            let orientation = UnitQuaternion::from_scaled_axis(Vector3::z() * (0.5 * time_s));
            // The centre of mass accelerates upwards at 0.3 m/s², and the origin rotates about it.
            let center_m = Vector3::new(0.2, 0.3, 0.15 * time_s * time_s);
            Some(Pose { position_m: center_m - orientation * Vector3::new(0.1, 0.0, 0.0), orientation })
        };
        let poses: Vec<Option<Pose>> = (0..100).map(pose).collect();
        let found = wrenches(&robot.params(), &poses);
        assert_eq!(found.len(), 100);
        // A window of 5 cycles, twice at either end.
        assert!((0..100).all(|cycle| found[cycle].is_some() == (10..90).contains(&cycle)));
        let force_n = -2.0 * (9.80665 + 0.3);
        for cycle in [10_u32, 50, 89] {
            let angle = 0.5 * f64::from(cycle) * 0.004;
            let wrench = found[cycle as usize].unwrap();
            assert!((wrench.force_n - Vector3::new(0.0, 0.0, force_n)).norm() < 1e-9, "{wrench:?}");
            // r × F with r = 0.1 (cos, sin, 0) and F along z.
            let torque_nm = Vector3::new(0.1 * angle.sin() * force_n, -0.1 * angle.cos() * force_n, 0.0);
            assert!((wrench.torque_nm - torque_nm).norm() < 1e-9, "{wrench:?}");
        }
    }

    #[test]
    fn motion_that_is_not_quiet_has_no_wrench() {
        let robot = robot();
        let poses: Vec<Option<Pose>> = (0..100)
            .map(|cycle| {
                let time_s = f64::from(cycle) * 0.004;
                let position_m = Vector3::new(0.3 * (time_s - 0.2).max(0.0).powi(2), 0.0, 0.0);
                Some(Pose { position_m, orientation: UnitQuaternion::identity() })
            })
            .collect();
        let found = wrenches(&robot.params(), &poses);
        // 0.6 m/s² from cycle 50 on.
        assert!(found[10..40].iter().all(Option::is_some) && found[55..].iter().all(Option::is_none));
    }
}
