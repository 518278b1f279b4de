//! The flags of a shape and of a command, those of [`ShapeStatus`] and [`GoalStatus`].

use fric_tendon::{GoalStatus, ShapeStatus};

/// Nothing is the matter with the shape.
pub const FRIC_SHAPE_OK: u32 = 0;
/// A tension is negative, NaN, infinite or beyond 1e9 N: the shape and what the holes remember stay as they were.
pub const FRIC_SHAPE_NOT_FINITE: u32 = 1;
/// No equilibrium was found: the shape and what the holes remember stay as they were.
pub const FRIC_SHAPE_NOT_CONVERGED: u32 = 2;
/// The equilibrium is not stable, the arm would leave it: the shape and what the holes remember stay as they were.
pub const FRIC_SHAPE_UNSTABLE: u32 = 4;
/// A tension is above what the tendon can bear; computed as usual.
pub const FRIC_SHAPE_OVER_CAPACITY: u32 = 8;
/// Disks would touch, the bend is beyond the model; computed as usual.
pub const FRIC_SHAPE_DISKS_TOUCH: u32 = 16;
/// The flags with which there is no new shape.
pub const FRIC_SHAPE_FAILED: u32 = 7;

/// The command reaches the goal, and the arm moves on in the direction in which it moved before.
pub const FRIC_COMMAND_OK: u32 = 0;
/// The goal is not finite, or the friction is FRIC_FRICTION_MEASURED: the tensions as they were.
pub const FRIC_COMMAND_NOT_USABLE: u32 = 1;
/// No tension was found: the tensions as they were.
pub const FRIC_COMMAND_NOT_CONVERGED: u32 = 2;
/// The tensions of the drive end before the goal, disks would touch, there is no stable shape, or the tip passes the goal by more than 1 %
/// of the arm's length: the tensions that come nearest.
pub const FRIC_COMMAND_OUT_OF_REACH: u32 = 4;
/// The goal is nearer than `hold_rad` of the drive: the tensions as they were.
pub const FRIC_COMMAND_HELD: u32 = 8;
/// The tendon turns round: friction at the base plate was against this motion before. The goal is reached.
pub const FRIC_COMMAND_REVERSAL: u32 = 16;
/// Some hole still has the friction of the motion before, so that much tension moves little. The goal is reached.
pub const FRIC_COMMAND_DEAD_BAND: u32 = 32;
/// The flags with which the command does not reach the goal.
pub const FRIC_COMMAND_MISSED: u32 = 7;

// cbindgen takes numbers only; that they are the core's is checked here.
const _: () = {
    let shape = [
        FRIC_SHAPE_NOT_FINITE,
        FRIC_SHAPE_NOT_CONVERGED,
        FRIC_SHAPE_UNSTABLE,
        FRIC_SHAPE_OVER_CAPACITY,
        FRIC_SHAPE_DISKS_TOUCH,
    ];
    let command = [
        FRIC_COMMAND_NOT_USABLE,
        FRIC_COMMAND_NOT_CONVERGED,
        FRIC_COMMAND_OUT_OF_REACH,
        FRIC_COMMAND_HELD,
        FRIC_COMMAND_REVERSAL,
        FRIC_COMMAND_DEAD_BAND,
    ];
    assert!(shape.len() == ShapeStatus::NAMES.len() && command.len() == GoalStatus::NAMES.len());
    let mut place = 0;
    while place < shape.len() {
        let status = ShapeStatus::NAMES[place].1;
        assert!(shape[place] == status.bits());
        assert!((status.bits() & FRIC_SHAPE_FAILED == 0) == status.has_shape());
        place += 1;
    }
    place = 0;
    while place < command.len() {
        let status = GoalStatus::NAMES[place].1;
        assert!(command[place] == status.bits());
        assert!((status.bits() & FRIC_COMMAND_MISSED == 0) == status.is_reached());
        place += 1;
    }
};
