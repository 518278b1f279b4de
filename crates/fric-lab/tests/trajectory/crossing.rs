//! The crossing run: every axis crossed at constant speed both ways, smooth, closed.

use fric_lab::CartesianAxis;
use fric_lab::trajectory::{CROSSING_CYCLES, Phase, Trajectory};
use nalgebra::{UnitQuaternion, Vector3};

const CENTER_M: Vector3<f64> = Vector3::new(0.1, 0.2, 0.3);

fn run() -> Trajectory {
    Trajectory::crossing(CENTER_M, &Vector3::new(0.05, 0.03, 0.0), &Vector3::new(0.08, 0.02, 0.04))
}

/// Way along an axis from the middle, m or rad, and the rate.
fn along(run: &Trajectory, axis: CartesianAxis, time_s: f64) -> (f64, f64) {
    let here = run.at(time_s);
    let (place, rate) = if axis.is_rotation() {
        (here.orientation.scaled_axis(), here.angular_velocity_rad_per_s)
    } else {
        (here.position_m - CENTER_M, here.velocity_m_per_s)
    };
    (place.dot(&axis.direction()), rate.dot(&axis.direction()))
}

#[test]
fn each_axis_is_crossed_both_ways_at_constant_speed() {
    let run = run();
    for axis in CartesianAxis::ALL {
        let (mut crossings, mut time_s) = ([0, 0], 0.0);
        while time_s < run.duration_s() {
            let (before, after) = (along(&run, axis, time_s), along(&run, axis, time_s + 0.001));
            if before.0 * after.0 < 0.0 {
                crossings[usize::from(after.1 > 0.0)] += 1;
                assert!(before.1.abs() > 0.05 && (before.1 - after.1).abs() < 1e-12, "{axis:?} at {time_s}");
                assert_eq!(run.phase_at(time_s), Some(Phase::Crossing(axis)));
            }
            time_s += 0.001;
        }
        let expected = if axis == CartesianAxis::Z { 0 } else { CROSSING_CYCLES };
        assert_eq!(crossings, [expected; 2], "{axis:?}");
    }
}

#[test]
fn smooth_within_its_amplitudes_and_closed() {
    let run = run();
    let step_s = 0.000_5;
    let mut last = run.at(0.0);
    let mut time_s = step_s;
    while time_s < run.duration_s() + 2.0 {
        let here = run.at(time_s);
        let mean = (here.position_m - last.position_m) / step_s;
        assert!((mean - (here.velocity_m_per_s + last.velocity_m_per_s) / 2.0).norm() < 1e-4, "{time_s}");
        // Rotation vector of the step, base axes.
        let turned = (here.orientation * last.orientation.inverse()).scaled_axis() / step_s;
        let rate = (here.angular_velocity_rad_per_s + last.angular_velocity_rad_per_s) / 2.0;
        assert!((turned - rate).norm() < 1e-4, "{time_s}");
        assert!(((here.position_m - CENTER_M).abs() - Vector3::new(0.05, 0.03, 0.0)).max() < 1e-12);
        assert!(here.orientation.angle() < 0.08 + 1e-12);
        last = here;
        time_s += step_s;
    }
    let end = run.at(run.duration_s() - 1e-9);
    assert_eq!((end.position_m, end.orientation), (CENTER_M, UnitQuaternion::identity()));
    assert_eq!((end.velocity_m_per_s, end.angular_velocity_rad_per_s), (Vector3::zeros(), Vector3::zeros()));
}
