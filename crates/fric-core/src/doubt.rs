//! What a sensor that has lied leaves doubtful: its jumps, and friction that is stored beyond what the load bears.
//!
//! For: the flags [`SENSOR_JUMP`](crate::CableStatus::SENSOR_JUMP) and [`UNSETTLED`](crate::CableStatus::UNSETTLED). It changes no force. A cycle
//! in which nothing is suspicious pays for two comparisons a cable; the reviews are for those in which something is.
//! Non-finite input is the caller's to keep out. State: six numbers a cable ([`Doubts`]).
//!
//! | symbol | identifier | unit | meaning |
//! |---|---|---|---|
//! | `J` | `sensor_jump_n` | N | greatest change of the sensor force in a cycle that is no jump |
//! | `T` | `tension_n` | N | tension as if nothing rubbed, `F_s/(1 − c)` |
//! | `S` | `stored_n` | N | friction stored: `Σ\|f_j\|` with `per_pulley`, `\|f\|` with `lumped` |
//! | `B` | `bears_n` | N | friction that the present load bears at most: the sum of `μkT_j` in steady sliding, drag included |
//! | `E` | `left_n` | N | how far the force at the platform can be off through what is stored |
//! | `f_c` | | N | `B`, and what the stored friction itself adds to the load |
//!
//! - **Jump**: `|ΔF_s| > max(J, 5 % of the smaller force + 0.1 N·(1 − c))`, of a sensor that follows late, or whose curve is bent, as much less as it shows of a change in a cycle, `n` times as much where the sensor has not changed for `n`
//!   cycles. It stands until the jumps since have cancelled or led back to where the force was, each to within `J`, with a sensor whose lag is undone until that is forgotten, or for
//!   [`LONGEST_LIE_S`] after the last of them: a level that stays longer is taken for the load. A jump that comes back by a part stands
//!   for that time.
//! - **Unsettled**: `S − B` beyond 25 % of `T` + 0.1 N at the platform, or `E` beyond half of 5 % of the force less `E` + 0.1 N. While a jump stands `E = S + max(B, S_0)`,
//!   `S_0` what was stored before it: the truth has stored no more, either way. From then on `E ← E·(e + (1 − e)·B/T)`,
//!   `e = exp(−σ|Δl|/f_c)`, by which two Dahl states under
//!   the same load come nearer, and with another exponent of the law by that law.

use crate::dahl::dahl_step;
use crate::effects::presliding_shape::PreslidingShape;
use crate::effects::sensor_lag::SensorLag;
use crate::effects::sensor_nonlinearity::SensorNonlinearity;
use crate::effects::{bearing_drag, pulley_defect};
use crate::parameters::GREATEST_MU;
use crate::pulley::wrap_factor;
use crate::robot::{CableParams, Presliding, Wrap};
use crate::scalar::{Mask, Scalar};

/// What a force at the platform may be off by without a flag: this share of it, and so many newtons.
pub const TOLERATED_RATIO: f64 = 0.05;
/// See [`TOLERATED_RATIO`].
pub const TOLERATED_N: f64 = 0.1;
/// What may be stored beyond what the load bears without a flag, as a share of the tension, beside [`TOLERATED_N`]. Where a load falls at rest the
/// model keeps what is stored; a bearing that bears no more gives it up, and the force is off by that. Loads that usual motion lets fall leave less
/// (at 0.05, 82 of 400 000 samples of the example log are beyond, at 0.25 none); at twice as much 30 N that fall to 3 N at rest (0.7) still leave more.
pub const BEYOND_RATIO: f64 = 0.25;
/// Of the way that counts as motion in a cycle (`length_jump_m`, 10 m/s), the part by which the cable's ends can run apart: 0.5 m/s, half
/// the speed of the fastest cable in \[P\]. Twice as much halves what is noticed of a spike; half as much is 0.25 m/s,
/// which a platform that swings by 4 mm at 10 Hz reaches.
const STRETCHED_RATIO: f64 = 0.05;
/// The part of what is tolerated from which on what a jump has left is settled: the rest is for what one pulley passes on to the next,
/// and for the stretch that friction itself makes, up to as much again. At 0.8 some 10 cycles in 10⁶ of the adversary were silent.
const LEFT_RATIO: f64 = 0.5;
/// The greatest part of what is off that a chain keeps feeding on, however much its pulleys bear: it is forgotten in the end.
const GREATEST_FED: f64 = 0.95;
/// How long a jump stands that is not taken back, s: beyond the spikes and drop-outs of amplifiers and buses. Twice as long doubles what
/// a real step of the load costs in flagged cycles; half as long lets a shorter lie pass for the load.
pub const LONGEST_LIE_S: f64 = 5.0;
/// No force changes by so much, N; far from what overflows.
const NO_JUMP_N: f64 = 1e100;
/// A pulley on which friction feeds on itself bears so much of the tension.
const UNBOUNDED_RATIO: f64 = 1e6;

