//! The cable as the equations of the cycle see it: its parameters, its pulleys and its state.
//!
//! The trait is generic over [`Scalar`], so that the control cycle (several cables at once) and a fit with derivatives run the same code. State: one
//! number per pulley, or one per cable, and [`MEMORY`](crate::effects::MEMORY) numbers of effects, stored by the caller behind [`Cable`].
//!
//! Symbols and sign convention are those of [`pulley`](crate::pulley).

use crate::effects::{Acting, time_delay};
use crate::friction::places::{Places, START_WRAP_FACTOR};
use crate::parameters::{MU, OFFSET, ParameterRow, SIGMA, Values};
use crate::robot::{CableParams, Presliding};
use crate::scalar::Scalar;

/// Parameters of a cable as the cycle uses them.
#[derive(Clone, Copy, Debug)]
pub struct CableModel<T: Scalar> {
    /// Bearing friction μ on the normal force, 1.
    pub mu: T,
    /// Presliding stiffness σ of one Dahl state, N/m: that of the whole cable for `lumped`, an n-th of it for `per_pulley` with n pulleys.
    pub sigma_n_per_m: T,
    /// Force added at the platform, ε of \[P\] 18, N.
    pub offset_n: T,
    /// cos α₁ of the sensor pulley; 0 for a sensor in line with the cable.
    pub sensor_cos: T,
    /// `1/(1 − cos α₁)`: ratio of the cable tension without friction to the sensor force.
    pub frictionless_gain: T,
    /// Whether there is one state per cable (as in \[P\]) instead of one per pulley.
    pub lumped: T::Mask,
}

impl<T: Scalar> CableModel<T> {
    /// Creates the model of several cables, one per lane, with `values` replacing the cables' own.
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
    /// Returns the ratio of the cable tension without friction to the sensor force: `1/(1 − cos α₁)`.
    #[must_use]
    pub fn frictionless_gain(&self) -> f64 {
        CableModel::<f64>::new(|_| self, &self.values()).frictionless_gain
    }

    /// Returns the distance over which the pulley with the longest memory forgets its stored friction to 1/e, per newton of sensor force: `f_c/σ` of
    /// one Dahl state with `F_N = k·F`, m/N. It is 0 without presliding.
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

/// A cable, or several in lanes: its pulleys in order from the winch, its effects, and its state.
///
/// Pulley 0 is the sensor pulley; a sensor in line with the cable counts as a sensor pulley without wrap.
pub trait Cable<T: Scalar> {
    /// Returns the number of pulley positions, at least 1.
    fn count(&self) -> usize;
    /// Returns `2 sin(α/2)` of the wrap of the pulley at a position; 0 if there is none.
    fn wrap_factor(&self, place: usize) -> T;
    /// Returns its viscous friction `F_pv·v` at a speed, N; 0 if there is none.
    fn viscous_n(&self, place: usize, speed_m_per_s: T) -> T;
    /// Returns `e^{μ_p α}` there, the tension ratio at which the cable slips; beyond [`NO_LIMIT_RATIO`](crate::pulley::NO_LIMIT_RATIO) if it cannot.
    fn traction_ratio(&self, place: usize) -> T;
    /// Returns 1 if there is a pulley, else 0.
    fn present(&self, place: usize) -> T;
    /// Returns the number of the pulley there, counted from 1 at the sensor; 0 if there is none.
    fn pulley_number(&self, place: usize) -> T;
    /// Returns the fraction of the cable's stretch between the winch and this position, 0…1: `j/n` at pulley j of n.
    fn stretch_ratio(&self, place: usize) -> T;
    /// Returns the greatest μ that the sensor pulley allows; see [`CableParams`].
    fn greatest_mu(&self) -> T;
    /// Returns a parameter of an effect, by its index in [`Values`].
    fn effect(&self, place: usize) -> T;
    /// Returns a state variable of an effect, by its index in [`MEMORY`](crate::effects::MEMORY); [`UNKNOWN`](crate::effects::UNKNOWN) before the
    /// first cycle.
    fn memory(&self, place: usize) -> T;
    /// Stores a state variable of an effect.
    fn set_memory(&mut self, place: usize, value: T);
    /// Returns the Coulomb friction stored at a pulley (`per_pulley`), N.
    fn pulley_friction_n(&self, place: usize) -> T;
    /// Stores the Coulomb friction of a pulley.
    fn set_pulley_friction_n(&mut self, place: usize, friction_n: T);
    /// Returns the Coulomb friction stored in the cable (`lumped`), N.
    fn lumped_friction_n(&self) -> T;
    /// Stores the Coulomb friction of the cable.
    fn set_lumped_friction_n(&mut self, friction_n: T);
    /// Returns the last valid total friction, N.
    fn held_friction_n(&self) -> T;
    /// Stores the last valid total friction.
    fn set_held_friction_n(&mut self, friction_n: T);
}

/// A read-only view of a cable: changes of its state are discarded.
pub(crate) struct Looked<'a, C>(pub &'a C);

