//! Computes the external wrench if it was not measured: weight and inertia of the platform, from its mass and pose alone.
//!
//! Newton and Euler: force `F = m·(g − a)`, and torque `R c × F − (I·α + ω × I·ω)` about the platform's origin, with the acceleration a of the centre
//! of mass c, the angular velocity ω and the inertia tensor I. A second difference over ± [`WINDOW_NANOS`] is the mean of an acceleration under a
//! triangular window of that width, which differs from it by `h²/12` times its second derivative. Differences of these means cancel that part:
//! together they are the central difference of fourth order, `(−1, 16, −30, 16, −1)/12`; for a rotation about changing axes it is nearly that. The angular
//! velocity is the plain mean over the window. Samples with accelerations or turns that are not small are left out: the tensor may not be known, and after a
//! jump of the acceleration the means are wrong. Times are those of the stamps, so that neither lost poses nor the file's `cycle_s` matter.

use std::collections::VecDeque;

use fric_core::robot::RobotParams;
use fric_core::{Pose, Wrench};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Half the width of the window, and the minimum distance of poses for a difference.
const WINDOW_NANOS: u64 = 20_000_000;
/// Stamps that are rounded may be nearer by this.
const ROUNDING_NANOS: u64 = 10_000;
/// Poses further apart than this say nothing about the acceleration between them, s,
const FARTHEST_S: f64 = 0.2;
/// nor two intervals whose ratio is beyond this: the mean of a jerk under them is no acceleration at the pose between.
const MOST_UNEVEN: f64 = 1.5;
/// Limits of quasi-static motion: acceleration of the centre of mass, m/s²,
const GREATEST_ACCELERATION_M_PER_S2: f64 = 0.5;
/// and angular acceleration and squared angular velocity, rad/s².
const GREATEST_ROTATION_RAD_PER_S2: f64 = 2.0;

/// Why no pose has a motion, as a clause.
pub const NEVER_QUIET: &str = "the platform is never in quiet motion by its poses, with accelerations to 0.5 m/s² and 2 rad/s² for 80 ms; noise of the poses \
                               beyond some 0.03 mm looks like more";

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

/// A pose of which the motion is to be known.
#[derive(Clone, Copy, Debug)]
struct Posed {
    stamp_nanos: i64,
    pose: Option<Pose>,
    /// Mean motion over the window, once that has passed; `None` if it is unknown or not quiet.
    mean: Option<Motion>,
}

/// The motion of the platform, pose by pose, as soon as two windows after a pose have passed.
#[derive(Clone, Debug)]
pub struct Motions {
    center_of_mass_m: Vector3<f64>,
    /// Poses that others still need, then those whose motion is not known yet, in the order of time.
    poses: VecDeque<Posed>,
    /// Number of poses whose mean motion has been computed, and number of those that are delivered.
    mean_count: usize,
    delivered: usize,
}

impl Motions {
    /// Creates the computation for a robot's platform, before the first pose.
    pub fn new(robot: &RobotParams<'_>) -> Self {
        Self { center_of_mass_m: robot.center_of_mass_m(), poses: VecDeque::new(), mean_count: 0, delivered: 0 }
    }

    /// Adds the next pose. Calls `show` with the motion of each pose for which it is final, in their order; `None` if it is unknown.
    pub fn push(&mut self, stamp_nanos: i64, pose: Option<Pose>, mut show: impl FnMut(Option<Motion>)) {
        if self.poses.back().is_some_and(|last| last.stamp_nanos >= stamp_nanos) {
            self.end(&mut show);
        }
        self.poses.push_back(Posed { stamp_nanos, pose, mean: None });
        while let Some(after) = self.after(self.mean_count) {
            let mean = self.quiet_motion(self.mean_count, after);
            if let Some(posed) = self.poses.get_mut(self.mean_count) {
                posed.mean = mean;
            }
            self.mean_count += 1;
        }
        while let Some(after) = self.after(self.delivered).filter(|after| *after < self.mean_count) {
            show(self.motion(self.delivered, after));
            self.delivered += 1;
            // The one before the window is the first that the next pose needs.
            while self.before(self.delivered).is_some_and(|before| before > 0) {
                self.poses.pop_front();
                self.mean_count -= 1;
                self.delivered -= 1;
            }
        }
    }

