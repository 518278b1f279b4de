//! Runs composed of pieces, each from the middle of the box and back to it, with its own load.
//!
//! The design of experiments chooses the pieces. A run starts with a short movement back and forth, which erases the bearings' memory of earlier
//! motion, and continues with its pieces. Between two pieces with different loads the platform rests while the load changes. A load is a fraction: 0
//! is the least allowed cable force, 1 the greatest. Position, speed and load are pure functions of time, as in every [`Trajectory`].

use core::f64::consts::PI;

use nalgebra::Vector3;

use super::identification::{ACCELERATION_M_PER_S2, STEP_M_PER_S};
use super::{Limits, Phase, Trajectory, WorkBox};

/// Length of the movement at the start of a run, m: many presliding distances.
const LEAD_IN_M: f64 = 0.01;
/// Rest before it, s.
const LEAD_IN_REST_S: f64 = 0.1;
/// Duration of a load change, s.
pub const LOAD_CHANGE_S: f64 = 0.4;
/// Load fractions that [`Shape::LoadSteps`] passes through.
const LOAD_STEPS: [f64; 3] = [0.9, 0.1, 0.5];

/// A piece of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The movement of the platform.
    pub shape: Shape,
    /// The load, as a fraction 0…1.
    pub load_share: f64,
}

/// The movement of the platform, or of the cable of a test bench, in a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Steps in one direction with rests, then equally many back.
    StopAndGo {
        /// Length of a step, m.
        step_m: f64,
        /// Rest after each step, s.
        rest_s: f64,
        /// Steps in each direction.
        count: usize,
    },
    /// Steps back and forth with rests.
    Alternating {
        /// Length of a step, m.
        step_m: f64,
        /// Rest after each step, s.
        rest_s: f64,
        /// Number of back-and-forth repetitions.
        count: usize,
    },
    /// Strokes around the middle, back and forth.
    Strokes {
        /// Axis x, y or z (0, 1, 2); `None` for the direction of the box.
        axis: Option<usize>,
        /// Length of a stroke, m.
        length_m: f64,
        /// Greatest speed, m/s.
        speed_m_per_s: f64,
        /// Greatest acceleration, m/s².
        acceleration_m_per_s2: f64,
        /// Number of back-and-forth repetitions.
        count: usize,
    },
    /// The platform rests while the load rises, falls, and returns to its middle.
    LoadSteps {
        /// Rest after each change, s.
        rest_s: f64,
    },
}

/// A change of the load.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ramp {
    start_s: f64,
    from_share: f64,
    to_share: f64,
}

/// The load over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Loads {
    start_share: f64,
    ramps: Vec<Ramp>,
}

impl Loads {
    fn last_share(&self) -> f64 {
        self.ramps.last().map_or(self.start_share, |ramp| ramp.to_share)
    }

    /// Returns the load fraction at a time, by a raised cosine while it changes.
    pub fn share_at(&self, time_s: f64) -> f64 {
        let begun = self.ramps.partition_point(|ramp| ramp.start_s <= time_s);
        let Some(ramp) = begun.checked_sub(1).and_then(|last| self.ramps.get(last)) else { return self.start_share };
        let done = ((time_s - ramp.start_s) / LOAD_CHANGE_S).min(1.0);
        ramp.from_share + (ramp.to_share - ramp.from_share) * 0.5 * (1.0 - libm::cos(PI * done))
    }
}