/// What a cable can do, one set of numbers for each.
#[derive(Clone, Copy, Debug)]
pub struct Trust {
    /// `J`, N.
    pub sensor_jump_n: f64,
    /// `0.1 N·(1 − c)`: what of a sensor's change is tolerated at the platform, N.
    pub tolerated_sensor_n: f64,
    /// 5 %: the same as a share of the force, 1.
    pub tolerated_ratio: f64,
    /// For how long a jump stands that has come back: until the cable has forgotten what its sensor showed, cycles.
    pub recovery_cycles: f64,
    /// `B/T` of the pulleys whose wrap is fixed, 1.
    pub bears_ratio: f64,
    /// `B/T` of a pulley that follows the pose, for each unit of its wrap factor, 1.
    pub bears_per_wrap: f64,
    /// `B` without load, N.
    pub bears_n: f64,
    /// How often stored friction counts at the platform at most, at least once.
    pub platform_share: f64,
}

impl Trust {
    /// Of a cable that is not there.
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

    /// From a cable's parameters: `J = σ·length_jump_m/20` unless the robot file states it; without σ nothing is a jump.
    pub fn new(params: &CableParams, sensor_jump_n: Option<f64>, length_jump_m: f64, cycle_s: f64) -> Self {
        let values = params.values();
        let by_stiffness_n = params.friction.sigma_n_per_m.map(|sigma| STRETCHED_RATIO * length_jump_m * sigma);
        let gain = params.frictionless_gain();

        let mu = params.raised_mu().unwrap_or(GREATEST_MU);
        let raised = if params.friction.mu > 0.0 { mu / params.friction.mu } else { 1.0 };
        let defect_mu = (values[pulley_defect::MU] * raised).min(params.greatest_mu());
        let is_lumped = params.presliding == Presliding::Lumped;
        let cos = params.sensor_wrap_rad.map_or(0.0, libm::cos);
        // What the sensor shows of a change in a cycle.
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
        // Tension for each newton of T, paying out: there friction is greatest.
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

/// What is remembered of a cable's jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubts<T> {
    /// Cycles since the last good sensor force; [`UNKNOWN`](crate::effects::UNKNOWN) before the first.
    pub unseen_cycles: T,
    /// For how many cycles more a jump stands, 0 without one.
    pub jump_cycles: T,
    /// The force before it, N.
    pub jump_from_n: T,
    /// The sum of all jumps since, N.
    pub jumped_n: T,
    /// What was stored before the jump, N.
    pub stored_from_n: T,
    /// `E`, N.
    pub left_n: T,
}

/// What a cycle has shown of a cable's sensor.
#[derive(Clone, Copy, Debug)]
pub struct Shown<T: Scalar> {
    /// Sensor force, in this cycle and the last, the last good one where there is none, N.
    pub sensor_force_n: [T; 2],
    /// It is a number in this cycle.
    pub finite: T::Mask,
    /// The length has jumped: time has passed that nobody has told of, in which the force may have become anything.
    pub paused: T::Mask,
    /// Cycles since the force had changed before.
    pub unchanged_cycles: T,
    /// What is stored before the cycle, N.
    pub stored_n: T,
    /// Cycles since the last.
    pub elapsed_cycles: T,
    /// Cycles for which a jump stands.
    pub longest_cycles: T,
}

/// What a cycle has left stored in a cable.
#[derive(Clone, Copy, Debug)]
pub struct Stored<T: Scalar> {
    /// A jump stands, or stood until now.
    pub jump: T::Mask,
    /// `T`, N.
    pub tension_n: T,
    /// `S`, N.
    pub sum_n: T,
    /// Force at the platform, N.
    pub platform_force_n: T,
    /// `B`, N.
    pub bears_n: T,
    /// How much of it each newton of `T` is, 1.
    pub bears_ratio: T,
    /// See [`Trust::platform_share`].
    pub platform_share: T,
    /// The way of the contacts, m.
    pub way_m: T,
    /// σ of one contact, N/m.
    pub sigma_n_per_m: T,
    /// The exponent of presliding, where some cable has one.
    pub shape: Option<PreslidingShape<T>>,
}

/// The greatest change of the sensor force that is no jump, N.
#[inline(always)]
fn greatest_change_n<T: Scalar>([force_n, last_n]: [T; 2], [jump_n, tolerated_n, tolerated_ratio]: [T; 3]) -> T {
    (force_n.min(last_n) * tolerated_ratio + tolerated_n).max(jump_n)
}

/// Whether a jump stands, and whether the next cycle has to be reviewed too.
///
/// The limits are the first four numbers of [`Trust`]. A cable of which nothing is doubtful stays as it is,
/// to the bit, whoever asks.
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
    // A lie that repeats itself ends in one cycle, however long it has.
    let cycles = shown.elapsed_cycles + (doubts.unseen_cycles + shown.unchanged_cycles).keep(stood.not());
    let change_n = force_n - last_n;
    let jumps = shown.finite.and(shown.paused.not()).and((jump_n * cycles).lt(change_n.abs()));
    let jumped_n = doubts.jumped_n + change_n.keep(jumps);
    let starts = jumps.and(stood.not());
    let from_n = T::select(starts, last_n, doubts.jump_from_n);
    let near = jumped_n.abs().le(jump_n).or((force_n - from_n).abs().le(jump_n));
    let back = jumps.and(stood).and(near);
    let left_cycles = T::select(back, recovery_cycles, (doubts.jump_cycles - shown.elapsed_cycles).max(zero));
    // What comes back by a part hides which part: it then stands for its time.
    let part = jumps.and(stood).and(near.not()).and((change_n.sign() * doubts.jumped_n.sign()).lt(zero));
    let (from_n, jumped_n) =
        (T::select(part, T::splat(NO_JUMP_N), from_n), T::select(part, T::splat(NO_JUMP_N), jumped_n));
    doubts.jump_cycles = T::select(jumps.and(back.not()), shown.longest_cycles, left_cycles);
    let stands = zero.lt(doubts.jump_cycles);
    doubts.jump_from_n = from_n.keep(stands);
    doubts.jumped_n = jumped_n.keep(stands);
    // Until the cycle has been reviewed to its end it is wanted, whether the jump still stands or not.
    doubts.stored_from_n = T::select(starts, shown.stored_n, doubts.stored_from_n).keep(jumps.or(stands));
    doubts.unseen_cycles = (doubts.unseen_cycles + shown.elapsed_cycles).keep(shown.finite.not());
    [jumps.or(stands), stands.or(shown.finite.not())]
}

