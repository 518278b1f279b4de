//! Ripples: the common form of several effects that are periodic in the cable's length.
//!
//! A ripple has two amplitudes, of the sine and of the cosine, and a period. The zero of the length determines the phase: a length that starts anew
//! with each run needs its own amplitudes. An identification finds the amplitudes from any start. It finds the period only from a start that is right
//! to a fraction of a revolution over the whole range, for instance from a scan of the residual.
//!
//! A cable can have two ripples of each kind, with different periods: a motor cogs 14 and 28 times a turn, two pulleys run out of true.

use super::{Acting, Effect, UNKNOWN};
use crate::parameters::{ParameterRow, Values};
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
        ParameterRow::fitted(sin, unit, [-most, 0.0, most], excitation),
        ParameterRow::fitted(cos, unit, [-most, 0.0, most], excitation),
        ParameterRow::setting(PERIOD_KEY, "m", [1e-4, 0.1, 100.0], excitation),
    ]
}

/// Returns the amplitude of a ripple from the values of its parameters in order.
pub(super) fn amplitude(values: &[f64]) -> f64 {
    let [sin, cos, ..] = values else { return 0.0 };
    libm::hypot(*sin, *cos)
}

/// Ripples whose periods differ by less than this ratio are one: they part by half a beat only over 50 periods. At half the ratio, a cable that turns a
/// motor or a pulley some dozens of times does not determine both; at twice the ratio, pulleys that differ by 2 % in size could not be described.
const SAME_PERIOD_RATIO: f64 = 0.01;

/// Whether an effect is a second ripple with nearly the period of the first, so that no log can tell them apart; not if one of them does nothing.
#[must_use]
pub fn repeats_first(effect: Effect, values: &Values) -> bool {
    let Some(first) = effect.first() else { return false };
    let both = [first, effect].map(|effect| values.get(effect.places()).unwrap_or_default());
    let ([.., one_m], [.., other_m]) = (both[0], both[1]) else { return false };
    both.iter().all(|values| amplitude(values) > 0.0)
        && (one_m - other_m).abs() < SAME_PERIOD_RATIO * one_m.max(*other_m)
}

/// The two ripples of a kind that a cable can have: each as a set of one, and the index of its first parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ripples([(Acting, usize); 2]);

impl Ripples {
    pub(super) const fn of([one, other]: [Effect; 2]) -> Self {
        Self([(one.acts(), one.first_place()), (other.acts(), other.first_place())])
    }

    /// Returns both as a set, to test whether any acts.
    pub(crate) const fn acts(self) -> Acting {
        let Self([(one, _), (other, _)]) = self;
        one.and(other)
    }

    /// Applies those that act, from a cable's parameter values by index, to a number one after the other.
    #[inline(always)]
    pub(crate) fn apply<T: Scalar>(
        self,
        acting: Acting,
        value: impl Fn(usize) -> T,
        number: T,
        apply: impl Fn(T, Ripple<T>) -> T,
    ) -> T {
        let Self([(one, of_one), (other, of_other)]) = self;
        let mut number = number;
        if acting.has(one) {
            number = apply(number, Ripple::of(of_one, &value));
        }
        if acting.has(other) {
            seldom();
            number = apply(number, Ripple::of(of_other, &value));
        }
        number
    }
}

/// Tells the compiler that cycles seldom come by, so that they alone pay for it.
#[cold]
#[inline(never)]
fn seldom() {}

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
