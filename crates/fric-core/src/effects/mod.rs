//! The effect catalogue: what can be added to the model, one file and one row each.
//!
//! A row states the name of the robot file, the parameters with unit, range and neutral value, the physical cause and
//! what to do about it on the machine. Everything that deals with effects reads the rows: the robot file, the simulation,
//! the command line, the documentation.

pub mod stribeck;
pub mod time_delay;

use crate::robot::{ParamError, check};
use stribeck::Stribeck;

/// One effect of the catalogue.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct EffectRow {
    /// Its name in robot files and reports.
    pub kind: &'static str,
    /// What happens physically, in one sentence.
    pub cause: &'static str,
    /// What to do about it on the machine.
    pub remedy: &'static str,
    /// Its parameters in order.
    pub parameters: &'static [ParameterRow],
}

/// One parameter of an effect.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ParameterRow {
    /// Its key in robot files, with the unit in it.
    pub key: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The value without effect; also what a file that leaves it out means.
    pub neutral: f64,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

/// Every effect there is.
pub const CATALOGUE: &[EffectRow] = &[stribeck::ROW, time_delay::ROW];

/// The row of a name.
#[must_use]
pub fn row(kind: &str) -> Option<&'static EffectRow> {
    CATALOGUE.iter().find(|row| row.kind == kind)
}

/// The parameters of all effects of one cable; neutral unless set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParams {
    /// Friction falling with speed.
    pub stribeck: Stribeck<f64>,
    /// Motion ahead of the cable, s.
    pub delay_s: f64,
}

impl EffectParams {
    /// No effect.
    pub const NEUTRAL: Self = Self { stribeck: Stribeck { ratio: 0.0, velocity_m_per_s: 0.02 }, delay_s: 0.0 };

    /// Sets one parameter.
    ///
    /// # Errors
    /// [`ParamError`] for a kind or a key that the catalogue does not have, and for a value out of the row's range.
    pub fn set(&mut self, kind: &str, key: &str, value: f64) -> Result<(), ParamError> {
        let parameter = row(kind).and_then(|row| row.parameters.iter().find(|parameter| parameter.key == key));
        let parameter = parameter.ok_or(ParamError::UNKNOWN_EFFECT)?;
        let value = check(parameter.key, value, parameter.min, parameter.max)?;
        match (kind, key) {
            ("stribeck", "ratio") => self.stribeck.ratio = value,
            ("stribeck", "velocity_m_per_s") => self.stribeck.velocity_m_per_s = value,
            ("time_delay", "delay_s") => self.delay_s = value,
            _ => return Err(ParamError::UNKNOWN_EFFECT),
        }
        Ok(())
    }
}

impl Default for EffectParams {
    fn default() -> Self {
        Self::NEUTRAL
    }
}
