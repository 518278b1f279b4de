//! A robot, and the structures of a cycle around it.

use std::ffi::{CStr, CString, c_char};
use std::ptr;

use fric::{
    CableResult, CableSignals, CycleResult, CycleSignals, Handle, Outcome, PlatformPose, PlatformWrench, fric_free,
    fric_load_text, fric_step,
};

/// Two cables, one of which follows the pose.
pub const ROBOT: &str = r#"
format = "fric-robot/1"
name = "rig"
cycle_s = 0.001
[platform]
mass_kg = 0.5
[[cable]]
name = "left"
base_m = [0.5, 0.0, 0.5]
platform_m = [0.05, 0.0, 0.0]
pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap = "pose", radius_m = 0.01, axis = [0.0, 0.0, 1.0] }]
friction = { mu = 0.02, sigma_n_per_m = 1000.0 }
[[cable]]
name = "right"
base_m = [-0.5, 0.0, 0.5]
platform_m = [-0.05, 0.0, 0.0]
pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]
friction = { mu = 0.03, viscous_n_s_per_m = 0.2 }
"#;

pub const CABLES: usize = 2;

/// A compensator that is given back.
pub struct Owned(pub *mut Handle);

impl Drop for Owned {
    fn drop(&mut self) {
        unsafe { fric_free(self.0) };
    }
}

/// Loads a text; the outcome with its error text.
pub fn load(toml: &str) -> Result<Owned, (Outcome, String)> {
    let toml = CString::new(toml).unwrap();
    let mut handle = ptr::null_mut();
    let mut error = [c_char::MAX; 512];
    let outcome = unsafe { fric_load_text(toml.as_ptr(), &raw mut handle, error.as_mut_ptr(), error.len()) };
    let text = unsafe { CStr::from_ptr(error.as_ptr()) }.to_str().unwrap().to_owned();
    if outcome == Outcome::Ok {
        assert_eq!(text, "");
        return Ok(Owned(handle));
    }
    assert!(handle.is_null());
    Err((outcome, text))
}

/// The example robot.
pub fn robot() -> Owned {
    load(ROBOT).unwrap_or_else(|(outcome, text)| unreachable!("{outcome:?} {text}"))
}

pub const POSE: PlatformPose = PlatformPose { position_m: [0.0, 0.02, 0.1], orientation_xyzw: [0.0, 0.0, 0.0, 1.0] };

/// Signals that move to and fro, without a fault. Arithmetic alone: Miri gives functions such as `sin` other bits each time.
pub fn signals(cycle: u32) -> [CableSignals; CABLES] {
    let phase = f64::from(cycle % 80);
    [1.0, -1.0].map(|sign| CableSignals {
        sensor_force_n: 20.0 + sign + 1e-3 * f64::from(cycle),
        length_m: sign * 1e-5 * phase * (80.0 - phase),
        speed_m_per_s: sign * 1e-2 * (80.0 - 2.0 * phase),
    })
}

pub fn input(cables: &[CableSignals], pose: Option<&PlatformPose>) -> CycleSignals {
    CycleSignals {
        struct_size: size_of::<CycleSignals>(),
        cables: cables.as_ptr(),
        cable_count: cables.len(),
        pose: pose.map_or(ptr::null(), ptr::from_ref),
        elapsed_cycles: 1.0,
    }
}

pub fn output(cables: &mut [CableResult]) -> CycleResult {
    CycleResult {
        struct_size: size_of::<CycleResult>(),
        cables: cables.as_mut_ptr(),
        cable_count: cables.len(),
        outside_wrench: PlatformWrench::default(),
        applied_wrench: PlatformWrench::default(),
        has_wrench: false,
        wrench_status: 0,
    }
}

/// One cycle that has to work.
pub fn step(
    handle: &Owned,
    cables: &[CableSignals],
    pose: Option<&PlatformPose>,
) -> ([CableResult; CABLES], CycleResult) {
    let mut results = [CableResult::default(); CABLES];
    let mut output = output(&mut results);
    let input = input(cables, pose);
    let outcome = unsafe { fric_step(handle.0, &raw const input, &raw mut output) };
    assert_eq!(outcome, Outcome::Ok);
    (results, output)
}
