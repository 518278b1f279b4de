//! Structure matrix and wrench, \[P\] 1–3.

use fric_core::platform::structure_matrix;
use fric_core::robot::{CableOptions, FrictionOptions, GeometryOptions, PlatformOptions, Presliding, PulleyOptions};
use fric_core::{Compensator, Pose, RobotParams, Wrench};
use shifted::{lengths_m, turned};

use crate::random::Random;
use crate::support::{GUIDE_90, UNMONITORED, assert_near, checked, corner_cable, platform, smooth_input};

/// Helpers that move a pose by hand.
mod shifted {
    use fric_core::{CableParams, Pose};

    use crate::support::{add, cross, dot, scale};

    pub fn lengths_m(cables: &[CableParams], pose: &Pose) -> Vec<f64> {
        cables.iter().map(|cable| cable.length_m(pose).unwrap()).collect()
    }

    /// The pose moved by `shift` along (rows 0…2) or turned about (rows 3…5) a base axis through the platform origin.
    pub fn turned(pose: &Pose, row: usize, shift: f64) -> Pose {
        let position_m: [f64; 3] = pose.position_m.into();
        let parts: [f64; 4] = pose.orientation.coords.into();
        if row < 3 {
            let mut moved = position_m;
            moved[row] += shift;
            return Pose::from_parts(moved, parts).unwrap();
        }
        // Hamilton product of the small turn (on the left: base axes) with the orientation.
        let mut axis = [0.0; 3];
        axis[row - 3] = (0.5 * shift).sin();
        let (real, [x, y, z, w]) = ((0.5 * shift).cos(), parts);
        let turn = cross(axis, [x, y, z]);
        let imaginary = add(add(scale([x, y, z], real), scale(axis, w)), turn);
        let product = [imaginary[0], imaginary[1], imaginary[2], real * w - dot(axis, [x, y, z])];
        Pose::from_parts(position_m, product).unwrap()
    }
}

fn robot_cables(random: &mut Random) -> Vec<fric_core::CableParams> {
    (0..8)
        .map(|index| {
            let pulleys =
                [GUIDE_90, PulleyOptions::Swivel { radius_m: random.range(0.0, 0.05), axis: random.unit_vector() }];
            let eyelet = [GUIDE_90];
            let geometry = GeometryOptions {
                base_m: [0.6, 0.5, 0.7].map(|size| size * [-1.0, 1.0][usize::from(random.below(2) == 1)]),
                platform_m: random.vector(0.08),
            };
            let list: &[PulleyOptions] = if index % 4 == 3 { &eyelet } else { &pulleys };
            checked(&[CableOptions { geometry: Some(geometry), ..CableOptions::new(list) }])[0]
        })
        .collect()
}

#[test]
fn structure_matrix_is_the_derivative_of_the_lengths() {
    let mut random = Random::new(51);
    for _ in 0..100 {
        let cables = robot_cables(&mut random);
        let robot = RobotParams::new(0.001, &PlatformOptions::default(), UNMONITORED, &cables).unwrap();
        let pose = random.pose(0.2);
        let matrix = structure_matrix::<8>(&robot, &pose).unwrap();
        let shift = 1e-5;
        for row in 0..6 {
            let ahead = lengths_m(&cables, &turned(&pose, row, shift));
            let behind = lengths_m(&cables, &turned(&pose, row, -shift));
            for (cable, (ahead, behind)) in ahead.into_iter().zip(behind).enumerate() {
                // dl/dx = −u: a platform that moves towards the exit shortens the cable.
                assert_near(matrix[(row, cable)], -(ahead - behind) / (2.0 * shift), 3e-9);
            }
        }
    }
}

#[test]
fn the_cycles_structure_matrix_and_wrench_are_those_of_the_parameters() {
    let options: Vec<_> = (0..7).map(|index| corner_cable(index, Presliding::PerPulley)).collect();
    let cables = checked(&options);
    let robot = RobotParams::new(0.001, &platform(), UNMONITORED, &cables).unwrap();
    let mut compensator = Compensator::<9>::new(&robot).unwrap();
    assert!(compensator.structure_matrix().is_none());
    for cycle in 0..500 {
        let input = smooth_input::<9>(cycle);
        let output = compensator.step(&input);
        let pose = input.pose.unwrap();
        let (ours, theirs) = (compensator.structure_matrix().unwrap(), structure_matrix::<9>(&robot, &pose).unwrap());
        assert!((ours - theirs).abs().max() < 1e-14);
        assert!(ours.column(7).iter().chain(ours.column(8).iter()).all(|entry| *entry == 0.0));
        let mut expected = [0.0; 6];
        for (cable, output) in output.cables.iter().enumerate() {
            for (row, sum) in expected.iter_mut().enumerate() {
                *sum -= theirs[(row, cable)] * output.force_at_platform_n;
            }
        }
        let outside = output.outside_wrench.unwrap();
        for (one, other) in outside.to_vector().iter().zip(expected) {
            assert_near(*one, other, 1e-13);
        }
        let gravity = Wrench::of_gravity(&robot, &pose.orientation);
        assert_near(gravity.force_n.z, -0.41 * 9.80665, 1e-15);
        let applied = output.applied_wrench.unwrap();
        for (row, one) in applied.to_vector().iter().enumerate() {
            assert_near(*one, expected[row] - gravity.to_vector()[row], 1e-13);
        }
        assert!(output.cables[7..].iter().all(|cable| *cable == fric_core::CableOutput::default()));
    }
}

