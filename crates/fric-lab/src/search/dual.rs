//! Dual numbers, which carry derivatives along: the [`Scalar`] that differentiates the cycle's equations.
//!
//! A dual number is `value + Σ gradient_k·ε_k` with `ε_j·ε_k = 0`. Every operation follows the chain rule exactly, so a result holds the derivatives
//! of the computed equations, to rounding. Comparisons use the value alone. At a kink the derivative is that of the branch taken; the derivative of a
//! magnitude at 0 is 0.
#![allow(clippy::inline_always, reason = "a call in the cycle's equations would pass the derivatives through memory")]

use std::ops::{Add, Div, Mul, Neg, Sub};

use fric_core::scalar::Scalar;

/// A number, or several side by side, with the derivatives with respect to `N` parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<V, const N: usize> {
    /// The number.
    pub value: V,
    /// Its derivatives.
    pub gradient: [V; N],
}

impl<V: Scalar, const N: usize> Dual<V, N> {
    /// Creates a number that does not depend on any parameter.
    #[inline(always)]
    #[must_use]
    pub fn constant(value: V) -> Self {
        Self { value, gradient: [V::splat(0.0); N] }
    }

    /// Returns `value` with the derivatives scaled by `slope`: the chain rule for one argument.
    #[inline(always)]
    fn chain(self, value: V, slope: V) -> Self {
        Self { value, gradient: self.gradient.map(|part| slope * part) }
    }

    /// Returns `value` with derivatives combined from those of both arguments.
    #[inline(always)]
    fn combine(self, other: Self, value: V, part: impl Fn(V, V) -> V) -> Self {
        Self { value, gradient: std::array::from_fn(|k| part(self.gradient[k], other.gradient[k])) }
    }
}

impl<V: Scalar, const N: usize> Add for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, |mine, others| mine + others)
    }
}

impl<V: Scalar, const N: usize> Sub for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, |mine, others| mine - others)
    }
}

impl<V: Scalar, const N: usize> Mul for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule is a sum")]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        self.combine(other, a * b, |mine, others| b * mine + a * others)
    }
}

impl<V: Scalar, const N: usize> Div for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (quotient, inverse) = (self.value / other.value, V::splat(1.0) / other.value);
        self.combine(other, quotient, |mine, others| inverse * (mine - quotient * others))
    }
}

impl<V: Scalar, const N: usize> Neg for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, gradient: self.gradient.map(|part| -part) }
    }
}

impl<V: Scalar, const N: usize> Scalar for Dual<V, N> {
    type Mask = V::Mask;
    const COUNT: usize = V::COUNT;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::constant(V::splat(value))
    }
    #[inline(always)]
    fn from_lanes(value: impl FnMut(usize) -> f64) -> Self {
        Self::constant(V::from_lanes(value))
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.value.lane(lane)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> V::Mask {
        self.value.lt(other.value)
    }
    #[inline(always)]
    fn le(self, other: Self) -> V::Mask {
        self.value.le(other.value)
    }
    #[inline(always)]
    fn eq(self, other: Self) -> V::Mask {
        self.value.eq(other.value)
    }
    #[inline(always)]
    fn select(mask: V::Mask, if_true: Self, if_false: Self) -> Self {
        let value = V::select(mask, if_true.value, if_false.value);
        if_true.combine(if_false, value, |mine, others| V::select(mask, mine, others))
    }
    #[inline(always)]
    fn scale(self, constant: Self) -> Self {
        self.chain(self.value * constant.value, constant.value)
    }
    #[inline(always)]
    fn keep(self, mask: V::Mask) -> Self {
        Self { value: self.value.keep(mask), gradient: self.gradient.map(|part| part.keep(mask)) }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.sign())
    }
    #[inline(always)]
    fn sign(self) -> Self {
        Self::constant(self.value.sign())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, V::splat(0.5) / root)
    }
    #[inline(always)]
    fn exp_negative(self) -> Self {
        let power = self.value.exp_negative();
        self.chain(power, power)
    }
    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), V::splat(1.0) / self.value)
    }
    #[inline]
    fn sin_cos_turns(self) -> [Self; 2] {
        let [sin, cos] = self.value.sin_cos_turns();
        let turn = V::splat(std::f64::consts::TAU);
        [self.chain(sin, turn * cos), self.chain(cos, -(turn * sin))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares each operation with the central difference of the same expression in plain numbers.
    #[test]
    fn every_operation_follows_the_chain_rule() {
        fn expression<T: Scalar>(x: T, y: T) -> [T; 14] {
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
                x.pow(y - half),
                (x - y).exp(),
                x.sin_cos_turns()[0] * y.sin_cos_turns()[1],
                (half * (x - y)).ln_1p_ratio(),
                (half * half * half * (x - y)).ln_1p_ratio(),
            ]
        }
        for (x, y) in [(0.7, 1.3), (2.5, 0.4), (0.1, 3.0)] {
            let duals = expression(Dual { value: x, gradient: [1.0, 0.0] }, Dual { value: y, gradient: [0.0, 1.0] });
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

    /// Compares the exponent of Dahl's law near 1 with a series in `b = a − 1`, because the closed form itself is singular there: `ln(u'/u) =
    /// −w·g(b·w)` with `w = k·e^{bL}`, `L = ln u`.
    #[test]
    fn the_exponent_of_presliding_has_its_derivative_at_one() {
        use fric_core::effects::presliding_shape::PreslidingShape;
        for (start_n, displacement_m) in [(-0.9, 1e-4), (0.0, 3e-4), (0.3, 1e-3), (0.8, -2e-4), (0.999, 1e-4)] {
            let (sliding_n, sigma) = (0.7_f64, 2e3_f64);
            let s = f64::signum(displacement_m);
            let u = 1.0 - s * start_n / sliding_n;
            let (k, log) = (sigma * f64::abs(displacement_m) / sliding_n, u.abs().ln());
            for beyond in [0.0, 1e-12, -1e-12, 1e-9, -1e-9, 1e-7, -1e-7, 1e-5, -1e-5] {
                // −w g(bw) = −k[1 + b(L − k/2) + b²(L²/2 − kL + k²/3) + …].
                let first = log - 0.5 * k;
                let second = 0.5 * log * log - k * log + k * k / 3.0;
                let power = -k * (1.0 + beyond * first + beyond * beyond * second);
                let slope = -k * (first + 2.0 * beyond * second);
                let left = u * power.exp();
                let exponent = Dual { value: 1.0 + beyond, gradient: [1.0] };
                let constant = Dual::<f64, 1>::constant;
                let [start, sliding, sigma] = [start_n, sliding_n, sigma].map(constant);
                let stepped = PreslidingShape { exponent }.step(start, sliding, sigma, constant(displacement_m));
                // The neglected terms are of third order in b, and of second order in the derivative.
                let rest = 50.0 * beyond * beyond + 1e-12;
                assert!((stepped.value - s * sliding_n * (1.0 - left)).abs() < rest, "{start_n} {beyond:e}");
                let derivative = -s * sliding_n * left * slope;
                assert!((stepped.gradient[0] - derivative).abs() < rest, "{start_n} {beyond:e}: {derivative}");
            }
        }
    }
}
