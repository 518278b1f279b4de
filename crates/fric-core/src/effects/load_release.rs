//! `load_release`: a bearing that holds no more friction than its present load allows.
//!
//! Equation: before a cycle moves the stored friction `f` of a contact, it is limited to `± f_c/ratio`, where `f_c` is the sliding friction at the
//! present load. Dahl's law alone (\[P\] 16) stores friction until the cable moves: after a load drop at rest it keeps the friction of the higher
//! load. The data of a machine show which of the two applies. With `ratio = 1` a contact holds its sliding friction at the present load, with less it
//! holds more. Neutral: `ratio = 0`.
//!
//! Cause: the elastic contact slips back as the normal force falls.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "a load on the resting platform that rises and falls by a third and more";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "load_release",
    cause: "as the load on a resting pulley falls, its contact slips back until it holds what the lower load bears",
    remedy: "nothing is wrong with the machine: it is how its bearings hold friction; keep the term",
    parameters: &[ParameterRow::fitted("ratio", "1", [0.0, 0.0, 1.5], EXCITATION)],
    example: &[1.0],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::LoadRelease.acts();
/// Index of `ratio` in [`Values`](crate::parameters::Values).
pub const RATIO: usize = Effect::LoadRelease.first_place();

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadRelease<T> {
    /// Sliding friction divided by the greatest friction that a contact holds; 0 if it holds everything stored.
    pub ratio: T,
}

impl<T: Scalar> LoadRelease<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { ratio: value(RATIO) }
    }

    /// Returns the part of the stored friction that is held under a load with the sliding friction `sliding_n`, N. A value within the limit is
    /// unchanged, to the bit.
    #[inline(always)]
    pub fn held_n(&self, stored_n: T, sliding_n: T) -> T {
        let most_n = sliding_n.max(T::splat(0.0)) / self.ratio.max(T::splat(LEAST_RATIO));
        let is_beyond = sliding_n.max(T::splat(0.0)).lt(self.ratio * stored_n.abs());
        T::select(is_beyond, most_n * stored_n.sign(), stored_n)
    }
}

/// Least ratio; no contact holds a higher multiple of its sliding friction.
const LEAST_RATIO: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::LoadRelease;

    #[test]
    fn what_the_load_does_not_bear_is_given_back() {
        let held_n = |ratio, stored_n: f64, sliding_n| LoadRelease { ratio }.held_n(stored_n, sliding_n);
        for (ratio, stored_n, sliding_n, expected_n) in [
            (1.0, 0.8, 0.5, 0.5),
            (1.0, -0.8, 0.5, -0.5),
            (0.5, 0.9, 0.4, 0.8),
            (0.5, 0.7, 0.4, 0.7),
            (1.0, 0.3, 0.5, 0.3),
            (1.0, 0.3, -0.1, 0.0),
            (0.0, -0.8, 0.5, -0.8),
        ] {
            assert!((held_n(ratio, stored_n, sliding_n) - expected_n).abs() < 1e-15, "{ratio} {stored_n} {sliding_n}");
        }
        assert_eq!(held_n(0.0, -0.0, 0.5).to_bits(), (-0.0_f64).to_bits());
    }
}
