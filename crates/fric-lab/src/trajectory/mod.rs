//! Runs of a platform as pure functions of time, for simulated and real robots.
//!
//! [`Trajectory::identification`] is the identification run of \[P\], section III C; [`Trajectory::crossing`] crosses one position along and about
//! each axis, \[P\] section IV B; `designed` has runs of pieces that are chosen for a question. All consist of straight movements and rotations from rest to rest, closed and at rest at both ends, so that they
//! repeat without a jump. They are finite for any finite input and independent of the cables.

mod crossing;
mod designed;
mod identification;
mod stroke;

use fric_core::{KnownReference, Pose};
use nalgebra::{UnitQuaternion, Vector3};

use crate::axis::{CartesianAxis, rotation};
use designed::Loads;
use stroke::Stroke;

pub use crossing::{CROSSING_CYCLES, CROSSING_HALF_M, CROSSING_HALF_RAD, CROSSING_RAD_PER_S, CROSSING_RAD_PER_S2};
pub use designed::{LOAD_CHANGE_S, Piece, Shape};
pub use identification::{
    ACCELERATION_M_PER_S2, AMPLITUDES_M, BREAK_S, FASTEST_M_PER_S, RECTANGLES_M_PER_S, STEP_M_PER_S,
    STROKE_ACCELERATION_M_PER_S2, STROKE_M, STROKES_M_PER_S,
};

/// The region of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkBox {
    /// Its centre, base frame, m.
    pub center_m: Vector3<f64>,
    /// Half its edges, along the base axes, m; 0 where the run has no extent.
    pub half_edges_m: Vector3<f64>,
    /// Unit vector of the small movements and the strokes.
    pub direction: Vector3<f64>,
}

impl WorkBox {
    /// Returns the distance from its centre to its surface along a unit vector, m.
    #[must_use]
    pub fn reach_m(&self, direction: &Vector3<f64>) -> f64 {
        let along = self.half_edges_m.iter().zip(direction.iter()).filter(|(_, part)| part.abs() > 1e-9);
        along.map(|(half_m, part)| half_m / part.abs()).fold(f64::INFINITY, f64::min)
    }
}

/// Fraction of the greatest acceleration under which the force of a load is known that a run makes use of.
const QUIET_RATIO: f64 = 0.8;

/// Limits for a run's own speeds and accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Greatest speed of the platform, m/s, above 0.
    pub speed_m_per_s: f64,
    /// Greatest acceleration of the platform, m/s², above 0.
    pub acceleration_m_per_s2: f64,
}

impl Limits {
    /// No limits: the run is unchanged.
    pub const NONE: Self = Self { speed_m_per_s: f64::INFINITY, acceleration_m_per_s2: f64::INFINITY };

    /// Returns the limits under which the force of a load stays known; some room is left for the noise of the length.
    #[must_use]
    pub fn of_load(known: Option<&KnownReference>) -> Self {
        let quiet_m_per_s2 = known.map_or(f64::INFINITY, KnownReference::quiet_m_per_s2);
        Self { acceleration_m_per_s2: QUIET_RATIO * quiet_m_per_s2, ..Self::NONE }
    }
}

/// The purpose of a part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Phase {
    /// Steps in one direction with breaks, then back in the other.
    StopAndGo,
    /// Steps back and forth with breaks.
    Alternating,
    /// Strokes back and forth; in the identification run of 100 mm at increasing speed.
    Stroke,
    /// Movements along rectangles through the workspace.
    Rectangle,
    /// Movements through the middle along or about an axis, back and forth.
    Crossing(CartesianAxis),
}

impl Phase {
    /// Returns the name used in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::StopAndGo => "stop_and_go",
            Self::Alternating => "alternating",
            Self::Stroke => "stroke",
            Self::Rectangle => "rectangle",
            Self::Crossing(_) => "crossing",
        }
    }
}

/// A movement from rest to rest: a straight line, or a rotation about a base axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Its purpose.
    pub phase: Phase,
    /// Start time, s.
    pub start_s: f64,
    /// Start position, m.
    pub from_m: Vector3<f64>,
    /// End position, m.
    pub to_m: Vector3<f64>,
    /// Rotation vector at the start, base axes, rad.
    pub from_rad: Vector3<f64>,
    /// Rotation vector at the end, base axes, rad: parallel to that at the start, because a rotation has one axis. Either may be 0.
    pub to_rad: Vector3<f64>,
    stroke: Stroke,
}

impl Leg {
    /// Returns the end time, s; the platform rests until the next leg starts.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.start_s + self.stroke.duration_s()
    }

    /// Returns the greatest speed, m/s; 0 for a rotation.
    #[must_use]
    pub fn peak_m_per_s(&self) -> f64 {
        if self.is_turn() { 0.0 } else { self.stroke.peak() }
    }

    fn is_turn(&self) -> bool {
        self.from_rad != self.to_rad
    }
}

/// Pose of the platform at one time with its rates, base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetPoint {
    /// Position, m.
    pub position_m: Vector3<f64>,
    /// Rotation from platform to base axes.
    pub orientation: UnitQuaternion<f64>,
    /// Velocity, m/s.
    pub velocity_m_per_s: Vector3<f64>,
    /// Angular velocity, rad/s.
    pub angular_velocity_rad_per_s: Vector3<f64>,
    /// Acceleration, m/s².
    pub acceleration_m_per_s2: Vector3<f64>,
    /// Angular acceleration, rad/s².
    pub angular_acceleration_rad_per_s2: Vector3<f64>,
}

