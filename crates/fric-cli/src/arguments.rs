//! The command line.

pub mod continuum;
pub mod terminal;

use std::path::PathBuf;

use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use fric_core::effects::Effect;
use fric_lab::fit::{LogZero, Reference, zero_per_log};
use fric_lab::simulate::DISTURBANCES;
use fric_log::signals::Part;
use fric_work::recording_name;

use crate::failure::{Failure, Outcome};

/// Friction compensation for cable-driven robots: identify friction, find what the model lacks, replay logs, look into
/// them, simulate and excite robots; tendons of continuum manipulators.
#[derive(Debug, Parser)]
#[command(version, arg_required_else_help = true)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub terminal: terminal::TerminalArguments,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run the compensator over a log as the control loop would, and show the error before and after
    #[command(after_help = "Example:\n  fric-cli replay examples/mini-ipanema.mcap -o compensated.mcap")]
    Replay(ReplayArguments),
    /// Identify the friction parameters from the log of an identification run
    ///
    /// Samples beyond 64 MB go to a temporary file of 72 bytes a sample and cable, in the folder TMPDIR or else the system's; then no more cables are
    /// worked on at once than memory allows. With `--reference wrench` all samples are kept in memory: some 200 bytes a sample and cable.
    #[command(after_help = "Examples:\n  fric-cli fit examples/mini-ipanema.mcap -o fitted.toml\n  \
                      fric-cli fit examples/mini-ipanema.mcap --reference wrench -o by-wrench.toml")]
    Fit(FitArguments),
    /// Find where the model and the measurement disagree, name the effect that is missing, and add it to the robot file
    ///
    /// Samples beyond 64 MB go to a temporary file, as in `fit`.
    #[command(after_help = "Examples:\n  fric-cli discover examples/mini-ipanema.mcap\n  \
                      fric-cli discover examples/mini-ipanema.mcap -o extended.toml --report discovery.html")]
    Discover(DiscoverArguments),
    /// Show what is in a log, what each signal maps to, and what is missing for which step
    #[command(after_help = "Example:\n  fric-cli info examples/mini-ipanema.mcap")]
    Info(InfoArguments),
    /// Write any log that can be read as MCAP, its signals on the topics that are looked for by default
    ///
    /// Samples are joined on the time of the cable signal. The robot file is attached, so that no other command needs --model.
    #[command(
        after_help = "Example:\n  fric-cli convert examples/mini-ipanema.mcap -o converted.mcap --start 1 --end 3"
    )]
    Convert(ConvertArguments),
    /// Write a robot file to start from, with every signal of a log that can be guessed
    ///
    /// What could not be guessed is a comment that begins with `# ?`.
    #[command(after_help = "Example:\n  fric-cli init examples/mini-ipanema.mcap -o draft.toml")]
    Init(InitArguments),
    /// Write the log of a simulated robot, with effects hidden in it on request
    #[command(after_help = "Examples:\n  fric-cli simulate --model examples/mini-ipanema.toml -o simulated.mcap \
                      --effect stribeck:ratio=0.5,velocity_m_per_s=0.02 --seed 7\n  \
                      fric-cli simulate --model examples/mini-ipanema.toml -o spoilt.mcap \
                      --disturbance hum:amplitude_n=0.12,frequency_hz=50 --hand-n 3 --reference-wander-n 0.01\n  \
                      fric-cli simulate --model examples/mini-ipanema.toml --run crossing -o crossing.mcap")]
    Simulate(SimulateArguments),
    /// Write the identification run, or a run designed for a question, as set points for a robot's controller
    ///
    /// With --for, --separate or --determine the run is put together so that its log answers the question, and what evidence to expect is said;
    /// where no run within the limits can tell, there is none. On a test bench --max-tension-n lets the run state the load of the cables too.
    #[command(
        after_help = "Examples:\n  fric-cli excite --model examples/mini-ipanema.toml -o tell.csv --determine mu,sigma_n_per_m \
                      --cables cable1 --duration 10\n  fric-cli excite --model examples/mini-ipanema.toml -o run.csv --preview run.html\n  \
                      fric-cli excite --model examples/mini-ipanema.toml -o gentle.csv --box=-0.1,-0.1,-0.1,0.1,0.1,0.1 \
                      --max-speed-m-per-s 0.5 --max-acceleration-m-per-s2 5 --min-tension-n 2 --max-tension-n 30"
    )]
    Excite(ExciteArguments),
    /// Show how much the wrench depends on the side from which a position is reached, with and without compensation
    ///
    /// The platform has to cross a position to and fro along an axis; `simulate --run crossing` makes such a log.
    #[command(after_help = "Example:\n  fric-cli hysteresis crossing.mcap")]
    Hysteresis(HysteresisArguments),
    /// Tendons through disks: calibrate gratings, measure friction, compute shapes of a continuum manipulator; `discover` finds what its model lacks
    #[command(
        subcommand,
        after_help = "Examples:\n  fric-cli continuum simulate --model examples/tendon-prototype.toml -o pull.csv --calibration \
                      loads.csv\n  fric-cli continuum calibrate loads.csv --model examples/tendon-prototype.toml -o \
                      calibrated.toml\n  fric-cli continuum friction pull.csv --model calibrated.toml\n  fric-cli continuum shape \
                      pull.csv --model calibrated.toml --report shapes.html"
    )]
    Continuum(continuum::ContinuumCommand),
    /// Print the completions of a shell, so that its Tab key knows commands, options and their values
    #[command(after_help = "bash:  fric-cli completions bash > ~/.local/share/bash-completion/completions/fric-cli\n\
                      zsh:   fric-cli completions zsh > \"${fpath[1]}/_fric-cli\"\n\
                      fish:  fric-cli completions fish > ~/.config/fish/completions/fric-cli.fish\n\n\
                      Example:\n  fric-cli completions bash")]
    Completions(CompletionsArguments),
    /// Write the manual pages, one for each command, into a directory
    #[command(after_help = "`man` finds those in ~/.local/share/man/man1 by name, as in `man fric-cli-replay`.\n\n\
                      Example:\n  fric-cli man man1")]
    Man(ManArguments),
}

