//! Errors in parameters.

use core::fmt;

use crate::effects::Effect;

/// The reason why a parameter was refused: its name, its value, and what is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ParamError {
    /// Name of the parameter, including its unit, as in the robot file.
    pub key: &'static str,
    /// Index of the pulley from the winch, if it belongs to one.
    pub pulley: Option<usize>,
    /// The effect, if it belongs to one.
    pub effect: Option<Effect>,
    /// The problem.
    pub problem: ParamProblem,
}

/// The problem of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParamProblem {
    /// The value is not finite or out of range.
    OutOfRange {
        /// The given value.
        value: f64,
        /// Least allowed value.
        min: f64,
        /// Greatest allowed value.
        max: f64,
    },
    /// A list has the wrong length.
    Count {
        /// Given length.
        count: usize,
        /// Least allowed length.
        min: usize,
        /// Greatest allowed length.
        max: usize,
    },
    /// The value differs from that of the running robot and cannot be changed while it runs.
    Fixed {
        /// The given value.
        value: f64,
        /// The value of the running robot.
        running: f64,
    },
    /// Values are inconsistent, in words.
    Conflict(&'static str),
}

impl ParamError {
    /// An effect or effect parameter is not in the catalogue.
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

/// Returns `value` if it is finite and in `min…max`.
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
            write!(formatter, " of effect `{effect}`")?;
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

/// A range, in which the greatest possible number means no bound.
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
