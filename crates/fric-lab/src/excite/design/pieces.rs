//! The pieces from which a run can be composed.
//!
//! Steps with short and long rests show presliding and friction that grows at rest. Strokes from a few millimetres per second up to the limit show
//! dependence on speed and acceleration, and short ones show the reversals. Long strokes cover the length of the cable and, along other axes, wraps
//! and tensions. Loads from low to high show which friction depends on the load.

use crate::trajectory::{
    ACCELERATION_M_PER_S2, Limits, Piece, STROKE_ACCELERATION_M_PER_S2, Shape, Trajectory, WorkBox,
};

/// Loads of pieces, as fractions of the range from the least to the greatest force.
const LOADS: [f64; 3] = [0.1, 0.5, 0.9];
/// The load of a run that cannot change it.
const MIDDLE: f64 = 0.5;
/// Alternating steps: length in m and rest in s.
const ALTERNATING: [(f64, f64); 6] =
    [(0.000_3, 0.15), (0.001, 0.1), (0.003, 0.15), (0.003, 0.7), (0.01, 0.3), (0.01, 2.0)];
/// Steps in one direction: length in m and rest in s.
const STOP_AND_GO: [(f64, f64); 3] = [(0.001, 0.1), (0.004, 0.5), (0.01, 1.5)];
/// Speeds of strokes, m/s.
const SPEEDS_M_PER_S: [f64; 8] = [0.003, 0.01, 0.025, 0.06, 0.15, 0.35, 0.7, 1.0];
/// From this speed on, strokes are made with a low and with a high acceleration.
const BRISK_M_PER_S: f64 = 0.15;
/// Duration at constant speed of a short and of a long stroke, s.
const SHORT_S: f64 = 0.15;
const LONG_S: f64 = 1.0;
/// Target duration of a piece, s, and its maximum.
const PIECE_S: f64 = 1.6;
const LONGEST_PIECE_S: f64 = 7.0;
/// Maximum number of repetitions in a piece.
const MOST_REPETITIONS: usize = 12;

/// Returns all pieces of a box within limits. `states_loads` says whether the run can change the load, `has_axes` whether there is a platform.
pub fn pieces(work_box: &WorkBox, limits: &Limits, states_loads: bool, has_axes: bool, longest_s: f64) -> Vec<Piece> {
    let loads: &[f64] = if states_loads { &LOADS } else { &[MIDDLE] };
    let shapes = shapes(work_box, limits, has_axes);
    let mut pieces: Vec<Piece> = loads
        .iter()
        .flat_map(|load_share| shapes.iter().map(|shape| Piece { shape: *shape, load_share: *load_share }))
        .collect();
    if states_loads {
        let steps = [0.1, 0.5].map(|rest_s| Piece { shape: Shape::LoadSteps { rest_s }, load_share: MIDDLE });
        pieces.extend(steps);
    }
    let longest_s = longest_s.min(LONGEST_PIECE_S);
    pieces.retain(|piece| duration_s(work_box, limits, piece) <= longest_s);
    pieces
}

/// Returns the duration of a piece, s.
pub fn duration_s(work_box: &WorkBox, limits: &Limits, piece: &Piece) -> f64 {
    let of = |pieces: &[Piece]| Trajectory::designed(work_box, limits, pieces, 0.0).duration_s();
    of(&[*piece]) - of(&[])
}

fn shapes(work_box: &WorkBox, limits: &Limits, has_axes: bool) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for (step_m, rest_s) in ALTERNATING {
        shapes.push(repeated(work_box, limits, |count| Shape::Alternating { step_m, rest_s, count }));
    }
    for (step_m, rest_s) in STOP_AND_GO {
        shapes.push(repeated(work_box, limits, |count| Shape::StopAndGo { step_m, rest_s, count }));
    }
    let mut strokes = |axis: Option<usize>, speed_m_per_s: f64, at_speed_s: f64, acceleration_m_per_s2: f64| {
        // Both ramps together cover π·v²/(2·a).
        let ramps_m = 0.5 * core::f64::consts::PI * speed_m_per_s * speed_m_per_s / acceleration_m_per_s2;
        let length_m = speed_m_per_s * at_speed_s + ramps_m;
        let stroke = |count| Shape::Strokes { axis, length_m, speed_m_per_s, acceleration_m_per_s2, count };
        shapes.push(repeated(work_box, limits, stroke));
    };
    let fastest = limits.speed_m_per_s;
    let speeds = SPEEDS_M_PER_S.into_iter().filter(|speed| *speed <= fastest);
    let fastest = Some(fastest).filter(|fastest| fastest.is_finite() && *fastest < SPEEDS_M_PER_S[7]);
    for speed_m_per_s in speeds.chain(fastest) {
        for at_speed_s in [SHORT_S, LONG_S] {
            strokes(None, speed_m_per_s, at_speed_s, ACCELERATION_M_PER_S2);
        }
        if speed_m_per_s >= BRISK_M_PER_S {
            strokes(None, speed_m_per_s, SHORT_S, STROKE_ACCELERATION_M_PER_S2);
        }
    }
    if has_axes {
        for axis in (0..3).filter(|axis| work_box.half_edges_m[*axis] > 0.0) {
            for speed_m_per_s in [0.06, 0.35] {
                strokes(Some(axis), speed_m_per_s, LONG_S, ACCELERATION_M_PER_S2);
            }
        }
    }
    shapes
}

/// Returns a shape with as many repetitions as fill the duration of a piece, at least one.
fn repeated(work_box: &WorkBox, limits: &Limits, shape: impl Fn(usize) -> Shape) -> Shape {
    let takes_s = |count| duration_s(work_box, limits, &Piece { shape: shape(count), load_share: MIDDLE });
    let count = (1..=MOST_REPETITIONS).take_while(|count| *count == 1 || takes_s(*count) <= PIECE_S).last();
    shape(count.unwrap_or(1))
}