#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct ManArguments {
    /// The directory, made if it is missing
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
    /// Replace pages that exist
    #[arg(long)]
    pub force: bool,
}

/// The log and its robot.
#[derive(Debug, Args)]
pub struct LogArguments {
    /// Log (MCAP, CSV, rosbag2); several files are the parts of one split recording
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Robot file; without it the one attached to the log
    #[arg(long, value_name = "M.toml")]
    pub model: Option<PathBuf>,
    #[command(flatten)]
    pub part: PartArguments,
}

/// Which part of the log.
#[derive(Clone, Copy, Debug, Args)]
pub struct PartArguments {
    /// Leave out what is less than so many seconds after the first sample
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = a_time)]
    start: Option<f64>,
    /// Leave out what is so many seconds after the first sample, or more
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = a_time)]
    end: Option<f64>,
}

impl PartArguments {
    /// The part, which has a beginning before its end.
    pub fn part(self) -> Outcome<Part> {
        let Self { start: start_s, end: end_s } = self;
        match start_s.zip(end_s) {
            Some((start_s, end_s)) if start_s >= end_s => {
                Err(Failure::usage(format!("--start {start_s} is not before --end {end_s}")))
            }
            _ => Ok(Part { start_s, end_s }),
        }
    }

    /// Makes sure that none is given where there is no log of a robot.
    pub fn check_none(self) -> Outcome {
        if self.start.is_none() && self.end.is_none() {
            return Ok(());
        }
        Err(Failure::usage("--start and --end are for the logs of robots, not for the run of a manipulator"))
    }
}

#[derive(Debug, Args)]
pub struct ReplayArguments {
    #[command(flatten)]
    pub log: LogArguments,
    /// Write forces, friction, wrench and status to this MCAP file
    #[arg(short, long, value_name = "OUT.mcap", value_parser = a_recording())]
    pub output: Option<PathBuf>,
    /// Write a page with the errors over time to this HTML file
    #[arg(long, value_name = "R.html", value_parser = a_file())]
    pub report: Option<PathBuf>,
    /// Correct the recording before it is compared, and tell what was wrong: a reference that comes late or runs by another clock, noise of the
    /// lengths; reads the log twice and keeps its samples, as `fit` does
    #[arg(long)]
    pub correct: bool,
    /// Show also the mean of the error's magnitude and the number of samples
    #[arg(long)]
    pub wide: bool,
    #[command(flatten)]
    pub result: ResultArguments,
}

