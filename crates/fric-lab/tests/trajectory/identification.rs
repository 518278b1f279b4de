//! The identification run against what \[P\], section III C, lists.

use fric_lab::trajectory::{
    AMPLITUDES_M, Leg, Limits, Phase, RECTANGLES_M_PER_S, STROKE_ACCELERATION_M_PER_S2, Trajectory, WorkBox,
};
use nalgebra::Vector3;

fn run() -> Trajectory {
    run_within(&Limits::NONE)
}

fn run_within(limits: &Limits) -> Trajectory {
    let work_box = WorkBox {
        center_m: Vector3::new(0.1, 0.2, 0.3),
        half_edges_m: Vector3::new(0.2, 0.15, 0.18),
        direction: Vector3::new(1.0, 1.0, 0.0).normalize(),
    };
    Trajectory::identification(&work_box, limits)
}

fn legs(run: &Trajectory, phase: Phase) -> Vec<&Leg> {
    run.legs().iter().filter(|leg| leg.phase == phase).collect()
}

fn length_m(leg: &Leg) -> f64 {
    (leg.to_m - leg.from_m).norm()
}

#[test]
fn small_steps_one_way_then_the_other_with_breaks() {
    let run = run();
    let steps = legs(&run, Phase::StopAndGo);
    assert_eq!(steps.len(), 2 * AMPLITUDES_M.len());
    assert!((AMPLITUDES_M[0] - 0.25e-3).abs() < 1e-12 && (AMPLITUDES_M[5] - 0.01).abs() < 1e-12);
    let direction = Vector3::new(1.0, 1.0, 0.0).normalize();
    for (place, (leg, amplitude_m)) in steps.iter().zip(AMPLITUDES_M.iter().chain(&AMPLITUDES_M)).enumerate() {
        let sign = if place < AMPLITUDES_M.len() { 1.0 } else { -1.0 };
        assert!((leg.to_m - leg.from_m - direction * (sign * amplitude_m)).norm() < 1e-12);
        assert!(leg.peak_m_per_s() <= 0.083 + 1e-12);
        let next = run.legs().iter().find(|next| next.start_s > leg.start_s).unwrap();
        assert!((next.start_s - leg.end_s() - 0.5).abs() < 1e-9);
    }
    assert!((steps[5].peak_m_per_s() - 0.083).abs() < 1e-12);
}

#[test]
fn small_steps_alternate_with_breaks() {
    let run = run();
    let steps = legs(&run, Phase::Alternating);
    for (pair, amplitude_m) in steps.chunks(2).zip(AMPLITUDES_M) {
        assert!((length_m(pair[0]) - amplitude_m).abs() < 1e-12);
        assert!((pair[1].to_m - pair[0].from_m).norm() < 1e-12);
        assert!((pair[1].start_s - pair[0].end_s() - 0.5).abs() < 1e-9);
    }
    assert_eq!(steps.len(), 12);
}

#[test]
fn strokes_of_100_mm_reach_every_speed_up_to_1_m_per_s() {
    let run = run();
    let strokes = legs(&run, Phase::Stroke);
    let full: Vec<_> = strokes.iter().filter(|leg| (length_m(leg) - 0.1).abs() < 1e-12).collect();
    for speed_m_per_s in [0.167, 0.333, 0.5, 0.667, 0.833, 1.0] {
        let reached = full.iter().filter(|leg| (leg.peak_m_per_s() - speed_m_per_s).abs() < 1e-9);
        assert!(reached.count() >= 3, "{speed_m_per_s}");
    }
    assert!(full.windows(2).all(|pair| pair[0].peak_m_per_s() <= pair[1].peak_m_per_s() + 1e-12));
    for pair in full.windows(2) {
        let cos = (pair[0].to_m - pair[0].from_m).normalize().dot(&(pair[1].to_m - pair[1].from_m).normalize());
        assert!((cos + 1.0).abs() < 1e-12, "strokes alternate");
    }
}

