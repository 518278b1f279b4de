//! Cables without a robot, in any number type: one in plain numbers, four in lanes.
//!
//! Identification uses it to run the cycle's equations with numbers that carry derivatives. A cable has the same bits as in the
//! [`Compensator`](crate::Compensator), whatever the number type and the other cables. The caller supplies conditioned signals
//! ([`condition`](crate::signals::condition)), and the wrap of a last pulley that follows the pose as [`PoseWrap`].

use crate::cable::{Cable, CableModel, Features, Moment};
use crate::cable_cycle::{CableForces, cable_cycle};
use crate::effects::cable_elasticity::COMPLIANCE;
use crate::effects::gear_backlash::PLAY;
use crate::effects::time_delay::{self, About, DELAY, DelayLine, Shifted, Taps};
use crate::effects::{MEMORY, UNKNOWN};
use crate::friction::places::{NO_SLIP, PLACES, Places, START_WRAP_FACTOR};
use crate::numbers::lanes::LANES;
use crate::parameters::{ParameterRow, VISCOUS, Values};
use crate::platform::Pose;
use crate::pulley::traction_ratio;
use crate::robot::CableParams;
use crate::scalar::{Mask, Scalar};
use crate::signals::{CableSignals, Conditioned};
use crate::swivel;

/// Wrap of a cable's last pulley at a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseWrap {
    /// `2 sin(β/2)` of its wrap.
    pub wrap_factor: f64,
    /// `e^{μ_p β}`; beyond [`NO_LIMIT_RATIO`](crate::pulley::NO_LIMIT_RATIO) without a slip limit.
    pub traction_ratio: f64,
}

impl PoseWrap {
    /// Returns the wrap, rad.
    #[must_use]
    pub fn wrap_rad(&self) -> f64 {
        2.0 * libm::asin((0.5 * self.wrap_factor).min(1.0))
    }

    /// The wrap before the first pose: 90°, no slip.
    pub const START: Self = Self { wrap_factor: START_WRAP_FACTOR, traction_ratio: NO_SLIP };

    /// Returns the wrap at a pose; `None` for a cable without a pulley that follows the pose, and if the attachment lies inside the pulley's circle.
    #[must_use]
    pub fn at(params: &CableParams, pose: &Pose) -> Option<Self> {
        let geometry = params.geometry.as_ref().filter(|_| params.needs_pose())?;
        let exit = swivel::exit(&geometry.swivel(), geometry.attachment_m(pose).into());
        let ratio = |traction_mu| traction_ratio(traction_mu, swivel::wrap_rad(exit.cos_sin_wrap));
        let traction_ratio = params.traction_mu.map_or(NO_SLIP, ratio);
        exit.reachable.then_some(Self { wrap_factor: exit.wrap_factor, traction_ratio })
    }
}

/// Up to as many cables as a `T` has lanes, with their state.
#[derive(Clone, Debug)]
pub struct CableGroup<T: Scalar> {
    model: CableModel<T>,
    features: Features,
    delay: Option<Delayed<T>>,
    cycle_s: f64,
    last_cycle: [f64; LANES],
    state: State<T>,
}

/// Least values of a delay, a compliance and a play that vary. At exactly 0 a cable at rest does not move, and the derivative by these parameters
/// would be 0 too. At these values the derivative is right, and forces change by a negligible amount.
const LEAST_DELAY_S: f64 = 1e-12;
const LEAST_COMPLIANCE_M_PER_N: f64 = 1e-15;
const LEAST_PLAY_M: f64 = 1e-15;

/// State of the delay of set points, lane by lane.
#[derive(Clone, Debug)]
struct Delayed<T> {
    taps: [Taps; LANES],
    fractions: [T; 2],
    displacement_m: [DelayLine; LANES],
    speed_m_per_s: [DelayLine; LANES],
    /// Distance by which the delayed motion lags behind, m.
    lag_m: T,
}

#[derive(Clone, Debug)]
struct State<T: Scalar> {
    values: Values<T>,
    wrap_factor: [T; PLACES],
    has_pulley: [T; PLACES],
    pulley_number: [T; PLACES],
    stretch_ratio: [T; PLACES],
    greatest_mu: T,
    traction_ratio: [T; PLACES],
    /// Whether the wrap of the pulley at the last position follows the pose.
    follows_pose: T::Mask,
    pose_wrap_factor: T,
    posed_mu_ratio: T,
    pose_traction_ratio: T,
    count: usize,
    pulley_friction_n: [T; PLACES],
    lumped_friction_n: T,
    held_friction_n: T,
    memory: [T; MEMORY],
}