#[derive(Debug, Args)]
pub struct FitArguments {
    /// Log (MCAP, CSV, rosbag2); several are runs of the same robot, identified together
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Robot file; without it the one attached to the first log that has one
    #[arg(long, value_name = "M.toml")]
    pub model: Option<PathBuf>,
    #[command(flatten)]
    pub part: PartArguments,
    /// Write the robot file with the identified values to this file
    #[arg(short, long, value_name = "FITTED.toml", required = true, value_parser = a_file())]
    pub output: PathBuf,
    /// What to compare the model with
    #[arg(long, value_name = "WHAT", default_value = "forces")]
    pub reference: ReferenceName,
    /// Identify these parameters only, such as `mu,sigma_n_per_m,stribeck.ratio`; an effect that a cable lacks is added
    /// [default: those of `friction`, and of the effects that each cable has]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub parameters: Option<Vec<String>>,
    #[command(flatten)]
    pub per_log: PerLogArguments,
    /// Weigh deviations that are far out less (Huber's loss) instead of leaving out what cannot be a measurement
    #[arg(long)]
    pub huber: bool,
    /// Write a page with the values, their errors and what is left to this HTML file
    #[arg(long, value_name = "R.html", value_parser = a_file())]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub result: ResultArguments,
}

#[derive(Debug, Args)]
pub struct PerLogArguments {
    /// Give each of several logs its own value of this zero, because sensors are tared anew: `offset_n` at the platform, or
    /// `sensor_offset.offset_n` at the sensor
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub per_log: Vec<String>,
}

impl PerLogArguments {
    /// The zero that each log has of its own.
    pub fn zero(&self, log_count: usize, reference: ReferenceName) -> Outcome<Option<LogZero>> {
        zero_per_log(&self.per_log, log_count, reference.into())
            .map_err(|error| Failure::from(error).of_option("--per-log"))
    }

    /// Makes sure that none is given where there is no log of a robot.
    pub fn check_none(&self) -> Outcome {
        if self.per_log.is_empty() {
            return Ok(());
        }
        Err(Failure::usage("--per-log is for the logs of robots, not for the run of a manipulator"))
    }
}

#[derive(Debug, Args)]
pub struct DiscoverArguments {
    /// Log (MCAP, CSV, rosbag2) with forces at the platform; several are runs of the same robot, looked at together. With a manipulator file,
    /// the run of a manipulator with gratings
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Robot or manipulator file; without it the robot file attached to the first log that has one
    #[arg(long, value_name = "M.toml")]
    pub model: Option<PathBuf>,
    #[command(flatten)]
    pub part: PartArguments,
    /// Write the file with what was found, and with values fitted to the log, to this file; without it, only tell
    #[arg(short, long, value_name = "EXTENDED.toml", value_parser = a_file())]
    pub output: Option<PathBuf>,
    /// What to compare the model with
    #[arg(long, value_name = "WHAT", default_value = "forces")]
    pub reference: ReferenceName,
    #[command(flatten)]
    pub per_log: PerLogArguments,
    /// Write a page with figures of what was found to this HTML file
    #[arg(long, value_name = "R.html", value_parser = a_file())]
    pub report: Option<PathBuf>,
    /// Leave what has no name as it is, without a table of how large it is and where
    #[arg(long)]
    pub no_empirical: bool,
    #[command(flatten)]
    pub result: ResultArguments,
}

#[derive(Debug, Args)]
pub struct ConvertArguments {
    #[command(flatten)]
    pub log: LogArguments,
    /// The MCAP file to write
    #[arg(short, long, value_name = "OUT.mcap", required = true, value_parser = a_recording())]
    pub output: PathBuf,
    /// Replace the output if it exists
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct InitArguments {
    /// Log (MCAP, CSV, rosbag2); several files are the parts of one split recording
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// The robot file to write
    #[arg(short, long, value_name = "ROBOT.toml", required = true, value_parser = a_file())]
    pub output: PathBuf,
    /// Replace the output if it exists
    #[arg(long)]
    pub force: bool,
}

/// What a fit or a discovery compares the model with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ReferenceName {
    /// Cable forces measured at the platform, each cable by itself
    Forces,
    /// The outside wrench on the platform, or without one the platform's mass; all cables at once, no sensor there
    Wrench,
}

impl From<ReferenceName> for Reference {
    fn from(name: ReferenceName) -> Self {
        match name {
            ReferenceName::Forces => Self::Forces,
            ReferenceName::Wrench => Self::Wrench,
        }
    }
}

#[derive(Debug, Args)]
pub struct InfoArguments {
    #[command(flatten)]
    pub log: LogArguments,
    /// Show also encoding, jitter and time range of each topic
    #[arg(long)]
    pub wide: bool,
    /// Write a page with what is in the log and its signals over time to this HTML file
    #[arg(long, value_name = "R.html", value_parser = a_file())]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub result: ResultArguments,
}

