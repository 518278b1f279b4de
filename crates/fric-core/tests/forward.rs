//! The pose from the cable lengths, against lengths in closed form.

use std::f64::consts::PI;

use fric_core::forward::{LengthPose, NoPose, PoseFollower, pose_anywhere, pose_near};
use fric_core::robot::{CableOptions, GeometryOptions, PlatformOptions, PulleyOptions};
use fric_core::{CableInput, CableParams, Pose, RobotParams};

use crate::random::Random;
use crate::support::{GUIDE_90, UNMONITORED, add, checked, cross, dot, norm, scale};

/// A cable of the tests: entry, axis, radius of the last pulley, attachment.
#[derive(Clone, Copy)]
struct Cable {
    entry_m: [f64; 3],
    axis: [f64; 3],
    radius_m: f64,
    platform_m: [f64; 3],
}

/// Pulleys at the corners of a box, entries from above and from below.
fn corners(count: usize) -> Vec<Cable> {
    let cable = |index: usize| {
        let [x, y, z] = [0, 1, 2].map(|bit| if index >> bit & 1 == 0 { 1.0 } else { -1.0 });
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        let uneven = 1.0 + 0.03 * index as f64;
        Cable {
            entry_m: [0.6 * x * uneven, 0.5 * y, 0.7 * z],
            axis: [0.0, 0.0, z],
            radius_m: if index == 3 { 0.0 } else { 0.02 },
            // Crossed, so that a turn about z is no less determined than the others.
            platform_m: if z > 0.0 { [0.02 * x, 0.08 * y, -0.07] } else { [0.08 * x * uneven, 0.02 * y, 0.07] },
        }
    };
    (0..count).map(cable).collect()
}

fn params(cables: &[Cable]) -> Vec<CableParams> {
    let one = |cable: &Cable| {
        let pulleys = [GUIDE_90, PulleyOptions::Swivel { radius_m: cable.radius_m, axis: cable.axis }];
        let geometry = GeometryOptions { base_m: cable.entry_m, platform_m: cable.platform_m };
        checked(&[CableOptions { geometry: Some(geometry), ..CableOptions::new(&pulleys) }])[0]
    };
    cables.iter().map(one).collect()
}

fn robot(params: &[CableParams]) -> RobotParams<'_> {
    RobotParams::new(0.001, &PlatformOptions::default(), UNMONITORED, params).unwrap()
}

/// `l = r·β + √(D² − r²)`, `β = π − (φ + γ)`, `φ = atan2(z, x − r)`, `γ = arccos(r/D)`, in the plane of axis and attachment.
fn length_m(cable: &Cable, pose: &Pose) -> f64 {
    let [x, y, z, w]: [f64; 4] = pose.orientation.coords.into();
    let (imaginary, arm_m) = ([x, y, z], cable.platform_m);
    let turn = scale(cross(imaginary, arm_m), 2.0);
    let turned = add(arm_m, add(scale(turn, w), cross(imaginary, turn)));
    let from_entry = add(add(pose.position_m.into(), turned), scale(cable.entry_m, -1.0));
    let along = dot(from_entry, cable.axis);
    let aside = norm(add(from_entry, scale(cable.axis, -along)));
    if cable.radius_m == 0.0 {
        return norm(from_entry);
    }
    let (radius, to_centre) = (cable.radius_m, (aside - cable.radius_m).hypot(along));
    let wrap = PI - (along.atan2(aside - radius) + (radius / to_centre).acos());
    radius * wrap.rem_euclid(2.0 * PI) + (to_centre * to_centre - radius * radius).sqrt()
}

fn inputs(cables: &[Cable], pose: &Pose) -> Vec<CableInput> {
    cables.iter().map(|cable| CableInput { length_m: length_m(cable, pose), ..CableInput::default() }).collect()
}

/// Up to 0.25 m and 0.45 rad away.
fn somewhere(random: &mut Random) -> Pose {
    let position_m = random.vector(0.25);
    let [x, y, z] = scale(random.unit_vector(), random.range(0.0, 0.22));
    Pose::from_parts(position_m, [x, y, z, (1.0 - x * x - y * y - z * z).sqrt()]).unwrap()
}

