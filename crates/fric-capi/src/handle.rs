//! The opaque handle and its queries.

use std::ffi::{CString, NulError, c_char};
use std::ptr;
use std::sync::Mutex;

use fric_core::robot::file::RobotFile;
use fric_core::{AnyCompensator, CableInput, ParamError, ParameterReceiver, ParameterSender, parameter_exchange};

/// Friction compensation of one robot: created by fric_load_file or fric_load_text, freed by fric_free.
///
/// Only one thread at a time may step or reset it. Others may query names and numbers and change parameters meanwhile. Several compensators are
/// independent of each other.
pub struct Handle {
    pub(crate) cycle: Cycle,
    /// The end for parameter changes, which the lock serialises; a step never uses it.
    pub(crate) parameters: Mutex<ParameterSender>,
    description: Description,
}

/// The data of a step.
pub(crate) struct Cycle {
    pub compensator: AnyCompensator,
    /// The signals of a cycle, one entry per cable of the robot.
    pub signals: Vec<CableInput>,
    pub parameters: ParameterReceiver,
}

/// The data that do not change after set-up.
pub(crate) struct Description {
    robot_name: CString,
    cable_names: Vec<CString>,
    cycle_s: f64,
}

impl Description {
    /// Whether the cables of a robot file are these, in this order.
    pub(crate) fn has_cables_of(&self, robot: &RobotFile) -> bool {
        let names = robot.cable_names();
        let ours = self.cable_names.iter().map(CString::as_bytes);
        ours.eq(names.iter().map(|name| name.as_bytes()))
    }
}

/// The reason why a checked robot file gives no handle.
pub(crate) enum Unfit {
    /// The robot has more cables than the library supports.
    Robot(ParamError),
    /// A name contains a zero byte, which C cannot represent.
    Name(NulError),
}

impl Handle {
    /// Creates a compensator for the robot of a file.
    ///
    /// # Errors
    /// Returns an [`Unfit`] if the library or C cannot represent the robot.
    pub(crate) fn new(robot: &RobotFile) -> Result<Self, Unfit> {
        let params = robot.params();
        let compensator = AnyCompensator::new(&params).map_err(Unfit::Robot)?;
        let (sender, receiver) = parameter_exchange(&params).map_err(Unfit::Robot)?;
        let name = |name: &str| CString::new(name).map_err(Unfit::Name);
        let cable_names = robot.cable_names().into_iter().map(name).collect::<Result<Vec<_>, _>>()?;
        let signals = vec![CableInput::default(); cable_names.len()];
        let options = robot.options();
        let description = Description { robot_name: name(&options.name)?, cable_names, cycle_s: options.cycle_s };
        let cycle = Cycle { compensator, signals, parameters: receiver };
        Ok(Self { cycle, parameters: Mutex::new(sender), description })
    }
}

/// Returns the description behind a handle; `None` if the pointer cannot be one.
///
/// # Safety
/// `compensator` is null or a handle that has not been freed.
pub(crate) unsafe fn description<'a>(compensator: *const Handle) -> Option<&'a Description> {
    if compensator.is_null() || !compensator.is_aligned() {
        return None;
    }
    // SAFETY: a live handle. Nothing writes to its description, and no reference to the rest is made.
    Some(unsafe { &(*compensator).description })
}

/// Returns the number of cables of the robot; 0 for a null pointer.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_cable_count(compensator: *const Handle) -> usize {
    // SAFETY: the caller of this function promises the same.
    unsafe { description(compensator) }.map_or(0, |description| description.cable_names.len())
}

/// Returns the cycle time of the robot, s; 0 for a null pointer.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_cycle_s(compensator: *const Handle) -> f64 {
    // SAFETY: the caller of this function promises the same.
    unsafe { description(compensator) }.map_or(0.0, |description| description.cycle_s)
}

/// Returns the name of the robot in UTF-8; null for a null pointer. The text is valid until fric_free.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_robot_name(compensator: *const Handle) -> *const c_char {
    // SAFETY: the caller of this function promises the same.
    unsafe { description(compensator) }.map_or(ptr::null(), |description| description.robot_name.as_ptr())
}

/// Returns the name of a cable, counted from 0, in UTF-8; null for a null pointer or a cable that the robot does not have. The text is valid until
/// fric_free.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_cable_name(compensator: *const Handle, cable: usize) -> *const c_char {
    // SAFETY: the caller of this function promises the same.
    let description = unsafe { description(compensator) };
    description.and_then(|description| description.cable_names.get(cable)).map_or(ptr::null(), |name| name.as_ptr())
}

/// Frees a compensator. Null does nothing. Not for the cycle: it frees memory.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed; it must not be used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_free(compensator: *mut Handle) {
    if !compensator.is_null() && compensator.is_aligned() {
        // SAFETY: it came from `Box::into_raw` in `load`, and is freed once.
        drop(unsafe { Box::from_raw(compensator) });
    }
}
