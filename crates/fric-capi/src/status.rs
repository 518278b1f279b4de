//! The flags of a cable's status, equal to those of [`CableStatus`].

use std::ffi::c_char;

use fric_core::CableStatus;

use crate::text_buffer::TextBuffer;

/// Bytes that hold every text of fric_status_text, including the final zero.
pub const FRIC_TEXT_SIZE: usize = 256;

/// No fault.
pub const FRIC_STATUS_OK: u32 = 0;
/// The cable carries no tension.
pub const FRIC_STATUS_SLACK: u32 = 1;
/// The cable slips on a pulley.
pub const FRIC_STATUS_SLIP: u32 = 2;
/// The sensor force is NaN, infinite or beyond 1e9 N: the last valid force and friction are held.
pub const FRIC_STATUS_SENSOR_NOT_FINITE: u32 = 4;
/// The sensor repeats its value to the last bit for `frozen_cycles` of the robot file, in which the cable has moved by 1 mm or more: the last valid
/// force and friction are held. A quiet sensor with coarse steps needs more cycles there, or 0, which switches the check off.
pub const FRIC_STATUS_SENSOR_FROZEN: u32 = 8;
/// The length changed by more than `length_jump_m` of the robot file per elapsed cycle: the friction is held.
pub const FRIC_STATUS_LENGTH_JUMP: u32 = 16;
/// Length or speed is NaN, infinite or beyond 1e6: the friction is held.
pub const FRIC_STATUS_MOTION_NOT_FINITE: u32 = 32;
/// The signals are outside the range in which the parameters were identified; computed as usual.
pub const FRIC_STATUS_OUT_OF_RANGE: u32 = 64;
/// There is no usable pose for a cable that needs it: last wrap and direction are held.
pub const FRIC_STATUS_POSE_MISSING: u32 = 128;
/// The pose leaves the cable no way out of its last pulley: last wrap and direction are held.
pub const FRIC_STATUS_POSE_UNREACHABLE: u32 = 256;
/// The sensor force has jumped by more than the cable can change it, and has not yet returned; computed as usual.
pub const FRIC_STATUS_SENSOR_JUMP: u32 = 512;
/// The stored friction exceeds what the load allows by more than 25 % of the tension + 0.1 N, or a jump of the sensor may have left an error of 5 % +
/// 0.1 N.
pub const FRIC_STATUS_UNSETTLED: u32 = 1024;

/// The flags in the order of [`CableStatus::NAMES`].
const FLAGS: [u32; 11] = [
    FRIC_STATUS_SLACK,
    FRIC_STATUS_SLIP,
    FRIC_STATUS_SENSOR_NOT_FINITE,
    FRIC_STATUS_SENSOR_FROZEN,
    FRIC_STATUS_LENGTH_JUMP,
    FRIC_STATUS_MOTION_NOT_FINITE,
    FRIC_STATUS_OUT_OF_RANGE,
    FRIC_STATUS_POSE_MISSING,
    FRIC_STATUS_POSE_UNREACHABLE,
    FRIC_STATUS_SENSOR_JUMP,
    FRIC_STATUS_UNSETTLED,
];

/// Writes the names of the flags in the status of a cable or a wrench, such as "SLACK|SENSOR_JUMP": those of FRIC_STATUS_…, lowest bit first, or "ok"
/// for FRIC_STATUS_OK. Bits that are no flag are left out.
///
/// `text` receives the text, cut to `text_size` bytes including the final zero; FRIC_TEXT_SIZE bytes suffice. It may be null with size 0.
/// Returns the length of the whole text without the final zero, as snprintf does. It may run inside the control loop: it does not allocate, lock or
/// wait.
///
/// # Safety
/// `text` is null or points to `text_size` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_status_text(status: u32, text: *mut c_char, text_size: usize) -> usize {
    // SAFETY: the caller of this function promises the same.
    let text = unsafe { TextBuffer::new(text, text_size) };
    text.show(CableStatus::from_bits(status))
}

// cbindgen accepts numbers only, so their equality with the core's is checked here.
const _: () = {
    let mut place = 0;
    while place < FLAGS.len() {
        assert!(FLAGS[place] == CableStatus::NAMES[place].1.bits());
        place += 1;
    }
};
