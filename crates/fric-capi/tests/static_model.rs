//! The static model: the core's bits, guards, faults.

use std::ffi::{CStr, CString, c_char};
use std::mem::MaybeUninit;
use std::ptr;

use fric::{
    DiskResult, DiskTensions, DriveLimits, FRIC_COMMAND_HELD, FRIC_COMMAND_MISSED, FRIC_COMMAND_NOT_USABLE,
    FRIC_COMMAND_OK, FRIC_COMMAND_OUT_OF_REACH, FRIC_FRICTION_HISTORY, FRIC_FRICTION_MEASURED, FRIC_FRICTION_NONE,
    FRIC_FRICTION_PULLING, FRIC_FRICTION_RELEASING, FRIC_GOAL_BEND, FRIC_GOAL_TIP, FRIC_SHAPE_NOT_FINITE,
    FRIC_SHAPE_OK, ModelCommand, ModelGoal, ModelHandle, Outcome, ShapeResult, ShapeSignals,
    fric_static_model_copy_state, fric_static_model_disk_count, fric_static_model_free, fric_static_model_load_file,
    fric_static_model_load_text, fric_static_model_name, fric_static_model_reset, fric_static_model_set_drive,
    fric_static_model_solve, fric_static_model_tension_for,
};
use fric_tendon::file::ManipulatorFile;
use fric_tendon::{
    Command, Direction, Drive, DriveOptions, Friction, Goal, ManipulatorParams, Shape, StaticModel, Tendon,
};

use crate::support::{ARM, DISKS, Model, command_for, goal, model, model_of, shape_input, shape_output, solve};

/// Tensions with a reversal. Arithmetic alone: Miri gives functions such as `sin` other bits each time.
fn base_tension_n(step: u32) -> [f64; 2] {
    let phase = f64::from(step % 12);
    [0.9 - 0.015 * (phase - 6.0) * (phase - 6.0), 0.05]
}

fn params() -> ManipulatorParams {
    *ManipulatorFile::parse(ARM, "here").unwrap().params()
}

fn assert_same(disks: &[DiskResult; DISKS], bend_rad: f64, shape: &Shape<DISKS>) {
    assert_eq!(bend_rad.to_bits(), shape.bend_rad().to_bits());
    for (place, disk) in disks.iter().enumerate() {
        let both = |list: fn(&Shape<DISKS>, Tendon) -> &[f64]| Tendon::BOTH.map(|tendon| list(shape, tendon)[place]);
        let expected = DiskResult {
            position_m: shape.disk_position_m()[place],
            bend_rad: shape.segment_bend_rad()[place],
            tension_n: both(|shape, tendon| shape.tension_n(tendon)),
            friction_n: both(|shape, tendon| shape.friction_n(tendon)),
            bound_n: both(|shape, tendon| shape.bound_n(tendon)),
        };
        let bits = |disk: &DiskResult| {
            let DiskResult { position_m, bend_rad, tension_n, friction_n, bound_n } = *disk;
            [position_m, [bend_rad; 2], tension_n, friction_n, bound_n].map(|both| both.map(f64::to_bits))
        };
        assert_eq!(bits(disk), bits(&expected), "disk {place}");
    }
}

#[test]
fn shapes_have_the_bits_of_the_core() {
    let params = params();
    let mut core = StaticModel::<DISKS>::new(&params).unwrap();
    let model = model();
    let lists_n: [Vec<f64>; 2] = [vec![0.7; DISKS], vec![0.0; DISKS]];
    let measured: Vec<DiskTensions> = vec![DiskTensions { tension_n: [0.7, 0.0] }; DISKS];
    let ways = [
        (FRIC_FRICTION_HISTORY, Friction::History),
        (FRIC_FRICTION_NONE, Friction::None),
        (FRIC_FRICTION_PULLING, Friction::Coulomb(Direction::Pulling)),
        (FRIC_FRICTION_RELEASING, Friction::Coulomb(Direction::Releasing)),
        (FRIC_FRICTION_MEASURED, Friction::Measured([&lists_n[0], &lists_n[1]])),
    ];
    for step in 0..if cfg!(miri) { 1 } else { 24 } {
        for (number, friction) in ways {
            let base_n = base_tension_n(step);
            let input = ShapeSignals {
                measured: measured.as_ptr(),
                measured_count: measured.len(),
                friction: number,
                ..shape_input(base_n)
            };
            let (disks, output) = solve(&model, &input);
            let status = core.solve(base_n, friction);
            assert_eq!((output.status, status.bits()), (FRIC_SHAPE_OK, FRIC_SHAPE_OK));
            assert_same(&disks, output.bend_rad, core.shape());
        }
    }
}

