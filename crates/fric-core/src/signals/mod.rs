//! Validates a cable's signals: checks motion and sensor force, and replaces invalid ones.
//!
//! [`condition`] takes the raw signals of one cycle and returns finite signals and their faults. It does not depend on friction or its parameters, so
//! a log can be conditioned once and fitted many times. State: four numbers per cable.

pub(crate) mod doubt;
pub(crate) mod sample;
pub(crate) mod status;

use crate::effects::UNKNOWN;
use crate::scalar::{Mask, Scalar};

/// Sensor forces beyond this are invalid, N.
const GREATEST_FORCE_N: f64 = 1e9;
/// Distance of the cable from its position at the last sensor change beyond which an unchanged sensor is frozen, m; greater than the noise of any
/// encoder.
const FROZEN_TRAVEL_M: f64 = 1e-3;
/// Maximum number of cycles of a pause, 1000 s at 1 ms.
const GREATEST_ELAPSED: f64 = 1e6;
/// Lengths and speeds beyond this are invalid, m and m/s.
pub(crate) const GREATEST_MOTION: f64 = 1e6;

/// Limits beyond which a signal counts as faulty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalLimits {
    /// Number of cycles with an unchanged positive force after which the sensor is frozen, if the cable moved meanwhile; infinite for never.
    pub frozen_cycles: f64,
    /// Greatest change of length in one cycle, m.
    pub length_jump_m: f64,
    /// Amplitude of the noise of measured lengths, m.
    pub length_noise_m: f64,
}

/// The state of the signals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalState<T> {
    /// Last valid sensor force, N.
    pub sensor_force_n: T,
    /// Number of cycles since its last change.
    pub frozen_count: T,
    /// Distance of the cable since then, m; no longer updated once it reaches that of a frozen sensor.
    pub frozen_travel_m: T,
    /// Last valid length, m, within the noise of measured lengths; [`UNKNOWN`] before the first.
    pub length_m: T,
}

impl<T: Scalar> SignalState<T> {
    /// Returns the state before the first cycle.
    #[must_use]
    pub fn start() -> Self {
        let zero = T::splat(0.0);
        Self { sensor_force_n: zero, frozen_count: zero, frozen_travel_m: zero, length_m: T::splat(UNKNOWN) }
    }
}

/// Raw signals, not yet checked.
#[derive(Clone, Copy, Debug)]
pub struct RawSignals<T> {
    /// Sensor force, N.
    pub sensor_force_n: T,
    /// Length, m.
    pub length_m: T,
    /// Speed, m/s.
    pub speed_m_per_s: T,
}

/// Signals of one cycle, all finite except the length before the first one, and their faults.
#[derive(Clone, Copy, Debug)]
pub struct Conditioned<T: Scalar> {
    /// Sensor force, N; the last valid one if there is none.
    pub sensor_force_n: T,
    /// Change of length that counts as motion, m.
    pub displacement_m: T,
    /// Speed, m/s; 0 if the motion is invalid.
    pub speed_m_per_s: T,
    /// Last valid length, m, within the noise of measured lengths; [`UNKNOWN`] before the first.
    pub length_m: T,
    /// Whether the sensor force is a number within its range.
    pub sensor_finite: T::Mask,
    /// Whether the sensor is frozen.
    pub frozen: T::Mask,
    /// Whether the length jumped.
    pub jump: T::Mask,
    /// Whether length and speed are numbers within their ranges.
    pub motion_finite: T::Mask,
}

/// The inputs of the friction.
#[derive(Clone, Copy, Debug)]
pub struct CableSignals<T: Scalar> {
    /// Sensor force, N; the last valid one if there is none.
    pub sensor_force_n: T,
    /// Change of length that counts as motion, m.
    pub displacement_m: T,
    /// Lead of the cable ahead of the sum of all displacements, m, for motion that is known too late.
    pub lead_m: T,
    /// Speed, m/s; 0 if the motion is invalid.
    pub speed_m_per_s: T,
    /// Last valid length, m, within the noise of measured lengths; [`UNKNOWN`] before the first.
    pub length_m: T,
    /// See [`Conditioned::hold`].
    pub hold: T::Mask,
    /// See [`Conditioned::sensor_fault`].
    pub sensor_fault: T::Mask,
    /// See [`Conditioned::moves`].
    pub moves: T::Mask,
}

