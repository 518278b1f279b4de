//! The effect catalogue: additions to the model, each with one file and one variant of [`Effect`].
//!
//! A [row](EffectRow) states the name in the robot file, the parameters with unit, range and neutral value, the physical cause, the remedy on the
//! machine, the memory, and the influence on μ. Everything that uses effects reads the rows: the robot file, set-up, parameter changes, the
//! identification, the simulation, the command line, the documentation.
//!
//! A cable can have two ripples of one kind, with different periods: the second is a variant of its own, with the row and the file of the first.

pub mod friction;
pub mod ripple;

use core::fmt;
use core::ops::Range;

use crate::parameters::{self, FRICTION_COUNT, ParameterRow};
use crate::robot::{ParamError, check};
use crate::scalar::Scalar;

/// The definition of an effect, from which the rest of the code derives everything else. Every part must be stated, so that none is forgotten.
#[derive(Clone, Copy, Debug)]
pub struct EffectRow {
    /// Its name in robot files and reports.
    pub kind: &'static str,
    /// The physical cause, in one sentence.
    pub cause: &'static str,
    /// The remedy on the machine.
    pub remedy: &'static str,
    /// Its parameters in order.
    pub parameters: &'static [ParameterRow],
    /// Typical parameter values of a machine with some ten newtons, distinguishable from noise; used by help and tests.
    pub example: &'static [f64],
    /// Its memory from cycle to cycle.
    pub memory: Memory,
    /// Its influence on μ.
    pub on_mu: OnMu,
    /// Whether it depends on the time of the run. All such effects of a robot share one clock, which starts when the first of them is switched on.
    pub goes_by_time: bool,
}

/// State variables that an effect keeps from cycle to cycle. While the effect does not act they are [`UNKNOWN`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    /// No state.
    Nothing,
    /// This many numbers that belong to the motion: they become unknown where the motion jumps, for instance at a change of a delay.
    OfMotion(usize),
    /// This many numbers that belong to the tension.
    OfTension(usize),
}

impl Memory {
    const fn count(self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::OfMotion(count) | Self::OfTension(count) => count,
        }
    }
}

/// The influence of an effect on μ, which set-up keeps within the limits of the model.
#[derive(Clone, Copy, Debug)]
pub enum OnMu {
    /// μ is unchanged or smaller.
    Unchanged,
    /// μ grows by a bounded factor, which follows from the effect's parameter values in order.
    AtMost {
        /// The factor, at least 1.
        factor: fn(&[f64]) -> f64,
        /// The parameter to name in an error.
        key: &'static str,
        /// The problem if μ becomes too great, and what to do.
        problem: &'static str,
    },
    /// There is no bound: the cycle limits μ to what the cable allows.
    Unbounded,
}

/// The catalogue: each effect and its file, in the order of their parameters; then the second ones of the kinds that a cable can have twice, with the
/// file of the first. Passes the list to a macro.
#[doc(hidden)]
#[macro_export]
macro_rules! catalogue {
    ($with:ident) => {
        $with! {
            Stribeck stribeck,
            DirectionAsymmetry direction_asymmetry,
            BearingDrag bearing_drag,
            LoadNonlinearity load_nonlinearity,
            FrictionDrift friction_drift,
            PreslidingShape presliding_shape,
            SensorGain sensor_gain,
            SensorOffset sensor_offset,
            SensorDrift sensor_drift,
            TimeDelay time_delay,
            PulleyInertia pulley_inertia,
            PulleyEccentricity pulley_eccentricity,
            CableElasticity cable_elasticity,
            DwellStiction dwell_stiction,
            ViscousNonlinearity viscous_nonlinearity,
            FrictionRipple friction_ripple,
            WinchRipple winch_ripple,
            FrictionWarmup friction_warmup,
            PulleyDefect pulley_defect,
            LoadRelease load_release,
            GearBacklash gear_backlash,
            SensorNonlinearity sensor_nonlinearity,
            SensorWarmup sensor_warmup,
            SensorLag sensor_lag,
            Empirical empirical;
            PulleyEccentricity2 pulley_eccentricity,
            FrictionRipple2 friction_ripple,
            WinchRipple2 winch_ripple,
        }
    };
}

macro_rules! effects {
    ($($effect:ident $file:ident),+; $($second:ident $of:ident,)+) => {
        $(pub mod $file;)+

        /// A named cause of friction of a cable: those that every model has, then the catalogue, then the second ones of a kind.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Effect {
            /// Friction in proportion to the load.
            Coulomb,
            /// Friction in proportion to the speed.
            Viscous,
            /// Friction that builds up over a distance.
            Presliding,
            $(#[doc = concat!("[`", stringify!($file), "`](mod@", stringify!($file), ")")] $effect,)+
            $(#[doc = concat!("The second [`", stringify!($of), "`](mod@", stringify!($of), ") of a cable")] $second,)+
        }

        impl Effect {
            /// All effects.
            pub const ALL: &[Self] =
                &[Self::Coulomb, Self::Viscous, Self::Presliding, $(Self::$effect,)+ $(Self::$second),+];

            /// Returns its row.
            #[must_use]
            pub const fn row(self) -> &'static EffectRow {
                match self {
                    Self::Coulomb => &friction::COULOMB_ROW,
                    Self::Viscous => &friction::VISCOUS_ROW,
                    Self::Presliding => &friction::PRESLIDING_ROW,
                    $(Self::$effect => &$file::ROW,)+
                    $(Self::$second => &$of::ROW,)+
                }
            }

            /// Whether it is the second of its kind in a cable.
            #[must_use]
            pub const fn is_second(self) -> bool {
                matches!(self, $(Self::$second)|+)
            }
        }
    };
}

