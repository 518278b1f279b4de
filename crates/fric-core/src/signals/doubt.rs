//! Detects doubtful state after a sensor fault: jumps of the sensor, and stored friction beyond what the load allows.
//!
//! It sets the flags [`SENSOR_JUMP`](crate::CableStatus::SENSOR_JUMP) and [`UNSETTLED`](crate::CableStatus::UNSETTLED), and changes no force. A cycle
//! without suspicion costs two comparisons per cable; the reviews run only in the others. The caller must exclude non-finite input. State: six
//! numbers per cable ([`Doubts`]).
//!
//! | symbol | identifier | unit | meaning |
//! |---|---|---|---|
//! | `J` | `sensor_jump_n` | N | greatest change of the sensor force in a cycle that is no jump |
//! | `T` | `tension_n` | N | tension as if nothing rubbed, `F_s/(1 − c)` |
//! | `S` | `stored_n` | N | friction stored: `Σ\|f_j\|` with `per_pulley`, `\|f\|` with `lumped` |
//! | `B` | `bears_n` | N | friction that the present load bears at most: the sum of `μkT_j` in steady sliding, drag included |
//! | `E` | `left_n` | N | how far the force at the platform can be off through what is stored |
//! | `f_c` | | N | `B`, and what the stored friction itself, before or after the cycle, adds to the load |
//!
//! - **Jump**: `|ΔF_s| > max(J, 5 % of the smaller force + 0.1 N·(1 − c))`. For a sensor with lag or a nonlinear curve the limit is reduced by the
//!   fraction of a change that it shows in one cycle; after `n` cycles without a new value it is `1 + min(n, 10)` times as much
//!   ([`MOST_SILENT_CYCLES`]). The jump persists
//!   until the jumps since then have cancelled or led back to the previous force, each to within `J` (with a sensor whose lag is undone, until that
//!   is forgotten), or for [`LONGEST_LIE_S`] after the last jump: a level that lasts longer is taken for the load. A jump that is only partly taken
//!   back persists for that time.
//! - **Unsettled**: `S − B` exceeds 25 % of `T` + 0.1 N at the platform, or `E` exceeds half of 5 % of the force minus `E` + 0.1 N. While a jump
//!   persists, `E = S + max(B + 25 % of T + 0.1 N, S_0 + E_0)`, with `S_0` stored and `E_0` doubtful before it: the true state has stored no more in
//!   either direction, or is unsettled itself. After that, `E ← E·(e + (1 − e)·B/T)`, `e = exp(−σ|Δl|/f_c)`, which is how two Dahl states under the
//!   same load converge; with another exponent, by that law.

use crate::dahl::dahl_step;
use crate::effects::UNKNOWN;
use crate::effects::presliding_shape::PreslidingShape;
use crate::effects::sensor_lag::SensorLag;
use crate::effects::sensor_nonlinearity::SensorNonlinearity;
use crate::effects::{bearing_drag, pulley_defect};
use crate::parameters::GREATEST_MU;
use crate::pulley::wrap_factor;
use crate::robot::{CableParams, Presliding, Wrap};
use crate::scalar::{Mask, Scalar};

/// Force error at the platform that is tolerated without a flag: this fraction of the force, plus a number of newtons.
pub const TOLERATED_RATIO: f64 = 0.05;
/// See [`TOLERATED_RATIO`].
pub const TOLERATED_N: f64 = 0.1;
/// Friction that may be stored beyond what the load allows without a flag, as a fraction of the tension, plus [`TOLERATED_N`]. If a load falls at
/// rest, the model keeps the stored friction, whereas a bearing that holds less releases it, and the force is wrong by that amount. Load drops in
/// typical motion leave less (at 0.05, 82 of 400 000 samples of the example log are beyond it, at 0.25 none). At twice this value, a drop from 30 N
/// to 3 N at rest (0.7) is still beyond it.
pub const BEYOND_RATIO: f64 = 0.25;
/// Fraction of the distance that counts as motion in a cycle (`length_jump_m`, 10 m/s) by which the cable's ends can move apart: 0.5 m/s, half the
/// speed of the fastest cable in \[P\]. Twice this value halves the detected part of a spike; half of it is 0.25 m/s, which a platform swinging by 4
/// mm at 10 Hz reaches.
const STRETCHED_RATIO: f64 = 0.05;
/// Fraction of the tolerance below which the remainder of a jump counts as settled. The rest of the tolerance covers the error that one pulley passes
/// on to the next, and the stretch due to friction itself, up to the same amount. At 0.8 about 10 cycles in 10⁶ of the adversary test were wrong
/// without a flag.
const LEFT_RATIO: f64 = 0.5;
/// Greatest fraction of an error that a chain keeps feeding on, however much its pulleys hold, so that the error is forgotten in the end.
const GREATEST_FED: f64 = 0.95;
/// Duration of a jump that is not taken back, s; longer than the spikes and drop-outs of amplifiers and buses. Twice this value doubles the number of
/// flagged cycles after a true load step; half of it takes shorter faults for the load.
pub const LONGEST_LIE_S: f64 = 5.0;
/// Cycles without a new sensor force, for it is the same or no number, that allow a greater change at once: a sensor that is ten times slower than the loop
/// changes by as much as ten cycles do. At a load that rests, each of them hides a greater lie: half of it makes jumps of the loads of such a sensor, twice
/// as much hides twice the lie. A slower sensor needs a `sensor_jump_n` of its own.
pub const MOST_SILENT_CYCLES: f64 = 10.0;
/// No force changes by this much, N; far below overflow.
const NO_JUMP_N: f64 = 1e100;
/// Ratio of friction to tension that represents a pulley whose friction amplifies itself without bound.
const UNBOUNDED_RATIO: f64 = 1e6;

