//! Changes parameters while another thread steps.

use std::ffi::c_char;
use std::path::Path;
use std::sync::PoisonError;

use fric_core::SendError;
use fric_core::robot::file::RobotFile;

use crate::handle::{Handle, description};
use crate::load::{guarded, text};
use crate::outcome::Outcome;
use crate::text_buffer::TextBuffer;

/// Changes a compensator to the parameters of another robot file while a thread steps it: without stopping that thread, without a lock in the step,
/// and without a jump in the output.
///
/// The following steps take the parameters over: within `blend_s` seconds (0…3600; at least one cycle) the output blends from the old parameters to
/// the new ones, and a step takes twice as long, the first up to six times. Skipped cycles (`elapsed_cycles`) count in that time. The file must be
/// that of the same robot: friction, effects, wraps, geometry, masses and limits may differ; cycle time, the cables' names and order, their numbers of
/// pulleys, which pulleys follow the pose, and which cables have an attachment may not. One change at a time: FRIC_RESULT_BUSY until the first step after the blend of the previous change.
/// FRIC_RESULT_ROBOT_FILE also if the file is that of another robot, or `blend_s` is NaN or out of its range. `error` is as in fric_load_file. Not
/// for the cycle: it reads a file and allocates.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed and is not freed during the call; `path` is null or a zero-terminated string;
/// `error` is null or points to `error_size` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_change_file(
    compensator: *const Handle,
    path: *const c_char,
    blend_s: f64,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the caller of this function promises the same.
    let error = unsafe { TextBuffer::new(error, error_size) };
    // SAFETY: the caller of this function promises the same.
    let path = unsafe { text(path, "path") };
    // SAFETY: the caller of this function promises the same.
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

/// Does the same as fric_change_file with the text of a robot file.
///
/// # Safety
/// `toml` is null or a zero-terminated string; the rest as for fric_change_file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_change_text(
    compensator: *const Handle,
    toml: *const c_char,
    blend_s: f64,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the caller of this function promises the same.
    let error = unsafe { TextBuffer::new(error, error_size) };
    // SAFETY: the caller of this function promises the same.
    let toml = unsafe { text(toml, "toml") };
    // SAFETY: the caller of this function promises the same.
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

/// Sends parameters, or returns a code and a text.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed and is not freed during the call.
unsafe fn change(
    compensator: *const Handle,
    source: Result<&str, (Outcome, String)>,
    read: impl FnOnce(&str) -> Result<RobotFile, String>,
    blend_s: f64,
    error: TextBuffer,
) -> Outcome {
    error.write("");
    // SAFETY: the caller of this function promises the same.
    let Some(description) = (unsafe { description(compensator) }) else {
        error.write("`compensator` is a null pointer or not aligned");
        return Outcome::BadPointer;
    };
    // SAFETY: a live handle; the step uses other fields only, and no reference to those is made here.
    let parameters = unsafe { &(*compensator).parameters };
    let sent = guarded(|| {
        let robot = read(source?).map_err(|text| (Outcome::RobotFile, text))?;
        if !description.has_cables_of(&robot) {
            let names = robot.cable_names().join(", ");
            let text = format!("`name` of the cables, in order: {names}; they have to be those of the robot that runs");
            return Err((Outcome::RobotFile, text));
        }
        // The two rings are consistent even after a panic.
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
