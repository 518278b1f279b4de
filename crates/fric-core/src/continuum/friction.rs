//! One hole: what a tendon can lose in it, and the four ways to say what it does lose.

use super::tangent::Tangent;
use crate::dahl::dahl_step;
use crate::pulley::wrap_factor;
use crate::scalar::Scalar;

/// Which way the tendons slide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// The first tendon is pulled, the second pays out: friction is positive along the first.
    #[default]
    Pulling,
    /// The other way round.
    Releasing,
}

impl Direction {
    /// From the change of the first tendon's tension at the base: the published rule, \[C\] 11.
    #[must_use]
    pub fn of_change(change_n: f64) -> Self {
        if change_n < 0.0 { Self::Releasing } else { Self::Pulling }
    }
}

/// How the friction at the holes is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction<'a> {
    /// There is none: `T_i = T_0`.
    None,
    /// Every hole slides the same way, \[C\] 11–13.
    Coulomb(Direction),
    /// Tensions in the segments are known, \[C\] 14: of each tendon, from the base, N. An empty slice is a slack tendon.
    Measured([&'a [f64]; 2]),
    /// A Dahl contact at every hole remembers how the tendon has moved through it. Needs every step of the run of base tensions, from
    /// a relaxed tendon on, and no sensor within the manipulator.
    History,
}

/// Load on the contact in a hole: the vector sum of the tensions on both sides, \[C\] 12.
///
/// `F_N = |T_{i−1} + T_i| = √((T_{i−1} − T_i)² + T_{i−1}T_i k²)`, `k = 2 sin(α/2)` with the angle α by which the tendon turns
/// in the hole. In N; `base_side_n`, `tip_side_n` ≥ 0. Without any tension it is 10⁻¹² N, so that it has a derivative.
#[must_use]
pub fn contact_load<T: Scalar>(base_side_n: T, tip_side_n: T, wrap_factor: T) -> T {
    let difference_n = base_side_n - tip_side_n;
    let across = base_side_n * tip_side_n * wrap_factor * wrap_factor;
    (difference_n * difference_n + across.max(T::splat(0.0)) + T::splat(1e-24)).sqrt()
}

/// `T_i/T_{i−1}` of a hole through which the tendon slides towards the base, \[C\] 11–13 solved.
///
/// From `T_{i−1} − T_i = μ·F_N` with [`contact_load`]: `x = 1 + g²/2 − g√(1 + g²/4)`, `g = μk/√(1 − μ²)`. Sliding towards the
/// tip it is `1/x`. For many holes it tends to `e^{−μ'θ}` with the sum θ of their angles and `μ' = μ/√(1 − μ²)`: the load of
/// \[C\] 12 is the whole force on the hole, friction included. That is the capstan's `e^{−μθ}` but for a share of `μ³θ/2`. `mu` in 0…0.9.
///
/// ```
/// use fric_core::continuum::{contact_load, sliding_ratio};
/// let ratio = sliding_ratio(0.2, 0.3);
/// assert!((1.0 - ratio - 0.2 * contact_load(1.0, ratio, 0.3)).abs() < 1e-15);
/// ```
#[must_use]
pub fn sliding_ratio<T: Scalar>(mu: T, wrap_factor: T) -> T {
    let one = T::splat(1.0);
    let half = T::splat(0.5);
    let g = mu * wrap_factor / (one - mu * mu).sqrt();
    let half_g = half * g;
    one + half * g * g - g * (one + half_g * half_g).sqrt()
}

/// A contact: what one hole needs to know of itself.
#[derive(Clone, Copy, Debug)]
pub struct Hole {
    pub mu: f64,
    pub sigma_n_per_m: f64,
}

/// Friction at a hole and its slopes with respect to the tensions on both sides, the angle and the tendon's motion.
#[derive(Clone, Copy, Debug)]
pub struct HoleFriction {
    pub friction_n: f64,
    /// With respect to `T_{i−1}`, `T_i`, α and the motion.
    pub slopes: [f64; 4],
}

/// What a hole sees.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    pub base_side_n: f64,
    pub tip_side_n: f64,
    /// By which the tendon turns, either sign.
    pub wrap_rad: f64,
    /// Towards the base, since the last step.
    pub motion_m: f64,
}

impl Passage {
    /// The tensions, the wrap factor and the motion as functions of the four numbers.
    fn tangents(&self) -> (Tangent, Tangent, Tangent, Tangent) {
        let (_, cos) = super::arc::sin_cos(0.5 * self.wrap_rad);
        let side = if self.wrap_rad < 0.0 { -1.0 } else { 1.0 };
        (
            Tangent::variable(self.base_side_n, 0, 1.0),
            Tangent::variable(self.tip_side_n, 1, 1.0),
            Tangent::variable(wrap_factor(side * self.wrap_rad), 2, side * cos),
            Tangent::variable(self.motion_m, 3, 1.0),
        )
    }
}

impl Hole {
    /// Greatest friction, `μ·F_N`, \[C\] 13.
    pub fn bound_n(&self, passage: &Passage) -> f64 {
        let factor = wrap_factor(passage.wrap_rad.abs());
        self.mu * contact_load(passage.base_side_n.max(0.0), passage.tip_side_n.max(0.0), factor)
    }

    /// Sliding, \[C\] 11–13; `towards_base` is the direction.
    pub fn sliding(&self, passage: &Passage, towards_base: bool) -> HoleFriction {
        let (base_side, _, factor, _) = passage.tangents();
        let one = Tangent::constant(1.0);
        let ratio = sliding_ratio(Tangent::constant(self.mu), factor);
        let ratio = if towards_base { ratio } else { one / ratio };
        let Tangent { value: friction_n, slopes } = base_side * (one - ratio);
        HoleFriction { friction_n, slopes }
    }

    /// After a motion, from the friction stored: [`dahl_step`] with `f_c = μ·F_N` of the end of the step.
    ///
    /// Where the load has dropped so far that the hole cannot hold what is stored, it starts from what it can hold: the
    /// tendon is free to slip, and friction that fell with the way of the tendon would have more than one equilibrium.
    pub fn presliding(&self, passage: &Passage, stored_n: f64) -> HoleFriction {
        let (base_side, tip_side, factor, motion) = passage.tangents();
        let zero = Tangent::constant(0.0);
        let sliding = Tangent::constant(self.mu) * contact_load(base_side.max(zero), tip_side.max(zero), factor);
        let sigma = Tangent::constant(self.sigma_n_per_m);
        let held = Tangent::constant(stored_n).min(sliding).max(-sliding);
        let Tangent { value: friction_n, mut slopes } = dahl_step(held, sliding, sigma, motion);
        if let (true, [.., motion_slope]) = (passage.motion_m == 0.0, &mut slopes) {
            // At rest there is a slope for either direction. The steeper one takes the tendon for stuck, which it is until
            // the first iteration has told its direction.
            let share = held.value.abs() / sliding.value.max(1e-30);
            *motion_slope = self.sigma_n_per_m * (1.0 + share);
        }
        HoleFriction { friction_n, slopes }
    }
}
