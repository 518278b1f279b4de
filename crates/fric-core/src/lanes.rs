//! Four cables side by side: the [`Scalar`] of the control cycle.
//!
//! A thin layer over the `wide` crate, which maps it to SSE2, AVX, NEON or plain arrays. Lane `i` holds exactly the
//! bits that `f64` would: no fused operations, no approximations.

use core::ops::{Add, Div, Mul, Neg, Sub};

use wide::{f64x4, i64x4};

use crate::functions;
use crate::scalar::{EXP_LOWEST, Mask, Scalar, exp_parts};

/// Cables that one set of instructions handles together.
pub const LANES: usize = 4;

/// Four numbers, one per cable.
#[derive(Clone, Copy, Debug)]
pub struct Lanes(f64x4);

/// Four truth values, one per cable.
#[derive(Clone, Copy, Debug)]
pub struct LanesMask(f64x4);

impl Lanes {
    /// Lanes from an array.
    #[inline(always)]
    #[must_use]
    pub fn new(values: [f64; LANES]) -> Self {
        Self(f64x4::new(values))
    }

    /// The numbers, in order.
    #[inline(always)]
    #[must_use]
    pub fn to_array(self) -> [f64; LANES] {
        self.0.to_array()
    }

    /// The sum over the lanes, always added in the same order: `(0 + 1) + (2 + 3)`.
    #[inline(always)]
    #[must_use]
    pub fn sum(self) -> f64 {
        let [a, b, c, d] = self.to_array();
        (a + b) + (c + d)
    }

    /// Numbers `4·block … 4·block + 3` of a column; zeros past its end.
    #[inline(always)]
    pub(crate) fn load<const COUNT: usize>(column: &[f64; COUNT], block: usize) -> Self {
        // Both ways mean the same; the first needs no tail and is a plain load.
        if COUNT.is_multiple_of(LANES) {
            return Self::new(column.as_chunks::<LANES>().0.get(block).copied().unwrap_or_default());
        }
        Self::new(core::array::from_fn(|lane| column.get(block * LANES + lane).copied().unwrap_or(0.0)))
    }

    /// Writes what [`load`](Self::load) reads.
    #[inline(always)]
    pub(crate) fn store<const COUNT: usize>(self, column: &mut [f64; COUNT], block: usize) {
        if COUNT.is_multiple_of(LANES) {
            if let Some(place) = column.as_chunks_mut::<LANES>().0.get_mut(block) {
                *place = self.to_array();
            }
            return;
        }
        for (place, value) in column.iter_mut().skip(block * LANES).zip(self.to_array()) {
            *place = value;
        }
    }
}

impl LanesMask {
    /// One bit per lane, lane 0 lowest.
    #[inline(always)]
    #[must_use]
    pub fn bits(self) -> u32 {
        self.0.to_bitmask()
    }

    /// Whether it holds in every lane.
    #[inline(always)]
    #[must_use]
    pub fn all(self) -> bool {
        self.0.all()
    }

    /// A mask from truth values.
    #[inline(always)]
    #[must_use]
    pub fn new(values: [bool; LANES]) -> Self {
        Self(f64x4::new(values.map(|value| f64::from_bits(if value { u64::MAX } else { 0 }))))
    }

    /// The same truth value in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(value: bool) -> Self {
        Self::new([value; LANES])
    }
}

macro_rules! lane_operator {
    ($trait:ident, $method:ident) => {
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    };
}
lane_operator!(Add, add);
lane_operator!(Sub, sub);
lane_operator!(Mul, mul);
lane_operator!(Div, div);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Mask for LanesMask {
    const NONE: Self = Self(f64x4::ZERO);

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Scalar for Lanes {
    type Mask = LanesMask;
    const COUNT: usize = LANES;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(f64x4::splat(value))
    }
    #[inline(always)]
    fn from_lanes(value: impl FnMut(usize) -> f64) -> Self {
        Self::new(core::array::from_fn(value))
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        let [first, second, third, fourth] = self.to_array();
        match lane {
            0 => first,
            1 => second,
            2 => third,
            _ => fourth,
        }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> LanesMask {
        LanesMask(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> LanesMask {
        LanesMask(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> LanesMask {
        LanesMask(self.0.simd_eq(other.0))
    }
    #[inline(always)]
    fn select(mask: LanesMask, if_true: Self, if_false: Self) -> Self {
        Self(mask.0.select(if_true.0, if_false.0))
    }
    #[inline(always)]
    fn keep(self, mask: LanesMask) -> Self {
        Self(self.0 & mask.0)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // Where `wide` has no hardware root it falls back on its own; the exact one is `libm`'s.
        if cfg!(any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128")) {
            Self(self.0.sqrt())
        } else {
            Self::new(self.to_array().map(libm::sqrt))
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // The instruction of that name is this very selection, NaN and zeros included; elsewhere it is not.
        if cfg!(target_feature = "sse2") {
            return Self(self.0.fast_max(other.0));
        }
        Self::select(other.lt(self), self, other)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if cfg!(target_feature = "sse2") {
            return Self(self.0.fast_min(other.0));
        }
        Self::select(self.lt(other), self, other)
    }
    #[inline(always)]
    fn sign(self) -> Self {
        let zero = Self::splat(0.0);
        let (negative, positive) = (self.lt(zero), zero.lt(self));
        Self((negative.0 & f64x4::splat(-1.0)) | (positive.0 & f64x4::splat(1.0)))
    }
    #[inline(always)]
    fn exp_negative(self) -> Self {
        let (fraction, exponent_bits) = exp_parts(self.max(Self::splat(EXP_LOWEST)));
        let bits: i64x4 = i64x4::new(exponent_bits.to_array().map(|value| value.to_bits().cast_signed()));
        let scale: i64x4 = (bits + i64x4::splat(1023)) << 52_i32;
        fraction * Self::new(scale.to_array().map(|value| f64::from_bits(value.cast_unsigned())))
    }
    #[inline]
    fn ln(self) -> Self {
        Self::new(self.to_array().map(libm::log))
    }
    #[inline]
    fn sin_cos_turns(self) -> [Self; 2] {
        functions::sin_cos_turns(self)
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "bit for bit is the point")]
mod tests {
    use super::*;

    #[test]
    fn lanes_have_the_bits_of_plain_numbers() {
        let values = [-0.1, -3.7, -250.0, -900.0];
        let lanes = Lanes::new(values).exp_negative().to_array();
        for (lane, value) in lanes.iter().zip(values) {
            assert_eq!(lane.to_bits(), value.exp_negative().to_bits());
        }
        let roots = Lanes::new([2.0, 3.0, 0.0, 1e-300]).sqrt().to_array();
        assert_eq!(roots, [2.0, 3.0, 0.0, 1e-300].map(libm::sqrt));
    }

    #[test]
    fn nan_compares_false_and_is_not_chosen() {
        let lanes = Lanes::new([f64::NAN, 1.0, f64::INFINITY, -2.0]);
        assert_eq!(lanes.within(10.0).bits(), 0b1010);
        assert_eq!(lanes.sign().to_array(), [0.0, 1.0, 1.0, -1.0]);
        assert_eq!(Lanes::select(lanes.within(10.0), lanes, Lanes::splat(0.0)).to_array(), [0.0, 1.0, 0.0, -2.0]);
    }
}
