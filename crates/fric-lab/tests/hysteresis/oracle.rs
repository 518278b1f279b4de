//! Widths that are known beforehand.

use fric_core::Wrench;
use fric_lab::CartesianAxis;
use nalgebra::SVector;

use super::logs::{Log, along, gravity, hysteresis, pose};
use crate::simulate::robots::frictionless_eight;

/// Away from the middle, turned: nothing is where a base axis is.
fn center() -> fric_core::Pose {
    pose([0.03, -0.02, 0.05], [0.04, -0.03, 0.02])
}

fn wrench(vector: &SVector<f64, 6>) -> Wrench {
    Wrench { force_n: vector.fixed_rows::<3>(0).into_owned(), torque_nm: vector.fixed_rows::<3>(3).into_owned() }
}

#[test]
fn a_force_that_depends_on_the_direction_is_the_width() {
    let robot = frictionless_eight();
    for (axis, half) in CartesianAxis::ALL.into_iter().zip([1.5, 0.7, -2.0, 0.05, -0.04, 0.003]) {
        let mut log = Log::new(&robot);
        log.cross(axis, &center(), 6, half, &gravity());
        let (found, axes) = hysteresis(&robot, &log.samples).unwrap();
        assert!((found.position_m - center().position_m).amax() < 1e-9, "{axis:?}: {found:?}");
        assert!(found.orientation.angle_to(&center().orientation) < 1e-7, "{axis:?}: {found:?}");
        let [only] = axes.as_slice() else { panic!("{axes:?}") };
        assert_eq!((only.axis, only.pass_count, only.is_applied_subtracted), (axis, 6, false));
        for width in [only.without, only.with] {
            assert!((width.width - 2.0 * half.abs()).abs() < 1e-9, "{axis:?}: {width:?}");
            assert!(width.standard_error.unwrap() < 1e-9);
        }
        assert!((only.lasting_ratio().unwrap() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn all_axes_in_one_log_that_starts_elsewhere() {
    let robot = frictionless_eight();
    let mut log = Log::new(&robot);
    // From a corner across, then a line to and fro that nothing else crosses.
    for step in 0..200 {
        let share = 1.0 - f64::from(step) / 200.0;
        log.add(&pose([0.1 * share, -0.09 * share, 0.12 * share], [0.0, 0.1 * share, 0.0]), &gravity(), None);
    }
    log.cross(CartesianAxis::Y, &pose([0.0, 0.0, -0.1], [0.0; 3]), 9, 0.2, &gravity());
    let halves = [1.5, 0.7, -2.0, 0.05, -0.04, 0.003];
    for (axis, half) in CartesianAxis::ALL.into_iter().zip(halves) {
        log.cross(axis, &center(), 4, half, &gravity());
    }
    let (found, axes) = hysteresis(&robot, &log.samples).unwrap();
    assert!((found.position_m - center().position_m).amax() < 1e-4, "{found:?}");
    assert_eq!(axes.iter().map(|axis| axis.axis).collect::<Vec<_>>(), CartesianAxis::ALL);
    for (axis, half) in axes.iter().zip(halves) {
        assert_eq!(axis.pass_count, 4, "{axis:?}");
        assert!((axis.without.width - 2.0 * half.abs()).abs() < 1e-6, "{axis:?}");
    }
}

#[test]
fn what_is_applied_does_not_count_where_the_log_knows_it() {
    let robot = frictionless_eight();
    let (half_n, hand_n) = (0.4, 3.0);
    for knows in [true, false] {
        let mut log = Log::new(&robot);
        log.cross(CartesianAxis::X, &center(), 5, half_n + hand_n, &gravity());
        let mut forward = true;
        let mut last_m = f64::NEG_INFINITY;
        for sample in log.samples.iter_mut().filter(|_| knows) {
            let place_m = sample.pose.unwrap().position_m.x;
            // At an end one way stops and the other starts at the same place.
            if (place_m - last_m).abs() > 0.0 {
                forward = place_m > last_m;
            }
            last_m = place_m;
            let mut applied = gravity();
            applied[0] += if forward { hand_n } else { -hand_n };
            sample.outside_wrench = Some(wrench(&applied));
        }
        let (_, axes) = hysteresis(&robot, &log.samples).unwrap();
        assert_eq!(axes[0].is_applied_subtracted, knows);
        let expected_n = 2.0 * if knows { half_n } else { half_n + hand_n };
        assert!((axes[0].with.width - expected_n).abs() < 1e-9, "{:?}", axes[0]);
    }
}

#[test]
fn the_standard_error_is_that_of_the_noise() {
    let robot = frictionless_eight();
    let mut random = 1_u64;
    let mut noise_n = || {
        // The sum of twelve uniform numbers is nearly normal.
        let sum: f64 = (0..12)
            .map(|_| {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                f64::from((random >> 40) as u32) / f64::from(1_u32 << 24)
            })
            .sum();
        0.05 * (sum - 6.0)
    };
    let half_n = 0.6;
    let mut log = Log::new(&robot);
    log.cross(CartesianAxis::Z, &center(), 40, half_n, &gravity());
    for sample in &mut log.samples {
        sample.cables.iter_mut().for_each(|cable| cable.sensor_force_n += noise_n());
    }
    let (_, axes) = hysteresis(&robot, &log.samples).unwrap();
    let (width, error) = (axes[0].with.width, axes[0].with.standard_error.unwrap());
    println!("{width} ± {error} N");
    assert!((width - 2.0 * half_n).abs() < 4.0 * error, "{width} ± {error} N");
    // 0.025 N behind the pulley on each of eight cables, averaged over some 25 samples and 20 passes either way.
    assert!((1e-3..2e-2).contains(&error), "{error}");
}

#[test]
fn a_pose_that_jitters_is_crossed_all_the_same() {
    let robot = frictionless_eight();
    let mut log = Log::new(&robot);
    log.cross(CartesianAxis::X, &center(), 6, 1.0, &gravity());
    log.cross(CartesianAxis::B, &center(), 6, 0.05, &gravity());
    for (number, sample) in log.samples.iter_mut().enumerate() {
        let jitter = 1e-4 * f64::from(u32::try_from(number * 7919 % 13).unwrap()).sin();
        let moved = along(CartesianAxis::Y, &sample.pose.unwrap(), jitter);
        sample.pose = Some(along(CartesianAxis::A, &along(CartesianAxis::X, &moved, -jitter), jitter));
    }
    let (_, axes) = hysteresis(&robot, &log.samples).unwrap();
    assert_eq!(
        axes.iter().map(|axis| (axis.axis, axis.pass_count)).collect::<Vec<_>>(),
        [(CartesianAxis::X, 6), (CartesianAxis::B, 6)]
    );
    assert!((axes[0].with.width - 2.0).abs() < 0.05, "{axes:?}");
}

/// More lines than are kept: the crossing, which comes first, is found all the same, and in no time.
#[test]
fn a_hundred_other_lines_do_not_hide_the_crossing() {
    let robot = frictionless_eight();
    let mut log = Log::new(&robot);
    for axis in [CartesianAxis::X, CartesianAxis::Z] {
        log.cross(axis, &center(), 8, 1.0, &gravity());
    }
    for line in 0..300 {
        let (row, column) = (f64::from(line / 20), f64::from(line % 20));
        let aside = pose([0.0, -0.1 + 0.014 * row, -0.12 + 0.012 * column], [0.0; 3]);
        log.cross(CartesianAxis::X, &aside, 2, 0.0, &gravity());
    }
    let (found, axes) = hysteresis(&robot, &log.samples).unwrap();
    assert!((found.position_m - center().position_m).amax() < 1e-3, "{found:?}");
    assert_eq!(axes.iter().map(|axis| axis.axis).collect::<Vec<_>>(), [CartesianAxis::X, CartesianAxis::Z]);
}
