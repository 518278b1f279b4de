//! Computes the external wrench if it was not measured: weight and inertia of the platform, from its mass and pose alone.
//!
//! Newton and Euler: force `F = m·(g − a)`, and torque `R c × F − (I·α + ω × I·ω)` about the platform's origin, with the acceleration a of the centre
//! of mass c, the angular velocity ω and the inertia tensor I. A second difference over ± [`WINDOW_S`] is the mean of an acceleration under a
//! triangular window of that width, which differs from it by `h²/12` times its second derivative. Differences of these means cancel that part:
//! together they are the central difference of fourth order, `(−1, 16, −30, 16, −1)/12`; for a rotation about changing axes it is nearly that. The angular
//! velocity is the plain mean over the window. Samples with accelerations or turns that are not small are left out: the tensor may not be known, and after a
//! jump of the acceleration the means are wrong.

use std::collections::VecDeque;

use fric_core::robot::RobotParams;
use fric_core::{Pose, Wrench};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Half the width of the window, s.
const WINDOW_S: f64 = 0.02;
/// Limits of quasi-static motion: acceleration of the centre of mass, m/s²,
const GREATEST_ACCELERATION_M_PER_S2: f64 = 0.5;
/// and angular acceleration and squared angular velocity, rad/s².
const GREATEST_ROTATION_RAD_PER_S2: f64 = 2.0;

/// What gravity and inertia act on.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    pub mass_kg: f64,
    /// Centre of mass, platform frame.
    pub center_of_mass_m: Vector3<f64>,
    /// Inertia tensor about the centre of mass, platform axes.
    pub inertia_kg_m2: Matrix3<f64>,
    /// Gravity, base frame.
    pub gravity_m_per_s2: Vector3<f64>,
}

/// The motion that inertia resists, base axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// Acceleration of the centre of mass.
    pub acceleration_m_per_s2: Vector3<f64>,
    pub angular_velocity_rad_per_s: Vector3<f64>,
    pub angular_acceleration_rad_per_s2: Vector3<f64>,
}

impl Body {
    /// Returns the platform of a robot.
    pub fn of(robot: &RobotParams<'_>) -> Self {
        Self {
            mass_kg: robot.mass_kg(),
            center_of_mass_m: robot.center_of_mass_m(),
            inertia_kg_m2: robot.inertia_kg_m2(),
            gravity_m_per_s2: robot.gravity_m_per_s2(),
        }
    }

    /// Returns the wrench of gravity and inertia, base axes, torque about the platform's origin.
    pub fn wrench(&self, orientation: &UnitQuaternion<f64>, motion: &Motion) -> Wrench {
        let force_n = (self.gravity_m_per_s2 - motion.acceleration_m_per_s2) * self.mass_kg;
        let rotation = orientation.to_rotation_matrix();
        let inertia_kg_m2 = rotation * self.inertia_kg_m2 * rotation.inverse();
        let (velocity, acceleration) = (motion.angular_velocity_rad_per_s, motion.angular_acceleration_rad_per_s2);
        let spin_nm = inertia_kg_m2 * acceleration + velocity.cross(&(inertia_kg_m2 * velocity));
        Wrench { force_n, torque_nm: (orientation * self.center_of_mass_m).cross(&force_n) - spin_nm }
    }
}

/// The wrench computed from the mass, pose by pose, with a latency of [`delay`](Self::delay) poses.
#[derive(Clone, Debug)]
pub struct Weight {
    body: Body,
    /// Number of samples in half the window.
    window: usize,
    window_s: f64,
    /// The last poses, the newest at the back: one window.
    poses: VecDeque<Option<Pose>>,
    /// The last motions, the newest at the back: one window; `None` if unknown or not quiet.
    motions: VecDeque<Option<Motion>>,
}

impl Weight {
    /// Creates the computation for a robot's platform, before the first pose.
    pub fn new(robot: &RobotParams<'_>) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let window = (WINDOW_S / robot.cycle_s()).ceil().max(1.0) as usize;
        #[expect(clippy::cast_precision_loss, reason = "a few samples")]
        let window_s = window as f64 * robot.cycle_s();
        Self {
            body: Body::of(robot),
            window,
            window_s,
            poses: vec![None; 2 * window + 1].into(),
            motions: vec![None; 2 * window + 1].into(),
        }
    }

    /// Returns the latency in poses.
    pub fn delay(&self) -> usize {
        2 * self.window
    }

    /// Adds the next pose and returns the wrench of the one `delay` poses before; `None` if it is unknown.
    pub fn push(&mut self, pose: Option<Pose>) -> Option<Wrench> {
        let (pose, motion) = self.moved(pose)?;
        Some(self.body.wrench(&pose.orientation, &motion))
    }

    /// Adds the next pose and returns the one `delay` poses before with its motion; `None` if that is unknown.
    fn moved(&mut self, pose: Option<Pose>) -> Option<(Pose, Motion)> {
        self.poses.pop_front();
        self.poses.push_back(pose);
        let motion = self.quiet_motion();
        self.motions.pop_front();
        self.motions.push_back(motion);
        // All accelerations must be small, because the mean over the window may vanish by chance.
        if self.motions.iter().any(Option::is_none) {
            return None;
        }
        let motion = |place: usize| self.motions.get(place).copied().flatten();
        let (before, now, after) = (motion(0)?, motion(self.window)?, motion(2 * self.window)?);
        let exact = |of: fn(&Motion) -> Vector3<f64>| of(&now) - (of(&before) - of(&now) * 2.0 + of(&after)) / 12.0;
        let motion = Motion {
            acceleration_m_per_s2: exact(|motion| motion.acceleration_m_per_s2),
            angular_acceleration_rad_per_s2: exact(|motion| motion.angular_acceleration_rad_per_s2),
            ..now
        };
        // The motion in the middle belongs to the pose at the front.
        Some(((*self.poses.front()?)?, motion))
    }

