//! The command line of `continuum`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::{ResultArguments, a_file, a_number, a_seed};

#[derive(Debug, Subcommand)]
pub enum ContinuumCommand {
    /// Calibrate the gratings with load steps, and write their coefficients into the manipulator file
    #[command(
        after_help = "The load steps are CSV or MCAP with the columns load_g (mass on the hook) or load_n, shift_1_nm …, and \
                      shift_reference_nm where a grating without load takes the temperature off.\n\n\
                      Example:\n  fric-cli continuum calibrate loads.csv --model examples/tendon-prototype.toml -o calibrated.toml"
    )]
    Calibrate(CalibrateArguments),
    /// Identify stiffness, geometry, loads and friction from runs with markers or gratings, and write them into the manipulator file
    #[command(
        after_help = "Any two of tension at the base, gratings and markers will do; runs are CSV or MCAP, and several belong to the same \
                      manipulator. What they cannot tell stays as the file states it and is reported.\n\n\
                      Examples:\n  fric-cli continuum fit pull.csv --model calibrated.toml -o fitted.toml\n  \
                      fric-cli continuum fit pull.csv mixed.csv --model calibrated.toml --parameters backbone_stiffness,hole_mu -o fitted.toml"
    )]
    Fit(TendonFitArguments),
    /// Show the friction at every hole over a run, from the gratings
    #[command(
        after_help = "Example:\n  fric-cli continuum friction pull.csv --model calibrated.toml --report friction.html"
    )]
    Friction(FrictionArguments),
    /// Find the friction coefficient of a single hole from a load run
    #[command(
        after_help = "The loads are CSV with the columns tension_1_n, tension_2_n (on both sides of the hole) and angle_1_rad, \
                      angle_2_rad (between them and the normal force).\n\nExample:\n  fric-cli continuum hole hole.csv"
    )]
    Hole(HoleArguments),
    /// Compute the shapes of a run by four ways of friction, and compare them with the markers
    #[command(
        after_help = "Examples:\n  fric-cli continuum shape pull.csv --model calibrated.toml --report shapes.html\n  \
                      fric-cli continuum shape mixed.csv --model calibrated.toml --mixed --shapes 4"
    )]
    Shape(ShapeArguments),
    /// Write the run of a simulated manipulator, whose truth is not the model
    #[command(
        after_help = "Examples:\n  fric-cli continuum simulate --model examples/tendon-prototype.toml -o pull.csv \
                      --calibration loads.csv\n  fric-cli continuum simulate --model examples/tendon-prototype.toml -o mixed.mcap \
                      --run mixed --seed 7"
    )]
    Simulate(TendonSimulateArguments),
    /// Find the tensions at the base that follow a path of bends or tip positions
    #[command(
        after_help = "The path is CSV or MCAP with the columns bend_rad, or tip_x_m and tip_y_m, and optionally time_s. Each command starts \
                      from what the holes remember of the commands before it. Tensions are those that the sensor at the base shows, and \
                      positions are in the frame of the markers, if the manipulator file states [base_sensor] and [markers].\n\n\
                      Examples:\n  fric-cli continuum track path.csv --model calibrated.toml -o tensions.csv\n  \
                      fric-cli continuum track path.csv --model calibrated.toml --simulate"
    )]
    Track(TrackArguments),
}

/// A run and its manipulator.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// CSV, or MCAP with a message for each sample: `time_s`, `tension_base_n`, `shift_1_nm` …, `marker_1_x_m`, `marker_1_y_m` …
    #[arg(required = true, value_name = "RUN")]
    pub run: PathBuf,
    /// Manipulator file
    #[arg(long, value_name = "M.toml", required = true)]
    pub model: PathBuf,
}

/// A page.
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// Write a page with figures to this HTML file
    #[arg(long, value_name = "R.html", value_parser = a_file())]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub result: ResultArguments,
}

