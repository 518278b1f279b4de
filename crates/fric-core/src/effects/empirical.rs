//! `empirical`: a rest without a name, as a table over one operating condition.
//!
//! Equation: `F_n = … + force_n·s(x)` at the platform and `μ(x) = μ·(1 + friction_ratio·s(x))`, at least 0, where s is the table. The shares
//! `share_1` … `share_12` belong to twelve equidistant points from the beginning to the end of a range of the condition x. Between the points s is
//! linear; beyond the ends it is constant. So `|s| ≤ 1`, the force is bounded by `force_n`, and μ by `1 + friction_ratio` times its value without the
//! table.
//!
//! The condition is the one whose range is stated:
//!
//! | range | condition | |
//! |---|---|---|
//! | `speed_from_m_per_s`, `speed_to_m_per_s` | speed, positive paying out | as the delay and the play of the gear leave it |
//! | `length_from_m`, `length_to_m` | cable length | behind a play of the gear |
//! | `load_from_n`, `load_to_n` | tension as if nothing rubbed, `F_s/(1 − cos α₁)` | of the corrected sensor force |
//!
//! Of several ranges the first of this list counts (a robot file with several is refused); without any there is no table. The force acts behind the
//! last pulley, after `pulley_eccentricity`, and needs no presliding distance. The factor changes the friction of all pulleys, which resists the
//! motion. A table over the length does nothing before the first length. Neutral: `force_n` and `friction_ratio` 0, whatever the shares.
//!
//! Cause: unknown. A table says how large something is and where, but does not explain it. It comes from `discover`, if a rest that no effect of the
//! catalogue explains is a function of one condition. An identification varies its size and keeps its shape.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN};
use crate::parameters::ParameterRow;
use crate::scalar::{Mask, Scalar};

/// Number of shares of a table.
pub const SHARES: usize = 12;

const EXCITATION: &str = "movements over all of the range of the table's condition, at several speeds and loads";

const fn setting(key: &'static str, unit: &'static str, most: f64) -> ParameterRow {
    ParameterRow::setting(key, unit, [-most, 0.0, most], EXCITATION)
}

const fn size(key: &'static str, unit: &'static str, most: f64) -> ParameterRow {
    ParameterRow::fitted(key, unit, [-most, 0.0, most], EXCITATION)
}

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "empirical",
    cause: "unnamed: this is how large it is and where; no effect of the catalogue accounts for it",
    remedy: "look for what changes on the machine where the table is large; the table keeps the force right meanwhile",
    parameters: &[
        size("force_n", "N", 1e4),
        size("friction_ratio", "1", 5.0),
        setting("speed_from_m_per_s", "m/s", 1e3),
        setting("speed_to_m_per_s", "m/s", 1e3),
        setting("length_from_m", "m", 1e5),
        setting("length_to_m", "m", 1e5),
        setting("load_from_n", "N", 1e6),
        setting("load_to_n", "N", 1e6),
        setting("share_1", "1", 1.0),
        setting("share_2", "1", 1.0),
        setting("share_3", "1", 1.0),
        setting("share_4", "1", 1.0),
        setting("share_5", "1", 1.0),
        setting("share_6", "1", 1.0),
        setting("share_7", "1", 1.0),
        setting("share_8", "1", 1.0),
        setting("share_9", "1", 1.0),
        setting("share_10", "1", 1.0),
        setting("share_11", "1", 1.0),
        setting("share_12", "1", 1.0),
    ],
    example: &[
        0.1, 0.15, -0.4, 0.4, 0.0, 0.0, 0.0, 0.0, -0.2, 0.3, 0.9, 0.8, 0.2, -0.1, -0.5, -1.0, -0.7, -0.6, -0.2, 0.1,
    ],
    memory: Memory::Nothing,
    on_mu: OnMu::AtMost {
        factor: |values| {
            let greatest = values.iter().skip(FIRST_SHARE).fold(0.0, |most: f64, share| most.max(libm::fabs(*share)));
            1.0 + libm::fabs(values.get(RATIO - SIZE).copied().unwrap_or(0.0)) * greatest
        },
        key: "friction_ratio",
        problem: "raises the friction, `mu`·(1 + friction_ratio·share), beyond 0.9; lower it, or `mu`",
    },
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::Empirical.acts();
/// Index of `force_n` in [`Values`](crate::parameters::Values).
pub const SIZE: usize = Effect::Empirical.first_place();
/// Index of `friction_ratio`.
pub const RATIO: usize = SIZE + 1;
/// Indices of the beginnings of the ranges, each followed by its end, in the order of [`Over::ALL`].
pub const RANGES: [usize; 3] = [SIZE + 2, SIZE + 4, SIZE + 6];
/// Position of the first share among the parameters.
const FIRST_SHARE: usize = 8;
/// Indices of the shares.
pub const SHARE_PLACES: core::ops::Range<usize> = SIZE + FIRST_SHARE..SIZE + FIRST_SHARE + SHARES;
/// Minimum width of a range, in the condition's unit, which prevents overflow.
const NARROWEST: f64 = 1e-9;

/// A condition that a table can be over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Over {
    /// Speed, positive paying out.
    Speed,
    /// Cable length.
    Length,
    /// Cable tension without friction.
    Load,
}

impl Over {
    /// All conditions, in the order in which ranges count.
    pub const ALL: [Self; 3] = [Self::Speed, Self::Length, Self::Load];