#[test]
fn commands_have_the_bits_of_the_core() {
    let params = params();
    let mut core = StaticModel::<DISKS>::new(&params).unwrap();
    let mut drive = Drive::new(&params, &DriveOptions::first_tendon(&params)).unwrap();
    let model = model();
    let mut flags = 0;
    for step in 0..if cfg!(miri) { 1 } else { 16 } {
        if step == 8 {
            let (least_tension_n, greatest_tension_n) = ([0.1, 0.1], [3.0, 2.0]);
            drive = Drive::new(&params, &DriveOptions { least_tension_n, greatest_tension_n, hold_rad: 0.0 }).unwrap();
            assert_eq!(set_drive(&model, least_tension_n, greatest_tension_n, 0.0), (Outcome::Ok, String::new()));
        }
        let bend_rad = 0.3 + 0.1 * f64::from(step % 5);
        let tip_m = [0.28 - 0.01 * f64::from(step % 3), 0.06];
        for (goal, wanted) in [
            (goal(bend_rad), Goal::BendRad(bend_rad)),
            (ModelGoal { tip_m, kind: FRIC_GOAL_TIP, ..goal(0.0) }, Goal::TipM(tip_m)),
            (ModelGoal { friction: FRIC_FRICTION_PULLING, ..goal(bend_rad) }, Goal::BendRad(bend_rad)),
        ] {
            let is_sliding = goal.friction == FRIC_FRICTION_PULLING;
            let friction = if is_sliding { Friction::Coulomb(Direction::Pulling) } else { Friction::History };
            let expected = core.tension_for(wanted, friction, &drive);
            assert_command(&command_for(&model, &goal), &expected);
            flags |= expected.status.bits();
        }
        let command = command_for(&model, &goal(bend_rad));
        let _ = core.solve(command.base_tension_n, Friction::History);
        let (disks, output) = solve(&model, &shape_input(command.base_tension_n));
        assert_same(&disks, output.bend_rad, core.shape());
    }
    assert!(flags != 0 || cfg!(miri), "no command had anything to say");
}

fn assert_command(command: &ModelCommand, expected: &Command) {
    let bits = |pair: [f64; 2]| pair.map(f64::to_bits);
    assert_eq!(bits(command.base_tension_n), bits(expected.base_tension_n));
    assert_eq!(command.bend_rad.to_bits(), expected.bend_rad.to_bits());
    assert_eq!((bits(command.tip_m), command.status), (bits(expected.tip_m), expected.status.bits()));
}

fn set_drive(
    model: &Model,
    least_tension_n: [f64; 2],
    greatest_tension_n: [f64; 2],
    hold_rad: f64,
) -> (Outcome, String) {
    let drive = DriveLimits { struct_size: size_of::<DriveLimits>(), least_tension_n, greatest_tension_n, hold_rad };
    let mut error = [c_char::MAX; 200];
    let outcome = unsafe { fric_static_model_set_drive(model.0, &raw const drive, error.as_mut_ptr(), error.len()) };
    (outcome, unsafe { CStr::from_ptr(error.as_ptr()) }.to_str().unwrap().to_owned())
}

#[test]
fn what_is_no_number_is_flagged_and_changes_nothing() {
    let (model, other) = (model(), model());
    let (before, output) = solve(&model, &shape_input([0.5, 0.0]));
    solve(&other, &shape_input([0.5, 0.0]));
    for value in [f64::NAN, f64::INFINITY, -0.1, 1e300] {
        let (disks, held) = solve(&model, &shape_input([value, 0.0]));
        assert_eq!((held.status, disks, held.bend_rad), (FRIC_SHAPE_NOT_FINITE, before, output.bend_rad));
        let tip = ModelGoal { tip_m: [value, f64::NAN], kind: FRIC_GOAL_TIP, ..goal(0.0) };
        let command = command_for(&model, &tip);
        assert_eq!((command.status, command.base_tension_n), (FRIC_COMMAND_NOT_USABLE, [0.5, 0.0]));
    }
    let measured = [DiskTensions { tension_n: [f64::NAN; 2] }; DISKS];
    let input = ShapeSignals {
        measured: measured.as_ptr(),
        measured_count: DISKS,
        friction: FRIC_FRICTION_MEASURED,
        ..shape_input([0.5, 0.0])
    };
    assert_eq!(solve(&model, &input).1.status, FRIC_SHAPE_NOT_FINITE);
    let unknown = ModelGoal { friction: FRIC_FRICTION_MEASURED, ..goal(0.2) };
    assert_eq!(command_for(&model, &unknown).status, FRIC_COMMAND_NOT_USABLE);
    assert_eq!(solve(&model, &shape_input([0.4, 0.0])).0, solve(&other, &shape_input([0.4, 0.0])).0);
}

