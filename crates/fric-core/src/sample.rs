//! What a log, or a simulation, holds at one time: the signals of a cycle with what is known from outside.

use crate::cycle::CableInput;
use crate::platform::{Pose, Wrench};

/// All signals at one time, for a robot of any number of cables. Borrowed: whoever yields samples reuses the memory.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Time, nanoseconds since 1970.
    pub stamp_nanos: i64,
    /// Signals of the cables in the robot's order.
    pub cables: &'a [CableInput],
    /// Cable forces measured at the platform, N, one per cable; NaN where there is none.
    pub reference_force_n: &'a [f64],
    /// Pose of the platform, where it is known.
    pub pose: Option<Pose>,
    /// Wrench on the platform from outside, gravity included, where it is known.
    pub outside_wrench: Option<Wrench>,
}
