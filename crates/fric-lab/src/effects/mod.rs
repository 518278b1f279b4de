//! What the lab knows of each effect of the catalogue, a file each: the same physics in the simulated robot, in its own way; where the search for
//! it begins; how strong it usually is in the sweep.
//!
//! The list is that of [`Effect`]: a variant without its file does not compile. An effect that acts on the simulated robot at a place where
//! none has acted so far gets a new method of [`TruthEffect`](truth::TruthEffect) with a default that does nothing, and one call where that place is
//! (`bristle`, `motion`, `stream` in [`simulate`](crate::simulate)).

pub mod truth;

use fric_core::effects::Effect;
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
}

/// What a search on a cable begins from.
#[derive(Clone, Debug)]
pub struct Around {
    /// Cycle time, s.
    pub cycle_s: f64,
    /// Root mean square of the cable tension, N.
    pub tension_n: f64,
    /// Standard deviation of the noise, N.
    pub noise_n: f64,
    /// Root mean square of the friction found so far, N.
    pub friction_n: f64,
    /// The same of the speed while it moves, m/s.
    pub speed_m_per_s: f64,
    /// Time from the first sample to the last, of the longest log, s.
    pub end_s: f64,
    /// Periods at which the residual ripples with the cable's length, m.
    pub periods_m: Vec<f64>,
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
