//! Ripples: the common form of several effects that are periodic in the cable's length.
//!
//! A ripple has two amplitudes, of the sine and of the cosine, and a period. The zero of the length determines the phase: a length that starts anew
//! with each run needs its own amplitudes. An identification finds the amplitudes from any start. It finds the period only from a start that is right
//! to a fraction of a revolution over the whole range, for instance from a scan of the residual.

use super::UNKNOWN;
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

/// Key of the period, which is the third parameter of each of these effects.
pub const PERIOD_KEY: &str = "period_m";

/// Returns the parameter rows of a ripple with these names for its amplitudes, which are at most `most`.
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

/// Returns the amplitude of a ripple from the values of its parameters in order.
pub(super) fn amplitude(values: &[f64]) -> f64 {
    let [sin, cos, ..] = values else { return 0.0 };
    libm::hypot(*sin, *cos)
}

/// A ripple, with amplitudes of any unit.
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
    /// Creates the ripple from a cable's parameter values by index, starting at `first`.
    #[inline(always)]
    pub fn of(first: usize, value: impl Fn(usize) -> T) -> Self {
        Self { sin: value(first), cos: value(first + 1), period_m: value(first + 2) }
    }

    /// Returns a number plus the ripple at a cable length (m); the number alone if the length is [`UNKNOWN`], before the first.
    #[inline(never)]
    pub fn added_to(&self, number: T, length_m: T) -> T {
        let known = length_m.lt(T::splat(UNKNOWN));
        let [sin, cos] = (length_m.keep(known) / self.period_m).sin_cos_turns();
        T::select(known, number + self.sin * sin + self.cos * cos, number)
    }
}
