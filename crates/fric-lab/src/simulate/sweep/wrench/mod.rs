//! Logs of whole robots with no force sensor at the platform, with known effects hidden in them: what a discovery by the wrench is tried on.
//!
//! [`wrench_cases`] lists what is tried: nothing hidden, a hand on the platform, gains on one cable and on all, drag, Stribeck effects on two
//! cables, inertia, asymmetry, ripples, delays, mixtures, hum, a wrong mass and a wrong point in the robot file. [`WrenchCase::log`] makes the log
//! of one. The reference is a wrench that is measured as often as the cycle or more seldom, or the weight of the platform.
//!
//! A case is a description and a seed; both together decide every bit of its log. The seed draws the size of the robot, its mass and so its
//! tensions, the friction of each cable, the movements and their speeds, which cables have an effect, and its exact size.
//!
//! ```
//! use fric_lab::simulate::sweep;
//! # fn main() -> Result<(), fric_lab::simulate::sweep::SweepError> {
//! let cases = sweep::wrench_cases();
//! assert!(cases.len() >= 60);
//! let log = cases[0].log()?;
//! assert_eq!(log.robot.cable_names().len(), 8);
//! assert!(log.cycles.iter().all(|cycle| cycle.wrench.is_some()));
//! # Ok(())
//! # }
//! ```

mod hidden;
mod log;
mod robot;

use crate::replay::WrenchReference;

pub use hidden::Misstated;
pub use log::{WrenchCaseLog, WrenchCycle, WrenchTruth};

/// What a log of a whole robot has in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum WrenchGroup {
    /// Nothing.
    Nothing,
    /// A hand that pushes the platform; a measured wrench has it in it.
    Hand,
    /// A sensor gain on one cable.
    Gain,
    /// A sensor gain on every cable, each its own.
    GainOnEach,
    /// The same sensor gain on all cables.
    GainOnAll,
    /// Bearing drag on one cable.
    Drag,
    /// The same bearing drag on all cables.
    DragOnAll,
    /// Stribeck effects on two cables.
    Stribeck,
    /// Pulley inertia on one cable.
    Inertia,
    /// The same pulley inertia on all cables.
    InertiaOnAll,
    /// Direction asymmetry on one cable.
    Asymmetry,
    /// An eccentric pulley on one cable.
    Ripple,
    /// A cogging winch on one cable.
    WinchRipple,
    /// Motion that is known later or earlier than it is, on one cable.
    Delay,
    /// The same delay on all cables.
    DelayOnAll,
    /// A sensor gain on one cable and bearing drag on all.
    GainAndDrag,
    /// A sensor gain on one cable and a Stribeck effect on another.
    GainAndStribeck,
    /// Hum in the force sensor of one cable.
    Hum,
    /// Hum in the force sensors of all cables, and a sensor gain on one.
    HumAndGain,
    /// The mass of the platform is another one than the robot file says.
    Mass,
    /// The last pulley of one cable is elsewhere than the robot file says.
    Base,
}

impl WrenchGroup {
    /// In a few words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Hand => "hand",
            Self::Gain => "gain on one",
            Self::GainOnEach => "gain on each",
            Self::GainOnAll => "gain on all",
            Self::Drag => "drag on one",
            Self::DragOnAll => "drag on all",
            Self::Stribeck => "stribeck on two",
            Self::Inertia => "inertia on one",
            Self::InertiaOnAll => "inertia on all",
            Self::Asymmetry => "asymmetry on one",
            Self::Ripple => "ripple on one",
            Self::WinchRipple => "winch ripple on one",
            Self::Delay => "delay on one",
            Self::DelayOnAll => "delay on all",
            Self::GainAndDrag => "gain on one + drag on all",
            Self::GainAndStribeck => "gain on one + stribeck on another",
            Self::Hum => "hum on one",
            Self::HumAndGain => "hum on all + gain on one",
            Self::Mass => "wrong mass",
            Self::Base => "wrong base_m",
        }
    }
}