/// The limits of a cable.
#[derive(Clone, Copy, Debug)]
pub struct Trust {
    /// `J`, N.
    pub sensor_jump_n: f64,
    /// `0.1 N·(1 − c)`: tolerated change of the sensor force, N.
    pub tolerated_sensor_n: f64,
    /// 5 %: tolerated change as a fraction of the force.
    pub tolerated_ratio: f64,
    /// Duration for which a jump persists after it was taken back, in cycles: until the cable has forgotten what its sensor showed.
    pub recovery_cycles: f64,
    /// `B/T` of the pulleys with a fixed wrap.
    pub bears_ratio: f64,
    /// `B/T` of a pulley that follows the pose, per unit of its wrap factor.
    pub bears_per_wrap: f64,
    /// `B` without load, N.
    pub bears_n: f64,
    /// Greatest influence of stored friction on the force at the platform, at least 1.
    pub platform_share: f64,
}

impl Trust {
    /// The limits of a cable that does not exist.
    pub const NONE: Self = Self {
        sensor_jump_n: NO_JUMP_N,
        tolerated_sensor_n: 0.0,
        tolerated_ratio: TOLERATED_RATIO,
        recovery_cycles: 0.0,
        bears_ratio: UNBOUNDED_RATIO,
        bears_per_wrap: 0.0,
        bears_n: 0.0,
        platform_share: 1.0,
    };

    /// Computes the limits from a cable's parameters: `J = σ·length_jump_m/20` unless the robot file states it; without σ nothing counts as a jump.
    pub fn new(params: &CableParams, sensor_jump_n: Option<f64>, length_jump_m: f64, cycle_s: f64) -> Self {
        let values = params.values();
        let by_stiffness_n = params.friction.sigma_n_per_m.map(|sigma| STRETCHED_RATIO * length_jump_m * sigma);
        let gain = params.frictionless_gain();

        let mu = params.raised_mu().unwrap_or(GREATEST_MU);
        let raised = if params.friction.mu > 0.0 { mu / params.friction.mu } else { 1.0 };
        let defect_mu = (values[pulley_defect::MU] * raised).min(params.greatest_mu());
        let is_lumped = params.presliding == Presliding::Lumped;
        let cos = params.sensor_wrap_rad.map_or(0.0, libm::cos);
        // The fraction of a change that the sensor shows in one cycle.
        let lag = SensorLag::of(|place| values[place]);
        let shown = lag.shown_ratio(cycle_s) * SensorNonlinearity::of(|place| values[place]).shown_ratio();
        let mut trust = Self {
            sensor_jump_n: sensor_jump_n.or(by_stiffness_n.map(|force_n| shown * force_n)).unwrap_or(NO_JUMP_N),
            tolerated_sensor_n: shown * TOLERATED_N / gain,
            tolerated_ratio: shown * TOLERATED_RATIO,
            recovery_cycles: lag.recovery_cycles(cycle_s),
            bears_ratio: 0.0,
            bears_per_wrap: 0.0,
            bears_n: 0.0,
            platform_share: 1.0,
        };
        // Tension per newton of T when paying out, where friction is greatest.
        let mut tension = 1.0;
        for (place, wrap) in params.wraps.iter().take(params.pulley_count).enumerate() {
            let is_sensor = place == 0 && params.sensor_wrap_rad.is_some();
            let share = if is_sensor { gain * cos.abs() } else { 1.0 };
            if is_sensor && !is_lumped {
                trust.platform_share = share.max(1.0);
            }
            let counts = if is_lumped { share } else { 1.0 };
            let mu = if params.defect_pulley() == Some(place) { mu.max(defect_mu) } else { mu };
            match *wrap {
                Wrap::Fixed { wrap_rad } => {
                    let half = 0.5 * mu * wrap_factor(wrap_rad);
                    // `f = half·(T_0 + T_1)`, with `T_1 = T + share·f`, `T_0 = T_1 + f` at the sensor pulley, `T_0 = T`, `T_1 = T + f`
                    // behind.
                    let left = 1.0 - half * if is_sensor { 2.0 * share + 1.0 } else { 1.0 };
                    let friction = if left > 0.05 { 2.0 * half * tension / left } else { UNBOUNDED_RATIO };
                    trust.bears_ratio += counts * friction;
                    tension += share * friction;
                }
                // `2/(2 − μk) ≤ 1/(1 − μ)` for every wrap.
                Wrap::Pose => trust.bears_per_wrap = mu * tension / (1.0 - mu),
            }
            trust.bears_n += counts * values[bearing_drag::DRAG];
        }
        trust.bears_ratio = trust.bears_ratio.min(UNBOUNDED_RATIO);
        trust.bears_per_wrap = trust.bears_per_wrap.min(UNBOUNDED_RATIO);
        trust.bears_n *= tension.min(UNBOUNDED_RATIO);
        trust
    }
}

