//! What can be wrong with a simulation.

use fric_core::ParamError;
use thiserror::Error;

/// What to do, each the end of a sentence.
mod advice {
    pub const EFFECT: &str = "give each effect once, with all its parameters";
    pub const DISTURBANCE: &str = "give each disturbance once, with all its parameters";
    pub const GEOMETRY: &str = "check `base_m`, `platform_m`, `radius_m` and `axis`, above all the unit m";
    pub const LOAD: &str = "leave `reference` out, or `base_m` and `platform_m`";
    pub const PLATFORM: &str = "give every cable both, or simulate the identification run";
}

/// Why a simulation cannot be set up. Running it cannot fail.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A number of [`SimulationOptions`](super::SimulationOptions) is not finite or out of range.
    #[error("`{key}` is {value}; allowed is {min} to {max}")]
    OptionOutOfRange {
        /// The field.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Least allowed.
        min: f64,
        /// Greatest allowed.
        max: f64,
    },
    /// Two hidden effects of one kind.
    #[error("the effect `{kind}` is hidden twice; {}", advice::EFFECT)]
    RepeatedEffect {
        /// Its name in the catalogue.
        kind: &'static str,
    },
    /// Two disturbances of one kind.
    #[error("the disturbance `{kind}` is hidden twice; {}", advice::DISTURBANCE)]
    RepeatedDisturbance {
        /// Its name.
        kind: &'static str,
    },
    /// The robot file's parameters are not right.
    #[error("the robot's parameters are not right: {0}")]
    Robot(#[from] ParamError),
    /// No place was found where every cable can leave its last pulley.
    #[error("the platform finds no place where all cables can leave their last pulleys; {}", advice::GEOMETRY)]
    NoWorkspace,
    /// Loads that are known, of cables that hold a platform.
    #[error(
        "`reference` under [log] is a known load, but the cables hold a platform, which pulls as it moves; {}",
        advice::LOAD
    )]
    KnownLoad,
    /// A crossing run of a robot without a platform that all cables hold.
    #[error(
        "a crossing run needs a platform that all cables are attached to, and {cable} has no `base_m` and `platform_m`; {}",
        advice::PLATFORM
    )]
    NoPlatform {
        /// The first cable without.
        cable: String,
    },
}

impl SimulationError {
    /// What to do: the words that end the error's sentence, where it has any.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::OptionOutOfRange { .. } | Self::Robot(_) => None,
            Self::RepeatedEffect { .. } => Some(advice::EFFECT),
            Self::RepeatedDisturbance { .. } => Some(advice::DISTURBANCE),
            Self::NoWorkspace => Some(advice::GEOMETRY),
            Self::KnownLoad => Some(advice::LOAD),
            Self::NoPlatform { .. } => Some(advice::PLATFORM),
        }
    }
}

/// Why what is to be hidden, a [`HiddenEffect`](super::HiddenEffect) or a [`Disturbance`](super::Disturbance), was refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HiddenError {
    /// The catalogue has nothing of that name.
    #[error("there is no {noun} `{kind}`; {}known are {known}", did_you_mean(*nearest))]
    UnknownKind {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// The name given.
        kind: String,
        /// The one that was probably meant.
        nearest: Option<&'static str>,
        /// All names, as a list.
        known: String,
    },
    /// It has no such parameter.
    #[error("the {noun} `{kind}` has no parameter `{key}`; {}it has {known}", did_you_mean(*nearest))]
    UnknownKey {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// The key given.
        key: String,
        /// The one that was probably meant.
        nearest: Option<&'static str>,
        /// All keys with unit and range, as a list.
        known: String,
    },
    /// A parameter that is given twice.
    #[error("the {noun} `{kind}` has the parameter `{key}` twice")]
    RepeatedKey {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// The key.
        key: &'static str,
    },
    /// No parameter at all, so that nothing would be hidden.
    #[error("the {noun} `{kind}` has no value, which would hide nothing; write `{kind}:key=value` with {known}")]
    NoParameter {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// All keys with unit and range, as a list.
        known: String,
    },
    /// Something that is not `key=value`.
    #[error("`{text}` is not `key=value` with a number; the {noun} `{kind}` has {known}")]
    NotAValue {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// The text given.
        text: String,
        /// All keys with unit and range, as a list.
        known: String,
    },
    /// A value that is not finite or out of range.
    #[error("`{key}` of the {noun} `{kind}` is {value}; allowed is {min} to {max}{}", with_unit(unit))]
    OutOfRange {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// The parameter.
        key: &'static str,
        /// The value given.
        value: f64,
        /// Least allowed.
        min: f64,
        /// Greatest allowed.
        max: f64,
        /// Its unit.
        unit: &'static str,
    },
}

/// A question in front of what is known; nothing where no name is like the one given.
fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!("did you mean `{name}`? "))
}

/// A unit behind a number; nothing for a ratio.
pub(super) fn with_unit(unit: &str) -> String {
    if unit == "1" { String::new() } else { format!(" {unit}") }
}
