//! `time_delay`: the motion known to the control is ahead of the cable's.
//!
//! Equation: displacement and speed at `t` are those of `t − delay_s`, interpolated linearly between cycles. A negative delay means that the motion
//! is known too late, by `τ = −delay_s`: it is extrapolated by the parabola through its values now, τ ago, and 2τ ago,
//!
//! ```text
//! x(t + τ) ≈ 3·x(t) − 3·x(t − τ) + x(t − 2τ)
//! ```
//!
//! for the position and for the speed. Values between two cycles are interpolated linearly. For a lead below one cycle, `u = τ/dt < 1`, it is the parabola
//! through the last three cycles instead, whose derivative by τ has no jump there:
//!
//! ```text
//! x(t + τ) ≈ x(t) + u·(3·x(t) − 4·x(t − dt) + x(t − 2dt))/2 + u²·(x(t) − 2·x(t − dt) + x(t − 2dt))/2
//! ```
//!
//! A constant acceleration is followed exactly. The remaining error of a position is its third derivative times
//! τ³, below one cycle times dt³, and noise is multiplied by at most √19, whatever the lead (an extrapolation from the last cycles alone would multiply
//! it by `1 + 2τ/dt` and more). Neutral: `delay_s = 0`.
//!
//! The friction state follows the motion that is known. The output force is that of a step ahead from this state, to the end of the parabola; the
//! stored state does not take this step. So a parabola that continues after the end of a motion releases no friction, and its effect vanishes as soon
//! as the end is known. The extrapolation never runs against the known motion, or while that rests, because it is about to be wrong there.
//!
//! After a cycle with invalid motion, or a pause, the change from one cycle to the next is not a measured motion. The extrapolation pauses until all
//! points of the parabola are valid.
//!
//! Cause: set points are used while the drive still follows (\[P\], section IV A), or the two signals take different paths through the bus. Deviation
//! from the paper: the set points are shifted, not the friction computed from them, so that the friction belongs to the present force.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN};
use crate::numbers::lanes::LANES;
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;
use crate::signals::CableSignals;

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "time_delay",
    cause: "motion and force signal are not of the same time: the motion is known too early (set points), or too late where the delay is negative",
    remedy: "keep the delay compensated, or bring both signals to the same time: delay the one that comes early",
    parameters: &[ParameterRow::fitted(
        "delay_s",
        "s",
        [-1.0, 0.0, 1.0],
        "quick reversals: strokes there and back without breaks",
    )],
    example: &[0.0083],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::TimeDelay.acts();
/// Index of `delay_s` in [`Values`](crate::parameters::Values).
pub const DELAY: usize = Effect::TimeDelay.first_place();

/// Maximum delay, in cycles; it determines the size of a [`Compensator`](crate::Compensator).
pub const MAX_DELAY_CYCLES: usize = 64;

/// Maximum lead, in cycles.
pub const MAX_LEAD_CYCLES: usize = 20;

/// Returns the least and the greatest delay at a cycle time, s.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "small constants")]
pub fn delay_range_s(cycle_s: f64) -> (f64, f64) {
    (-(MAX_LEAD_CYCLES as f64) * cycle_s, (MAX_DELAY_CYCLES - 1) as f64 * cycle_s)
}

/// A delay, divided into whole cycles and fractions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay {
    taps: Taps,
    fractions: [f64; 2],
}

impl Delay {
    /// No delay.
    pub const NONE: Self = Self { taps: Taps::NONE, fractions: [0.0; 2] };

    /// Whether it is a lead.
    pub(crate) const fn leads(self) -> bool {
        self.taps.leads
    }

    /// Creates a delay from cycles, limited to `−MAX_LEAD_CYCLES…MAX_DELAY_CYCLES − 1`.
    #[must_use]
    pub fn from_cycles(cycles: f64) -> Self {
        let taps = Taps::of_cycles(cycles);
        Self { taps, fractions: fractions(cycles, |_| taps) }
    }
}

/// The values of a [`DelayLine`] that a delay needs, by age: those around `t − delay_s`; for a lead those around `t − τ` and `t − 2τ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Taps {
    /// Whole cycles; the second entry is used only by a lead.
    ages: [usize; 2],
    leads: bool,
}

impl Taps {
    /// Whether they belong to a lead.
    pub(crate) const fn leads(self) -> bool {
        self.leads
    }

    const NONE: Self = Self { ages: [0; 2], leads: false };

    /// Returns the taps of a delay in cycles.
    pub(crate) fn of_cycles(cycles: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded by `ages`")]
        let ages = ages(cycles).map(|age| libm::floor(age) as usize);
        Self { ages, leads: cycles < 0.0 }
    }

    /// Whether they belong to a lead below one cycle, which uses the last three values.
    fn are_last(self) -> bool {
        self.leads && self.ages[0] == 0
    }

    /// Returns the age of the oldest value that they use.
    fn oldest(self) -> usize {
        if self.are_last() { 2 } else { self.ages[1] + 1 }
    }
}