    /// Returns the condition of a table with these values by index; `None` without a range.
    #[must_use]
    pub fn of(value: impl Fn(usize) -> f64) -> Option<Self> {
        Self::ALL.into_iter().find(|over| value(over.from()) < value(over.to()))
    }

    /// Returns the index of the beginning of its range in [`Values`](crate::parameters::Values).
    #[must_use]
    pub const fn from(self) -> usize {
        RANGES[self as usize]
    }

    /// Returns the index of the end of its range.
    #[must_use]
    pub const fn to(self) -> usize {
        self.from() + 1
    }

    /// Returns the condition's unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Speed => "m/s",
            Self::Length => "m",
            Self::Load => "N",
        }
    }
}

/// The inputs of a table.
#[derive(Clone, Copy, Debug)]
pub struct Conditions<T> {
    /// Speed, positive paying out, m/s.
    pub speed_m_per_s: T,
    /// Cable length, m; [`UNKNOWN`] before the first.
    pub length_m: T,
    /// Cable tension without friction, N.
    pub load_n: T,
}

/// The contribution of a table in a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unnamed<T> {
    /// Contribution to the force at the platform, N.
    pub force_n: T,
    /// Factor on μ, 1.
    pub mu_factor: T,
}

/// Returns the contribution of a cable's table, from its parameter values by index.
#[inline(never)]
pub fn unnamed<T: Scalar>(value: impl Fn(usize) -> T, conditions: &Conditions<T>) -> Unnamed<T> {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let share = share(&value, conditions);
    Unnamed { force_n: value(SIZE) * share, mu_factor: (one + value(RATIO) * share).max(zero) }
}

/// Returns the table's value at some conditions, −1…1.
#[inline(always)]
fn share<T: Scalar>(value: &impl Fn(usize) -> T, conditions: &Conditions<T>) -> T {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let range = |over: Over| (value(over.from()), value(over.to()));
    let of = [
        (conditions.load_n, range(Over::Load)),
        (conditions.length_m, range(Over::Length)),
        (conditions.speed_m_per_s, range(Over::Speed)),
    ];
    let (mut at, mut from, mut to) = (zero, zero, zero);
    for (of_condition, (begins, ends)) in of {
        let is_stated = begins.lt(ends);
        at = T::select(is_stated, of_condition, at);
        from = T::select(is_stated, begins, from);
        to = T::select(is_stated, ends, to);
    }
    let is_known = from.lt(to).and(at.lt(T::splat(UNKNOWN)));
    let width = (to - from).max(T::splat(NARROWEST));
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let last = (SHARES - 1) as f64;
    let place = ((at.keep(is_known) - from) / width).max(zero).min(one) * T::splat(last);
    let mut sum = zero;
    let mut of_share = zero;
    for share in SHARE_PLACES {
        let weight = (one - (place - of_share).abs()).max(zero);
        sum = sum + value(share) * weight;
        of_share = of_share + one;
    }
    sum.keep(is_known)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{PARAMETER_COUNT, Values};

    fn table(over: Over, [from, to]: [f64; 2], shares: [f64; SHARES]) -> Values {
        let mut values = [0.0; PARAMETER_COUNT];
        (values[SIZE], values[RATIO]) = (0.5, 2.0);
        (values[over.from()], values[over.to()]) = (from, to);
        values[SHARE_PLACES].copy_from_slice(&shares);
        values
    }

    #[test]
    fn between_two_places_a_line_holds_and_beyond_the_ends_the_last() {
        let shares = [0.0, 0.1, 0.4, 1.0, -1.0, 0.2, 0.3, 0.0, 0.0, -0.6, 0.5, 0.25];
        for (over, [from, to]) in [(Over::Speed, [-0.3, 0.8]), (Over::Length, [1.0, 2.1]), (Over::Load, [3.0, 14.0])] {
            let values = table(over, [from, to], shares);
            let at = |x: f64| {
                let mut conditions = Conditions { speed_m_per_s: 7.0, length_m: -7.0, load_n: 1e3 };
                match over {
                    Over::Speed => conditions.speed_m_per_s = x,
                    Over::Length => conditions.length_m = x,
                    Over::Load => conditions.load_n = x,
                }
                unnamed(|place| values[place], &conditions)
            };
            let step = (to - from) / 11.0;
            for (x, share) in [
                (from, 0.0),
                (from - 1e6, 0.0),
                (from + 1.5 * step, 0.25),
                (from + 3.0 * step, 1.0),
                (from + 3.25 * step, 0.5),
                (from + 4.0 * step, -1.0),
                (to, 0.25),
                (to + 1e6, 0.25),
            ] {
                let Unnamed { force_n, mu_factor } = at(x);
                assert!((force_n - 0.5 * share).abs() < 1e-9, "{over:?} {x}: {force_n}");
                assert!((mu_factor - (1.0 + 2.0 * share).max(0.0)).abs() < 1e-9, "{over:?} {x}: {mu_factor}");
            }
        }
        // There is no contribution without a range, nor before the first length.
        let nothing = Unnamed { force_n: 0.0, mu_factor: 1.0 };
        let conditions = Conditions { speed_m_per_s: 0.1, length_m: UNKNOWN, load_n: 5.0 };
        for values in [table(Over::Speed, [0.0, 0.0], shares), table(Over::Length, [0.1, 0.2], [1.0; SHARES])] {
            assert_eq!(unnamed(|place| values[place], &conditions), nothing);
        }
        assert_eq!(Over::of(|place| table(Over::Load, [1.0, 2.0], shares)[place]), Some(Over::Load));
        assert_eq!(Over::of(|_| 0.0), None);
    }
}
