//! A number that carries its derivatives with respect to four others.
//!
//! With it, the functions that compute the friction of a contact also give its slopes.

use core::ops::{Add, Div, Mul, Neg, Sub};

use fric_core::scalar::Scalar;

/// Number of derivatives.
const COUNT: usize = 4;

/// A value and its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Tangent {
    pub value: f64,
    pub slopes: [f64; COUNT],
}

impl Tangent {
    pub const fn constant(value: f64) -> Self {
        Self { value, slopes: [0.0; COUNT] }
    }

    /// Returns the `place`-th of the four numbers, or a function of it with this slope.
    pub fn variable(value: f64, place: usize, slope: f64) -> Self {
        Self { value, slopes: core::array::from_fn(|other| if other == place { slope } else { 0.0 }) }
    }

    /// Returns `value` with the slopes `a·self' + b·other'`.
    fn chain(self, value: f64, own: f64, other: Self, others: f64) -> Self {
        let mut slopes = self.slopes;
        for (slope, other) in slopes.iter_mut().zip(other.slopes) {
            *slope = own * *slope + others * other;
        }
        Self { value, slopes }
    }

    fn map(self, value: f64, own: f64) -> Self {
        Self { value, slopes: self.slopes.map(|slope| own * slope) }
    }
}

impl Add for Tangent {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.chain(self.value + other.value, 1.0, other, 1.0)
    }
}

impl Sub for Tangent {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.chain(self.value - other.value, 1.0, other, -1.0)
    }
}

impl Mul for Tangent {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.chain(self.value * other.value, other.value, other, self.value)
    }
}

impl Div for Tangent {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.chain(quotient, 1.0 / other.value, other, -quotient / other.value)
    }
}

impl Neg for Tangent {
    type Output = Self;
    fn neg(self) -> Self {
        self.map(-self.value, -1.0)
    }
}

impl Scalar for Tangent {
    type Mask = bool;
    const COUNT: usize = 1;

    fn splat(value: f64) -> Self {
        Self::constant(value)
    }
    fn from_lanes(mut value: impl FnMut(usize) -> f64) -> Self {
        Self::constant(value(0))
    }
    fn lane(self, _: usize) -> f64 {
        self.value
    }
    fn lt(self, other: Self) -> bool {
        self.value < other.value
    }
    fn le(self, other: Self) -> bool {
        self.value <= other.value
    }
    fn eq(self, other: Self) -> bool {
        self.value == other.value
    }
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
    fn abs(self) -> Self {
        self.map(self.value.abs(), self.value.sign())
    }
    fn sqrt(self) -> Self {
        let root = Scalar::sqrt(self.value);
        self.map(root, 0.5 / root)
    }
    fn exp_negative(self) -> Self {
        let power = self.value.exp_negative();
        self.map(power, power)
    }
    fn ln(self) -> Self {
        self.map(Scalar::ln(self.value), 1.0 / self.value)
    }
    fn sin_cos_turns(self) -> [Self; 2] {
        let [sin, cos] = self.value.sin_cos_turns();
        let turn = core::f64::consts::TAU;
        [self.map(sin, turn * cos), self.map(cos, -turn * sin)]
    }
}
