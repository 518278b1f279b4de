//! `sensor_offset`: a force sensor whose zero is wrong.
//!
//! Equation: `F_shown = F_s + offset_n`, so that the cycle uses `F_shown − offset_n`. Unlike `offset_n` of `friction`, which is added at the
//! platform, it acts before the pulleys: a sensor pulley of 180° halves it, and it is part of the load on the bearings. In newtons of the sensor
//! signal, like `sensor_drift`. Neutral: 0.
//!
//! Cause: the sensor was not tared, or its zero has moved since. A stated load that is wrong looks the same.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements at cable forces that differ by a factor of two and more";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "sensor_offset",
    cause: "the force sensor was not tared, or a load that the robot file states is another one",
    remedy: "tare the force sensor at the winch without load; weigh a load that is stated",
    parameters: &[ParameterRow::fitted("offset_n", "N", [-1e6, 0.0, 1e6], EXCITATION)],
    example: &[0.3],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::SensorOffset.acts();
/// Index of `offset_n` in [`Values`](crate::parameters::Values).
pub const OFFSET: usize = Effect::SensorOffset.first_place();

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorOffset<T> {
    /// Signal of the unloaded sensor, N.
    pub offset_n: T,
}

impl<T: Scalar> SensorOffset<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { offset_n: value(OFFSET) }
    }

    /// Returns the true force for the one shown, N.
    #[inline(always)]
    pub fn undo(&self, shown_n: T) -> T {
        shown_n - self.offset_n
    }
}
