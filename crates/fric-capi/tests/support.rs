//! A robot and the structures of a cycle around it; a manipulator and those of its static model.

use std::ffi::{CStr, CString, c_char};
use std::ptr;

use fric::{
    CableResult, CableSignals, CycleResult, CycleSignals, DiskResult, FRIC_FRICTION_HISTORY, FRIC_GOAL_BEND, Handle,
    ModelCommand, ModelGoal, ModelHandle, Outcome, PlatformPose, PlatformWrench, ShapeResult, ShapeSignals, fric_free,
    fric_load_text, fric_static_model_free, fric_static_model_load_text, fric_static_model_solve,
    fric_static_model_tension_for, fric_step,
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

/// An arm of a few disks, so that Miri can interpret its solution.
pub const ARM: &str = r#"
format = "fric-continuum/1"
name = "arm"
disk_count = 3
pitch_m = 0.1
disk_thickness_m = 0.002
hole_radius_m = 0.015
[backbone]
width_m = 0.006
thickness_m = 0.0003
youngs_modulus_pa = 200e9
mass_kg_per_m = 0.014
[tendon]
mu = 0.2
sigma_n_per_m = 20000.0
axial_stiffness_n = 13700.0
capacity_n = 4.0
"#;

pub const DISKS: usize = 3;

/// A static model that is given back.
pub struct Model(pub *mut ModelHandle);

impl Drop for Model {
    fn drop(&mut self) {
        unsafe { fric_static_model_free(self.0) };
    }
}

/// Loads a text; the outcome with its error text.
pub fn model_of(toml: &str) -> Result<Model, (Outcome, String)> {
    let toml = CString::new(toml).unwrap();
    let mut handle = ptr::null_mut();
    let mut error = [c_char::MAX; 512];
    let outcome =
        unsafe { fric_static_model_load_text(toml.as_ptr(), &raw mut handle, error.as_mut_ptr(), error.len()) };
    let text = unsafe { CStr::from_ptr(error.as_ptr()) }.to_str().unwrap().to_owned();
    if outcome == Outcome::Ok {
        assert_eq!(text, "");
        return Ok(Model(handle));
    }
    assert!(handle.is_null());
    Err((outcome, text))
}

/// The arm.
pub fn model() -> Model {
    model_of(ARM).unwrap_or_else(|(outcome, text)| unreachable!("{outcome:?} {text}"))
}

/// Tensions at the base with the friction of the history.
pub fn shape_input(base_tension_n: [f64; 2]) -> ShapeSignals {
    ShapeSignals {
        struct_size: size_of::<ShapeSignals>(),
        base_tension_n,
        measured: ptr::null(),
        measured_count: 0,
        friction: FRIC_FRICTION_HISTORY,
    }
}

pub fn shape_output(disks: &mut [DiskResult]) -> ShapeResult {
    let (disk_count, disks) = (disks.len(), disks.as_mut_ptr());
    ShapeResult { struct_size: size_of::<ShapeResult>(), disks, disk_count, bend_rad: 0.0, status: 0 }
}

/// One solution that has to work.
pub fn solve(model: &Model, input: &ShapeSignals) -> ([DiskResult; DISKS], ShapeResult) {
    let mut disks = [DiskResult::default(); DISKS];
    let mut output = shape_output(&mut disks);
    let outcome = unsafe { fric_static_model_solve(model.0, ptr::from_ref(input), &raw mut output) };
    assert_eq!(outcome, Outcome::Ok);
    (disks, output)
}

/// A bend that is wanted, from what the holes remember.
pub fn goal(bend_rad: f64) -> ModelGoal {
    ModelGoal {
        struct_size: size_of::<ModelGoal>(),
        bend_rad,
        tip_m: [0.0; 2],
        kind: FRIC_GOAL_BEND,
        friction: FRIC_FRICTION_HISTORY,
    }
}

/// The command for a goal; has to work.
pub fn command_for(model: &Model, goal: &ModelGoal) -> ModelCommand {
    let mut command = ModelCommand {
        struct_size: size_of::<ModelCommand>(),
        base_tension_n: [0.0; 2],
        bend_rad: 0.0,
        tip_m: [0.0; 2],
        status: 0,
    };
    let outcome = unsafe { fric_static_model_tension_for(model.0, ptr::from_ref(goal), &raw mut command) };
    assert_eq!(outcome, Outcome::Ok);
    command
}
