//! What goes into a cycle and what comes out.

use crate::platform::{Pose, Wrench};
use crate::status::CableStatus;

/// Signals of one cable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableInput {
    /// Force that the sensor shows, N.
    pub sensor_force_n: f64,
    /// Cable length, m; any zero, only changes count. Positive paying out.
    ///
    /// The winch's set point, as in \[P\], or a measured length whose noise is far below the presliding distance f_c/σ:
    /// back-and-forth noise δ releases the stored friction at standstill within some f_c/(2σδ) cycle pairs. For coarser
    /// encoders give the noise as `length_noise_m` of the robot's monitor.
    pub length_m: f64,
    /// Its rate, m/s.
    pub speed_m_per_s: f64,
}

/// Signals of one cycle for a robot of up to `CABLES` cables; entries past the robot's cables are not looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleInput<const CABLES: usize> {
    /// Cables in the robot's order.
    pub cables: [CableInput; CABLES],
    /// Pose of the platform, where it is known.
    pub pose: Option<Pose>,
    /// Cycles since the last call, 1 unless some were skipped: a longer pause allows a longer way before a change of
    /// length counts as a jump. Friction itself knows no time. Less than 1 and NaN count as 1.
    pub elapsed_cycles: f64,
}

impl<const CABLES: usize> Default for CycleInput<CABLES> {
    fn default() -> Self {
        Self { cables: [CableInput::default(); CABLES], pose: None, elapsed_cycles: 1.0 }
    }
}

/// Outcome for one cable. All numbers are finite, whatever went in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableOutput {
    /// Cable force at the platform, N, the offset ε included.
    pub force_at_platform_n: f64,
    /// Estimated friction, N: force at the platform less the frictionless one, without ε; 0 where the sensor shows no tension, or less.
    pub friction_n: f64,
    /// The sensor force turned into cable tension as if nothing rubbed, N.
    pub frictionless_n: f64,
    /// What is the matter with the cable, and so with these numbers.
    pub status: CableStatus,
}

/// Outcome of one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleOutput<const CABLES: usize> {
    /// Cables in the robot's order; entries past them are zero.
    pub cables: [CableOutput; CABLES],
    /// Wrench `−A^T f` that acts on the platform from outside, gravity included, base axes, about the platform origin.
    /// `None` until a pose has let every cable leave its last pulley, and for a robot with a cable whose attachment is not given.
    pub outside_wrench: Option<Wrench>,
    /// What is the matter with any of the cables that the wrenches are made of; [`CableStatus::OK`] if nothing.
    pub wrench_status: CableStatus,
    /// The outside wrench less gravity: what a hand, a tool or acceleration applies.
    pub applied_wrench: Option<Wrench>,
}

impl<const CABLES: usize> Default for CycleOutput<CABLES> {
    fn default() -> Self {
        Self {
            cables: [CableOutput::default(); CABLES],
            outside_wrench: None,
            wrench_status: CableStatus::OK,
            applied_wrench: None,
        }
    }
}