    /// Returns the mean motion about the pose in the middle; `None` if it is not quiet.
    fn quiet_motion(&self) -> Option<Motion> {
        let pose = |place: usize| self.poses.get(place).copied().flatten();
        let (before, now, after) = (pose(0)?, pose(self.window)?, pose(2 * self.window)?);
        let squared = self.window_s * self.window_s;
        let center_m = |pose: &Pose| pose.position_m + pose.orientation * self.body.center_of_mass_m;
        let turn_rad = |from: &Pose, to: &Pose| (to.orientation * from.orientation.inverse()).scaled_axis();
        let (to_rad, on_rad) = (turn_rad(&before, &now), turn_rad(&now, &after));
        let motion = Motion {
            acceleration_m_per_s2: (center_m(&before) - center_m(&now) * 2.0 + center_m(&after)) / squared,
            angular_velocity_rad_per_s: (to_rad + on_rad) / (2.0 * self.window_s),
            angular_acceleration_rad_per_s2: (on_rad - to_rad) / squared,
        };
        let is_quiet = motion.acceleration_m_per_s2.norm() <= GREATEST_ACCELERATION_M_PER_S2
            && motion.angular_acceleration_rad_per_s2.norm() <= GREATEST_ROTATION_RAD_PER_S2
            && motion.angular_velocity_rad_per_s.norm_squared() <= GREATEST_ROTATION_RAD_PER_S2;
        is_quiet.then_some(motion)
    }
}

/// Returns the motion at each pose of one log; `None` if it is unknown.
pub fn motions(robot: &RobotParams<'_>, poses: &[Option<Pose>]) -> Vec<Option<Motion>> {
    let mut weight = Weight::new(robot);
    let delay = weight.delay();
    let all = poses.iter().copied().chain(std::iter::repeat_n(None, delay));
    all.map(|pose| weight.moved(pose).map(|(_, motion)| motion)).skip(delay).collect()
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

    fn wrenches(robot: &RobotFile, poses: &[Option<Pose>]) -> Vec<Option<Wrench>> {
        let body = Body::of(&robot.params());
        let wrench =
            |(pose, motion): (&Option<Pose>, Option<Motion>)| Some(body.wrench(&pose.as_ref()?.orientation, &motion?));
        poses.iter().zip(motions(&robot.params(), poses)).map(wrench).collect()
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
        let found = wrenches(&robot, &poses);
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

    /// Newton and Euler by hand: a body with the moments 1, 2 and 3 that turns about a fixed axis, constantly and with a constant acceleration.
    #[test]
    fn a_turn_needs_the_torque_of_the_inertia_tensor() {
        let text = "format = 'fric-robot/1'\nname = 'r'\ncycle_s = 0.001\n[platform]\nmass_kg = 2.0\n\
                    inertia_kg_m2 = [1.0, 0.0, 0.25, 2.0, 0.0, 3.0]\n[[cable]]\nname = 'a'\npulleys = [{ wrap_deg = 90.0 }]\n";
        let robot = RobotFile::parse(text, "test").unwrap();
        let turned = |axis: Vector3<f64>, angle_rad: &dyn Fn(f64) -> f64| {
            let pose = |cycle: u32| {
                let orientation = UnitQuaternion::from_scaled_axis(axis * angle_rad(f64::from(cycle) * 0.001));
                Some(Pose { position_m: Vector3::zeros(), orientation })
            };
            let found = wrenches(&robot, &(0..1000).map(pose).collect::<Vec<_>>());
            found[500].unwrap().torque_nm
        };
        // At 0.5 s the axes agree, and the body is about to turn by ½·1.5·t² about z: −I·α with I·z = (0.25, 0, 3).
        let about_z = turned(Vector3::z(), &|time_s| 0.75 * (time_s - 0.5).powi(2));
        assert!((about_z - Vector3::new(-0.375, 0.0, -4.5)).norm() < 1e-6, "{about_z}");
        // −ω × I·ω at √2 rad/s about (0, 1, 1)/√2, when the axes agree: ω = (0, 1, 1), I·ω = (0.25, 2, 3), ω × I·ω = (1, 0.25, −0.25).
        let axis = Vector3::new(0.0, 1.0, 1.0).normalize();
        let steady = turned(axis, &|time_s| 1.414 * (time_s - 0.5));
        assert!((steady - Vector3::new(-1.0, -0.25, 0.25)).norm() < 1e-3, "{steady}");
    }

    /// A wave of 0.35 s with 0.4 m/s²: the mean over ± 20 ms alone would be wrong by 4 mm/s².
    #[test]
    fn short_moves_have_their_own_acceleration() {
        let robot = robot();
        let rate = std::f64::consts::TAU / 0.35;
        let pose = |cycle: u32| {
            let x_m = -0.4 / rate.powi(2) * (rate * f64::from(cycle) * 0.004).sin();
            Some(Pose { position_m: Vector3::new(x_m, 0.0, 0.0), orientation: UnitQuaternion::identity() })
        };
        let found = wrenches(&robot, &(0..200).map(pose).collect::<Vec<_>>());
        for cycle in 10_u32..190 {
            let exact_n = -2.0 * 0.4 * (rate * f64::from(cycle) * 0.004).sin();
            let error_n = found[cycle as usize].unwrap().force_n.x - exact_n;
            assert!(error_n.abs() < 3e-4, "{error_n} N in cycle {cycle}");
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
        let found = wrenches(&robot, &poses);
        // 0.6 m/s² from cycle 50 on.
        assert!(found[10..40].iter().all(Option::is_some) && found[55..].iter().all(Option::is_none));
    }
}
