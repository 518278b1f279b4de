//! Cables side by side: the [`Scalar`]s of the control cycle.
//!
//! A thin layer over the `wide` crate, which uses SSE2, AVX, NEON or plain arrays. Lane `i` holds exactly the bits of the same computation in `f64`:
//! there are no fused operations and no approximations. The number of lanes therefore changes no result, and the cycle uses as many as suit the
//! target ([`CycleLanes`]).

use core::ops::{Add, Div, Mul, Neg, Sub};

use wide::{f64x4, i64x4};
#[cfg(target_feature = "avx")]
use wide::{f64x8, i64x8};

use crate::numbers::functions;
use crate::scalar::{EXP_LOWEST, Mask, Scalar, exp_parts};

/// Number of lanes of a [`Lanes`].
pub const LANES: usize = 4;

/// What the control cycle needs of lanes besides arithmetic: access to columns of numbers, and masks as bits.
pub trait Block: Scalar {
    /// Loads a block of a column: as many numbers as there are lanes, from index `block` times that count. Numbers beyond the column are 0.
    fn load<const COUNT: usize>(column: &[f64; COUNT], block: usize) -> Self;
    /// Stores a block of a column; numbers beyond the column are dropped.
    fn store<const COUNT: usize>(self, column: &mut [f64; COUNT], block: usize);
    /// Returns the mask as bits, one per lane, lane 0 lowest.
    fn bits(mask: Self::Mask) -> u32;
    /// Whether the mask holds in every lane.
    fn all(mask: Self::Mask) -> bool;
    /// Returns the same truth value in every lane.
    fn mask(value: bool) -> Self::Mask;
}

macro_rules! lanes {
    ($(#[$doc:meta])* $lanes:ident, $mask:ident, $count:literal, $float:ident, $int:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $lanes($float);

        /// Truth values, one per lane.
        #[derive(Clone, Copy, Debug)]
        pub struct $mask($float);

        impl $lanes {
            /// Creates lanes from an array.
            #[inline(always)]
            #[must_use]
            pub fn new(values: [f64; $count]) -> Self {
                Self($float::new(values))
            }

            /// Returns the numbers, lane 0 first.
            #[inline(always)]
            #[must_use]
            pub fn to_array(self) -> [f64; $count] {
                self.0.to_array()
            }
        }

        lanes!(operator $lanes, Add, add);
        lanes!(operator $lanes, Sub, sub);
        lanes!(operator $lanes, Mul, mul);
        lanes!(operator $lanes, Div, div);

        impl Neg for $lanes {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Mask for $mask {
            const NONE: Self = Self($float::ZERO);

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
            #[inline(always)]
            fn any(self) -> bool {
                self.0.to_bitmask() != 0
            }
        }

        impl Block for $lanes {
            #[inline(always)]
            fn load<const COUNT: usize>(column: &[f64; COUNT], block: usize) -> Self {
                // Both ways give the same; the first has no tail and is a plain load.
                if COUNT.is_multiple_of($count) {
                    return Self::new(column.as_chunks::<$count>().0.get(block).copied().unwrap_or_default());
                }
                let rest = column.get(block * $count..).unwrap_or_default();
                let tail = || Self::from_lanes(|lane| rest.get(lane).copied().unwrap_or(0.0));
                rest.first_chunk().map_or_else(tail, |values| Self::new(*values))
            }
            #[inline(always)]
            fn store<const COUNT: usize>(self, column: &mut [f64; COUNT], block: usize) {
                if COUNT.is_multiple_of($count) {
                    if let Some(place) = column.as_chunks_mut::<$count>().0.get_mut(block) {
                        *place = self.to_array();
                    }
                    return;
                }
                for (place, value) in column.iter_mut().skip(block * $count).zip(self.to_array()) {
                    *place = value;
                }
            }
            #[inline(always)]
            fn bits(mask: $mask) -> u32 {
                mask.0.to_bitmask()
            }
            #[inline(always)]
            fn all(mask: $mask) -> bool {
                mask.0.all()
            }
            #[inline(always)]
            fn mask(value: bool) -> $mask {
                $mask($float::splat(f64::from_bits(if value { u64::MAX } else { 0 })))
            }
        }

        impl Scalar for $lanes {
            type Mask = $mask;
            const COUNT: usize = $count;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self($float::splat(value))
            }
            #[inline(always)]
            fn from_lanes(value: impl FnMut(usize) -> f64) -> Self {
                Self::new(core::array::from_fn(value))
            }
            #[inline(always)]
            fn lane(self, lane: usize) -> f64 {
                let values = self.to_array();
                values.get(lane).or(values.last()).copied().unwrap_or(0.0)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $mask {
                $mask(self.0.simd_lt(other.0))
            }
            #[inline(always)]
            fn le(self, other: Self) -> $mask {
                $mask(self.0.simd_le(other.0))
            }
            #[inline(always)]
            fn eq(self, other: Self) -> $mask {
                $mask(self.0.simd_eq(other.0))
            }
            #[inline(always)]
            fn select(mask: $mask, if_true: Self, if_false: Self) -> Self {
                Self(mask.0.select(if_true.0, if_false.0))
            }
            #[inline(always)]
            fn keep(self, mask: $mask) -> Self {
                Self(self.0 & mask.0)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // Without a hardware root `wide` computes one that is not exactly rounded; that of `libm` is.
                if cfg!(any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128")) {
                    Self(self.0.sqrt())
                } else {
                    Self::new(self.to_array().map(libm::sqrt))
                }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                // On x86 the instruction is exactly this selection, also for NaN and zeros; on other processors it is not.
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
                Self((negative.0 & $float::splat(-1.0)) | (positive.0 & $float::splat(1.0)))
            }
            #[inline(always)]
            fn exp_negative(self) -> Self {
                let (fraction, exponent_bits) = exp_parts(self.max(Self::splat(EXP_LOWEST)));
                let bits = $int::new(exponent_bits.to_array().map(|value| value.to_bits().cast_signed()));
                let scale: $int = (bits + $int::splat(1023)) << 52_i32;
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
    };
    (operator $lanes:ident, $trait:ident, $method:ident) => {
        impl $trait for $lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    };
}

lanes!(
    /// Four numbers, one per cable.
    Lanes, LanesMask, 4, f64x4, i64x4
);
#[cfg(target_feature = "avx")]
lanes!(
    /// Eight numbers, one per cable.
    EightLanes, EightLanesMask, 8, f64x8, i64x8
);

/// The lanes of the control cycle while more than [`LANES`] cables remain. With AVX they fill two registers, so that one computes while the other
/// waits for its root or quotient.
#[cfg(target_feature = "avx")]
pub type CycleLanes = EightLanes;
#[cfg(not(target_feature = "avx"))]
pub type CycleLanes = Lanes;

impl Lanes {
    /// Returns the sum over the lanes, always added in the same order: `(0 + 1) + (2 + 3)`.
    #[inline(always)]
    #[must_use]
    pub fn sum(self) -> f64 {
        let [a, b, c, d] = self.to_array();
        (a + b) + (c + d)
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
        assert_eq!(Lanes::bits(lanes.within(10.0)), 0b1010);
        assert_eq!(lanes.sign().to_array(), [0.0, 1.0, 1.0, -1.0]);
        assert_eq!(Lanes::select(lanes.within(10.0), lanes, Lanes::splat(0.0)).to_array(), [0.0, 1.0, 0.0, -2.0]);
    }
}
