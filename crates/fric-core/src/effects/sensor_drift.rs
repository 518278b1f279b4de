//! `sensor_drift`: a force sensor whose zero moves with time.
//!
//! Equation: `F_shown = F_s + rate_n_per_s·t`, t from the start of the run, in the newtons that the sensor shows. Neutral: 0.
//!
//! Cause: the load cell or its amplifier warms up.

use super::{Acting, EffectRow, first_place};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "a long run with the same poses at its beginning and its end";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "sensor_drift",
    cause: "the zero of the force sensor or its amplifier moves with temperature",
    remedy: "let the amplifier warm up before taring, or tare more often",
    parameters: &[ParameterRow {
        key: "rate_n_per_s",
        unit: "N/s",
        neutral: 0.0,
        min: -1e3,
        max: 1e3,
        fitted: true,
        excitation: EXCITATION,
    }],
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Acting::only(ROW.kind);
/// Place of `rate_n_per_s` in [`Values`](crate::parameters::Values).
pub const RATE: usize = first_place(ROW.kind);

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorDrift<T> {
    /// Change of the zero per second, N/s.
    pub rate_n_per_s: T,
}

impl<T: Scalar> SensorDrift<T> {
    /// From a cable's parameter values, by their place.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { rate_n_per_s: value(RATE) }
    }

    /// The force there is for the one shown (N) at a time (s) since the start.
    #[inline(always)]
    pub fn undo(&self, shown_n: T, time_s: T) -> T {
        shown_n - self.rate_n_per_s.scale(time_s)
    }
}
