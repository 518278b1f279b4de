//! The simulated platform: the wrench on it and the directions of its cables.
//!
//! Newton-Euler about the platform origin reads `A^T f + w = 0` (\[P\] 2, with gravity and inertia in w; [`Body::wrench`]).

use fric_core::{CableParams, Pose, RobotParams, Wrench};
use nalgebra::{UnitQuaternion, Vector3, Vector6};

use crate::trajectory::SetPoint;
use crate::weight::{Body, Motion};

/// Mass, attachment points and cables; cables without geometry are left out.
#[derive(Clone, Debug)]
pub struct Platform {
    body: Body,
    cables: Vec<Attached>,
}

#[derive(Clone, Copy, Debug)]
struct Attached {
    params: CableParams,
    base_m: Vector3<f64>,
    platform_m: Vector3<f64>,
}

impl Platform {
    pub fn new(robot: &RobotParams<'_>) -> Self {
        let cables = robot.cables().iter().filter_map(|cable| {
            let (base_m, platform_m) = cable.base_m().zip(cable.platform_m())?;
            Some(Attached { params: *cable, base_m, platform_m })
        });
        Self { body: Body::of(robot), cables: cables.collect() }
    }

    /// Returns the number of attached cables.
    pub fn cable_count(&self) -> usize {
        self.cables.len()
    }

    /// Returns the weight, N.
    pub fn weight_n(&self) -> f64 {
        self.body.mass_kg * self.body.gravity_m_per_s2.norm()
    }

    /// Returns the unit vector of gravity; downwards if there is none.
    pub fn down(&self) -> Vector3<f64> {
        self.body.gravity_m_per_s2.try_normalize(1e-9).unwrap_or_else(|| -Vector3::z())
    }

    /// Returns the root mean square distance of the attachments from the platform origin, m.
    pub fn arm_m(&self) -> f64 {
        let squares: Vec<f64> = self.cables.iter().map(|cable| cable.platform_m.norm_squared()).collect();
        mean(&squares).sqrt()
    }

    /// Returns the least and the greatest corner of the points where the cables enter their last pulleys.
    pub fn base_corners_m(&self) -> [Vector3<f64>; 2] {
        let start = [f64::INFINITY, f64::NEG_INFINITY].map(Vector3::repeat);
        self.cables
            .iter()
            .fold(start, |[least, greatest], cable| [least.inf(&cable.base_m), greatest.sup(&cable.base_m)])
    }

    /// Returns the pose at a position, aligned with the base axes.
    pub fn pose(position_m: Vector3<f64>) -> Pose {
        Pose { position_m, orientation: UnitQuaternion::identity() }
    }

    /// Computes the columns `[u; R b × u]` of `A^T`, with u from the platform to the point where the cable leaves its pulley. Returns false if a
    /// cable cannot leave its pulley; the columns are then unchanged.
    pub fn structure(&self, pose: &Pose, columns: &mut Vec<Vector6<f64>>) -> bool {
        if self.cables.iter().any(|cable| cable.params.direction(pose).is_none()) {
            return false;
        }
        columns.clear();
        columns.extend(self.cables.iter().filter_map(|cable| {
            let direction = cable.params.direction(pose)?;
            Some(stack(&direction, &(pose.orientation * cable.platform_m).cross(&direction)))
        }));
        true
    }

    /// Returns the wrench of gravity and inertia at an orientation and an acceleration of the platform that does not turn.
    pub fn outside_wrench(
        &self,
        orientation: &UnitQuaternion<f64>,
        acceleration_m_per_s2: &Vector3<f64>,
    ) -> Vector6<f64> {
        let motion = Motion { acceleration_m_per_s2: *acceleration_m_per_s2, ..Motion::default() };
        self.body.wrench(orientation, &motion).to_vector()
    }

    /// Returns the wrench of gravity and inertia at a set point.
    pub fn wrench_at(&self, set_point: &SetPoint) -> Vector6<f64> {
        let lever_m = set_point.orientation * self.body.center_of_mass_m;
        let (velocity, acceleration) =
            (set_point.angular_velocity_rad_per_s, set_point.angular_acceleration_rad_per_s2);
        let motion = Motion {
            acceleration_m_per_s2: set_point.acceleration_m_per_s2
                + acceleration.cross(&lever_m)
                + velocity.cross(&velocity.cross(&lever_m)),
            angular_velocity_rad_per_s: velocity,
            angular_acceleration_rad_per_s2: acceleration,
        };
        self.body.wrench(&set_point.orientation, &motion).to_vector()
    }
}

/// Returns `−A^T f`: the external wrench on the platform if it moves exactly as its cables pull.
pub fn balanced_wrench(columns: &[Vector6<f64>], forces_n: impl Iterator<Item = f64>) -> Wrench {
    let sum = columns.iter().zip(forces_n).fold(Vector6::zeros(), |sum, (column, force_n)| sum - column * force_n);
    Wrench { force_n: sum.fixed_rows::<3>(0).into_owned(), torque_nm: sum.fixed_rows::<3>(3).into_owned() }
}

fn stack(force: &Vector3<f64>, torque: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z)
}

fn mean(values: &[f64]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a number of cables")]
    let count = values.len().max(1) as f64;
    values.iter().sum::<f64>() / count
}
