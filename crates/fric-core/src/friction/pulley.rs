//! Macroscopic friction of cable pulleys: bearing friction, the sensor pulley, the slip limit.
//!
//! It computes the tension behind a pulley from the tension before it, in steady motion (\[P\] 4–14). Presliding, which smooths the reversal, is in
//! [`dahl`](crate::dahl). No state. Non-finite input gives non-finite output; the caller ([`Compensator`](crate::Compensator)) excludes it.
//!
//! | symbol | identifier | unit | range |
//! |---|---|---|---|
//! | `F_{j−1}`, `F_j` | `upstream_n`, `downstream_n`: tension on the winch side, on the platform side | N | ≥ 0 |
//! | `F_s` | `sensor_force_n` | N | ≥ 0 |
//! | `μ` | `mu`, bearing friction on the normal force | 1 | 0…0.9 |
//! | `F_pv` | `viscous_n_s_per_m`, each pulley's | N s/m | ≥ 0 |
//! | `v` | `speed_m_per_s`, positive paying out | m/s | |
//! | `s` | `direction`, −1, 0 or +1 | 1 | |
//! | `k` | `wrap_factor` = `2 sin(α/2)` | 1 | 0…2 |
//! | `c` | `sensor_cos` = `cos α₁` | 1 | −1…0.99 |
//!
//! **Sign convention**, here and everywhere: cable length grows when the cable pays out, `v = dl/dt`; when paying out, friction makes the platform
//! side tighter than the winch side. \[P\] is the paper named in the crate's documentation; the numbers are its equations.

use crate::scalar::{Mask, Scalar};

/// Returns the ratio of the normal force on a bearing to the mean cable tension: `k = √(2(1 − cos α)) = 2 sin(α/2)` (\[P\] 8).
///
/// `wrap_rad` is the wrap angle α in `0…2π`; 0 gives 0, a pulley without load.
///
/// ```
/// let right_angle = fric_core::pulley::wrap_factor(core::f64::consts::FRAC_PI_2);
/// assert!((right_angle - 2f64.sqrt()).abs() < 1e-15);
/// ```
#[must_use]
pub fn wrap_factor(wrap_rad: f64) -> f64 {
    2.0 * libm::sin(0.5 * wrap_rad)
}

/// Returns gain and viscous gain of one pulley in steady sliding.
///
/// `F_j = gain·F_{j−1} + viscous_gain·F_pv·v` is \[P\] 10 with `gain = (2 + sμk)/(2 − sμk)` and `viscous_gain = 2/(2 − sμk)`. At `s = 0` both are 1.
/// The caller must ensure `μk < 2`.
#[inline(always)]
pub fn sliding_gains<T: Scalar>(direction: T, mu: T, wrap_factor: T) -> (T, T) {
    let two = T::splat(2.0);
    let coulomb = mu.scale(direction).scale(wrap_factor);
    let inverse = T::splat(1.0) / (two - coulomb);
    ((two + coulomb) * inverse, two * inverse)
}

/// Returns gain and viscous gain behind the sensor pulley in steady sliding.
///
/// `F_1 = gain·F_s + viscous_gain·F_pv·v`, from the equilibrium of the sensor pulley `F_1 − F_0 cos α₁ = F_s` (\[P\] 11)
/// and \[P\] 10: `gain = (2 + sμk)/d`, `viscous_gain = −2c/d`, `d = (2 + sμk) − c(2 − sμk)`.
///
/// The paper solves 90° (`F_1 = F_s`, \[P\] 12) and 180° (`F_1 = F_s(1 + sμ)/2`, \[P\] 14); this is the solution for every angle. It is singular
/// where the wrap vanishes, which [`CableParams`](crate::CableParams) refuses.
#[inline(always)]
pub fn sensor_gains<T: Scalar>(direction: T, mu: T, wrap_factor: T, sensor_cos: T) -> (T, T) {
    let two = T::splat(2.0);
    let coulomb = mu.scale(direction).scale(wrap_factor);
    let plus = two + coulomb;
    let inverse = T::splat(1.0) / (plus - sensor_cos * (two - coulomb));
    (plus * inverse, -(two * sensor_cos) * inverse)
}

/// Returns the bearing friction at which a pulley slides: `μ·F_N` with `F_N = k(F_{j−1} + F_j)/2` (\[P\] 8).
///
/// It is never negative: if a tension computed with large viscous friction falls below zero, the bearing has no load.
#[inline(always)]
pub fn sliding_friction<T: Scalar>(mu: T, wrap_factor: T, upstream_n: T, downstream_n: T) -> T {
    (mu.scale(T::splat(0.5)).scale(wrap_factor) * (upstream_n + downstream_n)).max(T::splat(0.0))
}

/// Returns the tension ratio at which the cable slips on a pulley: `e^{μ_p α}` (\[P\] 4, Eytelwein), with the friction coefficient `traction_mu`
/// between cable and pulley and the wrap angle `wrap_rad`.
#[must_use]
pub fn traction_ratio(traction_mu: f64, wrap_rad: f64) -> f64 {
    libm::exp(traction_mu * wrap_rad)
}

/// A traction ratio beyond this means that the cable cannot slip; `e^{μ_p α}` is below 3·10⁵.
pub const NO_LIMIT_RATIO: f64 = 1e6;

/// Returns the tension behind a pulley limited to the slip limit, and whether it was limited (\[P\] 4, Eytelwein).
///
/// `traction_ratio = e^{μ_p α}` with the friction coefficient `μ_p` between cable and pulley: the cable slips when `F_j/F_{j−1}` leaves
/// `[1/traction_ratio, traction_ratio]`; the ratio is then held at that bound. If the cable arrives without tension, or if the ratio is beyond
/// [`NO_LIMIT_RATIO`], there is no slip and `downstream_n` is unchanged.
#[inline(always)]
pub fn limit_traction<T: Scalar>(upstream_n: T, downstream_n: T, traction_ratio: T) -> (T, T::Mask) {
    let greatest = upstream_n * traction_ratio;
    let least = upstream_n / traction_ratio;
    let limited = T::splat(0.0).lt(upstream_n).and(traction_ratio.le(T::splat(NO_LIMIT_RATIO)));
    let slips = limited.and(greatest.lt(downstream_n).or(downstream_n.lt(least)));
    (T::select(slips, downstream_n.min(greatest).max(least), downstream_n), slips)
}

/// Returns the tensions before and behind a sensor pulley on which the cable slips.
///
/// Neither tension is given there, only `F_1 − c·F_0 = F_s` (\[P\] 11). With `F_1/F_0` at the bound that the tensions without slip exceed (\[P\] 4),
/// `F_1 = F_s/(1 − c·F_0/F_1)`.
#[inline(always)]
pub fn slipping_sensor<T: Scalar>(
    sensor_force_n: T,
    sensor_cos: T,
    (upstream_n, downstream_n): (T, T),
    traction_ratio: T,
) -> (T, T) {
    let one = T::splat(1.0);
    let inverse = T::select(downstream_n.lt(upstream_n), traction_ratio, one / traction_ratio);
    // The divisor is positive wherever the cable slips; the bound keeps a vanishing sensor force from dividing by zero.
    let held_n = sensor_force_n / (one - sensor_cos * inverse).max(T::splat(1e-9));
    (held_n * inverse, held_n)
}