#[derive(Debug, Args)]
pub struct SimulateArguments {
    /// Robot file; its friction is the truth
    #[arg(long, value_name = "M.toml", required = true)]
    pub model: PathBuf,
    /// The log to write
    #[arg(short, long, value_name = "LOG.mcap", required = true, value_parser = a_recording())]
    pub output: PathBuf,
    /// What the platform does
    #[arg(long, value_name = "RUN", value_enum, default_value_t)]
    pub run: RunName,
    /// Hide an effect of the catalogue in all cables; may be given several times
    #[arg(long = "effect", value_name = "kind:key=value,…", long_help = effects_help())]
    pub effects: Vec<String>,
    /// Spoil the log by something that is in no catalogue; may be given several times
    #[arg(long = "disturbance", value_name = "kind:key=value,…", long_help = disturbances_help())]
    pub disturbances: Vec<String>,
    /// Seed of noise and micro motion
    #[arg(long, value_name = "S", default_value_t = 0, allow_negative_numbers = true, value_parser = a_seed)]
    pub seed: u64,
    /// Length of the log in s; the run is cut or repeated [default: one run]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = a_number)]
    pub duration: Option<f64>,
    /// Standard deviation of the sensor noise, N
    #[arg(long, value_name = "N", default_value_t = 0.02, allow_negative_numbers = true, value_parser = a_number)]
    pub sensor_noise_n: f64,
    /// Standard deviation of the reference noise, N
    #[arg(long, value_name = "N", default_value_t = 0.01, allow_negative_numbers = true, value_parser = a_number)]
    pub reference_noise_n: f64,
    /// Spread of μ over the pulleys of a cable, as a share of μ
    #[arg(long, value_name = "RATIO", default_value_t = 0.0, allow_negative_numbers = true, value_parser = a_number)]
    pub mu_spread_ratio: f64,
    /// Standard deviation by which each sensor's zero wanders, N
    #[arg(long, value_name = "N", default_value_t = 0.0, allow_negative_numbers = true, value_parser = a_number)]
    pub sensor_wander_n: f64,
    /// Standard deviation by which each reference force wanders, N
    #[arg(long, value_name = "N", default_value_t = 0.0, allow_negative_numbers = true, value_parser = a_number)]
    pub reference_wander_n: f64,
    /// Correlation time of what wanders, s
    #[arg(long, value_name = "S", default_value_t = 2.0, allow_negative_numbers = true, value_parser = a_number)]
    pub wander_s: f64,
    /// Let a hand push the platform slowly to and fro, by so much at most along each axis, N; a cable on a test bench along
    /// itself
    #[arg(long, value_name = "N", default_value_t = 0.0, allow_negative_numbers = true, value_parser = a_number)]
    pub hand_n: f64,
    /// Standard deviation of the noise of the lengths, m; the speed is then their difference over a cycle
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true, value_parser = a_number)]
    pub length_noise_m: f64,
    /// Step of the encoder's lengths, m; the speed is then their difference over a cycle
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true, value_parser = a_number)]
    pub length_resolution_m: f64,
    /// Replace the output if it exists
    #[arg(long)]
    pub force: bool,
}

/// What `--effect` can hide.
fn effects_help() -> String {
    let effects = Effect::kinds().map(|effect| {
        let row = effect.row();
        let keys = row.parameters.iter().map(|parameter| parameter.key);
        (row.kind, keys.collect::<Vec<_>>(), row.cause)
    });
    kinds_help("Hide an effect of the catalogue in all cables; may be given several times:", effects)
}

/// What `--disturbance` can hide.
fn disturbances_help() -> String {
    let disturbances = DISTURBANCES.iter().map(|row| {
        let keys = row.parameters.iter().map(|parameter| parameter.key);
        (row.kind, keys.collect::<Vec<_>>(), row.cause)
    });
    kinds_help("Spoil the log by something that is in no catalogue; may be given several times:", disturbances)
}

fn kinds_help<'a>(what: &str, kinds: impl Iterator<Item = (&'a str, Vec<&'a str>, &'a str)>) -> String {
    let line = |(kind, keys, cause): (&str, Vec<&str>, &str)| format!("\n  {kind} ({}): {cause}", keys.join(", "));
    let lines: String = kinds.map(line).collect();
    format!("{what}{lines}")
}

