//! The platform: pose, wrench, structure matrix, inverse kinematics.
//!
//! It contains the types of the cycle's input and output, and the kinematics of a whole robot outside the cycle. The cycle itself computes the
//! columns of `A^T` four at a time ([`Compensator`](crate::Compensator)); [`structure_matrix`] computes the same from the validated parameters, with
//! `nalgebra`.

use nalgebra::{Matrix3, Quaternion, SMatrix, SVector, UnitQuaternion, Vector3};

use crate::robot::{CableParams, Geometry, RobotParams};
use crate::scalar::Scalar;
use crate::swivel::{self, Swivel};
use crate::words::Words;

/// Greatest deviation of a normalised quaternion's norm from 1: four rounded squares and a root, four rounded quotients.
const NORM_ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Greatest magnitude of a component of a quaternion with a norm of at most 1.1.
const GREATEST_PART: f64 = 1.2;

/// Pose of the platform in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Platform origin, m.
    pub position_m: Vector3<f64>,
    /// Rotation from platform to base axes.
    pub orientation: UnitQuaternion<f64>,
}

impl Pose {
    /// Returns the pose in which platform frame and base frame coincide.
    #[must_use]
    pub fn identity() -> Self {
        Self { position_m: Vector3::zeros(), orientation: UnitQuaternion::identity() }
    }

    /// Creates a pose from position (m) and quaternion `x, y, z, w`; the quaternion is normalised. A quaternion whose norm is 1 up to rounding is
    /// taken unchanged, so that the parts of a pose give that pose again, to the bit.
    ///
    /// Returns `None` if a number is not finite or the quaternion's norm differs from 1 by more than 10 %: an all-zero quaternion, as in an unset
    /// message, is no rotation.
    #[must_use]
    pub fn from_parts(position_m: [f64; 3], [x, y, z, w]: [f64; 4]) -> Option<Self> {
        // This check precedes squares and divisions: a square may overflow, the norm may be 0.
        if ![x, y, z, w].into_iter().all(|part| part.abs() <= GREATEST_PART) {
            return None;
        }
        let quaternion = Quaternion::new(w, x, y, z);
        let norm = quaternion.norm();
        if !(0.9..=1.1).contains(&norm) {
            return None;
        }
        let is_unit = (norm - 1.0).abs() <= NORM_ROUNDING;
        let unit = if is_unit { quaternion } else { quaternion / norm };
        let pose = Self { position_m: position_m.into(), orientation: UnitQuaternion::new_unchecked(unit) };
        pose.is_usable().then_some(pose)
    }

    /// Interpolates a fraction `ratio` (0…1) of the way to `other`: position linear, orientation along the shorter arc (normalised linear, which is
    /// exact to second order in the angle between the two).
    #[must_use]
    pub fn interpolate(&self, other: &Self, ratio: f64) -> Self {
        Self {
            position_m: self.position_m.lerp(&other.position_m, ratio),
            orientation: self.orientation.nlerp(
                &if self.orientation.coords.dot(&other.orientation.coords) < 0.0 {
                    UnitQuaternion::new_unchecked(-other.orientation.into_inner())
                } else {
                    other.orientation
                },
                ratio,
            ),
        }
    }

    /// Whether the cycle accepts the pose: position finite and within ±10⁶ m, orientation with a norm within 10 % of 1.
    #[inline]
    #[must_use]
    pub fn is_usable(&self) -> bool {
        let norm_squared = self.orientation.coords.norm_squared();
        self.position_m.iter().all(|place| place.abs() <= 1e6) && (0.81..=1.21).contains(&norm_squared)
    }
}

/// Force and torque in base axes, torque about the platform origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force, N.
    pub force_n: Vector3<f64>,
    /// Torque, N m.
    pub torque_nm: Vector3<f64>,
}

impl Wrench {
    /// Returns the wrench of gravity on the platform: `m·g` at the centre of mass.
    #[must_use]
    pub fn of_gravity(robot: &RobotParams<'_>, orientation: &UnitQuaternion<f64>) -> Self {
        let force_n = robot.gravity_m_per_s2 * robot.mass_kg;
        Self { force_n, torque_nm: (orientation * robot.center_of_mass_m).cross(&force_n) }
    }

    /// Returns the wrench as one vector, force first.
    #[must_use]
    pub fn to_vector(&self) -> SVector<f64, 6> {
        let (force, torque) = (&self.force_n, &self.torque_nm);
        SVector::<f64, 6>::new(force.x, force.y, force.z, torque.x, torque.y, torque.z)
    }
}

impl core::ops::Sub for Wrench {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { force_n: self.force_n - other.force_n, torque_nm: self.torque_nm - other.torque_nm }
    }
}

