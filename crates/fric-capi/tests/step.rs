//! The cycle: the core's bits, guards, faults.

use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::ptr;

use fric::{
    CableResult, CableSignals, CycleResult, CycleSignals, FRIC_STATUS_OK, FRIC_STATUS_POSE_MISSING,
    FRIC_STATUS_SENSOR_NOT_FINITE, FRIC_TEXT_SIZE, Outcome, PlatformPose, fric_reset, fric_status_text, fric_step,
};
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, CableStatus, Compensator, CycleInput, Pose};

use crate::support::{CABLES, POSE, ROBOT, input, output, robot, signals, step};

/// A text of a status in a buffer of `size` bytes, of which the next stays as it was; and the length that the function returns.
fn status_text(status: u32, size: usize) -> (String, usize) {
    let mut text = vec![b'#'.cast_signed() as c_char; size + 1];
    let length = unsafe { fric_status_text(status, text.as_mut_ptr(), size) };
    assert_eq!(text.pop(), Some(b'#'.cast_signed() as c_char), "written past the buffer");
    let text =
        if size == 0 { String::new() } else { unsafe { CStr::from_ptr(text.as_ptr()) }.to_str().unwrap().to_owned() };
    (text, length)
}

#[test]
fn a_status_has_a_text() {
    for (status, expected) in [(FRIC_STATUS_OK, "ok"), (5, "SLACK|SENSOR_NOT_FINITE"), (1 << 31 | 1024, "UNSETTLED")] {
        assert_eq!(status_text(status, FRIC_TEXT_SIZE), (expected.to_owned(), expected.len()));
        for size in 0..=expected.len() {
            assert_eq!(status_text(status, size), (expected[..size.saturating_sub(1)].to_owned(), expected.len()));
        }
    }
    let (all, length) = status_text(u32::MAX, FRIC_TEXT_SIZE);
    assert!(all.len() == length && all.matches('|').count() + 1 == CableStatus::NAMES.len(), "{all}");
    assert_eq!(unsafe { fric_status_text(u32::MAX, ptr::null_mut(), 9) }, length);
}

#[test]
fn a_cycle_has_the_bits_of_the_core() {
    let file = RobotFile::parse(ROBOT, "here").unwrap();
    let mut core = Compensator::<CABLES>::new(&file.params()).unwrap();
    let handle = robot();
    for cycle in 0..if cfg!(miri) { 9 } else { 60 } {
        let pose = PlatformPose { position_m: [0.0, 1e-4 * f64::from(cycle), 0.1], ..POSE };
        let pose = (cycle % 7 != 0).then_some(pose);
        let cables = signals(cycle);
        let (results, output) = step(&handle, &cables, pose.as_ref());
        let expected = core.step(&CycleInput {
            cables: cables.map(|cable| CableInput {
                sensor_force_n: cable.sensor_force_n,
                length_m: cable.length_m,
                speed_m_per_s: cable.speed_m_per_s,
            }),
            pose: pose.and_then(|pose| Pose::from_parts(pose.position_m, pose.orientation_xyzw)),
            ..CycleInput::default()
        });
        for (result, expected) in results.iter().zip(&expected.cables) {
            assert_eq!(result.force_at_platform_n.to_bits(), expected.force_at_platform_n.to_bits());
            assert_eq!(result.friction_n.to_bits(), expected.friction_n.to_bits());
            assert_eq!(result.frictionless_n.to_bits(), expected.frictionless_n.to_bits());
            assert_eq!(result.status, expected.status.bits());
        }
        assert_eq!(output.has_wrench, expected.outside_wrench.is_some());
        assert_eq!(output.wrench_status, expected.wrench_status.bits());
        let wrenches =
            [(output.outside_wrench, expected.outside_wrench), (output.applied_wrench, expected.applied_wrench)];
        for (wrench, expected) in wrenches {
            let expected = expected.unwrap_or_default();
            assert_eq!(wrench.force_n.map(f64::to_bits), <[f64; 3]>::from(expected.force_n).map(f64::to_bits));
            assert_eq!(wrench.torque_nm.map(f64::to_bits), <[f64; 3]>::from(expected.torque_nm).map(f64::to_bits));
        }
    }
}

