//! What may be believed of a cable's signals: motion and sensor force checked, and what to do where they are none.
//!
//! For: raw signals of one cycle in, finite ones and their faults out ([`condition`]). It knows no friction and no
//! parameters of it, so that a log can be conditioned once and fitted many times. State: four numbers a cable.

use crate::effects::UNKNOWN;
use crate::scalar::{Mask, Scalar};

/// Sensor forces beyond this are no forces, N.
const GREATEST_FORCE_N: f64 = 1e9;
/// A sensor that does not change while the cable gets this far from where it stood is frozen, m; beyond every encoder's noise.
const FROZEN_TRAVEL_M: f64 = 1e-3;
/// A pause counts as at most so many cycles.
const GREATEST_ELAPSED: f64 = 1e6;
/// Lengths and speeds beyond this are none, m and m/s.
pub(crate) const GREATEST_MOTION: f64 = 1e6;

/// When a signal counts as faulty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalLimits {
    /// Cycles with an unchanged sensor after which it is frozen; infinite: never.
    pub frozen_cycles: f64,
    /// Greatest change of length in one cycle, m.
    pub length_jump_m: f64,
    /// Amplitude of the noise of measured lengths, m.
    pub length_noise_m: f64,
}

/// What is remembered of the signals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalState<T> {
    /// Last good sensor force, N.
    pub sensor_force_n: T,
    /// Cycles since it has changed.
    pub frozen_count: T,
    /// How far the cable has got since then, m; once that is far enough for a frozen sensor, it stays.
    pub frozen_travel_m: T,
    /// Last finite length, m; [`UNKNOWN`] before the first.
    pub length_m: T,
}

impl<T: Scalar> SignalState<T> {
    /// Nothing seen yet.
    #[must_use]
    pub fn start() -> Self {
        let zero = T::splat(0.0);
        Self { sensor_force_n: zero, frozen_count: zero, frozen_travel_m: zero, length_m: T::splat(UNKNOWN) }
    }
}

/// Signals as they come, not checked.
#[derive(Clone, Copy, Debug)]
pub struct RawSignals<T> {
    /// Sensor force, N.
    pub sensor_force_n: T,
    /// Length, m.
    pub length_m: T,
    /// Speed, m/s.
    pub speed_m_per_s: T,
}

/// Signals of one cycle, all finite but the length before its first, and what is the matter with them.
#[derive(Clone, Copy, Debug)]
pub struct Conditioned<T: Scalar> {
    /// Sensor force, the last good one where there is none, N.
    pub sensor_force_n: T,
    /// Change of length that counts as motion, m.
    pub displacement_m: T,
    /// Speed; 0 where the motion is not to be believed, m/s.
    pub speed_m_per_s: T,
    /// Last finite length, m; [`UNKNOWN`] before the first.
    pub length_m: T,
    /// The sensor force is a number.
    pub sensor_finite: T::Mask,
    /// The sensor repeats itself.
    pub frozen: T::Mask,
    /// The length jumped.
    pub jump: T::Mask,
    /// Length and speed are numbers.
    pub motion_finite: T::Mask,
}

/// What friction is computed from.
#[derive(Clone, Copy, Debug)]
pub struct CableSignals<T: Scalar> {
    /// Sensor force, the last good one where there is none, N.
    pub sensor_force_n: T,
    /// Change of length that counts as motion, m.
    pub displacement_m: T,
    /// How far the cable is ahead of all the displacements there have been, m: of motion that is known too late.
    pub lead_m: T,
    /// Speed; 0 where the motion is not to be believed, m/s.
    pub speed_m_per_s: T,
    /// Last finite length, m; [`UNKNOWN`] before the first.
    pub length_m: T,
    /// See [`Conditioned::hold`].
    pub hold: T::Mask,
    /// See [`Conditioned::sensor_fault`].
    pub sensor_fault: T::Mask,
    /// See [`Conditioned::moves`].
    pub moves: T::Mask,
}

impl<T: Scalar> Conditioned<T> {
    /// Length and speed are to be believed.
    #[inline(always)]
    pub fn moves(&self) -> T::Mask {
        self.motion_finite.and(self.jump.not())
    }

    /// What friction is computed from.
    #[inline(always)]
    pub fn signals(&self) -> CableSignals<T> {
        CableSignals {
            sensor_force_n: self.sensor_force_n,
            displacement_m: self.displacement_m,
            lead_m: T::splat(0.0),
            speed_m_per_s: self.speed_m_per_s,
            length_m: self.length_m,
            hold: self.hold(),
            sensor_fault: self.sensor_fault(),
            moves: self.moves(),
        }
    }

