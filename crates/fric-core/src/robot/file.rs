//! The robot file, `format = "fric-robot/1"`: converts TOML text to checked parameters.
//!
//! There are two steps: `serde` gives [`RobotOptions`], exactly as written; [`RobotFile::parse`] checks it into [`CableParams`] and the rest. Every
//! error names file, line and key, the value and what is allowed, and for a misspelt key the nearest valid one. Needs the feature `robot-file`, an
//! allocator and `std`; not for the cycle.

use std::borrow::ToOwned;
use std::collections::BTreeMap;
use std::format;
use std::path::{Path, PathBuf};
use std::string::{String, ToString};
use std::vec::Vec;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use super::effect_table::EffectTable;
use super::locate::{Line, Step, line_of, read_tables};
use super::log_columns;
pub use super::log_columns::{ColumnTable, POSE_COLUMNS, TIME_COLUMN, WRENCH_COLUMNS};
pub use super::options_error::OptionsError;
use super::read::{exactly, exactly_if_given, table, table_if_given, tables, tables_by_key, word, word_if_given};
pub use super::reference::{KnownReferenceTable, ReferenceTable};
use super::{CableParams, MOST_CABLES, MonitorOptions, ParamError, ParamProblem, PlatformOptions, RobotParams};
use crate::effects::Effect;
use crate::forward::FEWEST_CABLES;
use crate::text_file;

/// The only value of `format` that this version reads.
pub const FORMAT: &str = "fric-robot/1";

/// Value of `pose` under `[log]` if no pose was measured: it is computed from the cable lengths ([`forward`](crate::forward)). Value of `speed` if it is
/// derived from them too, whatever speed a log has.
pub const FROM_LENGTHS: &str = "lengths";

/// A robot file as written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotOptions {
    /// [`FORMAT`].
    pub format: String,
    /// Name of the robot.
    pub name: String,
    /// Cycle time, s.
    pub cycle_s: f64,
    /// Mass and gravity.
    #[serde(default, deserialize_with = "table")]
    pub platform: PlatformTable,
    /// Location of the signals in a log.
    #[serde(default, deserialize_with = "table")]
    pub log: LogTable,
    /// Limits beyond which a signal counts as faulty.
    #[serde(default, deserialize_with = "table")]
    pub monitor: MonitorTable,
    /// The cables.
    #[serde(deserialize_with = "tables")]
    pub cable: Vec<CableTable>,
}

/// `[platform]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlatformTable {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass, platform frame, m.
    #[serde(deserialize_with = "exactly")]
    pub center_of_mass_m: [f64; 3],
    /// Inertia tensor about the centre of mass, platform axes, kg m²: xx, xy, xz, yy, yz, zz.
    #[serde(deserialize_with = "exactly")]
    pub inertia_kg_m2: [f64; 6],
    /// Gravity, base frame, m/s².
    #[serde(deserialize_with = "exactly")]
    pub gravity_m_per_s2: [f64; 3],
}

impl Default for PlatformTable {
    fn default() -> Self {
        let PlatformOptions { mass_kg, center_of_mass_m, inertia_kg_m2, gravity_m_per_s2 } = PlatformOptions::default();
        Self { mass_kg, center_of_mass_m, inertia_kg_m2, gravity_m_per_s2 }
    }
}

/// `[log]`: a topic, or a message path to a field, for each signal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LogTable {
    /// Cable signals.
    pub cable: String,
    /// Cable lengths, if they have a topic or field of their own.
    pub length: Option<String>,
    /// Cable speeds, if they have a topic or field of their own, or [`FROM_LENGTHS`].
    pub speed: Option<String>,
    /// Cable forces at the platform: where they are measured, or their known value.
    pub reference: ReferenceTable,
    /// Pose of the platform, or [`FROM_LENGTHS`].
    pub pose: String,
    /// External wrench on the platform.
    pub wrench: String,
    /// `[log.columns]`: for CSV, the columns whose names or units differ from the defaults.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "tables_by_key")]
    pub columns: BTreeMap<String, ColumnTable>,
}

