//! Parameters of a manipulator: options as stated, checked once.

use core::fmt;

use fric_core::parameters::GREATEST_MU;
use fric_core::robot::{ParamProblem, check};
use nalgebra::Vector2;

use super::friction::Hole;

/// Maximum number of disks of a manipulator.
pub const MAX_DISKS: usize = 32;

/// Greatest unloaded bend of a segment, rad.
const GREATEST_REST_BEND_RAD: f64 = 1.0;

/// One of the two tendons in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tendon {
    /// The tendon in the holes on the side of +y; pulling it bends the manipulator towards +y.
    Agonist,
    /// The tendon in the holes on the side of −y.
    Antagonist,
}

impl Tendon {
    /// Both tendons, in the order of every pair.
    pub const BOTH: [Self; 2] = [Self::Agonist, Self::Antagonist];

    /// Returns this tendon's element of a pair.
    #[must_use]
    pub fn of<T>(self, pair: &[T; 2]) -> &T {
        let [agonist, antagonist] = pair;
        match self {
            Self::Agonist => agonist,
            Self::Antagonist => antagonist,
        }
    }
}

/// Options of a tendon and its holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonOptions<'a> {
    /// Friction coefficient μ between tendon and hole, 0…0.9: one for all holes, or one per hole, starting at the base plate.
    pub mu: &'a [f64],
    /// Presliding stiffness σ of a hole, N/m: one for all, or one per hole. `f_c/σ` is the distance over which friction builds up.
    pub sigma_n_per_m: &'a [f64],
    /// Axial stiffness E·A, N.
    pub axial_stiffness_n: f64,
    /// Tension capacity of the tendon, N.
    pub capacity_n: f64,
}

impl TendonOptions<'static> {
    /// Returns the optical fibre of \[C\] in its holes.
    ///
    /// Published: μ = 0.1753 in a single hole, capacity 4 N, ⌀ 0.5 mm in holes of ⌀ 0.8 mm. Chosen here: E·A = 13.7 kN, a silica fibre of that
    /// diameter at 70 GPa (the strain form \[C\] 4 with 1550 nm and P_e = 0.22 then gives 11.4 N/nm); σ = 20 kN/m, with which friction of 0.05 N
    /// builds up within 2.5 μm, a typical value for a polymer coating on metal.
    #[must_use]
    pub const fn published() -> Self {
        Self { mu: &[0.1753], sigma_n_per_m: &[20_000.0], axial_stiffness_n: 13_700.0, capacity_n: 4.0 }
    }
}

/// Options of a manipulator. Vectors are in the base frame (x along the straight manipulator, y towards the first tendon).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ManipulatorOptions<'a> {
    /// Number of disks without the base plate, 1…[`MAX_DISKS`]; the number of segments is the same.
    pub disk_count: usize,
    /// Distance between the centres of neighbouring disks, m: the length of backbone in a segment, which bends within the disks too. One for all
    /// segments, or one per segment, starting at the base plate.
    pub pitch_m: &'a [f64],
    /// Thickness of a disk, m.
    pub disk_thickness_m: f64,
    /// Radius of the circle of holes, m.
    pub hole_radius_m: f64,
    /// E·I of the backbone, N m²; see [`rectangle_bending_stiffness_n_m2`].
    pub bending_stiffness_n_m2: f64,
    /// E·I of a segment relative to that, 0.01…100: one for all segments, or one per segment, starting at the base plate.
    pub segment_stiffness_ratio: &'a [f64],
    /// Curvature of the unloaded backbone, 1/m, towards +y, at most 1 rad in the longest segment: one for all segments, or one per segment.
    pub precurvature_per_m: &'a [f64],
    /// Mass of a disk, kg.
    pub disk_mass_kg: f64,
    /// Mass of the backbone per length, kg/m.
    pub backbone_mass_kg_per_m: f64,
    /// Gravity, m/s².
    pub gravity_m_per_s2: [f64; 2],
    /// Mass attached to the centre of the last disk, kg.
    pub tip_mass_kg: f64,
    /// Force of constant direction on the centre of the last disk, N.
    pub tip_force_n: [f64; 2],
    /// The tendons.
    pub tendons: [TendonOptions<'a>; 2],
}

