//! Many random logs with known hidden effects, to test the discovery.
//!
//! [`cases`] lists the cases: nothing hidden, each effect in three strengths under three levels of noise, pairs and triples that can be
//! distinguished, four and five effects at once, other laws of presliding, drifting noise, a hand on the platform, disturbances outside the catalogue
//! alone and with an effect, and a drive on a test bench. [`Case::log`] makes the log of a case, with the robot file that a user would have: without
//! the effect, and with guessed friction values.
//!
//! A case is a description and a seed, which together determine every bit of its log. Friction, tension, the choice among the eight cables of a small
//! robot, and the sign and exact size of effects come from the seed.
//!
//! [`wrench_cases`] lists logs of whole robots that are compared with the wrench on the platform.
//!
//! ```
//! use fric_lab::simulate::sweep;
//! # fn main() -> Result<(), fric_lab::simulate::sweep::SweepError> {
//! let cases = sweep::cases();
//! assert!(cases.len() >= 300);
//! let mut log = cases[0].log()?;
//! assert_eq!(log.robot.cable_names().len(), 1);
//! assert!(log.simulation.next_cycle().is_some_and(|sample| sample.cables.len() == 1));
//! # Ok(())
//! # }
//! ```

mod case;
mod robots;
mod values;
mod wrench;

pub use case::{CaseLog, CaseTruth, SweepError};
pub use wrench::{Misstated, WrenchCase, WrenchCaseLog, WrenchCycle, WrenchGroup, WrenchTruth, wrench_cases};

use fric_core::effects::Effect;

use super::disturbances::DISTURBANCES;

/// The purpose of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Group {
    /// Nothing is hidden.
    Nothing,
    /// Nothing is hidden, but the noise drifts.
    Wander,
    /// Nothing is hidden, but a hand pushes the platform.
    Hand,
    /// One effect.
    Single,
    /// Other presliding exponents than those of [`Group::Single`].
    Law,
    /// Two effects.
    Pair,
    /// Three effects.
    Triple,
    /// Four or five effects.
    Many,
    /// A disturbance outside the catalogue.
    Outside,
    /// A disturbance outside the catalogue and one effect.
    Mixed,
    /// One drive on a test bench: no pose, 25 s, speeds from an encoder.
    Bench,
}

impl Group {
    /// Returns the name in one word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Wander => "wander",
            Self::Hand => "hand",
            Self::Single => "single",
            Self::Law => "law",
            Self::Pair => "pair",
            Self::Triple => "triple",
            Self::Many => "many",
            Self::Outside => "outside",
            Self::Mixed => "mixed",
            Self::Bench => "bench",
        }
    }
}

/// The description of one log of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The purpose.
    pub group: Group,
    /// Effects to hide, which the discovery is to find.
    pub effects: Vec<Effect>,
    /// A disturbance to hide, by its name in [`DISTURBANCES`].
    pub disturbance: Option<&'static str>,
    /// Strength of both; 1 is clearly visible. Negative values mean a presliding exponent below 1.
    pub strength_ratio: f64,
    /// White noise as a multiple of 0.02 N at the sensor and 0.01 N at the reference.
    pub noise_ratio: f64,
    /// Standard deviation of the sensor's drift, N.
    pub sensor_wander_n: f64,
    /// Standard deviation of the reference's drift, N.
    pub reference_wander_n: f64,
    /// Greatest push of a hand along each base axis, N.
    pub hand_n: f64,
    /// Seed for everything else.
    pub seed: u64,
}

/// Returns the effects for pairs and triples. An offset beside the fitted one at the platform is too weak, and a table has no name to be found.
fn combined() -> Vec<Effect> {
    let left_out = [Effect::SensorOffset, Effect::Empirical];
    Effect::kinds().filter(|effect| !left_out.contains(effect)).collect()
}

