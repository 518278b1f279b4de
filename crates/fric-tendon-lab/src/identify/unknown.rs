//! The numbers of a manipulator file that a run may determine, each as a distance from its value in the file.
//!
//! An unknown is 0 if the file is right. Stiffness, pitch, distance of the holes, μ and σ are logarithms of the ratio to the file's value, so that they stay
//! positive; the others are differences, in the unit of their key.

use fric_tendon::file::{ManipulatorTables, OneOrEach};
use fric_tendon::measuring::{BaseSensorTable, MarkersTable};

/// Start value of the friction coefficient if the file states none.
const START_MU: f64 = 0.15;
/// Maximum change of a logarithm, which keeps a wild step from leaving the range.
const MOST_LOG: f64 = 3.0;
/// Search range of μ.
const MU_RANGE: (f64, f64) = (1e-4, 0.9);

/// A number to identify. Indices count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// Bending stiffness of the backbone.
    Stiffness,
    /// Bending stiffness of one segment.
    SegmentStiffness(usize),
    /// Length of one segment: the distance of its disk from the one before.
    Pitch(usize),
    /// Distance of the holes from the backbone.
    HoleRadius,
    /// Curvature of all segments of the unloaded manipulator.
    Precurvature,
    /// Offset of the markers' frame along x (0) or y (1).
    MarkerOffset(usize),
    /// Rotation of the markers' frame.
    MarkerAngle,
    /// Mass on the tip.
    TipMass,
    /// Force on the tip along x (0) or y (1).
    TipForce(usize),
    /// Rotation of gravity.
    GravityAngle,
    /// μ of all holes; the values of a list are scaled together.
    SharedMu,
    /// μ of one hole.
    HoleMu(usize),
    /// Presliding stiffness of all holes.
    Sigma,
    /// Gain of the tension sensor at the base.
    BaseGain,
    /// Offset of the tension sensor at the base.
    BaseOffset,
    /// Lag of the tension sensor at the base.
    BaseLag,
    /// Time by which all markers are recorded late. It belongs to the recording, so no file states it.
    MarkerLag,
    /// Common shift of all gratings from a time on.
    CommonShift,
    /// Drift of one grating's shift.
    Drift(usize),
}

impl Unknown {
    /// Returns the key of its value in results.
    #[must_use]
    pub fn key(self) -> String {
        match self {
            Self::Stiffness => "bending_stiffness_n_m2".to_owned(),
            Self::SegmentStiffness(segment) => format!("segment_{}_stiffness_ratio", segment + 1),
            Self::Pitch(segment) => format!("pitch_{}_m", segment + 1),
            Self::HoleRadius => "hole_radius_m".to_owned(),
            Self::Precurvature => "precurvature_per_m".to_owned(),
            Self::MarkerOffset(axis) => format!("marker_offset_{}_m", axis_name(axis)),
            Self::MarkerAngle => "marker_angle_rad".to_owned(),
            Self::TipMass => "tip_mass_kg".to_owned(),
            Self::TipForce(axis) => format!("tip_force_{}_n", axis_name(axis)),
            Self::GravityAngle => "gravity_angle_rad".to_owned(),
            Self::SharedMu => "mu".to_owned(),
            Self::HoleMu(hole) => format!("mu_{}", hole + 1),
            Self::Sigma => "sigma_n_per_m".to_owned(),
            Self::BaseGain => "base_gain".to_owned(),
            Self::BaseOffset => "base_offset_n".to_owned(),
            Self::BaseLag => "base_lag_s".to_owned(),
            Self::MarkerLag => "delay_s".to_owned(),
            Self::CommonShift => "shift_nm".to_owned(),
            Self::Drift(grating) => format!("drift_{}_nm_per_s", grating + 1),
        }
    }