impl Default for LogTable {
    fn default() -> Self {
        Self {
            cable: "/cable_states".to_owned(),
            length: None,
            speed: None,
            reference: ReferenceTable::Signal("/reference_forces".to_owned()),
            pose: "/platform_pose".to_owned(),
            wrench: "/platform_wrench".to_owned(),
            columns: BTreeMap::new(),
        }
    }
}

impl LogTable {
    /// Whether the pose is computed from the cable lengths.
    #[must_use]
    pub fn pose_is_from_lengths(&self) -> bool {
        self.pose == FROM_LENGTHS
    }

    /// Whether the speeds are derived from the cable lengths even if a log has speeds.
    #[must_use]
    pub fn speed_is_from_lengths(&self) -> bool {
        self.speed.as_deref() == Some(FROM_LENGTHS)
    }

    /// Checks that there are six cables for the six unknowns of a pose.
    fn check_pose(&self, cables: &[CableParams]) -> Result<(), OptionsError> {
        let complete = cables.iter().filter(|cable| cable.has_geometry()).count();
        if !self.pose_is_from_lengths() || complete >= FEWEST_CABLES {
            return Ok(());
        }
        let problem = format!(
            "is \"{FROM_LENGTHS}\", which takes `base_m` and `platform_m` of {FEWEST_CABLES} cables or more, and {complete} of the {} have both; give those that are missing, \
             or the topic of a measured pose",
            cables.len()
        );
        Err(OptionsError::new(&[Step::Key("log"), Step::Key("pose")], "pose", problem))
    }
}

/// `[monitor]`: see [`MonitorOptions`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MonitorTable {
    /// Number of cycles with an unchanged sensor; 0 for never.
    pub frozen_cycles: Option<u32>,
    /// Greatest change of length in a cycle, m.
    pub length_jump_m: Option<f64>,
    /// Amplitude of the noise of measured lengths, m.
    pub length_noise_m: Option<f64>,
    /// Greatest change of a sensor force in a cycle, N.
    pub sensor_jump_n: Option<f64>,
}

/// `[[cable]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CableTable {
    /// Name, as in the log's `JointState.name`.
    pub name: String,
    /// Entry point of the cable into the last pulley, base frame, m.
    #[serde(default, deserialize_with = "exactly_if_given")]
    pub base_m: Option<[f64; 3]>,
    /// Attachment, platform frame, m.
    #[serde(default, deserialize_with = "exactly_if_given")]
    pub platform_m: Option<[f64; 3]>,
    /// `"per_pulley"` or `"lumped"`.
    #[serde(default, deserialize_with = "word")]
    pub presliding: PreslidingName,
    /// Pulleys from the winch to the platform.
    #[serde(deserialize_with = "tables")]
    pub pulleys: Vec<PulleyTable>,
    /// Friction.
    #[serde(default, deserialize_with = "table")]
    pub friction: FrictionTable,
    /// Friction coefficient between cable and pulley.
    pub traction_mu: Option<f64>,
    /// Range of the identification.
    #[serde(default, deserialize_with = "table_if_given")]
    pub validated: Option<ValidatedTable>,
    /// Effects of the catalogue.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<EffectTable>,
}

/// Presliding form by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PreslidingName {
    /// One state on each pulley.
    #[default]
    PerPulley,
    /// One state per cable.
    Lumped,
}

/// An entry of `pulleys`: `wrap_deg`, or `wrap = "pose"` with `radius_m` and `axis`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PulleyTable {
    /// Fixed wrap angle, degrees.
    pub wrap_deg: Option<f64>,
    /// `"pose"`.
    #[serde(default, deserialize_with = "word_if_given")]
    pub wrap: Option<WrapName>,
    /// Radius, m.
    pub radius_m: Option<f64>,
    /// Direction in which the cable enters.
    #[serde(default, deserialize_with = "exactly_if_given")]
    pub axis: Option<[f64; 3]>,
    /// Whether the pulley carries the force sensor.
    pub sensor: Option<bool>,
}

