//! The flags of a cable's status, equal to those of [`CableStatus`].

use fric_core::CableStatus;

/// No fault.
pub const FRIC_STATUS_OK: u32 = 0;
/// The cable carries no tension.
pub const FRIC_STATUS_SLACK: u32 = 1;
/// The cable slips on a pulley.
pub const FRIC_STATUS_SLIP: u32 = 2;
/// The sensor force is NaN, infinite or beyond 1e9 N: the last valid force and friction are held.
pub const FRIC_STATUS_SENSOR_NOT_FINITE: u32 = 4;
/// The sensor is bit-identical while the cable moves: the last valid force and friction are held.
pub const FRIC_STATUS_SENSOR_FROZEN: u32 = 8;
/// The length changed by more than `length_jump_m` of the robot file: the friction is held.
pub const FRIC_STATUS_LENGTH_JUMP: u32 = 16;
/// Length or speed is NaN, infinite or beyond 1e6: the friction is held.
pub const FRIC_STATUS_MOTION_NOT_FINITE: u32 = 32;
/// The signals are outside the range in which the parameters were identified; computed as usual.
pub const FRIC_STATUS_OUT_OF_RANGE: u32 = 64;
/// There is no usable pose for a cable that needs it: last wrap and direction are held.
pub const FRIC_STATUS_POSE_MISSING: u32 = 128;
/// The pose leaves the cable no way out of its last pulley: last wrap and direction are held.
pub const FRIC_STATUS_POSE_UNREACHABLE: u32 = 256;
/// The sensor force has jumped by more than the cable can change, and not yet returned; computed as usual.
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

// cbindgen accepts numbers only, so their equality with the core's is checked here.
const _: () = {
    let mut place = 0;
    while place < FLAGS.len() {
        assert!(FLAGS[place] == CableStatus::NAMES[place].1.bits());
        place += 1;
    }
};
