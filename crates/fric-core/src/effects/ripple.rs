//! What goes up and down with the cable's length: the form that several effects have in common.
//!
//! Two amplitudes, of the sine and of the cosine, and the period. The zero of the length decides what is sine and what cosine: a length that starts anew
//! with each run needs its own. An identification finds the amplitudes from anywhere; the period only from a start that is right to a fraction of
//! a turn over the whole way, such as a scan of the residual gives.

use super::UNKNOWN;
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

/// Key of the period, which each of these effects has at its third place.
pub const PERIOD_KEY: &str = "period_m";

/// The parameters of a ripple whose amplitudes, called so, are at most `most` of a unit.
pub(super) const fn rows(
    [sin, cos]: [&'static str; 2],
    unit: &'static str,
    most: f64,
    excitation: &'static str,
) -> [ParameterRow; 3] {
    [
        ParameterRow { key: sin, unit, neutral: 0.0, min: -most, max: most, fitted: true, excitation },
        ParameterRow { key: cos, unit, neutral: 0.0, min: -most, max: most, fitted: true, excitation },
        ParameterRow { key: PERIOD_KEY, unit: "m", neutral: 0.1, min: 1e-4, max: 100.0, fitted: false, excitation },
    ]
}

/// The amplitude of a ripple by the values of its parameters in order.
pub(super) fn amplitude(values: &[f64]) -> f64 {
    let [sin, cos, ..] = values else { return 0.0 };
    libm::hypot(*sin, *cos)
}

/// A ripple; its amplitudes are of any unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple<T> {
    /// Amplitude of the sine.
    pub sin: T,
    /// Amplitude of the cosine.
    pub cos: T,
    /// Cable length of one period, m.
    pub period_m: T,
}

impl<T: Scalar> Ripple<T> {
    /// From a cable's parameter values by their place, the first of which is this.
    #[inline(always)]
    pub fn of(first: usize, value: impl Fn(usize) -> T) -> Self {
        Self { sin: value(first), cos: value(first + 1), period_m: value(first + 2) }
    }

    /// A number and the ripple at a cable length (m); the number alone where that is [`UNKNOWN`], before the first.
    #[inline(never)]
    pub fn added_to(&self, number: T, length_m: T) -> T {
        let known = length_m.lt(T::splat(UNKNOWN));
        let [sin, cos] = (length_m.keep(known) / self.period_m).sin_cos_turns();
        T::select(known, number + self.sin * sin + self.cos * cos, number)
    }
}