    /// Whether it applies to the tables: without gravity, for example, there is nothing to rotate.
    #[must_use]
    pub fn is_possible(self, tables: &ManipulatorTables) -> bool {
        let has_gravity = tables.gravity_m_per_s2.iter().any(|part| *part != 0.0);
        let has_mass = tables.disk_mass_kg > 0.0 || tables.backbone.mass_kg_per_m > 0.0 || tables.tip.mass_kg > 0.0;
        match self {
            Self::TipMass => has_gravity,
            Self::TipForce(_) => !has_gravity,
            Self::GravityAngle => has_gravity && has_mass,
            Self::Sigma => matches!(tables.tendon.sigma_n_per_m, Some(OneOrEach::One(_))),
            Self::CommonShift | Self::Drift(_) => tables.gratings.is_some(),
            _ => true,
        }
    }

    /// Changes the tables by this distance.
    pub fn put(self, tables: &mut ManipulatorTables, distance: f64) {
        let ratio = distance.clamp(-MOST_LOG, MOST_LOG).exp();
        let count = tables.disk_count;
        let each = |stated: &Option<OneOrEach>, neutral: f64| -> Vec<f64> {
            match stated.as_ref().map(OneOrEach::as_slice) {
                None => vec![neutral; count],
                Some([one]) => vec![*one; count],
                Some(all) => all.to_vec(),
            }
        };
        match self {
            Self::Stiffness => tables.backbone.youngs_modulus_pa *= ratio,
            Self::SegmentStiffness(segment) => {
                let mut all = each(&tables.backbone.segment_stiffness_ratio, 1.0);
                if let Some(one) = all.get_mut(segment) {
                    *one = (*one * ratio).clamp(0.01, 100.0);
                }
                tables.backbone.segment_stiffness_ratio = Some(OneOrEach::Each(all));
            }
            Self::Pitch(segment) => {
                let mut all: Vec<f64> = tables.segment_pitch_m().collect();
                if let Some(pitch_m) = all.get_mut(segment) {
                    *pitch_m *= ratio;
                }
                tables.pitch_m = OneOrEach::Each(all);
            }
            Self::HoleRadius => tables.hole_radius_m *= ratio,
            Self::Precurvature => {
                let mut stated = tables.backbone.precurvature_per_m.clone().unwrap_or(OneOrEach::One(0.0));
                let most = 1.0 / tables.segment_pitch_m().fold(0.0, f64::max);
                let bend = |per_m: &mut f64| *per_m = (*per_m + distance).clamp(-most, most);
                match &mut stated {
                    OneOrEach::One(one) => bend(one),
                    OneOrEach::Each(all) => all.iter_mut().for_each(bend),
                }
                tables.backbone.precurvature_per_m = Some(stated);
            }
            Self::MarkerOffset(axis) => {
                let mut markers = tables.markers.unwrap_or_default();
                markers.offset_m[axis.min(1)] += distance;
                tables.markers = Some(markers);
            }
            Self::MarkerAngle => {
                let markers = tables.markers.unwrap_or_default();
                tables.markers = Some(MarkersTable { angle_rad: markers.angle_rad + distance, ..markers });
            }
            Self::TipMass => {
                // The search may pass below zero, where the force of a negative weight acts. Such a file is not written.
                let mass_kg = tables.tip.mass_kg + distance;
                tables.tip.mass_kg = mass_kg.max(0.0);
                for (force_n, gravity) in tables.tip.force_n.iter_mut().zip(tables.gravity_m_per_s2) {
                    *force_n += mass_kg.min(0.0) * gravity;
                }
            }
            Self::TipForce(axis) => tables.tip.force_n[axis.min(1)] += distance,
            Self::GravityAngle => {
                let ([x, y], (sin, cos)) = (tables.gravity_m_per_s2, distance.sin_cos());
                tables.gravity_m_per_s2 = [cos * x - sin * y, sin * x + cos * y];
            }
            Self::SharedMu => match &mut tables.tendon.mu {
                OneOrEach::One(mu) => *mu = scaled_mu(*mu, ratio),
                OneOrEach::Each(all) => all.iter_mut().for_each(|mu| *mu = scaled_mu(*mu, ratio)),
            },
            Self::HoleMu(hole) => {
                let mut all = each(&Some(tables.tendon.mu.clone()), 0.0);
                if let Some(mu) = all.get_mut(hole) {
                    *mu = scaled_mu(*mu, ratio);
                }
                tables.tendon.mu = OneOrEach::Each(all);
            }
            Self::Sigma => {
                if let Some(OneOrEach::One(sigma)) = &mut tables.tendon.sigma_n_per_m {
                    *sigma = (*sigma * ratio).clamp(1.0, 1e7);
                }
            }
            Self::BaseGain => {
                let sensor = tables.base_sensor.unwrap_or_default();
                tables.base_sensor = Some(BaseSensorTable { gain: sensor.gain * ratio, ..sensor });
            }
            Self::BaseOffset => {
                let sensor = tables.base_sensor.unwrap_or_default();
                tables.base_sensor = Some(BaseSensorTable { offset_n: sensor.offset_n + distance, ..sensor });
            }
            Self::BaseLag => {
                let sensor = tables.base_sensor.unwrap_or_default();
                tables.base_sensor = Some(BaseSensorTable { lag_s: sensor.lag_s + distance, ..sensor });
            }
            Self::MarkerLag => {}
            Self::CommonShift => {
                if let Some(gratings) = &mut tables.gratings {
                    gratings.common_step_nm = Some(gratings.common_step_nm.unwrap_or(0.0) + distance);
                }
            }
            Self::Drift(grating) => {
                if let Some(gratings) = &mut tables.gratings {
                    gratings.drift_nm_per_s.resize(count, 0.0);
                    gratings.drift_nm_per_s[grating] += distance;
                }
            }
        }
    }

