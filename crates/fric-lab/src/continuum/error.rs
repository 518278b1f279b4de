//! What can be wrong with the data of a manipulator.

use thiserror::Error;

/// Why work on a manipulator's data was refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ContinuumError {
    /// A number of an option is not finite or out of range.
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
    /// The simulated manipulator has no equilibrium.
    #[error(
        "the simulated manipulator finds no equilibrium at {time_s} s with {tension_base_n} N; check stiffness, weight and tip \
         load"
    )]
    NoShape {
        /// When.
        time_s: f64,
        /// Tension at the base, N.
        tension_base_n: f64,
    },
    /// Time stands still or goes back.
    #[error("time goes from {before_s} s to {time_s} s; sort the run and take out repeated samples")]
    TimeNotRising {
        /// The time in question, s.
        time_s: f64,
        /// The one before, s.
        before_s: f64,
    },
    /// A number that cannot be.
    #[error("`{what}` is {value} at {time_s} s; it must be finite and not negative")]
    NotFinite {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
        /// When, s.
        time_s: f64,
    },
    /// A list of the wrong length.
    #[error("there are {count} {what}; {needed} are needed")]
    WrongCount {
        /// Of what.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Too few load steps for a line, or all the same.
    #[error("{count} load steps with different shifts are too few for grating {grating}; {needed} are needed")]
    TooFewLoads {
        /// The grating, from 1.
        grating: usize,
        /// How many there are.
        count: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A grating that shows no more shift under more load.
    #[error("grating {grating} does not answer to the load; it may be broken, or the columns exchanged")]
    DeadGrating {
        /// The grating, from 1.
        grating: usize,
    },
    /// A grating would run into a disk, \[C\] 6.
    #[error(
        "grating {grating} leaves its segment: it moves {travel_mm:.1} mm towards the base and has {room_mm:.1} mm; put it \
         nearer to the tip side of the segment, or bend less"
    )]
    TravelTooLong {
        /// The grating, from 1.
        grating: usize,
        /// How far it moves, mm.
        travel_mm: f64,
        /// How far it can, mm.
        room_mm: f64,
    },
    /// Nothing to fit a coefficient to.
    #[error("the friction coefficient cannot be fitted: {0}")]
    NoCoefficient(&'static str),
}
