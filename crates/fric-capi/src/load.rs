//! Set-up: creates a handle from a robot file.

use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use fric_core::robot::file::{RobotFile, RobotFileError};

use crate::handle::{Handle, Unfit};
use crate::outcome::Outcome;
use crate::text_buffer::TextBuffer;

/// Creates a compensator for the robot of a robot file (TOML, `format = "fric-robot/1"`).
///
/// `path` is UTF-8. On FRIC_RESULT_OK `*compensator` is the new compensator, else null. `error` receives one sentence that says what is wrong, where
/// and what is allowed, cut to `error_size` bytes including the final zero, and is empty without an error; it may be null with size 0. Not for the
/// cycle: it reads a file and allocates. The optimised library uses at most 1024 KiB of stack, 256 KiB for a robot of 16 cables or fewer; so do
/// fric_load_text, fric_change_file and fric_change_text.
///
/// # Safety
/// `path` is null or a zero-terminated string; `compensator` is null or writable; `error` is null or points to `error_size` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_load_file(
    path: *const c_char,
    compensator: *mut *mut Handle,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the caller of this function promises the same.
    let error = unsafe { TextBuffer::new(error, error_size) };
    // SAFETY: the caller of this function promises the same.
    let path = unsafe { text(path, "path") };
    let set_up = || compensator_of(RobotFile::read(Path::new(path?)));
    // SAFETY: the caller of this function promises the same.
    unsafe { load(set_up, compensator, "compensator", error) }
}

/// Does the same as fric_load_file with the text of a robot file, which has no path: errors name line and key.
///
/// # Safety
/// `toml` is null or a zero-terminated string; the rest as for fric_load_file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_load_text(
    toml: *const c_char,
    compensator: *mut *mut Handle,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the caller of this function promises the same.
    let error = unsafe { TextBuffer::new(error, error_size) };
    // SAFETY: the caller of this function promises the same.
    let toml = unsafe { text(toml, "toml") };
    let set_up = || compensator_of(RobotFile::parse(toml?, "robot file"));
    // SAFETY: the caller of this function promises the same.
    unsafe { load(set_up, compensator, "compensator", error) }
}

/// Returns a text of the caller.
///
/// # Safety
/// `pointer` is null or a zero-terminated string that does not change while the text is used.
pub(crate) unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str, (Outcome, String)> {
    if pointer.is_null() {
        return Err((Outcome::BadPointer, format!("`{name}` is a null pointer")));
    }
    // SAFETY: not null, so a string by the caller's promise.
    let bytes = unsafe { CStr::from_ptr(pointer) };
    bytes.to_str().map_err(|error| (Outcome::RobotFile, format!("`{name}` is not UTF-8: {error}")))
}

/// Returns a compensator for a robot file that was read, or a code and a text.
fn compensator_of(robot: Result<RobotFile, RobotFileError>) -> Result<Handle, (Outcome, String)> {
    let robot = robot.map_err(|error| (Outcome::RobotFile, error.to_string()))?;
    Handle::new(&robot).map_err(|unfit| match unfit {
        Unfit::Robot(error) => (Outcome::RobotFile, error.to_string()),
        Unfit::Name(error) => (Outcome::RobotFile, format!("`name` has a zero in it, which no C string can: {error}")),
    })
}

/// Passes out the created object, or a code and a text. `name` is the name of the caller's pointer.
///
/// # Safety
/// `handle` is null or writable.
pub(crate) unsafe fn load<T>(
    set_up: impl FnOnce() -> Result<T, (Outcome, String)>,
    handle: *mut *mut T,
    name: &str,
    error: TextBuffer,
) -> Outcome {
    error.write("");
    if handle.is_null() || !handle.is_aligned() {
        error.write(&format!("`{name}` is a null pointer or not aligned"));
        return Outcome::BadPointer;
    }
    let (outcome, made) = match guarded(set_up) {
        Ok(made) => (Outcome::Ok, Box::into_raw(Box::new(made))),
        Err((outcome, text)) => {
            error.write(&text);
            (outcome, std::ptr::null_mut())
        }
    };
    // SAFETY: neither null nor misaligned, so writable by the caller's promise.
    unsafe { handle.write(made) };
    outcome
}

/// Runs work that may fail, and converts a panic to a code.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, (Outcome, String)>) -> Result<T, (Outcome, String)> {
    // The data of a panic are not used again: they were on their way to the caller, or are behind a lock that reports it.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        Err((Outcome::Internal, "a mistake inside of fric; please report it with the file".to_owned()))
    })
}
