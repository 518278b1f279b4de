//! Friction of one cable over one cycle: the chain of its pulleys with presliding, in the two forms that are wanted.
//!
//! For: sensor force and displacement in, force at the platform out ([`cable_cycle`]). Generic over [`Scalar`], so the
//! control cycle (four cables at once) and a fit that carries derivatives run the very same code. It does not judge
//! signals: [`condition`](crate::signals::condition) sees to it that they are finite. State: one number per pulley, or
//! one per cable, kept by the caller behind [`Cable`].
//!
//! Symbols and sign convention are those of [`pulley`].

use crate::dahl::dahl_step;
use crate::effects::stribeck::{self, Stribeck};
use crate::parameters::{MU, OFFSET, SIGMA, Values};
use crate::places::{Places, START_WRAP_FACTOR};
use crate::pulley;
use crate::robot::{CableParams, Presliding};
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
}

impl<T: Scalar> CableModel<T> {
    /// The model of cables, one a lane, with `values` in place of the cables' own.
    #[must_use]
    pub fn new<'a>(of_lane: impl Fn(usize) -> &'a CableParams, values: &Values<T>) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "at most MAX_PULLEYS")]
        let states = |params: &CableParams| match params.presliding {
            Presliding::PerPulley => params.pulley_count as f64,
            Presliding::Lumped => 1.0,
        };
        let sensor_cos = |lane| of_lane(lane).sensor_wrap_rad.map_or(0.0, libm::cos);
        let is_lumped = |lane| f64::from(of_lane(lane).presliding == Presliding::Lumped);
        Self {
            mu: values[MU],
            sigma_n_per_m: values[SIGMA] / T::from_lanes(|lane| states(of_lane(lane))),
            offset_n: values[OFFSET],
            sensor_cos: T::from_lanes(sensor_cos),
            frictionless_gain: T::from_lanes(|lane| 1.0 / (1.0 - sensor_cos(lane))),
            lumped: T::splat(0.0).lt(T::from_lanes(is_lumped)),
        }
    }
}

impl CableParams {
    /// From sensor force to cable tension without friction: `1/(1 − cos α₁)`, 1.
    #[must_use]
    pub fn frictionless_gain(&self) -> f64 {
        CableModel::<f64>::new(|_| self, &self.values()).frictionless_gain
    }

    /// The way over which the pulley that remembers longest forgets its stored friction to 1/e, for each newton of sensor
    /// force: `f_c/σ` of one Dahl state with `F_N = k·F`, m/N. Without presliding it is 0.
    #[must_use]
    pub fn memory_m_per_n(&self, mu: f64, sigma_n_per_m: f64) -> f64 {
        let mut values = self.values();
        (values[MU], values[SIGMA]) = (mu, sigma_n_per_m);
        let model = CableModel::<f64>::new(|_| self, &values);
        let factors = Places::new(self, Places::needed(self)).wrap_factor;
        let pose_factor = if self.needs_pose() { START_WRAP_FACTOR } else { 0.0 };
        let pick = |pick: fn(f64, f64) -> f64| factors.into_iter().chain([pose_factor]).fold(0.0, pick);
        let factor = if model.lumped { pick(|sum, factor| sum + factor) } else { pick(f64::max) };
        mu * factor * model.frictionless_gain / model.sigma_n_per_m
    }
}