#[test]
fn the_drive_limits_the_command() {
    let model = model();
    assert_eq!(command_for(&model, &goal(0.2)).status, FRIC_COMMAND_OK);
    assert_eq!(set_drive(&model, [0.0; 2], [0.3, 0.0], 0.01).0, Outcome::Ok);
    let command = command_for(&model, &goal(1.0));
    assert_eq!((command.status, command.base_tension_n), (FRIC_COMMAND_OUT_OF_REACH, [0.3, 0.0]));
    assert!(command.status & FRIC_COMMAND_MISSED != 0);
    solve(&model, &shape_input([0.2, 0.0]));
    let (_, shape) = solve(&model, &shape_input([0.2, 0.0]));
    let command = command_for(&model, &goal(shape.bend_rad + 0.005));
    assert_eq!((command.status & FRIC_COMMAND_HELD, command.base_tension_n), (FRIC_COMMAND_HELD, [0.2, 0.0]));
    let refused = |least_n: [f64; 2], greatest_n, hold_rad, words: &str| {
        let (outcome, text) = set_drive(&model, least_n, greatest_n, hold_rad);
        assert!(outcome == Outcome::BadValue && text.contains(words), "{outcome:?} {text}");
    };
    refused([0.0; 2], [5.0, 0.0], 0.0, "`greatest_tension_n` of the tendon is 5; allowed is 0 to 4");
    refused([0.0, f64::NAN], [1.0, 1.0], 0.0, "`least_tension_n` of the antagonist is NaN");
    refused([0.0; 2], [1.0, 0.0], 2.0, "`hold_rad` is 2; allowed is 0 to 1");
    // What was refused has left the drive as it was, and so does a reset.
    assert_eq!(unsafe { fric_static_model_reset(model.0) }, Outcome::Ok);
    assert_eq!(command_for(&model, &goal(1.0)).base_tension_n, [0.3, 0.0]);
}

#[test]
fn a_state_goes_to_another_model_and_back() {
    let (model, kept, fresh) = (model(), model(), model());
    for step in 0..if cfg!(miri) { 2 } else { 9 } {
        solve(&model, &shape_input(base_tension_n(step)));
    }
    let copy = |to: &Model, from: &Model| unsafe { fric_static_model_copy_state(to.0, from.0) };
    assert_eq!((copy(&kept, &model), copy(&model, &model)), (Outcome::Ok, Outcome::Ok));
    let expected = solve(&model, &shape_input([0.6, 0.0])).0;
    assert_eq!(solve(&kept, &shape_input([0.6, 0.0])).0, expected);
    assert_ne!(solve(&fresh, &shape_input([0.6, 0.0])).0, expected);
    assert_eq!(unsafe { fric_static_model_reset(kept.0) }, Outcome::Ok);
    assert_eq!(unsafe { fric_static_model_reset(fresh.0) }, Outcome::Ok);
    assert_eq!(solve(&kept, &shape_input([0.4, 0.0])).0, solve(&fresh, &shape_input([0.4, 0.0])).0);
    let shorter = model_of(&ARM.replace("disk_count = 3", "disk_count = 2")).unwrap();
    assert_eq!((copy(&shorter, &model), copy(&model, &shorter)), (Outcome::WrongSize, Outcome::WrongSize));
}

