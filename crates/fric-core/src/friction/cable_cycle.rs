//! Friction of one cable over one cycle: the chain of its pulleys with presliding, in both forms.
//!
//! [`cable_cycle`] computes the force at the platform from sensor force and displacement, generic over [`Scalar`]. It does not check signals:
//! [`condition`](crate::signals::condition) ensures that they are finite. State: that of the [`Cable`].
//!
//! Symbols and sign convention are those of [`pulley`](crate::pulley).

use crate::cable::{Cable, CableModel, Features, Looked, Moment};
use crate::effects::cable_elasticity::{self, CableElasticity, Stretching};
use crate::effects::empirical::{self, Conditions, Unnamed};
use crate::effects::gear_backlash::{self, GearBacklash};
use crate::effects::pulley_eccentricity;
use crate::effects::sensor_drift::{self, SensorDrift};
use crate::effects::sensor_gain::{self, SensorGain};
use crate::effects::sensor_lag::{self, SensorLag};
use crate::effects::sensor_nonlinearity::{self, SensorNonlinearity};
use crate::effects::sensor_offset::{self, SensorOffset};
use crate::effects::sensor_warmup::{self, SensorWarmup};
use crate::effects::winch_ripple;
use crate::effects::{Acting, UNKNOWN};
use crate::friction::bearing::Bearing;
use crate::friction::chain::Chain;
use crate::scalar::{Mask, Scalar};
use crate::signals::CableSignals;

/// The result of one cycle for one cable.
#[derive(Clone, Copy, Debug)]
pub struct CableForces<T: Scalar> {
    /// Force at the platform, N, the offset ε included.
    pub platform_force_n: T,
    /// Friction, N: force at the platform minus the force without friction, without ε. It includes what effects add: inertia, ripple, corrections of
    /// the sensor. 0 in a cable without tension.
    pub friction_n: T,
    /// Cable tension computed from the measured sensor force without friction, N.
    pub frictionless_n: T,
    /// The same for the corrected sensor force, N.
    pub tension_n: T,
    /// Stored friction, N: the sum of the magnitudes over the pulleys; with `lumped` the magnitude for the cable.
    pub stored_n: T,
    /// Least displacement of the contacts, m.
    pub way_m: T,
    /// Whether the cable carries no tension at the platform, or none at all.
    pub slack: T::Mask,
    /// Whether the cable slips on a pulley.
    pub slip: T::Mask,
}

