//! The number type of the model.
//!
//! Every equation of this crate is generic over [`Scalar`], so that one source serves three uses: plain `f64` (one cable), [`Lanes`](crate::Lanes)
//! (several cables side by side, as in the control cycle), and numbers that carry derivatives (a fit). Choices that depend on data are
//! [`select`](Scalar::select)s, not branches, so all lanes take the same path and a cycle takes the same instructions whatever the cables do. The
//! exceptions take more: held or repeated signals, a sensor that has jumped, inertia at rest, and the first cycle of new parameters.
//!
//! Only operations that IEEE 754 rounds exactly are used (`+ − × ÷ √` and comparisons). Transcendental functions, mainly [`exp_negative`], are built
//! from them; the logarithm is that of the `libm` crate. Results therefore do not depend on the platform.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::numbers::functions;

/// A real number, or several side by side. Comparisons give masks, which replace branches.
pub trait Scalar:
    Copy
    + core::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The result of a comparison, one truth value per lane.
    type Mask: Mask;

    /// Number of lanes.
    const COUNT: usize;

    /// Returns the same constant in every lane.
    fn splat(value: f64) -> Self;
    /// Returns a constant of its own in each lane.
    fn from_lanes(value: impl FnMut(usize) -> f64) -> Self;
    /// Returns the number in a lane, without its derivatives. An index beyond the last lane gives the last lane.
    fn lane(self, lane: usize) -> f64;
    /// Whether `self < other`; false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether `self ≤ other`; false where either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Whether `self = other`; false where either is NaN.
    fn eq(self, other: Self) -> Self::Mask;
    /// Returns `if_true` where the mask holds, else `if_false`; the value not chosen may be NaN.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// Returns the magnitude.
    #[must_use]
    fn abs(self) -> Self;
    /// Returns the square root, correctly rounded.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Returns the exponential of an argument ≤ 0, see [`exp_negative`].
    #[must_use]
    fn exp_negative(self) -> Self;
    /// Returns the natural logarithm of a positive number. It is computed lane after lane; only some effects need it.
    #[must_use]
    fn ln(self) -> Self;
    /// Returns sine and cosine of `2π·self`, for magnitudes below 2⁴⁹.
    #[must_use]
    fn sin_cos_turns(self) -> [Self; 2];

    /// Returns the exponential; arguments beyond ±708 count as ±708.
    #[inline(always)]
    #[must_use]
    fn exp(self) -> Self {
        let falls = self.lt(Self::splat(0.0));
        let fall = Self::select(falls, self, -self).exp_negative();
        Self::select(falls, fall, Self::splat(1.0) / fall)
    }
    /// Returns a positive number raised to a power; exactly 1 for the power 0.
    #[inline(always)]
    #[must_use]
    fn pow(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }
    /// Returns `ln(1 + self)/self`: 1 at 0, where it is smooth; 1000 for `self ≤ −1`, which has no logarithm.
    #[inline(always)]
    #[must_use]
    fn ln_1p_ratio(self) -> Self {
        functions::ln_1p_ratio(self)
    }

    /// Returns the greater of the two; `other` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    /// Returns the lesser of the two; `other` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// Returns −1, 0 or +1; 0 for NaN.
    #[inline(always)]
    #[must_use]
    fn sign(self) -> Self {
        let zero = Self::splat(0.0);
        let negative_or_zero = Self::select(self.lt(zero), Self::splat(-1.0), zero);
        Self::select(zero.lt(self), Self::splat(1.0), negative_or_zero)
    }
    /// Returns `self` times a number without derivatives: a signal, a wrap factor, a constant of the geometry.
    #[inline(always)]
    #[must_use]
    fn scale(self, constant: Self) -> Self {
        self * constant
    }
    /// Returns `self` where the mask holds, else 0.
    #[inline(always)]
    #[must_use]
    fn keep(self, mask: Self::Mask) -> Self {
        Self::select(mask, self, Self::splat(0.0))
    }
    /// Whether the magnitude is at most `bound`; false for NaN.
    #[inline(always)]
    fn within(self, bound: f64) -> Self::Mask {
        self.abs().le(Self::splat(bound))
    }
}