/// The quantity that a wrap follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WrapName {
    /// The pose of the platform.
    Pose,
}

/// `friction`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FrictionTable {
    /// Bearing friction, 1.
    pub mu: f64,
    /// Presliding stiffness of the whole cable, N/m.
    pub sigma_n_per_m: Option<f64>,
    /// Viscous friction of each pulley, N s/m.
    pub viscous_n_s_per_m: f64,
    /// Offset at the platform, N.
    pub offset_n: f64,
}

/// `validated`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValidatedTable {
    /// Least and greatest sensor force, N.
    #[serde(default, deserialize_with = "exactly_if_given")]
    pub force_n: Option<[f64; 2]>,
    /// Greatest speed, m/s.
    pub speed_m_per_s: Option<f64>,
}

/// A valid robot file.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFile {
    options: RobotOptions,
    /// All parameters except the cables, which are stored beside it.
    robot: RobotParams<'static>,
    cables: Vec<CableParams>,
}

/// Errors of a robot file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RobotFileError {
    /// The file cannot be read.
    #[error("cannot read the robot file {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The text is not a valid robot file.
    #[error("{origin}{}: {problem}", Line(*line))]
    Invalid {
        /// Source of the text.
        origin: String,
        /// Line, from 1, if it is known.
        line: Option<usize>,
        /// The cable that the problem names, if it does.
        cable: Option<String>,
        /// The problem, and what to do.
        problem: String,
    },
}

impl RobotFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// Returns a [`RobotFileError`] if the file cannot be read or is invalid.
    pub fn read(path: &Path) -> Result<Self, RobotFileError> {
        let text = text_file::read(path).map_err(|source| RobotFileError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, &path.display().to_string())
    }

    /// Checks a text; `origin` names its source in error messages.
    ///
    /// # Errors
    /// Returns [`RobotFileError::Invalid`] for the first problem.
    pub fn parse(text: &str, origin: &str) -> Result<Self, RobotFileError> {
        let invalid = |line, cable, problem: String| RobotFileError::Invalid {
            origin: text_file::printable(origin),
            line,
            cable,
            problem: text_file::printable(&problem),
        };
        let options = read_tables(text, FORMAT).map_err(|(line, problem)| invalid(line, None, problem))?;
        Self::check(options)
            .map_err(|fault| invalid(line_of(text, &fault.path), fault.cable.clone(), fault.to_string()))
    }

    /// Checks options that come from elsewhere than a text; the error names key and problem.
    ///
    /// # Errors
    /// Returns an [`OptionsError`] for the first problem.
    pub fn check(options: RobotOptions) -> Result<Self, OptionsError> {
        if options.format != FORMAT {
            let problem = format!("is \"{}\"; this version reads \"{FORMAT}\"", options.format);
            return Err(OptionsError::new(&[Step::Key("format")], "format", problem));
        }
        if let Some(problem) = text_file::name_problem(&options.name) {
            return Err(OptionsError::new(&[Step::Key("name")], "name", problem));
        }
        let count = options.cable.len();
        if count > MOST_CABLES {
            let problem = format!("has {count} tables; a robot has {MOST_CABLES} cables at most");
            return Err(OptionsError::new(&[Step::Key("cable")], "cable", problem));
        }
        let mut cables = Vec::with_capacity(count);
        for (index, table) in options.cable.iter().enumerate() {
            let at = |mut error: OptionsError| {
                error.path.splice(0..0, [Step::Key("cable"), Step::Index(index)]);
                error.cable = Some(table.name.clone());
                error
            };
            if options.cable.iter().take(index).any(|other| other.name == table.name) {
                let problem = "is the name of an earlier cable too; names must differ".to_owned();
                return Err(at(OptionsError::new(&[Step::Key("name")], "name", problem)));
            }
            if let Some(problem) = text_file::name_problem(&table.name) {
                return Err(at(OptionsError::new(&[Step::Key("name")], "name", problem)));
            }
            cables.push(table.check().map_err(at)?);
        }
        let names: Vec<&str> = options.cable.iter().map(|cable| cable.name.as_str()).collect();
        log_columns::check(&options.log.columns, &names)?;
        options.log.check_pose(&cables)?;
        let robot = options.robot_params(&cables)?;
        Ok(Self { options, robot, cables })
    }

    /// Returns the parameters for a [`Compensator`](crate::Compensator).
    #[must_use]
    pub fn params(&self) -> RobotParams<'_> {
        RobotParams { cables: &self.cables, ..self.robot }
    }

    /// Returns the content of the file as written.
    #[must_use]
    pub fn options(&self) -> &RobotOptions {
        &self.options
    }

    /// Returns the names of the cables in order.
    #[must_use]
    pub fn cable_names(&self) -> Vec<&str> {
        self.options.cable.iter().map(|cable| cable.name.as_str()).collect()
    }

    /// Whether a column of a CSV log has the name of one of this robot's signals.
    #[must_use]
    pub fn is_log_column(&self, name: &str) -> bool {
        log_columns::known(&self.cable_names()).iter().any(|known| known == name)
    }

    /// Returns the file as TOML text, without comments.
    ///
    /// # Errors
    /// A checked file causes no error; the signature is that of the serialiser.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(&self.options)
    }
}