/// One log of a whole robot, described.
#[derive(Clone, Debug, PartialEq)]
pub struct WrenchCase {
    /// What is in it.
    pub group: WrenchGroup,
    /// How strong that is; 1 is plain to see.
    pub strength_ratio: f64,
    /// White noise as a multiple of 0.02 N at the sensors, and of 0.01 N and 0.0005 N m in a measured wrench.
    pub noise_ratio: f64,
    /// What the log has to compare with.
    pub reference: WrenchReference,
    /// Pose and wrench are measured every so many cycles, and between two measurements on a line.
    pub wrench_every: usize,
    /// Decides the rest.
    pub seed: u64,
}

const MEASURED: WrenchReference = WrenchReference::Measured;
const MASS: WrenchReference = WrenchReference::Mass;

/// Per group: strength, noise, reference, cycles per measurement.
type Variant = (f64, f64, WrenchReference, usize);

/// The usual four variants of a group: two strengths, three noises, wrenches at 1 kHz, 250 Hz and 100 Hz, and the weight.
const USUAL: [Variant; 4] =
    [(1.0, 1.0, MEASURED, 4), (0.5, 1.0, MEASURED, 1), (1.0, 2.0, MEASURED, 10), (1.0, 0.5, MASS, 4)];

/// All cases; each has a seed of its own.
#[must_use]
pub fn wrench_cases() -> Vec<WrenchCase> {
    use WrenchGroup::{
        Asymmetry, Base, Delay, DelayOnAll, Drag, DragOnAll, Gain, GainAndDrag, GainAndStribeck, GainOnAll, GainOnEach,
        Hand, Hum, HumAndGain, Inertia, InertiaOnAll, Mass, Nothing, Ripple, Stribeck, WinchRipple,
    };
    let nothing = [1.0, 0.5, 2.0].into_iter().flat_map(|noise| {
        [(1.0, noise, MEASURED, 1), (1.0, noise, MEASURED, 4), (1.0, noise, MEASURED, 10), (1.0, noise, MASS, 1)]
    });
    let by_measurement = USUAL.iter().copied().filter(|(_, _, reference, _)| *reference == MEASURED);
    let by_mass = [(1.0, 1.0, MASS, 1), (0.5, 1.0, MASS, 4), (1.0, 2.0, MASS, 1), (0.5, 0.5, MASS, 4)];
    let mut all: Vec<(WrenchGroup, Variant)> = nothing.map(|variant| (Nothing, variant)).collect();
    all.extend(by_measurement.clone().map(|variant| (Hand, variant)));
    for group in [
        Gain,
        GainOnEach,
        Drag,
        DragOnAll,
        Stribeck,
        Inertia,
        InertiaOnAll,
        Asymmetry,
        Ripple,
        WinchRipple,
        Delay,
        DelayOnAll,
        GainAndDrag,
        GainAndStribeck,
        Hum,
        HumAndGain,
        Base,
    ] {
        all.extend(USUAL.map(|variant| (group, variant)));
    }
    // By its weight alone, a platform of another mass looks as gains that are off alike.
    all.extend(by_measurement.map(|variant| (GainOnAll, variant)));
    all.extend(by_mass.map(|variant| (Mass, variant)));
    let case = |(seed, (group, (strength_ratio, noise_ratio, reference, wrench_every)))| WrenchCase {
        group,
        strength_ratio,
        noise_ratio,
        reference,
        wrench_every,
        seed,
    };
    (1..).zip(all).map(case).collect()
}

impl WrenchCase {
    /// In a few words: what is hidden, strength and noise where they are not 1, the reference, seed.
    #[must_use]
    pub fn name(&self) -> String {
        let mut words = vec![self.group.name().to_owned()];
        let ratios = [("×", self.strength_ratio), ("noise ×", self.noise_ratio)];
        let others = ratios.into_iter().filter(|(_, ratio)| (*ratio - 1.0).abs() > 0.0);
        words.extend(others.map(|(word, ratio)| format!("{word}{ratio}")));
        words.push(match self.reference {
            WrenchReference::Measured => format!("wrench every {}", self.wrench_every),
            WrenchReference::Mass => "weight".to_owned(),
        });
        words.push(format!("#{}", self.seed));
        words.join(" ")
    }
}