/// The inputs of one cable of a group in one cycle.
#[derive(Clone, Copy, Debug)]
pub struct CableCycle<'a> {
    /// Its signals.
    pub signals: &'a Conditioned<f64>,
    /// Wrap at the last known pose.
    pub pose_wrap: PoseWrap,
    /// Number of cycles since the first one of the run, see [`next_cycle`](crate::signals::next_cycle).
    pub cycle: f64,
}

impl<T: Scalar> CableGroup<T> {
    /// Creates cables at rest, one per lane, with `values` replacing their own; further lanes repeat the last cable. A parameter that `varies` is
    /// computed even at its neutral value, so that its derivative is right there.
    ///
    /// Returns `None` without any cable.
    #[must_use]
    pub fn new(
        cables: &[&CableParams],
        values: &Values<T>,
        cycle_s: f64,
        varies: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let last = **cables.last()?;
        let of_lane = |lane: usize| cables.get(lane).map_or(&last, |params| *params);
        let count = cables.iter().map(|params| Places::needed(params)).max()?;
        let places: [Places; LANES] = core::array::from_fn(|lane| Places::new(of_lane(lane), count));
        let at = |column: fn(&Places) -> &[f64; PLACES]| {
            core::array::from_fn(|place| T::from_lanes(|lane| column(&places[lane.min(LANES - 1)])[place]))
        };
        let zero = T::splat(0.0);
        let is_active = |row: &ParameterRow, place: usize| {
            let differs = |lane| values[place].lane(lane).to_bits() != row.neutral.to_bits();
            varies(place) || (0..T::COUNT).any(differs)
        };
        let features = cables.iter().fold(Features::default(), |features, params| features.with(params));
        let features = features.and_acting(is_active);
        let mut values = *values;
        for (place, least) in [(DELAY, LEAST_DELAY_S), (COMPLIANCE, LEAST_COMPLIANCE_M_PER_N), (PLAY, LEAST_PLAY_M)] {
            if varies(place) {
                values[place] = values[place] + T::splat(least).keep(values[place].eq(zero));
            }
        }
        let delay = values[DELAY] / T::splat(cycle_s);
        let taps = core::array::from_fn(|lane| Taps::of_cycles(delay.lane(lane)));
        let features = features.with_lead(taps.into_iter().any(Taps::leads));
        let delayed = features.acting.has(time_delay::ACTS);
        Some(Self {
            model: CableModel::new(of_lane, &values),
            features,
            delay: delayed.then(|| Delayed {
                taps,
                fractions: time_delay::fractions(delay, |lane| taps[lane % LANES]),
                displacement_m: [DelayLine::EMPTY; LANES],
                speed_m_per_s: [DelayLine::EMPTY; LANES],
                lag_m: zero,
            }),
            cycle_s,
            last_cycle: [f64::NAN; LANES],
            state: State {
                values,
                wrap_factor: at(|places| &places.wrap_factor),
                has_pulley: at(|places| &places.has_pulley),
                pulley_number: at(|places| &places.number),
                stretch_ratio: at(|places| &places.stretch_ratio),
                greatest_mu: T::from_lanes(|lane| of_lane(lane).greatest_mu()),
                traction_ratio: at(|places| &places.traction_ratio),
                follows_pose: zero.lt(T::from_lanes(|lane| f64::from(of_lane(lane).needs_pose()))),
                pose_wrap_factor: zero,
                posed_mu_ratio: T::splat(1.0),
                pose_traction_ratio: zero,
                count,
                pulley_friction_n: [zero; PLACES],
                lumped_friction_n: zero,
                held_friction_n: zero,
                memory: [T::splat(UNKNOWN); MEMORY],
            },
        })
    }