impl<T: Scalar> Conditioned<T> {
    /// Returns whether length and speed are valid.
    #[inline(always)]
    pub fn moves(&self) -> T::Mask {
        self.motion_finite.and(self.jump.not())
    }

    /// Returns the inputs of the friction.
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

    /// Returns whether the sensor is unusable.
    #[inline(always)]
    pub fn sensor_fault(&self) -> T::Mask {
        self.sensor_finite.not().or(self.frozen)
    }

    /// Returns whether the friction cannot be computed from these signals and the last value is held.
    #[inline(always)]
    pub fn hold(&self) -> T::Mask {
        self.sensor_fault().or(self.moves().not())
    }
}

/// Returns the number of cycles that count as elapsed: at least 1, also for NaN, and at most that of a pause.
#[inline(always)]
#[must_use]
pub fn bounded_elapsed(elapsed_cycles: f64) -> f64 {
    Scalar::min(Scalar::max(elapsed_cycles, 1.0), GREATEST_ELAPSED)
}

/// The cycle count before the first cycle of a run.
pub const BEFORE_FIRST: f64 = -1.0;

/// Returns the number of cycles since the first one of a run, 0 in the first, from the count of the previous cycle, which is [`BEFORE_FIRST`] if
/// there was none.
#[inline(always)]
#[must_use]
pub fn next_cycle(last: f64, elapsed_cycles: f64) -> f64 {
    if last < 0.0 { 0.0 } else { last + bounded_elapsed(elapsed_cycles) }
}

/// Returns the number of cycles in which length and force may have changed, for the checks of jumps: one after a pause longer than
/// [`GREATEST_ELAPSED`], so that a great change is flagged.
#[inline(always)]
pub(crate) fn checked_cycles(elapsed_cycles: f64) -> f64 {
    Scalar::max(if elapsed_cycles <= GREATEST_ELAPSED { elapsed_cycles } else { 0.0 }, 1.0)
}

/// Checks the signals of one cycle, `elapsed_cycles` after the last; for its range see [`CycleInput`](crate::CycleInput).
#[inline(always)]
pub fn condition<T: Scalar>(
    limits: &SignalLimits,
    state: &mut SignalState<T>,
    raw: &RawSignals<T>,
    elapsed_cycles: f64,
) -> Conditioned<T> {
    let zero = T::splat(0.0);
    // Motion: accept or reject the displacement of the cable.
    let motion_finite = raw.length_m.within(GREATEST_MOTION).and(raw.speed_m_per_s.within(GREATEST_MOTION));
    let change_m = raw.length_m - state.length_m;
    let length_jump_m = T::splat(limits.length_jump_m * checked_cycles(elapsed_cycles));
    // Before the first length there is no motion and no flag.
    let has_length = state.length_m.lt(T::splat(UNKNOWN));
    let jump = motion_finite.and(length_jump_m.lt(change_m.abs())).and(has_length);
    let displaces = motion_finite.and(change_m.abs().le(length_jump_m));
    let mut displacement_m = change_m.keep(displaces);
    let mut settled_m = raw.length_m;
    if limits.length_noise_m > 0.0 {
        // The play of measured lengths: only a length that pushes against its edge is motion.
        let beyond_m = (change_m.abs() - T::splat(limits.length_noise_m)).max(zero);
        displacement_m = (change_m.sign() * beyond_m).keep(displaces);
        settled_m = raw.length_m - (change_m - displacement_m).keep(displaces);
    }
    let speed_m_per_s = raw.speed_m_per_s.keep(motion_finite.and(jump.not()));
    state.length_m = T::select(motion_finite, settled_m, state.length_m);

    // Sensor: accept or reject the force.
    let sensor_finite = raw.sensor_force_n.within(GREATEST_FORCE_N);
    let sensor_force_n = T::select(sensor_finite, raw.sensor_force_n, state.sensor_force_n);
    let repeats = raw.sensor_force_n.eq(state.sensor_force_n);
    state.sensor_force_n = sensor_force_n;
    let frozen = if repeats.any() {
        // An invalid value resets the count.
        let unchanged = repeats.and(zero.lt(sensor_force_n)).and(sensor_finite);
        state.frozen_count = (state.frozen_count + T::splat(1.0)).keep(unchanged);
        // A sensor that was found frozen stays so if the cable comes back.
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
