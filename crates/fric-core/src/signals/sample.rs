//! The content of a log, or a simulation, at one time: the signals of a cycle and the reference data.

use crate::compensator::cycle::CableInput;
use crate::platform::{Pose, Wrench};

/// All signals at one time, for a robot with any number of cables. The data are borrowed: the source of the samples reuses the memory.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Stamp, nanoseconds since 1970.
    pub stamp_nanos: i64,
    /// Signals of the cables in the robot's order.
    pub cables: &'a [CableInput],
    /// Cable forces measured at the platform, N, one per cable; NaN if there is none.
    pub reference_force_n: &'a [f64],
    /// Pose of the platform, if it is known.
    pub pose: Option<Pose>,
    /// External wrench on the platform including gravity, if it is known.
    pub outside_wrench: Option<Wrench>,
}