#[test]
fn rectangles_go_round_the_box_at_both_speeds() {
    let run = run();
    for speed_m_per_s in RECTANGLES_M_PER_S {
        let sides = legs(&run, Phase::Rectangle);
        let sides: Vec<_> = sides.iter().filter(|leg| (leg.peak_m_per_s() - speed_m_per_s).abs() < 1e-9).collect();
        for (edge_m, count) in [(0.4, 4), (0.3, 4), (0.36, 1)] {
            let along_axis = sides.iter().filter(|leg| (leg.to_m - leg.from_m).amax() > length_m(leg) - 1e-12);
            assert_eq!(along_axis.filter(|leg| (length_m(leg) - edge_m).abs() < 1e-12).count(), count, "{edge_m}");
        }
        for corner in 0..8 {
            let sign = |bit: i32| f64::from((corner >> bit & 1) * 2 - 1);
            let corner_m = Vector3::new(0.1 + 0.2 * sign(0), 0.2 + 0.15 * sign(1), 0.3 + 0.18 * sign(2));
            assert!(sides.iter().any(|leg| (leg.to_m - corner_m).norm() < 1e-12), "{corner_m}");
        }
    }
    assert!(RECTANGLES_M_PER_S.iter().zip([0.167, 0.5]).all(|(is, said)| (is - said).abs() < 1e-12));
}

#[test]
fn smooth_within_limits_inside_the_box_and_closed() {
    let run = run();
    let step_s = 0.000_5;
    let mut last = run.at(0.0);
    let mut time_s = step_s;
    // Beyond the end: the run goes on from the start.
    while time_s < run.duration_s() + 2.0 {
        let here = run.at(time_s);
        let mean = (here.position_m - last.position_m) / step_s;
        let trapezoid = (here.velocity_m_per_s + last.velocity_m_per_s) / 2.0;
        assert!((mean - trapezoid).norm() < 1e-4, "{time_s}");
        let change = here.acceleration_m_per_s2 - last.acceleration_m_per_s2;
        assert!(change.norm() < 0.7, "{time_s}: {}", change.norm());
        assert!(here.acceleration_m_per_s2.norm() <= STROKE_ACCELERATION_M_PER_S2 * (1.0 + 1e-12));
        let outside_m = (here.position_m - Vector3::new(0.1, 0.2, 0.3)).abs() - Vector3::new(0.2, 0.15, 0.18);
        assert!(outside_m.max() < 1e-12, "{time_s}");
        last = here;
        time_s += step_s;
    }
    assert_eq!(run.at(run.duration_s() - 1e-9).velocity_m_per_s, Vector3::zeros());
    assert!((run.at(run.duration_s() - 1e-9).position_m - run.at(0.0).position_m).norm() < 1e-12);
}

#[test]
fn a_small_box_makes_movements_shorter() {
    let half_edges_m = Vector3::new(0.01, 0.01, 0.01);
    let center_m = Vector3::zeros();
    let work_box = WorkBox { center_m, half_edges_m, direction: Vector3::x() };
    let small = Trajectory::identification(&work_box, &Limits::NONE);
    let mut time_s = 0.0;
    while time_s < small.duration_s() {
        assert!(small.at(time_s).position_m.amax() <= 0.02 + 1e-12);
        time_s += 0.001;
    }
}

#[test]
fn limits_cap_speed_and_acceleration_and_change_nothing_else() {
    let limits = Limits { speed_m_per_s: 0.3, acceleration_m_per_s2: 2.0 };
    let (capped, free) = (run_within(&limits), run());
    assert_eq!(capped.legs().len(), free.legs().len());
    for (capped, free) in capped.legs().iter().zip(free.legs()) {
        assert_eq!((capped.from_m, capped.to_m, capped.phase), (free.from_m, free.to_m, free.phase));
    }
    let (mut fastest, mut strongest, mut time_s) = (0.0_f64, 0.0_f64, 0.0);
    while time_s < capped.duration_s() {
        let here = capped.at(time_s);
        fastest = fastest.max(here.velocity_m_per_s.norm());
        strongest = strongest.max(here.acceleration_m_per_s2.norm());
        time_s += 0.001;
    }
    assert!((0.299..=0.3 + 1e-12).contains(&fastest), "{fastest}");
    assert!((1.99..=2.0 + 1e-12).contains(&strongest), "{strongest}");
}