/// Computes one cycle of one cable (or of several in lanes) from conditioned signals.
///
/// While a signal is faulty ([`hold`](CableSignals::hold)), the stored friction follows the motion with the last valid force. The output holds the
/// last valid friction, limited so that no cable goes below zero tension. A slack cable releases its stored friction.
///
/// Viscous friction and inertia are outside the Dahl state in both forms, because they need no presliding distance (deviation from \[P\] 15, where
/// viscous friction is inside). Macroscopic friction is the difference from the cable without friction, `F_f = F_n − F_s/(1 − c)`, so that presliding
/// covers the sensor pulley too (deviation from \[P\] 15: `F_n − F_1`).
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
        let sensor_force_n = corrected_sensor(acting, (signals, moment), model.frictionless_gain, cable);
        (sensor_force_n, sensor_force_n.scale(model.frictionless_gain))
    } else {
        (signals.sensor_force_n, shown_n)
    };
    let no_tension = sensor_force_n.le(zero);
    let signals = &if acting.has(gear_backlash::ACTS) { behind_play(signals, cable) } else { *signals };
    let unnamed = if acting.has(empirical::ACTS) {
        let CableSignals { speed_m_per_s, length_m, .. } = *signals;
        let conditions = Conditions { speed_m_per_s, length_m, load_n: frictionless_n };
        empirical::unnamed(|place| cable.effect(place), &conditions)
    } else {
        Unnamed { force_n: zero, mu_factor: T::splat(1.0) }
    };
    let bearing = Bearing::new(model, acting, signals, (moment, unnamed.mu_factor), cable);
    let stretch_m = stretch(acting, frictionless_n + cable.held_friction_n(), (signals, moment), cable);
    let displacement_m = signals.displacement_m;
    let chain = Chain { model, features, bearing, sensor_force_n, displacement_m, stretch_m };
    let Moved { mut chain_n, mut slip, stored_n } = over_pulleys(&chain, no_tension, cable);
    if features.leads {
        // One step ahead, from the stored state, which it does not change.
        let ahead = Chain { displacement_m: signals.lead_m, stretch_m: zero, ..chain };
        let Moved { chain_n: ahead_n, slip: slips, .. } = over_pulleys(&ahead, no_tension, &mut Looked(cable));
        let leads = zero.lt(signals.lead_m.abs());
        chain_n = T::select(leads, ahead_n, chain_n);
        slip = leads.and(slips).or(leads.not().and(slip));
    }
    if acting.has(pulley_eccentricity::ACTS) {
        chain_n = pulley_eccentricity::times(chain_n, acting, |place| cable.effect(place), signals.length_m);
    }
    if acting.has(empirical::ACTS) {
        chain_n = chain_n + unnamed.force_n;
    }
    let slack = no_tension.or(chain_n.lt(zero));
    // A cable cannot push, even if an untared sensor shows a negative force for a slack one.
    let pulled_n = chain_n.max(zero).keep(no_tension.not());
    let moving_n = pulled_n + model.offset_n;
    // A cable without tension has no friction, whatever its sensor shows.
    let friction_n = (moving_n - model.offset_n - frictionless_n).keep(no_tension.not());

    let hold = signals.hold;
    let (platform_force_n, friction_n) = if hold.any() {
        let held_friction_n = cable.held_friction_n();
        cable.set_held_friction_n(T::select(hold, held_friction_n, friction_n));
        let held_n = held_friction_n.max(-frictionless_n).keep(no_tension.not());
        let holding_n = (frictionless_n + held_n).keep(no_tension.not()) + model.offset_n;
        (T::select(hold, holding_n, moving_n), T::select(hold, held_n, friction_n))
    } else {
        cable.set_held_friction_n(friction_n);
        (moving_n, friction_n)
    };
    CableForces {
        platform_force_n,
        friction_n: if acting.has(SENSOR) {
            let with_sensor_n = (platform_force_n - model.offset_n - shown_n).keep(no_tension.not());
            T::select(shown_n.eq(frictionless_n), friction_n, with_sensor_n)
        } else {
            friction_n
        },
        frictionless_n: shown_n,
        tension_n: frictionless_n,
        stored_n,
        // If the stretch is against the motion of the winch, a contact may have moved by only this much.
        way_m: displacement_m.abs() - stretch_m.abs(),
        slack,
        slip: slip.and(slack.not()).and(hold.not()),
    }
}

/// The result of the chain of pulleys.
struct Moved<T: Scalar> {
    /// Tension behind the last pulley, N.
    chain_n: T,
    slip: T::Mask,
    /// See [`CableForces::stored_n`].
    stored_n: T,
}

/// Computes the chain in the forms of presliding that the cables have. It advances the stored friction, and releases it without tension.
#[inline(always)]
fn over_pulleys<T: Scalar>(chain: &Chain<'_, T>, no_tension: T::Mask, cable: &mut impl Cable<T>) -> Moved<T> {
    let lumped = chain.model.lumped;
    if !chain.features.lumped {
        let (chain_n, stored_n, slip) = chain.per_pulley(no_tension.or(lumped), cable);
        return Moved { chain_n, slip, stored_n };
    }
    let (lumped_n, friction_n, lumped_slips) = chain.lumped(cable);
    let friction_n = friction_n.keep(no_tension.not());
    cable.set_lumped_friction_n(friction_n);
    if !chain.features.per_pulley {
        return Moved { chain_n: lumped_n, slip: lumped_slips, stored_n: friction_n.abs() };
    }
    let (per_pulley_n, stored_n, slips) = chain.per_pulley(no_tension.or(lumped), cable);
    Moved {
        chain_n: T::select(lumped, lumped_n, per_pulley_n),
        slip: lumped.and(lumped_slips).or(lumped.not().and(slips)),
        stored_n: T::select(lumped, friction_n.abs(), stored_n),
    }
}

/// Effects of the force sensor.
const SENSOR: Acting = sensor_offset::ACTS
    .and(sensor_drift::ACTS)
    .and(sensor_gain::ACTS)
    .and(sensor_lag::ACTS)
    .and(sensor_warmup::ACTS)
    .and(sensor_nonlinearity::ACTS)
    .and(winch_ripple::ACTS);

