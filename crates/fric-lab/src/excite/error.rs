//! Errors of an identification run for a real robot.

use thiserror::Error;

use crate::simulate::SimulationError;
use crate::trajectory::Phase;

/// Advice, each the end of a sentence.
mod advice {
    pub const BOX: &str = "give the lesser corner first, and at least one edge of 1 mm";
    pub const OPTION: &str = "leave it out, or give every cable both";
    pub const SHORTER: &str = "choose a smaller box, or greater limits of speed and acceleration";
    pub const REACH: &str = "choose another box, or check `base_m`, `radius_m` and `axis`";
    pub const BALANCE: &str = "check `base_m`, `platform_m` and `center_of_mass_m`, for fewer than six cables hold only a \
                               platform that hangs in one point";
    pub const GENTLER: &str = "choose a lower acceleration, a smaller box, or other bounds";
    pub const KNOWN: &str = "leave it out, or take `reference` out of `[log]` where the load can be changed";
    pub const BOTH_BOUNDS: &str = "give `max_tension_n` too, the greatest load that the bench can put on the cable";
    pub const MORE: &str = "give it more time, or greater limits of speed, acceleration and force";
    pub const ELSEWHERE: &str = "it cannot even rest there, so choose a smaller or another box, or other bounds";
}

/// The reason why there are no set points.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ExcitationError {
    /// A number of [`ExcitationOptions`](super::ExcitationOptions) is not finite or out of range.
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
    /// The corners of a box are not in order, or the box has no extent.
    #[error("the box goes from {from} to {to} m along {axis}; {}", advice::BOX)]
    BadBox {
        /// `x`, `y` or `z`.
        axis: &'static str,
        /// Coordinate of the first corner, m.
        from: f64,
        /// Coordinate of the second corner, m.
        to: f64,
    },
    /// An option concerns a platform, but the cables have none.
    #[error(
        "`{key}` needs a platform, and {cable} has no `base_m` and `platform_m` in the robot file; {}",
        advice::OPTION
    )]
    NeedsPlatform {
        /// The field.
        key: &'static str,
        /// The first cable without attachment.
        cable: String,
    },
    /// The load of a test bench is known in the robot file, but an option asks to change it.
    #[error(
        "`max_tension_n` is {greatest_n}, but the robot file knows the load of the cables and the run cannot change it; {}",
        advice::KNOWN
    )]
    LoadIsKnown {
        /// The greatest load, N.
        greatest_n: f64,
    },
    /// The least load of a test bench is given without the greatest.
    #[error("`min_tension_n` is {least_n} without `max_tension_n`; {}", advice::BOTH_BOUNDS)]
    NoGreatestLoad {
        /// The least load, N.
        least_n: f64,
    },
    /// The question does not apply to this robot.
    #[error("{problem}")]
    BadQuestion {
        /// The mistake and what to do, without the full stop.
        problem: String,
    },
    /// No run within the limits answers the question.
    #[error("no run of {duration_s} s within these limits tells {what}; {}", advice::MORE)]
    CannotTell {
        /// The question, with the result of the best run.
        what: String,
        /// Duration of the run, s.
        duration_s: f64,
    },
    /// The design was stopped from outside.
    #[error("the design of the run was stopped")]
    Stopped,
    /// The run takes more than an hour.
    #[error("the run would take {duration_s:.0} s, and more than {longest_s} s is not allowed; {}", advice::SHORTER)]
    TooLong {
        /// Duration, s.
        duration_s: f64,
        /// Greatest allowed duration, s.
        longest_s: f64,
    },
    /// No workspace was found.
    #[error(transparent)]
    Workspace(#[from] SimulationError),
    /// A cable that cannot leave its last pulley.
    #[error("{cable} cannot leave its last pulley with the platform at {}; {}", place(position_m), advice::REACH)]
    Unreachable {
        /// The cable.
        cable: String,
        /// Position of the platform, m.
        position_m: [f64; 3],
    },
    /// No forces within the bounds hold the platform.
    #[error(
        "no cable forces of {least_n:.3} N{} hold the platform at {} ({}, {time_s:.3} s): {}; {}",
        greatest_n.map_or_else(|| " or more".to_owned(), |greatest_n| format!(" to {greatest_n:.3} N")),
        place(position_m),
        phase.name(),
        blame(worst.as_ref()),
        remedy(worst.is_some(), *holds_at_rest)
    )]
    NotHeld {
        /// Least force, N.
        least_n: f64,
        /// Greatest force, N.
        greatest_n: Option<f64>,
        /// Position of the platform, m.
        position_m: [f64; 3],
        /// Time, s.
        time_s: f64,
        /// Part of the run.
        phase: Phase,
        /// The cable that would be furthest out of bounds, and its force, N; `None` if not even pushing cables could hold the platform.
        worst: Option<(String, f64)>,
        /// Whether the cables hold the platform there at rest.
        holds_at_rest: bool,
    },
}

impl ExcitationError {
    /// Returns the advice that ends the error's sentence, if there is any.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::OptionOutOfRange { .. } | Self::BadQuestion { .. } | Self::Stopped => None,
            Self::LoadIsKnown { .. } => Some(advice::KNOWN),
            Self::NoGreatestLoad { .. } => Some(advice::BOTH_BOUNDS),
            Self::CannotTell { .. } => Some(advice::MORE),
            Self::BadBox { .. } => Some(advice::BOX),
            Self::NeedsPlatform { .. } => Some(advice::OPTION),
            Self::TooLong { .. } => Some(advice::SHORTER),
            Self::Workspace(error) => error.advice(),
            Self::Unreachable { .. } => Some(advice::REACH),
            Self::NotHeld { worst, holds_at_rest, .. } => Some(remedy(worst.is_some(), *holds_at_rest)),
        }
    }
}

fn place([x_m, y_m, z_m]: &[f64; 3]) -> String {
    format!("({x_m:.3}, {y_m:.3}, {z_m:.3}) m")
}

fn blame(worst: Option<&(String, f64)>) -> String {
    match worst {
        Some((cable, force_n)) => format!("{cable} would have to pull with {force_n:.3} N"),
        None => "they cannot balance it, whatever their size or sign".to_owned(),
    }
}

fn remedy(can_balance: bool, holds_at_rest: bool) -> &'static str {
    if !can_balance {
        advice::BALANCE
    } else if holds_at_rest {
        advice::GENTLER
    } else {
        advice::ELSEWHERE
    }
}