/// Pairs that look alike, so that both together say little about a search.
const ALIKE: [(Effect, Effect); 15] = [
    (Effect::BearingDrag, Effect::LoadNonlinearity),
    (Effect::TimeDelay, Effect::PulleyInertia),
    (Effect::Stribeck, Effect::FrictionDrift),
    (Effect::SensorGain, Effect::DirectionAsymmetry),
    (Effect::FrictionDrift, Effect::FrictionWarmup),
    (Effect::SensorDrift, Effect::SensorWarmup),
    (Effect::Stribeck, Effect::DwellStiction),
    (Effect::SensorGain, Effect::SensorNonlinearity),
    (Effect::LoadNonlinearity, Effect::SensorNonlinearity),
    (Effect::TimeDelay, Effect::SensorLag),
    (Effect::PulleyInertia, Effect::SensorLag),
    (Effect::TimeDelay, Effect::GearBacklash),
    (Effect::PreslidingShape, Effect::GearBacklash),
    (Effect::PulleyEccentricity, Effect::FrictionRipple),
    (Effect::PulleyEccentricity, Effect::WinchRipple),
];

/// Effects to combine with a disturbance.
const MIXED: [Effect; 4] = [Effect::Stribeck, Effect::DirectionAsymmetry, Effect::SensorGain, Effect::TimeDelay];
const STRENGTHS: [f64; 3] = [1.0, 0.5, 0.25];
const NOISES: [f64; 3] = [1.0, 0.5, 2.0];
/// Presliding exponents minus 1 in units of 0.8: exponents of 0.6, 0.8, 1.25, 1.5, 2.2, 2.6.
const LAWS: [f64; 6] = [-0.5, -0.25, 0.3125, 0.625, 1.5, 2.0];
/// Strides through all pairs, and through all triples.
const PAIR_STRIDE: usize = 3;
const TRIPLE_STRIDE: usize = 53;
/// Number of logs with four effects, and with five.
const MANY: usize = 10;
/// Effects that show only if the load changes while the winch rests.
const NEEDS_A_HAND: [Effect; 2] = [Effect::CableElasticity, Effect::LoadRelease];
/// The same of disturbances.
const DISTURBANCES_THAT_NEED_A_HAND: [&str; 1] = ["creep"];
/// Push of the hand along each axis, N: about 1.5 N in a cable.
const HAND_N: f64 = 3.0;

/// Returns all cases, each with its own seed.
#[must_use]
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for _ in 0..8 {
        cases.extend(NOISES.map(|noise_ratio| Case { noise_ratio, ..Case::of(Group::Nothing) }));
    }
    for wander_n in [0.005, 0.01, 0.02] {
        for _ in 0..2 {
            cases.push(Case { reference_wander_n: wander_n, ..Case::of(Group::Wander) });
            cases.push(Case { sensor_wander_n: wander_n, ..Case::of(Group::Wander) });
        }
    }
    cases.extend((0..8).map(|_| Case { hand_n: HAND_N, ..Case::of(Group::Hand) }));
    for effect in combined().into_iter().chain([Effect::SensorOffset]) {
        for strength_ratio in STRENGTHS {
            let single = |noise_ratio| Case { strength_ratio, noise_ratio, ..Case::hiding(Group::Single, &[effect]) };
            cases.extend(NOISES.map(single));
        }
    }
    let law = |strength_ratio| Case { strength_ratio, ..Case::hiding(Group::Law, &[Effect::PreslidingShape]) };
    cases.extend(LAWS.map(law));
    cases.extend(pairs().into_iter().step_by(PAIR_STRIDE).map(|pair| Case::hiding(Group::Pair, &pair)));
    cases.extend(triples().step_by(TRIPLE_STRIDE).map(|triple| Case::hiding(Group::Triple, &triple)));
    cases.extend((0..2 * MANY).map(|which| Case::hiding(Group::Many, &many(which))));
    for row in DISTURBANCES {
        let hand_n = if DISTURBANCES_THAT_NEED_A_HAND.contains(&row.kind) { HAND_N } else { 0.0 };
        let spoilt =
            |group, effects: &[Effect]| Case { disturbance: Some(row.kind), hand_n, ..Case::hiding(group, effects) };
        for strength_ratio in [1.0, 0.5] {
            let outside = |noise_ratio| Case { strength_ratio, noise_ratio, ..spoilt(Group::Outside, &[]) };
            cases.extend([1.0, 0.5].map(outside));
        }
        cases.extend(MIXED.map(|effect| spoilt(Group::Mixed, &[effect])));
    }
    cases.extend(NOISES.map(|noise_ratio| Case { noise_ratio, ..Case::of(Group::Bench) }));
    let on_bench = [
        Effect::Stribeck,
        Effect::DirectionAsymmetry,
        Effect::PreslidingShape,
        Effect::SensorGain,
        Effect::FrictionDrift,
        Effect::GearBacklash,
    ];
    for effect in on_bench {
        cases.push(Case::hiding(Group::Bench, &[effect]));
    }
    cases.push(Case { disturbance: Some("hum"), ..Case::of(Group::Bench) });
    for (seed, case) in (1..).zip(&mut cases) {
        case.seed = seed;
    }
    cases
}