impl RobotOptions {
    /// Returns the checked parameters of a robot with these cables, without the cables themselves.
    fn robot_params(&self, cables: &[CableParams]) -> Result<RobotParams<'static>, OptionsError> {
        let PlatformTable { mass_kg, center_of_mass_m, inertia_kg_m2, gravity_m_per_s2 } = self.platform;
        let standard = MonitorOptions::for_cycle(self.cycle_s);
        let monitor = MonitorOptions {
            frozen_cycles: self.monitor.frozen_cycles.unwrap_or(standard.frozen_cycles),
            length_jump_m: self.monitor.length_jump_m.unwrap_or(standard.length_jump_m),
            length_noise_m: self.monitor.length_noise_m.unwrap_or(standard.length_noise_m),
            sensor_jump_n: self.monitor.sensor_jump_n,
        };
        let platform = PlatformOptions { mass_kg, center_of_mass_m, inertia_kg_m2, gravity_m_per_s2 };
        let robot = RobotParams::new(self.cycle_s, &platform, monitor, cables)
            .map_err(|error| self.name_parameter(cables, error))?;
        let known_reference = self.log.reference.check(robot.gravity_m_per_s2.norm())?;
        Ok(RobotParams { cables: &[], ..robot.with_known_reference(known_reference) })
    }

    /// Returns the error with the position of a refused parameter of the whole robot.
    fn name_parameter(&self, cables: &[CableParams], error: ParamError) -> OptionsError {
        let table = match error.key {
            "mass_kg" | "center_of_mass_m" | "inertia_kg_m2" | "gravity_m_per_s2" => Some(Step::Key("platform")),
            "length_jump_m" | "length_noise_m" | "sensor_jump_n" => Some(Step::Key("monitor")),
            "delay_s" => return self.delay_error(cables, error),
            _ => None,
        };
        let mut path: Vec<Step> = table.into_iter().collect();
        path.push(Step::Key(error.key));
        OptionsError::new(&path, error.key, error.problem.to_string())
    }

    /// Returns the error of a delay that is too long. The longest delay depends on the cycle time, so it is known only with the whole robot.
    fn delay_error(&self, cables: &[CableParams], error: ParamError) -> OptionsError {
        let of_value = |cable: &CableParams| match error.problem {
            ParamProblem::OutOfRange { value, .. } => cable
                .effects
                .get(Effect::TimeDelay, "delay_s")
                .is_some_and(|delay_s| delay_s.to_bits() == value.to_bits()),
            _ => false,
        };
        let place = cables.iter().position(of_value).and_then(|index| Some((index, self.cable.get(index)?)));
        let Some((index, table)) = place else { return OptionsError::from(error) };
        let mut named = table.name_parameter(error);
        named.path.splice(0..0, [Step::Key("cable"), Step::Index(index)]);
        named.cable = Some(table.name.clone());
        named
    }
}
