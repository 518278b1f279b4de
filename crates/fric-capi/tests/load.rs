//! Set-up: what is refused, and in which words.

use std::ffi::{CStr, CString, c_char};
use std::ptr;

use fric::{
    FRIC_ABI_VERSION, Outcome, fric_abi_version, fric_cable_count, fric_cable_name, fric_cycle_s, fric_free,
    fric_load_file, fric_load_text, fric_reset, fric_robot_name, fric_version,
};

use crate::support::{ROBOT, load, robot};

fn text(pointer: *const c_char) -> &'static str {
    unsafe { CStr::from_ptr(pointer) }.to_str().unwrap()
}

#[test]
fn a_handle_tells_of_its_robot() {
    let robot = robot();
    assert_eq!(unsafe { fric_cable_count(robot.0) }, 2);
    assert_eq!(unsafe { fric_cycle_s(robot.0) }.to_bits(), 0.001_f64.to_bits());
    assert_eq!(text(unsafe { fric_robot_name(robot.0) }), "rig");
    assert_eq!(text(unsafe { fric_cable_name(robot.0, 1) }), "right");
    assert!(unsafe { fric_cable_name(robot.0, 2) }.is_null());
    assert_eq!(text(fric_version()), env!("CARGO_PKG_VERSION"));
    assert_eq!(fric_abi_version(), FRIC_ABI_VERSION);
}

#[test]
fn what_is_wrong_in_the_file_is_said_with_its_place() {
    let error = load(&ROBOT.replace("mu = 0.03", "mu = 1.5")).err();
    let text = "robot file, line 18: cable \"right\": `mu` is 1.5; allowed is 0 to 0.9".to_owned();
    assert_eq!(error, Some((Outcome::RobotFile, text)));
    for (toml, word) in [("", "format"), ("ψ = [", "line"), (&ROBOT.replace("rig", "r\\u0000g"), "name")] {
        let (outcome, text) = load(toml).err().unwrap();
        assert_eq!(outcome, Outcome::RobotFile);
        assert!(text.contains(word) && !text.contains('\n'), "{text}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "reads files")]
fn a_file_is_loaded_by_its_path() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/mini-ipanema.toml");
    let mut handle = ptr::null_mut();
    let load = |path: &str, handle, error: &mut [c_char]| {
        let path = CString::new(path).unwrap();
        unsafe { fric_load_file(path.as_ptr(), handle, error.as_mut_ptr(), error.len()) }
    };
    assert_eq!(load(path, &raw mut handle, &mut []), Outcome::Ok);
    assert_eq!(unsafe { fric_cable_count(handle) }, 8);
    unsafe { fric_free(handle) };
    let mut error = [0; 200];
    assert_eq!(load("/no/such/file.toml", &raw mut handle, &mut error), Outcome::RobotFile);
    assert!(handle.is_null());
    let sentence = text(error.as_ptr());
    assert!(sentence.contains("/no/such/file.toml") && sentence.contains("No such file"), "{sentence}");
}

#[test]
fn the_error_text_is_cut_to_its_buffer_between_characters() {
    let toml = CString::new(ROBOT.replace("name = \"rig\"", "\"näme\" = \"rig\"")).unwrap();
    let full = load(toml.to_str().unwrap()).err().unwrap().1;
    assert!(full.contains("näme"), "{full}");
    // Miri is too slow for every size.
    let sizes = (0..full.len() + 3).filter(|size| !cfg!(miri) || [0, 1, full.len()].contains(size));
    for size in sizes {
        let mut error = vec![b'#'.cast_signed() as c_char; size + 1];
        let mut handle = ptr::null_mut();
        let outcome = unsafe { fric_load_text(toml.as_ptr(), &raw mut handle, error.as_mut_ptr(), size) };
        assert_eq!(outcome, Outcome::RobotFile);
        assert_eq!(error.pop(), Some(b'#'.cast_signed() as c_char), "written past the buffer");
        if size > 0 {
            let cut = text_of(&error);
            assert_eq!(cut, &full[..full.floor_char_boundary(size - 1)]);
        }
    }
}

fn text_of(buffer: &[c_char]) -> String {
    unsafe { CStr::from_ptr(buffer.as_ptr()) }.to_str().unwrap().to_owned()
}

#[test]
fn null_pointers_are_told_from_robots() {
    let toml = CString::new(ROBOT).unwrap();
    let mut error: [c_char; 100] = [0; 100];
    let mut handle = ptr::dangling_mut();
    unsafe {
        let (buffer, size) = (error.as_mut_ptr(), error.len());
        assert_eq!(fric_load_text(toml.as_ptr(), ptr::null_mut(), buffer, size), Outcome::BadPointer);
        assert!(text_of(&error).contains("`compensator`"));
        assert_eq!(fric_load_text(ptr::null(), &raw mut handle, buffer, size), Outcome::BadPointer);
        assert!(text_of(&error).contains("`toml`") && handle.is_null());
        assert_eq!(fric_load_file(ptr::null(), &raw mut handle, ptr::null_mut(), 7), Outcome::BadPointer);
        assert_eq!(fric_load_file(c"\xff".as_ptr(), &raw mut handle, buffer, size), Outcome::RobotFile);
        assert!(text_of(&error).contains("`path` is not UTF-8"));
        assert_eq!((fric_cable_count(ptr::null()), fric_cycle_s(ptr::null()).to_bits()), (0, 0));
        assert!(fric_robot_name(ptr::null()).is_null() && fric_cable_name(ptr::null(), 0).is_null());
        assert_eq!(fric_reset(ptr::null_mut()), Outcome::BadPointer);
        fric_free(ptr::null_mut());
    }
}
