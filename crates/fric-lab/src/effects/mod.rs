//! The lab's entry for each effect of the catalogue, one file per effect: the same physics in the simulated robot, implemented independently; the
//! start values of its search; its typical strength in the sweep.
//!
//! The list is that of [`Effect`]: a variant without its file does not compile. An effect that acts at a new place of the simulated robot gets a new
//! method of [`TruthEffect`](truth::TruthEffect) with a default that does nothing, and one call at that place (`bristle`, `motion`, `stream` in
//! [`simulate`](crate::simulate)).

pub mod truth;

use fric_core::effects::Effect;
use fric_core::parameters::{MU, Values};
use rand_chacha::ChaCha8Rng;

use self::truth::Build;
use crate::random::uniform;

/// Values of some parameters, by key.
pub type Start = Vec<(&'static str, f64)>;

/// The entry of an effect in the lab.
#[derive(Clone, Copy, Debug)]
pub struct LabEffect {
    /// The effect on the simulated robot.
    pub truth: Build,
    /// One or several starts of its search: the parameters that do not start at their neutral values.
    pub starts: fn(&Around) -> Vec<Start>,
    /// Typical values in machines.
    pub typical: fn(&mut Sizing<'_>) -> Start,
    /// Whether fitted values exceed what robots without the effect show.
    pub is_more_than_usual: fn(&Values, &Around) -> bool,
}

/// The surroundings that a search on a cable starts from.
#[derive(Clone, Debug)]
pub struct Around {
    /// Cycle time, s.
    pub cycle_s: f64,
    /// Time between two samples, s.
    pub interval_s: f64,
    /// Root mean square of the cable tension, N.
    pub tension_n: f64,
    /// Mean of the cable tension, N.
    pub mean_tension_n: f64,
    /// Standard deviation of the noise, N.
    pub noise_n: f64,
    /// Root mean square of the friction found so far, N.
    pub friction_n: f64,
    /// Root mean square of the speed while the cable moves, m/s.
    pub speed_m_per_s: f64,
    /// Duration of the longest log, s.
    pub end_s: f64,
    /// μ found so far, dimensionless.
    pub mu: f64,
    /// Compliance at which the cable stretches by as much as the friction takes to build up, while its tension changes by its standard deviation, m/N.
    pub compliance_m_per_n: f64,
    /// Standard deviation of the noise of the length, m.
    pub length_noise_m: f64,
    /// Number of pulleys of the cable.
    pub pulley_count: u32,
    /// Force of the sensor without friction at a tension of 1 N, dimensionless.
    pub sensor_ratio: f64,
    /// Sums of the wrap factors `k` of the pulleys (\[P\] 7) and of their squares, dimensionless.
    pub wrap_factor_sum: f64,
    pub wrap_factor_square_sum: f64,
    /// Periods in the cable's length at which the residual ripples.
    pub periods: Periods,
}

/// Periods of a ripple, m, the strongest first.
#[derive(Clone, Debug, Default)]
pub struct Periods {
    /// Periods of a ripple in proportion to the tension.
    pub with_load: Vec<f64>,
    /// Periods of a ripple that also reverses with the motion.
    pub with_friction: Vec<f64>,
    /// Periods of a ripple that depends on neither.
    pub alone: Vec<f64>,
}

/// Start values of warm-up time constants, as fractions of the log's duration.
const WARM_UP_RATIOS: [f64; 2] = [0.08, 0.3];

/// Minimum duration of a warm-up, as a fraction of the log: two of the blocks into which the log is cut, one of which is held out. A shorter
/// transient is the start of the run, in which friction from before is still stored.
const LEAST_WARM_UP_RATIO: f64 = 0.05;

impl Around {
    /// Whether a warm-up with this time constant lasts long enough to be distinguished from the start of the run.
    fn lasts_s(&self, time_constant_s: f64) -> bool {
        time_constant_s > LEAST_WARM_UP_RATIO * self.end_s
    }

    /// Returns by what fraction of the tension laws of the same friction differ. The friction at a pulley, `a = μ·k` of a tension, may bear on the tension
    /// before the pulley, behind it, or on their mean as in \[P\] 7. The force behind it is then `1 + a`, `1/(1 − a)` or `(2 + a)/(2 − a)` times the one before:
    /// up to `a²` more, whichever way the cable runs. A sensor with another gain or zero looks like that, and friction that differs by direction.
    fn between_laws_ratio(&self, values: &Values) -> f64 {
        values[MU] * values[MU] * self.wrap_factor_square_sum
    }

    fn time_constants_s(&self) -> [f64; 2] {
        WARM_UP_RATIOS.map(|ratio| ratio * self.end_s)
    }
}

/// The quantities that determine the size of an effect in the sweep.
pub struct Sizing<'a> {
    /// Fraction of the full strength.
    pub strength_ratio: f64,
    pub mu: f64,
    /// Mean tension, N.
    pub tension_n: f64,
    /// Mean normal force of a pulley, N.
    pub normal_n: f64,
    pub duration_s: f64,
    pub random: &'a mut ChaCha8Rng,
}

impl Sizing<'_> {
    /// Returns a value near `full` at full strength, and its fraction at others.
    pub fn about(&mut self, full: f64) -> f64 {
        full * self.strength_ratio * uniform(self.random, 0.85, 1.15)
    }

    /// Returns such a value with either sign.
    pub fn either(&mut self, full: f64) -> f64 {
        let value = self.about(full);
        if uniform(self.random, -1.0, 1.0) < 0.0 { -value } else { value }
    }
}

/// For an effect that is completely absent in robots without it.
fn always(_: &Values, _: &Around) -> bool {
    true
}

/// For an effect whose search can start at its neutral values.
fn as_it_is(_: &Around) -> Vec<Start> {
    vec![Vec::new()]
}

macro_rules! lab {
    ($($effect:ident $file:ident),+; $($second:ident $of:ident,)+) => {
        $(pub mod $file;)+

        /// Returns the lab's entry of an effect; `None` for the friction that every model has.
        pub const fn of(effect: Effect) -> Option<LabEffect> {
            match effect {
                $(Effect::$effect => Some($file::LAB),)+
                $(Effect::$second => Some($of::LAB),)+
                Effect::Coulomb | Effect::Viscous | Effect::Presliding => None,
            }
        }
    };
}

fric_core::catalogue!(lab);