#[derive(Debug, Args)]
pub struct ExciteArguments {
    /// Robot file
    #[arg(long, value_name = "M.toml", required = true)]
    pub model: PathBuf,
    /// The CSV file to write, one row a cycle
    #[arg(short, long, value_name = "RUN.csv", required = true, value_parser = a_file())]
    pub output: PathBuf,
    /// Two corners of the box in which the platform runs, base frame, m [default: where the simulation runs]
    #[arg(long = "box", value_name = "x0,y0,z0,x1,y1,z1", allow_hyphen_values = true, value_parser = corners)]
    pub box_m: Option<Corners>,
    /// Cap on the speed of the platform, m/s [default: the run's own, 1]
    #[arg(long, value_name = "V", allow_negative_numbers = true, value_parser = a_number)]
    pub max_speed_m_per_s: Option<f64>,
    /// Cap on the acceleration of the platform, m/s² [default: the run's own, 16]
    #[arg(long, value_name = "A", allow_negative_numbers = true, value_parser = a_number)]
    pub max_acceleration_m_per_s2: Option<f64>,
    /// Least force of each cable at the platform, N [default: a tenth of its mean, and the viscous friction]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = a_number)]
    pub min_tension_n: Option<f64>,
    /// Greatest force of each cable at the platform, N [default: any]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = a_number)]
    pub max_tension_n: Option<f64>,
    /// Draw the run on a page, this HTML file
    #[arg(long, value_name = "P.html", value_parser = a_file())]
    pub preview: Option<PathBuf>,
    #[command(flatten)]
    pub design: DesignArguments,
    /// Replace outputs that exist
    #[arg(long)]
    pub force: bool,
}

/// What a run is designed for, in place of the identification run.
#[derive(Debug, Args)]
pub struct DesignArguments {
    /// Design the run that tells what a discovery left open: the file that `discover --json` wrote
    #[arg(long = "for", value_name = "FOUND.json", group = "question")]
    pub found: Option<PathBuf>,
    /// Design the run that tells these two effects apart, such as `stribeck,dwell_stiction`
    #[arg(long, value_name = "A,B", value_delimiter = ',', group = "question")]
    pub separate: Option<Vec<String>>,
    /// Design the run that determines these parameters best, such as `sigma_n_per_m,stribeck.ratio`
    #[arg(long, value_name = "NAMES", value_delimiter = ',', group = "question")]
    pub determine: Option<Vec<String>>,
    /// How long the designed run is, s [default: 20]
    #[arg(long = "duration", value_name = "S", allow_negative_numbers = true, value_parser = a_number, requires = "question")]
    pub duration_s: Option<f64>,
    /// Design for these cables only [default: all]
    #[arg(long = "cables", value_name = "NAMES", value_delimiter = ',', requires = "question")]
    pub cables: Option<Vec<String>>,
    /// Standard deviation of the noise of the force at the platform, N [default: what the discovery found; else 0.02 N at the sensor, 0.01 N at the
    /// platform]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = a_number, requires = "question")]
    pub noise_n: Option<f64>,
}

/// Six coordinates, m.
pub type Corners = [f64; 6];

fn corners(text: &str) -> Result<Corners, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    numbers.ok().and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
        "a box is six numbers in m, x0,y0,z0,x1,y1,z1, the lesser corner first, such as -0.1,-0.1,0,0.1,0.1,0.3"
            .to_owned()
    })
}

#[derive(Debug, Args)]
pub struct HysteresisArguments {
    #[command(flatten)]
    pub log: LogArguments,
    /// Write a page with the widths and the loops to this HTML file
    #[arg(long, value_name = "R.html", value_parser = a_file())]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub result: ResultArguments,
}

/// The runs of a simulated platform.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum RunName {
    /// Small steps, strokes and rectangles, as for the identification
    #[default]
    Identification,
    /// One position crossed along x, y, z and about them, as for the hysteresis of the wrench
    Crossing,
}

/// Where the result goes beside the table.
#[derive(Debug, Args)]
pub struct ResultArguments {
    /// Write the result as JSON to this file; `-` is stdout, and the table then goes to stderr
    #[arg(long, value_name = "F")]
    pub json: Option<PathBuf>,
    /// Replace outputs that exist
    #[arg(long)]
    pub force: bool,
}

/// An output that appears whole or not at all, which stdout cannot.
fn a_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        if path.as_os_str() == "-" { Err("this output cannot go to stdout; name a file") } else { Ok(path) }
    })
}

/// An MCAP file, which is not named like another kind of file.
fn a_recording() -> impl TypedValueParser<Value = PathBuf> {
    a_file().try_map(|path| recording_name::check(&path).map(|()| path))
}

/// Whether it is in range depends on the robot and is checked with it.
fn a_number(text: &str) -> Result<f64, &'static str> {
    text.parse().map_err(|_| "it must be a number in digits, such as 0 or 1.5, without its unit")
}

fn a_time(text: &str) -> Result<f64, &'static str> {
    let time_s = text.parse().ok().filter(|time_s: &f64| time_s.is_finite() && *time_s >= 0.0);
    time_s.ok_or("it must be a number of seconds, 0 or greater, such as 2.5")
}

fn a_seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("it must be a whole number, 0 to {}", u64::MAX))
}