/// Returns the true sensor force for the measured one, N. It undoes the lag first, then added forces, then gain and nonlinearity.
#[inline(always)]
fn corrected_sensor<T: Scalar>(
    acting: Acting,
    (signals, moment): (&CableSignals<T>, &Moment<T>),
    frictionless_gain: T,
    cable: &mut impl Cable<T>,
) -> T {
    let mut force_n = signals.sensor_force_n;
    if acting.has(sensor_lag::ACTS) {
        let memory = sensor_lag::FORCES.map(|place| cable.memory(place));
        let (undone_n, memory) = SensorLag::of(|place| cable.effect(place)).undo(force_n, memory, moment.step_s);
        // After a fault it starts anew, so that the force has no bump.
        for (place, next_n) in sensor_lag::FORCES.into_iter().zip(memory) {
            cable.set_memory(place, T::select(signals.sensor_fault, T::splat(UNKNOWN), next_n));
        }
        force_n = undone_n;
    }
    let value = |place| cable.effect(place);
    if acting.has(sensor_offset::ACTS) {
        force_n = SensorOffset::of(value).undo(force_n);
    }
    if acting.has(sensor_drift::ACTS) {
        force_n = SensorDrift::of(value).undo(force_n, moment.time_s);
    }
    if acting.has(sensor_warmup::ACTS) {
        force_n = SensorWarmup::of(value).undo(force_n, moment.time_s);
    }
    if acting.has(winch_ripple::ACTS) {
        force_n = winch_ripple::undo(acting, value, force_n, signals.length_m);
    }
    if acting.has(sensor_gain::ACTS) {
        force_n = SensorGain::of(value).undo(force_n);
    }
    if acting.has(sensor_nonlinearity::ACTS) {
        force_n = SensorNonlinearity::of(value).undo(force_n, frictionless_gain);
    }
    force_n
}

/// Returns the motion of the cable behind the play of its gear.
#[inline(always)]
fn behind_play<T: Scalar>(signals: &CableSignals<T>, cable: &mut impl Cable<T>) -> CableSignals<T> {
    let zero = T::splat(0.0);
    let gear = GearBacklash::of(|place| cable.effect(place));
    let [displacement_m, in_play_m] = gear.moved_m(cable.memory(gear_backlash::IN_PLAY), signals.displacement_m);
    cable.set_memory(gear_backlash::IN_PLAY, in_play_m);
    let [lead_m, _] = gear.moved_m(in_play_m, signals.lead_m);
    let has_play = zero.lt(gear.play_m);
    let driven = zero.lt(displacement_m.sign() * signals.speed_m_per_s);
    CableSignals {
        displacement_m: T::select(has_play, displacement_m, signals.displacement_m),
        lead_m: T::select(has_play, lead_m, signals.lead_m),
        speed_m_per_s: signals.speed_m_per_s.keep(driven.or(has_play.not())),
        length_m: T::select(has_play, signals.length_m - in_play_m, signals.length_m),
        ..*signals
    }
}

/// Returns by how much the whole cable has stretched in this cycle, m; 0 while the sensor is faulty.
#[inline(always)]
fn stretch<T: Scalar>(
    acting: Acting,
    tension_n: T,
    (signals, moment): (&CableSignals<T>, &Moment<T>),
    cable: &mut impl Cable<T>,
) -> T {
    if !acting.has(cable_elasticity::ACTS) {
        return T::splat(0.0);
    }
    let elasticity = CableElasticity::of(|place| cable.effect(place));
    let last = Stretching {
        middle_n: cable.memory(cable_elasticity::TENSION),
        waiting_m: cable.memory(cable_elasticity::STRETCH),
    };
    let mut next = last;
    let tension_n = tension_n.max(T::splat(0.0));
    let stretch_m = elasticity.stretch_m(tension_n, signals.displacement_m, moment.step_s, &mut next);
    let known = signals.sensor_fault.not();
    cable.set_memory(cable_elasticity::TENSION, T::select(known, next.middle_n, last.middle_n));
    cable.set_memory(cable_elasticity::STRETCH, T::select(known, next.waiting_m, last.waiting_m));
    stretch_m.keep(known)
}
