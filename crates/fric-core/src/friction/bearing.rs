//! The friction law of a cable's bearings in one cycle, with every effect that changes it.
//!
//! What is the same for all pulleys is computed once per cycle. Which effects act is decided outside the arithmetic, so effects that do not act cost
//! nothing.

use crate::cable::{Cable, CableModel, Moment};
use crate::dahl::dahl_step;
use crate::effects::bearing_drag::{self, BearingDrag};
use crate::effects::direction_asymmetry::{self, DirectionAsymmetry};
use crate::effects::dwell_stiction::{self, DwellStiction};
use crate::effects::empirical;
use crate::effects::friction_drift::{self, FrictionDrift};
use crate::effects::friction_ripple;
use crate::effects::friction_warmup::{self, FrictionWarmup};
use crate::effects::load_nonlinearity::{self, LoadNonlinearity};
use crate::effects::load_release::{self, LoadRelease};
use crate::effects::presliding_shape::{self, PreslidingShape};
use crate::effects::pulley_defect::{self, PulleyDefect};
use crate::effects::pulley_inertia::{self, PulleyInertia};
use crate::effects::stribeck::{self, Stribeck};
use crate::effects::viscous_nonlinearity::{self, ViscousNonlinearity};
use crate::effects::{Acting, UNKNOWN};
use crate::pulley::sliding_friction;
use crate::scalar::{Mask, Scalar};
use crate::signals::CableSignals;

/// Effects that can raise μ beyond the greatest value that the sensor pulley allows.
const RAISES_MU: Acting = Acting::raising_mu();

/// The friction law of a cable's bearings in one cycle.
#[derive(Clone, Copy, Debug)]
pub struct Bearing<T: Scalar> {
    acting: Acting,
    /// μ at the present speed and time, 1.
    mu: T,
    /// The same for the pulley of the effect `pulley_defect`, which has a μ of its own.
    defect_mu: T,
    greatest_mu: T,
    sigma_n_per_m: T,
    speed_m_per_s: T,
    /// Force that accelerates one pulley, N.
    accelerating_n: T,
    /// Friction of one pulley that grows with the square of the speed, N.
    quadratic_n: T,
}

impl<T: Scalar> Bearing<T> {
    /// Computes the law for the signals of a cycle. `unnamed_factor` is the factor on μ of the effect `empirical`.
    #[inline(always)]
    pub fn new(
        model: &CableModel<T>,
        acting: Acting,
        signals: &CableSignals<T>,
        (moment, unnamed_factor): (&Moment<T>, T),
        cable: &mut impl Cable<T>,
    ) -> Self {
        let mut accelerating_n = T::splat(0.0);
        if acting.has(pulley_inertia::ACTS) {
            let inertia = PulleyInertia::of(|place| cable.effect(place));
            let filtered_m_per_s = pulley_inertia::SPEEDS.map(|place| cable.memory(place));
            let (force_n, next_m_per_s) = inertia.force_n(signals.speed_m_per_s, filtered_m_per_s, moment.step_s);
            // After an invalid motion the low-pass filters start anew, so that the force has no bump.
            for (place, next_m_per_s) in pulley_inertia::SPEEDS.into_iter().zip(next_m_per_s) {
                cable.set_memory(place, T::select(signals.moves, next_m_per_s, T::splat(UNKNOWN)));
            }
            accelerating_n = force_n.keep(signals.moves);
        }
        let value = |place| cable.effect(place);
        let defect_mu = if acting.has(pulley_defect::ACTS) { PulleyDefect::of(value).mu } else { T::splat(0.0) };
        let mut mus = [model.mu, defect_mu];
        let mut multiply = |factor: T| mus = mus.map(|mu| mu * factor);
        if acting.has(dwell_stiction::ACTS) {
            let dwell = DwellStiction::of(|place| cable.effect(place));
            let age = cable.memory(dwell_stiction::AGE);
            let (factor, next) = dwell.factor(age, signals.displacement_m, moment.step_s);
            cable.set_memory(dwell_stiction::AGE, next);
            multiply(factor);
        }
        if acting.has(stribeck::ACTS) {
            let before_m_per_s = cable.memory(stribeck::SPEED);
            multiply(Stribeck::of(|place| cable.effect(place)).factor(signals.speed_m_per_s, before_m_per_s));
            cable.set_memory(stribeck::SPEED, T::select(signals.moves, signals.speed_m_per_s, T::splat(UNKNOWN)));
        }
        let value = |place| cable.effect(place);
        if acting.has(friction_drift::ACTS) {
            multiply(FrictionDrift::of(value).factor(moment.time_s));
        }
        if acting.has(friction_warmup::ACTS) {
            multiply(FrictionWarmup::of(value).factor(moment.time_s));
        }
        if acting.has(friction_ripple::ACTS) {
            multiply(friction_ripple::times(T::splat(1.0), acting, value, signals.length_m));
        }
        if acting.has(empirical::ACTS) {
            multiply(unnamed_factor);
        }
        let [mu, defect_mu] = mus;
        let quadratic_n = if acting.has(viscous_nonlinearity::ACTS) {
            let pulleys = (0..cable.count()).fold(T::splat(0.0), |sum, place| sum + cable.present(place));
            let all_n = ViscousNonlinearity::of(value).force_n(signals.speed_m_per_s);
            all_n.scale(T::splat(1.0) / pulleys.max(T::splat(1.0)))
        } else {
            T::splat(0.0)
        };
        Self {
            acting,
            mu,
            defect_mu,
            greatest_mu: if acting.has(RAISES_MU) { cable.greatest_mu() } else { mu },
            sigma_n_per_m: model.sigma_n_per_m,
            speed_m_per_s: signals.speed_m_per_s,
            accelerating_n,
            quadratic_n,
        }
    }

