//! `sensor_lag`: a force sensor with a lag.
//!
//! Equation: `F_shown ← F_shown + (Δt/time_constant)·(F_s − F_shown)` in each cycle, the first-order low-pass filter as amplifiers compute it. It is
//! undone exactly by `F_s = F_shown,before + (time_constant/Δt)·(F_shown − F_shown,before)`. This multiplies noise that enters after the filter by up
//! to twice the time constant in cycles. The result is therefore smoothed by two low-pass filters of `smoothing_s` in series, `F = 2F_1 − F_2`
//! (Brown's double exponential smoothing), which add no delay; the noise gain stays below about `2·time_constant/smoothing`. The discovery uses no
//! smoothing, because noise that enters before the filter, as most does, needs none. A time constant of less than a cycle is no lag. Neutral:
//! `time_constant_s = 0`, whatever `smoothing_s`.
//!
//! Cause: the filter of the amplifier, or of its converter.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "forces that change fast: strokes at high acceleration, small movements that reverse";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "sensor_lag",
    cause: "the filter of the amplifier lets the force follow late",
    remedy: "set the filter of the amplifier to a higher corner frequency; its noise is better filtered behind the compensation",
    parameters: &[
        ParameterRow::fitted("time_constant_s", "s", [0.0, 0.0, 1.0], EXCITATION),
        ParameterRow::setting("smoothing_s", "s", [0.0, 0.0, 1.0], EXCITATION),
    ],
    example: &[0.004, 0.002],
    memory: Memory::OfTension(3),
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::SensorLag.acts();
/// Index of `time_constant_s` in [`Values`](crate::parameters::Values).
pub const TIME_CONSTANT: usize = Effect::SensorLag.first_place();
/// Index of `smoothing_s`.
pub const SMOOTHING: usize = TIME_CONSTANT + 1;

/// Indices of its state: the force shown in the previous cycle, and the outputs of the two low-pass filters of the corrected force, N.
pub(crate) const FORCES: [usize; 3] = {
    let first = Effect::SensorLag.memory_places().start;
    [first, first + 1, first + 2]
};

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorLag<T> {
    /// Time constant of the lag, s.
    pub time_constant_s: T,
    /// Time constant of the smoothing filters, s.
    pub smoothing_s: T,
}

/// Number of time constants after which two low-pass filters in series have decayed to `10⁻¹²`: `x·e^{−x}`.
const FORGOTTEN: f64 = 31.0;

impl<T: Scalar> SensorLag<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { time_constant_s: value(TIME_CONSTANT), smoothing_s: value(SMOOTHING) }
    }

    /// Returns the fraction of a force change that shows in its own cycle, as far as the smoothing does not remove it again.
    pub fn shown_ratio(&self, cycle_s: T) -> T {
        let one = T::splat(1.0);
        let smoothed = one - self.smoothing(cycle_s);
        (one / (self.sharpening(cycle_s) * (one - smoothed * smoothed))).min(one)
    }

    /// Returns the number of cycles after which earlier sensor signals are forgotten, whatever they were: to less than `10⁻¹²`, through two low-pass
    /// filters in series. It includes the first cycle with a force that is right again, so that this one is still reviewed.
    pub fn recovery_cycles(&self, cycle_s: T) -> T {
        let lags = T::splat(0.0).lt(self.time_constant_s);
        (T::splat(FORGOTTEN) * self.smoothing_s / cycle_s + T::splat(2.0)).keep(lags)
    }

    /// Returns the time constant in cycles, at least one.
    #[inline(always)]
    fn sharpening(&self, step_s: T) -> T {
        (self.time_constant_s / step_s).max(T::splat(1.0))
    }

    /// Returns the update fraction of a low-pass filter per cycle, 0…1.
    #[inline(always)]
    fn smoothing(&self, step_s: T) -> T {
        step_s / self.smoothing_s.max(step_s)
    }

    /// Returns the true force for the one shown, N, and the new state. `memory` is the previous state, [`UNKNOWN`] at the start of a run.
    #[inline(never)]
    pub fn undo(&self, shown_n: T, memory: [T; 3], step_s: T) -> (T, [T; 3]) {
        let known = memory[0].lt(T::splat(UNKNOWN));
        let [last_n, once_n, twice_n] = memory.map(|force_n| T::select(known, force_n, shown_n));
        let sharp_n = last_n + self.sharpening(step_s) * (shown_n - last_n);
        let share = self.smoothing(step_s);
        let once_n = once_n + share * (sharp_n - once_n);
        let twice_n = twice_n + share * (once_n - twice_n);
        let lags = T::splat(0.0).lt(self.time_constant_s);
        (T::select(lags, once_n + (once_n - twice_n), shown_n), [shown_n, once_n, twice_n])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the greatest difference between the corrected sensor signal and the force over cycles of 1 ms, after the first.
    fn worst_n(smoothing_s: f64, force_n: impl Fn(f64) -> f64) -> f64 {
        let lag = SensorLag { time_constant_s: 4e-3, smoothing_s };
        let (mut shown_n, mut memory, mut worst_n) = (force_n(0.0), [UNKNOWN; 3], 0.0_f64);
        for cycle in 0..2000 {
            let time_s = 1e-3 * f64::from(cycle);
            shown_n += 0.25 * (force_n(time_s) - shown_n);
            let (found_n, next) = lag.undo(shown_n, memory, 1e-3);
            memory = next;
            if cycle > 200 {
                worst_n = worst_n.max((found_n - force_n(time_s)).abs());
            }
        }
        worst_n
    }

    #[test]
    fn a_lag_without_noise_is_undone_exactly_and_a_ramp_behind_the_smoothing_too() {
        assert!(worst_n(0.0, |time_s| 20.0 + 5.0 * (20.0 * time_s).sin()) < 1e-9);
        assert!(worst_n(3e-3, |time_s| 20.0 + 50.0 * time_s) < 1e-9);
        // The error of the smoothing is `T²·F''` apart from the cycle: 20 rad/s, 5 N.
        let bent_n = worst_n(3e-3, |time_s| 20.0 + 5.0 * (20.0 * time_s).sin());
        assert!(bent_n < 1.2 * 9e-6 * 400.0 * 5.0, "{bent_n}");
    }

    #[test]
    fn the_gain_on_noise_is_bounded_and_a_change_of_one_cycle_shows_as_stated() {
        for (smoothing_s, most) in [(0.0, 8.0), (2e-3, 4.0), (4e-3, 2.0)] {
            let lag = SensorLag { time_constant_s: 4e-3, smoothing_s };
            let (mut memory, mut greatest_n) = ([0.0; 3], 0.0_f64);
            for cycle in 0..100 {
                let (found_n, next) = lag.undo(if cycle % 2 == 0 { 1.0 } else { -1.0 }, memory, 1e-3);
                memory = next;
                greatest_n = greatest_n.max(if cycle > 50 { found_n.abs() } else { 0.0 });
            }
            assert!(greatest_n <= most, "{smoothing_s}: {greatest_n}");
            let (jumped_n, _) = lag.undo(1.0, [0.0; 3], 1e-3);
            assert!((jumped_n * lag.shown_ratio(1e-3) - 1.0).abs() < 1e-12, "{smoothing_s}: {jumped_n}");
        }
    }
}
