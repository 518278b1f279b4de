//! Errors of an identification run for a real robot.

use miette::Diagnostic;
use thiserror::Error;

use crate::simulate::SimulationError;
use crate::trajectory::Phase;

/// The reason why there are no set points.
#[derive(Clone, Debug, PartialEq, Diagnostic, Error)]
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
    #[error("the box goes from {from} to {to} m along {axis}")]
    #[diagnostic(help("Give the lesser corner first, and at least one edge of 1 mm."))]
    BadBox {
        /// `x`, `y` or `z`.
        axis: &'static str,
        /// Coordinate of the first corner, m.
        from: f64,
        /// Coordinate of the second corner, m.
        to: f64,
    },
    /// An option concerns a platform, but the cables have none.
    #[error("`{key}` needs a platform, and {cable} has no `base_m` and `platform_m` in the robot file")]
    #[diagnostic(help("Leave it out, or give every cable both."))]
    NeedsPlatform {
        /// The field.
        key: &'static str,
        /// The first cable without attachment.
        cable: String,
    },
    /// The load of a test bench is known in the robot file, but an option asks to change it.
    #[error(
        "`max_tension_n` is {greatest_n}, but the robot file knows the load of the cables and the run cannot change it"
    )]
    #[diagnostic(help("Leave it out, or take `reference` out of `[log]` where the load can be changed."))]
    LoadIsKnown {
        /// The greatest load, N.
        greatest_n: f64,
    },
    /// The least load of a test bench is given without the greatest.
    #[error("`min_tension_n` is {least_n} without `max_tension_n`")]
    #[diagnostic(help("Give `max_tension_n` too, the greatest load that the bench can put on the cable."))]
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
    #[error("no run of {duration_s} s within these limits tells {what}")]
    #[diagnostic(help("Give it more time, or greater limits of speed, acceleration and force."))]
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
    #[error("the run would take {duration_s:.0} s, and more than {longest_s} s is not allowed")]
    #[diagnostic(help("Choose a smaller box, or greater limits of speed and acceleration."))]
    TooLong {
        /// Duration, s.
        duration_s: f64,
        /// Greatest allowed duration, s.
        longest_s: f64,
    },
    /// No workspace was found.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Workspace(#[from] SimulationError),
    /// A cable that cannot leave its last pulley.
    #[error("{cable} cannot leave its last pulley with the platform at {}", place(position_m))]
    #[diagnostic(help("Choose another box, or check `base_m`, `radius_m` and `axis`."))]
    Unreachable {
        /// The cable.
        cable: String,
        /// Position of the platform, m.
        position_m: [f64; 3],
    },
    /// No forces within the bounds hold the platform.
    #[error("no cable forces of {least_n:.3} N{} hold the platform at {} ({}, {time_s:.3} s): {}",
        greatest_n.map_or_else(|| " or more".to_owned(), |greatest_n| format!(" to {greatest_n:.3} N")),
        place(position_m),
        phase.name(),
        blame(worst.as_ref()))]
    #[diagnostic(help("{}", remedy(worst.is_some(), *holds_at_rest)))]
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
        "Check `base_m`, `platform_m` and `center_of_mass_m`, for fewer than six cables hold only a platform that hangs in one point."
    } else if holds_at_rest {
        "Choose a lower acceleration, a smaller box, or other bounds."
    } else {
        "It cannot even rest there, so choose a smaller or another box, or other bounds."
    }
}