    /// Returns what a pulley adds to the tension without a presliding distance, N: viscous friction and inertia.
    #[inline(always)]
    pub fn viscous_n(&self, place: usize, cable: &impl Cable<T>) -> T {
        let mut viscous_n = cable.viscous_n(place, self.speed_m_per_s);
        if self.acting.has(direction_asymmetry::ACTS) {
            viscous_n = viscous_n * asymmetry(cable).viscous_factor(self.speed_m_per_s.sign());
        }
        if self.acting.has(viscous_nonlinearity::ACTS) {
            viscous_n = viscous_n + self.quadratic_n.scale(cable.present(place));
        }
        if self.acting.has(pulley_inertia::ACTS) {
            viscous_n = viscous_n + self.accelerating_n.scale(cable.present(place));
        }
        viscous_n
    }

    /// Returns μ of the pulley at a position, between two tensions, for a direction of motion (−1, 0, +1).
    #[inline(always)]
    pub fn mu_at(&self, place: usize, tensions: (T, T), direction: T, cable: &impl Cable<T>) -> T {
        let mut mu = self.mu;
        if self.acting.has(pulley_defect::ACTS) {
            let is_defect = PulleyDefect::of(|place| cable.effect(place)).is_at(cable.pulley_number(place));
            mu = T::select(is_defect, self.defect_mu, mu);
        }
        if self.acting.has(direction_asymmetry::ACTS) {
            mu = mu * asymmetry(cable).coulomb_factor(direction);
        }
        if self.acting.has(load_nonlinearity::ACTS) {
            let normal_n = normal_n(place, tensions, cable);
            mu = mu * LoadNonlinearity::of(|place| cable.effect(place)).factor(normal_n);
        }
        if self.acting.has(RAISES_MU) { mu.min(self.greatest_mu) } else { mu }
    }

    /// Whether μ depends on the load, so that [`mu_at`](Self::mu_at) must be evaluated again after the tensions have changed.
    #[inline(always)]
    pub fn depends_on_load(&self) -> bool {
        self.acting.has(load_nonlinearity::ACTS)
    }

    /// Returns the μ at whose load [`tangent`](Self::tangent)s are drawn first: the greatest for an exponent below 1, none above. The friction law is
    /// concave over the load for the one, convex for the other, so Newton's method comes from that side.
    #[inline(always)]
    pub fn first_mu(&self, cable: &impl Cable<T>) -> T {
        let is_concave = LoadNonlinearity::of(|place| cable.effect(place)).exponent.lt(T::splat(1.0));
        self.greatest_mu.keep(is_concave)
    }