catalogue!(effects);

/// Indices of the parameters that every model has.
const OF_FRICTION: [usize; 3] = [parameters::MU, parameters::VISCOUS, parameters::SIGMA];

impl Effect {
    /// The effects that a cable of a robot file can have.
    pub const CATALOGUE: &[Self] = Self::ALL.split_at(OF_FRICTION.len()).1;

    /// Returns one effect of each kind of the catalogue.
    pub fn kinds() -> impl Iterator<Item = Self> + Clone {
        Self::CATALOGUE.iter().copied().filter(|effect| !effect.is_second())
    }

    /// Returns the effects of a kind that a cable can have, in the order of their entries in a robot file.
    pub fn all_of_kind(kind: &str) -> impl Iterator<Item = Self> {
        Self::CATALOGUE.iter().copied().filter(move |effect| effect.kind() == kind)
    }

    /// Returns the effect, or the first of two, with this name in robot files.
    #[must_use]
    pub fn of_kind(kind: &str) -> Option<Self> {
        Self::all_of_kind(kind).next()
    }

    /// Returns the first of its kind, if it is the second.
    #[must_use]
    pub fn first(self) -> Option<Self> {
        if self.is_second() { Self::of_kind(self.kind()) } else { None }
    }

    /// Returns its name in robot files and reports.
    #[must_use]
    pub const fn kind(self) -> &'static str {
        self.row().kind
    }

    /// Whether every model has it, so that it is no entry of `effects` in a robot file.
    #[must_use]
    pub const fn is_friction(self) -> bool {
        (self as usize) < OF_FRICTION.len()
    }

    /// Returns the index of its first parameter in [`Values`](parameters::Values).
    #[must_use]
    pub const fn first_place(self) -> usize {
        if self.is_friction() { OF_FRICTION[self as usize] } else { FRICTION_COUNT + before(self).0 }
    }

    /// Returns the indices of its parameters in [`Values`](parameters::Values).
    #[must_use]
    pub const fn places(self) -> Range<usize> {
        let first = self.first_place();
        first..first + self.row().parameters.len()
    }

    /// Returns the indices of its state variables.
    pub(crate) const fn memory_places(self) -> Range<usize> {
        let first = before(self).1;
        first..first + self.row().memory.count()
    }

    /// Returns the effect as a set of one, to test whether it acts.
    pub(crate) const fn acts(self) -> Acting {
        Acting(1 << self as u32)
    }
}

// A set of effects has 128 bits.
const _: () = assert!(Effect::ALL.len() <= u128::BITS as usize);

/// Writes the name that only this effect of a cable has: its kind, with a number if it is the second.
impl fmt::Display for Effect {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}{}", self.kind(), if self.is_second() { "_2" } else { "" })
    }
}

/// Returns the numbers of effect parameters and of state variables before those of an effect.
const fn before(effect: Effect) -> (usize, usize) {
    let (mut parameters, mut memory, mut place) = (0, 0, OF_FRICTION.len());
    while place < effect as usize {
        let row = Effect::ALL[place].row();
        parameters += row.parameters.len();
        memory += row.memory.count();
        place += 1;
    }
    (parameters, memory)
}

/// The last effect of the catalogue.
const LAST: Effect = Effect::ALL[Effect::ALL.len() - 1];
/// Number of parameters of all effects together.
pub const EFFECT_PARAMETER_COUNT: usize = before(LAST).0 + LAST.row().parameters.len();
/// Number of state variables of all effects together.
pub const MEMORY: usize = LAST.memory_places().end;

/// Represents an unknown number, far beyond all valid ones. It equals itself, as a snapshot requires, and is finite: results computed from it and
/// then not selected, which a compiler may do unasked, are no invalid operations.
pub const UNKNOWN: f64 = 1e200;
/// The row of `until_s` of an effect that depends on time: a drift observed in one run does not continue forever.
const UNTIL_ROW: ParameterRow =
    ParameterRow::setting("until_s", "s", [0.0, 0.0, 1e9], "the run itself: it is as long as this");

/// Returns the time that a drift depends on, s: that of the run, up to `until_s`; without end if that is 0.
#[inline(always)]
fn drifting_s<T: Scalar>(time_s: T, until_s: T) -> T {
    T::select(T::splat(0.0).lt(until_s), time_s.min(until_s), time_s)
}

