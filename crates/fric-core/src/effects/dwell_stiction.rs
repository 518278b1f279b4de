//! `dwell_stiction`: breakaway friction that grows with the time at rest.
//!
//! Equation: `μ·(1 + ratio·θ)`, where the age θ of the contacts, 0…1, grows at rest and wears off while they slide:
//!
//! ```text
//! dθ/dt = (1 − θ)/time_s − θ·|v|/distance_m
//! ```
//!
//! Over a cycle with the displacement Δl at constant speed this is solved exactly: θ approaches `(Δt/time_s)/r` by `e^(−r)`, `r =
//! Δt/time_s + |Δl|/distance_m`.
//!
//! In steady motion `θ = 1/(1 + |v|·time_s/distance_m)`, which is nearly zero at any usual speed. A run begins with θ = 0. The friction of a cycle
//! uses the mean of the θ before and after it. Neutral: `ratio = 0`.
//!
//! Rests of one length determine only `ratio·(1 − e^(−rest/time_s))`. A fit identifies `time_s` if the run has rests of several lengths. If not, it stays
//! as stated: the identified values are valid for rests like those of the run, and for others as far as `time_s` is right.
//!
//! Cause: asperities in contact creep and grow, and grease is squeezed out of the contact. Source: the ageing law of rate-and-state friction
//! (Dieterich 1979; Ruina 1983), with a bounded age.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN, first};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str =
    "rests of different length, a tenth of a second to several seconds, each followed by a slow movement";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "dwell_stiction",
    cause: "the contacts in the bearings grow while they rest, so the cable breaks away later the longer it has stood still",
    remedy: "a grease with additives against stick-slip, or bearings with less preload; else keep the cable moving a little",
    parameters: &[
        ParameterRow::fitted("ratio", "1", [0.0, 0.0, 10.0], EXCITATION),
        ParameterRow::setting("time_s", "s", [1e-3, 0.6, 1e4], EXCITATION),
        ParameterRow::fitted("distance_m", "m", [1e-6, 1e-3, 1.0], EXCITATION),
    ],
    example: &[0.8, 0.5, 1e-3],
    memory: Memory::OfMotion(1),
    on_mu: OnMu::AtMost {
        factor: |values| 1.0 + first(values),
        key: "ratio",
        problem: "raises the friction after a long rest, `mu`·(1 + `ratio`), beyond 0.9; lower it, or `mu`",
    },
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::DwellStiction.acts();
/// Index of `ratio` in [`Values`](crate::parameters::Values).
pub const RATIO: usize = Effect::DwellStiction.first_place();
/// Index of `time_s`.
pub const TIME: usize = RATIO + 1;
/// Index of `distance_m`.
pub const DISTANCE: usize = RATIO + 2;

/// Index of its state: the age of the contacts.
pub(crate) const AGE: usize = Effect::DwellStiction.memory_places().start;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DwellStiction<T> {
    /// Additional friction after a long rest, as a fraction of μ.
    pub ratio: T,
    /// Time constant of the contacts' growth at rest, s.
    pub time_s: T,
    /// Sliding distance over which their growth wears off to 1/e, m.
    pub distance_m: T,
}

impl<T: Scalar> DwellStiction<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { ratio: value(RATIO), time_s: value(TIME), distance_m: value(DISTANCE) }
    }

    /// Returns the factor on μ in a cycle, and the age of the contacts after it. `age` is the age before, [`UNKNOWN`] at the start of a run.
    #[inline(never)]
    pub fn factor(&self, age: T, displacement_m: T, step_s: T) -> (T, T) {
        let age = age.keep(age.lt(T::splat(UNKNOWN)));
        let growing = step_s / self.time_s;
        let rate = growing + displacement_m.abs() / self.distance_m;
        let settled = growing / rate;
        let next = settled + (age - settled) * (-rate).exp_negative();
        (T::splat(1.0) + self.ratio * (age + next).scale(T::splat(0.5)), next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: DwellStiction<f64> = DwellStiction { ratio: 0.8, time_s: 0.5, distance_m: 1e-3 };

    /// Returns the age after cycles of 1 ms at a speed.
    fn age_after(mut age: f64, cycles: u32, speed_m_per_s: f64) -> f64 {
        for _ in 0..cycles {
            age = LAW.factor(age, 1e-3 * speed_m_per_s, 1e-3).1;
        }
        age
    }

    #[test]
    fn a_rest_ages_and_a_distance_wears_off() {
        let rested = age_after(UNKNOWN, 1000, 0.0);
        assert!((rested - (1.0 - (-2.0_f64).exp())).abs() < 1e-12, "{rested}");
        // 3 mm in 3 ms: no time to age.
        let worn = age_after(rested, 3, -1.0);
        assert!((worn - rested * (-3.0_f64).exp()).abs() < 3e-3, "{worn}");
        let creeping = age_after(0.0, 20_000, 1e-3);
        assert!((creeping - 1.0 / 1.5).abs() < 1e-9, "{creeping}");
        // The factor of a cycle that breaks away and wears off to 1/e is that of the mean age.
        let (factor, after) = LAW.factor(rested, 1e-3, 1e-9);
        assert!((factor - (1.0 + 0.4 * (rested + after))).abs() < 1e-15);
    }

    /// Compares the exact step with many small steps of the differential equation.
    #[test]
    fn one_step_is_many_small_ones() {
        let (mut slow, parts) = (0.3_f64, 1_000_000);
        for _ in 0..parts {
            slow += ((1.0 - slow) / 0.5 * 0.1 - slow * 4e-4 / 1e-3) / f64::from(parts);
        }
        let (_, exact) = LAW.factor(0.3, -4e-4, 0.1);
        assert!((exact - slow).abs() < 1e-6, "{exact} {slow}");
    }
}
