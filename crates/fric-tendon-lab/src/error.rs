//! Errors in the data of a manipulator.

use fric_lab::text::significant;
use fric_tendon::{ManipulatorError, ShapeStatus};
use miette::Diagnostic;
use thiserror::Error;

/// The reason why work on a manipulator's data was refused.
#[derive(Clone, Debug, PartialEq, Diagnostic, Error)]
#[non_exhaustive]
pub enum ContinuumError {
    /// A number of an option is not finite or out of range.
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
    /// The tension to simulate may break the tendon.
    #[error("`greatest_tension_n` is {greatest_tension_n} N, above the tendon's capacity of {capacity_n} N")]
    #[diagnostic(help("Pull less, or state another `capacity_n` in the manipulator file."))]
    TooGreatTension {
        /// The tension, N.
        greatest_tension_n: f64,
        /// Capacity of the tendon, N.
        capacity_n: f64,
    },
    /// The simulated manipulator has no equilibrium.
    #[error("the simulated manipulator finds no equilibrium at {time_s} s with {tension_base_n} N")]
    #[diagnostic(help("Check stiffness, weight and tip load."))]
    NoShape {
        /// Time, s.
        time_s: f64,
        /// Tension at the base, N.
        tension_base_n: f64,
    },
    /// The column is unknown here; the message names the nearest known one.
    #[error("{0}")]
    #[diagnostic(help("Correct its name, or take the column out."))]
    UnknownColumn(String),
    /// A required column is missing, by itself or from its group.
    #[error("column `{column}` is missing{}",
        beside.as_ref().map_or_else(String::new, |beside| format!(" beside `{beside}`")))]
    #[diagnostic(help("Add it, with empty cells where there is no value."))]
    MissingColumn {
        /// Its name.
        column: String,
        /// A column of its group that is present.
        beside: Option<String>,
    },
    /// Columns have different lengths.
    #[error("column `{column}` has {count} values, the first column {needed}")]
    #[diagnostic(help("Make them equally long."))]
    UnequalColumns {
        /// Its name.
        column: String,
        /// Its length.
        count: usize,
        /// Length of the first column.
        needed: usize,
    },
    /// A cell is not a number where one is required.
    #[error("`{column}` is {value} in row {row}, which is no finite number")]
    #[diagnostic(help("Mend the row or take it out."))]
    NotFinite {
        /// Its column.
        column: String,
        /// The row below the header, from 1.
        row: usize,
        /// Its content.
        value: f64,
    },
    /// An angle exceeds half a turn.
    #[error("`{column}` is {value} in row {row}; angles to the normal force are within ±π")]
    #[diagnostic(help("State it in rad; it is likely in degrees."))]
    NoAngle {
        /// Its column.
        column: String,
        /// The row below the header, from 1.
        row: usize,
        /// Its content.
        value: f64,
    },
    /// A time is not valid.
    #[error("`time_s` of sample {row} is {time_s}")]
    #[diagnostic(help("Give every sample its time in seconds, or take it out."))]
    NoTime {
        /// The sample, from 1.
        row: usize,
        /// Its content, s.
        time_s: f64,
    },
    /// The time does not increase.
    #[error("time goes from {before_s} s to {time_s} s at sample {row}")]
    #[diagnostic(help("Sort the run by `time_s` and take out repeated samples."))]
    TimeNotRising {
        /// The sample, from 1.
        row: usize,
        /// Its time, s.
        time_s: f64,
        /// Time of the sample before, s.
        before_s: f64,
    },
    /// A tension is not valid.
    #[error("`tension_base_n` is {tension_n} at {time_s} s (sample {row}); it must be finite and not negative")]
    #[diagnostic(help("Take the sample out or mend it."))]
    NoTension {
        /// The sample, from 1.
        row: usize,
        /// Its content, N.
        tension_n: f64,
        /// Time, s.
        time_s: f64,
    },
    /// A path has no goals.
    #[error("the path has neither `bend_rad` nor `tip_x_m` and `tip_y_m`")]
    #[diagnostic(help("Add one of the two."))]
    NoGoals,
    /// A path has goals of two kinds.
    #[error("the path has both `bend_rad` and `tip_x_m`; a goal is a bend or a position of the tip")]
    #[diagnostic(help("Take one of them out."))]
    TwoKindsOfGoals,
    /// A single pull of the simulated manipulator does not come to a bend.
    #[error(
        "the simulated manipulator has no bend of {bend_rad:.4} rad (goal {row}): a pull takes it from {least_rad:.4} to {greatest_rad:.4} rad"
    )]
    #[diagnostic(help("Take the goal out of the path."))]
    NotPulledTo {
        /// The goal, from 1.
        row: usize,
        /// The bend, rad.
        bend_rad: f64,
        /// Bend before the pull, rad.
        least_rad: f64,
        /// Bend at the end of the pull, rad.
        greatest_rad: f64,
    },
    /// The model has no shapes for the runs.
    #[error("the model finds no shape for the runs, so that nothing can be identified")]
    #[diagnostic(help("Check stiffness, weight and tension against the manipulator file."))]
    NotIdentified,
    /// A tension at which the tendon may break.
    #[error(
        "`tension_base_n` is {tension_n} N at {time_s} s (sample {row}), above the tendon's capacity of {capacity_n} N"
    )]
    #[diagnostic(help("Check the unit of the column, or `capacity_n` in the manipulator file."))]
    OverCapacity {
        /// The sample, from 1.
        row: usize,
        /// Time, s.
        time_s: f64,
        /// The tension, N.
        tension_n: f64,
        /// Capacity of the tendon, N.
        capacity_n: f64,
    },
    /// A bend for which no friction model has a shape.
    #[error(
        "the bend at {time_s} s (sample {row}, {tension_n} N) is beyond the model by every way of friction ({status})"
    )]
    #[diagnostic(help("Check the tension, and stiffness and weight in the manipulator file."))]
    BeyondModel {
        /// The sample, from 1.
        row: usize,
        /// Time, s.
        time_s: f64,
        /// Tension at the base, N.
        tension_n: f64,
        /// The status of the model.
        status: ShapeStatus,
    },
    /// A required group of columns is missing.
    #[error("the run has no {what}: {consequence}")]
    #[diagnostic(help("Record {remedy}."))]
    MissingGroup {
        /// The group.
        what: &'static str,
        /// What is impossible without it.
        consequence: &'static str,
        /// What to record.
        remedy: &'static str,
    },
    /// A time is outside the run.
    #[error("{time_s} s is not within the run, {from_s} … {to_s} s")]
    #[diagnostic(help("Name another time."))]
    NotWithinRun {
        /// The time, s.
        time_s: f64,
        /// Start of the run, s.
        from_s: f64,
        /// End of the run, s.
        to_s: f64,
    },
    /// The run has too few samples.
    #[error("the run has {count} samples, {needed} are needed to hold some out")]
    #[diagnostic(help("Record a longer one."))]
    TooShort {
        /// Number of samples.
        count: usize,
        /// Required number.
        needed: usize,
    },
    /// The gratings have hardly any consecutive samples.
    #[error("so many samples of the gratings are missing that nothing tells their noise")]
    #[diagnostic(help("Record a run with fewer gaps."))]
    UntoldNoise,
    /// The file has no gratings that convert shifts to tensions.
    #[error("the manipulator file has no `[gratings]`, without which shifts are no tensions")]
    #[diagnostic(help("Write them with a calibration."))]
    NoGratings,
    /// The manipulator's parameters are invalid.
    #[error("{0}")]
    #[diagnostic(help("Correct the manipulator file."))]
    Params(#[from] ManipulatorError),
    /// Shifts that no fibre survives.
    #[error(
        "`{column}` goes up to {greatest_nm} nm, which would strain the fibre by {strain_percent:.0} %: it is likely in pm, or the wavelength itself"
    )]
    #[diagnostic(help("State the shift from the wavelength without load, in nm."))]
    ShiftUnit {
        /// The column.
        column: String,
        /// Greatest magnitude of most of its values, nm.
        greatest_nm: f64,
        /// Corresponding strain of a silica fibre at common wavelengths, %.
        strain_percent: f64,
    },
    /// Markers that are much farther away than the arm is long.
    #[error(
        "the markers are {distance_m:.3} m from the origin of their frame, and the arm is {length_m} m long: they are likely in mm"
    )]
    #[diagnostic(help("State `marker_1_x_m` and so on in m."))]
    MarkerUnit {
        /// Median distance, m.
        distance_m: f64,
        /// Length of the backbone, m.
        length_m: f64,
    },
    /// A calibration load exceeds the tendon's capacity.
    #[error("`load_n` goes up to {greatest_n} N, above the tendon's capacity of {capacity_n} N: it is likely in g")]
    #[diagnostic(help("Name the column `load_g`, or state another `capacity_n` in the manipulator file."))]
    LoadUnit {
        /// The greatest load, N.
        greatest_n: f64,
        /// Capacity of the tendon, N.
        capacity_n: f64,
    },
    /// The tensions of the gratings differ from the tension at the base by orders of magnitude.
    #[error("by `shift_1_nm` and so on the tension is {} times `tension_base_n`: {}",
        significant(*ratio), unit_by(*ratio))]
    #[diagnostic(help("State shifts in nm and forces in N, and calibrate again."))]
    GratingUnit {
        /// Ratio of the gratings' tension to the tension at the base.
        ratio: f64,
    },
    /// Every grating is dead.
    #[error("no grating follows the tension in any sample")]
    #[diagnostic(help("Check the demodulator and the columns."))]
    AllDead,
    /// A list has the wrong length.
    #[error("there are {count} {what}; {needed} are needed")]
    WrongCount {
        /// The content of the list.
        what: &'static str,
        /// Its length.
        count: usize,
        /// Required length.
        needed: usize,
    },
    /// Too few load steps for a line, or all equal.
    #[error("{count} load steps with different shifts are too few for grating {grating}; {needed} are needed")]
    TooFewLoads {
        /// The grating, from 1.
        grating: usize,
        /// Number of load steps.
        count: usize,
        /// Required number.
        needed: usize,
    },
    /// The shift of a grating does not grow with the load.
    #[error("grating {grating} does not answer to the load")]
    #[diagnostic(help("Check whether it is broken, or the columns are exchanged."))]
    DeadGrating {
        /// The grating, from 1.
        grating: usize,
    },
    /// A grating would move into a disk, \[C\] 6.
    #[error(
        "grating {grating} leaves its segment: it moves {travel_mm:.1} mm towards the base and has {room_mm:.1} mm"
    )]
    #[diagnostic(help("Put it nearer to the tip side of the segment, or bend less."))]
    TravelTooLong {
        /// The grating, from 1.
        grating: usize,
        /// Its travel, mm.
        travel_mm: f64,
        /// Available travel, mm.
        room_mm: f64,
    },
    /// The loads do not determine a coefficient.
    #[error("the friction coefficient cannot be fitted: {0}")]
    NoCoefficient(&'static str),
}

/// Returns which unit is likely wrong if the gratings show this multiple of the tension at the base.
fn unit_by(ratio: f64) -> &'static str {
    match ratio {
        300.0..3000.0 => "they are likely in pm",
        6.0..30.0 => "`tension_base_n` is likely in kg",
        30.0..300.0 => "the loads that they were calibrated with were likely in g under the name `load_n`",
        0.03..0.2 => "the loads that they were calibrated with were likely in kg under the name `load_n`",
        0.003..0.03 => "`tension_base_n` is likely in g, or the calibration's `load_g` was in N",
        0.0003..0.003 => "they were likely calibrated in pm",
        _ => "one of them is in another unit",
    }
}