/// Returns the ages of the values that a delay needs, in cycles; the second is used only by a lead.
fn ages<T: Scalar>(cycles: T) -> [T; 2] {
    let (earliest, longest) = delay_range_s(1.0);
    let age = cycles.max(T::splat(earliest)).min(T::splat(longest)).abs();
    [age, age + age]
}

/// Returns the fractions of the ages beyond the whole cycles of each lane's taps; for a lead below one cycle the lead in cycles and its square.
pub(crate) fn fractions<T: Scalar>(cycles: T, taps: impl Fn(usize) -> Taps) -> [T; 2] {
    let [once, twice] = ages(cycles);
    #[expect(clippy::cast_precision_loss, reason = "at most twice MAX_DELAY_CYCLES")]
    let whole = |which: usize| T::from_lanes(|lane| taps(lane).ages[which] as f64);
    let are_last = T::splat(0.0).lt(T::from_lanes(|lane| f64::from(taps(lane).are_last())));
    [once - whole(0), T::select(are_last, once * once, twice - whole(1))]
}

/// The last [`MAX_DELAY_CYCLES`] values of one signal, the newest at index `newest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayLine {
    values: [f64; MAX_DELAY_CYCLES],
    newest: usize,
    /// Number of consecutive valid cycles up to now, as far as there are values.
    in_order: usize,
}

impl crate::words::Words for DelayLine {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        let Self { values, newest, in_order } = self;
        values.each_word(show);
        for count in [&mut *newest, in_order] {
            let mut word = *count as u64;
            show(&mut word);
            // Limited to the number of values, whatever the word is.
            *count = usize::try_from(word).unwrap_or(0).min(MAX_DELAY_CYCLES);
        }
        *newest %= MAX_DELAY_CYCLES;
    }
}

impl DelayLine {
    /// A line filled with zeros: nothing moved before the start.
    pub const EMPTY: Self = Self { values: [0.0; MAX_DELAY_CYCLES], newest: 0, in_order: 0 };

    /// A line that the first value fills: the value was the same before it was known.
    pub(crate) const UNFILLED: Self = Self { values: [UNKNOWN; MAX_DELAY_CYCLES], newest: 0, in_order: 0 };

    /// Stores this cycle's value and returns the delayed one. `in_order` says that the value is valid and one cycle younger than the one before it.
    ///
    /// ```
    /// use fric_core::effects::time_delay::{Delay, DelayLine};
    /// let shifted = |cycles, values: [f64; 6]| {
    ///     let mut line = DelayLine::EMPTY;
    ///     values.map(|value| line.shift(value, true, Delay::from_cycles(cycles)))
    /// };
    /// assert_eq!(shifted(1.5, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]), [0.0, 0.0, 0.5, 1.5, 2.5, 3.5]);
    /// // The squares: what led them is known from the fifth cycle on.
    /// assert_eq!(shifted(-1.0, [0.0, 1.0, 4.0, 9.0, 16.0, 25.0]), [0.0, 1.0, 4.0, 9.0, 25.0, 36.0]);
    /// ```
    #[inline]
    pub fn shift(&mut self, value: f64, in_order: bool, delay: Delay) -> f64 {
        self.push(value, in_order);
        self.about(delay.taps).at(delay.fractions)
    }

    /// Stores this cycle's value.
    #[inline]
    pub(crate) fn push(&mut self, value: f64, in_order: bool) {
        self.in_order = if in_order { (self.in_order + 1).min(MAX_DELAY_CYCLES) } else { 0 };
        if self.values.first().is_some_and(|first| first.to_bits() == UNKNOWN.to_bits()) {
            self.values.fill(value);
        }
        self.newest = (self.newest + 1) % MAX_DELAY_CYCLES;
        if let Some(place) = self.values.get_mut(self.newest) {
            *place = value;
        }
    }

    /// Returns how far the sum of all delayed values lags behind that of all values; 0 for a lead, which delays none.
    pub(crate) fn lag(&self, delay: Delay) -> f64 {
        if delay.leads() {
            0.0
        } else {
            About { value: self.since(delay.taps.ages[0]), slopes: [self.at(delay.taps.ages[0]), 0.0] }
                .at(delay.fractions)
        }
    }

    /// Returns how far a lead is ahead of the sum of all values.
    pub(crate) fn lead(&self, delay: Delay) -> f64 {
        self.about_lead(delay.taps).at(delay.fractions)
    }

    /// Returns the same for whole cycles, and its derivatives with respect to the fractions; zero for a delay.
    pub(crate) fn about_lead(&self, taps: Taps) -> About {
        if !taps.leads || self.stands(taps) {
            return About::default();
        }
        if taps.are_last() {
            let [now, before] = [0, 1].map(|age| self.at(age));
            return About { value: 0.0, slopes: [0.5 * (3.0 * now - before), 0.5 * (now - before)] };
        }
        let [once, twice] = taps.ages;
        About { value: 3.0 * self.since(once) - self.since(twice), slopes: [3.0 * self.at(once), -self.at(twice)] }
    }

    /// Returns the sum of the last `age` values.
    fn since(&self, age: usize) -> f64 {
        (0..age.min(MAX_DELAY_CYCLES - 1)).map(|age| self.at(age)).sum()
    }