    /// Returns the same `cables` with a μ of its own for each pulley: `ratio` is its multiple of the cable's μ, by lane and pulley.
    ///
    /// The normal force is multiplied instead of μ. This is equivalent except with `load_nonlinearity`, which depends on the normal force.
    #[must_use]
    pub fn with_mu_ratios(mut self, cables: &[&CableParams], ratio: impl Fn(usize, usize) -> f64) -> Self {
        let places: [Option<Places>; LANES] = core::array::from_fn(|lane| {
            cables.get(lane).or(cables.last()).map(|params| Places::new(params, self.state.count))
        });
        let ratio_at = |place: usize, lane: usize| {
            let of_lane = places.get(lane).and_then(Option::as_ref);
            let pulley = of_lane.and_then(|places| places.of_pulley.iter().position(|other| *other == place));
            pulley.map_or(1.0, |pulley| ratio(lane, pulley))
        };
        for (place, wrap_factor) in self.state.wrap_factor.iter_mut().enumerate() {
            *wrap_factor = *wrap_factor * T::from_lanes(|lane| ratio_at(place, lane));
        }
        let last = self.state.count.saturating_sub(1);
        self.state.posed_mu_ratio = T::from_lanes(|lane| ratio_at(last, lane));
        self
    }

    /// Computes one cycle; `cycle` gives the inputs of the cable in a lane.
    #[inline(always)]
    pub fn step<'a>(&mut self, cycle: impl Fn(usize) -> CableCycle<'a>) -> CableForces<T> {
        if self.features.has_effects() { self.step_with_effects(cycle) } else { self.step_as::<false>(cycle) }
    }

    /// Computes one cycle with effects, in a separate function, so that the cycle without effects does not become slower.
    #[inline(never)]
    fn step_with_effects<'a>(&mut self, cycle: impl Fn(usize) -> CableCycle<'a>) -> CableForces<T> {
        self.step_as::<true>(cycle)
    }

    #[inline(always)]
    fn step_as<'a, const EFFECTS: bool>(&mut self, cycle: impl Fn(usize) -> CableCycle<'a>) -> CableForces<T> {
        let number = |of: fn(&Conditioned<f64>) -> f64| T::from_lanes(|lane| of(cycle(lane).signals));
        let mask = |of: fn(&Conditioned<f64>) -> bool| {
            T::splat(0.0).lt(T::from_lanes(|lane| f64::from(of(cycle(lane).signals))))
        };
        let mut signals = CableSignals {
            sensor_force_n: number(|signals| signals.sensor_force_n),
            displacement_m: number(|signals| signals.displacement_m),
            lead_m: T::splat(0.0),
            speed_m_per_s: number(|signals| signals.speed_m_per_s),
            length_m: number(|signals| signals.length_m),
            hold: mask(Conditioned::hold),
            sensor_fault: mask(Conditioned::sensor_fault),
            moves: mask(Conditioned::moves),
        };
        let count: [f64; LANES] = core::array::from_fn(|lane| if lane < T::COUNT { cycle(lane).cycle } else { 0.0 });
        let last = core::mem::replace(&mut self.last_cycle, count);
        if let Some(delayed) = &mut self.delay {
            let in_order = |lane: usize| {
                let signals = cycle(lane).signals;
                let pause = count[lane % LANES] - last[lane % LANES] > 1.0;
                signals.moves() && !pause
            };
            let Delayed { taps, fractions, .. } = *delayed;
            let known = [signals.displacement_m, signals.speed_m_per_s];
            let by_lines = [
                shift(&mut delayed.displacement_m, known[0], in_order, taps, fractions),
                shift(&mut delayed.speed_m_per_s, known[1], in_order, taps, fractions),
            ];
            let lead = if taps.into_iter().any(Taps::leads) {
                let leads = T::from_lanes(|lane| f64::from(taps[lane % LANES].leads()));
                let lines = &delayed.displacement_m;
                let leads_m = core::array::from_fn(|lane| lines[lane % LANES].about_lead(taps[lane % LANES]));
                (T::splat(0.0).lt(leads), About::of_lanes(&leads_m, fractions))
            } else {
                (T::Mask::NONE, T::splat(0.0))
            };
            let shifted = Shifted::new(known, by_lines, delayed.lag_m, lead);
            delayed.lag_m = shifted.lag_m;
            shifted.enter(&mut signals);
        }
        let of_lanes = |cycles: [f64; LANES]| T::from_lanes(|lane| cycles[lane % LANES]);
        let moment = Moment::new(of_lanes(count), of_lanes(last), self.cycle_s);
        let wrap_factor = T::from_lanes(|lane| cycle(lane).pose_wrap.wrap_factor);
        self.state.pose_wrap_factor = wrap_factor.scale(self.state.posed_mu_ratio);
        self.state.pose_traction_ratio = T::from_lanes(|lane| cycle(lane).pose_wrap.traction_ratio);
        cable_cycle(&self.model, self.features.limited_to::<EFFECTS>(), &signals, &moment, &mut self.state)
    }
}