impl Trajectory {
    /// Creates a run of pieces in a box, within limits. If it takes less than `duration_s`, it rests at the end.
    ///
    /// Movements longer than the box are shortened; speeds and accelerations beyond the limits are reduced to them.
    #[must_use]
    pub fn designed(work_box: &WorkBox, limits: &Limits, pieces: &[Piece], duration_s: f64) -> Self {
        let start_share = pieces.first().map_or(0.5, |piece| piece.load_share);
        let mut run = Self::starting_at(work_box.center_m, LEAD_IN_REST_S);
        run.loads = Some(Loads { start_share, ramps: Vec::new() });
        let mut builder = Builder { run, work_box: *work_box, limits: *limits };
        builder.add(&Shape::Alternating { step_m: LEAD_IN_M, rest_s: LEAD_IN_REST_S, count: 1 });
        for piece in pieces {
            builder.load(piece.load_share);
            builder.add(&piece.shape);
        }
        let mut run = builder.run;
        run.duration_s = run.duration_s.max(duration_s);
        run
    }
}

/// A run under construction.
struct Builder {
    run: Trajectory,
    work_box: WorkBox,
    limits: Limits,
}

impl Builder {
    fn add(&mut self, shape: &Shape) {
        let WorkBox { center_m, direction, .. } = self.work_box;
        match *shape {
            Shape::StopAndGo { step_m, rest_s, count } => {
                #[expect(clippy::cast_precision_loss, reason = "a few steps")]
                let step_m = step_m.min(self.reach_m(&direction) / count.max(1) as f64);
                for sign in [1.0, -1.0] {
                    for _ in 0..count {
                        let to_m = self.run.place_m() + direction * (sign * step_m);
                        self.step_to(Phase::StopAndGo, to_m, rest_s);
                    }
                }
                // Sums of steps accumulate rounding errors.
                self.step_to(Phase::StopAndGo, center_m, 0.0);
            }
            Shape::Alternating { step_m, rest_s, count } => {
                let to_m = center_m + direction * step_m.min(self.reach_m(&direction));
                for _ in 0..count {
                    self.step_to(Phase::Alternating, to_m, rest_s);
                    self.step_to(Phase::Alternating, center_m, rest_s);
                }
            }
            Shape::Strokes { axis, length_m, speed_m_per_s, acceleration_m_per_s2, count } => {
                let direction = axis.map_or(direction, |axis| Vector3::ith(axis.min(2), 1.0));
                let end_m = direction * (0.5 * length_m).min(self.reach_m(&direction));
                for to_m in [center_m + end_m, center_m - end_m].into_iter().cycle().take(2 * count) {
                    self.go(Phase::Stroke, to_m, speed_m_per_s, acceleration_m_per_s2);
                }
                self.go(Phase::Stroke, center_m, speed_m_per_s, acceleration_m_per_s2);
            }
            Shape::LoadSteps { rest_s } => {
                for share in LOAD_STEPS {
                    self.load(share);
                    self.run.rest(rest_s);
                }
            }
        }
    }

    /// Returns the distance from the middle to the surface of the box along a direction, m.
    fn reach_m(&self, direction: &Vector3<f64>) -> f64 {
        self.work_box.reach_m(direction)
    }

    fn step_to(&mut self, phase: Phase, to_m: Vector3<f64>, rest_s: f64) {
        self.go(phase, to_m, STEP_M_PER_S, ACCELERATION_M_PER_S2);
        self.run.rest(rest_s);
    }

    fn go(&mut self, phase: Phase, to_m: Vector3<f64>, speed_m_per_s: f64, acceleration_m_per_s2: f64) {
        let speed_m_per_s = speed_m_per_s.min(self.limits.speed_m_per_s);
        let acceleration_m_per_s2 = acceleration_m_per_s2.min(self.limits.acceleration_m_per_s2);
        self.run.go(phase, to_m, speed_m_per_s, acceleration_m_per_s2);
    }

    /// Rests while the load changes to a fraction; takes no time if the load is already there.
    fn load(&mut self, to_share: f64) {
        let start_s = self.run.duration_s;
        let Some(loads) = &mut self.run.loads else { return };
        let from_share = loads.last_share();
        if (to_share - from_share).abs() > 1e-9 {
            loads.ramps.push(Ramp { start_s, from_share, to_share });
            self.run.rest(LOAD_CHANGE_S);
        }
    }
}
