//! Errors of the robot file in the platform and the geometry of the cables, as candidates beside the effects. Otherwise they would be named friction.
//!
//! In `A^T f + w = 0` (\[P\] 3) the structure matrix `A^T` depends on the points where cables enter their last pulleys and where they are attached.
//! If the outside wrench `w` is computed from weight and inertia, it depends on mass, centre of mass, inertia tensor and gravity; a measured wrench
//! does not.

use std::borrow::Cow;
use std::collections::BTreeMap;

use fric_core::robot::RobotParams;
use fric_core::robot::edit::PlatformEdit;
use fric_core::{CableParams, Pose};
use nalgebra::{Matrix3, Vector3, Vector6};

use crate::replay::WrenchReference;
use crate::samples::noise::white_noise;
use crate::weight::{Body, Motion};

/// An entry of the robot file that may be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Geometry {
    /// Mass of the platform.
    Mass,
    /// Its centre of mass.
    CenterOfMass,
    /// Its inertia tensor about the centre of mass. It is no candidate, but fitted with the friction: few files state it, every platform has one, and what it
    /// explains is no evidence for anything else.
    Inertia,
    /// Direction of gravity in the base frame.
    Gravity,
    /// The point where the cable of this index enters its last pulley.
    Base(usize),
    /// The point where the cable of this index is attached to the platform.
    Attachment(usize),
}

/// Corrections of entries: kg, m, kg m², and for gravity two components perpendicular to the given one, m/s².
pub type Changes = BTreeMap<Geometry, Vec<f64>>;

/// One vector per sample, or per sample and cable: borrowed if unchanged.
pub type Series<'a> = Cow<'a, [Vector6<f64>]>;

/// Step of the finite differences, as a fraction of [`Description::size`]. All functions here are nearly linear over it, and rounding is 1e-12 of it.
const STEP_RATIO: f64 = 1e-4;

/// Minimum mass, as a fraction of the stated one. A platform without weight on slack cables is always in balance.
const LEAST_MASS_RATIO: f64 = 0.1;

/// Greatest noise of the angular acceleration, as a fraction of its square. A fit makes the moments too small by as much.
const MOST_NOISE: f64 = 0.05;

impl Geometry {
    /// Returns its key in the robot file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Mass => "mass_kg",
            Self::CenterOfMass => "center_of_mass_m",
            Self::Inertia => "inertia_kg_m2",
            Self::Gravity => "gravity_m_per_s2",
            Self::Base(_) => "base_m",
            Self::Attachment(_) => "platform_m",
        }
    }

    /// Returns the index of its cable, if it belongs to one.
    #[must_use]
    pub const fn cable(self) -> Option<usize> {
        match self {
            Self::Base(cable) | Self::Attachment(cable) => Some(cable),
            Self::Mass | Self::CenterOfMass | Self::Inertia | Self::Gravity => None,
        }
    }

    /// Returns the names of its numbers in results.
    #[must_use]
    pub const fn names(self) -> &'static [&'static str] {
        match self {
            Self::Mass => &["mass_kg"],
            Self::CenterOfMass | Self::Base(_) | Self::Attachment(_) => &["x_m", "y_m", "z_m"],
            Self::Inertia => &["xx_kg_m2", "xy_kg_m2", "xz_kg_m2", "yy_kg_m2", "yz_kg_m2", "zz_kg_m2"],
            Self::Gravity => &["x_m_per_s2", "y_m_per_s2", "z_m_per_s2"],
        }
    }

    /// Returns how many numbers a fit varies for it.
    #[must_use]
    pub const fn count(self) -> usize {
        match self {
            Self::Mass => 1,
            Self::Gravity => 2,
            Self::Inertia => 6,
            Self::CenterOfMass | Self::Base(_) | Self::Attachment(_) => 3,
        }
    }
}

