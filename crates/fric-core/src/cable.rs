//! Friction of one cable over one cycle: the chain of its pulleys with presliding, in the two forms that are wanted.
//!
//! For: sensor force and displacement in, force at the platform out ([`cable_cycle`]). Generic over [`Scalar`], so the
//! control cycle (several cables at once) and a fit that carries derivatives run the very same code. It does not judge
//! signals: [`condition`](crate::signals::condition) sees to it that they are finite. State: one number per pulley, or
//! one per cable, and [`MEMORY`] of effects, kept by the caller behind [`Cable`].
//!
//! Symbols and sign convention are those of [`pulley`](crate::pulley).

use crate::bearing::Bearing;
use crate::chain::Chain;
use crate::effects::Acting;
use crate::effects::cable_elasticity::{self, CableElasticity};
use crate::effects::pulley_eccentricity::{self, PulleyEccentricity};
use crate::effects::sensor_drift::{self, SensorDrift};
use crate::effects::sensor_gain::{self, SensorGain};
use crate::effects::sensor_offset::{self, SensorOffset};
use crate::effects::time_delay;
use crate::parameters::{MU, OFFSET, ParameterRow, SIGMA, Values};
use crate::places::{Places, START_WRAP_FACTOR};
use crate::robot::{CableParams, Presliding};
use crate::scalar::{Mask, Scalar};
use crate::signals::CableSignals;

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
    /// [`NO_LIMIT_RATIO`](crate::pulley::NO_LIMIT_RATIO) where it cannot.
    fn traction_ratio(&self, place: usize) -> T;
    /// 1 where there is a pulley, else 0.
    fn present(&self, place: usize) -> T;
    /// How much of the cable's stretch lies between the winch and there, 0…1: `j/n` at pulley j of n.
    fn stretch_ratio(&self, place: usize) -> T;
    /// The greatest μ that the sensor pulley bears, see [`CableParams`].
    fn greatest_mu(&self) -> T;
    /// A parameter of an effect, by its place in [`Values`].
    fn effect(&self, place: usize) -> T;
    /// What an effect remembers, by its place in [`MEMORY`]; [`UNKNOWN`] before the first cycle.
    fn memory(&self, place: usize) -> T;
    /// Keeps it.
    fn set_memory(&mut self, place: usize, value: T);
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

/// Numbers that effects remember.
pub const MEMORY: usize = 2;
/// Stands for a number that is not known yet; equal to itself, as a snapshot has to be.
pub const UNKNOWN: f64 = f64::INFINITY;
/// Middle of the play of the tension, of `cable_elasticity`, N.
pub(crate) const TENSION: usize = 0;
/// Low pass of the speed, of `pulley_inertia`, m/s.
pub(crate) const SPEED: usize = 1;

/// What may differ between robots but not between the lanes of one: decided once a cycle, outside the arithmetic.
#[derive(Clone, Copy, Debug, Default)]
pub struct Features {
    /// Some cable has one Dahl state per pulley.
    pub per_pulley: bool,
    /// Some cable has one Dahl state in all.
    pub lumped: bool,
    /// Some cable has a slip limit.
    pub traction: bool,
    /// Effects that some cable has.
    pub(crate) acting: Acting,
}

impl Features {
    /// Whether the cycle has anything to do with effects; the delay is in its signals already.
    #[inline(always)]
    pub(crate) fn has_effects(self) -> bool {
        self.acting.without(time_delay::ACTS) != Acting::NONE
    }

    /// These; if not `EFFECTS` without any, which the compiler then leaves out.
    #[inline(always)]
    pub(crate) fn limited_to<const EFFECTS: bool>(self) -> Self {
        if EFFECTS { self } else { Self { acting: Acting::NONE, ..self } }
    }

    /// These and what a cable needs, but for its effects.
    pub(crate) fn with(mut self, params: &CableParams) -> Self {
        self.per_pulley |= params.presliding == Presliding::PerPulley;
        self.lumped |= params.presliding == Presliding::Lumped;
        self.traction |= params.traction_mu.is_some();
        self
    }

    /// These and the effects of which a parameter is `active`: not neutral, or varied.
    pub(crate) fn and_acting(mut self, active: impl Fn(&ParameterRow, usize) -> bool) -> Self {
        self.acting = self.acting.and(Acting::of(active));
        self
    }
}

/// Where the run stands.
#[derive(Clone, Copy, Debug)]
pub struct Moment<T> {
    /// Time since its first cycle, s.
    pub time_s: T,
    /// Time since the cycle before, s; the cycle time in the first.
    pub step_s: T,
}

impl<T: Scalar> Moment<T> {
    /// The moment `cycle` cycles after the first, where the cycle before was `last`; NaN if that is not known.
    #[inline(always)]
    pub fn new(cycle: T, last: T, cycle_s: f64) -> Self {
        let elapsed = T::select(last.lt(cycle), cycle - last, T::splat(1.0));
        Self { time_s: cycle * T::splat(cycle_s), step_s: elapsed * T::splat(cycle_s) }
    }
}

/// Outcome of one cycle for one cable.
#[derive(Clone, Copy, Debug)]
pub struct CableForces<T: Scalar> {
    /// Force at the platform, N, the offset ε included.
    pub platform_force_n: T,
    /// Friction: force at the platform less the frictionless one, without ε, N. With it all that effects add: inertia,
    /// ripple, what is corrected of the sensor.
    pub friction_n: T,
    /// Sensor force as it is shown, turned into cable tension as if nothing rubbed, N.
    pub frictionless_n: T,
    /// The cable carries no tension at the platform, or none at all.
    pub slack: T::Mask,
    /// Slip on a pulley.
    pub slip: T::Mask,
}

