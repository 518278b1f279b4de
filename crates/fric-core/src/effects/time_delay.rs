//! `time_delay`: the motion that the control knows runs ahead of the cable's.
//!
//! Equation: displacement and speed at `t` are those of `t − delay_s`; between cycles they are interpolated linearly.
//! Neutral: `delay_s = 0`.
//!
//! Cause: set points are used where the drive still follows (\[P\], section IV A), or the two signals take different ways
//! through the bus. Deviation from the paper: the set points are shifted, not the friction computed from them, so that
//! the friction is that of the present force.

use super::{EffectRow, first_place};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "time_delay",
    cause: "the winch motion is known earlier than the cable moves: set points, or a longer way of the force signal",
    remedy: "keep the delay compensated, or bring both signals to the same time: the set points delayed by the drive's lag",
    parameters: &[ParameterRow {
        key: "delay_s",
        unit: "s",
        neutral: 0.0,
        min: 0.0,
        max: 1.0,
        excitation: "quick reversals: strokes there and back without breaks",
    }],
};

/// Place of `delay_s` in [`Values`](crate::parameters::Values).
pub const DELAY: usize = first_place(ROW.kind);

/// The longest delay, in cycles; part of the size of a [`Compensator`](crate::Compensator).
pub const MAX_DELAY_CYCLES: usize = 64;

/// A delay as whole cycles and the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Delay<T = f64> {
    /// Whole cycles, less than [`MAX_DELAY_CYCLES`].
    pub cycles: usize,
    /// The rest, 0…1.
    pub fraction: T,
}

impl<T: Scalar> Delay<T> {
    /// A delay in cycles, of which `value` is the number itself; held within `0…MAX_DELAY_CYCLES − 1`.
    #[must_use]
    pub fn from_cycles(cycles: T, value: f64) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let longest = (MAX_DELAY_CYCLES - 1) as f64;
        let whole = libm::floor(Scalar::min(Scalar::max(value, 0.0), longest));
        let fraction = cycles.max(T::splat(0.0)).min(T::splat(longest)) - T::splat(whole);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded above")]
        Self { cycles: whole as usize, fraction }
    }
}

/// The last [`MAX_DELAY_CYCLES`] values of one signal, newest at `newest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayLine {
    values: [f64; MAX_DELAY_CYCLES],
    newest: usize,
}

impl DelayLine {
    /// A line filled with zeros: before the start nothing moved.
    pub const EMPTY: Self = Self { values: [0.0; MAX_DELAY_CYCLES], newest: 0 };

    /// Takes in this cycle's value and gives the delayed one.
    ///
    /// ```
    /// use fric_core::effects::time_delay::{Delay, DelayLine};
    /// let mut line = DelayLine::EMPTY;
    /// let delay = Delay::from_cycles(1.5, 1.5);
    /// let out: [f64; 4] = [0.0, 1.0, 2.0, 3.0].map(|value| line.shift(value, delay));
    /// assert_eq!(out, [0.0, 0.0, 0.5, 1.5]);
    /// ```
    #[inline]
    pub fn shift(&mut self, value: f64, delay: Delay) -> f64 {
        self.push(value);
        let [at, before] = self.around(delay.cycles);
        at + delay.fraction * (before - at)
    }

    /// Takes in this cycle's value.
    #[inline]
    pub(crate) fn push(&mut self, value: f64) {
        self.newest = (self.newest + 1) % MAX_DELAY_CYCLES;
        if let Some(place) = self.values.get_mut(self.newest) {
            *place = value;
        }
    }

    /// The value so many cycles ago, and the one before it.
    #[inline]
    pub(crate) fn around(&self, cycles: usize) -> [f64; 2] {
        let cycles = cycles.min(MAX_DELAY_CYCLES - 1);
        [cycles, cycles + 1].map(|age| {
            let place = (self.newest + MAX_DELAY_CYCLES - age % MAX_DELAY_CYCLES) % MAX_DELAY_CYCLES;
            self.values.get(place).copied().unwrap_or(0.0)
        })
    }
}
