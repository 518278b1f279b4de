//! `sensor_gain`: a force sensor that shows more, or less, than there is, in proportion.
//!
//! Equation: `F_shown = gain·F_s`, so that the cycle takes `F_shown/gain`; with all errors of a sensor
//! `F_shown = gain·F_s + offset_n + rate_n_per_s·t`. Neutral: `gain = 1`.
//!
//! Cause: calibration of the amplifier, or of the load cell's direction in its mount.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "long movements at cable forces that differ by a factor of two and more";

/// What it is.
pub const ROW: EffectRow = EffectRow {
    kind: "sensor_gain",
    cause: "the force sensor or its amplifier is calibrated with a wrong slope",
    remedy: "calibrate the sensor at the winch with known weights",
    parameters: &[ParameterRow {
        key: "gain",
        unit: "1",
        neutral: 1.0,
        min: 0.1,
        max: 10.0,
        fitted: true,
        excitation: EXCITATION,
    }],
    example: &[1.03],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Effect::SensorGain.acts();
/// Place of `gain` in [`Values`](crate::parameters::Values).
pub const GAIN: usize = Effect::SensorGain.first_place();

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorGain<T> {
    /// What the sensor shows, as a multiple of what there is, 1.
    pub gain: T,
}

impl<T: Scalar> SensorGain<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { gain: value(GAIN) }
    }

    /// The force there is for the one shown, N.
    #[inline(always)]
    pub fn undo(&self, shown_n: T) -> T {
        shown_n / self.gain
    }
}
