//! The flags of a shape and of a command, equal to those of [`ShapeStatus`] and [`GoalStatus`].

use fric_tendon::{GoalStatus, ShapeStatus};

/// The shape has no fault.
pub const FRIC_SHAPE_OK: u32 = 0;
/// A tension is negative, NaN, infinite or beyond 1e9 N: the shape and the memory of the holes are unchanged.
pub const FRIC_SHAPE_NOT_FINITE: u32 = 1;
/// No equilibrium was found: the shape and the memory of the holes are unchanged.
pub const FRIC_SHAPE_NOT_CONVERGED: u32 = 2;
/// The equilibrium is unstable, and the manipulator would leave it: the shape and the memory of the holes are unchanged.
pub const FRIC_SHAPE_UNSTABLE: u32 = 4;
/// A tension exceeds the tendon's capacity; computed as usual.
pub const FRIC_SHAPE_OVER_CAPACITY: u32 = 8;
/// Disks would touch, and the bend is beyond the model; computed as usual.
pub const FRIC_SHAPE_DISKS_TOUCH: u32 = 16;
/// A hole has not slid since `StaticModel::begin_history` of the Rust crate stated what it holds; computed as usual.
pub const FRIC_SHAPE_MEMORY_UNCERTAIN: u32 = 32;
/// The flags without a new shape.
pub const FRIC_SHAPE_FAILED: u32 = 7;

/// The command reaches the goal, and the manipulator continues in its previous direction.
pub const FRIC_COMMAND_OK: u32 = 0;
/// The goal is not finite, or the friction is FRIC_FRICTION_MEASURED: the tensions are unchanged.
pub const FRIC_COMMAND_NOT_USABLE: u32 = 1;
/// No tension was found: the tensions are unchanged.
pub const FRIC_COMMAND_NOT_CONVERGED: u32 = 2;
/// The tensions of the drive end before the goal, disks would touch, there is no stable shape, or the tip passes the goal by more than 1 % of the
/// manipulator's length: the command is the nearest possible one.
pub const FRIC_COMMAND_OUT_OF_REACH: u32 = 4;
/// The goal is nearer than `hold_rad` of the drive: the tensions are unchanged.
pub const FRIC_COMMAND_HELD: u32 = 8;
/// The tendon reverses: friction at the base plate was against this motion before. The goal is reached.
pub const FRIC_COMMAND_REVERSAL: u32 = 16;
/// Some hole still has the friction of the previous motion, so the tip hardly moves until the tension has changed by the dead band. The goal is reached.
pub const FRIC_COMMAND_DEAD_BAND: u32 = 32;
/// The flags with which the command does not reach the goal.
pub const FRIC_COMMAND_MISSED: u32 = 7;

// cbindgen accepts numbers only, so their equality with the core's is checked here.
const _: () = {
    let shape = [
        FRIC_SHAPE_NOT_FINITE,
        FRIC_SHAPE_NOT_CONVERGED,
        FRIC_SHAPE_UNSTABLE,
        FRIC_SHAPE_OVER_CAPACITY,
        FRIC_SHAPE_DISKS_TOUCH,
        FRIC_SHAPE_MEMORY_UNCERTAIN,
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