    /// Ends a log: the motion of the last poses is not known.
    pub fn end(&mut self, mut show: impl FnMut(Option<Motion>)) {
        (self.delivered..self.poses.len()).for_each(|_| show(None));
        self.poses.clear();
        (self.mean_count, self.delivered) = (0, 0);
    }

    /// Returns the last pose at least half a window before another; `None` if there is none, or none near.
    fn before(&self, index: usize) -> Option<usize> {
        let now = self.poses.get(index)?.stamp_nanos;
        (0..index).rev().find(|before| self.is_apart(*before, now))
    }

    /// Returns the first pose at least half a window after another; `None` before it has come.
    fn after(&self, index: usize) -> Option<usize> {
        let now = self.poses.get(index)?.stamp_nanos;
        (index + 1..self.poses.len()).find(|after| self.is_apart(*after, now))
    }

    fn is_apart(&self, index: usize, now_nanos: i64) -> bool {
        self.poses
            .get(index)
            .is_some_and(|other| now_nanos.abs_diff(other.stamp_nanos) >= WINDOW_NANOS - ROUNDING_NANOS)
    }

    /// Returns the motion of a pose; `None` if it is unknown. All mean accelerations within the window must be small, because the mean over it may vanish by
    /// chance.
    fn motion(&self, index: usize, after: usize) -> Option<Motion> {
        let before = self.before(index)?;
        let mean = |index: usize| self.poses.get(index)?.mean;
        if (before..=after).any(|index| mean(index).is_none()) {
            return None;
        }
        let (past, now, future) = (mean(before)?, mean(index)?, mean(after)?);
        let exact = |of: fn(&Motion) -> Vector3<f64>| of(&now) - (of(&past) - of(&now) * 2.0 + of(&future)) / 12.0;
        Some(Motion {
            acceleration_m_per_s2: exact(|motion| motion.acceleration_m_per_s2),
            angular_acceleration_rad_per_s2: exact(|motion| motion.angular_acceleration_rad_per_s2),
            ..now
        })
    }

    /// Returns the mean motion about a pose; `None` if it is unknown or not quiet.
    fn quiet_motion(&self, index: usize, after: usize) -> Option<Motion> {
        let posed = |index: usize| self.poses.get(index).and_then(|of| Some((of.stamp_nanos, of.pose?)));
        let (before, now, after) = (posed(self.before(index)?)?, posed(index)?, posed(after)?);
        #[expect(clippy::cast_precision_loss, reason = "intervals between poses")]
        let [past_s, future_s] = [now.0 - before.0, after.0 - now.0].map(|nanos| nanos as f64 * 1e-9);
        if past_s.max(future_s) > FARTHEST_S || past_s.max(future_s) > MOST_UNEVEN * past_s.min(future_s) {
            return None;
        }
        let middle_s = 0.5 * (past_s + future_s);
        let center_m = |pose: &Pose| pose.position_m + pose.orientation * self.center_of_mass_m;
        let turn_rad = |from: &Pose, to: &Pose| (to.orientation * from.orientation.inverse()).scaled_axis();
        let (to_rad, on_rad) = (turn_rad(&before.1, &now.1) / past_s, turn_rad(&now.1, &after.1) / future_s);
        let (to_m, on_m) =
            ((center_m(&now.1) - center_m(&before.1)) / past_s, (center_m(&after.1) - center_m(&now.1)) / future_s);
        let motion = Motion {
            acceleration_m_per_s2: (on_m - to_m) / middle_s,
            angular_velocity_rad_per_s: (to_rad * future_s + on_rad * past_s) / (past_s + future_s),
            angular_acceleration_rad_per_s2: (on_rad - to_rad) / middle_s,
        };
        let is_quiet = motion.acceleration_m_per_s2.norm() <= GREATEST_ACCELERATION_M_PER_S2
            && motion.angular_acceleration_rad_per_s2.norm() <= GREATEST_ROTATION_RAD_PER_S2
            && motion.angular_velocity_rad_per_s.norm_squared() <= GREATEST_ROTATION_RAD_PER_S2;
        is_quiet.then_some(motion)
    }
}