impl<T: Scalar, C: Cable<T>> Cable<T> for Looked<'_, C> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.0.count()
    }
    #[inline(always)]
    fn wrap_factor(&self, place: usize) -> T {
        self.0.wrap_factor(place)
    }
    #[inline(always)]
    fn viscous_n(&self, place: usize, speed_m_per_s: T) -> T {
        self.0.viscous_n(place, speed_m_per_s)
    }
    #[inline(always)]
    fn traction_ratio(&self, place: usize) -> T {
        self.0.traction_ratio(place)
    }
    #[inline(always)]
    fn present(&self, place: usize) -> T {
        self.0.present(place)
    }
    #[inline(always)]
    fn pulley_number(&self, place: usize) -> T {
        self.0.pulley_number(place)
    }
    #[inline(always)]
    fn stretch_ratio(&self, place: usize) -> T {
        self.0.stretch_ratio(place)
    }
    #[inline(always)]
    fn greatest_mu(&self) -> T {
        self.0.greatest_mu()
    }
    #[inline(always)]
    fn effect(&self, place: usize) -> T {
        self.0.effect(place)
    }
    #[inline(always)]
    fn memory(&self, place: usize) -> T {
        self.0.memory(place)
    }
    #[inline(always)]
    fn set_memory(&mut self, _: usize, _: T) {}
    #[inline(always)]
    fn pulley_friction_n(&self, place: usize) -> T {
        self.0.pulley_friction_n(place)
    }
    #[inline(always)]
    fn set_pulley_friction_n(&mut self, _: usize, _: T) {}
    #[inline(always)]
    fn lumped_friction_n(&self) -> T {
        self.0.lumped_friction_n()
    }
    #[inline(always)]
    fn set_lumped_friction_n(&mut self, _: T) {}
    #[inline(always)]
    fn held_friction_n(&self) -> T {
        self.0.held_friction_n()
    }
    #[inline(always)]
    fn set_held_friction_n(&mut self, _: T) {}
}

/// Properties that may differ between robots but not between the lanes of one. They are decided once per cycle, outside the arithmetic.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is there or not, whatever the others are")]
pub struct Features {
    /// Whether any cable has one Dahl state per pulley.
    pub per_pulley: bool,
    /// Whether any cable has a single Dahl state.
    pub lumped: bool,
    /// Whether any cable has a slip limit.
    pub traction: bool,
    /// Whether the motion of any cable is known too late and extrapolated.
    pub(crate) leads: bool,
    /// Effects that any cable has.
    pub(crate) acting: Acting,
}

impl Features {
    /// Whether the cycle must compute any effects; a delay is already applied to its signals.
    #[inline(always)]
    pub(crate) fn has_effects(self) -> bool {
        self.leads || self.acting.without(time_delay::ACTS) != Acting::NONE
    }

    /// Returns these features; if not `EFFECTS`, without any effect, so that the compiler removes them.
    #[inline(always)]
    pub(crate) fn limited_to<const EFFECTS: bool>(self) -> Self {
        if EFFECTS { self } else { Self { acting: Acting::NONE, leads: false, ..self } }
    }

    /// Returns these features together with those that a cable needs, except its effects.
    pub(crate) fn with(mut self, params: &CableParams) -> Self {
        self.per_pulley |= params.presliding == Presliding::PerPulley;
        self.lumped |= params.presliding == Presliding::Lumped;
        self.traction |= params.traction_mu.is_some();
        self
    }

    /// Returns these features together with a lead, if there is one.
    pub(crate) fn with_lead(mut self, leads: bool) -> Self {
        self.leads |= leads;
        self
    }

    /// Returns these features together with the effects that have an `active` parameter: one that is not neutral, or is varied.
    pub(crate) fn and_acting(mut self, active: impl Fn(&ParameterRow, usize) -> bool) -> Self {
        self.acting = self.acting.and(Acting::of(active));
        self
    }
}

/// The present time of the run.
#[derive(Clone, Copy, Debug)]
pub struct Moment<T> {
    /// Time since the first cycle, s.
    pub time_s: T,
    /// Time since the previous cycle, s; the cycle time in the first cycle.
    pub step_s: T,
}

impl<T: Scalar> Moment<T> {
    /// Returns the time at `cycle` cycles after the first, with the previous cycle at `last`; NaN if that is unknown.
    #[inline(always)]
    pub fn new(cycle: T, last: T, cycle_s: f64) -> Self {
        let elapsed = T::select(last.lt(cycle), cycle - last, T::splat(1.0));
        Self { time_s: cycle * T::splat(cycle_s), step_s: elapsed * T::splat(cycle_s) }
    }
}
