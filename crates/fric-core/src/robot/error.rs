//! What can be wrong with a parameter.

use core::fmt;

use crate::effects::Effect;

/// Why a parameter was refused: which one, its value, what is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ParamError {
    /// Name of the parameter, with its unit, as in the robot file.
    pub key: &'static str,
    /// Which pulley, from the winch, where it is one's.
    pub pulley: Option<usize>,
    /// Which effect, where it is one's.
    pub effect: Option<Effect>,
    /// What is wrong with it.
    pub problem: ParamProblem,
}

/// What is wrong with a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParamProblem {
    /// Not finite or out of range.
    OutOfRange {
        /// The value given.
        value: f64,
        /// Least allowed.
        min: f64,
        /// Greatest allowed.
        max: f64,
    },
    /// A list of the wrong length.
    Count {
        /// How many were given.
        count: usize,
        /// Fewest allowed.
        min: usize,
        /// Most allowed.
        max: usize,
    },
    /// Not what the robot that runs has, and not to be changed while it does.
    Fixed {
        /// The value given.
        value: f64,
        /// That of the robot that runs.
        running: f64,
    },
    /// Something that does not go together, in words.
    Conflict(&'static str),
}

impl ParamError {
    /// An effect or effect parameter that the catalogue does not have.
    pub(crate) const UNKNOWN_EFFECT: Self =
        Self::conflict("effects", "names an effect or a parameter that the catalogue does not have");

    pub(crate) const fn conflict(key: &'static str, reason: &'static str) -> Self {
        Self { key, pulley: None, effect: None, problem: ParamProblem::Conflict(reason) }
    }

    pub(crate) const fn at_pulley(self, place: usize) -> Self {
        Self { pulley: Some(place), ..self }
    }

    pub(crate) const fn of_effect(self, effect: Effect) -> Self {
        Self { effect: Some(effect), ..self }
    }
}

/// `value` if it is finite and in `min…max`.
///
/// # Errors
/// [`ParamProblem::OutOfRange`] otherwise.
pub fn check(key: &'static str, value: f64, min: f64, max: f64) -> Result<f64, ParamError> {
    if (min..=max).contains(&value) && value.is_finite() {
        Ok(value)
    } else {
        Err(ParamError { key, pulley: None, effect: None, problem: ParamProblem::OutOfRange { value, min, max } })
    }
}

impl fmt::Display for ParamError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, pulley, effect, problem } = self;
        write!(formatter, "`{key}`")?;
        if let Some(place) = pulley {
            write!(formatter, " of pulley {}", place + 1)?;
        }
        if let Some(effect) = effect {
            write!(formatter, " of effect `{}`", effect.kind())?;
        }
        write!(formatter, " {problem}")
    }
}

impl fmt::Display for ParamProblem {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { value, min, max } if !value.is_finite() => {
                write!(formatter, "is {value}, which is not a finite number; allowed is {}", Range(*min, *max))
            }
            Self::OutOfRange { value, min, max } => {
                write!(formatter, "is {}; allowed is {}", Plain(*value), Range(*min, *max))
            }
            Self::Count { count, min, max } if min == max => write!(formatter, "has {count} entries; {min} are needed"),
            Self::Count { count, min, max } => write!(formatter, "has {count} entries; allowed is {min} to {max}"),
            Self::Fixed { value, running } => {
                let (value, running) = (Plain(*value), Plain(*running));
                write!(formatter, "is {value}; in the robot that runs it is {running} and cannot change")
            }
            Self::Conflict(reason) => formatter.write_str(reason),
        }
    }
}

/// A number in the shorter of its two notations.
struct Plain(f64);

impl fmt::Display for Plain {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = self;
        if *value == 0.0 || (1e-4..1e7).contains(&value.abs()) {
            write!(formatter, "{value}")
        } else {
            write!(formatter, "{value:e}")
        }
    }
}

/// A range, where the greatest number there is stands for no bound.
struct Range(f64, f64);

impl fmt::Display for Range {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self(min, f64::MAX) if min <= -f64::MAX => formatter.write_str("any finite number"),
            Self(min, f64::MAX) => write!(formatter, "{} or greater", Plain(min)),
            Self(min, max) => write!(formatter, "{} to {}", Plain(min), Plain(max)),
        }
    }
}

impl core::error::Error for ParamError {}
