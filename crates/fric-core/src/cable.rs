//! Friction of one cable over one cycle: the chain of its pulleys with presliding, in the two forms that are wanted.
//!
//! For: sensor force and displacement in, force at the platform out ([`cable_step`]). Generic over [`Scalar`], so the
//! control cycle (four cables at once) and a fit that carries derivatives run the very same code. It does not judge
//! signals: whoever calls it passes finite numbers ([`Compensator`](crate::Compensator) sees to that). State: one number
//! per pulley, or one per cable, kept by the caller: behind [`Pulleys`], or passed as `lumped_friction_n`.
//!
//! Symbols and sign convention are those of [`pulley`].

use crate::dahl::dahl_step;
use crate::effects::stribeck::Stribeck;
use crate::pulley;
use crate::scalar::{Mask, Scalar};

/// Parameters of a cable as the cycle uses them.
#[derive(Clone, Copy, Debug)]
pub struct CableModel<T: Scalar> {
    /// Bearing friction μ on the normal force, 1.
    pub mu: T,
    /// Presliding stiffness σ of one Dahl state: the whole cable's for `lumped`, its n-th part for `per_pulley`, N/m.
    pub sigma_n_per_m: T,
    /// Force added at the platform, ε of \[P\] 18, N.
    pub offset_n: T,
    /// cos α₁ of the sensor pulley; 0 for a sensor in line with the cable.
    pub sensor_cos: T,
    /// `1/(1 − cos α₁)`: from sensor force to cable tension without friction, 1.
    pub frictionless_gain: T,
    /// One state per cable (\[P\]'s) instead of one per pulley.
    pub lumped: T::Mask,
    /// Friction falling with speed.
    pub stribeck: Stribeck<T>,
}

/// One pulley of a cable. All zero is a pulley that is not there.
#[derive(Clone, Copy, Debug)]
pub struct Pulley<T> {
    /// `2 sin(α/2)` of its wrap.
    pub wrap_factor: T,
    /// F_pv, N s/m.
    pub viscous_n_s_per_m: T,
}

/// The pulleys of a cable in order from the winch, and the friction force each has stored (`per_pulley`).
///
/// Pulley 0 is the sensor pulley; a sensor in line with the cable is a sensor pulley without wrap.
pub trait Pulleys<T> {
    /// How many, at least 1.
    fn count(&self) -> usize;
    /// The pulley at a place.
    fn pulley(&self, place: usize) -> Pulley<T>;
    /// `e^{μ_p α}` there, the tension ratio at which the cable slips; beyond
    /// [`NO_LIMIT_RATIO`](pulley::NO_LIMIT_RATIO) where it cannot.
    fn traction_ratio(&self, place: usize) -> T;
    /// Its stored Coulomb friction, N.
    fn friction_n(&self, place: usize) -> T;
    /// Stores it.
    fn set_friction_n(&mut self, place: usize, friction_n: T);
}

/// What may differ between robots but not between the lanes of one: decided once a cycle, outside the arithmetic.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "independent switches, each read on its own")]
pub struct Features {
    /// Some cable has one Dahl state per pulley.
    pub per_pulley: bool,
    /// Some cable has one Dahl state in all.
    pub lumped: bool,
    /// Some cable has a slip limit.
    pub traction: bool,
    /// Some cable has the Stribeck effect.
    pub stribeck: bool,
}

/// Signals of one cable in one cycle, all finite.
#[derive(Clone, Copy, Debug)]
pub struct CableSignals<T> {
    /// Sensor force, N.
    pub sensor_force_n: T,
    /// Change of length since the last cycle, m.
    pub displacement_m: T,
    /// Speed, m/s.
    pub speed_m_per_s: T,
}

/// Outcome of one cycle for one cable.
#[derive(Clone, Copy, Debug)]
pub struct CableForces<T: Scalar> {
    /// Force at the platform, N.
    pub platform_force_n: T,
    /// Sensor force turned into cable tension as if nothing rubbed, N.
    pub frictionless_n: T,
    /// The `lumped` state after the cycle, N.
    pub lumped_friction_n: T,
    /// The sensor shows no tension.
    pub no_tension: T::Mask,
    /// The cable carries no tension at the platform, or none at all.
    pub slack: T::Mask,
    /// Slip on a pulley.
    pub slip: T::Mask,
}

