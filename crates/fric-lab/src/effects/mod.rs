//! What the lab knows of each effect of the catalogue, a file each: the same physics in the simulated robot, in its own way; where the search for
//! it begins; how strong it usually is in the sweep.
//!
//! The list is that of [`Effect`]: a variant without its file does not compile. An effect that acts on the simulated robot at a place where
//! none has acted so far gets a new method of [`TruthEffect`](truth::TruthEffect) with a default that does nothing, and one call where that place is
//! (`bristle`, `motion`, `stream` in [`simulate`](crate::simulate)).

pub mod truth;

use fric_core::effects::Effect;
use fric_core::parameters::Values;
use rand_chacha::ChaCha8Rng;

use self::truth::Build;
use crate::random::uniform;

/// Values of some parameters, by key.
pub type Start = Vec<(&'static str, f64)>;

/// What the lab knows of an effect.
#[derive(Clone, Copy, Debug)]
pub struct LabEffect {
    /// The effect on the simulated robot.
    pub truth: Build,
    /// Where the search for it begins, one or several places: the parameters that do not begin at their neutral values.
    pub starts: fn(&Around) -> Vec<Start>,
    /// Values as machines have them.
    pub typical: fn(&mut Sizing<'_>) -> Start,
    /// Whether values that were found are more than what robots without the effect have.
    pub is_more_than_usual: fn(&Values, &Around) -> bool,
}

/// What a search on a cable begins from.
#[derive(Clone, Debug)]
pub struct Around {
    /// Cycle time, s.
    pub cycle_s: f64,
    /// Root mean square of the cable tension, N.
    pub tension_n: f64,
    /// Its mean, N.
    pub mean_tension_n: f64,
    /// Standard deviation of the noise, N.
    pub noise_n: f64,
    /// Root mean square of the friction found so far, N.
    pub friction_n: f64,
    /// The same of the speed while it moves, m/s.
    pub speed_m_per_s: f64,
    /// Time from the first sample to the last, of the longest log, s.
    pub end_s: f64,
    /// μ found so far, 1.
    pub mu: f64,
    /// Compliance at which the cable stretches by as much as the friction takes to build up, while its tension changes by its standard deviation, m/N.
    pub compliance_m_per_n: f64,
    /// Standard deviation of the noise of the length, m.
    pub length_noise_m: f64,
    /// How many pulleys the cable has.
    pub pulley_count: u32,
    /// Periods at which the residual ripples with the cable's length.
    pub periods: Periods,
}

/// Periods of a ripple, m, the strongest first.
#[derive(Clone, Debug, Default)]
pub struct Periods {
    /// Of one in proportion to the tension.
    pub with_load: Vec<f64>,
    /// Of one that also turns round with the motion.
    pub with_friction: Vec<f64>,
    /// Of one that goes with neither.
    pub alone: Vec<f64>,
}

/// Time constants of what warms up that a search begins from, as shares of the log.
const WARM_UP_RATIOS: [f64; 2] = [0.08, 0.3];

/// What warms up does so for more than this share of the log: two of the blocks that it is cut into, one of which is held out. What is over
/// sooner is the beginning of the run, in which friction from before is still stored.
const LEAST_WARM_UP_RATIO: f64 = 0.05;

impl Around {
    /// Whether what warms up with a time constant does so for long enough to be told from the beginning of the run.
    fn lasts_s(&self, time_constant_s: f64) -> bool {
        time_constant_s > LEAST_WARM_UP_RATIO * self.end_s
    }

    fn time_constants_s(&self) -> [f64; 2] {
        WARM_UP_RATIOS.map(|ratio| ratio * self.end_s)
    }
}

/// What the size of an effect in the sweep goes by.
pub struct Sizing<'a> {
    /// Share of the full strength.
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
    /// About a value at full strength, the share of it at others.
    pub fn about(&mut self, full: f64) -> f64 {
        full * self.strength_ratio * uniform(self.random, 0.85, 1.15)
    }

    /// Either sign.
    pub fn either(&mut self, full: f64) -> f64 {
        let value = self.about(full);
        if uniform(self.random, -1.0, 1.0) < 0.0 { -value } else { value }
    }
}

/// For an effect of which every robot without has none at all.
fn always(_: &Values, _: &Around) -> bool {
    true
}

/// For an effect whose search leads away from its neutral values.
fn as_it_is(_: &Around) -> Vec<Start> {
    vec![Vec::new()]
}

macro_rules! lab {
    ($($effect:ident $file:ident,)+) => {
        $(mod $file;)+

        /// What the lab knows of an effect of the catalogue; `None` for the friction that every model has.
        pub const fn of(effect: Effect) -> Option<LabEffect> {
            match effect {
                $(Effect::$effect => Some($file::LAB),)+
                Effect::Coulomb | Effect::Viscous | Effect::Presliding => None,
            }
        }
    };
}

fric_core::catalogue!(lab);
