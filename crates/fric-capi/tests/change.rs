//! New parameters from one thread while another steps.

use std::ffi::{CStr, CString, c_char};
use std::ptr;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;

use fric::{CableResult, CableSignals, Handle, Outcome, fric_change_file, fric_change_text, fric_reset};

use crate::support::{CABLES, POSE, ROBOT, load, robot, signals, step};

/// The example robot with more friction, and an offset that would be a jump of 0.5 N.
fn rougher() -> String {
    ROBOT.replace("mu = 0.02", "mu = 0.05, offset_n = 0.5")
}

/// Paying out so slowly that no force changes by more than 0.02 N a cycle.
fn creep(cycle: u32) -> [CableSignals; CABLES] {
    let length_m = 1e-5 * f64::from(cycle);
    [CableSignals { sensor_force_n: 20.0 + 1e-3 * f64::from(cycle % 3), length_m, speed_m_per_s: 0.01 }; CABLES]
}

fn change(handle: *const Handle, toml: &str, blend_s: f64) -> (Outcome, String) {
    let toml = CString::new(toml).unwrap();
    let mut error = [c_char::MAX; 512];
    let outcome = unsafe { fric_change_text(handle, toml.as_ptr(), blend_s, error.as_mut_ptr(), error.len()) };
    (outcome, unsafe { CStr::from_ptr(error.as_ptr()) }.to_str().unwrap().to_owned())
}

/// A pointer that may go to another thread, as C lets it.
#[derive(Clone, Copy)]
struct Shared(*const Handle);
unsafe impl Send for Shared {}

impl Shared {
    fn change(self, toml: &str, blend_s: f64) -> (Outcome, String) {
        change(self.0, toml, blend_s)
    }
}

#[test]
fn another_thread_changes_parameters_while_this_one_steps() {
    let handle = robot();
    let (shared, done) = (Shared(handle.0), &AtomicU32::new(0));
    let mut cycle = 1;
    let mut greatest_n: f64 = 0.0;
    step(&handle, &creep(0), Some(&POSE));
    let mut last = step(&handle, &creep(1), Some(&POSE)).0;
    thread::scope(|scope| {
        scope.spawn(move || {
            assert_eq!(shared.change(&rougher(), 0.02), (Outcome::Ok, String::new()));
            done.store(1, Ordering::Release);
        });
        // Some cycles after the change has been given its blend of 20 is over.
        let mut left = 30;
        while left > 0 {
            left -= done.load(Ordering::Acquire);
            cycle += 1;
            let results = step(&handle, &creep(cycle), Some(&POSE)).0;
            for (now, last) in results.iter().zip(&last) {
                greatest_n = greatest_n.max((now.force_at_platform_n - last.force_at_platform_n).abs());
            }
            last = results;
        }
    });
    assert!(greatest_n < 0.06, "a step of {greatest_n} N");
    let built = load(&rougher()).unwrap_or_else(|(_, text)| unreachable!("{text}"));
    for cycle in cycle + 1..cycle + 200 {
        let (ours, theirs) =
            (step(&handle, &signals(cycle), Some(&POSE)).0, step(&built, &signals(cycle), Some(&POSE)).0);
        last = core::array::from_fn(|cable| CableResult {
            force_at_platform_n: ours[cable].force_at_platform_n - theirs[cable].force_at_platform_n,
            ..ours[cable]
        });
    }
    assert!(last.iter().all(|gap| gap.force_at_platform_n.abs() < 1e-6), "{last:?}");
}

#[test]
fn with_a_reset_the_parameters_given_hold_at_once() {
    for steps_before in 0..3 {
        let handle = robot();
        let built = load(&rougher()).unwrap_or_else(|(_, text)| unreachable!("{text}"));
        assert_eq!(change(handle.0, &rougher(), 1.0).0, Outcome::Ok);
        for cycle in 0..steps_before {
            step(&handle, &signals(cycle), Some(&POSE));
        }
        assert_eq!(unsafe { fric_reset(handle.0) }, Outcome::Ok);
        for cycle in 0..3 {
            let [(results, _), (expected, _)] =
                [&handle, &built].map(|handle| step(handle, &signals(cycle), Some(&POSE)));
            assert_eq!(results, expected, "{steps_before} steps before, cycle {cycle}");
        }
        assert_eq!(change(handle.0, ROBOT, 1.0).0, Outcome::Ok);
    }
}

#[test]
fn what_is_refused_is_told() {
    let handle = robot();
    let is_refused = |toml: &str, blend_s, expected: Outcome, word: &str| {
        let (outcome, text) = change(handle.0, toml, blend_s);
        assert!(outcome == expected && text.contains(word), "{outcome:?} {text}");
    };
    is_refused(&ROBOT.replace("mu = 0.02", "mu = 2.0"), 0.1, Outcome::RobotFile, "`mu` is 2; allowed is 0 to 0.9");
    is_refused(
        &ROBOT.replace("cycle_s = 0.001", "cycle_s = 0.002"),
        0.1,
        Outcome::RobotFile,
        "`cycle_s` is 0.002; in the robot that runs it is 0.001",
    );
    let [first, second] = ["name = \"left\"", "name = \"right\""];
    let swapped = ROBOT.replace(first, "name = \"\"").replace(second, first).replace("name = \"\"", second);
    is_refused(&swapped, 0.1, Outcome::RobotFile, "they have to be those of the robot that runs");
    is_refused(ROBOT, f64::NAN, Outcome::RobotFile, "`blend_s` is NaN");
    assert_eq!(change(handle.0, &rougher(), 0.003).0, Outcome::Ok);
    for cycle in 0..=3 {
        is_refused(ROBOT, 0.1, Outcome::Busy, "is not over");
        step(&handle, &signals(cycle), None);
    }
    assert_eq!(change(handle.0, ROBOT, 0.003).0, Outcome::Ok);
    assert_eq!(change(ptr::null(), ROBOT, 0.1).0, Outcome::BadPointer);
    unsafe {
        assert_eq!(fric_change_text(handle.0, ptr::null(), 0.1, ptr::null_mut(), 0), Outcome::BadPointer);
        assert_eq!(fric_change_file(handle.0, ptr::null(), 0.1, ptr::null_mut(), 9), Outcome::BadPointer);
    }
}