/// One cycle of one cable (or of several in lanes).
///
/// Slack releases the stored friction. `lumped_friction_n` is the stored friction of the
/// `lumped` form. Viscous friction stays outside the Dahl state in both forms: it needs no presliding distance
/// (deviation from \[P\] 15, where it is inside). The macroscopic friction is taken from the frictionless cable,
/// `F_f = F_n − F_s/(1 − c)`, so that presliding covers the sensor pulley too (deviation from \[P\] 15: `F_n − F_1`).
#[inline(always)]
pub fn cable_step<T: Scalar>(
    model: &CableModel<T>,
    features: Features,
    signals: &CableSignals<T>,
    pulleys: &mut impl Pulleys<T>,
    lumped_friction_n: T,
) -> CableForces<T> {
    let zero = T::splat(0.0);
    let frictionless_n = signals.sensor_force_n * model.frictionless_gain;
    let no_tension = signals.sensor_force_n.le(zero);
    let mu = if features.stribeck { model.mu * model.stribeck.factor(signals.speed_m_per_s) } else { model.mu };
    let mut forces = CableForces {
        platform_force_n: frictionless_n,
        frictionless_n,
        lumped_friction_n,
        no_tension,
        slack: no_tension,
        slip: T::Mask::NONE,
    };
    if features.lumped {
        let (platform_n, friction_n, slip) = lumped_chain(model, features, mu, signals, lumped_friction_n, pulleys);
        forces.platform_force_n = platform_n;
        forces.lumped_friction_n = friction_n.keep(no_tension.not());
        forces.slip = slip;
    }
    if features.per_pulley {
        let (platform_n, slip) = pulley_chain(model, features, mu, signals, no_tension.or(model.lumped), pulleys);
        if features.lumped {
            forces.platform_force_n = T::select(model.lumped, forces.platform_force_n, platform_n);
            forces.slip = model.lumped.and(forces.slip).or(model.lumped.not().and(slip));
        } else {
            forces.platform_force_n = platform_n;
            forces.slip = slip;
        }
    }
    forces.slack = no_tension.or(forces.platform_force_n.lt(zero));
    let pulled_n = forces.platform_force_n.max(zero);
    forces.platform_force_n = T::select(no_tension, frictionless_n, pulled_n) + model.offset_n;
    forces.slip = forces.slip.and(forces.slack.not());
    forces
}

/// `per_pulley`: one Dahl state on each bearing; its normal force includes the friction it has stored.
///
/// With the stored Coulomb friction `f_j`: `F_1 = (F_s − c(f_1 + F_pv v))/(1 − c)` (\[P\] 11), then
/// `F_j = F_{j−1} + f_j + F_pv v`. In steady sliding this is \[P\] 10.
#[inline(always)]
fn pulley_chain<T: Scalar>(
    model: &CableModel<T>,
    features: Features,
    mu: T,
    signals: &CableSignals<T>,
    release: T::Mask,
    pulleys: &mut impl Pulleys<T>,
) -> (T, T::Mask) {
    let zero = T::splat(0.0);
    let mut tension_n = zero;
    let mut slip = T::Mask::NONE;
    for place in 0..pulleys.count() {
        let pulley = pulleys.pulley(place);
        let stored_n = pulleys.friction_n(place);
        let viscous_n = pulley.viscous_n_s_per_m * signals.speed_m_per_s;
        let sensed = |friction_n: T| {
            (signals.sensor_force_n - model.sensor_cos * (friction_n + viscous_n)) * model.frictionless_gain
        };
        let (upstream_n, downstream_n) = if place == 0 {
            let behind_n = sensed(stored_n);
            (behind_n - stored_n - viscous_n, behind_n)
        } else {
            (tension_n, tension_n + stored_n + viscous_n)
        };
        let sliding_n = pulley::sliding_friction(mu, pulley.wrap_factor, upstream_n, downstream_n);
        let mut friction_n = dahl_step(stored_n, sliding_n, model.sigma_n_per_m, signals.displacement_m);
        let mut behind_n = if place == 0 { sensed(friction_n) } else { tension_n + friction_n + viscous_n };
        if features.traction {
            let traction_ratio = pulleys.traction_ratio(place);
            let before_n = if place == 0 { behind_n - friction_n - viscous_n } else { tension_n };
            let (limited_n, slips) = pulley::limit_traction(before_n, behind_n, traction_ratio);
            let (held_before_n, held_n) = if place == 0 {
                let unlimited = (before_n, behind_n);
                pulley::slipping_sensor(signals.sensor_force_n, model.sensor_cos, unlimited, traction_ratio)
            } else {
                (before_n, limited_n)
            };
            behind_n = T::select(slips, held_n, behind_n);
            friction_n = T::select(slips, held_n - held_before_n - viscous_n, friction_n);
            slip = slip.or(slips);
        }
        pulleys.set_friction_n(place, friction_n.keep(release.not()));
        tension_n = behind_n;
    }
    (tension_n, slip)
}

