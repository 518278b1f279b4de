//! The identification run of \[P\], section III C, as a path of the platform over time.
//!
//! Its phases have different purposes: small steps with breaks, in one direction and alternating, show presliding; strokes of increasing speed show
//! viscous friction; rectangles through the workspace vary tension and wrap. The path is a pure function of time, closed and at rest at both ends, so
//! that it repeats without a jump.
//!
//! \[P\] states amplitudes, speeds and breaks; the acceleration limits, the amplitudes between the stated ends and the order within a phase are
//! chosen here. An amplitude is the length of a step, not half of it.

use nalgebra::Vector3;

use super::{Limits, Phase, Trajectory, WorkBox};

/// Amplitudes of the small movements, m: 0.25…10 mm.
pub const AMPLITUDES_M: [f64; 6] = [0.000_25, 0.000_5, 0.001, 0.002_5, 0.005, 0.010];
/// Speed of the small movements, m/s; reached from about 3 mm on.
pub const STEP_M_PER_S: f64 = 0.083;
/// Rest after each small movement, s.
pub const BREAK_S: f64 = 0.5;
/// Length of the fast alternating movements, m.
pub const STROKE_M: f64 = 0.1;
/// Speeds of the strokes, m/s; each is used twice in both directions.
pub const STROKES_M_PER_S: [f64; 6] = [0.167, 0.333, 0.5, 0.667, 0.833, 1.0];
/// The greatest speed of the strokes, m/s.
pub const FASTEST_M_PER_S: f64 = 1.0;
/// Speeds along the rectangles, m/s.
pub const RECTANGLES_M_PER_S: [f64; 2] = [0.167, 0.5];
/// Acceleration limit of small movements and rectangles, m/s².
pub const ACCELERATION_M_PER_S2: f64 = 4.0;
/// Acceleration limit of the fastest strokes, m/s², needed to reach 1 m/s within 100 mm. Slower strokes accelerate for the same time.
pub const STROKE_ACCELERATION_M_PER_S2: f64 = 16.0;

impl Trajectory {
    /// Creates the run inside a box. A movement that is too long for the box along its direction is shortened; a speed or acceleration beyond the
    /// limits is reduced to them.
    #[must_use]
    pub fn identification(work_box: &WorkBox, limits: &Limits) -> Self {
        let WorkBox { center_m, half_edges_m, direction } = *work_box;
        let mut run = Capped { run: Self::starting_at(center_m, BREAK_S), limits: *limits };
        // The distance from the middle to the box's surface along the direction.
        let reach_m = work_box.reach_m(&direction);
        let fit = |length_m: f64| length_m.min(2.0 * reach_m);

        let all_steps_m: f64 = AMPLITUDES_M.iter().sum();
        let step_scale = fit(all_steps_m) / all_steps_m;
        for sign in [1.0, -1.0] {
            for amplitude_m in AMPLITUDES_M {
                let to_m = run.run.place_m() + direction * (sign * amplitude_m * step_scale);
                run.step_to(Phase::StopAndGo, to_m);
            }
        }
        for amplitude_m in AMPLITUDES_M {
            run.step_to(Phase::Alternating, center_m + direction * fit(amplitude_m));
            run.step_to(Phase::Alternating, center_m);
        }
        let end_m = direction * (0.5 * fit(STROKE_M));
        for speed_m_per_s in STROKES_M_PER_S {
            let acceleration_m_per_s2 = STROKE_ACCELERATION_M_PER_S2 * speed_m_per_s / FASTEST_M_PER_S;
            for to_m in [center_m + end_m, center_m - end_m, center_m + end_m, center_m - end_m] {
                run.go(Phase::Stroke, to_m, speed_m_per_s, acceleration_m_per_s2);
            }
        }
        run.go(Phase::Stroke, center_m, STEP_M_PER_S, ACCELERATION_M_PER_S2);
        // The path goes around the top and the bottom of the box and along an edge between, so that it passes every corner.
        let round = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]];
        for speed_m_per_s in RECTANGLES_M_PER_S {
            for [x, y, z] in [1.0, -1.0].into_iter().flat_map(|z| round.map(|[x, y]| [x, y, z])) {
                let corner_m = center_m + half_edges_m.component_mul(&Vector3::new(x, y, z));
                run.go(Phase::Rectangle, corner_m, speed_m_per_s, ACCELERATION_M_PER_S2);
            }
            run.go(Phase::Rectangle, center_m, speed_m_per_s, ACCELERATION_M_PER_S2);
        }
        run.run.rest(BREAK_S);
        run.run
    }
}

/// A run under construction, with its limits.
struct Capped {
    run: Trajectory,
    limits: Limits,
}

impl Capped {
    fn go(&mut self, phase: Phase, to_m: Vector3<f64>, speed_m_per_s: f64, acceleration_m_per_s2: f64) {
        let speed_m_per_s = speed_m_per_s.min(self.limits.speed_m_per_s);
        let acceleration_m_per_s2 = acceleration_m_per_s2.min(self.limits.acceleration_m_per_s2);
        self.run.go(phase, to_m, speed_m_per_s, acceleration_m_per_s2);
    }

    fn step_to(&mut self, phase: Phase, to_m: Vector3<f64>) {
        self.go(phase, to_m, STEP_M_PER_S, ACCELERATION_M_PER_S2);
        self.run.rest(BREAK_S);
    }
}
