//! The number type the model is written in.
//!
//! Every equation of this crate is generic over [`Scalar`], so that one source serves three uses: plain `f64` (one
//! cable, one number), [`Lanes`](crate::Lanes) (cables side by side, as in the control cycle), and any number that
//! carries derivatives along. Choices that depend on data are [`select`](Scalar::select)s, not branches: all lanes take the
//! same path, and the time that the equations take does not depend on what the cables do, but for what is out of the ordinary (signals that are
//! held or repeat themselves, a sensor that has jumped), which takes longer.
//!
//! Only operations that IEEE 754 rounds exactly are used (`+ − × ÷ √` and comparisons); transcendental functions, above
//! all [`exp_negative`], are built from them, the logarithm by the `libm` crate. So results do not depend on the platform.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::functions;

/// A real number, or several side by side, with comparison masks instead of branches.
pub trait Scalar:
    Copy
    + core::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The outcome of a comparison, one truth value per lane.
    type Mask: Mask;

    /// How many numbers stand side by side.
    const COUNT: usize;

    /// The same constant in every lane.
    fn splat(value: f64) -> Self;
    /// A constant for each lane.
    fn from_lanes(value: impl FnMut(usize) -> f64) -> Self;
    /// The number in a lane, without what it carries along; the last lane's past the end.
    fn lane(self, lane: usize) -> f64;
    /// `self < other`; false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self ≤ other`; false where either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `self = other`; false where either is NaN.
    fn eq(self, other: Self) -> Self::Mask;
    /// `if_true` where the mask holds, else `if_false`; what is not chosen may be NaN.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self;
    /// Square root, correctly rounded.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Exponential for arguments ≤ 0, see [`exp_negative`].
    #[must_use]
    fn exp_negative(self) -> Self;
    /// Natural logarithm of a positive number, lane after lane: for effects, which alone pay for it.
    #[must_use]
    fn ln(self) -> Self;
    /// Sine and cosine of `2π·self`, for magnitudes below 2⁴⁹.
    #[must_use]
    fn sin_cos_turns(self) -> [Self; 2];

    /// Exponential; arguments beyond ±708 count as that.
    #[inline(always)]
    #[must_use]
    fn exp(self) -> Self {
        let falls = self.lt(Self::splat(0.0));
        let fall = Self::select(falls, self, -self).exp_negative();
        Self::select(falls, fall, Self::splat(1.0) / fall)
    }
    /// A positive number to a power; 1 for the power 0.
    #[inline(always)]
    #[must_use]
    fn pow(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }
    /// `ln(1 + self)/self`, 1 at 0 and smooth there; 1000 where there is no logarithm.
    #[inline(always)]
    #[must_use]
    fn ln_1p_ratio(self) -> Self {
        functions::ln_1p_ratio(self)
    }

    /// The greater of the two; `other` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    /// The lesser of the two; `other` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// −1, 0 or +1; 0 for NaN.
    #[inline(always)]
    #[must_use]
    fn sign(self) -> Self {
        let zero = Self::splat(0.0);
        let negative_or_zero = Self::select(self.lt(zero), Self::splat(-1.0), zero);
        Self::select(zero.lt(self), Self::splat(1.0), negative_or_zero)
    }
    /// `self` times a number that carries nothing along: a signal, a wrap, a constant of the geometry.
    #[inline(always)]
    #[must_use]
    fn scale(self, constant: Self) -> Self {
        self * constant
    }
    /// `self` where the mask holds, else 0.
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

/// Truth values of one comparison.
pub trait Mask: Copy + core::fmt::Debug {
    /// False in every lane.
    const NONE: Self;
    /// Lane-wise and.
    #[must_use]
    fn and(self, other: Self) -> Self;
    /// Lane-wise or.
    #[must_use]
    fn or(self, other: Self) -> Self;
    /// Lane-wise not.
    #[must_use]
    fn not(self) -> Self;
    /// Whether it holds in any lane.
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

/// Below this, [`exp_negative`] has reached the smallest normal number's neighbourhood (e⁻⁷⁰⁸ ≈ 3·10⁻³⁰⁸).
pub(crate) const EXP_LOWEST: f64 = -708.0;
/// 1.5·2⁵²: adding it rounds to an integer, which then stands in the low bits of the mantissa.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// ln 2, upper part: 33 bits, so that its product with the exponent is exact.
const LN_2_UPPER: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
/// ln 2, the rest.
const LN_2_LOWER: f64 = f64::from_bits(0x3dea_39ef_3579_3c76);

/// The exponential of a number that is not positive: `e^x`, `x ≤ 0`.
///
/// Range reduction `x = n·ln 2 + r`, `|r| ≤ ln 2/2`, then the Taylor polynomial of degree 13, whose remainder on that
/// interval is below 2⁻⁵⁸. Relative error at most 2 units in the last place for `x ∈ [−708, 0]` (checked against the
/// platform's `exp` in the tests); smaller `x` give e⁻⁷⁰⁸, NaN gives e⁻⁷⁰⁸ too. Built from additions and
/// multiplications only, so the bits are the same on every platform.
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

/// `e^r` and the number whose low mantissa bits hold `n`, for `x = n·ln 2 + r`.
#[inline(always)]
pub(crate) fn exp_parts<T: Scalar>(x: T) -> (T, T) {
    let shifted = x * T::splat(core::f64::consts::LOG2_E) + T::splat(ROUND);
    let exponent = shifted - T::splat(ROUND);
    let r = (x - exponent * T::splat(LN_2_UPPER)) - exponent * T::splat(LN_2_LOWER);
    // Estrin's scheme: short dependency chains, which is what a cycle of few cables waits for.
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