/// Whether what is stored is unsettled, and whether the next cycle has to be reviewed too; with the same care.
#[inline(always)]
pub fn review_friction<T: Scalar>(stored: &Stored<T>, doubts: &mut Doubts<T>) -> [T::Mask; 2] {
    let zero = T::splat(0.0);
    let Stored { tension_n, sum_n: stored_n, bears_n, platform_share, sigma_n_per_m, way_m, .. } = *stored;
    let tolerated_n = tension_n * T::splat(BEYOND_RATIO) + T::splat(TOLERATED_N);
    let at_most_n = (stored_n + bears_n.max(doubts.stored_from_n)) * platform_share;
    // From beyond the sliding friction `f_c` Dahl's law leads to it as from one state to another.
    // `μk(F_0 + F_1)/2` of a sensor pulley grows by `share + 1/2` times what it stores.
    let fed = stored.bears_ratio * (platform_share + T::splat(0.5));
    let sliding_n = bears_n + fed * stored_n;
    let from_n = sliding_n + doubts.left_n;
    let to_n = match &stored.shape {
        Some(shape) => shape.step(from_n, sliding_n, sigma_n_per_m, way_m),
        None => dahl_step(from_n, sliding_n, sigma_n_per_m, way_m),
    };
    let own_n = (to_n - sliding_n).max(zero);
    // What is off in one contact is load of itself and of those behind it, and so in what they slide at.
    let fed = fed.min(T::splat(GREATEST_FED));
    let left_n = T::select(stored.jump, at_most_n, own_n + fed * (doubts.left_n - own_n));
    // Below what is tolerated of a cable without tension nothing is doubtful any more.
    doubts.left_n = left_n.keep(T::splat(LEFT_RATIO * TOLERATED_N).lt(left_n));
    let excess_n = (stored_n - bears_n) * platform_share;
    // The true force may be less than this one by what is doubtful.
    let least_n = (stored.platform_force_n.abs() - doubts.left_n).max(zero);
    let left_tolerated_n = least_n * T::splat(LEFT_RATIO * TOLERATED_RATIO) + T::splat(LEFT_RATIO * TOLERATED_N);
    let unsettled = tolerated_n.lt(excess_n).or(left_tolerated_n.lt(doubts.left_n));
    [unsettled, zero.lt(doubts.left_n)]
}
