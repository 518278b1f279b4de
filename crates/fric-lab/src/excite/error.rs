//! What can be wrong with an identification run for a real robot.

use thiserror::Error;

use crate::simulate::SimulationError;
use crate::trajectory::Phase;

/// What to do, each the end of a sentence.
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

/// Why there are no set points.
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
        /// Least allowed.
        min: f64,
        /// Greatest allowed.
        max: f64,
    },
    /// A box whose corners are not in order, or without extent.
    #[error("the box goes from {from} to {to} m along {axis}; {}", advice::BOX)]
    BadBox {
        /// `x`, `y` or `z`.
        axis: &'static str,
        /// Coordinate of the first corner, m.
        from: f64,
        /// Coordinate of the second corner, m.
        to: f64,
    },
    /// An option that is about a platform, for cables that have none.
    #[error(
        "`{key}` needs a platform, and {cable} has no `base_m` and `platform_m` in the robot file; {}",
        advice::OPTION
    )]
    NeedsPlatform {
        /// The field.
        key: &'static str,
        /// The first cable without.
        cable: String,
    },
    /// The load of a test bench that the robot file knows, and is told to change.
    #[error(
        "`max_tension_n` is {greatest_n}, but the robot file knows the load of the cables and the run cannot change it; {}",
        advice::KNOWN
    )]
    LoadIsKnown {
        /// The greatest load, N.
        greatest_n: f64,
    },
    /// A least load of a test bench without a greatest.
    #[error("`min_tension_n` is {least_n} without `max_tension_n`; {}", advice::BOTH_BOUNDS)]
    NoGreatestLoad {
        /// The least load, N.
        least_n: f64,
    },
    /// A question that cannot be asked of this robot.
    #[error("{problem}")]
    BadQuestion {
        /// What is wrong and what to do, without its full stop.
        problem: String,
    },
    /// No run within the limits tells anything of what is asked.
    #[error("no run of {duration_s} s within these limits tells {what}; {}", advice::MORE)]
    CannotTell {
        /// What is asked, with what the best run would give.
        what: String,
        /// How long a run may be, s.
        duration_s: f64,
    },
    /// The design was stopped from outside.
    #[error("the design of the run was stopped")]
    Stopped,
    /// A run of more than an hour.
    #[error("the run would take {duration_s:.0} s, and more than {longest_s} s is not allowed; {}", advice::SHORTER)]
    TooLong {
        /// How long, s.
        duration_s: f64,
        /// Longest allowed, s.
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
        /// Where the platform is, m.
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
        /// Where the platform is, m.
        position_m: [f64; 3],
        /// When, s.
        time_s: f64,
        /// In which part of the run.
        phase: Phase,
        /// The cable that would be furthest out of bounds, and its force, N; `None` where not even pushing cables could
        /// hold the platform.
        worst: Option<(String, f64)>,
        /// Whether the cables hold the platform there at rest.
        holds_at_rest: bool,
    },
}

impl ExcitationError {
    /// What to do: the words that end the error's sentence, where it has any.
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