impl ManipulatorOptions<'static> {
    /// Returns the prototype of \[C\], lying flat: no gravity in the plane of bending, no load.
    ///
    /// Published: 8 disks of 2 mm, 35 mm between them, holes on a circle of ⌀ 30 mm, backbone of steel sheet 0.3 × 6 mm. Chosen here: steel with E =
    /// 200 GPa and 7850 kg/m³; disks of 3 g.
    #[must_use]
    pub const fn published() -> Self {
        Self {
            disk_count: 8,
            pitch_m: &[0.037],
            disk_thickness_m: 0.002,
            hole_radius_m: 0.015,
            bending_stiffness_n_m2: rectangle_bending_stiffness_n_m2(200e9, 0.006, 0.0003),
            segment_stiffness_ratio: &[1.0],
            precurvature_per_m: &[0.0],
            disk_mass_kg: 0.003,
            backbone_mass_kg_per_m: 7850.0 * 0.006 * 0.0003,
            gravity_m_per_s2: [0.0, 0.0],
            tip_mass_kg: 0.0,
            tip_force_n: [0.0, 0.0],
            tendons: [TendonOptions::published(); 2],
        }
    }
}

/// Returns E·I of a rectangular strip that bends about its wide side, N m²: `E·b·h³/12`.
#[must_use]
pub const fn rectangle_bending_stiffness_n_m2(youngs_modulus_pa: f64, width_m: f64, thickness_m: f64) -> f64 {
    youngs_modulus_pa * width_m * thickness_m * thickness_m * thickness_m / 12.0
}

/// A checked tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TendonParams {
    mu: [f64; MAX_DISKS],
    sigma_n_per_m: [f64; MAX_DISKS],
    pub axial_stiffness_n: f64,
    pub capacity_n: f64,
}

/// A checked manipulator, from which a [`StaticModel`](super::StaticModel) is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ManipulatorParams {
    pub(crate) disk_count: usize,
    /// Length of each segment, and their sum, m.
    pub(crate) pitch_m: [f64; MAX_DISKS],
    length_m: f64,
    pub(crate) disk_thickness_m: f64,
    pub(crate) hole_radius_m: f64,
    pub(crate) bending_stiffness_n_m2: f64,
    /// E·I of each segment, N m².
    pub(crate) segment_stiffness_n_m2: [f64; MAX_DISKS],
    /// Unloaded bend of each segment, rad.
    pub(crate) rest_bend_rad: [f64; MAX_DISKS],
    /// Force on each disk, on the backbone of each segment and on the tip, N.
    pub(crate) disk_weight_n: Vector2<f64>,
    pub(crate) backbone_weight_n: [Vector2<f64>; MAX_DISKS],
    pub(crate) tip_force_n: Vector2<f64>,
    /// Force of all weight and tip load beyond the middle of each segment, N.
    pub(crate) middle_force_n: [Vector2<f64>; MAX_DISKS],
    pub(crate) tendons: [TendonParams; 2],
}

/// The reason why a manipulator was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ManipulatorError {
    /// The tendon, if the parameter belongs to one.
    pub tendon: Option<Tendon>,
    /// Name of the parameter, including its unit.
    pub key: &'static str,
    /// Index in its list, from 0, if it is in one.
    pub place: Option<usize>,
    /// The problem.
    pub problem: ParamProblem,
}

impl fmt::Display for ManipulatorError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "`{}`", self.key)?;
        match self.tendon {
            Some(Tendon::Agonist) => formatter.write_str(" of the tendon")?,
            Some(Tendon::Antagonist) => formatter.write_str(" of the antagonist")?,
            None => {}
        }
        if let Some(place) = self.place {
            write!(formatter, " at place {}", place + 1)?;
        }
        write!(formatter, " {}", self.problem)
    }
}

impl core::error::Error for ManipulatorError {}

/// Returns `value` if it is finite and in `min…max`.
fn checked(key: &'static str, value: f64, min: f64, max: f64) -> Result<f64, ManipulatorError> {
    check(key, value, min, max).map_err(|error| ManipulatorError {
        tendon: None,
        key,
        place: None,
        problem: error.problem,
    })
}

fn checked_vector(key: &'static str, vector: [f64; 2], most: f64) -> Result<Vector2<f64>, ManipulatorError> {
    let [x, y] = vector;
    Ok(Vector2::new(checked(key, x, -most, most)?, checked(key, y, -most, most)?))
}

pub(crate) fn count_error(key: &'static str, count: usize, min: usize, max: usize) -> ManipulatorError {
    ManipulatorError { tendon: None, key, place: None, problem: ParamProblem::Count { count, min, max } }
}

