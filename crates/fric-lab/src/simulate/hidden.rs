//! An effect to hide in a log, in the command-line form `kind:key=value,…`.

use std::fmt;
use std::str::FromStr;

use fric_core::effects::{Effect, EffectParams};
use fric_core::parameters::ParameterRow;

use super::error::HiddenError;
use super::stated::{self, Allowed, Kind};

/// An effect of the catalogue with values, checked against its row.
///
/// A parameter that is not given takes the same default as in the robot file.
///
/// ```
/// use fric_core::effects::Effect;
/// use fric_lab::simulate::HiddenEffect;
/// # fn main() -> Result<(), fric_lab::simulate::HiddenError> {
/// let effect = HiddenEffect::parse("stribeck:ratio=0.5,velocity_m_per_s=0.02")?;
/// assert_eq!(effect.effect(), Effect::Stribeck);
/// assert_eq!(effect.params().get(Effect::Stribeck, "ratio"), Some(0.5));
/// let problem = HiddenEffect::parse("stribek:ratio=0.5").map_err(|error| error.to_string());
/// assert!(problem.is_err_and(|text| text.starts_with("there is no effect `stribek`; did you mean `stribeck`? known")));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HiddenEffect {
    effect: Effect,
    values: Vec<(&'static str, f64)>,
    params: EffectParams,
}

impl HiddenEffect {
    /// Reads `kind:key=value,key=value`.
    ///
    /// # Errors
    /// Returns a [`HiddenError`] that names the mistake and the known or allowed values.
    pub fn parse(text: &str) -> Result<Self, HiddenError> {
        let (kind, entries) = stated::split(text);
        let effect = find(kind)?;
        let values = stated_kind(effect).read(entries)?;
        Self::of(effect, &values)
    }

    /// Creates an effect from its name, with values by key.
    ///
    /// # Errors
    /// Returns a [`HiddenError`] that names the mistake and the known or allowed values.
    pub fn new(kind: &str, values: &[(&str, f64)]) -> Result<Self, HiddenError> {
        Self::of(find(kind)?, values)
    }

    /// Creates an effect with values by key.
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new).
    pub fn of(effect: Effect, values: &[(&str, f64)]) -> Result<Self, HiddenError> {
        let values = stated_kind(effect).check(values)?;
        let mut params = EffectParams::NEUTRAL;
        for &(key, value) in &values {
            // The value was already checked against the same row.
            let _ = params.set(effect, key, value);
        }
        Ok(Self { effect, values, params })
    }

    /// Returns the effect.
    #[must_use]
    pub fn effect(&self) -> Effect {
        self.effect
    }

    /// Returns the given values, by key.
    #[must_use]
    pub fn values(&self) -> &[(&'static str, f64)] {
        &self.values
    }

    /// Returns the parameters that were not given, by key, with their default values.
    #[must_use]
    pub fn defaults(&self) -> Vec<(&'static str, f64)> {
        let missing = |key: &str| self.values.iter().all(|(given, _)| *given != key);
        let all = self.effect.row().parameters.iter().filter(|parameter| missing(parameter.key));
        all.filter_map(|parameter| Some((parameter.key, self.params.get(self.effect, parameter.key)?))).collect()
    }

    /// Returns the effect as parameters of the compensator; all other effects are neutral.
    #[must_use]
    pub fn params(&self) -> &EffectParams {
        &self.params
    }
}

impl FromStr for HiddenEffect {
    type Err = HiddenError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::parse(text)
    }
}

/// Writes the form that [`HiddenEffect::parse`] reads.
impl fmt::Display for HiddenEffect {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        stated::write(formatter, self.effect.kind(), &self.values)
    }
}

const NOUN: &str = "effect";

fn find(kind: &str) -> Result<Effect, HiddenError> {
    let known = Effect::kinds().map(Effect::kind);
    Effect::of_kind(kind).ok_or_else(|| stated::unknown(NOUN, kind, known))
}

fn stated_kind(effect: Effect) -> Kind {
    let allowed = |&ParameterRow { key, unit, min, max, .. }: &ParameterRow| Allowed { key, unit, min, max };
    Kind { noun: NOUN, name: effect.kind(), parameters: effect.row().parameters.iter().map(allowed).collect() }
}

/// Joins names with commas.
pub(super) fn list(names: impl Iterator<Item = String>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
