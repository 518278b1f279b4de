//! Logs that show no hysteresis, and what is said about them.

use fric_core::Pose;
use fric_lab::CartesianAxis;
use fric_lab::hysteresis::{HysteresisError, Survey};
use miette::Diagnostic as _;

use super::logs::{Log, gravity, hysteresis, pose};
use crate::simulate::robots::{bench, frictionless_eight};

const FLAT: [f64; 3] = [0.0; 3];

/// The error for a log of these poses.
fn refused(poses: impl Iterator<Item = Pose>) -> HysteresisError {
    let robot = frictionless_eight();
    let mut log = Log::new(&robot);
    poses.for_each(|pose| log.add(&pose, &gravity(), None));
    hysteresis(&robot, &log.samples).unwrap_err()
}

/// To and fro between −1 and 1.
fn swing() -> impl Iterator<Item = f64> {
    (0..2000).map(|step| (f64::from(step) * 0.02).sin())
}

#[test]
fn without_geometry_there_is_no_wrench() {
    let error = Survey::new(&bench("{ wrap_deg = 90.0, sensor = true }", "mu = 0.02")).unwrap_err();
    assert_eq!(error, HysteresisError::NoGeometry { cable: "winch".to_owned() });
}

#[test]
fn without_a_pose_there_is_none() {
    let robot = frictionless_eight();
    let mut log = Log::new(&robot);
    log.cross(CartesianAxis::X, &Pose::identity(), 4, 1.0, &gravity());
    log.samples.iter_mut().for_each(|sample| sample.pose = None);
    assert_eq!(hysteresis(&robot, &log.samples).unwrap_err(), HysteresisError::NoPose);
}

#[test]
fn a_platform_at_rest_crosses_nothing() {
    assert_eq!(refused((0..500).map(|_| pose([0.1, 0.0, 0.0], FLAT))), HysteresisError::NoMovement);
    let jitter = swing().map(|part| pose([1e-4 * part, 0.0, -1e-4 * part], FLAT));
    assert_eq!(refused(jitter), HysteresisError::NoMovement);
}

#[test]
fn movements_along_all_axes_at_once_are_told() {
    let diagonal = swing().map(|part| pose([0.05 * part, 0.05 * part, -0.03 * part], FLAT));
    assert_eq!(refused(diagonal), HysteresisError::SeveralAxes);
    let slanting = swing().map(|part| pose([0.05 * part, 0.02 * part, 0.0], FLAT));
    assert_eq!(refused(slanting), HysteresisError::SeveralAxes);
    let screw = swing().map(|part| pose([0.0, 0.0, 0.03 * part], [0.0, 0.0, 0.2 * part]));
    assert_eq!(refused(screw), HysteresisError::SeveralAxes);
}

#[test]
fn one_way_is_no_crossing() {
    let one_way = (0..500).map(|step| pose([1e-4 * f64::from(step), 0.0, 0.0], FLAT));
    assert_eq!(refused(one_way), HysteresisError::NoCrossing);
}

#[test]
fn a_cable_without_a_force_leaves_no_wrench() {
    let robot = frictionless_eight();
    let mut log = Log::new(&robot);
    log.cross(CartesianAxis::X, &Pose::identity(), 4, 1.0, &gravity());
    log.samples.iter_mut().for_each(|sample| sample.cables[3].sensor_force_n = f64::NAN);
    assert_eq!(hysteresis(&robot, &log.samples).unwrap_err(), HysteresisError::NoWrench);
}

#[test]
fn what_is_not_finite_breaks_its_pass_alone() {
    let robot = frictionless_eight();
    let mut log = Log::new(&robot);
    log.cross(CartesianAxis::X, &Pose::identity(), 8, 1.0, &gravity());
    log.samples[60].cables[3].sensor_force_n = f64::NAN;
    log.samples[121 + 60].pose = None;
    let (_, axes) = hysteresis(&robot, &log.samples).unwrap();
    assert_eq!(axes[0].pass_count, 6);
    assert!((axes[0].with.width - 2.0).abs() < 1e-9, "{axes:?}");
}

#[test]
fn each_error_says_what_to_do() {
    use HysteresisError::{NoCrossing, NoMovement, NoPose, NoWrench, SeveralAxes};
    for error in [NoCrossing, NoMovement, NoPose, NoWrench, SeveralAxes] {
        assert!(error.help().is_some_and(|advice| advice.to_string().ends_with('.')), "{error}");
    }
}