    /// Returns its value in tables, in the unit of its key. The angle of gravity is that of its vector, from x to y.
    #[must_use]
    pub fn value(self, tables: &ManipulatorTables) -> f64 {
        let backbone = &tables.backbone;
        let at = |list: &Option<OneOrEach>, place: usize, neutral: f64| match list.as_ref().map(OneOrEach::as_slice) {
            None => neutral,
            Some([one]) => *one,
            Some(all) => all.get(place).copied().unwrap_or(f64::NAN),
        };
        let markers = tables.markers.unwrap_or_default();
        let sensor = tables.base_sensor.unwrap_or_default();
        let mu = Some(tables.tendon.mu.clone());
        match self {
            Self::Stiffness => fric_tendon::rectangle_bending_stiffness_n_m2(
                backbone.youngs_modulus_pa,
                backbone.width_m,
                backbone.thickness_m,
            ),
            Self::SegmentStiffness(segment) => at(&backbone.segment_stiffness_ratio, segment, 1.0),
            Self::Pitch(segment) => tables.segment_pitch_m().nth(segment).unwrap_or(f64::NAN),
            Self::HoleRadius => tables.hole_radius_m,
            Self::Precurvature => at(&backbone.precurvature_per_m, 0, 0.0),
            Self::MarkerOffset(axis) => markers.offset_m[axis.min(1)],
            Self::MarkerAngle => markers.angle_rad,
            Self::TipMass => tables.tip.mass_kg,
            Self::TipForce(axis) => tables.tip.force_n[axis.min(1)],
            Self::GravityAngle => libm::atan2(tables.gravity_m_per_s2[1], tables.gravity_m_per_s2[0]),
            Self::SharedMu => {
                let all = tables.tendon.mu.as_slice();
                #[expect(clippy::cast_precision_loss, reason = "a small count")]
                let mean = all.iter().sum::<f64>() / all.len() as f64;
                mean
            }
            Self::HoleMu(hole) => at(&mu, hole, f64::NAN),
            Self::Sigma => at(&tables.tendon.sigma_n_per_m, 0, f64::NAN),
            Self::BaseGain => sensor.gain,
            Self::BaseOffset => sensor.offset_n,
            Self::BaseLag => sensor.lag_s,
            Self::MarkerLag => 0.0,
            Self::CommonShift => tables.gratings.as_ref().and_then(|table| table.common_step_nm).unwrap_or(0.0),
            Self::Drift(grating) => {
                let stated = tables.gratings.as_ref().and_then(|table| table.drift_nm_per_s.get(grating)).copied();
                stated.unwrap_or(0.0)
            }
        }
    }