    /// Returns the tangent to the friction law `f(F_N)` where it has `mu` between two tensions: its slope, and its value at `F_N = 0`, N.
    ///
    /// `f ∝ F_N^p` has the slope `p·μ`, and `μ` itself where `f` is held at the greatest μ. No slope is above that one, with which every pulley has a
    /// solution; a convex law that is steeper has none short of it.
    #[inline(always)]
    pub fn tangent(&self, place: usize, mu: T, tensions: (T, T), cable: &impl Cable<T>) -> (T, T) {
        let exponent = LoadNonlinearity::of(|place| cable.effect(place)).exponent;
        let greatest_mu = self.greatest_mu;
        let slope = T::select(mu.lt(greatest_mu), (exponent * mu).min(greatest_mu), greatest_mu);
        (slope, (mu - slope) * normal_n(place, tensions, cable))
    }

    /// Whether the bearings of any cable have friction that does not depend on the load.
    #[inline(always)]
    pub fn drags(&self) -> bool {
        self.acting.has(bearing_drag::ACTS)
    }

    /// Returns the load-independent friction of the pulley at a position, N.
    #[inline(always)]
    pub fn drag_n(place: usize, cable: &impl Cable<T>) -> T {
        BearingDrag::of(|place| cable.effect(place)).drag_n.scale(cable.present(place))
    }

    /// Returns the friction stored by the bearing of a pulley after a displacement, between two tensions, N.
    #[inline(always)]
    pub fn move_pulley(
        &self,
        place: usize,
        (stored_n, tensions): (T, (T, T)),
        displacement_m: T,
        cable: &impl Cable<T>,
    ) -> T {
        let wrap_factor = cable.wrap_factor(place);
        let mu = self.mu_at(place, tensions, displacement_m.sign(), cable);
        let mut sliding_n = sliding_friction(mu, wrap_factor, tensions.0, tensions.1);
        if self.drags() {
            sliding_n = sliding_n + Self::drag_n(place, cable);
        }
        self.preslide(stored_n, sliding_n, displacement_m, cable)
    }

    /// Returns the direction for which sliding friction is computed: that of the motion. At rest, with the effect `load_release`, it is the direction
    /// of the stored friction.
    #[inline(always)]
    pub fn direction(&self, displacement_m: T, stored_n: T, cable: &impl Cable<T>) -> T {
        let direction = displacement_m.sign();
        if !self.acting.has(load_release::ACTS) {
            return direction;
        }
        let zero = T::splat(0.0);
        let releases = zero.lt(LoadRelease::of(|place| cable.effect(place)).ratio);
        T::select(releases.and(displacement_m.eq(zero)), stored_n.sign(), direction)
    }

    /// Returns the friction stored after a displacement, N.
    #[inline(always)]
    pub fn preslide(&self, friction_n: T, sliding_n: T, displacement_m: T, cable: &impl Cable<T>) -> T {
        let friction_n = if self.acting.has(load_release::ACTS) {
            LoadRelease::of(|place| cable.effect(place)).held_n(friction_n, sliding_n)
        } else {
            friction_n
        };
        if self.acting.has(presliding_shape::ACTS) {
            let shape = PreslidingShape::of(|place| cable.effect(place));
            shape.step(friction_n, sliding_n, self.sigma_n_per_m, displacement_m)
        } else {
            dahl_step(friction_n, sliding_n, self.sigma_n_per_m, displacement_m)
        }
    }
}

/// Returns the normal force on the bearing of the pulley at a position between two tensions, N (\[P\] 8).
#[inline(always)]
fn normal_n<T: Scalar>(place: usize, (upstream_n, downstream_n): (T, T), cable: &impl Cable<T>) -> T {
    (upstream_n + downstream_n).scale(cable.wrap_factor(place)).scale(T::splat(0.5))
}

#[inline(always)]
fn asymmetry<T: Scalar>(cable: &impl Cable<T>) -> DirectionAsymmetry<T> {
    DirectionAsymmetry::of(|place| cable.effect(place))
}
