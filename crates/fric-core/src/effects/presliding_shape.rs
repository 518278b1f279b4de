//! `presliding_shape`: the exponent of Dahl's law.
//!
//! Equation (\[P\] 16): `df/dx = σ·|u|^a·sgn u`, `u = 1 − s·f/f_c`, where a is the exponent. Exact over one step with `k = σ|Δl|/f_c`: `|u| ←
//! (|u|^(1−a) + (a−1)·k)^(1/(1−a))`, 0 if the bracket is not positive; the sign of u is kept. Neutral: `exponent = 1`, where it is the exponential of
//! [`dahl`](crate::dahl).
//!
//! The implementation is `u ← u·exp(−w·g(b·w))` with `b = a − 1`, `w = k·|u|^b` and `g(x) = ln(1 + x)/x`, which is equivalent and needs no special
//! case at `a = 1`. There `w = k` and `g = 1`, value and derivatives are right to rounding, and the value has the bits of
//! [`dahl_step`]. Below 1, sliding is reached after a finite distance, `k = |u|^(1−a)/(1−a)`.
//!
//! Cause: the asperities of the contact yield more abruptly (below 1) or more gradually (above 1) than in Dahl's simplest law.

use super::{Acting, Effect, EffectRow, Memory, OnMu};
use crate::dahl::{dahl_step, dahl_step_over};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "small movements that reverse: steps of 0.25 … 10 mm there and back, with breaks";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "presliding_shape",
    cause: "the contact gives way more abruptly, or more gradually, than in the simplest presliding law",
    remedy: "nothing is wrong with the machine: keep the exponent",
    parameters: &[ParameterRow::fitted("exponent", "1", [0.3, 1.0, 4.0], EXCITATION)],
    example: &[1.8],
    memory: Memory::Nothing,
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::PreslidingShape.acts();
/// Index of `exponent` in [`Values`](crate::parameters::Values).
pub const EXPONENT: usize = Effect::PreslidingShape.first_place();

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreslidingShape<T> {
    /// Exponent of the law, dimensionless.
    pub exponent: T,
}

impl<T: Scalar> PreslidingShape<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { exponent: value(EXPONENT) }
    }

    /// Returns the friction force after a displacement; see [`dahl_step`] for the arguments.
    #[inline(never)]
    pub fn step(&self, friction_n: T, sliding_n: T, sigma_n_per_m: T, displacement_m: T) -> T {
        dahl_step_over(friction_n, sliding_n, sigma_n_per_m, displacement_m, |way, left| {
            self.exponential_way(way, left)
        })
    }

    /// Returns the same for two states under one load, the lower at `f_c` and the other at `friction_n` beyond it: how far they are apart at most, for
    /// states at that distance anywhere within `±f_c`. The law's slope differs least between them where it is largest, at twice `f_c` from its target,
    /// by `n·2^(n − 1)` of Dahl's, if n is below 1.
    #[inline(never)]
    pub fn step_apart(&self, friction_n: T, sliding_n: T, sigma_n_per_m: T, displacement_m: T) -> T {
        let least_ratio = self.exponent * T::splat(2.0).pow(self.exponent - T::splat(1.0));
        let least_sigma_n_per_m = sigma_n_per_m * least_ratio.min(T::splat(1.0));
        let linear_n = dahl_step(friction_n, sliding_n, least_sigma_n_per_m, displacement_m);
        self.step(friction_n, sliding_n, sigma_n_per_m, displacement_m).max(linear_n)
    }

    /// Returns the distance, in units of `f_c/σ`, over which the exponential law has the same effect as this one over `way`, starting from
    /// `left = |u|`.
    #[inline(never)]
    fn exponential_way(&self, way: T, left: T) -> T {
        let beyond = self.exponent - T::splat(1.0);
        let scaled_way = way * left.max(T::splat(LEAST_LEFT)).pow(beyond);
        scaled_way * (beyond * scaled_way).ln_1p_ratio()
    }
}

/// Replaces `u = 0` in the power, which occurs in sliding, where the distance does not matter.
const LEAST_LEFT: f64 = 1e-300;

#[cfg(test)]
mod tests {
    use super::PreslidingShape;

    /// Two states under one load, between `−f_c` and `f_c`, over ways that take them from next to nothing to sliding.
    #[test]
    fn two_states_are_never_farther_apart_than_stated() {
        const SLIDING_N: f64 = 1.5;
        const SIGMA_N_PER_M: f64 = 2000.0;
        for exponent in [0.2, 0.3, 0.7, 1.0, 1.5, 3.0] {
            let law = PreslidingShape { exponent };
            for (lower, upper) in (-10..10).flat_map(|lower| (lower + 1..=10).map(move |upper| (lower, upper))) {
                let [lower_n, upper_n] = [lower, upper].map(|tenths| f64::from(tenths) / 10.0 * SLIDING_N);
                for way_m in [-3e-3, -3e-4, -1e-5, 1e-6, 1e-5, 1e-4, 1e-3] {
                    let step = |friction_n| law.step(friction_n, SLIDING_N, SIGMA_N_PER_M, way_m);
                    let apart_n = step(upper_n) - step(lower_n);
                    let most_n = law.step_apart(SLIDING_N + upper_n - lower_n, SLIDING_N, SIGMA_N_PER_M, way_m.abs())
                        - SLIDING_N;
                    assert!(
                        apart_n.abs() <= most_n + 1e-12,
                        "exponent {exponent}, {lower_n} N and {upper_n} N, {way_m} m: {apart_n} N, stated {most_n} N"
                    );
                }
            }
        }
    }
}
