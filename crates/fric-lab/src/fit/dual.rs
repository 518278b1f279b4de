//! Numbers that carry their derivatives along: the [`Scalar`] with which the cycle's equations are differentiated.
//!
//! `value + Σ gradient_k·ε_k` with `ε_j·ε_k = 0`: every operation follows the chain rule exactly, so a result holds the
//! derivatives of what the equations computed, to rounding. Comparisons look at the value alone; at a kink the derivative is
//! that of the branch taken.
#![allow(clippy::inline_always, reason = "a call in the cycle's equations would pass the derivatives through memory")]

use std::ops::{Add, Div, Mul, Neg, Sub};

use fric_core::scalar::Scalar;

/// A number with its derivatives by `N` parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The number.
    pub value: f64,
    /// Its derivatives.
    pub gradient: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A number that does not depend on any parameter.
    #[inline(always)]
    #[must_use]
    pub const fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; N] }
    }

    /// The parameter at a place; a constant where the place is past the end.
    #[must_use]
    pub fn variable(value: f64, place: usize) -> Self {
        Self { value, gradient: std::array::from_fn(|k| f64::from(u8::from(k == place))) }
    }

    /// `value` with the derivatives scaled, the chain rule of one argument.
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, gradient: self.gradient.map(|part| slope * part) }
    }

    /// `value` with the derivatives `a·self' + b·other'`.
    #[inline(always)]
    fn combine(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        Self { value, gradient: std::array::from_fn(|k| a * self.gradient[k] + b * other.gradient[k]) }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: std::array::from_fn(|k| self.gradient[k] + other.gradient[k]),
        }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            gradient: std::array::from_fn(|k| self.gradient[k] - other.gradient[k]),
        }
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (quotient, inverse) = (self.value / other.value, 1.0 / other.value);
        self.combine(other, quotient, inverse, -quotient * inverse)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::constant(value)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self.value < other.value
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self.value <= other.value
    }
    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self.value == other.value
    }
    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { Self { value: self.value.abs(), ..self } }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = Scalar::sqrt(self.value);
        self.chain(root, 0.5 / root)
    }
    #[inline(always)]
    fn exp_negative(self) -> Self {
        let power = Scalar::exp_negative(self.value);
        self.chain(power, power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each operation against the central difference of the same expression in plain numbers.
    #[test]
    fn every_operation_follows_the_chain_rule() {
        fn expression<T: Scalar>(x: T, y: T) -> [T; 9] {
            let half = T::splat(0.5);
            [
                x + half * y,
                x - y * y,
                x * y,
                x / y,
                -x,
                (x - y).abs(),
                (x * x + y).sqrt(),
                (-(x * y)).exp_negative(),
                x.max(y) * x.min(y).sign(),
            ]
        }
        for (x, y) in [(0.7, 1.3), (2.5, 0.4), (0.1, 3.0)] {
            let duals = expression(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
            let h = 1e-6;
            let [plus_x, minus_x] = [expression(x + h, y), expression(x - h, y)];
            let [plus_y, minus_y] = [expression(x, y + h), expression(x, y - h)];
            for (place, dual) in duals.into_iter().enumerate() {
                assert_eq!(dual.value.to_bits(), expression(x, y)[place].to_bits());
                for (derivative, difference) in
                    dual.gradient.into_iter().zip([plus_x[place] - minus_x[place], plus_y[place] - minus_y[place]])
                {
                    let numeric = difference / (2.0 * h);
                    assert!(
                        (derivative - numeric).abs() < 1e-8 * (1.0 + numeric.abs()),
                        "{place}: {derivative} {numeric}"
                    );
                }
            }
        }
    }
}
