//! The run of \[P\], section IV B: crosses one position repeatedly, along each axis and about it.
//!
//! It measures the hysteresis of the wrench, which is the difference at one pose reached from either side. Each crossing has constant speed, so that
//! inertia has no effect, and starts and ends so far away that presliding is over. \[P\] states neither amplitudes nor speeds; all numbers are chosen
//! here.

use nalgebra::Vector3;

use super::identification::{ACCELERATION_M_PER_S2, BREAK_S, STEP_M_PER_S};
use super::{Phase, Trajectory};
use crate::axis::CartesianAxis;

/// Distance to either side of the position, m, if there is room: many presliding distances.
pub const CROSSING_HALF_M: f64 = 0.05;
/// Rotation to either side, rad, if the cables allow it: 5°.
pub const CROSSING_HALF_RAD: f64 = 5.0 * core::f64::consts::PI / 180.0;
/// Angular speed, rad/s: a rotation takes as long as a translation.
pub const CROSSING_RAD_PER_S: f64 = 0.15;
/// Limit of angular acceleration, rad/s².
pub const CROSSING_RAD_PER_S2: f64 = 7.2;
/// Number of times that the position is crossed back and forth on each axis.
pub const CROSSING_CYCLES: usize = 4;

impl Trajectory {
    /// Crosses `center_m` by `half_m` to either side along the base axes and by `half_rad` about them, each back and forth [`CROSSING_CYCLES`] times
    /// with rests at the ends. An axis with 0 is left out.
    ///
    /// Apart from the rotations, the platform keeps the orientation of the base axes.
    #[must_use]
    pub fn crossing(center_m: Vector3<f64>, half_m: &Vector3<f64>, half_rad: &Vector3<f64>) -> Self {
        let mut run = Self::starting_at(center_m, BREAK_S);
        for axis in CartesianAxis::ALL {
            let phase = Phase::Crossing(axis);
            let half = if axis.is_rotation() { half_rad } else { half_m };
            let end = axis.direction() * half.dot(&axis.direction());
            let there_and_back = [-end, end].into_iter().cycle().take(2 * CROSSING_CYCLES);
            for offset in [end].into_iter().chain(there_and_back).chain([Vector3::zeros()]) {
                let before_s = run.duration_s();
                if axis.is_rotation() {
                    run.turn(phase, offset, CROSSING_RAD_PER_S, CROSSING_RAD_PER_S2);
                } else {
                    run.go(phase, center_m + offset, STEP_M_PER_S, ACCELERATION_M_PER_S2);
                }
                if run.duration_s() > before_s {
                    run.rest(BREAK_S);
                }
            }
        }
        run
    }
}