impl Case {
    /// Returns a case with nothing hidden, default noise and seed 0.
    #[must_use]
    pub fn of(group: Group) -> Self {
        Self::hiding(group, &[])
    }

    /// Returns a case with effects at full strength, default noise and seed 0, and a hand if the effect would not show without it.
    #[must_use]
    pub fn hiding(group: Group, effects: &[Effect]) -> Self {
        Self {
            group,
            effects: effects.to_vec(),
            disturbance: None,
            strength_ratio: 1.0,
            noise_ratio: 1.0,
            sensor_wander_n: 0.0,
            reference_wander_n: 0.0,
            hand_n: if effects.iter().any(|effect| NEEDS_A_HAND.contains(effect)) { HAND_N } else { 0.0 },
            seed: 0,
        }
    }

    /// Returns a short name: group, hidden content, strength and noise if they are not 1, seed.
    #[must_use]
    pub fn name(&self) -> String {
        let mut words = vec![self.group.name().to_owned()];
        let hidden: Vec<&str> = self.effects.iter().map(|effect| effect.kind()).chain(self.disturbance).collect();
        if !hidden.is_empty() {
            words.push(hidden.join("+"));
        }
        let ratios = [("×", self.strength_ratio), ("noise ×", self.noise_ratio)];
        words.extend(
            ratios
                .into_iter()
                .filter(|(_, ratio)| (*ratio - 1.0).abs() > 0.0)
                .map(|(word, ratio)| format!("{word}{ratio}")),
        );
        let wanders = [("sensor wander", self.sensor_wander_n), ("reference wander", self.reference_wander_n)];
        words.extend(wanders.into_iter().filter(|(_, n)| *n > 0.0).map(|(word, n)| format!("{word} {n} N")));
        words.push(format!("#{}", self.seed));
        words.join(" ")
    }
}

fn is_alike(one: Effect, other: Effect) -> bool {
    ALIKE.contains(&(one, other)) || ALIKE.contains(&(other, one))
}

fn pairs() -> Vec<[Effect; 2]> {
    let all = combined();
    let each = all.iter().flat_map(|one| all.iter().filter(move |other| *other > one).map(|other| [*one, *other]));
    each.filter(|[one, other]| !is_alike(*one, *other)).collect()
}

/// Returns four effects that can be distinguished or, from the tenth case on, five: taken at a stride with a different offset each time.
fn many(which: usize) -> Vec<Effect> {
    let (wanted, stride) = (4 + which / MANY, [1, 5, 7, 11][which % 4]);
    let all = combined();
    let mut effects: Vec<Effect> = Vec::new();
    for place in 0..all.len() {
        let effect = all[(which + place * stride) % all.len()];
        if effects.len() < wanted && !effects.iter().any(|other| is_alike(effect, *other)) {
            effects.push(effect);
        }
    }
    effects
}

fn triples() -> impl Iterator<Item = [Effect; 3]> {
    pairs().into_iter().flat_map(|[one, other]| {
        let third = combined().into_iter().filter(move |third| *third > other);
        third
            .filter(move |third| !is_alike(one, *third) && !is_alike(other, *third))
            .map(move |third| [one, other, third])
    })
}