/// Advances the delay lines of all lanes by one cycle.
fn shift<T: Scalar>(
    lines: &mut [DelayLine; LANES],
    values: T,
    in_order: impl Fn(usize) -> bool,
    taps: [Taps; LANES],
    fractions: [T; 2],
) -> T {
    let mut of_lanes = [About::default(); LANES];
    for (lane, ((line, taps), about)) in lines.iter_mut().zip(taps).zip(&mut of_lanes).enumerate().take(T::COUNT) {
        line.push(values.lane(lane), in_order(lane));
        *about = line.about(taps);
    }
    About::of_lanes(&of_lanes, fractions)
}

impl<T: Scalar> State<T> {
    /// Returns the value by the pose at the last position of cables that follow it, else the fixed one.
    #[inline(always)]
    fn posed(&self, place: usize, by_pose: T, fixed: &[T; PLACES]) -> T {
        let fixed = fixed.get(place).copied().unwrap_or(T::splat(0.0));
        if place + 1 < self.count { fixed } else { T::select(self.follows_pose, by_pose, fixed) }
    }
}

impl<T: Scalar> Cable<T> for State<T> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }
    #[inline(always)]
    fn wrap_factor(&self, place: usize) -> T {
        self.posed(place, self.pose_wrap_factor, &self.wrap_factor)
    }
    #[inline(always)]
    fn viscous_n(&self, place: usize, speed_m_per_s: T) -> T {
        (self.values[VISCOUS] * speed_m_per_s).scale(self.present(place))
    }
    #[inline(always)]
    fn traction_ratio(&self, place: usize) -> T {
        self.posed(place, self.pose_traction_ratio, &self.traction_ratio)
    }
    #[inline(always)]
    fn present(&self, place: usize) -> T {
        self.has_pulley.get(place).copied().unwrap_or(T::splat(0.0))
    }
    #[inline(always)]
    fn pulley_number(&self, place: usize) -> T {
        self.pulley_number.get(place).copied().unwrap_or(T::splat(0.0))
    }
    #[inline(always)]
    fn stretch_ratio(&self, place: usize) -> T {
        self.stretch_ratio.get(place).copied().unwrap_or(T::splat(0.0))
    }
    #[inline(always)]
    fn greatest_mu(&self) -> T {
        self.greatest_mu
    }
    #[inline(always)]
    fn effect(&self, place: usize) -> T {
        self.values[place]
    }
    #[inline(always)]
    fn memory(&self, place: usize) -> T {
        self.memory.get(place).copied().unwrap_or(T::splat(0.0))
    }
    #[inline(always)]
    fn set_memory(&mut self, place: usize, value: T) {
        if let Some(entry) = self.memory.get_mut(place) {
            *entry = value;
        }
    }
    #[inline(always)]
    fn pulley_friction_n(&self, place: usize) -> T {
        self.pulley_friction_n.get(place).copied().unwrap_or(T::splat(0.0))
    }
    #[inline(always)]
    fn set_pulley_friction_n(&mut self, place: usize, friction_n: T) {
        if let Some(stored_n) = self.pulley_friction_n.get_mut(place) {
            *stored_n = friction_n;
        }
    }
    #[inline(always)]
    fn lumped_friction_n(&self) -> T {
        self.lumped_friction_n
    }
    #[inline(always)]
    fn set_lumped_friction_n(&mut self, friction_n: T) {
        self.lumped_friction_n = friction_n;
    }
    #[inline(always)]
    fn held_friction_n(&self) -> T {
        self.held_friction_n
    }
    #[inline(always)]
    fn set_held_friction_n(&mut self, friction_n: T) {
        self.held_friction_n = friction_n;
    }
}
