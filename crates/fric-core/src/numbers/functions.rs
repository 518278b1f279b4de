//! Functions of [`Scalar`]s that only a few effects need. They too are built from exactly rounded operations.

use crate::scalar::{Mask, Scalar};

/// 1.5·2⁵²: adding it rounds to an integer.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// Greatest `|x|` at which `ln(1 + x)/x` is computed by a series; beyond it the logarithm is used.
const SERIES: f64 = 0.25;
/// Value that stands for `ln(1 + x)/x` where `x ≤ −1`, which has no logarithm.
const BEYOND: f64 = 1e3;

/// Returns the nearest integer, for magnitudes below 2⁵¹.
#[inline(always)]
fn round<T: Scalar>(x: T) -> T {
    (x + T::splat(ROUND)) - T::splat(ROUND)
}

/// Returns `ln(1 + x)/x`, 1 at 0. For small `x` it is the series `2/(2 + x)·(1 + z²/3 + z⁴/5 + …)` with `z = x/(2 + x)`.
#[inline(always)]
pub fn ln_1p_ratio<T: Scalar>(x: T) -> T {
    let (one, two) = (T::splat(1.0), T::splat(2.0));
    let (is_near, exists) = (x.within(SERIES), T::splat(-1.0).lt(x));
    // Each form is computed only where it is defined, so that no lane does an invalid operation.
    let small = x.keep(is_near);
    let large = T::select(is_near.not().and(exists), x, one);
    let inverse = one / (two + small);
    let z = small * inverse;
    let z2 = z * z;
    // |z| ≤ 1/7, so the first omitted term is at most 1/21·7⁻²⁰.
    let odd = [19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0];
    let sum = odd.into_iter().fold(T::splat(0.0), |sum, divisor| sum * z2 + T::splat(1.0 / divisor));
    let near = two * inverse * sum;
    let far = (one + large).ln() / large;
    T::select(is_near, near, T::select(exists, far, T::splat(BEYOND)))
}

/// Returns sine and cosine of `2π·turns`, `|turns| < 2⁴⁹`, from Taylor polynomials on ±1/8 turn, whose remainders are below 2⁻⁵⁸.
#[inline(always)]
pub fn sin_cos_turns<T: Scalar>(turns: T) -> [T; 2] {
    let zero = T::splat(0.0);
    let turns = turns - round(turns);
    let quarters = round(turns * T::splat(4.0));
    let angle = (turns - quarters * T::splat(0.25)) * T::splat(core::f64::consts::TAU);
    let square = angle * angle;
    let polynomial =
        |divisors: [f64; 8]| divisors.into_iter().fold(zero, |sum, divisor| (sum + T::splat(1.0 / divisor)) * square);
    let sin_divisors =
        [355_687_428_096_000.0, -1_307_674_368_000.0, 6_227_020_800.0, -39_916_800.0, 362_880.0, -5_040.0, 120.0, -6.0];
    let cos_divisors =
        [20_922_789_888_000.0, -87_178_291_200.0, 479_001_600.0, -3_628_800.0, 40_320.0, -720.0, 24.0, -2.0];
    let sin = angle + angle * polynomial(sin_divisors);
    let cos = T::splat(1.0) + polynomial(cos_divisors);
    // `quarters` is −2, −1, 0, 1 or 2.
    let odd = quarters.abs().eq(T::splat(1.0));
    let sin_falls = quarters.lt(zero).and(odd).or(T::splat(1.0).lt(quarters.abs()));
    let cos_falls = zero.lt(quarters);
    let (first, second) = (T::select(odd, cos, sin), T::select(odd, sin, cos));
    let cos_falls = cos_falls.or(quarters.lt(T::splat(-1.0)));
    [T::select(sin_falls, -first, first), T::select(cos_falls, -second, second)]
}