/// The state of a cable's jump detection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubts<T> {
    /// Cycles since the last valid sensor force; [`UNKNOWN`](crate::effects::UNKNOWN) before the first.
    pub unseen_cycles: T,
    /// Remaining cycles of a jump; 0 without one.
    pub jump_cycles: T,
    /// Force before the jump, N.
    pub jump_from_n: T,
    /// Sum of all jumps since then, N.
    pub jumped_n: T,
    /// Friction stored before the jump, and what was doubtful then; without a jump, friction stored before the cycle; N.
    pub stored_from_n: T,
    /// `E`, N.
    pub left_n: T,
}

/// The sensor data of a cable in one cycle.
#[derive(Clone, Copy, Debug)]
pub struct Shown<T: Scalar> {
    /// Sensor force in this cycle and in the last one, N; the last valid force if there is none.
    pub sensor_force_n: [T; 2],
    /// Whether the force is a number in this cycle.
    pub finite: T::Mask,
    /// Whether the length has jumped: an unreported time has passed, in which the force may have taken any value.
    pub paused: T::Mask,
    /// Cycles since the previous change of the force, without this one.
    pub unchanged_cycles: T,
    /// Friction stored before the cycle, N.
    pub stored_n: T,
    /// Cycles since the last one.
    pub elapsed_cycles: T,
    /// Maximum duration of a jump, in cycles.
    pub longest_cycles: T,
}

/// The stored friction of a cable after a cycle.
#[derive(Clone, Copy, Debug)]
pub struct Stored<T: Scalar> {
    /// Whether a jump persists, or persisted until now.
    pub jump: T::Mask,
    /// `T`, N.
    pub tension_n: T,
    /// `S`, N.
    pub sum_n: T,
    /// Force at the platform, N.
    pub platform_force_n: T,
    /// `B`, N.
    pub bears_n: T,
    /// Contribution to the sliding friction per newton of tension, at most.
    pub fed_ratio: T,
    /// See [`Trust::platform_share`].
    pub platform_share: T,
    /// Displacement of the contacts, m.
    pub way_m: T,
    /// σ of one contact, N/m.
    pub sigma_n_per_m: T,
    /// The exponent of presliding, if any cable has one.
    pub shape: Option<PreslidingShape<T>>,
}

/// Returns the greatest change of the sensor force that is no jump, N.
#[inline(always)]
fn greatest_change_n<T: Scalar>([force_n, last_n]: [T; 2], [jump_n, tolerated_n, tolerated_ratio]: [T; 3]) -> T {
    (force_n.min(last_n) * tolerated_ratio + tolerated_n).max(jump_n)
}

