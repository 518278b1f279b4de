//! `sensor_drift`: a force sensor whose zero moves with time.
//!
//! Equation: `F_shown = F_s + rate_n_per_s·t`, in newtons of the sensor signal, with t from the start of the run up to `until_s`, where the drift
//! ends. Without an end (`until_s = 0`) the correction grows without limit in a running loop; the discovery sets the end to that of its log. Neutral:
//! `rate_n_per_s = 0`.
//!
//! Cause: the load cell or its amplifier warms up.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNTIL_ROW, drifting_s};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "a long run with the same poses at its beginning and its end";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "sensor_drift",
    cause: "the zero of the force sensor or its amplifier moves with temperature",
    remedy: "let the amplifier warm up before taring, or tare more often",
    parameters: &[ParameterRow::fitted("rate_n_per_s", "N/s", [-1e3, 0.0, 1e3], EXCITATION), UNTIL_ROW],
    example: &[-0.005, 0.0],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: true,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::SensorDrift.acts();
/// Index of `rate_n_per_s` in [`Values`](crate::parameters::Values).
pub const RATE: usize = Effect::SensorDrift.first_place();
/// Index of `until_s`.
pub const UNTIL: usize = RATE + 1;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorDrift<T> {
    /// Change of the zero per second, N/s.
    pub rate_n_per_s: T,
    /// End of the drift, s; 0 for never.
    pub until_s: T,
}

impl<T: Scalar> SensorDrift<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { rate_n_per_s: value(RATE), until_s: value(UNTIL) }
    }

    /// Returns the true force for the one shown (N) at a time (s) since the start.
    #[inline(always)]
    pub fn undo(&self, shown_n: T, time_s: T) -> T {
        shown_n - self.rate_n_per_s * drifting_s(time_s, self.until_s)
    }
}
