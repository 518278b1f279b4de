//! The result of a call, and the version.

use std::ffi::{CStr, c_char};

use crate::abi::FRIC_ABI_VERSION;

/// Result of a call. Anything but FRIC_RESULT_OK has left the compensator or static model, and the output of a step, unchanged.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Outcome {
    /// Success.
    Ok = 0,
    /// A pointer is null, or misaligned for its type.
    BadPointer = 1,
    /// `struct_size` is not that of this ABI version, `cable_count` is not the robot's, or a number of disks is not the manipulator's.
    WrongSize = 2,
    /// The robot or manipulator file cannot be read, or is invalid; the error text says what is wrong, where and what is allowed.
    RobotFile = 3,
    /// The previous change of parameters is not over; try again some steps later.
    Busy = 4,
    /// A bug inside the library was caught; please report it.
    Internal = 5,
    /// A `kind` or `friction` is none of this header's numbers for it, or a limit of the drives is out of its range.
    BadValue = 6,
}

/// Returns the version of this library's interface, FRIC_ABI_VERSION of the matching header.
#[unsafe(no_mangle)]
pub extern "C" fn fric_abi_version() -> u32 {
    FRIC_ABI_VERSION
}

const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => c"",
};

/// Returns the version of the library, "0.1.0"; the text is always valid.
#[unsafe(no_mangle)]
pub extern "C" fn fric_version() -> *const c_char {
    VERSION.as_ptr()
}