fn distance(one: &Pose, other: &Pose) -> (f64, f64) {
    ((one.position_m - other.position_m).norm(), one.orientation.angle_to(&other.orientation))
}

#[track_caller]
fn assert_is(found: Result<LengthPose, NoPose>, pose: &Pose) {
    let found = found.unwrap();
    let (way_m, turn_rad) = distance(&found.pose, pose);
    assert!(way_m < 1e-10 && turn_rad < 1e-9, "{way_m} m, {turn_rad} rad: {found:?} is not {pose:?}");
    assert!(found.residual_rms_m < 1e-12, "{found:?}");
}

#[test]
fn the_pose_is_the_one_whose_lengths_they_are() {
    let mut random = Random::new(61);
    let cables = corners(8);
    let params = params(&cables);
    let robot = robot(&params);
    for _ in 0..1000 {
        let pose = somewhere(&mut random);
        assert_is(pose_anywhere(&robot, &inputs(&cables, &pose)), &pose);
        let shift = random.vector(0.03);
        let near = Pose { position_m: pose.position_m + nalgebra::Vector3::from(shift), ..Pose::identity() };
        assert_is(pose_near(&robot, &inputs(&cables, &pose), &near), &pose);
    }
}

#[test]
fn six_and_seven_cables_are_enough_to_follow_a_motion() {
    for count in [6, 7] {
        let cables = corners(count);
        let params = params(&cables);
        let robot = robot(&params);
        let at = |step: u32| {
            let phase = f64::from(step) * 0.01;
            let (x, y) = (0.1 * phase.sin(), 0.05 * (2.0 * phase).sin());
            Pose::from_parts([x, -y, 0.3 * y], [y, 0.0, x, (1.0 - x * x - y * y).sqrt()]).unwrap()
        };
        let mut last = Pose::identity();
        for step in 0..700 {
            let found = pose_near(&robot, &inputs(&cables, &at(step)), &last);
            assert_is(found, &at(step));
            last = found.unwrap().pose;
            assert_eq!(found.unwrap().cable_count, count);
        }
    }
}

/// All pulleys in one plane, all attachments in another: turned over, the platform would hang above its pulleys.
#[test]
fn a_platform_hangs_below_its_pulleys() {
    let mut cables = corners(8);
    for (index, cable) in cables.iter_mut().enumerate() {
        cable.entry_m[2] = 2.0;
        cable.axis = [0.0, 0.0, -1.0];
        cable.entry_m[0] *= if index < 4 { 1.0 } else { 0.4 };
        cable.platform_m[2] = 0.0;
    }
    let mut random = Random::new(62);
    let params = params(&cables);
    for _ in 0..200 {
        let pose = somewhere(&mut random);
        let pose = Pose { position_m: pose.position_m + nalgebra::Vector3::new(0.0, 0.0, 1.0), ..pose };
        assert_is(pose_anywhere(&robot(&params), &inputs(&cables, &pose)), &pose);
    }
}

#[test]
fn a_length_that_is_off_stays_in_the_residual_and_moves_the_pose_little() {
    let cables = corners(8);
    let params = params(&cables);
    let robot = robot(&params);
    for wrong in 0..8 {
        let mut inputs = inputs(&cables, &Pose::identity());
        inputs[wrong].length_m += 0.01;
        for found in [pose_anywhere(&robot, &inputs), pose_near(&robot, &inputs, &Pose::identity())] {
            let found = found.unwrap();
            // What a pose takes up of 1 cm on one of eight cables is 1 cm·√6/8 at most on the average of all.
            assert!((0.001..0.0035).contains(&found.residual_rms_m), "{found:?}");
            let squares: f64 = cables
                .iter()
                .zip(&inputs)
                .map(|(cable, input)| (length_m(cable, &found.pose) - input.length_m).powi(2))
                .sum();
            assert!(((squares / 8.0).sqrt() - found.residual_rms_m).abs() < 1e-12, "{found:?}");
        }
    }
}

