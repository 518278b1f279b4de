//! New parameters while another thread steps.

use std::ffi::c_char;
use std::path::Path;
use std::sync::PoisonError;

use fric_core::SendError;
use fric_core::robot::file::RobotFile;

use crate::error_text::ErrorText;
use crate::handle::{Handle, description};
use crate::load::{guarded, text};
use crate::outcome::Outcome;

/// Changes to the parameters of another robot file while a thread steps: without stopping it, without a lock in the step, and without a
/// jump in the output.
///
/// The steps after it take the parameters over: within `blend_s` seconds (0…3600; one cycle at least) the output goes over from
/// the old parameters to the new ones, and a step takes twice as long, the first up to six times. The file is that of the same robot: friction,
/// effects, wraps, geometry, masses and limits may differ; cycle time, the cables' names and order, how many pulleys each
/// has, which of them follow the pose, and which cables have an attachment may not. One change at a time:
/// FRIC_RESULT_BUSY until the first step after the blend of the change before. FRIC_RESULT_ROBOT_FILE also where the file is that
/// of another robot, or `blend_s` out of its range or NaN. `error` is as in fric_load_file. Not for the cycle: it reads a file
/// and allocates.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back and is not while this runs; `path` is null or a
/// string that ends with zero; `error` is null or `error_size` bytes may be written to there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_change_file(
    compensator: *const Handle,
    path: *const c_char,
    blend_s: f64,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the same is promised here.
    let error = unsafe { ErrorText::new(error, error_size) };
    // SAFETY: the same is promised here.
    let path = unsafe { text(path, "path") };
    // SAFETY: the same is promised here.
    unsafe {
        change(
            compensator,
            path,
            |path| RobotFile::read(Path::new(path)).map_err(|error| error.to_string()),
            blend_s,
            error,
        )
    }
}

/// The same with the text of a robot file.
///
/// # Safety
/// `toml` is null or a string that ends with zero; the rest as for fric_change_file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_change_text(
    compensator: *const Handle,
    toml: *const c_char,
    blend_s: f64,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the same is promised here.
    let error = unsafe { ErrorText::new(error, error_size) };
    // SAFETY: the same is promised here.
    let toml = unsafe { text(toml, "toml") };
    // SAFETY: the same is promised here.
    unsafe {
        change(
            compensator,
            toml,
            |toml| RobotFile::parse(toml, "robot file").map_err(|error| error.to_string()),
            blend_s,
            error,
        )
    }
}

/// Sends parameters, or gives a code and a text.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back and is not while this runs.
unsafe fn change(
    compensator: *const Handle,
    source: Result<&str, (Outcome, String)>,
    read: impl FnOnce(&str) -> Result<RobotFile, String>,
    blend_s: f64,
    error: ErrorText,
) -> Outcome {
    error.write("");
    // SAFETY: the same is promised here.
    let Some(description) = (unsafe { description(compensator) }) else {
        error.write("`compensator` is a null pointer or not aligned");
        return Outcome::BadPointer;
    };
    // SAFETY: a handle that lives; the step looks at other fields only, and no reference to those is made here.
    let parameters = unsafe { &(*compensator).parameters };
    let sent = guarded(|| {
        let robot = read(source?).map_err(|text| (Outcome::RobotFile, text))?;
        if !description.has_cables_of(&robot) {
            let names = robot.cable_names().join(", ");
            let text = format!("`name` of the cables, in order: {names}; they have to be those of the robot that runs");
            return Err((Outcome::RobotFile, text));
        }
        // After a panic the two rings are whole all the same.
        let mut sender = parameters.lock().unwrap_or_else(PoisonError::into_inner);
        sender.send(&robot.params(), blend_s).map_err(|refused| {
            let outcome = if refused == SendError::Busy { Outcome::Busy } else { Outcome::RobotFile };
            (outcome, refused.to_string())
        })
    });
    match sent {
        Ok(()) => Outcome::Ok,
        Err((outcome, text)) => {
            error.write(&text);
            outcome
        }
    }
}