impl SetPoint {
    /// Returns the set point at rest at a position, aligned with the base axes.
    fn resting_at(position_m: Vector3<f64>) -> Self {
        Self {
            position_m,
            orientation: UnitQuaternion::identity(),
            velocity_m_per_s: Vector3::zeros(),
            angular_velocity_rad_per_s: Vector3::zeros(),
            acceleration_m_per_s2: Vector3::zeros(),
            angular_acceleration_rad_per_s2: Vector3::zeros(),
        }
    }

    /// Returns position and orientation.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose { position_m: self.position_m, orientation: self.orientation }
    }
}

/// A run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    legs: Vec<Leg>,
    start_m: Vector3<f64>,
    duration_s: f64,
    /// The loads, if the run states the cable tensions.
    loads: Option<Loads>,
}

impl Trajectory {
    /// Creates a run that starts at rest at a position, with a rest before its first movement.
    fn starting_at(start_m: Vector3<f64>, rest_s: f64) -> Self {
        Self { legs: Vec::new(), start_m, duration_s: rest_s, loads: None }
    }

    fn place_m(&self) -> Vector3<f64> {
        self.legs.last().map_or(self.start_m, |leg| leg.to_m)
    }

    fn rotation_rad(&self) -> Vector3<f64> {
        self.legs.last().map_or_else(Vector3::zeros, |leg| leg.to_rad)
    }

    /// Adds a straight movement, unless the platform is there already.
    fn go(&mut self, phase: Phase, to_m: Vector3<f64>, speed_m_per_s: f64, acceleration_m_per_s2: f64) {
        let (from_m, rotation_rad) = (self.place_m(), self.rotation_rad());
        let distance_m = (to_m - from_m).norm();
        if distance_m > 1e-9 {
            let stroke = Stroke::new(distance_m, speed_m_per_s, acceleration_m_per_s2);
            let start_s = self.duration_s;
            self.add(Leg { phase, start_s, from_m, to_m, from_rad: rotation_rad, to_rad: rotation_rad, stroke });
        }
    }

    /// Adds a turn to a rotation vector that is parallel to the present one.
    fn turn(&mut self, phase: Phase, to_rad: Vector3<f64>, speed_rad_per_s: f64, acceleration_rad_per_s2: f64) {
        let (place_m, from_rad) = (self.place_m(), self.rotation_rad());
        let angle_rad = (to_rad - from_rad).norm();
        if angle_rad > 1e-9 {
            let stroke = Stroke::new(angle_rad, speed_rad_per_s, acceleration_rad_per_s2);
            let start_s = self.duration_s;
            self.add(Leg { phase, start_s, from_m: place_m, to_m: place_m, from_rad, to_rad, stroke });
        }
    }

    fn add(&mut self, leg: Leg) {
        self.duration_s = leg.end_s();
        self.legs.push(leg);
    }

    fn rest(&mut self, rest_s: f64) {
        self.duration_s += rest_s;
    }

    /// Returns the movements in order.
    #[must_use]
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// Returns the duration of one run, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Returns the last movement that has started at a time of the first run.
    fn leg_at(&self, time_s: f64) -> Option<&Leg> {
        let started = self.legs.partition_point(|leg| leg.start_s <= time_s);
        started.checked_sub(1).and_then(|last| self.legs.get(last))
    }

    /// Returns the purpose of the run at a time; a rest belongs to the movement before it. Returns `None` for a run without movements.
    #[must_use]
    pub fn phase_at(&self, time_s: f64) -> Option<Phase> {
        self.leg_at(self.within_s(time_s)).or(self.legs.first()).map(|leg| leg.phase)
    }

    /// Returns the cable tension at a time, as a fraction between the least allowed force, 0, and the greatest, 1; `None` for a run that does not
    /// state it.
    #[must_use]
    pub fn load_share_at(&self, time_s: f64) -> Option<f64> {
        self.loads.as_ref().map(|loads| loads.share_at(self.within_s(time_s)))
    }

    fn within_s(&self, time_s: f64) -> f64 {
        time_s - self.duration_s * libm::floor(time_s / self.duration_s)
    }

    /// Returns the set point of the platform at a time; the run repeats before its start and after its end.
    #[must_use]
    pub fn at(&self, time_s: f64) -> SetPoint {
        let within_s = self.within_s(time_s);
        let Some(leg) = self.leg_at(within_s) else { return SetPoint::resting_at(self.start_m) };
        let along = leg.stroke.at(within_s - leg.start_s);
        let is_over = within_s >= leg.end_s();
        let resting = SetPoint { orientation: rotation(&leg.to_rad), ..SetPoint::resting_at(leg.to_m) };
        if leg.is_turn() {
            let whole_rad = leg.to_rad - leg.from_rad;
            let axis = whole_rad / whole_rad.norm();
            let turned_rad = if is_over { leg.to_rad } else { leg.from_rad + axis * along.distance };
            return SetPoint {
                orientation: rotation(&turned_rad),
                angular_velocity_rad_per_s: axis * along.speed,
                angular_acceleration_rad_per_s2: axis * along.acceleration,
                ..resting
            };
        }
        let whole_m = leg.to_m - leg.from_m;
        let direction = whole_m / whole_m.norm();
        SetPoint {
            position_m: if is_over { leg.to_m } else { leg.from_m + direction * along.distance },
            velocity_m_per_s: direction * along.speed,
            acceleration_m_per_s2: direction * along.acceleration,
            ..resting
        }
    }
}
