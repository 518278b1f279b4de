//! The friction of one hole: its greatest value, and four ways to determine the actual one.
//!
//! A hole is a pulley's bearing that the tendon itself slides on, and takes its contact from [`fric_core::pulley`]: `f_c = μ·F_N` with
//! `F_N = (T_{i−1} + T_i)·sin(α/2)` for the angle α by which the tendon turns. That is the part of the vector sum of both tensions (\[C\] 12)
//! that presses on the hole, as \[C\] 16 has it where μ is measured; many holes tend to the capstan's `e^{−μθ}`. Deviation: the
//! magnitude of the whole sum would count the friction itself as load, 1/√(1 − μ²) times as much (1.6 % at μ = 0.1753).

use fric_core::dahl::dahl_step;
use fric_core::pulley::{sliding_friction, sliding_gains, wrap_factor};
use fric_core::scalar::Scalar;

use super::solver::tangent::Tangent;

/// The sliding direction of the tendons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// The first tendon is pulled, the second pays out: friction is positive along the first.
    #[default]
    Pulling,
    /// The opposite.
    Releasing,
}

impl Direction {
    /// Returns the direction from the change of the first tendon's base tension: the published rule, \[C\] 11.
    #[must_use]
    pub fn of_change(change_n: f64) -> Self {
        if change_n < 0.0 { Self::Releasing } else { Self::Pulling }
    }
}

/// The way to determine the friction at the holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction<'a> {
    /// No friction: `T_i = T_0`.
    None,
    /// Every hole slides in the same direction, \[C\] 11–13.
    Coulomb(Direction),
    /// The tensions in the segments are known, \[C\] 14: of each tendon, starting at the base, N. An empty slice is a slack tendon.
    Measured([&'a [f64]; 2]),
    /// A Dahl contact at every hole remembers the motion of the tendon through it. It needs every step of the base tensions, starting with a relaxed
    /// tendon, but no sensor within the manipulator.
    History,
}

/// The contact parameters of one hole.
#[derive(Clone, Copy, Debug)]
pub struct Hole {
    pub mu: f64,
    pub sigma_n_per_m: f64,
}

/// Friction at a hole and its slopes with respect to the tensions on both sides, the angle and the tendon's motion.
#[derive(Clone, Copy, Debug)]
pub struct HoleFriction {
    pub friction_n: f64,
    /// Slopes with respect to `T_{i−1}`, `T_i`, α and the motion.
    pub slopes: [f64; 4],
}

/// The tendon's state at a hole.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    pub base_side_n: f64,
    pub tip_side_n: f64,
    /// Angle by which the tendon turns, either sign.
    pub wrap_rad: f64,
    /// Motion towards the base since the last step.
    pub motion_m: f64,
}

impl Passage {
    /// Returns the tensions, the wrap factor and the motion as functions of the four numbers.
    fn tangents(&self) -> (Tangent, Tangent, Tangent, Tangent) {
        let side = if self.wrap_rad < 0.0 { -1.0 } else { 1.0 };
        let factor = wrap_factor(side * self.wrap_rad);
        // The cosine of half the angle, which is below a right angle, from its sine.
        let cos = Scalar::sqrt((1.0 - 0.25 * factor * factor).max(0.0));
        (
            Tangent::variable(self.base_side_n, 0, 1.0),
            Tangent::variable(self.tip_side_n, 1, 1.0),
            Tangent::variable(factor, 2, side * cos),
            Tangent::variable(self.motion_m, 3, 1.0),
        )
    }
}

impl Hole {
    /// Returns the greatest friction, `μ·F_N`, \[C\] 13.
    pub fn bound_n(&self, passage: &Passage) -> f64 {
        let factor = wrap_factor(passage.wrap_rad.abs());
        sliding_friction(self.mu, factor, passage.base_side_n.max(0.0), passage.tip_side_n.max(0.0))
    }

    /// Returns the sliding friction, \[C\] 11–13; `towards_base` is the direction.
    pub fn sliding(&self, passage: &Passage, towards_base: bool) -> HoleFriction {
        let (base_side, _, factor, _) = passage.tangents();
        let direction = Tangent::constant(if towards_base { -1.0 } else { 1.0 });
        let (gain, _) = sliding_gains(direction, Tangent::constant(self.mu), factor);
        let Tangent { value: friction_n, slopes } = base_side * (Tangent::constant(1.0) - gain);
        HoleFriction { friction_n, slopes }
    }

    /// Returns the friction after a motion, from the stored friction: [`dahl_step`] with `f_c = μ·F_N` at the end of the step.
    ///
    /// If the load has dropped so far that the hole cannot hold the stored friction, the step starts from the friction that it can hold, because the
    /// tendon is free to slip. Friction that fell with the displacement of the tendon would have more than one equilibrium.
    pub fn presliding(&self, passage: &Passage, stored_n: f64) -> HoleFriction {
        let (base_side, tip_side, factor, motion) = passage.tangents();
        let zero = Tangent::constant(0.0);
        let sliding = sliding_friction(Tangent::constant(self.mu), factor, base_side.max(zero), tip_side.max(zero));
        let sigma = Tangent::constant(self.sigma_n_per_m);
        let held = Tangent::constant(stored_n).min(sliding).max(-sliding);
        let Tangent { value: friction_n, mut slopes } = dahl_step(held, sliding, sigma, motion);
        if let (true, [.., motion_slope]) = (passage.motion_m == 0.0, &mut slopes) {
            // At rest there is a slope for either direction. The steeper one treats the tendon as stuck, which is right until the first iteration has
            // determined its direction.
            let share = held.value.abs() / sliding.value.max(1e-30);
            *motion_slope = self.sigma_n_per_m * (1.0 + share);
        }
        HoleFriction { friction_n, slopes }
    }
}
