//! Set-up: a robot file becomes a handle.

use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use fric_core::robot::file::RobotFile;

use crate::error_text::ErrorText;
use crate::handle::{Handle, Unfit};
use crate::outcome::Outcome;

/// Makes a compensator for the robot of a robot file (TOML, `format = "fric-robot/1"`).
///
/// `path` is UTF-8. On FRIC_RESULT_OK `*compensator` is the new compensator, else null. `error` takes one sentence that
/// says what is wrong, where and what is allowed, cut to `error_size` bytes with the final zero, and is empty without
/// an error; it may be null with size 0. Not for the cycle: it reads a file and allocates. The optimised library takes
/// at most 1024 KiB of stack, 256 KiB for a robot of 16 cables or fewer; so do fric_load_text, fric_change_file and fric_change_text.
///
/// # Safety
/// `path` is null or a string that ends with zero; `compensator` is null or may be written to; `error` is null or
/// `error_size` bytes may be written to there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_load_file(
    path: *const c_char,
    compensator: *mut *mut Handle,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the same is promised here.
    let error = unsafe { ErrorText::new(error, error_size) };
    // SAFETY: the same is promised here.
    let path = unsafe { text(path, "path") };
    // SAFETY: the same is promised here.
    unsafe {
        load(path, |path| RobotFile::read(Path::new(path)).map_err(|error| error.to_string()), compensator, error)
    }
}

/// The same for the text of a robot file, which has no place of its own: errors name line and key.
///
/// # Safety
/// `toml` is null or a string that ends with zero; the rest as for fric_load_file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_load_text(
    toml: *const c_char,
    compensator: *mut *mut Handle,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the same is promised here.
    let error = unsafe { ErrorText::new(error, error_size) };
    // SAFETY: the same is promised here.
    let toml = unsafe { text(toml, "toml") };
    // SAFETY: the same is promised here.
    unsafe {
        load(toml, |toml| RobotFile::parse(toml, "robot file").map_err(|error| error.to_string()), compensator, error)
    }
}

/// A text of the caller's.
///
/// # Safety
/// `pointer` is null or a string that ends with zero and stays as it is while the text is used.
pub(crate) unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str, (Outcome, String)> {
    if pointer.is_null() {
        return Err((Outcome::BadPointer, format!("`{name}` is a null pointer")));
    }
    // SAFETY: not null, so a string by the caller's promise.
    let bytes = unsafe { CStr::from_ptr(pointer) };
    bytes.to_str().map_err(|error| (Outcome::RobotFile, format!("`{name}` is not UTF-8: {error}")))
}

/// Hands out a compensator, or a code and a text.
///
/// # Safety
/// `compensator` is null or may be written to.
unsafe fn load(
    source: Result<&str, (Outcome, String)>,
    read: impl FnOnce(&str) -> Result<RobotFile, String>,
    compensator: *mut *mut Handle,
    error: ErrorText,
) -> Outcome {
    error.write("");
    if compensator.is_null() || !compensator.is_aligned() {
        error.write("`compensator` is a null pointer or not aligned");
        return Outcome::BadPointer;
    }
    let set_up = || {
        let robot = read(source?).map_err(|text| (Outcome::RobotFile, text))?;
        Handle::new(&robot).map_err(|unfit| match unfit {
            Unfit::Robot(error) => (Outcome::RobotFile, error.to_string()),
            Unfit::Name(error) => {
                (Outcome::RobotFile, format!("`name` has a zero in it, which no C string can: {error}"))
            }
        })
    };
    let (outcome, handle) = match guarded(set_up) {
        Ok(handle) => (Outcome::Ok, Box::into_raw(Box::new(handle))),
        Err((outcome, text)) => {
            error.write(&text);
            (outcome, std::ptr::null_mut())
        }
    };
    // SAFETY: neither null nor misaligned, so it may be written to by the caller's promise.
    unsafe { compensator.write(handle) };
    outcome
}

/// A call that may fail, and in which a mistake of ours becomes a code.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, (Outcome, String)>) -> Result<T, (Outcome, String)> {
    // What a panic leaves behind is not looked at again: it was on its way to the caller, or is behind a lock that tells.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        Err((Outcome::Internal, "a mistake inside of fric; please report it with the robot file".to_owned()))
    })
}