#[test]
fn a_wrong_pointer_size_or_choice_is_told_and_nothing_happens() {
    type Change = fn(&mut ShapeSignals, &mut ShapeResult);
    let changes: [(Change, Outcome); 12] = [
        (|input, _| input.struct_size = 0, Outcome::WrongSize),
        (|input, _| input.struct_size += 8, Outcome::WrongSize),
        (|_, output| output.struct_size -= 8, Outcome::WrongSize),
        (|_, output| output.disk_count -= 1, Outcome::WrongSize),
        (|_, output| output.disk_count = usize::MAX, Outcome::WrongSize),
        (|input, _| input.measured_count += 1, Outcome::WrongSize),
        (|input, _| input.measured_count = usize::MAX, Outcome::WrongSize),
        (|input, _| input.measured = ptr::null(), Outcome::BadPointer),
        (|input, _| input.measured = input.measured.wrapping_byte_add(1), Outcome::BadPointer),
        (|_, output| output.disks = ptr::null_mut(), Outcome::BadPointer),
        (|_, output| output.disks = output.disks.wrapping_byte_add(4), Outcome::BadPointer),
        (|input, _| input.friction = FRIC_FRICTION_MEASURED + 1, Outcome::BadValue),
    ];
    let (model, other) = (model(), model());
    let untouched = DiskResult { bend_rad: 7.0, ..DiskResult::default() };
    let measured = [DiskTensions { tension_n: [0.2, 0.0] }; DISKS];
    for (change, outcome) in changes {
        let mut disks = [untouched; DISKS];
        let mut input = ShapeSignals {
            measured: measured.as_ptr(),
            measured_count: DISKS,
            friction: FRIC_FRICTION_MEASURED,
            ..shape_input([0.3, 0.0])
        };
        let mut output = shape_output(&mut disks);
        change(&mut input, &mut output);
        assert_eq!(unsafe { fric_static_model_solve(model.0, &raw const input, &raw mut output) }, outcome);
        assert_eq!((disks, output.bend_rad), ([untouched; DISKS], 0.0));
    }
    let goals = [
        (ModelGoal { struct_size: 1, ..goal(0.1) }, Outcome::WrongSize),
        (ModelGoal { kind: FRIC_GOAL_TIP + 1, ..goal(0.1) }, Outcome::BadValue),
        (ModelGoal { friction: FRIC_FRICTION_MEASURED + 1, ..goal(0.1) }, Outcome::BadValue),
    ];
    let mut command = command_for(&other, &goal(0.1));
    let before = command.base_tension_n;
    for (goal, outcome) in goals {
        assert_eq!(unsafe { fric_static_model_tension_for(model.0, &raw const goal, &raw mut command) }, outcome);
    }
    let (goal, input) = (goal(0.1), shape_input([0.3, 0.0]));
    let mut disks = [untouched; DISKS];
    let mut output = shape_output(&mut disks);
    let (none, mut error) = (ptr::null_mut(), [0; 99]);
    unsafe {
        let command = &raw mut command;
        assert_eq!(fric_static_model_solve(none, &raw const input, &raw mut output), Outcome::BadPointer);
        assert_eq!(fric_static_model_solve(model.0, ptr::null(), &raw mut output), Outcome::BadPointer);
        assert_eq!(fric_static_model_solve(model.0, &raw const input, ptr::null_mut()), Outcome::BadPointer);
        assert_eq!(fric_static_model_tension_for(none, &raw const goal, command), Outcome::BadPointer);
        assert_eq!(fric_static_model_tension_for(model.0, ptr::null(), command), Outcome::BadPointer);
        assert_eq!(fric_static_model_tension_for(model.0, &raw const goal, ptr::null_mut()), Outcome::BadPointer);
        (*command).struct_size = 3;
        assert_eq!(fric_static_model_tension_for(model.0, &raw const goal, command), Outcome::WrongSize);
        let (buffer, size) = (error.as_mut_ptr(), error.len());
        assert_eq!(fric_static_model_set_drive(model.0, ptr::null(), buffer, size), Outcome::BadPointer);
        let drive =
            DriveLimits { struct_size: 8, least_tension_n: [0.0; 2], greatest_tension_n: [0.0; 2], hold_rad: 0.0 };
        assert_eq!(fric_static_model_set_drive(none, &raw const drive, ptr::null_mut(), 9), Outcome::BadPointer);
        assert_eq!(fric_static_model_set_drive(model.0, &raw const drive, buffer, size), Outcome::WrongSize);
        assert_eq!(fric_static_model_reset(none), Outcome::BadPointer);
        assert_eq!(fric_static_model_copy_state(none, model.0), Outcome::BadPointer);
        assert_eq!(fric_static_model_copy_state(model.0, none), Outcome::BadPointer);
        assert_eq!(fric_static_model_disk_count(none), 0);
        assert!(fric_static_model_name(none).is_null());
        fric_static_model_free(none);
    }
    assert_eq!(command.base_tension_n, before);
    assert_eq!(solve(&model, &input).0, solve(&other, &input).0);
}

