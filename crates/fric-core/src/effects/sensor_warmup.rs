//! `sensor_warmup`: a force sensor whose zero approaches another value as it warms up.
//!
//! Equation: `F_shown = F_s + final_n·(1 − exp(−t/time_constant_s))`, in newtons of the sensor signal, with t from the start of the run. A steady
//! drift over the run is described by `sensor_drift`. For a sensor that is already warm, tare it and leave the effect out. Neutral: `final_n = 0`.
//!
//! Cause: the load cell or its amplifier was switched on shortly before and warms up to its steady temperature.

use super::{Acting, Effect, EffectRow, Memory, OnMu, warmed};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str =
    "a long run from cold with the same poses throughout, three times as long as it takes to warm up";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "sensor_warmup",
    cause: "the load cell or its amplifier warms up after it was switched on, and its zero moves towards a final value",
    remedy: "switch the amplifier on well before taring: some five times the time constant",
    parameters: &[
        ParameterRow::fitted("final_n", "N", [-1e4, 0.0, 1e4], EXCITATION),
        ParameterRow::fitted("time_constant_s", "s", [1e-2, 10.0, 1e6], EXCITATION),
    ],
    example: &[0.2, 5.0],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: true,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::SensorWarmup.acts();
/// Index of `final_n` in [`Values`](crate::parameters::Values).
pub const FINAL: usize = Effect::SensorWarmup.first_place();
/// Index of `time_constant_s`.
pub const TIME_CONSTANT: usize = FINAL + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorWarmup<T> {
    /// Excess of the warm sensor's signal, N.
    pub final_n: T,
    /// Time constant of the change, s.
    pub time_constant_s: T,
}

impl<T: Scalar> SensorWarmup<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { final_n: value(FINAL), time_constant_s: value(TIME_CONSTANT) }
    }

    /// Returns the true force for the one shown (N) at a time (s) since the start.
    #[inline(never)]
    pub fn undo(&self, shown_n: T, time_s: T) -> T {
        shown_n - self.final_n * warmed(time_s, self.time_constant_s)
    }
}