/// The robot as its file describes it, with the poses of a log.
#[derive(Clone, Copy, Debug)]
pub struct Description<'a> {
    pub robot: &'a RobotParams<'a>,
    pub reference: WrenchReference,
    pub poses: &'a [Option<Pose>],
    /// The motion of the platform in each sample; empty if the wrench is measured.
    pub motions: &'a [Option<Motion>],
    /// Columns of the structure matrix: all cables of a sample, one sample after the other.
    pub structure: &'a [Vector6<f64>],
    /// The outside wrench of each sample; NaN where there is none.
    pub outside: &'a [Vector6<f64>],
}

impl<'a> Description<'a> {
    /// Returns the entries that may be wrong.
    pub fn candidates(&self) -> Vec<Geometry> {
        let of_platform = [Geometry::Mass, Geometry::CenterOfMass, Geometry::Gravity];
        let of_cables = (0..self.count()).flat_map(|cable| [Geometry::Base(cable), Geometry::Attachment(cable)]);
        let is_known = self.reference == WrenchReference::Mass;
        of_platform.into_iter().filter(|_| is_known).chain(of_cables).collect()
    }

    /// Returns the corrections that are fitted with the friction: of the inertia tensor, if the wrench depends on it.
    pub fn fitted(&self) -> Changes {
        let of = Geometry::Inertia;
        let mut motions = self.motions.iter().flatten();
        let is_turned = motions.any(|motion| motion.angular_acceleration_rad_per_s2.norm() > 0.0);
        (is_turned && self.size(of) > 0.0).then(|| (of, vec![0.0; of.count()])).into_iter().collect()
    }

    /// Whether the noise of the poses is little beside the angular accelerations: below [`MOST_NOISE`] of their square.
    pub fn sees_turns(&self) -> bool {
        let (mut squares, mut noise_squares) = (0.0, 0.0);
        for axis in 0..3 {
            let of = |motion: &Option<Motion>| {
                motion.map_or(f64::NAN, |motion| motion.angular_acceleration_rad_per_s2[axis])
            };
            let series: Vec<f64> = self.motions.iter().map(of).filter(|number| number.is_finite()).collect();
            let Some(noise) = white_noise(&series) else { return false };
            #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
            let count = series.len() as f64;
            squares += series.iter().map(|number| number * number).sum::<f64>();
            noise_squares += count * noise * noise;
        }
        noise_squares <= MOST_NOISE * squares
    }

    fn count(&self) -> usize {
        self.robot.cables().len()
    }

    /// Returns structure matrix and outside wrench with corrected entries.
    pub fn changed(&self, changes: &Changes) -> (Series<'a>, Series<'a>) {
        let (mut structure, mut outside) = (Cow::Borrowed(self.structure), Cow::Borrowed(self.outside));
        for cable in 0..self.count() {
            let Some(moved) = self.moved(cable, changes) else { continue };
            let columns = structure.to_mut().iter_mut().skip(cable).step_by(self.count());
            columns.zip(self.poses).for_each(|(column, pose)| *column = column_of(&moved, pose.as_ref()));
        }
        if changes.keys().any(|of| of.cable().is_none()) {
            let body = self.body(changes);
            let samples = outside.to_mut().iter_mut().zip(self.poses.iter().zip(self.motions));
            for (wrench, (pose, motion)) in samples {
                if let Some((pose, motion)) = pose.zip(*motion) {
                    *wrench = body.wrench(&pose.orientation, &motion).to_vector();
                }
            }
        }
        (structure, outside)
    }

    /// Returns a cable with corrected geometry; `None` if nothing of it is corrected.
    pub fn moved(&self, cable: usize, changes: &Changes) -> Option<CableParams> {
        let of = |geometry: Geometry| changes.get(&geometry).map(Vec::as_slice);
        let (base, attachment) = (of(Geometry::Base(cable)), of(Geometry::Attachment(cable)));
        if base.is_none() && attachment.is_none() {
            return None;
        }
        let params = self.robot.cables().get(cable)?;
        params.with_geometry(shifted(params.base_m()?, base), shifted(params.platform_m()?, attachment))
    }

