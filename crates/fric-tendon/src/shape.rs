//! The result of a static solution.

use core::fmt;
use core::ops::BitOr;

use fric_core::words::words_of;
use nalgebra::Vector2;

use super::params::{MAX_DISKS, Tendon};

/// Flags of one solution; [`ShapeStatus::OK`] if there is no fault.
///
/// | flag | cause | what the shape is |
/// |---|---|---|
/// | `NOT_FINITE` | a tension that is not finite or negative, or a list of the wrong length | the last one that was right |
/// | `NOT_CONVERGED` | no equilibrium found within the iterations and load steps | the last one that was right |
/// | `UNSTABLE` | the equilibrium found is no minimum of the energy: the manipulator would leave it | the last one that was right |
/// | `OVER_CAPACITY` | a tension above the tendon's capacity | computed as usual |
/// | `DISKS_TOUCH` | two holes are nearer than a disk is thick: bend beyond the model | computed as usual |
/// | `MEMORY_UNCERTAIN` | since [`begin_history`](super::StaticModel::begin_history) some hole has not slid | computed as usual |
///
/// With any of the first three the state of the holes is unchanged, too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[must_use]
pub struct ShapeStatus(u32);

impl ShapeStatus {
    /// No fault.
    pub const OK: Self = Self(0);
    /// The input is not usable.
    pub const NOT_FINITE: Self = Self(1);
    /// No equilibrium was found.
    pub const NOT_CONVERGED: Self = Self(1 << 1);
    /// The equilibrium is not stable.
    pub const UNSTABLE: Self = Self(1 << 2);
    /// A tendon may break.
    pub const OVER_CAPACITY: Self = Self(1 << 3);
    /// Disks would touch.
    pub const DISKS_TOUCH: Self = Self(1 << 4);
    /// A hole may still hold friction from before the history began.
    pub const MEMORY_UNCERTAIN: Self = Self(1 << 5);

    /// Every flag with its name, lowest bit first.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("NOT_FINITE", Self::NOT_FINITE),
        ("NOT_CONVERGED", Self::NOT_CONVERGED),
        ("UNSTABLE", Self::UNSTABLE),
        ("OVER_CAPACITY", Self::OVER_CAPACITY),
        ("DISKS_TOUCH", Self::DISKS_TOUCH),
        ("MEMORY_UNCERTAIN", Self::MEMORY_UNCERTAIN),
    ];

    const FAILED: Self = Self(Self::NOT_FINITE.0 | Self::NOT_CONVERGED.0 | Self::UNSTABLE.0);

    /// Returns the flags as a number.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether there is no fault.
    #[must_use]
    pub const fn is_ok(self) -> bool {
        self.0 == 0
    }

    /// Whether there is a new shape; otherwise the shape is the last valid one.
    #[must_use]
    pub const fn has_shape(self) -> bool {
        self.0 & Self::FAILED.0 == 0
    }

    /// Whether all flags of `other` are set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl BitOr for ShapeStatus {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Writes `ok`, or the names of the flags separated by `|`.
impl fmt::Display for ShapeStatus {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_flags(formatter, Self::NAMES.iter().filter(|(_, flag)| self.contains(*flag)).map(|(name, _)| *name))
    }
}

/// Writes `ok`, or the names separated by `|`.
pub(super) fn write_flags(
    formatter: &mut fmt::Formatter<'_>,
    names: impl Iterator<Item = &'static str>,
) -> fmt::Result {
    let mut is_first = true;
    for name in names {
        formatter.write_str(if is_first { "" } else { "|" })?;
        formatter.write_str(name)?;
        is_first = false;
    }
    if is_first { formatter.write_str("ok") } else { Ok(()) }
}

/// A manipulator in equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape<const DISKS: usize> {
    pub(super) count: usize,
    pub(super) bend_rad: [f64; DISKS],
    pub(super) position_m: [[f64; 2]; DISKS],
    pub(super) base_tension_n: [f64; 2],
    pub(super) tension_n: [[f64; DISKS]; 2],
    pub(super) friction_n: [[f64; DISKS]; 2],
    pub(super) bound_n: [[f64; DISKS]; 2],
}

words_of!(Shape<const DISKS> { count, bend_rad, position_m, base_tension_n, tension_n, friction_n, bound_n });

impl<const DISKS: usize> Shape<DISKS> {
    /// Returns the straight shape without tension.
    pub(super) fn straight(count: usize, pitch_m: &[f64; MAX_DISKS]) -> Self {
        let mut position_m = [[0.0; 2]; DISKS];
        let mut along_m = 0.0;
        for ([x, _], pitch_m) in position_m.iter_mut().zip(pitch_m) {
            along_m += pitch_m;
            *x = along_m;
        }
        let zeros = [[0.0; DISKS]; 2];
        Self {
            count,
            bend_rad: [0.0; DISKS],
            position_m,
            base_tension_n: [0.0; 2],
            tension_n: zeros,
            friction_n: zeros,
            bound_n: zeros,
        }
    }

    fn used<'a, T>(&self, all: &'a [T; DISKS]) -> &'a [T] {
        all.get(..self.count).unwrap_or(all)
    }

    /// Returns the centres of the disks, starting at the base, base frame, m. These are the markers of \[C\].
    #[must_use]
    pub fn disk_position_m(&self) -> &[[f64; 2]] {
        self.used(&self.position_m)
    }

    /// Returns the bend of each segment, starting at the base, rad.
    #[must_use]
    pub fn segment_bend_rad(&self) -> &[f64] {
        self.used(&self.bend_rad)
    }

    /// Returns the bend of the whole manipulator, rad: the direction of the last disk.
    #[must_use]
    pub fn bend_rad(&self) -> f64 {
        self.segment_bend_rad().iter().sum()
    }

    /// Returns the tension `T_0` of a tendon at the base, N.
    #[must_use]
    pub fn base_tension_n(&self, tendon: Tendon) -> f64 {
        *tendon.of(&self.base_tension_n)
    }

    /// Returns the tension of a tendon in each segment, N.
    #[must_use]
    pub fn tension_n(&self, tendon: Tendon) -> &[f64] {
        self.used(tendon.of(&self.tension_n))
    }

    /// Returns the friction of a tendon at each hole, N: `T_{i−1} − T_i`, positive if the base side is tighter.
    #[must_use]
    pub fn friction_n(&self, tendon: Tendon) -> &[f64] {
        self.used(tendon.of(&self.friction_n))
    }

    /// Returns the greatest friction of a tendon at each hole, `μ·F_N` (\[C\] 13), N.
    #[must_use]
    pub fn bound_n(&self, tendon: Tendon) -> &[f64] {
        self.used(tendon.of(&self.bound_n))
    }
}

/// Returns `vector` rotated by an angle.
pub(super) fn turned((sin, cos): (f64, f64), vector: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(cos * vector.x - sin * vector.y, sin * vector.x + cos * vector.y)
}
