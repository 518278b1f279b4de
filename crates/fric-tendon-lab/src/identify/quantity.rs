//! Quantities that a user can identify, by name.

use fric_core::robot::unknown_name;
use fric_tendon::file::{ManipulatorTables, OneOrEach};

use super::unknown::Unknown;

/// A physical quantity: one or several numbers of the manipulator file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Bending stiffness of the backbone.
    BackboneStiffness,
    /// Bending stiffness of each segment.
    SegmentStiffness,
    /// Distances between neighbouring disks.
    Pitch,
    /// Distance of the holes from the backbone.
    TendonOffset,
    /// Curvature of the unloaded manipulator.
    Precurvature,
    /// Pose of the markers' frame.
    MarkerFrame,
    /// Mass on the tip if there is gravity in the plane, else a force.
    TipLoad,
    /// Direction of gravity.
    GravityDirection,
    /// Friction coefficient: one, or one per hole if the file has a list.
    Mu,
    /// Friction coefficient of each hole.
    HoleMu,
    /// Presliding stiffness.
    Sigma,
    /// Gain of the tension sensor at the base.
    BaseGain,
    /// Offset of the tension sensor at the base.
    BaseOffset,
    /// Lag of the tension sensor at the base.
    TensionLag,
    /// Calibration lines of the gratings.
    Calibration,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 15] = [
        Self::BackboneStiffness,
        Self::SegmentStiffness,
        Self::Pitch,
        Self::TendonOffset,
        Self::Precurvature,
        Self::MarkerFrame,
        Self::TipLoad,
        Self::GravityDirection,
        Self::Mu,
        Self::HoleMu,
        Self::Sigma,
        Self::BaseGain,
        Self::BaseOffset,
        Self::TensionLag,
        Self::Calibration,
    ];

    /// Returns its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::BackboneStiffness => "backbone_stiffness",
            Self::SegmentStiffness => "segment_stiffness",
            Self::Pitch => "pitch",
            Self::TendonOffset => "tendon_offset",
            Self::Precurvature => "precurvature",
            Self::MarkerFrame => "marker_frame",
            Self::TipLoad => "tip_load",
            Self::GravityDirection => "gravity_direction",
            Self::Mu => "mu",
            Self::HoleMu => "hole_mu",
            Self::Sigma => "sigma",
            Self::BaseGain => "base_gain",
            Self::BaseOffset => "base_offset",
            Self::TensionLag => "tension_lag",
            Self::Calibration => "calibration",
        }
    }

    /// Returns the quantities of a list of names.
    ///
    /// # Errors
    /// Returns a sentence about the first name that is unknown, with the nearest known one, or that contradicts another.
    pub fn all_named<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Vec<Self>, String> {
        let mut all = Vec::new();
        for name in names {
            let known = Self::ALL.into_iter().find(|quantity| quantity.name() == name);
            let quantity =
                known.ok_or_else(|| unknown_name("quantity", name, Self::ALL.iter().map(|one| one.name())))?;
            if !all.contains(&quantity) {
                all.push(quantity);
            }
        }
        for [one, other] in [[Self::Mu, Self::HoleMu], [Self::BackboneStiffness, Self::SegmentStiffness]] {
            if all.contains(&one) && all.contains(&other) {
                return Err(format!("`{}` is part of `{}`; name one of them", one.name(), other.name()));
            }
        }
        Ok(all)
    }

    /// Returns the quantities that are identified by default. Without markers these are those of friction: gratings show friction alone, which goes with μ
    /// and with the angle at a hole, so that another stiffness with another μ has nearly the same tensions.
    #[must_use]
    pub fn usual(tables: &ManipulatorTables, has_markers: bool) -> Vec<Self> {
        let usual = [
            Self::BackboneStiffness,
            Self::TendonOffset,
            Self::Precurvature,
            Self::MarkerFrame,
            Self::TipLoad,
            Self::GravityDirection,
            Self::Mu,
            Self::Sigma,
        ];
        // A force on the tip that is no weight is not a default.
        let is_usual = |quantity: &Self| match quantity {
            of_friction if of_friction.is_friction() => true,
            Self::TipLoad => has_markers && tables.gravity_m_per_s2.iter().any(|part| *part != 0.0),
            _ => has_markers,
        };
        usual.into_iter().filter(|quantity| is_usual(quantity) && !quantity.unknowns(tables).is_empty()).collect()
    }

    /// Whether it does not apply to a manipulator.
    pub(super) fn is_impossible(self, tables: &ManipulatorTables) -> bool {
        self != Self::Calibration && self.unknowns(tables).is_empty()
    }

    /// Whether it is one of friction.
    pub(super) fn is_friction(self) -> bool {
        matches!(self, Self::Mu | Self::HoleMu | Self::Sigma)
    }

    /// Returns its numbers; empty if it does not apply to the manipulator.
    pub(super) fn unknowns(self, tables: &ManipulatorTables) -> Vec<Unknown> {
        let count = tables.disk_count;
        let all: Vec<Unknown> = match self {
            Self::BackboneStiffness => vec![Unknown::Stiffness],
            Self::SegmentStiffness => (0..count).map(Unknown::SegmentStiffness).collect(),
            Self::Pitch => (0..count).map(Unknown::Pitch).collect(),
            Self::TendonOffset => vec![Unknown::HoleRadius],
            Self::Precurvature => vec![Unknown::Precurvature],
            Self::MarkerFrame => vec![Unknown::MarkerOffset(0), Unknown::MarkerOffset(1), Unknown::MarkerAngle],
            Self::TipLoad => vec![Unknown::TipMass, Unknown::TipForce(0), Unknown::TipForce(1)],
            Self::GravityDirection => vec![Unknown::GravityAngle],
            Self::Mu => match &tables.tendon.mu {
                OneOrEach::One(_) => vec![Unknown::SharedMu],
                OneOrEach::Each(_) => (0..count).map(Unknown::HoleMu).collect(),
            },
            Self::HoleMu => (0..count).map(Unknown::HoleMu).collect(),
            Self::Sigma => vec![Unknown::Sigma],
            Self::BaseGain => vec![Unknown::BaseGain],
            Self::BaseOffset => vec![Unknown::BaseOffset],
            Self::TensionLag => vec![Unknown::BaseLag],
            Self::Calibration => Vec::new(),
        };
        all.into_iter().filter(|unknown| unknown.is_possible(tables)).collect()
    }
}