/// Returns whether a jump persists, and whether the next cycle must be reviewed too.
///
/// The limits are the first four numbers of [`Trust`]. A cable without doubts is unchanged, to the bit, whether or not it is reviewed.
#[inline(always)]
pub fn review_sensor<T: Scalar>(
    [jump_n, tolerated_n, tolerated_ratio, recovery_cycles]: [T; 4],
    shown: &Shown<T>,
    doubts: &mut Doubts<T>,
) -> [T::Mask; 2] {
    let zero = T::splat(0.0);
    let stood = zero.lt(doubts.jump_cycles);
    let [force_n, last_n] = shown.sensor_force_n;
    let jump_n = greatest_change_n(shown.sensor_force_n, [jump_n, tolerated_n, tolerated_ratio]);
    let silent_cycles = doubts.unseen_cycles + shown.unchanged_cycles;
    let is_first = T::splat(UNKNOWN).le(silent_cycles);
    let silent_cycles = T::select(is_first, silent_cycles, silent_cycles.min(T::splat(MOST_SILENT_CYCLES)));
    // A repeated wrong value ends in one cycle, however long it lasted.
    let cycles = shown.elapsed_cycles + silent_cycles.keep(stood.not());
    let change_n = force_n - last_n;
    let jumps = shown.finite.and(shown.paused.not()).and((jump_n * cycles).lt(change_n.abs()));
    let jumped_n = doubts.jumped_n + change_n.keep(jumps);
    let starts = jumps.and(stood.not());
    let from_n = T::select(starts, last_n, doubts.jump_from_n);
    let near = jumped_n.abs().le(jump_n).or((force_n - from_n).abs().le(jump_n));
    let back = jumps.and(stood).and(near);
    let left_cycles = T::select(back, recovery_cycles, (doubts.jump_cycles - shown.elapsed_cycles).max(zero));
    // A partial return hides which part is wrong, so the jump then persists for its full duration.
    let part = jumps.and(stood).and(near.not()).and((change_n.sign() * doubts.jumped_n.sign()).lt(zero));
    let (from_n, jumped_n) =
        (T::select(part, T::splat(NO_JUMP_N), from_n), T::select(part, T::splat(NO_JUMP_N), jumped_n));
    doubts.jump_cycles = T::select(jumps.and(back.not()), shown.longest_cycles, left_cycles);
    let stands = zero.lt(doubts.jump_cycles);
    doubts.jump_from_n = from_n.keep(stands);
    doubts.jumped_n = jumped_n.keep(stands);
    // It is needed until the cycle has been fully reviewed, whether the jump persists or not.
    let persisted = stood.and(jumps.or(stands));
    let needed = jumps.or(stands).or(zero.lt(doubts.left_n));
    let stored_n = shown.stored_n + doubts.left_n.keep(starts);
    doubts.stored_from_n = T::select(persisted, doubts.stored_from_n, stored_n).keep(needed);
    doubts.unseen_cycles = (doubts.unseen_cycles + shown.elapsed_cycles).keep(shown.finite.not());
    [jumps.or(stands), stands.or(shown.finite.not())]
}

/// Returns whether the stored friction is unsettled, and whether the next cycle must be reviewed too. Unaffected cables stay unchanged to the bit
/// here as well.
#[inline(always)]
pub fn review_friction<T: Scalar>(stored: &Stored<T>, doubts: &mut Doubts<T>) -> [T::Mask; 2] {
    let zero = T::splat(0.0);
    let Stored { tension_n, sum_n: stored_n, bears_n, platform_share, sigma_n_per_m, way_m, .. } = *stored;
    let tolerated_n = tension_n * T::splat(BEYOND_RATIO) + T::splat(TOLERATED_N);
    let at_most_n =
        ((stored_n + bears_n) * platform_share + tolerated_n).max((stored_n + doubts.stored_from_n) * platform_share);
    // From beyond the sliding friction `f_c`, Dahl's law converges to it as one state to another. `μk(F_0 + F_1)/2` of a sensor pulley grows by
    // `share + 1/2` times its stored friction.
    let fed = stored.fed_ratio * (platform_share + T::splat(0.5));
    // The greater one, as it falls in the cycle.
    let sliding_n = bears_n + fed * stored_n.max(doubts.stored_from_n);
    let from_n = sliding_n + doubts.left_n;
    let to_n = match &stored.shape {
        Some(shape) => shape.step_apart(from_n, sliding_n, sigma_n_per_m, way_m),
        None => dahl_step(from_n, sliding_n, sigma_n_per_m, way_m),
    };
    let own_n = (to_n - sliding_n).max(zero);
    // An error in one contact is part of the load of itself and of those behind it, and therefore of their sliding friction.
    let fed = fed.min(T::splat(GREATEST_FED));
    let left_n = T::select(stored.jump, at_most_n, own_n + fed * (doubts.left_n - own_n));
    // Below the tolerance of a cable without tension there is no doubt any more.
    doubts.left_n = left_n.keep(T::splat(LEFT_RATIO * TOLERATED_N).lt(left_n));
    doubts.stored_from_n = doubts.stored_from_n.keep(stored.jump.or(zero.lt(doubts.left_n)));
    let excess_n = (stored_n - bears_n) * platform_share;
    // The true force may be smaller than this one by the doubtful amount.
    let least_n = (stored.platform_force_n.abs() - doubts.left_n).max(zero);
    let left_tolerated_n = least_n * T::splat(LEFT_RATIO * TOLERATED_RATIO) + T::splat(LEFT_RATIO * TOLERATED_N);
    let unsettled = tolerated_n.lt(excess_n).or(left_tolerated_n.lt(doubts.left_n));
    [unsettled, zero.lt(doubts.left_n)]
}