/// A cable, or several in lanes: its pulleys in order from the winch, its effects, and what it remembers.
///
/// Pulley 0 is the sensor pulley; a sensor in line with the cable is a sensor pulley without wrap.
pub trait Cable<T: Scalar> {
    /// How many pulleys, at least 1.
    fn count(&self) -> usize;
    /// `2 sin(α/2)` of the wrap of the pulley at a place; 0 where there is none.
    fn wrap_factor(&self, place: usize) -> T;
    /// Its viscous friction `F_pv·v` at a speed, N; 0 where there is none.
    fn viscous_n(&self, place: usize, speed_m_per_s: T) -> T;
    /// `e^{μ_p α}` there, the tension ratio at which the cable slips; beyond
    /// [`NO_LIMIT_RATIO`](pulley::NO_LIMIT_RATIO) where it cannot.
    fn traction_ratio(&self, place: usize) -> T;
    /// A parameter of an effect, by its place in [`Values`].
    fn effect(&self, place: usize) -> T;
    /// Coulomb friction stored at a pulley (`per_pulley`), N.
    fn pulley_friction_n(&self, place: usize) -> T;
    /// Stores it.
    fn set_pulley_friction_n(&mut self, place: usize, friction_n: T);
    /// Coulomb friction stored in the cable (`lumped`), N.
    fn lumped_friction_n(&self) -> T;
    /// Stores it.
    fn set_lumped_friction_n(&mut self, friction_n: T);
    /// Last good friction in all, N.
    fn held_friction_n(&self) -> T;
    /// Keeps it.
    fn set_held_friction_n(&mut self, friction_n: T);
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

impl Features {
    /// These and what a cable needs.
    pub(crate) fn with(mut self, params: &CableParams) -> Self {
        self.per_pulley |= params.presliding == Presliding::PerPulley;
        self.lumped |= params.presliding == Presliding::Lumped;
        self.traction |= params.traction_mu.is_some();
        self.stribeck |= params.effects.get("stribeck", "ratio").is_some_and(|ratio| ratio.abs() > 0.0);
        self
    }

    /// These and the effects that act at values other than the cable's own.
    pub(crate) fn and_acting(mut self, value: impl Fn(usize) -> f64) -> Self {
        self.stribeck |= value(stribeck::RATIO).abs() > 0.0;
        self
    }