/// One cycle of one cable (or of several in lanes) on conditioned signals.
///
/// While a signal is faulty ([`hold`](CableSignals::hold)) the stored friction follows the motion with the last good force, and
/// the output holds the last good friction, which takes no cable below zero tension. Slack releases the stored friction.
///
/// Viscous friction and inertia stay outside the Dahl state in both forms: they need no presliding distance (deviation from
/// \[P\] 15, where viscous friction is inside). The macroscopic friction is taken from the frictionless cable,
/// `F_f = F_n − F_s/(1 − c)`, so that presliding covers the sensor pulley too (deviation from \[P\] 15: `F_n − F_1`).
#[inline(always)]
pub fn cable_cycle<T: Scalar>(
    model: &CableModel<T>,
    features: Features,
    signals: &CableSignals<T>,
    moment: &Moment<T>,
    cable: &mut impl Cable<T>,
) -> CableForces<T> {
    let zero = T::splat(0.0);
    let acting = features.acting;
    let shown_n = signals.sensor_force_n.scale(model.frictionless_gain);
    let (sensor_force_n, frictionless_n) = if acting.has(SENSOR) {
        let sensor_force_n = corrected_sensor(acting, signals.sensor_force_n, moment, cable);
        (sensor_force_n, sensor_force_n.scale(model.frictionless_gain))
    } else {
        (signals.sensor_force_n, shown_n)
    };
    let no_tension = sensor_force_n.le(zero);
    let bearing = Bearing::new(model, acting, signals, moment, cable);
    let stretch_m = stretch(acting, frictionless_n + cable.held_friction_n(), signals, cable);
    let displacement_m = signals.displacement_m;
    let chain = Chain { model, features, bearing, sensor_force_n, displacement_m, stretch_m };
    let mut chain_n = frictionless_n;
    let mut slip = T::Mask::NONE;
    if features.lumped {
        let (platform_n, friction_n, slips) = chain.lumped(cable);
        cable.set_lumped_friction_n(friction_n.keep(no_tension.not()));
        (chain_n, slip) = (platform_n, slips);
    }
    if features.per_pulley {
        let (platform_n, slips) = chain.per_pulley(no_tension.or(model.lumped), cable);
        if features.lumped {
            chain_n = T::select(model.lumped, chain_n, platform_n);
            slip = model.lumped.and(slip).or(model.lumped.not().and(slips));
        } else {
            (chain_n, slip) = (platform_n, slips);
        }
    }
    if acting.has(pulley_eccentricity::ACTS) {
        chain_n = chain_n * PulleyEccentricity::of(|place| cable.effect(place)).factor(signals.length_m);
    }
    let slack = no_tension.or(chain_n.lt(zero));
    let pulled_n = chain_n.max(zero);
    let moving_n = T::select(no_tension, frictionless_n, pulled_n) + model.offset_n;
    let friction_n = moving_n - model.offset_n - frictionless_n;

    let hold = signals.hold;
    let held_friction_n = cable.held_friction_n();
    cable.set_held_friction_n(T::select(hold, held_friction_n, friction_n));
    let held_n = held_friction_n.max(-frictionless_n).keep(no_tension.not());
    let platform_force_n = T::select(hold, frictionless_n + held_n + model.offset_n, moving_n);
    let friction_n = T::select(hold, held_n, friction_n);
    CableForces {
        platform_force_n,
        friction_n: if acting.has(SENSOR) { platform_force_n - model.offset_n - shown_n } else { friction_n },
        frictionless_n: shown_n,
        slack,
        slip: slip.and(slack.not()).and(hold.not()),
    }
}

/// Effects of the force sensor.
const SENSOR: Acting = sensor_offset::ACTS.and(sensor_drift::ACTS).and(sensor_gain::ACTS);

/// The sensor force there is for the one shown, N: `(F_shown − offset − rate·t)/gain`.
#[inline(always)]
fn corrected_sensor<T: Scalar>(acting: Acting, shown_n: T, moment: &Moment<T>, cable: &impl Cable<T>) -> T {
    let value = |place| cable.effect(place);
    let mut force_n = shown_n;
    if acting.has(sensor_offset::ACTS) {
        force_n = SensorOffset::of(value).undo(force_n);
    }
    if acting.has(sensor_drift::ACTS) {
        force_n = SensorDrift::of(value).undo(force_n, moment.time_s);
    }
    if acting.has(sensor_gain::ACTS) {
        force_n = SensorGain::of(value).undo(force_n);
    }
    force_n
}

/// By how much the whole cable has stretched in this cycle, m; a sensor that tells nothing tells of no stretch.
#[inline(always)]
fn stretch<T: Scalar>(acting: Acting, tension_n: T, signals: &CableSignals<T>, cable: &mut impl Cable<T>) -> T {
    if !acting.has(cable_elasticity::ACTS) {
        return T::splat(0.0);
    }
    let elasticity = CableElasticity::of(|place| cable.effect(place));
    let middle_n = cable.memory(TENSION);
    let (stretch_m, next_n) = elasticity.stretch_m(tension_n.max(T::splat(0.0)), middle_n);
    let known = signals.sensor_fault.not();
    cable.set_memory(TENSION, T::select(known, next_n, middle_n));
    stretch_m.keep(known)
}