#[derive(Debug, Args)]
pub struct CalibrateArguments {
    /// CSV or MCAP: `load_g` or `load_n`, `shift_1_nm` …
    #[arg(required = true, value_name = "LOADS")]
    pub loads: PathBuf,
    /// Manipulator file
    #[arg(long, value_name = "M.toml", required = true)]
    pub model: PathBuf,
    /// Write the manipulator file with the coefficients to this file
    #[arg(short, long, value_name = "CALIBRATED.toml", required = true, value_parser = a_file())]
    pub output: PathBuf,
    #[command(flatten)]
    pub page: ReportArguments,
}

#[derive(Debug, Args)]
pub struct TendonFitArguments {
    /// CSV, or MCAP with a message for each sample; several are runs of the same manipulator, each from a relaxed tendon on
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// Manipulator file: where the search begins
    #[arg(long, value_name = "M.toml", required = true)]
    pub model: PathBuf,
    /// Write the manipulator file with the identified values to this file
    #[arg(short, long, value_name = "FITTED.toml", required = true, value_parser = a_file())]
    pub output: PathBuf,
    /// Identify these only: `backbone_stiffness`, `segment_stiffness`, `pitch`, `tendon_offset`, `precurvature`, `marker_frame`,
    /// `tip_load`, `gravity_direction`, `mu`, `hole_mu`, `sigma`, `base_gain`, `base_offset`, `tension_lag`, `calibration` [default: all but those of
    /// segments, single holes, the sensor at the base and the gratings]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub parameters: Option<Vec<String>>,
    #[command(flatten)]
    pub result: ResultArguments,
}

#[derive(Debug, Args)]
pub struct FrictionArguments {
    #[command(flatten)]
    pub run: RunArguments,
    #[command(flatten)]
    pub page: ReportArguments,
}

#[derive(Debug, Args)]
pub struct HoleArguments {
    /// CSV: `tension_1_n`, `tension_2_n`, `angle_1_rad`, `angle_2_rad`
    #[arg(required = true, value_name = "LOADS")]
    pub loads: PathBuf,
    #[command(flatten)]
    pub result: ResultArguments,
}

#[derive(Debug, Args)]
pub struct ShapeArguments {
    #[command(flatten)]
    pub run: RunArguments,
    /// How many shapes to show, spread over the run
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..=100))]
    pub shapes: u16,
    /// Show the shapes at these times instead, s
    #[arg(long, value_name = "TIMES", value_delimiter = ',', conflicts_with_all = ["shapes", "mixed"], value_parser = a_number)]
    pub at_s: Option<Vec<f64>>,
    /// Take them from the samples in which the gratings show friction of both directions
    #[arg(long)]
    pub mixed: bool,
    /// Compute by these ways of friction only
    #[arg(long, value_name = "WAYS", value_enum, value_delimiter = ',', default_values_t = WayName::ALL, hide_default_value = true)]
    pub ways: Vec<WayName>,
    /// Show also the greatest distances
    #[arg(long)]
    pub wide: bool,
    #[command(flatten)]
    pub page: ReportArguments,
}

