//! The inverse model: the tensions at the base for a goal.

use std::ffi::c_char;

use fric_tendon::{Drive, DriveOptions, Friction, Goal};

use super::handle::{ModelHandle, Work};
use super::shape::{FRIC_FRICTION_MEASURED, friction_of};
use crate::cycle::usable;
use crate::load::guarded;
use crate::outcome::Outcome;
use crate::text_buffer::TextBuffer;

/// The goal is a bend of the whole manipulator.
pub const FRIC_GOAL_BEND: u32 = 0;
/// The goal is a position of the tip, the centre of the last disk.
pub const FRIC_GOAL_TIP: u32 = 1;

/// The limits of the drives at the base.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DriveLimits {
    /// sizeof(fric_drive).
    pub struct_size: usize,
    /// Tension that each tendon keeps while the other one is pulled, N, at least 0.
    pub least_tension_n: [f64; 2],
    /// Greatest tension of each tendon, N, from the least tension up to the tendon's capacity. If it equals the least tension, that tendon is not
    /// pulled.
    pub greatest_tension_n: [f64; 2],
    /// A goal nearer than this, rad (for the tip: relative to the manipulator's length), keeps the tensions, so that noise on the goal does not move
    /// them back and forth across the friction of all holes. 0…1.
    pub hold_rad: f64,
}

/// The goal of the manipulator.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ModelGoal {
    /// sizeof(fric_goal).
    pub struct_size: usize,
    /// With FRIC_GOAL_BEND: the bend of the whole manipulator, rad, positive towards the first tendon.
    pub bend_rad: f64,
    /// With FRIC_GOAL_TIP: the centre of the last disk, base frame, m. One tension moves the tip along a curve; the command brings it to the nearest
    /// point of that curve.
    pub tip_m: [f64; 2],
    /// FRIC_GOAL_BEND or FRIC_GOAL_TIP.
    pub kind: u32,
    /// FRIC_FRICTION_…, except FRIC_FRICTION_MEASURED, which cannot predict other tensions. That of a zeroed structure is FRIC_FRICTION_HISTORY.
    pub friction: u32,
}

/// The tensions to set at the base, and the model's prediction. Set `struct_size`; the call sets the rest. All numbers are finite, whatever the
/// input.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ModelCommand {
    /// sizeof(fric_command).
    pub struct_size: usize,
    /// Tension at the base of the first and the second tendon, N.
    pub base_tension_n: [f64; 2],
    /// Predicted bend of the whole manipulator, rad.
    pub bend_rad: f64,
    /// Predicted centre of the last disk, base frame, m.
    pub tip_m: [f64; 2],
    /// FRIC_COMMAND_… flags, FRIC_COMMAND_OK if there is none.
    pub status: u32,
}

/// Sets the limits of the drives at the base. After set-up the first tendon is pulled from 0 N up to its capacity, and every goal is followed.
///
/// FRIC_RESULT_BAD_VALUE, with the drive unchanged, if a number is NaN or out of its range; `error` then names the number, its value and what is
/// allowed, and is otherwise as in fric_load_file. Only that text allocates.
///
/// # Safety
/// `model` is null or a model that has not been freed and that nobody else uses now. `drive` is null or a structure whose `struct_size` is readable;
/// if that is right, the rest is readable too. `error` is null or points to `error_size` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_set_drive(
    model: *mut ModelHandle,
    drive: *const DriveLimits,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the caller of this function promises the same.
    let error = unsafe { TextBuffer::new(error, error_size) };
    error.write("");
    if !(usable(model) && usable(drive)) {
        error.write("`model` or `drive` is a null pointer or not aligned");
        return Outcome::BadPointer;
    }
    // SAFETY: promised to be readable; the rest of the structure is not touched before its size is known to be right.
    let size = unsafe { (&raw const (*drive).struct_size).read() };
    if size != size_of::<DriveLimits>() {
        error.write("`struct_size` of the drive is not sizeof(fric_drive)");
        return Outcome::WrongSize;
    }
    // SAFETY: of the right size, so all of it is readable.
    let DriveLimits { least_tension_n, greatest_tension_n, hold_rad, .. } = unsafe { drive.read() };
    // SAFETY: a live handle that nobody else uses; no other reference to its data exists.
    let Work { model, drive } = unsafe { &mut (*model).work };
    let options = DriveOptions { least_tension_n, greatest_tension_n, hold_rad };
    let checked =
        guarded(|| Drive::new(model.params(), &options).map_err(|error| (Outcome::BadValue, error.to_string())));
    match checked {
        Ok(checked) => {
            *drive = checked;
            Outcome::Ok
        }
        Err((outcome, text)) => {
            error.write(&text);
            outcome
        }
    }
}

/// Computes the tensions at the base that bring the manipulator to a goal, from the end of the last step of the history. It may run inside the
/// control loop: it does not allocate, lock or wait, accepts any numbers, including NaN, and its iterations are bounded.
///
/// The shape and the memory of the holes are unchanged: fric_static_model_solve, with the tensions that were then set or measured, advances them.
/// FRIC_RESULT_BAD_VALUE for a `kind` or `friction` that is none of the header's. On anything but FRIC_RESULT_OK nothing has happened and the command
/// is unchanged. Goal and command must not share memory.
///
/// # Safety
/// `model` is null or a model that has not been freed and that nobody else uses now. `goal` and `command` are null or structures whose `struct_size`
/// is readable; if that is right, the rest of the goal is readable too, and the rest of the command is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_tension_for(
    model: *mut ModelHandle,
    goal: *const ModelGoal,
    command: *mut ModelCommand,
) -> Outcome {
    if !(usable(model) && usable(goal) && usable(command)) {
        return Outcome::BadPointer;
    }
    // SAFETY: promised to be readable; the rest of the structure is not touched before its size is known to be right.
    let goal_size = unsafe { (&raw const (*goal).struct_size).read() };
    // SAFETY: as above.
    let command_size = unsafe { (&raw const (*command).struct_size).read() };
    if goal_size != size_of::<ModelGoal>() || command_size != size_of::<ModelCommand>() {
        return Outcome::WrongSize;
    }
    // SAFETY: of the right size, so all of it is readable.
    let ModelGoal { bend_rad, tip_m, kind, friction, .. } = unsafe { goal.read() };
    let goal = match kind {
        FRIC_GOAL_BEND => Goal::BendRad(bend_rad),
        FRIC_GOAL_TIP => Goal::TipM(tip_m),
        _ => return Outcome::BadValue,
    };
    let friction = match friction {
        FRIC_FRICTION_MEASURED => Friction::Measured([&[]; 2]),
        number => match friction_of(number) {
            Some(friction) => friction,
            None => return Outcome::BadValue,
        },
    };
    // SAFETY: a live handle that nobody else uses; no other reference to its data exists.
    let Work { model, drive } = unsafe { &mut (*model).work };
    let found = model.tension_for(goal, friction, drive);
    let result = ModelCommand {
        struct_size: command_size,
        base_tension_n: found.base_tension_n,
        bend_rad: found.bend_rad,
        tip_m: found.tip_m,
        status: found.status.bits(),
    };
    // SAFETY: of the right size, so all of it is writable.
    unsafe { command.write(result) };
    Outcome::Ok
}