/// `lumped`: one Dahl state for the whole cable on the macroscopic Coulomb friction, as the paper has it.
#[inline(always)]
fn lumped_chain<T: Scalar>(
    model: &CableModel<T>,
    features: Features,
    mu: T,
    signals: &CableSignals<T>,
    friction_n: T,
    pulleys: &impl Pulleys<T>,
) -> (T, T, T::Mask) {
    let zero = T::splat(0.0);
    let direction = signals.displacement_m.sign();
    let mut slip = T::Mask::NONE;
    let mut coulomb_n = zero;
    let mut viscous_n = zero;
    for place in 0..pulleys.count() {
        let pulley = pulleys.pulley(place);
        let drag_n = pulley.viscous_n_s_per_m * signals.speed_m_per_s;
        if place == 0 {
            let (gain, viscous_gain) = pulley::sensor_gains(direction, mu, pulley.wrap_factor, model.sensor_cos);
            coulomb_n = signals.sensor_force_n * gain;
            viscous_n = drag_n * viscous_gain;
            if features.traction {
                let traction_ratio = pulleys.traction_ratio(place);
                // [P] 10 the other way round: the tension on the winch side from the one behind.
                let (inverse_gain, inverse_viscous) = pulley::sliding_gains(-direction, mu, pulley.wrap_factor);
                let behind_n = coulomb_n + viscous_n;
                let before_n = behind_n * inverse_gain - drag_n * inverse_viscous;
                let (_, slips) = pulley::limit_traction(before_n, behind_n, traction_ratio);
                let tensions = (before_n, behind_n);
                let (_, held_n) =
                    pulley::slipping_sensor(signals.sensor_force_n, model.sensor_cos, tensions, traction_ratio);
                coulomb_n = T::select(slips, held_n - viscous_n, coulomb_n);
                slip = slips;
            }
            continue;
        }
        let (gain, viscous_gain) = pulley::sliding_gains(direction, mu, pulley.wrap_factor);
        let before_n = coulomb_n + viscous_n;
        let (next_coulomb_n, next_viscous_n) = (coulomb_n * gain, viscous_n * gain + drag_n * viscous_gain);
        if features.traction {
            let traction_ratio = pulleys.traction_ratio(place);
            let behind_n = next_coulomb_n + next_viscous_n;
            let (limited_n, slips) = pulley::limit_traction(before_n, behind_n, traction_ratio);
            slip = slip.or(slips);
            // The slip limit holds the sum; what it takes away is Coulomb friction.
            coulomb_n = T::select(slips, limited_n - next_viscous_n, next_coulomb_n);
            viscous_n = next_viscous_n;
        } else {
            coulomb_n = next_coulomb_n;
            viscous_n = next_viscous_n;
        }
    }
    let frictionless_n = signals.sensor_force_n * model.frictionless_gain;
    let sliding_n = coulomb_n - frictionless_n;
    // Sliding this way leads to `sliding_n`, whose sign is not the motion's where a sensor pulley of less than 90°
    // outweighs the others: its friction lowers the tension behind it.
    let distance_m = signals.displacement_m.abs();
    let toward_m = T::select(sliding_n.lt(zero), -distance_m, distance_m);
    let moved_n = dahl_step(friction_n, sliding_n.abs(), model.sigma_n_per_m, toward_m);
    (frictionless_n + moved_n + viscous_n, moved_n, slip)
}