    /// The sensor tells nothing.
    #[inline(always)]
    pub fn sensor_fault(&self) -> T::Mask {
        self.sensor_finite.not().or(self.frozen)
    }

    /// The friction cannot be told from these signals: hold the last.
    #[inline(always)]
    pub fn hold(&self) -> T::Mask {
        self.sensor_fault().or(self.moves().not())
    }
}

/// Cycles that count as elapsed since the last: 1 at least, for NaN too, and no more than a pause can have.
#[inline(always)]
#[must_use]
pub fn bounded_elapsed(elapsed_cycles: f64) -> f64 {
    Scalar::min(Scalar::max(elapsed_cycles, 1.0), GREATEST_ELAPSED)
}

/// The count of cycles before the first of a run.
pub const BEFORE_FIRST: f64 = -1.0;

/// Cycles since the first of a run, 0 there, from those in the cycle before, [`BEFORE_FIRST`] if there was none.
#[inline(always)]
#[must_use]
pub fn next_cycle(last: f64, elapsed_cycles: f64) -> f64 {
    if last < 0.0 { 0.0 } else { last + bounded_elapsed(elapsed_cycles) }
}

/// Checks the signals of one cycle, `elapsed_cycles` after the last (less than 1 and NaN count as 1).
#[inline(always)]
pub fn condition<T: Scalar>(
    limits: &SignalLimits,
    state: &mut SignalState<T>,
    raw: &RawSignals<T>,
    elapsed_cycles: f64,
) -> Conditioned<T> {
    let zero = T::splat(0.0);
    // Motion: what may be taken for a displacement of the cable.
    let motion_finite = raw.length_m.within(GREATEST_MOTION).and(raw.speed_m_per_s.within(GREATEST_MOTION));
    let change_m = raw.length_m - state.length_m;
    let length_jump_m = T::splat(limits.length_jump_m * bounded_elapsed(elapsed_cycles));
    // Before the first length: no motion, no flag.
    let has_length = state.length_m.lt(T::splat(UNKNOWN));
    let jump = motion_finite.and(length_jump_m.lt(change_m.abs())).and(has_length);
    let moves = motion_finite.and(change_m.abs().le(length_jump_m));
    let mut displacement_m = change_m.keep(moves);
    let mut settled_m = raw.length_m;
    if limits.length_noise_m > 0.0 {
        // The play of measured lengths: only what pushes against its edge is motion.
        let beyond_m = (change_m.abs() - T::splat(limits.length_noise_m)).max(zero);
        displacement_m = (change_m.sign() * beyond_m).keep(moves);
        settled_m = raw.length_m - (change_m - displacement_m).keep(moves);
    }
    let speed_m_per_s = raw.speed_m_per_s.keep(motion_finite.and(jump.not()));
    state.length_m = T::select(motion_finite, settled_m, state.length_m);

    // Sensor: what may be taken for a force.
    let sensor_finite = raw.sensor_force_n.within(GREATEST_FORCE_N);
    let sensor_force_n = T::select(sensor_finite, raw.sensor_force_n, state.sensor_force_n);
    let repeats = raw.sensor_force_n.eq(state.sensor_force_n);
    state.sensor_force_n = sensor_force_n;
    let frozen = if repeats.any() {
        // A value that is none says nothing about the ones around it.
        let unchanged = repeats.and(zero.lt(sensor_force_n)).and(sensor_finite);
        state.frozen_count = (state.frozen_count + T::splat(1.0)).keep(unchanged);
        // A sensor that has been found frozen is so too where the cable comes back.
        let travel_m = T::splat(FROZEN_TRAVEL_M);
        let was_far = travel_m.le(state.frozen_travel_m.abs());
        state.frozen_travel_m = (state.frozen_travel_m + displacement_m.keep(was_far.not())).keep(unchanged);
        let far = travel_m.le(state.frozen_travel_m.abs());
        let stuck = T::splat(limits.frozen_cycles).le(state.frozen_count).and(far);
        stuck.and(sensor_finite)
    } else {
        // The noise of a sensor changes its last bits in nearly every cycle.
        (state.frozen_count, state.frozen_travel_m) = (zero, zero);
        T::Mask::NONE
    };
    let length_m = state.length_m;
    Conditioned { sensor_force_n, displacement_m, speed_m_per_s, length_m, sensor_finite, frozen, jump, motion_finite }
}
