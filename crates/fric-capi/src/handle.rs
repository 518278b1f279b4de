//! The opaque handle and what may be asked of it.

use std::ffi::{CString, NulError, c_char};
use std::ptr;
use std::sync::Mutex;

use fric_core::robot::file::RobotFile;
use fric_core::{AnyCompensator, CableInput, ParamError, ParameterReceiver, ParameterSender, parameter_exchange};

/// Friction compensation of one robot: made by fric_load_file or fric_load_text, given back by fric_free.
///
/// One thread at a time may step or reset it. Others may ask for names and numbers and change parameters meanwhile. Several
/// compensators are independent of each other.
pub struct Handle {
    pub(crate) cycle: Cycle,
    /// The end of those who change parameters, among whom the lock is; a step never looks at it.
    pub(crate) parameters: Mutex<ParameterSender>,
    description: Description,
}

/// What a step works on.
pub(crate) struct Cycle {
    pub compensator: AnyCompensator,
    /// The signals of a cycle, as many as the robot has cables.
    pub signals: Vec<CableInput>,
    pub parameters: ParameterReceiver,
}

/// What does not change after set-up.
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

/// Why a checked robot file makes no handle.
pub(crate) enum Unfit {
    /// More cables than the library takes.
    Robot(ParamError),
    /// A name that C cannot hold.
    Name(NulError),
}

impl Handle {
    /// A compensator for the robot of a file.
    ///
    /// # Errors
    /// [`Unfit`] if the library or C cannot take the robot.
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

/// The description behind a handle; `None` where the pointer cannot be one.
///
/// # Safety
/// `compensator` is null or a handle that has not been given back.
pub(crate) unsafe fn description<'a>(compensator: *const Handle) -> Option<&'a Description> {
    if compensator.is_null() || !compensator.is_aligned() {
        return None;
    }
    // SAFETY: a handle that lives. Nothing writes to its description, and no reference to the rest is made.
    Some(unsafe { &(*compensator).description })
}

/// How many cables the robot has; 0 for a null pointer.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_cable_count(compensator: *const Handle) -> usize {
    // SAFETY: the same is promised here.
    unsafe { description(compensator) }.map_or(0, |description| description.cable_names.len())
}

/// Cycle time of the robot, s; 0 for a null pointer.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_cycle_s(compensator: *const Handle) -> f64 {
    // SAFETY: the same is promised here.
    unsafe { description(compensator) }.map_or(0.0, |description| description.cycle_s)
}

/// Name of the robot in UTF-8; null for a null pointer. The text lives until fric_free.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_robot_name(compensator: *const Handle) -> *const c_char {
    // SAFETY: the same is promised here.
    unsafe { description(compensator) }.map_or(ptr::null(), |description| description.robot_name.as_ptr())
}

/// Name of a cable, counted from 0, in UTF-8; null for a null pointer or a cable that the robot does not have. The text
/// lives until fric_free.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_cable_name(compensator: *const Handle, cable: usize) -> *const c_char {
    // SAFETY: the same is promised here.
    let description = unsafe { description(compensator) };
    description.and_then(|description| description.cable_names.get(cable)).map_or(ptr::null(), |name| name.as_ptr())
}

/// Gives a compensator back. Null does nothing. Not for the cycle: it frees memory.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back; it is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_free(compensator: *mut Handle) {
    if !compensator.is_null() && compensator.is_aligned() {
        // SAFETY: it came from `Box::into_raw` in `load`, and is given back once.
        drop(unsafe { Box::from_raw(compensator) });
    }
}
