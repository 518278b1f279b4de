//! `time_delay`: the motion that the control knows runs ahead of the cable's.
//!
//! Equation: displacement and speed at `t` are those of `t − delay_s`; between cycles they are interpolated linearly. A
//! negative delay is motion that is known too late: it is extrapolated by its last change,
//! `x(t + τ) ≈ x + (x − x_before)·τ/dt`, which is wrong by its second derivative times τ²/2, and multiplies the noise of both
//! signals by `1 + 2τ/dt`. Neutral: `delay_s = 0`.
//!
//! After a cycle without motion to be believed, or a pause, the change from one cycle to the next is not the motion's:
//! nothing is extrapolated until three cycles have been in order.
//!
//! Cause: set points are used where the drive still follows (\[P\], section IV A), or the two signals take different ways
//! through the bus. Deviation from the paper: the set points are shifted, not the friction computed from them, so that
//! the friction is that of the present force.

use super::{Acting, EffectRow, first_place};
use crate::cable::UNKNOWN;
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
        min: -1.0,
        max: 1.0,
        fitted: true,
        excitation: "quick reversals: strokes there and back without breaks",
    }],
};

/// The effect by itself, to ask whether it acts.
pub(crate) const ACTS: Acting = Acting::only(ROW.kind);
/// Place of `delay_s` in [`Values`](crate::parameters::Values).
pub const DELAY: usize = first_place(ROW.kind);

/// The longest delay, in cycles; part of the size of a [`Compensator`](crate::Compensator).
pub const MAX_DELAY_CYCLES: usize = 64;

/// The longest lead, in cycles.
pub const MAX_LEAD_CYCLES: usize = 20;

/// Cycles in order before anything is extrapolated: the first of them may have made up for others.
const BELIEVED: usize = 3;

/// Least and greatest delay at a cycle time, s.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "small constants")]
pub fn delay_range_s(cycle_s: f64) -> (f64, f64) {
    (-(MAX_LEAD_CYCLES as f64) * cycle_s, (MAX_DELAY_CYCLES - 1) as f64 * cycle_s)
}

/// A delay as whole cycles and the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Delay<T = f64> {
    /// Whole cycles, less than [`MAX_DELAY_CYCLES`].
    pub cycles: usize,
    /// The rest, 0…1; below 0 a lead in cycles.
    pub fraction: T,
    /// Whether it is a lead.
    pub leads: bool,
}

impl<T: Scalar> Delay<T> {
    /// A delay in cycles, of which `value` is the number itself; held within `−MAX_LEAD_CYCLES…MAX_DELAY_CYCLES − 1`.
    #[must_use]
    pub fn from_cycles(cycles: T, value: f64) -> Self {
        let (earliest, longest) = delay_range_s(1.0);
        let whole = libm::floor(Scalar::min(Scalar::max(value, 0.0), longest));
        let fraction = cycles.max(T::splat(earliest)).min(T::splat(longest)) - T::splat(whole);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded above")]
        Self { cycles: whole as usize, fraction, leads: value < 0.0 }
    }
}

/// The last [`MAX_DELAY_CYCLES`] values of one signal, newest at `newest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayLine {
    values: [f64; MAX_DELAY_CYCLES],
    newest: usize,
    /// Cycles in order up to now, no further than [`BELIEVED`].
    in_order: usize,
}

impl DelayLine {
    /// A line filled with zeros: before the start nothing moved.
    pub const EMPTY: Self = Self { values: [0.0; MAX_DELAY_CYCLES], newest: 0, in_order: 0 };

    /// A line that the first value fills: before it was known, it was as it is.
    pub(crate) const UNFILLED: Self = Self { values: [UNKNOWN; MAX_DELAY_CYCLES], newest: 0, in_order: 0 };

    /// Takes in this cycle's value and gives the delayed one. `in_order` says that the value is believed, and one cycle
    /// younger than the one before it.
    ///
    /// ```
    /// use fric_core::effects::time_delay::{Delay, DelayLine};
    /// let shifted = |cycles| {
    ///     let mut line = DelayLine::EMPTY;
    ///     [0.0, 1.0, 2.0, 3.0].map(|value| line.shift(value, true, Delay::from_cycles(cycles, cycles)))
    /// };
    /// assert_eq!(shifted(1.5), [0.0, 0.0, 0.5, 1.5]);
    /// assert_eq!(shifted(-1.5), [0.0, 1.0, 3.5, 4.5]);
    /// ```
    #[inline]
    pub fn shift(&mut self, value: f64, in_order: bool, delay: Delay) -> f64 {
        self.push(value, in_order);
        let [at, before] = self.around(delay.cycles, delay.leads);
        at + delay.fraction * (before - at)
    }

    /// Takes in this cycle's value.
    #[inline]
    pub(crate) fn push(&mut self, value: f64, in_order: bool) {
        self.in_order = if in_order { (self.in_order + 1).min(BELIEVED) } else { 0 };
        if self.values.first().is_some_and(|first| first.to_bits() == UNKNOWN.to_bits()) {
            self.values.fill(value);
        }
        self.newest = (self.newest + 1) % MAX_DELAY_CYCLES;
        if let Some(place) = self.values.get_mut(self.newest) {
            *place = value;
        }
    }

    /// Whether so many cycles have been in order that a lead extrapolates.
    #[inline]
    pub(crate) fn is_believed(&self) -> bool {
        self.in_order >= BELIEVED
    }

    /// How far the sum of all delayed values lags behind that of all values.
    pub(crate) fn lag(&self, delay: Delay) -> f64 {
        let between: f64 = (0..delay.cycles.min(MAX_DELAY_CYCLES - 1)).map(|age| self.around(age, false)[0]).sum();
        let [at, _] = self.around(delay.cycles, delay.leads);
        let stands = delay.leads && !self.is_believed();
        if stands { between } else { between + delay.fraction * at }
    }

    /// The value so many cycles ago, and the one before it; for a lead that would not be in order, the first twice.
    #[inline]
    pub(crate) fn around(&self, cycles: usize, leads: bool) -> [f64; 2] {
        let cycles = cycles.min(MAX_DELAY_CYCLES - 1);
        let stands = leads && !self.is_believed();
        [cycles, cycles + usize::from(!stands)].map(|age| {
            let place = (self.newest + MAX_DELAY_CYCLES - age % MAX_DELAY_CYCLES) % MAX_DELAY_CYCLES;
            self.values.get(place).copied().unwrap_or(0.0)
        })
    }
}
