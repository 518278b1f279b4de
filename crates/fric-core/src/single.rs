//! One cable by itself, in any number type: the cycle of [`Compensator`](crate::Compensator) without the other cables.
//!
//! For: identification, which runs the cycle's equations with numbers that carry derivatives along. In `f64` it gives the
//! compensator's bits. Signals come conditioned ([`condition`](crate::signals::condition)), the wrap of a last
//! pulley that follows the pose as [`PoseWrap`].

use crate::cable::{Cable, CableForces, CableModel, Features, Pulley, cable_cycle};
use crate::effects::time_delay::{DELAY, Delay, DelayLine};
use crate::parameters::{VISCOUS, Values};
use crate::places::{NO_SLIP, PLACES, Places, START_WRAP_FACTOR};
use crate::platform::Pose;
use crate::pulley::traction_ratio;
use crate::robot::{CableParams, Wrap};
use crate::scalar::Scalar;
use crate::signals::Conditioned;
use crate::swivel;

/// What the pose means for the last pulley of a cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseWrap {
    /// `2 sin(β/2)` of its wrap.
    pub wrap_factor: f64,
    /// `e^{μ_p β}`; beyond [`NO_LIMIT_RATIO`](crate::pulley::NO_LIMIT_RATIO) without a slip limit.
    pub traction_ratio: f64,
}

impl PoseWrap {
    /// Before the first pose: 90°, no slip.
    pub const START: Self = Self { wrap_factor: START_WRAP_FACTOR, traction_ratio: NO_SLIP };

    /// The wrap at a pose; `None` for a cable without a pulley that follows it, and where the pose leaves the cable no
    /// way out of it.
    #[must_use]
    pub fn at(params: &CableParams, pose: &Pose) -> Option<Self> {
        let geometry = params.geometry.as_ref().filter(|_| params.needs_pose())?;
        let exit = swivel::exit(&geometry.swivel(), geometry.attachment_m(pose).into());
        let ratio = |traction_mu| traction_ratio(traction_mu, swivel::wrap_rad(exit.cos_sin_wrap));
        let traction_ratio = params.traction_mu.map_or(NO_SLIP, ratio);
        exit.reachable.then_some(Self { wrap_factor: exit.wrap_factor, traction_ratio })
    }
}

/// A cable with its state.
#[derive(Clone, Debug)]
pub struct SingleCable<T: Scalar> {
    model: CableModel<T>,
    features: Features,
    delay: Option<Delayed<T>>,
    state: State<T>,
}

#[derive(Clone, Debug)]
struct Delayed<T> {
    delay: Delay<T>,
    displacement_m: DelayLine,
    speed_m_per_s: DelayLine,
}

#[derive(Clone, Debug)]
struct State<T> {
    values: Values<T>,
    places: Places,
    /// Place of the pulley that follows the pose; [`PLACES`] where none does.
    pose_place: usize,
    pose_wrap: PoseWrap,
    count: usize,
    pulley_friction_n: [T; PLACES],
    lumped_friction_n: T,
    held_friction_n: T,
}

impl<T: Scalar> SingleCable<T> {
    /// A cable at rest with `values` in place of its own; `plain` gives the number in a `T`. A parameter that `varies`
    /// takes part also at its neutral value, so that its derivative is right there.
    #[must_use]
    pub fn new(
        params: &CableParams,
        values: &Values<T>,
        cycle_s: f64,
        plain: impl Fn(T) -> f64,
        varies: impl Fn(usize) -> bool,
    ) -> Self {
        let count = Places::needed(params);
        let follows_pose = params.wraps.iter().take(params.pulley_count).any(|wrap| *wrap == Wrap::Pose);
        let features = Features::default().with(params).and_acting(|place| plain(values[place])).and_varying(&varies);
        let delay_cycles = values[DELAY] / T::splat(cycle_s);
        let delayed = plain(values[DELAY]) > 0.0 || varies(DELAY);
        let zero = T::splat(0.0);
        Self {
            model: CableModel::new(params, values),
            features,
            delay: delayed.then(|| Delayed {
                delay: Delay::from_cycles(delay_cycles, plain(delay_cycles)),
                displacement_m: DelayLine::EMPTY,
                speed_m_per_s: DelayLine::EMPTY,
            }),
            state: State {
                values: *values,
                places: Places::new(params, count),
                pose_place: if follows_pose { count - 1 } else { PLACES },
                pose_wrap: PoseWrap::START,
                count,
                pulley_friction_n: [zero; PLACES],
                lumped_friction_n: zero,
                held_friction_n: zero,
            },
        }
    }

    /// One cycle. `pose_wrap` is that of the last pose there was.
    #[inline]
    pub fn step(&mut self, signals: &Conditioned<f64>, pose_wrap: PoseWrap) -> CableForces<T> {
        let (mut displacement_m, mut speed_m_per_s) =
            (T::splat(signals.displacement_m), T::splat(signals.speed_m_per_s));
        if let Some(delayed) = &mut self.delay {
            displacement_m = delayed.displacement_m.shift(signals.displacement_m, delayed.delay);
            speed_m_per_s = delayed.speed_m_per_s.shift(signals.speed_m_per_s, delayed.delay);
        }
        let mask = |truth: bool| T::splat(0.0).lt(T::splat(f64::from(truth)));
        let conditioned = Conditioned {
            sensor_force_n: T::splat(signals.sensor_force_n),
            displacement_m,
            speed_m_per_s,
            sensor_finite: mask(signals.sensor_finite),
            frozen: mask(signals.frozen),
            jump: mask(signals.jump),
            motion_finite: mask(signals.motion_finite),
        };
        self.state.pose_wrap = pose_wrap;
        cable_cycle(&self.model, self.features, &conditioned, &mut self.state)
    }
}

impl<T: Scalar> State<T> {
    #[inline(always)]
    fn at(&self, column: &[f64; PLACES], by_pose: f64, place: usize) -> T {
        T::splat(if place == self.pose_place { by_pose } else { column.get(place).copied().unwrap_or(0.0) })
    }
}

impl<T: Scalar> Cable<T> for State<T> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }
    #[inline(always)]
    fn pulley(&self, place: usize) -> Pulley<T> {
        let has_pulley = self.places.has_pulley.get(place).copied().unwrap_or(false);
        Pulley {
            wrap_factor: self.at(&self.places.wrap_factor, self.pose_wrap.wrap_factor, place),
            viscous_n_s_per_m: if has_pulley { self.values[VISCOUS] } else { T::splat(0.0) },
        }
    }
    #[inline(always)]
    fn traction_ratio(&self, place: usize) -> T {
        self.at(&self.places.traction_ratio, self.pose_wrap.traction_ratio, place)
    }
    #[inline(always)]
    fn effect(&self, place: usize) -> T {
        self.values[place]
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