    /// Returns the platform with corrected entries.
    fn body(&self, changes: &Changes) -> Body {
        Body {
            mass_kg: self.mass_kg(changes),
            center_of_mass_m: self.center_of_mass_m(changes),
            inertia_kg_m2: self.inertia_kg_m2(changes),
            gravity_m_per_s2: self.gravity_m_per_s2(changes),
        }
    }

    fn mass_kg(&self, changes: &Changes) -> f64 {
        let by_kg = changes.get(&Geometry::Mass).and_then(|by| by.first()).copied().unwrap_or(0.0);
        self.robot.mass_kg() + by_kg
    }

    fn center_of_mass_m(&self, changes: &Changes) -> Vector3<f64> {
        let by_m = changes.get(&Geometry::CenterOfMass).map(Vec::as_slice);
        shifted(self.robot.center_of_mass_m(), by_m).into()
    }

    /// Returns the corrected inertia tensor. A moment that the samples hardly determine may come out below 0 and is then 0.
    fn inertia_kg_m2(&self, changes: &Changes) -> Matrix3<f64> {
        let given = self.robot.inertia_kg_m2();
        let by = changes.get(&Geometry::Inertia).and_then(|by| by.first_chunk::<6>());
        let Some([xx, xy, xz, yy, yz, zz]) = by.copied() else { return given };
        let mut tensor = given + Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        for place in 0..3 {
            tensor[(place, place)] = tensor[(place, place)].max(0.0);
        }
        tensor
    }

    /// Returns gravity in its corrected direction; its magnitude stays.
    fn gravity_m_per_s2(&self, changes: &Changes) -> Vector3<f64> {
        let given = self.robot.gravity_m_per_s2();
        let Some([across, along]) = changes.get(&Geometry::Gravity).and_then(|by| by.first_chunk::<2>()) else {
            return given;
        };
        let [one, other] = across_of(&given);
        let turned: Vector3<f64> = given + one * *across + other * *along;
        turned * (given.norm() / turned.norm())
    }

    /// Returns the corrected numbers of an entry, in the order of [`Geometry::names`].
    pub fn corrected(&self, of: Geometry, changes: &Changes) -> Vec<f64> {
        let cable = |cable: usize| self.moved(cable, changes).or_else(|| self.robot.cables().get(cable).copied());
        let point = match of {
            Geometry::Mass => return vec![self.mass_kg(changes)],
            Geometry::CenterOfMass => Some(self.center_of_mass_m(changes)),
            Geometry::Inertia => return entries(&self.inertia_kg_m2(changes)).to_vec(),
            Geometry::Gravity => Some(self.gravity_m_per_s2(changes)),
            Geometry::Base(of) => cable(of).and_then(|params| params.base_m()),
            Geometry::Attachment(of) => cable(of).and_then(|params| params.platform_m()),
        };
        point.map_or_else(Vec::new, |point| point.iter().copied().collect())
    }

    /// Returns the corrections for the `[platform]` table of the robot file.
    pub fn platform_edit(&self, changes: &Changes) -> PlatformEdit {
        let has = |of: Geometry| changes.contains_key(&of);
        PlatformEdit {
            mass_kg: has(Geometry::Mass).then(|| self.mass_kg(changes)),
            center_of_mass_m: has(Geometry::CenterOfMass).then(|| self.center_of_mass_m(changes).into()),
            inertia_kg_m2: has(Geometry::Inertia).then(|| entries(&self.inertia_kg_m2(changes))),
            gravity_m_per_s2: has(Geometry::Gravity).then(|| self.gravity_m_per_s2(changes).into()),
        }
    }