    /// These and the effects of which a parameter varies, see [`Values`].
    pub(crate) fn and_varying(mut self, varies: impl Fn(usize) -> bool) -> Self {
        self.stribeck |= varies(stribeck::RATIO) || varies(stribeck::VELOCITY);
        self
    }
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
    /// Force at the platform, N, the offset ε included.
    pub platform_force_n: T,
    /// Friction: force at the platform less the frictionless one, without ε, N.
    pub friction_n: T,
    /// Sensor force turned into cable tension as if nothing rubbed, N.
    pub frictionless_n: T,
    /// The cable carries no tension at the platform, or none at all.
    pub slack: T::Mask,
    /// Slip on a pulley.
    pub slip: T::Mask,
}

/// One cycle of one cable (or of several in lanes) on conditioned signals.
///
/// While a signal is faulty (`hold`, see [`Conditioned::hold`](crate::signals::Conditioned::hold)) the stored friction follows the motion with the last good force, and
/// the output holds the last good friction, which takes no cable below zero tension. Slack releases the stored friction.
#[inline(always)]
pub fn cable_cycle<T: Scalar>(
    model: &CableModel<T>,
    features: Features,
    signals: &CableSignals<T>,
    hold: T::Mask,
    cable: &mut impl Cable<T>,
) -> CableForces<T> {
    let held_friction_n = cable.held_friction_n();
    let forces = cable_step(model, features, signals, cable);
    let no_tension = signals.sensor_force_n.le(T::splat(0.0));
    cable.set_held_friction_n(T::select(hold, held_friction_n, forces.friction_n));
    let held_n = held_friction_n.max(-forces.frictionless_n).keep(no_tension.not());
    CableForces {
        platform_force_n: T::select(hold, forces.frictionless_n + held_n + model.offset_n, forces.platform_force_n),
        friction_n: T::select(hold, held_n, forces.friction_n),
        slip: forces.slip.and(hold.not()),
        ..forces
    }
}

/// One cycle of one cable on signals that may be believed.
///
/// Viscous friction stays outside the Dahl state in both forms: it needs no presliding distance (deviation from \[P\] 15,
/// where it is inside). The macroscopic friction is taken from the frictionless cable, `F_f = F_n − F_s/(1 − c)`, so that
/// presliding covers the sensor pulley too (deviation from \[P\] 15: `F_n − F_1`).
#[inline(always)]
fn cable_step<T: Scalar>(
    model: &CableModel<T>,
    features: Features,
    signals: &CableSignals<T>,
    cable: &mut impl Cable<T>,
) -> CableForces<T> {
    let zero = T::splat(0.0);
    let frictionless_n = signals.sensor_force_n.scale(model.frictionless_gain);
    let no_tension = signals.sensor_force_n.le(zero);
    let mut mu = model.mu;
    if features.stribeck {
        mu = mu * Stribeck::of(|place| cable.effect(place)).factor(signals.speed_m_per_s);
    }
    let mut chain_n = frictionless_n;
    let mut slip = T::Mask::NONE;
    if features.lumped {
        let (platform_n, friction_n, slips) = lumped_chain(model, features, mu, signals, cable);
        cable.set_lumped_friction_n(friction_n.keep(no_tension.not()));
        (chain_n, slip) = (platform_n, slips);
    }
    if features.per_pulley {
        let (platform_n, slips) = pulley_chain(model, features, mu, signals, no_tension.or(model.lumped), cable);
        if features.lumped {
            chain_n = T::select(model.lumped, chain_n, platform_n);
            slip = model.lumped.and(slip).or(model.lumped.not().and(slips));
        } else {
            (chain_n, slip) = (platform_n, slips);
        }
    }
    let slack = no_tension.or(chain_n.lt(zero));
    let pulled_n = chain_n.max(zero);
    let platform_force_n = T::select(no_tension, frictionless_n, pulled_n) + model.offset_n;
    CableForces {
        platform_force_n,
        friction_n: platform_force_n - model.offset_n - frictionless_n,
        frictionless_n,
        slack,
        slip: slip.and(slack.not()),
    }
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
    cable: &mut impl Cable<T>,
) -> (T, T::Mask) {
    let zero = T::splat(0.0);
    let mut tension_n = zero;
    let mut slip = T::Mask::NONE;
    for place in 0..cable.count() {
        let stored_n = cable.pulley_friction_n(place);
        let viscous_n = cable.viscous_n(place, signals.speed_m_per_s);
        let sensed = |friction_n: T| {
            (signals.sensor_force_n - (friction_n + viscous_n).scale(model.sensor_cos)).scale(model.frictionless_gain)
        };
        let (upstream_n, downstream_n) = if place == 0 {
            let behind_n = sensed(stored_n);
            (behind_n - stored_n - viscous_n, behind_n)
        } else {
            (tension_n, tension_n + stored_n + viscous_n)
        };
        let sliding_n = pulley::sliding_friction(mu, cable.wrap_factor(place), upstream_n, downstream_n);
        let mut friction_n = dahl_step(stored_n, sliding_n, model.sigma_n_per_m, signals.displacement_m);
        let mut behind_n = if place == 0 { sensed(friction_n) } else { tension_n + friction_n + viscous_n };
        if features.traction {
            let traction_ratio = cable.traction_ratio(place);
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
        cable.set_pulley_friction_n(place, friction_n.keep(release.not()));
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
    cable: &impl Cable<T>,
) -> (T, T, T::Mask) {
    let zero = T::splat(0.0);
    let direction = signals.displacement_m.sign();
    let mut slip = T::Mask::NONE;
    let mut coulomb_n = zero;
    let mut viscous_n = zero;
    for place in 0..cable.count() {
        let wrap_factor = cable.wrap_factor(place);
        let drag_n = cable.viscous_n(place, signals.speed_m_per_s);
        if place == 0 {
            let (gain, viscous_gain) = pulley::sensor_gains(direction, mu, wrap_factor, model.sensor_cos);
            coulomb_n = signals.sensor_force_n * gain;
            viscous_n = drag_n * viscous_gain;
            if features.traction {
                let traction_ratio = cable.traction_ratio(place);
                // [P] 10 the other way round: the tension on the winch side from the one behind.
                let (inverse_gain, inverse_viscous) = pulley::sliding_gains(-direction, mu, wrap_factor);
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
        let (gain, viscous_gain) = pulley::sliding_gains(direction, mu, wrap_factor);
        let before_n = coulomb_n + viscous_n;
        let (next_coulomb_n, next_viscous_n) = (coulomb_n * gain, viscous_n * gain + drag_n * viscous_gain);
        if features.traction {
            let traction_ratio = cable.traction_ratio(place);
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
    let frictionless_n = signals.sensor_force_n.scale(model.frictionless_gain);
    let sliding_n = coulomb_n - frictionless_n;
    // Sliding this way leads to `sliding_n`, whose sign is not the motion's where a sensor pulley of less than 90°
    // outweighs the others: its friction lowers the tension behind it.
    let distance_m = signals.displacement_m.abs();
    let toward_m = T::select(sliding_n.lt(zero), -distance_m, distance_m);
    let moved_n = dahl_step(cable.lumped_friction_n(), sliding_n.abs(), model.sigma_n_per_m, toward_m);
    (frictionless_n + moved_n + viscous_n, moved_n, slip)
}
