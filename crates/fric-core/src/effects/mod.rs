//! The effect catalogue: what can be added to the model, one file and one row each.
//!
//! A row states the name of the robot file, the parameters with unit, range and neutral value, the physical cause and
//! what to do about it on the machine. Everything that deals with effects reads the rows: the robot file, the
//! identification, the simulation, the command line, the documentation. [`named`] lists them together with the friction
//! that every model has.

pub mod bearing_drag;
pub mod cable_elasticity;
pub mod direction_asymmetry;
pub mod friction;
pub mod friction_drift;
pub mod load_nonlinearity;
pub mod presliding_shape;
pub mod pulley_eccentricity;
pub mod pulley_inertia;
pub mod sensor_drift;
pub mod sensor_gain;
pub mod sensor_offset;
pub mod stribeck;
pub mod time_delay;

use core::ops::Range;

use crate::parameters::{self, FRICTION_COUNT, ParameterRow};
use crate::robot::{ParamError, check};
use crate::scalar::Scalar;

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

/// Numbers that effects remember from cycle to cycle.
pub const MEMORY: usize = 4;
/// Stands for a number that is not known yet: far beyond all that are. Equal to itself, as a snapshot has to be, and finite: what is worked
/// out from it and then not chosen, which a compiler may do unasked, is no invalid operation.
pub const UNKNOWN: f64 = 1e200;
/// Middle of the play of the tension, of `cable_elasticity`, N.
pub(crate) const TENSION: usize = 0;
/// Stretch that waits to move the cable, of `cable_elasticity`, m.
pub(crate) const STRETCH: usize = 1;
/// Both low passes of the speed, of `pulley_inertia`, m/s.
pub(crate) const SPEEDS: [usize; 2] = [2, 3];

/// The row of `until_s` of an effect that goes with time: what drifts in one run does not go on like that for ever.
const UNTIL_ROW: ParameterRow = ParameterRow {
    key: "until_s",
    unit: "s",
    neutral: 0.0,
    min: 0.0,
    max: 1e9,
    fitted: false,
    excitation: "the run itself: it is as long as this",
};

/// The time that a drift goes by, s: that of the run, up to `until_s`; without end where that is 0.
#[inline(always)]
fn drifting_s<T: Scalar>(time_s: T, until_s: T) -> T {
    T::select(T::splat(0.0).lt(until_s), time_s.min(until_s), time_s)
}

/// Every effect that a cable of a robot file can have.
pub const CATALOGUE: &[EffectRow] = &[
    stribeck::ROW,
    direction_asymmetry::ROW,
    bearing_drag::ROW,
    load_nonlinearity::ROW,
    friction_drift::ROW,
    presliding_shape::ROW,
    sensor_gain::ROW,
    sensor_offset::ROW,
    sensor_drift::ROW,
    time_delay::ROW,
    pulley_inertia::ROW,
    pulley_eccentricity::ROW,
    cable_elasticity::ROW,
];

/// Everything that has a name in the friction of a cable: what every model has, then the catalogue.
pub fn named() -> impl Iterator<Item = &'static EffectRow> {
    [friction::COULOMB_ROW, friction::VISCOUS_ROW, friction::PRESLIDING_ROW].iter().chain(CATALOGUE)
}

impl EffectRow {
    /// Places of its parameters in [`Values`](parameters::Values).
    #[must_use]
    pub fn places(&self) -> Range<usize> {
        let first = match self.kind {
            "coulomb" => parameters::MU,
            "viscous" => parameters::VISCOUS,
            "presliding" => parameters::SIGMA,
            kind => first_place(kind),
        };
        first..first + self.parameters.len()
    }
}

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
                *place = check_parameter(row, parameter, value)?;
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
        for ((row, parameter), value) in parameters().zip(values) {
            check_parameter(row, parameter, value)?;
        }
        Ok(Self(values))
    }
}

fn check_parameter(row: &EffectRow, parameter: &ParameterRow, value: f64) -> Result<f64, ParamError> {
    check(parameter.key, value, parameter.min, parameter.max).map_err(|error| error.of_effect(row.kind))
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

/// A set of effects, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Acting(u32);

impl Acting {
    /// No effect.
    pub const NONE: Self = Self(0);

    /// The effect of a name. For constants: it compares texts.
    const fn only(kind: &str) -> Self {
        let mut effect = 0;
        while effect < CATALOGUE.len() {
            if same(CATALOGUE[effect].kind.as_bytes(), kind.as_bytes()) {
                return Self(1 << effect);
            }
            effect += 1;
        }
        Self::NONE
    }

    /// The effects of which a parameter is `active`, asked by its row and its place in
    /// [`Values`](parameters::Values).
    pub fn of(active: impl Fn(&ParameterRow, usize) -> bool) -> Self {
        let mut place = FRICTION_COUNT;
        let mut bits = 0;
        for (effect, row) in CATALOGUE.iter().enumerate() {
            for parameter in row.parameters {
                bits |= u32::from(active(parameter, place)) << effect;
                place += 1;
            }
        }
        Self(bits)
    }

    /// These and those.
    #[inline(always)]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// These but for those.
    #[inline(always)]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether one of those is among these.
    #[inline(always)]
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
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