#[test]
fn structure_matrix_needs_room_and_geometry() {
    let with = corner_cable(0, Presliding::PerPulley);
    let pulleys = [GUIDE_90];
    let without = CableOptions::new(&pulleys);
    for (options, expected) in [(vec![with, with], true), (vec![with, without], false), (vec![with, with, with], false)]
    {
        let cables = checked(&options);
        let robot = RobotParams::new(0.001, &platform(), UNMONITORED, &cables).unwrap();
        assert_eq!(structure_matrix::<2>(&robot, &Pose::identity()).is_some(), expected);
    }
}

#[test]
fn the_wrench_is_linear_in_the_forces() {
    // Without friction and offset the platform force is the sensor's, so the wrench must be linear in it.
    let options: Vec<_> = (0..8)
        .map(|index| CableOptions { friction: FrictionOptions::default(), ..corner_cable(index, Presliding::Lumped) })
        .collect();
    let mut random = Random::new(52);
    let pose = random.pose(0.1);
    let wrench = |forces_n: [f64; 8]| {
        let mut compensator = crate::support::compensator::<8>(&options, UNMONITORED);
        let cables = forces_n.map(|sensor_force_n| fric_core::CableInput { sensor_force_n, ..Default::default() });
        compensator
            .step(&fric_core::CycleInput { cables, pose: Some(pose), ..fric_core::CycleInput::default() })
            .outside_wrench
            .unwrap()
            .to_vector()
    };
    for _ in 0..200 {
        let mut draw = || [(); 8].map(|()| random.range(0.1, 50.0));
        let (a, b) = (draw(), draw());
        let factor = 2.5;
        let combined = wrench(core::array::from_fn(|cable| a[cable] + factor * b[cable]));
        let separate = wrench(a) + wrench(b) * factor;
        assert!((combined - separate).abs().max() < 1e-11);
    }
}

#[test]
fn poses_that_are_none_are_refused() {
    let good = [0.0, 0.0, 0.0, 1.0];
    assert!(Pose::from_parts([0.0; 3], good).is_some());
    assert!(Pose::from_parts([0.0; 3], [0.0, 0.0, 0.0, 1.05]).unwrap().orientation.w == 1.0);
    for quaternion in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 2.0], [f64::INFINITY; 4]] {
        assert_eq!(Pose::from_parts([0.0; 3], quaternion), None);
    }
    for position_m in [[f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0], [0.0, 0.0, 1e7]] {
        assert_eq!(Pose::from_parts(position_m, good), None);
    }
}

#[test]
fn the_parts_of_a_pose_give_it_again_to_the_bit() {
    let mut random = Random::new(71);
    for _ in 0..2000 {
        let quaternion = [(); 4].map(|()| random.range(-1.0, 1.0));
        let norm = quaternion.iter().map(|part| part * part).sum::<f64>().sqrt();
        let stretch = random.range(0.91, 1.09) / norm;
        let pose = Pose::from_parts([0.1, 0.2, 0.3], quaternion.map(|part| part * stretch)).unwrap();
        assert!((pose.orientation.coords.norm() - 1.0).abs() <= 4.0 * f64::EPSILON);
        assert_eq!(Pose::from_parts(pose.position_m.into(), pose.orientation.coords.into()), Some(pose));
    }
}

#[test]
fn interpolation_goes_the_short_way_round() {
    let mut random = Random::new(53);
    for _ in 0..200 {
        let (one, other) = (random.pose(1.0), random.pose(1.0));
        let flipped = Pose { orientation: fric_negated(&other), ..other };
        for ratio in [0.0, 0.3, 1.0] {
            let (a, b) = (one.interpolate(&other, ratio), one.interpolate(&flipped, ratio));
            assert!(
                (a.orientation.to_rotation_matrix().matrix() - b.orientation.to_rotation_matrix().matrix()).abs().max()
                    < 1e-12
            );
            assert!((a.position_m - b.position_m).abs().max() < 1e-15);
        }
        assert!((one.interpolate(&other, 1.0).position_m - other.position_m).abs().max() < 1e-15);
    }
}

/// The same rotation with the other sign of its quaternion.
fn fric_negated(pose: &Pose) -> nalgebra::UnitQuaternion<f64> {
    nalgebra::UnitQuaternion::new_unchecked(-pose.orientation.into_inner())
}
