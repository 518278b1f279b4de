//! The cycle: plain structures in, plain structures out.

use fric_core::{CableInput, ParamError, Pose, Wrench};

use crate::handle::{Cycle, Handle};
use crate::outcome::Outcome;

/// Signals of one cable.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CableSignals {
    /// Force shown by the sensor, N.
    pub sensor_force_n: f64,
    /// Cable length, m, positive paying out; its zero is arbitrary, because only changes count. The winch's set point, or a measured length with
    /// little noise.
    pub length_m: f64,
    /// Rate of the length, m/s.
    pub speed_m_per_s: f64,
}

/// Pose of the platform in the base frame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PlatformPose {
    /// Platform origin, m.
    pub position_m: [f64; 3],
    /// Rotation from platform to base axes as a quaternion x, y, z, w, which is normalised here. A quaternion whose norm is not within 10 % of 1 is
    /// no pose.
    pub orientation_xyzw: [f64; 4],
}

/// Force and torque in base axes, torque about the platform origin.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlatformWrench {
    /// Force, N.
    pub force_n: [f64; 3],
    /// Torque, N m.
    pub torque_nm: [f64; 3],
}

/// Output for one cable. All numbers are finite, whatever the input.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableResult {
    /// Cable force at the platform including the offset, N.
    pub force_at_platform_n: f64,
    /// Estimated friction, N; positive if it makes the platform side tighter.
    pub friction_n: f64,
    /// Cable tension computed from the sensor force without friction, N.
    pub frictionless_n: f64,
    /// FRIC_STATUS_… flags, FRIC_STATUS_OK if there is no fault.
    pub status: u32,
}

/// Signals of one cycle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CycleSignals {
    /// sizeof(fric_input).
    pub struct_size: usize,
    /// Cables in the robot's order.
    pub cables: *const CableSignals,
    /// Number of cables, which must be fric_cable_count.
    pub cable_count: usize,
    /// Pose of the platform; null if it is unknown.
    pub pose: *const PlatformPose,
    /// Cycles since the last step, 1 unless some were skipped. A longer pause allows a longer distance before a change of length counts as a jump, and
    /// advances a change of parameters. The range is 1 to 1e6: lower values (0, as in a zeroed structure) and NaN count as 1. Higher ones, infinity
    /// included, count as 1e6 for what goes by time, but as 1 in the checks of jumps: after such a pause, a change that is too large for one cycle is
    /// flagged FRIC_STATUS_LENGTH_JUMP or FRIC_STATUS_SENSOR_JUMP.
    pub elapsed_cycles: f64,
}

/// Output of one cycle. Set `struct_size`, `cables` and `cable_count`; the step sets the rest.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CycleResult {
    /// sizeof(fric_output).
    pub struct_size: usize,
    /// Output for the cables, in the robot's order.
    pub cables: *mut CableResult,
    /// Number of cables, which must be fric_cable_count.
    pub cable_count: usize,
    /// External wrench on the platform including gravity; zero without a wrench.
    pub outside_wrench: PlatformWrench,
    /// External wrench without gravity: the contribution of a hand, a tool or acceleration; zero without a wrench.
    pub applied_wrench: PlatformWrench,
    /// Whether there are wrenches: not before the first pose, and not for a robot file that lacks the attachment of a cable.
    pub has_wrench: bool,
    /// Every FRIC_STATUS_… flag of any cable that contributes to the wrenches.
    pub wrench_status: u32,
}

impl PlatformWrench {
    fn new(wrench: &Wrench) -> Self {
        Self { force_n: wrench.force_n.into(), torque_nm: wrench.torque_nm.into() }
    }
}

/// Whether a pointer may be dereferenced: not null and aligned.
pub(crate) fn usable<T>(pointer: *const T) -> bool {
    !pointer.is_null() && pointer.is_aligned()
}