impl CableParams {
    /// Returns the cable length from the entry into the last pulley to the platform, m: `r·β + free` (\[P\] 1 with the pulley).
    ///
    /// Returns `None` without geometry, or if the attachment lies inside the last pulley.
    #[must_use]
    pub fn length_m(&self, pose: &Pose) -> Option<f64> {
        let geometry = self.geometry.as_ref()?;
        swivel::cable_length_m(&geometry.swivel(), &geometry.attachment_m(pose))
    }

    /// Returns the unit vector from the attachment to the point where the cable leaves its last pulley, base axes; `None` as for
    /// [`length_m`](Self::length_m).
    #[must_use]
    pub fn direction(&self, pose: &Pose) -> Option<Vector3<f64>> {
        let geometry = self.geometry.as_ref()?;
        let exit = swivel::exit(&geometry.swivel(), geometry.attachment_m(pose).into());
        exit.reachable.then(|| exit.direction.into())
    }

    /// Returns the cable's column of the structure matrix `A^T`, `[u; (R b) × u]` (\[P\] 2): the wrench on the platform per newton of tension, force
    /// first, torque about the platform origin; `None` as for [`length_m`](Self::length_m).
    #[must_use]
    pub fn structure_column(&self, pose: &Pose) -> Option<SVector<f64, 6>> {
        let direction = self.direction(pose)?;
        let arm_m = pose.orientation.to_rotation_matrix().into_inner() * self.geometry.as_ref()?.platform_m;
        Some(Wrench { force_n: direction, torque_nm: arm_m.cross(&direction) }.to_vector())
    }

    /// Returns the wrap angle of the swivelling last pulley, rad, 0…2π; `None` as for [`length_m`](Self::length_m), or if the last pulley does not
    /// swivel.
    #[must_use]
    pub fn pose_wrap_rad(&self, pose: &Pose) -> Option<f64> {
        let geometry = self.geometry.as_ref().filter(|_| self.needs_pose())?;
        let exit = swivel::exit(&geometry.swivel(), geometry.attachment_m(pose).into());
        exit.reachable.then(|| swivel::wrap_rad(exit.cos_sin_wrap))
    }
}

impl Geometry {
    pub(crate) fn swivel(&self) -> Swivel<f64> {
        Swivel { entry_m: self.base_m.into(), axis: self.axis.into(), radius_m: self.radius_m }
    }

    pub(crate) fn attachment_m(&self, pose: &Pose) -> Vector3<f64> {
        let rotation = pose.orientation.to_rotation_matrix().into_inner();
        attachment(pose, &rotation, self.platform_m.into()).0.into()
    }
}

/// Returns the attachment point in the base frame, m, and its offset from the platform origin in base axes (`R·b`), m; `rotation` is the pose's.
#[inline(always)]
pub(crate) fn attachment<T: Scalar>(pose: &Pose, rotation: &Matrix3<f64>, platform_m: [T; 3]) -> ([T; 3], [T; 3]) {
    let [px, py, pz] = platform_m;
    let turn = |x: f64, y: f64, z: f64| T::splat(x) * px + T::splat(y) * py + T::splat(z) * pz;
    let arm_m @ [ax, ay, az] = [
        turn(rotation.m11, rotation.m12, rotation.m13),
        turn(rotation.m21, rotation.m22, rotation.m23),
        turn(rotation.m31, rotation.m32, rotation.m33),
    ];
    let [x, y, z] = [pose.position_m.x, pose.position_m.y, pose.position_m.z].map(T::splat);
    ([x + ax, y + ay, z + az], arm_m)
}

/// Returns the structure matrix `A^T = [u_i; (R b_i) × u_i]` (\[P\] 2). The wrench of the cables on the platform is `A^T f`; the external wrench that
/// balances it is `−A^T f` (\[P\] 3).
///
/// It has `CABLES` columns; those past the robot's cables are zero. Returns `None` if a cable has no geometry or cannot leave its last pulley, or if
/// the robot has more than `CABLES` cables.
#[must_use]
pub fn structure_matrix<const CABLES: usize>(robot: &RobotParams<'_>, pose: &Pose) -> Option<SMatrix<f64, 6, CABLES>> {
    if robot.cables.len() > CABLES {
        return None;
    }
    let mut matrix = SMatrix::<f64, 6, CABLES>::zeros();
    for (mut column, cable) in matrix.column_iter_mut().zip(robot.cables) {
        column.copy_from(&cable.structure_column(pose)?);
    }
    Some(matrix)
}

impl Words for Wrench {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        for number in self.force_n.iter_mut().chain(&mut self.torque_nm) {
            number.each_word(show);
        }
    }
}

impl Words for Option<Wrench> {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        let (mut is_known, mut wrench) = (self.is_some(), self.unwrap_or_default());
        is_known.each_word(show);
        wrench.each_word(show);
        *self = is_known.then_some(wrench);
    }
}
