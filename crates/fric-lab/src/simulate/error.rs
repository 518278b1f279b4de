//! Errors in the set-up of a simulation.

use fric_core::ParamError;
use miette::Diagnostic;
use thiserror::Error;

/// The reason why a simulation cannot be set up. Running it cannot fail.
#[derive(Clone, Debug, PartialEq, Diagnostic, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A number of [`SimulationOptions`](super::SimulationOptions) is not finite or out of range.
    #[error("`{key}` is {value}; allowed is {min} to {max}")]
    OptionOutOfRange {
        /// The field.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Least allowed value.
        min: f64,
        /// Greatest allowed value.
        max: f64,
    },
    /// More hidden effects of one kind than a cable can have.
    #[error("the effect `{kind}` is hidden too often")]
    #[diagnostic(help("Give each effect once, ripples at most twice, with all its parameters."))]
    RepeatedEffect {
        /// Its name in the catalogue.
        kind: &'static str,
    },
    /// Two disturbances of one kind.
    #[error("the disturbance `{kind}` is hidden twice")]
    #[diagnostic(help("Give each disturbance once, with all its parameters."))]
    RepeatedDisturbance {
        /// Its name.
        kind: &'static str,
    },
    /// The parameters of the robot file are invalid.
    #[error("the robot's parameters are not right: {0}")]
    Robot(#[from] ParamError),
    /// No position was found where every cable can leave its last pulley.
    #[error("the platform finds no place where all cables can leave their last pulleys")]
    #[diagnostic(help("Check `base_m`, `platform_m`, `radius_m` and `axis`, above all the unit m."))]
    NoWorkspace,
    /// A known load is given for cables that hold a platform.
    #[error("`reference` under [log] is a known load, but the cables hold a platform, which pulls as it moves")]
    #[diagnostic(help("Leave `reference` out, or `base_m` and `platform_m`."))]
    KnownLoad,
    /// A crossing run was requested for a robot without a platform to which all cables are attached.
    #[error(
        "a crossing run needs a platform that all cables are attached to, and {cable} has no `base_m` and `platform_m`"
    )]
    #[diagnostic(help("Give every cable both, or simulate the identification run."))]
    NoPlatform {
        /// The first cable without attachment.
        cable: String,
    },
}

/// The reason why a [`HiddenEffect`](super::HiddenEffect) or a [`Disturbance`](super::Disturbance) was refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HiddenError {
    /// The catalogue has no entry with this name.
    #[error("there is no {noun} `{kind}`; {}known are {known}", did_you_mean(*nearest))]
    UnknownKind {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// The given name.
        kind: String,
        /// The name that was probably meant.
        nearest: Option<&'static str>,
        /// All names, as a list.
        known: String,
    },
    /// The kind has no such parameter.
    #[error("the {noun} `{kind}` has no parameter `{key}`; {}it has {known}", did_you_mean(*nearest))]
    UnknownKey {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// The given key.
        key: String,
        /// The key that was probably meant.
        nearest: Option<&'static str>,
        /// All keys with unit and range, as a list.
        known: String,
    },
    /// A parameter was given twice.
    #[error("the {noun} `{kind}` has the parameter `{key}` twice")]
    RepeatedKey {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// The key.
        key: &'static str,
    },
    /// No parameter was given, so nothing would be hidden.
    #[error("the {noun} `{kind}` has no value, which would hide nothing; write `{kind}:key=value` with {known}")]
    NoParameter {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// All keys with unit and range, as a list.
        known: String,
    },
    /// A text is not `key=value`.
    #[error("`{text}` is not `key=value` with a number; the {noun} `{kind}` has {known}")]
    NotAValue {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// The given text.
        text: String,
        /// All keys with unit and range, as a list.
        known: String,
    },
    /// A value is not finite or out of range.
    #[error("`{key}` of the {noun} `{kind}` is {value}; allowed is {min} to {max}{}", with_unit(unit))]
    OutOfRange {
        /// `effect` or `disturbance`.
        noun: &'static str,
        /// Its name.
        kind: &'static str,
        /// The parameter.
        key: &'static str,
        /// The given value.
        value: f64,
        /// Least allowed value.
        min: f64,
        /// Greatest allowed value.
        max: f64,
        /// Its unit.
        unit: &'static str,
    },
}

/// Returns a "did you mean" question; empty if no name is similar.
fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!("did you mean `{name}`? "))
}

/// Returns the unit to print behind a number; empty for a ratio.
pub(super) fn with_unit(unit: &str) -> String {
    if unit == "1" { String::new() } else { format!(" {unit}") }
}