#[test]
fn what_is_no_number_is_flagged_and_stays_with_its_cable() {
    let (handle, other) = (robot(), robot());
    step(&handle, &signals(0), Some(&POSE));
    step(&other, &signals(0), Some(&POSE));
    for value in [f64::NAN, f64::INFINITY, -1e300] {
        let mut faulty = signals(1);
        faulty[0].sensor_force_n = value;
        let (results, output) = step(&handle, &faulty, Some(&POSE));
        let (expected, _) = step(&other, &signals(1), Some(&POSE));
        assert_eq!(results[0].status, FRIC_STATUS_SENSOR_NOT_FINITE);
        assert!(
            results[0].force_at_platform_n.is_finite() && output.outside_wrench.force_n.iter().all(|n| n.is_finite())
        );
        assert_eq!(results[1], expected[1]);
    }
    let nowhere = PlatformPose { orientation_xyzw: [0.0; 4], ..POSE };
    for pose in [None, Some(&nowhere), Some(&PlatformPose { position_m: [f64::NAN; 3], ..POSE })] {
        let (results, output) = step(&handle, &signals(2), pose);
        assert_eq!((results[0].status, output.wrench_status), (FRIC_STATUS_POSE_MISSING, FRIC_STATUS_POSE_MISSING));
        assert!(output.has_wrench);
    }
    assert_eq!(step(&handle, &signals(3), Some(&POSE)).0.map(|result| result.status), [FRIC_STATUS_OK; CABLES]);
}

#[test]
fn after_a_reset_it_is_as_new() {
    let (handle, fresh) = (robot(), robot());
    for cycle in 0..if cfg!(miri) { 2 } else { 20 } {
        step(&handle, &signals(cycle), Some(&POSE));
    }
    assert_eq!(unsafe { fric_reset(handle.0) }, Outcome::Ok);
    for cycle in 0..5 {
        let [(results, output), (expected, _)] =
            [&handle, &fresh].map(|handle| step(handle, &signals(cycle + 30), None));
        assert_eq!(results, expected);
        assert!(!output.has_wrench);
    }
}

#[test]
fn a_wrong_pointer_or_size_is_told_and_nothing_happens() {
    type Change = fn(&mut CycleSignals, &mut CycleResult);
    let changes: [(Change, Outcome); 13] = [
        (|input, _| input.struct_size = 0, Outcome::WrongSize),
        (|input, _| input.struct_size -= 8, Outcome::WrongSize),
        (|input, _| input.struct_size += 8, Outcome::WrongSize),
        (|_, output| output.struct_size -= 8, Outcome::WrongSize),
        (|_, output| output.struct_size = usize::MAX, Outcome::WrongSize),
        (|input, _| input.cable_count = 1, Outcome::WrongSize),
        (|input, _| input.cable_count = usize::MAX, Outcome::WrongSize),
        (|_, output| output.cable_count = 3, Outcome::WrongSize),
        (|input, _| input.cables = ptr::null(), Outcome::BadPointer),
        (|_, output| output.cables = ptr::null_mut(), Outcome::BadPointer),
        (|input, _| input.cables = input.cables.wrapping_byte_add(1), Outcome::BadPointer),
        (|_, output| output.cables = output.cables.wrapping_byte_add(4), Outcome::BadPointer),
        (|input, _| input.pose = input.pose.wrapping_byte_add(1), Outcome::BadPointer),
    ];
    let (handle, other) = (robot(), robot());
    step(&handle, &signals(0), Some(&POSE));
    step(&other, &signals(0), Some(&POSE));
    let cables = signals(1);
    let untouched = CableResult { force_at_platform_n: 7.0, status: 99, ..CableResult::default() };
    for (change, outcome) in changes {
        let mut results = [untouched; CABLES];
        let (mut input, mut output) = (input(&cables, Some(&POSE)), output(&mut results));
        change(&mut input, &mut output);
        assert_eq!(unsafe { fric_step(handle.0, &raw const input, &raw mut output) }, outcome);
        assert_eq!(results, [untouched; CABLES]);
    }
    let (input, mut results) = (input(&cables, None), [untouched; CABLES]);
    let mut output = output(&mut results);
    unsafe {
        assert_eq!(fric_step(ptr::null_mut(), &raw const input, &raw mut output), Outcome::BadPointer);
        assert_eq!(fric_step(handle.0, ptr::null(), &raw mut output), Outcome::BadPointer);
        assert_eq!(fric_step(handle.0, &raw const input, ptr::null_mut()), Outcome::BadPointer);
    }
    assert_eq!(step(&handle, &cables, Some(&POSE)).0, step(&other, &cables, Some(&POSE)).0);
}

#[test]
fn the_output_need_not_have_been_written_to_before() {
    let handle = robot();
    let cables: [CableSignals; CABLES] = signals(0);
    let mut results = MaybeUninit::<[CableResult; CABLES]>::uninit();
    let mut output = MaybeUninit::<CycleResult>::uninit();
    let input = input(&cables, None);
    let (results, output) = unsafe {
        let target = output.as_mut_ptr();
        (&raw mut (*target).struct_size).write(size_of::<CycleResult>());
        (&raw mut (*target).cables).write(results.as_mut_ptr().cast());
        (&raw mut (*target).cable_count).write(CABLES);
        assert_eq!(fric_step(handle.0, &raw const input, target), Outcome::Ok);
        (results.assume_init(), output.assume_init())
    };
    assert!(!output.has_wrench && results.iter().all(|result| result.force_at_platform_n > 0.0));
}
