//! The effect catalogue: what can be added to the model, one file and one row each.
//!
//! A row states the name of the robot file, the parameters with unit, range and neutral value, the physical cause and
//! what to do about it on the machine. Everything that deals with effects reads the rows: the robot file, the
//! identification, the simulation, the command line, the documentation.

pub mod stribeck;
pub mod time_delay;

use crate::parameters::{FRICTION_COUNT, ParameterRow};
use crate::robot::{ParamError, check};

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

/// Every effect there is.
pub const CATALOGUE: &[EffectRow] = &[stribeck::ROW, time_delay::ROW];

/// Parameters of all effects together.
pub const EFFECT_PARAMETER_COUNT: usize = count(CATALOGUE);

/// The row of a name.
#[must_use]
pub fn row(kind: &str) -> Option<&'static EffectRow> {
    CATALOGUE.iter().find(|row| row.kind == kind)
}

/// Each parameter of each effect with its effect, in the order of [`EffectParams::values`].
pub fn parameters() -> impl Iterator<Item = (&'static EffectRow, &'static ParameterRow)> {
    CATALOGUE.iter().flat_map(|row| row.parameters.iter().map(move |parameter| (row, parameter)))
}

/// The parameters of all effects of one cable; neutral unless set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParams([f64; EFFECT_PARAMETER_COUNT]);

impl EffectParams {
    /// No effect.
    pub const NEUTRAL: Self = Self(neutral());

    /// One parameter; `None` for a kind or a key that the catalogue does not have.
    #[must_use]
    pub fn get(&self, kind: &str, key: &str) -> Option<f64> {
        let mut named =
            parameters().zip(self.0).filter(|((row, parameter), _)| row.kind == kind && parameter.key == key);
        named.next().map(|(_, value)| value)
    }

    /// Sets one parameter.
    ///
    /// # Errors
    /// [`ParamError`] for a kind or a key that the catalogue does not have, and for a value out of the row's range.
    pub fn set(&mut self, kind: &str, key: &str, value: f64) -> Result<(), ParamError> {
        for ((row, parameter), place) in parameters().zip(&mut self.0) {
            if row.kind == kind && parameter.key == key {
                *place = check(parameter.key, value, parameter.min, parameter.max)?;
                return Ok(());
            }
        }
        Err(ParamError::UNKNOWN_EFFECT)
    }

    /// All of them, effect by effect in the order of [`CATALOGUE`].
    #[must_use]
    pub const fn values(&self) -> &[f64; EFFECT_PARAMETER_COUNT] {
        &self.0
    }

    /// From values in the order of [`Self::values`].
    ///
    /// # Errors
    /// [`ParamError`] names the first that is out of its row's range.
    pub fn from_values(values: [f64; EFFECT_PARAMETER_COUNT]) -> Result<Self, ParamError> {
        for ((_, parameter), value) in parameters().zip(values) {
            check(parameter.key, value, parameter.min, parameter.max)?;
        }
        Ok(Self(values))
    }
}

impl Default for EffectParams {
    fn default() -> Self {
        Self::NEUTRAL
    }
}

const fn count(rows: &[EffectRow]) -> usize {
    match rows {
        [] => 0,
        [row, rest @ ..] => row.parameters.len() + count(rest),
    }
}

const fn neutral() -> [f64; EFFECT_PARAMETER_COUNT] {
    let mut values = [0.0; EFFECT_PARAMETER_COUNT];
    let (mut place, mut effect) = (0, 0);
    while effect < CATALOGUE.len() {
        let mut parameter = 0;
        while parameter < CATALOGUE[effect].parameters.len() {
            values[place] = CATALOGUE[effect].parameters[parameter].neutral;
            place += 1;
            parameter += 1;
        }
        effect += 1;
    }
    values
}

/// Where an effect's parameters begin among all of a cable, see [`crate::parameters`]. Evaluated by the compiler, which
/// refuses a name that is not in the catalogue: what comes out is no place of an array.
const fn first_place(kind: &str) -> usize {
    let (mut place, mut effect) = (FRICTION_COUNT, 0);
    while effect < CATALOGUE.len() {
        if same(CATALOGUE[effect].kind.as_bytes(), kind.as_bytes()) {
            return place;
        }
        place += CATALOGUE[effect].parameters.len();
        effect += 1;
    }
    usize::MAX
}

const fn same(one: &[u8], other: &[u8]) -> bool {
    match (one, other) {
        ([], []) => true,
        ([a, one @ ..], [b, other @ ..]) => *a == *b && same(one, other),
        _ => false,
    }
}
