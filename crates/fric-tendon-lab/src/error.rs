//! What can be wrong with the data of a manipulator.

use fric_tendon::{ManipulatorError, ShapeStatus};
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
    /// A tension to simulate at which the tendon may break.
    #[error(
        "`greatest_tension_n` is {greatest_tension_n} N, above the tendon's capacity of {capacity_n} N; pull less, or state \
         another `capacity_n` in the manipulator file"
    )]
    TooGreatTension {
        /// The tension, N.
        greatest_tension_n: f64,
        /// What the tendon can bear, N.
        capacity_n: f64,
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
    /// A column that means nothing here; with the nearest that does.
    #[error("{0}")]
    UnknownColumn(String),
    /// A column that is needed, by itself or beside others of its group.
    #[error(
        "column `{column}` is missing{}; add it, with empty cells where there is no value",
        beside.as_ref().map_or_else(String::new, |beside| format!(" beside `{beside}`"))
    )]
    MissingColumn {
        /// Its name.
        column: String,
        /// One of its group that is there.
        beside: Option<String>,
    },
    /// Columns of different length.
    #[error("column `{column}` has {count} values, the first column {needed}; make them equally long")]
    UnequalColumns {
        /// Its name.
        column: String,
        /// How many it has.
        count: usize,
        /// How many the first has.
        needed: usize,
    },
    /// A cell that is no number where one is needed.
    #[error("`{column}` is {value} in row {row}; it must be a finite number, mend the row or take it out")]
    NotFinite {
        /// Its column.
        column: String,
        /// The row below the header, from 1.
        row: usize,
        /// What stands there.
        value: f64,
    },
    /// An angle beyond half a turn.
    #[error("`{column}` is {value} in row {row}; angles to the normal force are in rad, within ±π")]
    NoAngle {
        /// Its column.
        column: String,
        /// The row below the header, from 1.
        row: usize,
        /// What stands there.
        value: f64,
    },
    /// A time that is none.
    #[error("`time_s` of sample {row} is {time_s}; give every sample its time in seconds, or take it out")]
    NoTime {
        /// The sample, from 1.
        row: usize,
        /// What stands there, s.
        time_s: f64,
    },
    /// Time stands still or goes back.
    #[error(
        "time goes from {before_s} s to {time_s} s at sample {row}; sort the run by `time_s` and take out repeated samples"
    )]
    TimeNotRising {
        /// The sample in question, from 1.
        row: usize,
        /// Its time, s.
        time_s: f64,
        /// The one before, s.
        before_s: f64,
    },
    /// A tension that cannot be.
    #[error(
        "`tension_base_n` is {tension_n} at {time_s} s (sample {row}); it must be finite and not negative, take the sample out or mend it"
    )]
    NoTension {
        /// The sample, from 1.
        row: usize,
        /// What stands there, N.
        tension_n: f64,
        /// When, s.
        time_s: f64,
    },
    /// The model has no shapes for the runs.
    #[error(
        "the model finds no shape for the runs, so that nothing can be identified; check stiffness, weight and tension against the manipulator file"
    )]
    NotIdentified,
    /// A tension at which the tendon may break.
    #[error(
        "`tension_base_n` is {tension_n} N at {time_s} s (sample {row}), above the tendon's capacity of {capacity_n} N; check the \
         unit of the column, or `capacity_n` in the manipulator file"
    )]
    OverCapacity {
        /// The sample, from 1.
        row: usize,
        /// When, s.
        time_s: f64,
        /// The tension, N.
        tension_n: f64,
        /// What the tendon bears, N.
        capacity_n: f64,
    },
    /// A bend for which no way of friction has a shape.
    #[error(
        "the bend at {time_s} s (sample {row}, {tension_n} N) is beyond the model by every way of friction ({status}); check \
         the tension, and stiffness and weight in the manipulator file"
    )]
    BeyondModel {
        /// The sample, from 1.
        row: usize,
        /// When, s.
        time_s: f64,
        /// Tension at the base, N.
        tension_n: f64,
        /// What the model says.
        status: ShapeStatus,
    },
    /// A group of columns that the work needs.
    #[error("the run has no {what}: {consequence}; record {remedy}")]
    MissingGroup {
        /// Which.
        what: &'static str,
        /// What is impossible.
        consequence: &'static str,
        /// What to record.
        remedy: &'static str,
    },
    /// A time that the run does not have.
    #[error("{time_s} s is not within the run, {from_s} … {to_s} s; name another time")]
    NotWithinRun {
        /// The time, s.
        time_s: f64,
        /// Where the run begins, s.
        from_s: f64,
        /// Where it ends, s.
        to_s: f64,
    },
    /// A run with too little in it.
    #[error("the run has {count} samples, {needed} are needed to hold some out; record a longer one")]
    TooShort {
        /// How many there are.
        count: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Gratings of which hardly any samples follow one another.
    #[error("so many samples of the gratings are missing that nothing tells their noise; record a run with fewer gaps")]
    UntoldNoise,
    /// Shifts that nothing turns into tensions.
    #[error(
        "the manipulator file has no `[gratings]`, without which shifts are no tensions; write them with a calibration"
    )]
    NoGratings,
    /// The manipulator is refused.
    #[error("{0}; correct the manipulator file")]
    Params(#[from] ManipulatorError),
    /// Shifts that no fibre survives.
    #[error(
        "`{column}` goes up to {greatest_nm} nm, which would strain the fibre by {strain_percent:.0} %: it is likely in pm, or the \
         wavelength itself; state the shift from the wavelength without load, in nm"
    )]
    ShiftUnit {
        /// The column.
        column: String,
        /// The greatest of most of its values, nm.
        greatest_nm: f64,
        /// Strain of a silica fibre at usual wavelengths, %.
        strain_percent: f64,
    },
    /// A calibration load that the tendon cannot bear.
    #[error(
        "`load_n` goes up to {greatest_n} N, above the tendon's capacity of {capacity_n} N: it is likely in g; name the column \
         `load_g`, or state another `capacity_n` in the manipulator file"
    )]
    LoadUnit {
        /// The greatest load, N.
        greatest_n: f64,
        /// What the tendon can bear, N.
        capacity_n: f64,
    },
    /// Gratings that show another order of magnitude than the tension at the base.
    #[error(
        "by `shift_1_nm` and so on the tension is {ratio:.2e} times `tension_base_n`: {}; state shifts in nm and forces in N, and \
         calibrate again",
        unit_by(*ratio)
    )]
    GratingUnit {
        /// Tension by the gratings per tension at the base.
        ratio: f64,
    },
    /// Every grating is dead.
    #[error("no grating follows the tension in any sample; check the demodulator and the columns")]
    AllDead,
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

/// Which unit is likely wrong where the gratings show so many times the tension at the base.
fn unit_by(ratio: f64) -> &'static str {
    match ratio {
        300.0..3000.0 => "they are likely in pm",
        30.0..300.0 => "the loads that they were calibrated with were likely in g under the name `load_n`",
        0.003..0.03 => "`tension_base_n` is likely in g, or the calibration's `load_g` was in N",
        0.0003..0.003 => "they were likely calibrated in pm",
        _ => "one of them is in another unit",
    }
}