#[derive(Debug, Args)]
pub struct TendonSimulateArguments {
    /// Manipulator file; its friction is the truth, but for the spread
    #[arg(long, value_name = "M.toml", required = true)]
    pub model: PathBuf,
    /// The run to write: CSV, or MCAP by its ending
    #[arg(short, long, value_name = "RUN", required = true, value_parser = a_file())]
    pub output: PathBuf,
    /// Write load steps on the same gratings to this CSV file, 20…200 g
    #[arg(long, value_name = "LOADS.csv", value_parser = a_file())]
    pub calibration: Option<PathBuf>,
    /// Write what was really there to this JSON file
    #[arg(long, value_name = "TRUTH.json", value_parser = a_file())]
    pub truth: Option<PathBuf>,
    /// What is done with the tendon
    #[arg(long, value_name = "RUN", value_enum, default_value_t)]
    pub run: ExperimentName,
    /// Greatest tension at the base, N
    #[arg(long, value_name = "N", default_value_t = 1.7, allow_negative_numbers = true, value_parser = a_number)]
    pub greatest_tension_n: f64,
    /// Seed of noise, gratings and spread
    #[arg(long, value_name = "S", default_value_t = 0, allow_negative_numbers = true, value_parser = a_seed)]
    pub seed: u64,
    /// How far each hole's μ is from the stated one at most, as a share of it
    #[arg(long, value_name = "RATIO", default_value_t = 0.1, allow_negative_numbers = true, value_parser = a_number)]
    pub mu_spread_ratio: f64,
    /// Standard deviation of the noise of each grating, nm
    #[arg(long, value_name = "NM", default_value_t = 0.0005, allow_negative_numbers = true, value_parser = a_number)]
    pub grating_noise_nm: f64,
    /// Standard deviation of the noise of each coordinate of a marker, m
    #[arg(long, value_name = "M", default_value_t = 0.00025, allow_negative_numbers = true, value_parser = a_number)]
    pub marker_noise_m: f64,
    /// Replace outputs that exist
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct TrackArguments {
    /// CSV or MCAP: `bend_rad`, or `tip_x_m` and `tip_y_m`; `time_s` if there is one
    #[arg(required = true, value_name = "PATH")]
    pub path: PathBuf,
    /// Manipulator file
    #[arg(long, value_name = "M.toml", required = true)]
    pub model: PathBuf,
    /// Write the tensions, with prediction and flags, to this file: CSV, or MCAP by its ending
    #[arg(short, long, value_name = "TENSIONS", value_parser = a_file())]
    pub output: Option<PathBuf>,
    /// Friction that the commands allow for
    #[arg(long, value_name = "WAY", value_enum, default_value_t)]
    pub friction: CompensationName,
    /// Start with the holes as this run leaves them, instead of the relaxed tendon: CSV or MCAP with `time_s` and `tension_base_n`
    #[arg(long, value_name = "RUN", conflicts_with = "simulate")]
    pub after: Option<PathBuf>,
    /// Tension that a tendon keeps while the other one is pulled, N: of the first, or `FIRST,SECOND`
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "0", allow_negative_numbers = true, value_parser = a_number)]
    pub least_tension_n: Vec<f64>,
    /// Greatest tension, N: of the first tendon, or `FIRST,SECOND` [default: the capacity of the first; the second is not pulled]
    #[arg(long, value_name = "N", value_delimiter = ',', allow_negative_numbers = true, value_parser = a_number)]
    pub greatest_tension_n: Option<Vec<f64>>,
    /// Keep the tensions for a goal nearer than this, rad (tip: relative to the length)
    #[arg(long, value_name = "RAD", default_value_t = 0.0, allow_negative_numbers = true, value_parser = a_number)]
    pub hold_rad: f64,
    /// Follow the path on a simulated manipulator too, and show how far its tip is from the goals with each friction model
    #[arg(long, conflicts_with_all = ["least_tension_n", "greatest_tension_n", "hold_rad"])]
    pub simulate: bool,
    /// Seed of the simulated manipulator
    #[arg(long, value_name = "S", default_value_t = 0, allow_negative_numbers = true, value_parser = a_seed, requires = "simulate")]
    pub seed: u64,
    /// How far each simulated hole's μ is from the stated one at most, as a share of it
    #[arg(long, value_name = "RATIO", default_value_t = 0.1, allow_negative_numbers = true, value_parser = a_number, requires = "simulate")]
    pub mu_spread_ratio: f64,
    #[command(flatten)]
    pub result: ResultArguments,
}

/// The friction that commands allow for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum CompensationName {
    /// No friction
    None,
    /// All holes slide in the direction of each change
    Coulomb,
    /// What the holes remember
    #[default]
    History,
}

/// The ways of friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WayName {
    /// No friction
    None,
    /// All holes slide one way
    Coulomb,
    /// By the gratings
    Measured,
    /// By the run of the tension at the base
    History,
}

impl WayName {
    const ALL: [Self; 4] = [Self::None, Self::Coulomb, Self::Measured, Self::History];
}

/// The runs of a simulated manipulator.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ExperimentName {
    /// The tendon is pulled: friction has one direction
    #[default]
    OneWay,
    /// It is pulled and released by turns: directions differ along it
    Mixed,
}