/// Returns the completed fraction of a change towards a final value at a time, 0…1.
#[inline(always)]
fn warmed<T: Scalar>(time_s: T, time_constant_s: T) -> T {
    T::splat(1.0) - (-(time_s / time_constant_s)).exp_negative()
}

/// Returns each parameter of each effect with its effect, in the order of [`EffectParams::values`].
pub fn parameters() -> impl Iterator<Item = (Effect, &'static ParameterRow)> {
    Effect::CATALOGUE.iter().flat_map(|effect| effect.row().parameters.iter().map(|parameter| (*effect, parameter)))
}

/// The parameters of all effects of one cable; neutral unless set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParams([f64; EFFECT_PARAMETER_COUNT]);

impl EffectParams {
    /// Without any effect.
    pub const NEUTRAL: Self = Self(neutral());

    /// Returns one parameter; `None` for a key that the effect does not have.
    #[must_use]
    pub fn get(&self, effect: Effect, key: &str) -> Option<f64> {
        let mut named = parameters().zip(self.0).filter(|((of, parameter), _)| *of == effect && parameter.key == key);
        named.next().map(|(_, value)| value)
    }

    /// Sets one parameter.
    ///
    /// # Errors
    /// Returns a [`ParamError`] for a key that the effect does not have, and for a value out of the row's range.
    pub fn set(&mut self, effect: Effect, key: &str, value: f64) -> Result<(), ParamError> {
        for ((of, parameter), place) in parameters().zip(&mut self.0) {
            if of == effect && parameter.key == key {
                *place = check_parameter(effect, parameter, value)?;
                return Ok(());
            }
        }
        Err(ParamError::UNKNOWN_EFFECT)
    }

    /// Returns all parameters, effect by effect in the order of [`Effect::CATALOGUE`].
    #[must_use]
    pub const fn values(&self) -> &[f64; EFFECT_PARAMETER_COUNT] {
        &self.0
    }

    /// Creates the parameters from values in the order of [`Self::values`].
    ///
    /// # Errors
    /// Returns a [`ParamError`] with the first one that is out of its row's range.
    pub fn from_values(values: [f64; EFFECT_PARAMETER_COUNT]) -> Result<Self, ParamError> {
        for ((effect, parameter), value) in parameters().zip(values) {
            check_parameter(effect, parameter, value)?;
        }
        Ok(Self(values))
    }
}

fn check_parameter(effect: Effect, parameter: &ParameterRow, value: f64) -> Result<f64, ParamError> {
    check(parameter.key, value, parameter.min, parameter.max).map_err(|error| error.of_effect(effect))
}

impl Default for EffectParams {
    fn default() -> Self {
        Self::NEUTRAL
    }
}

const fn neutral() -> [f64; EFFECT_PARAMETER_COUNT] {
    let mut values = [0.0; EFFECT_PARAMETER_COUNT];
    let (mut place, mut effect) = (0, 0);
    while effect < Effect::CATALOGUE.len() {
        let parameters = Effect::CATALOGUE[effect].row().parameters;
        let mut parameter = 0;
        while parameter < parameters.len() {
            values[place] = parameters[parameter].neutral;
            place += 1;
            parameter += 1;
        }
        effect += 1;
    }
    values
}

/// A set of effects, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Acting(u128);

impl Acting {
    /// The empty set.
    pub const NONE: Self = Self(0);

    /// Returns the effects that have an `active` parameter; `active` gets its row and its index in [`Values`](parameters::Values).
    pub fn of(active: impl Fn(&ParameterRow, usize) -> bool) -> Self {
        let acts = |effect: &Effect| {
            effect.row().parameters.iter().zip(effect.places()).any(|(row, place)| active(row, place))
        };
        Effect::CATALOGUE.iter().filter(|effect| acts(effect)).fold(Self::NONE, |all, effect| all.and(effect.acts()))
    }

    /// Returns the effects of the catalogue that depend on time. A `const` function, computed from the rows.
    pub const fn going_by_time() -> Self {
        let (mut all, mut effect) = (Self::NONE, 0);
        while effect < Effect::CATALOGUE.len() {
            if Effect::CATALOGUE[effect].row().goes_by_time {
                all = all.and(Effect::CATALOGUE[effect].acts());
            }
            effect += 1;
        }
        all
    }

    /// Returns the effects that can raise μ.
    pub const fn raising_mu() -> Self {
        let (mut all, mut effect) = (Self::NONE, 0);
        while effect < Effect::CATALOGUE.len() {
            if !matches!(Effect::CATALOGUE[effect].row().on_mu, OnMu::Unchanged) {
                all = all.and(Effect::CATALOGUE[effect].acts());
            }
            effect += 1;
        }
        all
    }

    /// Returns the union of both sets.
    #[inline(always)]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns this set without the other.
    #[inline(always)]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether the sets have a common effect.
    #[inline(always)]
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

/// Returns the first of some values.
fn first(values: &[f64]) -> f64 {
    values.first().copied().unwrap_or(0.0)
}
