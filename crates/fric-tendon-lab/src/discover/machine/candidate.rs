//! Candidates of the joint search: numbers of a manipulator file that may be wrong.

use fric_tendon::file::ManipulatorTables;

use crate::identify::unknown::Unknown;

/// A candidate. Indices count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Candidate {
    /// Bending stiffness of the backbone.
    Stiffness,
    /// Bending stiffness of one segment.
    SegmentStiffness(usize),
    /// Distances between neighbouring disks.
    UnevenPitch,
    /// Distance of the holes from the backbone.
    TendonOffset,
    /// Curvature of the unloaded manipulator.
    Precurvature,
    /// Pose of the markers' frame.
    MarkerFrame,
    /// Mass on the tip, or a force if the file has no gravity.
    TipLoad,
    /// Direction of gravity.
    GravityDirection,
    /// A common shift of all gratings from a time on.
    Temperature,
    /// Gain of the tension sensor at the base.
    BaseGain,
    /// Offset of the tension sensor at the base.
    BaseOffset,
    /// Lag of the tension sensor at the base.
    TensionLag,
    /// A hole whose μ differs strongly from that of the others.
    Hole(usize),
    /// Individual μ of all holes.
    AllHoles,
    /// A grating that drifts.
    Drift(usize),
    /// A grating whose calibration line is wrong.
    Line(usize),
    /// The calibration lines of all gratings.
    AllLines,
    /// All markers, recorded late.
    LateMarkers,
}

impl Candidate {
    /// Returns the candidates that the run can show. Those of the bending need markers, but for a soft or stiff segment: it turns the tendon more or less
    /// at its holes, and so has more or less friction.
    pub fn all(tables: &ManipulatorTables, has_markers: bool) -> Vec<Self> {
        let count = tables.disk_count;
        let mut all =
            vec![Self::Temperature, Self::BaseGain, Self::BaseOffset, Self::TensionLag, Self::AllHoles, Self::AllLines];
        for place in 0..count {
            all.extend([Self::Hole(place), Self::Drift(place), Self::Line(place)]);
        }
        all.extend((0..count).map(Self::SegmentStiffness));
        if has_markers {
            all.extend([
                Self::LateMarkers,
                Self::Stiffness,
                Self::UnevenPitch,
                Self::TendonOffset,
                Self::Precurvature,
                Self::MarkerFrame,
                Self::TipLoad,
                Self::GravityDirection,
            ]);
        }
        all.retain(|one| match one.frees(tables).as_slice() {
            [] => !one.is_named(),
            unknowns => unknowns.iter().all(|unknown| unknown.is_possible(tables)),
        });
        all
    }

    /// Whether the joint search names the candidate. The others only keep wrong names from being given: friction of holes and drifts are named by the
    /// search on the tensions, late markers are a fault of the recording, and a wrong calibration line has no name.
    pub fn is_named(self) -> bool {
        !matches!(
            self,
            Self::Hole(_) | Self::AllHoles | Self::Drift(_) | Self::Line(_) | Self::AllLines | Self::LateMarkers
        )
    }