/// Expands one number for all, or checks one per item.
fn spread(
    key: &'static str,
    given: &[f64],
    count: usize,
    (min, max): (f64, f64),
) -> Result<[f64; MAX_DISKS], ManipulatorError> {
    if given.len() != 1 && given.len() != count {
        return Err(count_error(key, given.len(), if given.is_empty() { 1 } else { count }, count));
    }
    let mut all = [given.first().copied().unwrap_or(min); MAX_DISKS];
    for (place, (value, given)) in all.iter_mut().zip(given).enumerate() {
        *value = checked(key, *given, min, max).map_err(|error| ManipulatorError { place: Some(place), ..error })?;
    }
    Ok(all)
}

/// Returns the sum of the segments' lengths; for equal ones the product, whose rounding does not grow with their number.
fn length(pitch_m: &[f64]) -> f64 {
    let first_m = pitch_m.first().copied().unwrap_or(0.0);
    #[expect(clippy::cast_precision_loss, reason = "at most MAX_DISKS")]
    let count = pitch_m.len() as f64;
    let is_even = pitch_m.iter().all(|pitch_m| pitch_m.to_bits() == first_m.to_bits());
    if is_even { first_m * count } else { pitch_m.iter().sum() }
}

fn products(one: &[f64; MAX_DISKS], other: &[f64; MAX_DISKS]) -> [f64; MAX_DISKS] {
    let mut products = *one;
    for (product, factor) in products.iter_mut().zip(other) {
        *product *= factor;
    }
    products
}

impl TendonParams {
    fn new(options: &TendonOptions<'_>, disk_count: usize) -> Result<Self, ManipulatorError> {
        Ok(Self {
            mu: spread("mu", options.mu, disk_count, (0.0, GREATEST_MU))?,
            sigma_n_per_m: spread("sigma_n_per_m", options.sigma_n_per_m, disk_count, (1.0, 1e7))?,
            axial_stiffness_n: checked("axial_stiffness_n", options.axial_stiffness_n, 1.0, 1e9)?,
            capacity_n: checked("capacity_n", options.capacity_n, 1e-6, 1e6)?,
        })
    }

    pub fn holes(&self) -> impl Iterator<Item = Hole> {
        self.mu.iter().zip(&self.sigma_n_per_m).map(|(&mu, &sigma_n_per_m)| Hole { mu, sigma_n_per_m })
    }
}