#[test]
fn what_is_wrong_in_the_file_is_said_with_its_place() {
    let model = model();
    assert_eq!(unsafe { fric_static_model_disk_count(model.0) }, DISKS);
    assert_eq!(unsafe { CStr::from_ptr(fric_static_model_name(model.0)) }.to_str().unwrap(), "arm");
    let error = model_of(&ARM.replace("mu = 0.2", "mu = 1.5")).err();
    let text = "manipulator file, line 14: `mu` of the tendon at place 1 is 1.5; allowed is 0 to 0.9".to_owned();
    assert_eq!(error, Some((Outcome::RobotFile, text)));
    for (toml, words) in [("", "format"), (&ARM.replace("continuum", "robot"), "fric-continuum/1")] {
        let (outcome, text) = model_of(toml).err().unwrap();
        assert!(outcome == Outcome::RobotFile && text.contains(words) && !text.contains('\n'), "{text}");
    }
    let mut error: [c_char; 200] = [0; 200];
    let text = |error: &[c_char]| unsafe { CStr::from_ptr(error.as_ptr()) }.to_str().unwrap().to_owned();
    let (toml, mut handle) = (CString::new(ARM).unwrap(), ptr::dangling_mut::<ModelHandle>());
    unsafe {
        let (buffer, size) = (error.as_mut_ptr(), error.len());
        assert_eq!(fric_static_model_load_text(toml.as_ptr(), ptr::null_mut(), buffer, size), Outcome::BadPointer);
        assert!(text(&error).contains("`model`"));
        assert_eq!(fric_static_model_load_text(ptr::null(), &raw mut handle, buffer, size), Outcome::BadPointer);
        assert!(text(&error).contains("`toml`") && handle.is_null());
        assert_eq!(fric_static_model_load_file(ptr::null(), &raw mut handle, ptr::null_mut(), 7), Outcome::BadPointer);
    }
}

#[test]
#[cfg_attr(miri, ignore = "reads files")]
fn a_file_is_loaded_by_its_path() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/tendon-prototype.toml");
    let mut handle = ptr::null_mut();
    let load = |path: &str, handle, error: &mut [c_char]| {
        let path = CString::new(path).unwrap();
        unsafe { fric_static_model_load_file(path.as_ptr(), handle, error.as_mut_ptr(), error.len()) }
    };
    assert_eq!(load(path, &raw mut handle, &mut []), Outcome::Ok);
    assert_eq!(unsafe { fric_static_model_disk_count(handle) }, 8);
    unsafe { fric_static_model_free(handle) };
    let mut error = [0; 200];
    assert_eq!(load("/no/such/arm.toml", &raw mut handle, &mut error), Outcome::RobotFile);
    let sentence = unsafe { CStr::from_ptr(error.as_ptr()) }.to_str().unwrap();
    assert!(handle.is_null() && sentence.contains("/no/such/arm.toml"), "{sentence}");
}

#[test]
fn the_output_need_not_have_been_written_to_before() {
    let model = model();
    let input = shape_input([0.3, 0.0]);
    let (wanted, mut command) = (goal(0.2), MaybeUninit::<ModelCommand>::uninit());
    let mut disks = MaybeUninit::<[DiskResult; DISKS]>::uninit();
    let mut output = MaybeUninit::<ShapeResult>::uninit();
    let (disks, output, command) = unsafe {
        let target = output.as_mut_ptr();
        (&raw mut (*target).struct_size).write(size_of::<ShapeResult>());
        (&raw mut (*target).disks).write(disks.as_mut_ptr().cast());
        (&raw mut (*target).disk_count).write(DISKS);
        assert_eq!(fric_static_model_solve(model.0, &raw const input, target), Outcome::Ok);
        let target = command.as_mut_ptr();
        (&raw mut (*target).struct_size).write(size_of::<ModelCommand>());
        assert_eq!(fric_static_model_tension_for(model.0, &raw const wanted, target), Outcome::Ok);
        (disks.assume_init(), output.assume_init(), command.assume_init())
    };
    assert!(output.bend_rad > 0.0 && disks.iter().all(|disk| disk.tension_n[0] > 0.0));
    assert!(command.bend_rad > 0.0 && wanted.kind == FRIC_GOAL_BEND);
}