    /// Returns the name used in results.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Stiffness | Self::SegmentStiffness(_) => "backbone_stiffness",
            Self::UnevenPitch => "uneven_pitch",
            Self::TendonOffset => "tendon_offset",
            Self::Precurvature => "precurvature",
            Self::MarkerFrame => "marker_frame",
            Self::TipLoad => "tip_load",
            Self::GravityDirection => "gravity_direction",
            Self::Temperature => "temperature",
            Self::BaseGain => "base_gain",
            Self::BaseOffset => "base_offset",
            Self::TensionLag => "tension_lag",
            Self::Hole(_) | Self::AllHoles => "hole_friction",
            Self::Drift(_) => "sensor_drift",
            Self::Line(_) | Self::AllLines => "calibration",
            Self::LateMarkers => "reference_delay",
        }
    }

    /// Returns the numbers that are free with the candidate and keep their stated values without it.
    pub fn frees(self, tables: &ManipulatorTables) -> Vec<Unknown> {
        match self {
            Self::Stiffness => vec![Unknown::Stiffness],
            Self::SegmentStiffness(segment) => vec![Unknown::SegmentStiffness(segment)],
            Self::UnevenPitch => (0..tables.disk_count).map(Unknown::Pitch).collect(),
            Self::TendonOffset => vec![Unknown::HoleRadius],
            Self::Precurvature => vec![Unknown::Precurvature],
            Self::MarkerFrame => vec![Unknown::MarkerOffset(0), Unknown::MarkerOffset(1), Unknown::MarkerAngle],
            Self::TipLoad if Unknown::TipMass.is_possible(tables) => vec![Unknown::TipMass],
            Self::TipLoad => vec![Unknown::TipForce(0), Unknown::TipForce(1)],
            Self::GravityDirection => vec![Unknown::GravityAngle],
            Self::Temperature => vec![Unknown::CommonShift],
            Self::BaseGain => vec![Unknown::BaseGain],
            Self::BaseOffset => vec![Unknown::BaseOffset],
            Self::TensionLag => vec![Unknown::BaseLag],
            Self::Drift(grating) => vec![Unknown::Drift(grating)],
            Self::LateMarkers => vec![Unknown::MarkerLag],
            Self::Hole(_) | Self::AllHoles | Self::Line(_) | Self::AllLines => Vec::new(),
        }
    }

    /// Returns the rank. Of several candidates that explain a run equally, the one with the greatest rank is written: lengths are measured with a
    /// calliper, stiffness is not; a sensor's zero wanders, its time stamps do not.
    pub fn rank(self) -> u8 {
        match self {
            Self::Stiffness => 9,
            Self::MarkerFrame => 8,
            Self::TipLoad => 7,
            Self::GravityDirection => 6,
            Self::Temperature => 5,
            Self::TendonOffset => 4,
            Self::Precurvature => 3,
            Self::BaseGain | Self::BaseOffset => 2,
            Self::SegmentStiffness(_) | Self::UnevenPitch | Self::TensionLag => 1,
            Self::Hole(_) | Self::AllHoles | Self::Drift(_) | Self::Line(_) | Self::AllLines | Self::LateMarkers => 0,
        }
    }

    /// Returns the cause, and what to do about it on the machine.
    pub fn cause_and_remedy(self) -> [&'static str; 2] {
        match self {
            Self::Stiffness => [
                "The backbone bends more or less than its stated stiffness lets it.",
                "Measure its thickness, which counts with its third power, and Young's modulus.",
            ],
            Self::SegmentStiffness(_) => [
                "One segment bends more or less than the others.",
                "Look for a crack, a kink or a clamped place in this segment.",
            ],
            Self::UnevenPitch => [
                "The disks are not where they are stated along the backbone.",
                "Measure the distances between the disks, and fix disks that slide.",
            ],
            Self::TendonOffset => [
                "The holes are nearer to the backbone or further from it than stated.",
                "Measure hole_radius_m, from the neutral line of the backbone to the line on which the tendon lies in its holes.",
            ],
            Self::Precurvature => {
                ["The backbone is curved without load.", "Straighten it, or state the curvature at rest."]
            }
            Self::MarkerFrame => [
                "The markers are measured in a frame that is not that of the base.",
                "Measure the frame of the camera at the base again.",
            ],
            Self::TipLoad => {
                ["There is a load on the tip that is not stated.", "Weigh what the tip carries, cables of sensors too."]
            }
            Self::GravityDirection => [
                "Gravity has another direction in the plane of bending than stated.",
                "Level the base, or state gravity_m_per_s2 as it is.",
            ],
            Self::Temperature => [
                "All gratings shift alike, as with the temperature.",
                "Calibrate at the temperature of the run, or lead a grating without load along and record it as shift_reference_nm.",
            ],
            Self::BaseGain => ["The load cell at the base shows another force than there is.", "Calibrate it."],
            Self::BaseOffset => ["The load cell at the base has an offset.", "Tare it without tension."],
            Self::TensionLag => [
                "The tension at the base is recorded late or early.",
                "Take its time stamps from the clock of the gratings, and its filter off.",
            ],
            Self::Hole(_) | Self::AllHoles | Self::Drift(_) | Self::Line(_) | Self::AllLines | Self::LateMarkers => {
                ["", ""]
            }
        }
    }
}
