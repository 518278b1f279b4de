//! The workspace of the platform: a box in the middle of the cables' base points.
//!
//! Boxes are tried from the largest down, first around the middle of the base points, then below it (for a suspended robot). A box is accepted if, on
//! a grid of positions, under the run's accelerations and at the lowest and highest prestress, every cable can leave its last pulley and pull. A
//! robot that its cables cannot hold anywhere (for instance with too few cables) runs in the box with the least imbalance in the middle, as if a
//! guide carried the rest.

use fric_core::Pose;
use nalgebra::{UnitQuaternion, Vector3, Vector6};

use super::distribution::Distribution;
use super::platform::Platform;
use super::tension::TensionLevel;
use crate::axis::rotation;
use crate::simulate::error::SimulationError;
use crate::trajectory::{
    ACCELERATION_M_PER_S2, CROSSING_HALF_M, CROSSING_HALF_RAD, STROKE_ACCELERATION_M_PER_S2, Trajectory, WorkBox,
};

/// Trial half edges relative to the half extent of the base points, the largest first.
const SHARES: [f64; 7] = [0.32, 0.26, 0.2, 0.14, 0.1, 0.06, 0.03];
/// Trial depths below the middle, relative to the largest half extent.
const DEPTHS: [f64; 5] = [0.0, 0.4, 0.7, 1.0, 1.5];
/// Longest half edge, m: rectangles through a larger box would take minutes.
const LONGEST_HALF_EDGE_M: f64 = 0.2;
/// Base points with an extent below this fraction of the largest lie in a plane.
const FLAT_SHARE: f64 = 0.05;
/// Edge of the box perpendicular to such a plane, relative to the largest edge.
const ACROSS_SHARE: f64 = 0.4;

/// An imbalance below this fraction of the mean tension is rounding.
pub const SHORT_SHARE: f64 = 1e-9;

/// Trial rotations of a crossing run, relative to its full rotation.
const TURN_SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

/// Lateral offset from a single base point, relative to the depth below it.
const ASIDE_SHARE: f64 = 0.75;

/// A box, and whether the cables alone hold the platform in it.
#[derive(Clone, Copy, Debug)]
pub struct Workspace {
    pub work_box: WorkBox,
    pub balanced: bool,
    /// Whether the platform has weight, hangs from base points at one height, and the box is not below them.
    pub among_anchors: bool,
}

impl Workspace {
    /// Finds the box for a platform with at least one cable.
    pub fn find(platform: &Platform, level: &TensionLevel) -> Result<Self, SimulationError> {
        let mut trial = Trial::new(platform, level);
        let mut best: Option<(f64, WorkBox)> = None;
        for depth in DEPTHS {
            for share in SHARES {
                let Some(work_box) = candidate(platform, depth, share) else { continue };
                let Some(missing_n) = trial.missing_in_n(&work_box) else { continue };
                if missing_n <= 0.0 {
                    return Ok(Self { work_box, balanced: true, among_anchors: among_anchors(platform, &work_box) });
                }
                if best.is_none_or(|(least_n, _)| missing_n < least_n) {
                    best = Some((missing_n, work_box));
                }
            }
        }
        let (_, work_box) = best.ok_or(SimulationError::NoWorkspace)?;
        Ok(Self { work_box, balanced: false, among_anchors: among_anchors(platform, &work_box) })
    }

    /// Returns the crossing run in its middle, as large in each direction as there is room.
    pub fn crossing(&self, platform: &Platform, level: &TensionLevel) -> Trajectory {
        let half_m = self.work_box.half_edges_m.map(|half_m| half_m.min(CROSSING_HALF_M));
        Trajectory::crossing(self.work_box.center_m, &half_m, &turns_rad(platform, level, self))
    }
}

/// Returns how far the platform can rotate in either direction about each base axis in the middle of a workspace, rad: the rotation of a crossing
/// run, or a half, a quarter … of it, such that every cable can follow, and hold the platform if the cables hold it at all; 0 if even the smallest
/// fails.
fn turns_rad(platform: &Platform, level: &TensionLevel, workspace: &Workspace) -> Vector3<f64> {
    let mut trial = Trial::new(platform, level);
    let mut allowed = |turn_rad: Vector3<f64>| {
        let pose = Pose { position_m: workspace.work_box.center_m, orientation: rotation(&turn_rad) };
        trial.platform.structure(&pose, &mut trial.columns)
            && (!workspace.balanced
                || trial.missing_n(&pose.orientation, Vector3::zeros()) <= SHORT_SHARE * level.mean_n)
    };
    Vector3::from([Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| {
        let turns_rad = TURN_SHARES.map(|share| share * CROSSING_HALF_RAD);
        turns_rad.into_iter().find(|turn_rad| allowed(axis * *turn_rad) && allowed(axis * -turn_rad)).unwrap_or(0.0)
    }))
}

/// Returns the axis or diagonal of the box along which the least-moving cable moves most, with the platform in the middle; `None` if a cable cannot
/// reach it.
pub fn direction_in(platform: &Platform, center_m: Vector3<f64>, half_edges_m: &Vector3<f64>) -> Option<Vector3<f64>> {
    let mut columns = Vec::new();
    platform.structure(&Platform::pose(center_m), &mut columns).then_some(())?;
    best_direction(half_edges_m, &columns)
}