impl ManipulatorParams {
    /// Checks a manipulator.
    ///
    /// # Errors
    /// Returns a [`ManipulatorError`] with the first parameter that is not finite, out of its range or inconsistent with another.
    pub fn new(options: &ManipulatorOptions<'_>) -> Result<Self, ManipulatorError> {
        let count = options.disk_count;
        if count == 0 || count > MAX_DISKS {
            return Err(count_error("disk_count", count, 1, MAX_DISKS));
        }
        let pitch_m = spread("pitch_m", options.pitch_m, count, (1e-5, 10.0))?;
        let used_m = pitch_m.get(..count).unwrap_or(&pitch_m);
        let (shortest_m, longest_m) = used_m
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(least_m, most_m), pitch_m| (least_m.min(*pitch_m), most_m.max(*pitch_m)));
        let stiffness_n_m2 = checked("bending_stiffness_n_m2", options.bending_stiffness_n_m2, 1e-12, 1e9)?;
        let stiffness_ratio = spread("segment_stiffness_ratio", options.segment_stiffness_ratio, count, (0.01, 100.0))?;
        let most_per_m = GREATEST_REST_BEND_RAD / longest_m;
        let curvature_per_m =
            spread("precurvature_per_m", options.precurvature_per_m, count, (-most_per_m, most_per_m))?;
        let gravity = checked_vector("gravity_m_per_s2", options.gravity_m_per_s2, 1e3)?;
        let disk_mass_kg = checked("disk_mass_kg", options.disk_mass_kg, 0.0, 1e3)?;
        let backbone_mass_kg_per_m = checked("backbone_mass_kg_per_m", options.backbone_mass_kg_per_m, 0.0, 1e3)?;
        let tip_mass_kg = checked("tip_mass_kg", options.tip_mass_kg, 0.0, 1e3)?;
        let tip_force_n = checked_vector("tip_force_n", options.tip_force_n, 1e6)? + tip_mass_kg * gravity;
        let disk_weight_n = disk_mass_kg * gravity;
        let backbone_weight_n = pitch_m.map(|pitch_m| backbone_mass_kg_per_m * pitch_m * gravity);
        let mut beyond_n = tip_force_n;
        let mut middle_force_n = [Vector2::zeros(); MAX_DISKS];
        for (middle_n, weight_n) in middle_force_n.iter_mut().zip(backbone_weight_n).take(count).rev() {
            beyond_n += disk_weight_n;
            *middle_n = beyond_n + 0.5 * weight_n;
            beyond_n += weight_n;
        }
        let [agonist, antagonist] = &options.tendons;
        let tendon = |which: Tendon, options: &TendonOptions<'_>| {
            TendonParams::new(options, count).map_err(|error| ManipulatorError { tendon: Some(which), ..error })
        };
        Ok(Self {
            disk_count: count,
            pitch_m,
            length_m: length(used_m),
            disk_thickness_m: checked("disk_thickness_m", options.disk_thickness_m, 0.0, shortest_m)?,
            hole_radius_m: checked("hole_radius_m", options.hole_radius_m, 1e-6, 10.0)?,
            bending_stiffness_n_m2: stiffness_n_m2,
            segment_stiffness_n_m2: stiffness_ratio.map(|ratio| stiffness_n_m2 * ratio),
            rest_bend_rad: products(&curvature_per_m, &pitch_m),
            disk_weight_n,
            backbone_weight_n,
            tip_force_n,
            middle_force_n,
            tendons: [tendon(Tendon::Agonist, agonist)?, tendon(Tendon::Antagonist, antagonist)?],
        })
    }

    /// Returns the number of disks without the base plate, which is also the number of segments and of a tendon's holes.
    #[must_use]
    pub fn disk_count(&self) -> usize {
        self.disk_count
    }

    /// Whether weight or tip load acts.
    pub(crate) fn has_load(&self) -> bool {
        let [backbone_n, ..] = self.backbone_weight_n;
        [self.disk_weight_n, backbone_n, self.tip_force_n].iter().any(|load_n| load_n.norm_squared() > 0.0)
    }

    /// Returns the length of each segment, starting at the base plate, m: the distance between the centres of neighbouring disks.
    #[must_use]
    pub fn pitch_m(&self) -> &[f64] {
        self.pitch_m.get(..self.disk_count).unwrap_or(&self.pitch_m)
    }

    /// Returns the length of the backbone, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Returns the thickness of a disk, m.
    #[must_use]
    pub fn disk_thickness_m(&self) -> f64 {
        self.disk_thickness_m
    }

    /// Returns the radius of the circle of holes, m.
    #[must_use]
    pub fn hole_radius_m(&self) -> f64 {
        self.hole_radius_m
    }

    /// Returns E·I of the backbone, N m², to which the ratios of its segments refer.
    #[must_use]
    pub fn bending_stiffness_n_m2(&self) -> f64 {
        self.bending_stiffness_n_m2
    }

    /// Returns E·I of each segment, starting at the base plate, N m².
    #[must_use]
    pub fn segment_stiffness_n_m2(&self) -> &[f64] {
        self.segment_stiffness_n_m2.get(..self.disk_count).unwrap_or(&self.segment_stiffness_n_m2)
    }

    /// Returns the unloaded bend of each segment, starting at the base plate, rad.
    #[must_use]
    pub fn rest_bend_rad(&self) -> &[f64] {
        self.rest_bend_rad.get(..self.disk_count).unwrap_or(&self.rest_bend_rad)
    }

    /// Returns the weight of a disk, the weight of the backbone in the first segment, and the force on the tip, base frame, N. The weight of the
    /// backbone in another segment goes with its length.
    #[must_use]
    pub fn loads_n(&self) -> [[f64; 2]; 3] {
        let [backbone_n, ..] = self.backbone_weight_n;
        [self.disk_weight_n, backbone_n, self.tip_force_n].map(Into::into)
    }

    /// Returns the friction coefficients of a tendon's holes, starting at the base plate.
    #[must_use]
    pub fn mu(&self, tendon: Tendon) -> &[f64] {
        let all = &tendon.of(&self.tendons).mu;
        all.get(..self.disk_count).unwrap_or(all)
    }

    /// Returns the presliding stiffnesses of a tendon's holes, starting at the base plate, N/m.
    #[must_use]
    pub fn sigma_n_per_m(&self, tendon: Tendon) -> &[f64] {
        let all = &tendon.of(&self.tendons).sigma_n_per_m;
        all.get(..self.disk_count).unwrap_or(all)
    }

    /// Returns the axial stiffness E·A of a tendon, N.
    #[must_use]
    pub fn axial_stiffness_n(&self, tendon: Tendon) -> f64 {
        tendon.of(&self.tendons).axial_stiffness_n
    }

    /// Returns the tension capacity of a tendon, N.
    #[must_use]
    pub fn capacity_n(&self, tendon: Tendon) -> f64 {
        tendon.of(&self.tendons).capacity_n
    }
}
