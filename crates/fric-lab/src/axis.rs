//! The six Cartesian axes of a platform: along and about the base axes.

use fric_core::{Pose, Wrench};
use nalgebra::{UnitQuaternion, Vector3, Vector6};

/// An axis along or about which the platform moves, named as in table II of \[P\].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CartesianAxis {
    /// Along base x.
    X,
    /// Along base y.
    Y,
    /// Along base z.
    Z,
    /// About base x.
    A,
    /// About base y.
    B,
    /// About base z.
    C,
}

impl CartesianAxis {
    /// All six axes in the order of a wrench: force, then torque.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::A, Self::B, Self::C];

    /// Returns `x`, `y`, `z`, `a`, `b` or `c`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::A => "a",
            Self::B => "b",
            Self::C => "c",
        }
    }

    /// Returns the unit of the wrench component along it.
    #[must_use]
    pub fn wrench_unit(self) -> &'static str {
        if self.is_rotation() { "Nm" } else { "N" }
    }

    /// Whether it is a rotation.
    #[must_use]
    pub fn is_rotation(self) -> bool {
        matches!(self, Self::A | Self::B | Self::C)
    }

    /// Returns the base axis along or about which it acts.
    #[must_use]
    pub fn direction(self) -> Vector3<f64> {
        match self {
            Self::X | Self::A => Vector3::x(),
            Self::Y | Self::B => Vector3::y(),
            Self::Z | Self::C => Vector3::z(),
        }
    }

    /// Returns the component of a wrench along it, N or N m.
    #[must_use]
    pub fn component(self, wrench: &Wrench) -> f64 {
        let part = if self.is_rotation() { &wrench.torque_nm } else { &wrench.force_n };
        part.dot(&self.direction())
    }

    /// Returns its index in a wrench.
    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

/// Returns the displacement of a pose from another: position, m, and rotation vector in base axes, rad (`R = exp(θ)·R_other`).
pub(crate) fn displacement(pose: &Pose, from: &Pose) -> Vector6<f64> {
    let moved_m = pose.position_m - from.position_m;
    let turned_rad = (pose.orientation * from.orientation.inverse()).scaled_axis();
    Vector6::new(moved_m.x, moved_m.y, moved_m.z, turned_rad.x, turned_rad.y, turned_rad.z)
}

/// Returns the rotation for a rotation vector, rad; bit-identical on every computer platform.
pub(crate) fn rotation(rotation_rad: &Vector3<f64>) -> UnitQuaternion<f64> {
    let angle_rad = libm::sqrt(rotation_rad.dot(rotation_rad));
    if angle_rad <= 0.0 {
        return UnitQuaternion::identity();
    }
    let (sin, cos) = libm::sincos(0.5 * angle_rad);
    UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_parts(cos, rotation_rad * (sin / angle_rad)))
}
