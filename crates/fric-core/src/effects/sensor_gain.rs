//! `sensor_gain`: a force sensor whose signal is proportionally too large or too small.
//!
//! Equation: `F_shown = gain·F_s`, so that the cycle uses `F_shown/gain`; with all sensor errors `F_shown = gain·F_s + offset_n + rate_n_per_s·t`.
//! Neutral: `gain = 1`.
//!
//! Cause: calibration of the amplifier, or orientation of the load cell in its mount.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements at cable forces that differ by a factor of two and more";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "sensor_gain",
    cause: "the force sensor or its amplifier is calibrated with a wrong slope, or a load that the robot file states is another one",
    remedy: "calibrate the sensor at the winch with known weights; weigh a load that is stated",
    parameters: &[ParameterRow::fitted("gain", "1", [0.1, 1.0, 10.0], EXCITATION)],
    example: &[1.03],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::SensorGain.acts();
/// Index of `gain` in [`Values`](crate::parameters::Values).
pub const GAIN: usize = Effect::SensorGain.first_place();

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorGain<T> {
    /// Ratio of the force shown to the true force, dimensionless.
    pub gain: T,
}

impl<T: Scalar> SensorGain<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { gain: value(GAIN) }
    }

    /// Returns the true force for the one shown, N.
    #[inline(always)]
    pub fn undo(&self, shown_n: T) -> T {
        shown_n / self.gain
    }
}