/// The truth values of a comparison.
pub trait Mask: Copy + core::fmt::Debug {
    /// False in every lane.
    const NONE: Self;
    /// Returns the lane-wise "and".
    #[must_use]
    fn and(self, other: Self) -> Self;
    /// Returns the lane-wise "or".
    #[must_use]
    fn or(self, other: Self) -> Self;
    /// Returns the lane-wise "not".
    #[must_use]
    fn not(self) -> Self;
    /// Whether the mask holds in any lane.
    #[must_use]
    fn any(self) -> bool;
}

impl Mask for bool {
    const NONE: Self = false;

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self | other
    }
    #[inline(always)]
    fn not(self) -> Self {
        !self
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
}

impl Scalar for f64 {
    type Mask = bool;
    const COUNT: usize = 1;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn from_lanes(mut value: impl FnMut(usize) -> f64) -> Self {
        value(0)
    }
    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }
    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
    #[inline(always)]
    fn exp_negative(self) -> Self {
        let (fraction, exponent_bits) = exp_parts(self.max(EXP_LOWEST));
        fraction * f64::from_bits(exponent_bits.to_bits().wrapping_add(1023) << 52)
    }
    #[inline]
    fn ln(self) -> Self {
        libm::log(self)
    }
    #[inline]
    fn sin_cos_turns(self) -> [Self; 2] {
        functions::sin_cos_turns(self)
    }
}

/// Least argument of [`exp_negative`]: e⁻⁷⁰⁸ ≈ 3·10⁻³⁰⁸ is just above the smallest normal number.
pub(crate) const EXP_LOWEST: f64 = -708.0;
/// 1.5·2⁵²: adding it rounds to an integer, which is then in the low bits of the mantissa.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// Upper part of ln 2, 33 bits, so that its product with the exponent is exact.
const LN_2_UPPER: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
/// Remainder of ln 2.
const LN_2_LOWER: f64 = f64::from_bits(0x3dea_39ef_3579_3c76);

/// Returns the exponential `e^x` of a number `x ≤ 0`.
///
/// The range is reduced by `x = n·ln 2 + r`, `|r| ≤ ln 2/2`; `e^r` is the Taylor polynomial of degree 13, whose remainder there is below 2⁻⁵⁸. The
/// relative error is at most 2 units in the last place for `x ∈ [−708, 0]` (the tests compare with the platform's `exp`). Smaller `x` and NaN give
/// e⁻⁷⁰⁸. Only additions and multiplications are used, so the bits are the same on every platform.
///
/// ```
/// use fric_core::scalar::exp_negative;
/// assert!((exp_negative(-1.0_f64) - 1.0 / core::f64::consts::E).abs() < 1e-16);
/// assert_eq!(exp_negative(0.0_f64), 1.0);
/// ```
#[inline(always)]
pub fn exp_negative<T: Scalar>(x: T) -> T {
    x.exp_negative()
}

/// Returns `e^r`, and a number whose low mantissa bits hold `n`, for `x = n·ln 2 + r`.
#[inline(always)]
pub(crate) fn exp_parts<T: Scalar>(x: T) -> (T, T) {
    let shifted = x * T::splat(core::f64::consts::LOG2_E) + T::splat(ROUND);
    let exponent = shifted - T::splat(ROUND);
    let r = (x - exponent * T::splat(LN_2_UPPER)) - exponent * T::splat(LN_2_LOWER);
    // Estrin's scheme has short dependency chains, which limit the speed of a cycle of few cables.
    let c = |divisor: f64| T::splat(1.0 / divisor);
    let r2 = r * r;
    let r4 = r2 * r2;
    let r8 = r4 * r4;
    let p01 = T::splat(1.0) + r;
    let p23 = c(2.0) + r * c(6.0);
    let p45 = c(24.0) + r * c(120.0);
    let p67 = c(720.0) + r * c(5_040.0);
    let p89 = c(40_320.0) + r * c(362_880.0);
    let p1011 = c(3_628_800.0) + r * c(39_916_800.0);
    let p1213 = c(479_001_600.0) + r * c(6_227_020_800.0);
    let high = (p89 + r2 * p1011) + r4 * p1213;
    let middle = p45 + r2 * p67;
    let low = p01 + r2 * p23;
    (low + (r4 * middle + r8 * high), shifted)
}
