//! What a call says, and of which version it is.

use std::ffi::{CStr, c_char};

use crate::abi::FRIC_ABI_VERSION;

/// Outcome of a call. Anything but FRIC_RESULT_OK has left the compensator or static model, and the output of a step, as they were.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Outcome {
    /// Done.
    Ok = 0,
    /// A pointer is null, or not aligned for what it points to.
    BadPointer = 1,
    /// `struct_size` is not that of this ABI version, `cable_count` not the robot's, or a number of disks not the manipulator's.
    WrongSize = 2,
    /// The robot or manipulator file cannot be read, or something in it is wrong; the error text says what, where and what is allowed.
    RobotFile = 3,
    /// The change of parameters given before is not over; try again some steps later.
    Busy = 4,
    /// A mistake inside of the library, caught; please report it.
    Internal = 5,
    /// A number that chooses is none of the header's, or one that limits is out of its range.
    BadValue = 6,
}

/// Version of the interface that this library has; FRIC_ABI_VERSION of the header that it goes with.
#[unsafe(no_mangle)]
pub extern "C" fn fric_abi_version() -> u32 {
    FRIC_ABI_VERSION
}

const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => c"",
};

/// Version of the library, "0.1.0"; the text lives as long as the program.
#[unsafe(no_mangle)]
pub extern "C" fn fric_version() -> *const c_char {
    VERSION.as_ptr()
}