    /// Returns the value per unit of distance near these tables, which converts an error of the distance to one of the value.
    #[must_use]
    pub fn value_per_distance(self, tables: &ManipulatorTables) -> f64 {
        match self {
            Self::Stiffness
            | Self::SegmentStiffness(_)
            | Self::Pitch(_)
            | Self::HoleRadius
            | Self::SharedMu
            | Self::HoleMu(_)
            | Self::Sigma
            | Self::BaseGain => self.value(tables),
            _ => 1.0,
        }
    }

    /// Returns half the width of the widest 95 % interval that still counts as determined, as a distance: about what moves the tip by a hundredth of
    /// the length, or the tension by a twentieth.
    #[must_use]
    pub fn widest(self, tables: &ManipulatorTables, greatest_tension_n: f64) -> f64 {
        let length_m = tables.length_m();
        let force_n = 0.05 * Self::Stiffness.value(tables) / (length_m * length_m);
        let [x, y] = tables.gravity_m_per_s2;
        match self {
            Self::Stiffness | Self::HoleRadius | Self::BaseGain => 0.05,
            Self::SegmentStiffness(_) | Self::SharedMu => 0.25,
            Self::Pitch(_) => 0.01 * length_m / self.value(tables),
            Self::HoleMu(_) => 0.5,
            Self::Precurvature => 0.03 / length_m,
            Self::MarkerOffset(_) => 0.01 * length_m,
            Self::MarkerAngle => 0.02,
            Self::TipMass => force_n / libm::hypot(x, y).max(1e-3),
            Self::TipForce(_) => force_n,
            Self::GravityAngle => 0.1,
            Self::Sigma => 0.7,
            Self::BaseOffset => 0.02 * greatest_tension_n,
            Self::BaseLag | Self::MarkerLag => 0.2,
            Self::CommonShift => 0.01,
            Self::Drift(_) => 0.001,
        }
    }

    /// Returns the step for its finite differences: small, and far above the solver's tolerance.
    #[must_use]
    pub fn small(self, tables: &ManipulatorTables, greatest_tension_n: f64) -> f64 {
        let share = match self {
            Self::Sigma => 0.3,
            _ => 0.04,
        };
        share * self.widest(tables, greatest_tension_n)
    }

    /// Whether a state has a negative mass on the tip.
    pub(super) fn is_below_range(self, given: &ManipulatorTables, state: &[(Self, f64)]) -> bool {
        let found = state.iter().find(|(unknown, _)| *unknown == self);
        found.is_some_and(|(_, distance)| self == Self::TipMass && given.tip.mass_kg + distance < 0.0)
    }

    /// Returns the rank. Of several numbers that a run cannot distinguish and whose stated values it does not contradict, the one with the least rank
    /// is held: lengths are measured with a calliper, while stiffness and friction are the purpose of a fit.
    #[must_use]
    pub fn rank(self) -> u8 {
        match self {
            Self::Sigma | Self::Drift(_) | Self::CommonShift => 0,
            Self::BaseLag | Self::MarkerLag => 1,
            Self::BaseOffset => 2,
            Self::BaseGain => 3,
            Self::Pitch(_) => 4,
            Self::HoleRadius => 5,
            Self::TipForce(_) => 6,
            Self::GravityAngle => 7,
            Self::Precurvature => 8,
            Self::SegmentStiffness(_) => 9,
            Self::HoleMu(_) => 10,
            Self::TipMass => 11,
            Self::MarkerAngle => 12,
            Self::MarkerOffset(_) => 13,
            Self::SharedMu => 14,
            Self::Stiffness => 15,
        }
    }
}

fn axis_name(axis: usize) -> char {
    if axis == 0 { 'x' } else { 'y' }
}

fn scaled_mu(mu: f64, ratio: f64) -> f64 {
    let (least, most) = MU_RANGE;
    (if mu > 0.0 { mu * ratio } else { START_MU * ratio }).clamp(least, most)
}