fn among_anchors(platform: &Platform, work_box: &WorkBox) -> bool {
    let down = platform.down();
    let [least_m, greatest_m] = platform.base_corners_m();
    let along_m = |edges_m: &Vector3<f64>| edges_m.component_mul(&down).abs().sum();
    let half_m = (greatest_m - least_m) * 0.5;
    let is_level = along_m(&half_m) < FLAT_SHARE * half_m.max();
    let depth_m = (work_box.center_m - (least_m + greatest_m) * 0.5).dot(&down);
    platform.weight_n() > 0.0 && is_level && depth_m - along_m(&work_box.half_edges_m) <= 0.0
}

/// Returns a box at a depth with a fraction of the base points' extent; `None` if the cables cannot reach its middle.
fn candidate(platform: &Platform, depth: f64, share: f64) -> Option<WorkBox> {
    let [least_m, greatest_m] = platform.base_corners_m();
    let half_m = (greatest_m - least_m) * 0.5;
    // A single base point has no extent. The platform then hangs within a metre of it and to the side, because directly behind a swivelling pulley
    // there is no way out.
    let single = half_m.max() <= 1e-6;
    let largest_m = if single { 0.5 } else { half_m.max() };
    let level = if platform.down().x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let aside = if single { level * ASIDE_SHARE } else { Vector3::zeros() };
    let across_m = if depth > 0.0 { largest_m * ACROSS_SHARE } else { 0.0 };
    let half_edges_m = half_m.map(|extent_m| {
        let extent_m = if extent_m < FLAT_SHARE * largest_m { across_m } else { extent_m };
        (extent_m * share).min(LONGEST_HALF_EDGE_M)
    });
    let center_m = (least_m + greatest_m) * 0.5 + (platform.down() + aside) * (depth * largest_m);
    let direction = direction_in(platform, center_m, &half_edges_m)?;
    Some(WorkBox { center_m, half_edges_m, direction })
}

/// Returns the axis or diagonal of the box along which the least-moving cable moves most.
fn best_direction(half_edges_m: &Vector3<f64>, columns: &[Vector6<f64>]) -> Option<Vector3<f64>> {
    let parts = [0.0, 1.0, -1.0];
    let mut best: Option<(f64, Vector3<f64>)> = None;
    for direction in parts.into_iter().flat_map(|x| parts.into_iter().flat_map(move |y| parts.map(|z| [x, y, z]))) {
        let outside = direction.iter().zip(half_edges_m.iter()).any(|(part, half_m)| *part != 0.0 && *half_m <= 0.0);
        let Some(direction) = Vector3::from(direction).try_normalize(1e-9).filter(|_| !outside) else { continue };
        let moved = |column: &Vector6<f64>| column.fixed_rows::<3>(0).dot(&direction).abs();
        let least = columns.iter().map(moved).fold(f64::INFINITY, f64::min);
        // The margin of a hundredth keeps rounding from choosing between equal directions.
        if best.is_none_or(|(other, _)| least > other + 0.01) {
            best = Some((least, direction));
        }
    }
    best.map(|(_, direction)| direction)
}

struct Trial<'a> {
    platform: &'a Platform,
    level: &'a TensionLevel,
    distribution: Distribution,
    columns: Vec<Vector6<f64>>,
    forces_n: Vec<f64>,
}

impl<'a> Trial<'a> {
    fn new(platform: &'a Platform, level: &'a TensionLevel) -> Self {
        let distribution = Distribution::new(platform.arm_m(), level.least_n);
        Self { platform, level, distribution, columns: Vec::new(), forces_n: Vec::new() }
    }

    /// Returns the first imbalance found in the box, N, starting from its middle; 0 if the cables provide all forces. Returns `None` if a cable
    /// cannot leave its pulley.
    fn missing_in_n(&mut self, work_box: &WorkBox) -> Option<f64> {
        let parts = [-1.0, 0.0, 1.0];
        let grid = parts.into_iter().flat_map(|x| parts.into_iter().flat_map(move |y| parts.map(|z| [x, y, z])));
        let places_m =
            grid.map(|corner| work_box.center_m + work_box.half_edges_m.component_mul(&Vector3::from(corner)));
        if !places_m.clone().all(|place_m| self.platform.structure(&Platform::pose(place_m), &mut self.columns)) {
            return None;
        }
        let upright = UnitQuaternion::identity();
        let tolerance_n = SHORT_SHARE * self.level.mean_n;
        let stroke = work_box.direction * STROKE_ACCELERATION_M_PER_S2;
        let ramps = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| axis * ACCELERATION_M_PER_S2);
        let strokes = [(work_box.center_m, stroke)].into_iter();
        let tried = strokes.chain(places_m.flat_map(|place_m| ramps.map(|ramp| (place_m, ramp))));
        for (place_m, acceleration_m_per_s2) in tried {
            self.platform.structure(&Platform::pose(place_m), &mut self.columns);
            let missing_n =
                self.missing_n(&upright, acceleration_m_per_s2).max(self.missing_n(&upright, -acceleration_m_per_s2));
            if missing_n > tolerance_n {
                return Some(missing_n);
            }
        }
        Some(0.0)
    }

    /// Returns the imbalance at the pose of the columns, N.
    fn missing_n(&mut self, orientation: &UnitQuaternion<f64>, acceleration_m_per_s2: Vector3<f64>) -> f64 {
        let wrench = self.platform.outside_wrench(orientation, &acceleration_m_per_s2);
        let mut missing_n = 0.0_f64;
        for mean_n in self.level.extremes_n() {
            self.forces_n.clear();
            self.forces_n.resize(self.columns.len(), mean_n);
            let balance = self.distribution.solve(&self.columns, &wrench, &mut self.forces_n);
            missing_n = missing_n.max(balance.residual_n);
        }
        missing_n
    }
}
