//! Input and output of a cycle.

use crate::numbers::lanes::Block;
use crate::platform::{Pose, Wrench};
use crate::signals::RawSignals;
use crate::signals::status::CableStatus;
use crate::words::words_of;

/// Signals of one cable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableInput {
    /// Force shown by the sensor, N.
    pub sensor_force_n: f64,
    /// Cable length, m, positive paying out. Its zero is arbitrary, because only changes count.
    ///
    /// The winch's set point, as in \[P\], or a measured length with noise far below the presliding distance f_c/σ: alternating noise of amplitude δ
    /// releases the stored friction at standstill within about f_c/(2σδ) pairs of cycles. For coarser encoders, state the noise as `length_noise_m`
    /// of the robot's monitor.
    pub length_m: f64,
    /// Rate of the length, m/s.
    pub speed_m_per_s: f64,
}

/// Signals of one cycle for a robot of up to `CABLES` cables; entries past the robot's cables are ignored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleInput<const CABLES: usize> {
    /// Cables in the robot's order.
    pub cables: [CableInput; CABLES],
    /// Pose of the platform, if it is known.
    pub pose: Option<Pose>,
    /// Cycles since the last call, 1 unless some were skipped. A longer pause allows a longer distance before a change of length counts as a jump, and
    /// advances a change of parameters. Friction itself does not depend on time. The range is 1 to 10⁶: lower values and NaN count as 1. Higher ones,
    /// infinity included, count as 10⁶ for what goes by time, but as 1 in the checks of jumps: after such a pause, a change that is too large for one
    /// cycle is flagged [`LENGTH_JUMP`](CableStatus::LENGTH_JUMP) or [`SENSOR_JUMP`](CableStatus::SENSOR_JUMP).
    pub elapsed_cycles: f64,
}

impl<const CABLES: usize> Default for CycleInput<CABLES> {
    fn default() -> Self {
        Self { cables: [CableInput::default(); CABLES], pose: None, elapsed_cycles: 1.0 }
    }
}

impl<const CABLES: usize> CycleInput<CABLES> {
    /// Returns the signals of a block's cables.
    #[inline(always)]
    pub(super) fn signals_of_block<T: Block>(&self, first: usize) -> RawSignals<T> {
        let signal = |of: fn(&CableInput) -> f64| T::from_lanes(|lane| self.cables.get(first + lane).map_or(0.0, of));
        RawSignals {
            sensor_force_n: signal(|cable| cable.sensor_force_n),
            length_m: signal(|cable| cable.length_m),
            speed_m_per_s: signal(|cable| cable.speed_m_per_s),
        }
    }
}

/// Output for one cable. All numbers are finite, whatever the input.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableOutput {
    /// Cable force at the platform including the offset ε, N.
    pub force_at_platform_n: f64,
    /// Estimated friction, N: force at the platform minus the frictionless one, without ε; 0 if the sensor shows no positive tension.
    pub friction_n: f64,
    /// Cable tension computed from the sensor force without friction, N.
    pub frictionless_n: f64,
    /// Faults of the cable, which also apply to these numbers.
    pub status: CableStatus,
}

/// Output of one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleOutput<const CABLES: usize> {
    /// Cables in the robot's order; entries past the robot's cables are zero.
    pub cables: [CableOutput; CABLES],
    /// External wrench `−A^T f` on the platform including gravity, base axes, about the platform origin. `None` until a pose has let every cable
    /// leave its last pulley, and for a robot with a cable without attachment.
    pub outside_wrench: Option<Wrench>,
    /// Faults of any cable that contributes to the wrenches; [`CableStatus::OK`] if there are none.
    pub wrench_status: CableStatus,
    /// External wrench without gravity: the contribution of a hand, a tool or acceleration.
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

words_of!(CableOutput { force_at_platform_n, friction_n, frictionless_n, status });
words_of!(CycleOutput<const CABLES> { cables, outside_wrench, wrench_status, applied_wrench });