    /// Returns the derivative of the sum of all wrenches by each number of an entry, in every sample. `force_n` gives the force of a sample and cable.
    pub fn tangents(
        &self,
        of: Geometry,
        changes: &Changes,
        force_n: impl Fn(usize, usize) -> f64,
    ) -> Vec<Vec<Vector6<f64>>> {
        let step = STEP_RATIO * self.size(of);
        let tangent = |number: usize| {
            let mut beside = changes.clone();
            let numbers = beside.entry(of).or_insert_with(|| vec![0.0; of.count()]);
            numbers.iter_mut().skip(number).take(1).for_each(|entry| *entry += step);
            let from = changes.clone();
            if let Some(cable) = of.cable() {
                let params =
                    |changes: &Changes| self.moved(cable, changes).or_else(|| self.robot.cables().get(cable).copied());
                let (Some(from), Some(to)) = (params(&from), params(&beside)) else { return Vec::new() };
                let change = |(place, pose): (usize, &Option<Pose>)| {
                    let columns = column_of(&to, pose.as_ref()) - column_of(&from, pose.as_ref());
                    columns * (force_n(place, cable) / step)
                };
                return self.poses.iter().enumerate().map(change).collect();
            }
            let (from, to) = (self.body(&from), self.body(&beside));
            let change = |(pose, motion): (&Option<Pose>, &Option<Motion>)| {
                let Some((pose, motion)) = pose.zip(*motion) else { return Vector6::repeat(f64::NAN) };
                let of = |body: &Body| body.wrench(&pose.orientation, &motion).to_vector();
                (of(&to) - of(&from)) / step
            };
            self.poses.iter().zip(self.motions).map(change).collect()
        };
        (0..of.count()).map(tangent).collect()
    }

    /// Returns the scale of an entry's numbers: no robot file is wrong by as much.
    pub fn size(&self, of: Geometry) -> f64 {
        match of {
            Geometry::Mass => self.robot.mass_kg(),
            Geometry::Gravity => self.robot.gravity_m_per_s2().norm(),
            Geometry::Inertia => (self.robot.mass_kg() * self.arm_square_m2()).max(self.robot.inertia_kg_m2().norm()),
            Geometry::CenterOfMass | Geometry::Base(_) | Geometry::Attachment(_) => 1.0,
        }
    }

    /// Returns the mean square distance of the attachments from the centre of mass.
    fn arm_square_m2(&self) -> f64 {
        let points = self.robot.cables().iter().filter_map(CableParams::platform_m);
        let square_m2 = |point: Vector3<f64>| (point - self.robot.center_of_mass_m()).norm_squared();
        let (sum, count) = points.fold((0.0, 0.0), |(sum, count), point| (sum + square_m2(point), count + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// Whether an entry is corrected by more than can be.
    pub fn is_at_end(&self, of: Geometry, changes: &Changes) -> bool {
        of == Geometry::Mass && self.mass_kg(changes) < LEAST_MASS_RATIO * self.robot.mass_kg()
    }

    /// Returns the usual error of an entry's numbers: the whole mass, because of payloads; the whole inertia, which few files state; 1° of the vertical;
    /// 10 mm of a point.
    pub fn usual(&self, of: Geometry) -> f64 {
        let ratio = match of {
            Geometry::Mass | Geometry::Inertia => 1.0,
            Geometry::Gravity => 1_f64.to_radians(),
            Geometry::CenterOfMass | Geometry::Base(_) | Geometry::Attachment(_) => 0.01,
        };
        ratio * self.size(of)
    }
}

/// Returns the entries of a symmetric tensor in the order of the robot file.
pub fn entries(tensor: &Matrix3<f64>) -> [f64; 6] {
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|place| tensor[place])
}

fn shifted(point: Vector3<f64>, by: Option<&[f64]>) -> [f64; 3] {
    let by = by.and_then(|by| by.first_chunk::<3>()).copied().unwrap_or_default();
    (point + Vector3::from(by)).into()
}

fn column_of(params: &CableParams, pose: Option<&Pose>) -> Vector6<f64> {
    pose.and_then(|pose| params.structure_column(pose)).unwrap_or_else(|| Vector6::repeat(f64::NAN))
}

/// Returns two unit vectors perpendicular to a vector and to each other.
fn across_of(vector: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let least = vector.abs().imin();
    let axis = Vector3::from_fn(|row, _| f64::from(u8::from(row == least)));
    let one = vector.cross(&axis).normalize();
    [one, vector.cross(&one).normalize()]
}