/// Returns the motion at each pose of one log, with its stamps; `None` if it is unknown.
pub fn motions(robot: &RobotParams<'_>, poses: impl Iterator<Item = (i64, Option<Pose>)>) -> Vec<Option<Motion>> {
    let (mut motions, mut all) = (Motions::new(robot), Vec::new());
    for (stamp_nanos, pose) in poses {
        motions.push(stamp_nanos, pose, |motion| all.push(motion));
    }
    motions.end(|motion| all.push(motion));
    all
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

    fn wrenches(robot: &RobotFile, cycle_nanos: i64, poses: &[Option<Pose>]) -> Vec<Option<Wrench>> {
        let body = Body::of(&robot.params());
        let wrench =
            |(pose, motion): (&Option<Pose>, Option<Motion>)| Some(body.wrench(&pose.as_ref()?.orientation, &motion?));
        let stamped = (0..).map(|cycle| cycle * cycle_nanos).zip(poses.iter().copied());
        poses.iter().zip(motions(&robot.params(), stamped)).map(wrench).collect()
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
        let found = wrenches(&robot, 4_000_000, &poses);
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
            let found = wrenches(&robot, 1_000_000, &(0..1000).map(pose).collect::<Vec<_>>());
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
        let found = wrenches(&robot, 4_000_000, &(0..200).map(pose).collect::<Vec<_>>());
        for cycle in 10_u32..190 {
            let exact_n = -2.0 * 0.4 * (rate * f64::from(cycle) * 0.004).sin();
            let error_n = found[cycle as usize].unwrap().force_n.x - exact_n;
            assert!(error_n.abs() < 3e-4, "{error_n} N in cycle {cycle}");
        }
    }

    /// A pose that is lost changes the times of its neighbours, not the acceleration; and the file's `cycle_s` is not the rate of the log.
    #[test]
    fn lost_poses_and_another_rate_make_no_acceleration() {
        let robot = robot();
        for (cycle_nanos, lost) in
            [(4_000_000, 7), (4_000_000, 1000), (1_000_000, 13), (10_000_000, 1000), (31_000_000, 1000)]
        {
            let cycles = (0..3_000_000_000 / cycle_nanos).filter(|cycle| cycle % lost != lost - 1);
            let stamped = cycles.map(|cycle| {
                let stamp_nanos = cycle * cycle_nanos;
                #[expect(clippy::cast_precision_loss, reason = "a time")]
                let time_s = stamp_nanos as f64 * 1e-9;
                let position_m = Vector3::new(0.3 * time_s, 0.1 * time_s * time_s, 0.0);
                (stamp_nanos, Some(Pose { position_m, orientation: UnitQuaternion::identity() }))
            });
            let found = motions(&robot.params(), stamped.clone());
            assert_eq!(found.len(), stamped.count());
            let known: Vec<Motion> = found.into_iter().flatten().collect();
            assert!(known.len() > 40, "{cycle_nanos}, {lost}: {}", known.len());
            for motion in known {
                let error = motion.acceleration_m_per_s2 - Vector3::new(0.0, 0.2, 0.0);
                assert!(error.norm() < 1e-6, "{cycle_nanos}, {lost}: {error}");
            }
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
        let found = wrenches(&robot, 4_000_000, &poses);
        // 0.6 m/s² from cycle 50 on.
        assert!(found[10..40].iter().all(Option::is_some) && found[55..].iter().all(Option::is_none));
    }
}