/// After a pause another pose of nearly these lengths may be the next one downhill.
#[test]
fn a_follower_finds_its_way_again() {
    let cables = corners(8);
    let params = params(&cables);
    let robot = robot(&params);
    let mut random = Random::new(63);
    let mut follower = PoseFollower::default();
    for _ in 0..300 {
        let pose = somewhere(&mut random);
        assert_is(follower.next_pose(&robot, &inputs(&cables, &pose)), &pose);
        if random.below(4) == 0 {
            let nothing = [CableInput { length_m: f64::NAN, ..CableInput::default() }; 8];
            assert_eq!(follower.next_pose(&robot, &nothing), Err(NoPose::TooFew { cable_count: 0 }));
        }
    }
    // Lengths that never fit are given up, and what fits again is found at the latest 256 samples later, from where it was.
    let zeroed = [CableInput { length_m: 0.0, ..CableInput::default() }; 8];
    for _ in 0..2000 {
        assert!(follower.next_pose(&robot, &zeroed).is_err());
    }
    let pose = somewhere(&mut random);
    let found = (0..256)
        .find_map(|_| follower.next_pose(&robot, &inputs(&cables, &pose)).ok().filter(|it| it.residual_rms_m < 1e-9));
    assert_is(found.ok_or(NoPose::NotConverged), &pose);
}

#[test]
fn what_is_no_pose_is_refused_with_the_reason() {
    let cables = corners(8);
    let params = params(&cables);
    let robot = robot(&params);
    let good = inputs(&cables, &Pose::identity());
    let with = |changes: &[(usize, f64)]| {
        let mut inputs = good.clone();
        for (cable, length_m) in changes {
            inputs[*cable].length_m = *length_m;
        }
        [pose_anywhere(&robot, &inputs), pose_near(&robot, &inputs, &Pose::identity())]
    };
    // Two of eight may lack; from nothing, the pose may be another of the same six lengths.
    let [anywhere, near] = with(&[(1, f64::NAN), (6, f64::INFINITY)]).map(Result::unwrap);
    assert_eq!((anywhere.cable_count, near.cable_count), (6, 6));
    assert!(anywhere.residual_rms_m < 1e-9 && distance(&near.pose, &Pose::identity()).0 < 1e-9);
    for found in with(&[(1, f64::NAN), (4, f64::NAN), (6, f64::NEG_INFINITY)]) {
        assert_eq!(found, Err(NoPose::TooFew { cable_count: 5 }));
    }
    // Lengths from a zero of the winch's own.
    let zeroed: Vec<(usize, f64)> = (0..8).map(|cable| (cable, 0.0)).collect();
    assert!(with(&zeroed).iter().all(Result::is_err));
    for found in with(&[(2, 3.0)]) {
        assert!(matches!(found, Err(NoPose::Apart { .. } | NoPose::NotConverged)), "{found:?}");
    }
    for value in [1e300, -1e300, f64::MAX] {
        for found in with(&[(0, value)]) {
            assert!(found.is_ok_and(|found| found.cable_count == 7), "a length of {value}");
        }
    }
    // A platform that is a point, or a rod, turns as it likes.
    for narrow in [[0.0; 3], [1.0, 0.0, 0.0]] {
        let mut cables = corners(8);
        for cable in &mut cables {
            cable.platform_m = std::array::from_fn(|part| cable.platform_m[part] * narrow[part]);
        }
        let params = crate::forward::params(&cables);
        let inputs = inputs(&cables, &Pose::identity());
        assert_eq!(pose_anywhere(&crate::forward::robot(&params), &inputs), Err(NoPose::Undetermined));
    }
    // No geometry, no cable.
    let bare = checked(&[CableOptions::new(&[GUIDE_90]); 8]);
    let of_bare = pose_anywhere(&crate::forward::robot(&bare), &good);
    assert_eq!(of_bare, Err(NoPose::TooFew { cable_count: 0 }));
}