/// Runs one cycle, inside the control loop. It does not allocate, lock or wait, and accepts any numbers, including NaN.
///
/// On anything but FRIC_RESULT_OK nothing has happened and the output is unchanged. Input and output must not share memory.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed and that nobody else steps or resets now. `input` and `output` are null or
/// structures whose `struct_size` is readable; if that is right, the rest is readable too, `cables` are null or `cable_count` elements, `pose` is
/// null or a pose, and those of the output are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_step(
    compensator: *mut Handle,
    input: *const CycleSignals,
    output: *mut CycleResult,
) -> Outcome {
    if !(usable(compensator) && usable(input) && usable(output)) {
        return Outcome::BadPointer;
    }
    // SAFETY: promised to be readable; the rest of the structure is not touched before its size is known to be right.
    let input_size = unsafe { (&raw const (*input).struct_size).read() };
    // SAFETY: as above.
    let output_size = unsafe { (&raw const (*output).struct_size).read() };
    if input_size != size_of::<CycleSignals>() || output_size != size_of::<CycleResult>() {
        return Outcome::WrongSize;
    }
    // SAFETY: of the right size, so all of it is readable.
    let input = unsafe { input.read() };
    // SAFETY: of the right size. Only what the caller sets is read: the rest may be uninitialised.
    let results = unsafe { (&raw const (*output).cables).read() };
    // SAFETY: as above.
    let result_count = unsafe { (&raw const (*output).cable_count).read() };
    if !(usable(input.cables) && usable(results) && (input.pose.is_null() || input.pose.is_aligned())) {
        return Outcome::BadPointer;
    }
    // SAFETY: a live handle that nobody else steps; no other reference to its cycle exists.
    let cycle = unsafe { &mut (*compensator).cycle };
    let count = cycle.signals.len();
    if input.cable_count != count || result_count != count {
        return Outcome::WrongSize;
    }
    for (place, signal) in cycle.signals.iter_mut().enumerate() {
        // SAFETY: `place` < `cable_count`, and this many are readable.
        let CableSignals { sensor_force_n, length_m, speed_m_per_s } = unsafe { input.cables.add(place).read() };
        *signal = CableInput { sensor_force_n, length_m, speed_m_per_s };
    }
    // SAFETY: null, or a readable pose.
    let pose = unsafe { input.pose.as_ref() }.copied();
    let Ok(outside) = cycle.step(pose, input.elapsed_cycles) else { return Outcome::Internal };
    for (place, outcome) in cycle.compensator.outputs().iter().enumerate() {
        let result = CableResult {
            force_at_platform_n: outcome.force_at_platform_n,
            friction_n: outcome.friction_n,
            frictionless_n: outcome.frictionless_n,
            status: outcome.status.bits(),
        };
        // SAFETY: `place` < `cable_count`, and this many are writable.
        unsafe { results.add(place).write(result) };
    }
    let of = |wrench: Option<Wrench>| wrench.as_ref().map_or_else(PlatformWrench::default, PlatformWrench::new);
    let result = CycleResult {
        struct_size: output_size,
        cables: results,
        cable_count: result_count,
        outside_wrench: of(outside),
        applied_wrench: of(cycle.compensator.applied_wrench()),
        has_wrench: outside.is_some(),
        wrench_status: cycle.compensator.wrench_status().bits(),
    };
    // SAFETY: of the right size, so all of it is writable.
    unsafe { output.write(result) };
    Outcome::Ok
}

impl Cycle {
    /// Runs one cycle. Both ends of the exchange belong to the same robot, so an error here and in `reset` is a bug.
    fn step(&mut self, pose: Option<PlatformPose>, elapsed_cycles: f64) -> Result<Option<Wrench>, ParamError> {
        let pose = pose.and_then(|pose| Pose::from_parts(pose.position_m, pose.orientation_xyzw));
        self.parameters.deliver_to(&mut self.compensator)?;
        self.compensator.set_input(&self.signals, pose, elapsed_cycles);
        Ok(self.compensator.step())
    }

    fn reset(&mut self) -> Result<(), ParamError> {
        self.parameters.deliver_to(&mut self.compensator)?;
        self.compensator.reset();
        Ok(())
    }
}

/// Resets to the state after set-up: at rest, nothing stored, no pose. The parameters are kept; those of a pending change apply at once, without a
/// blend. It does not allocate, lock or wait.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed and that nobody else steps or resets now.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_reset(compensator: *mut Handle) -> Outcome {
    if !usable(compensator) {
        return Outcome::BadPointer;
    }
    // SAFETY: a live handle that nobody else uses in this way; no other reference to its cycle exists.
    let cycle = unsafe { &mut (*compensator).cycle };
    cycle.reset().map_or(Outcome::Internal, |()| Outcome::Ok)
}