    /// Returns the delayed value for whole cycles, and its derivatives with respect to the fractions.
    #[inline]
    pub(crate) fn about(&self, taps: Taps) -> About {
        let newest = self.at(0);
        if self.stands(taps) {
            return About { value: newest, slopes: [0.0; 2] };
        }
        if taps.are_last() {
            let [once, twice] = [1, 2].map(|age| self.at(age));
            let slopes = [0.5 * (3.0 * newest - 4.0 * once + twice), 0.5 * (newest - 2.0 * once + twice)];
            return About { value: newest, slopes };
        }
        let [[once, before_once], [twice, before_twice]] = taps.ages.map(|age| [self.at(age), self.at(age + 1)]);
        if taps.leads {
            let slopes = [3.0 * (once - before_once), before_twice - twice];
            About { value: 3.0 * (newest - once) + twice, slopes }
        } else {
            About { value: once, slopes: [before_once - once, 0.0] }
        }
    }

    /// Whether a lead would use invalid values, or the first valid one, which may contain the change of several cycles.
    #[inline]
    fn stands(&self, taps: Taps) -> bool {
        taps.leads && self.in_order < taps.oldest() + 2
    }

    /// Returns the value `age` cycles ago; the oldest one beyond that.
    #[inline]
    fn at(&self, age: usize) -> f64 {
        let place = (self.newest + MAX_DELAY_CYCLES - age.min(MAX_DELAY_CYCLES - 1)) % MAX_DELAY_CYCLES;
        self.values.get(place).copied().unwrap_or(0.0)
    }
}

/// The motion of a cycle as used by the friction.
pub(crate) struct Shifted<T> {
    /// Displacement of the stored friction, m.
    pub displacement_m: T,
    /// Speed, m/s.
    pub speed_m_per_s: T,
    /// Lag of the displacement behind the known motion, m.
    pub lag_m: T,
    /// Lead of the cable ahead of it, m.
    pub lead_m: T,
}

impl<T: Scalar> Shifted<T> {
    /// Creates the motion from the `known` displacement and speed and the values from the delay lines, `lag_m` behind in the previous cycle; then
    /// which lanes lead, and the displacement of the parabola.
    #[inline]
    pub fn new(known: [T; 2], by_lines: [T; 2], lag_m: T, (leads, parabola_m): (T::Mask, T)) -> Self {
        let ([known_m, known_m_per_s], [displacement_m, speed_m_per_s]) = (known, by_lines);
        let displacement_m = T::select(leads, known_m, displacement_m);
        let speed_m_per_s = T::select(leads, never_against(known_m_per_s, speed_m_per_s), speed_m_per_s);
        let lead_m = never_against(known_m, parabola_m).keep(leads);
        Self { displacement_m, speed_m_per_s, lag_m: lag_m + (known_m - displacement_m), lead_m }
    }

    /// Replaces the known motion in the signals.
    #[inline]
    pub fn enter(self, signals: &mut CableSignals<T>) {
        signals.displacement_m = self.displacement_m;
        signals.speed_m_per_s = self.speed_m_per_s;
        signals.lead_m = self.lead_m;
        signals.length_m = signals.length_m - self.lag_m + self.lead_m;
    }
}

/// Returns the extrapolated motion `led`, limited to the direction of the `known` one.
#[inline]
fn never_against<T: Scalar>(known: T, led: T) -> T {
    let direction = known.sign();
    led.scale(direction).max(T::splat(0.0)).scale(direction)
}

/// A delayed value for whole cycles, and its derivatives with respect to the [`fractions`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct About {
    value: f64,
    slopes: [f64; 2],
}

impl About {
    fn at(self, [once, twice]: [f64; 2]) -> f64 {
        let [of_once, of_twice] = self.slopes;
        self.value + of_once * once + of_twice * twice
    }

    /// Returns the values of all lanes.
    pub(crate) fn of_lanes<T: Scalar>(lanes: &[Self; LANES], [once, twice]: [T; 2]) -> T {
        let number = |of: fn(&Self) -> f64| T::from_lanes(|lane| of(&lanes[lane % LANES]));
        number(|about| about.value) + number(|about| about.slopes[0]) * once + number(|about| about.slopes[1]) * twice
    }
}

#[cfg(test)]
mod tests {
    use super::{Delay, DelayLine};

    /// The sum of what a lead returns is ahead of the sum of what it was given: below one cycle by the last values, beyond by those of its taps.
    #[test]
    fn a_lead_is_ahead_by_the_sum_of_what_it_added() {
        for lead_cycles in [0.3, 0.99, 1.0, 4.6, 20.0] {
            let (mut line, delay) = (DelayLine::EMPTY, Delay::from_cycles(-lead_cycles));
            let (mut given, mut led) = (0.0, 0.0);
            for cycle in 0_u8..150 {
                // At rest at first, as every line begins.
                let value = if cycle < 60 { 0.0 } else { (0.2 * f64::from(cycle)).sin() };
                given += value;
                led += line.shift(value, true, delay);
                assert!((line.lead(delay) - (led - given)).abs() < 1e-10, "{lead_cycles} cycles, cycle {cycle}");
            }
        }
    }
}
