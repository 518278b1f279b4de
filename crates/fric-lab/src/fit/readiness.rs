//! Checks what a log holds for an identification, and what it lacks.

use fric_core::Sample;
use fric_core::robot::file::{LogTable, ReferenceTable, RobotFile};

use super::balance::{ONE_LINE, ONE_LINE_ADVICE};
use super::error::FitError;
use crate::samples::record::Reference;
use crate::samples::store::SampleStore;

/// What a force sensor of the other sign shows, and what to do.
pub(crate) const NEGATIVE_FORCE: &str = "most samples have a force below 0 by the sensor";
pub(crate) const NEGATIVE_ADVICE: &str =
    "Tension is positive: tare the sensor, or turn its sign, that of a column by `factor = -1` under `[log.columns]`.";

/// Counts of the rows of one or several logs that have each signal.
#[derive(Clone, Debug)]
pub struct Holdings {
    /// Number of rows.
    pub rows: u64,
    /// Number of rows with a pose.
    pub posed: u64,
    /// Number of rows with the external wrench.
    pub wrenched: u64,
    cables: Vec<CableHoldings>,
    last_stamp_nanos: Option<i64>,
    /// Number of intervals between consecutive rows.
    intervals: u64,
    intervals_s: f64,
    /// Whether the signals are columns of rows, and no topics.
    has_columns: bool,
}

/// The same counts for one cable.
#[derive(Clone, Copy, Debug, Default)]
struct CableHoldings {
    signalled: u64,
    tension: Tension,
    referenced: u64,
    length_m: Course,
    reference_n: Course,
}

/// Whether a signal changes.
#[derive(Clone, Copy, Debug, Default)]
struct Course {
    /// Its first value.
    first: Option<f64>,
    /// Whether it ever was another one.
    changed: bool,
}

impl Course {
    fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.changed |= (*self.first.get_or_insert(value) - value).abs() > 0.0;
        }
    }
}

/// The sign of the forces that a sensor shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tension {
    count: u64,
    negative: u64,
    sum_n: f64,
}

impl Tension {
    /// Adds the force of a sample.
    pub fn add(&mut self, force_n: f64) {
        if force_n.is_finite() {
            self.count += 1;
            self.negative += u64::from(force_n < 0.0);
            self.sum_n += force_n;
        }
    }

    /// Whether any force was added.
    pub fn is_known(&self) -> bool {
        self.count > 0
    }

    fn join(&mut self, other: &Self) {
        self.count += other.count;
        self.negative += other.negative;
        self.sum_n += other.sum_n;
    }

    /// Whether most forces and their mean are negative. An untared sensor of a cable that is slack for most of the time has a positive mean.
    pub fn is_turned(&self) -> bool {
        2 * self.negative > self.count && self.sum_n < 0.0
    }
}

impl Holdings {
    /// Creates empty counts for `cable_count` cables.
    #[must_use]
    pub fn new(cable_count: usize) -> Self {
        Self {
            rows: 0,
            posed: 0,
            wrenched: 0,
            cables: vec![CableHoldings::default(); cable_count],
            last_stamp_nanos: None,
            intervals: 0,
            intervals_s: 0.0,
            has_columns: false,
        }
    }

    /// States that the signals are columns of rows, as in a CSV log.
    #[must_use]
    pub fn of_columns(self, has_columns: bool) -> Self {
        Self { has_columns, ..self }
    }

    /// Counts a row.
    pub fn add(&mut self, row: &Sample<'_>) {
        self.rows += 1;
        self.posed += u64::from(row.pose.is_some());
        self.wrenched += u64::from(row.outside_wrench.is_some());
        if let Some(last_nanos) = self.last_stamp_nanos.replace(row.stamp_nanos) {
            self.intervals += 1;
            #[expect(clippy::cast_precision_loss, reason = "a duration")]
            let interval_nanos = row.stamp_nanos.saturating_sub(last_nanos) as f64;
            self.intervals_s += interval_nanos * 1e-9;
        }
        for (holdings, (input, reference_n)) in self.cables.iter_mut().zip(row.cables.iter().zip(row.reference_force_n))
        {
            holdings.signalled += u64::from(input.sensor_force_n.is_finite() && input.length_m.is_finite());
            holdings.tension.add(input.sensor_force_n);
            holdings.length_m.add(input.length_m);
            holdings.reference_n.add(*reference_n);
            holdings.referenced += u64::from(reference_n.is_finite());
        }
    }

    /// Adds the counts of another log.
    pub fn join(&mut self, other: &Self) {
        self.rows += other.rows;
        self.posed += other.posed;
        self.wrenched += other.wrenched;
        self.intervals += other.intervals;
        self.intervals_s += other.intervals_s;
        for (cable, other) in self.cables.iter_mut().zip(&other.cables) {
            cable.signalled += other.signalled;
            cable.tension.join(&other.tension);
            cable.referenced += other.referenced;
            // What differs between logs only is no change.
            cable.length_m.changed |= other.length_m.changed;
            cable.reference_n.changed |= other.reference_n.changed;
        }
    }

    /// Returns how long a cable has a reference, estimated from the mean row interval, s.
    #[expect(clippy::cast_precision_loss, reason = "counts of rows")]
    pub(crate) fn referenced_s(&self, cable: usize) -> f64 {
        let referenced = self.cables.get(cable).map_or(0, |of| of.referenced);
        referenced as f64 * self.intervals_s / self.intervals.max(1) as f64
    }

    /// Returns how long the log has a pose, and the external wrench if it is measured at all, estimated from the mean row interval, s.
    #[expect(clippy::cast_precision_loss, reason = "counts of rows")]
    pub(crate) fn balanced_s(&self) -> f64 {
        let rows = if self.wrenched > 0 { self.posed.min(self.wrenched) } else { self.posed };
        rows as f64 * self.intervals_s / self.intervals.max(1) as f64
    }

    /// Returns the cause if no sample has a reference force, and the advice if there is only one.
    #[must_use]
    pub fn without_reference(&self, robot: &RobotFile) -> (String, Option<&'static str>) {
        without_reference(&robot.options().log.reference, self.has_columns)
    }

    /// Whether any cable has a reference.
    #[must_use]
    pub fn has_reference(&self) -> bool {
        self.cables.iter().any(|cable| cable.referenced > 0)
    }
}

/// Something that is missing.
#[derive(Debug)]
pub struct Lack {
    /// One sentence without its full stop.
    pub cause: String,
    /// What to do, one sentence; without a full stop if another reference can be used.
    pub advice: &'static str,
    /// Another reference that does not need what is missing.
    instead: Option<Reference>,
    /// Indices of the cables that cannot be identified without it.
    cables: Vec<usize>,
}

/// Everything that is missing for an identification.
#[derive(Debug)]
pub struct Readiness {
    /// The missing items.
    pub lacks: Vec<Lack>,
    cable_count: usize,
}

impl Readiness {
    /// Whether any cable can be identified.
    #[must_use]
    pub fn is_possible(&self) -> bool {
        (0..self.cable_count).any(|cable| !self.is_lacking(cable))
    }

    /// Adds something that is missing for cables.
    pub(crate) fn add(&mut self, cause: String, advice: &'static str, cables: Vec<usize>) {
        self.lacks.push(Lack { cause, advice, instead: None, cables });
    }

    /// Whether something is missing for a cable.
    #[must_use]
    pub fn is_lacking(&self, cable: usize) -> bool {
        self.lacks.iter().any(|lack| lack.cables.contains(&cable))
    }

    /// Returns the first missing item of a cable.
    #[must_use]
    pub fn lack_of(&self, cable: usize) -> Option<&Lack> {
        self.lacks.iter().find(|lack| lack.cables.contains(&cable))
    }

    /// Returns warnings about what is missing for some cables.
    ///
    /// # Errors
    /// Returns a [`FitError`] if no cable can be identified.
    pub fn check(&self) -> Result<Vec<String>, FitError> {
        if !self.is_possible() {
            let worst = self.lacks.iter().rev().max_by_key(|lack| lack.cables.len());
            return Err(worst.map_or_else(|| FitError::new("the robot has no cables", ""), Lack::error));
        }
        let warning = |Lack { cause, cables, .. }: &Lack| {
            let consequence = match cables.as_slice() {
                [] => "",
                [_] => ": its values are kept",
                _ => ": their values are kept",
            };
            format!("{cause}{consequence}")
        };
        Ok(self.lacks.iter().map(warning).collect())
    }
}

impl Lack {
    /// Returns the missing items as an error.
    #[must_use]
    pub fn error(&self) -> FitError {
        FitError { instead: self.instead, ..FitError::new(&self.cause, self.advice) }
    }
}

const SILENT_ADVICE: &str =
    "Compare the names of the cables in the log with those in the robot file; if they agree, all values are gaps.";
const STILL_ADVICE: &str = "Record strokes in both directions, best the run of `fric-cli excite`; if the cable did move, look for its length in the log.";
const CONSTANT_ADVICE: &str = "State a load that stays as `reference = { hanging_mass_kg = … }` or `{ constant_n = … }` under `[log]`; of several logs under several loads, each in the robot file that is attached to it (`fric-cli convert`).";
const SENSOR_ADVICE: &str =
    "Name their topic as `reference` under `[log]` in the robot file, or record with force sensors at the platform.";
const COLUMN_ADVICE: &str = "Name their columns under `[log.columns]` in the robot file, such as \"cable1.reference_n\" = { column = \"Load cell [N]\" }, or a force that is known as `reference` under `[log]`.";
const POSE_ADVICE: &str = "Name the topic of the poses as `pose` under `[log]` in the robot file.";
const POSE_COLUMN_ADVICE: &str = "Name the columns of the pose under `[log.columns]` in the robot file.";
const LENGTHS_ADVICE: &str = "Make sure that lengths count from `base_m` to `platform_m`, or name the topic of a measured pose as `pose` under `[log]` in the robot file.";

/// Returns the cause and the advice if there is no pose.
fn without_pose(log: &LogTable, has_columns: bool) -> (String, &'static str) {
    if log.pose_is_from_lengths() {
        ("no sample has a pose from its cable lengths".to_owned(), LENGTHS_ADVICE)
    } else if has_columns {
        ("the log has no pose in columns `pose.x_m` to `pose.qw`".to_owned(), POSE_COLUMN_ADVICE)
    } else {
        (format!("the log has no pose on {}", log.pose), POSE_ADVICE)
    }
}

/// Checks that the references are measured apart from the sensors. `names` are those of the cables.
///
/// # Errors
/// [`FitError`] if the reference of a cable is the force of its own sensor.
pub fn references(samples: &SampleStore<'_>, names: &[&str]) -> Result<(), FitError> {
    let advice =
        "Name the column or topic of the force at the platform as the reference, under `[log]` in the robot file.";
    samples.copied_references(names).map_or(Ok(()), |cause| Err(FitError::new(cause, advice)))
}

/// Returns what is missing to identify each cable from its force at the platform.
#[must_use]
pub fn by_forces(robot: &RobotFile, holdings: &Holdings) -> Readiness {
    let advice = "Name their topic as `reference` under `[log]` in the robot file, or fit without them";
    of_forces(robot, holdings, advice)
}

/// Returns what is missing to compare each cable with its force at the platform. `advice` is for a robot that can do without these forces.
pub(crate) fn of_forces(robot: &RobotFile, holdings: &Holdings, advice: &'static str) -> Readiness {
    let log = &robot.options().log;
    let (names, params) = (robot.cable_names(), robot.params());
    let mut readiness = Readiness { lacks: silent(&names, holdings), cable_count: names.len() };
    let without = |readiness: &Readiness, is_missing: &dyn Fn(usize) -> bool| -> Vec<usize> {
        (0..names.len()).filter(|cable| !readiness.is_lacking(*cable) && is_missing(*cable)).collect()
    };
    let cables = without(&readiness, &|cable| holdings.cables.get(cable).is_none_or(|of| of.referenced == 0));
    if !cables.is_empty() {
        let (cause, own_advice) = holdings.without_reference(robot);
        let can_balance = names.len() > 1 && geometry(robot, "").is_none();
        let (advice, instead) = match own_advice {
            Some(own) => (own, None),
            None if can_balance => (advice, Some(Reference::Wrench)),
            None => (SENSOR_ADVICE, None),
        };
        readiness.lacks.push(Lack { cause: cause + &of_cables(&names, &cables), advice, instead, cables });
    }
    let add_still = |readiness: &mut Readiness, signal: &str, advice, of: fn(&CableHoldings) -> Course| {
        let cables = without(readiness, &|cable| holdings.cables.get(cable).is_none_or(|all| !of(all).changed));
        if !cables.is_empty() {
            let listed: Vec<&str> = cables.iter().filter_map(|cable| names.get(*cable).copied()).collect();
            readiness.add(format!("the {signal} of {} never changes", listed.join(", ")), advice, cables);
        }
    };
    add_still(&mut readiness, "length", STILL_ADVICE, |of| of.length_m);
    if params.known_reference().is_none() {
        add_still(&mut readiness, "reference", CONSTANT_ADVICE, |of| of.reference_n);
    }
    let follows_pose = |cable: usize| params.cables().get(cable).is_some_and(fric_core::CableParams::needs_pose);
    let cables = if holdings.posed == 0 { without(&readiness, &follows_pose) } else { Vec::new() };
    if !cables.is_empty() {
        let (cause, advice) = without_pose(log, holdings.has_columns);
        readiness.lacks.push(Lack {
            cause: format!("{cause}, and so no wrap of the last pulley{}", of_cables(&names, &cables)),
            advice,
            instead: None,
            cables,
        });
    }
    readiness
}

/// Returns the cause if no sample has a reference force, and the advice if there is only one. `has_columns` tells columns of rows from topics.
pub(crate) fn without_reference(reference: &ReferenceTable, has_columns: bool) -> (String, Option<&'static str>) {
    match reference {
        ReferenceTable::Signal(_) if has_columns => {
            ("the log has no reference forces in columns such as `cable1.reference_n`".to_owned(), Some(COLUMN_ADVICE))
        }
        ReferenceTable::Signal(path) => (format!("the log has no reference forces on {path}"), None),
        ReferenceTable::Known(known) if known.hanging_mass_kg.is_some() => {
            let cause = format!(
                "in no sample is `{reference}` the reference: there is no force with a length, or the cable is never in quiet \
                 motion (accelerations to 0.5 m/s²)"
            );
            (cause, Some("Record motion at constant speed, or give the force as `constant_n`."))
        }
        ReferenceTable::Known(_) => {
            (format!("in no sample is `{reference}` the reference: the log has no forces"), Some(SILENT_ADVICE))
        }
    }
}

/// Returns what is missing to identify all cables from the wrench on the platform. `origin` names the source of the robot file.
#[must_use]
pub fn by_wrench(robot: &RobotFile, origin: &str, holdings: &Holdings) -> Readiness {
    let log = &robot.options().log;
    let names = robot.cable_names();
    let all: Vec<usize> = (0..names.len()).collect();
    let mut lacks: Vec<Lack> = geometry(robot, origin).into_iter().collect();
    if names.len() == 1 {
        // Robots with more cables are checked with the log.
        lacks.push(Lack { cause: ONE_LINE.to_owned(), advice: ONE_LINE_ADVICE, instead: None, cables: all.clone() });
    }
    for lack in silent(&names, holdings) {
        lacks.push(Lack {
            cause: format!("{}, and the wrench is that of all", lack.cause),
            cables: all.clone(),
            ..lack
        });
    }
    if holdings.posed == 0 {
        let (cause, advice) = without_pose(log, holdings.has_columns);
        lacks.push(Lack {
            cause: format!("{cause}: the directions of the cables are not known"),
            advice,
            instead: None,
            cables: all.clone(),
        });
    }
    let mass_kg = robot.params().mass_kg();
    let (of_wrench, wrench_advice) = if holdings.has_columns {
        (
            "in columns `wrench.fx_n` to `wrench.tz_nm`".to_owned(),
            "Name the columns under `[log.columns]`, or give `mass_kg` under `[platform]`, in the robot file.",
        )
    } else {
        (
            format!("on {}", log.wrench),
            "Name the topic as `wrench` under `[log]`, or give `mass_kg` under `[platform]`, in the robot file.",
        )
    };
    if holdings.wrenched == 0 && mass_kg > 0.0 {
        lacks.push(Lack {
            cause: format!(
                "the log has no wrench {of_wrench}: it is taken from the platform's mass of {mass_kg} kg and the pose, in quiet \
                 motion only"
            ),
            advice: "",
            instead: None,
            cables: Vec::new(),
        });
    } else if holdings.wrenched == 0 {
        lacks.push(Lack {
            cause: format!("the log has no wrench {of_wrench}, and the robot file no mass to take it from"),
            advice: wrench_advice,
            instead: None,
            cables: all,
        });
    }
    Readiness { lacks, cable_count: names.len() }
}

/// Returns what the robot file lacks for the wrench. `origin` names its source.
#[must_use]
pub fn geometry(robot: &RobotFile, origin: &str) -> Option<Lack> {
    let (names, params) = (robot.cable_names(), robot.params());
    let without: Vec<&str> =
        names.iter().zip(params.cables()).filter(|(_, cable)| !cable.has_geometry()).map(|(name, _)| *name).collect();
    (!without.is_empty()).then(|| Lack {
        cause: format!(
            "{origin} has no `base_m` and `platform_m` of {}, which the wrench needs of every cable",
            without.join(", ")
        ),
        advice: "Add them, or fit each cable to its reference force",
        instead: Some(Reference::Forces),
        cables: (0..names.len()).collect(),
    })
}

/// Returns the cables that the log has no data of, or no tension.
fn silent(names: &[&str], holdings: &Holdings) -> Vec<Lack> {
    let without = |is_lacking: &dyn Fn(&CableHoldings) -> bool| -> Vec<usize> {
        (0..names.len()).filter(|cable| holdings.cables.get(*cable).is_none_or(is_lacking)).collect()
    };
    let lack = |cables: Vec<usize>, cause: &dyn Fn(String) -> String, advice: &'static str| {
        let listed: Vec<&str> = cables.iter().filter_map(|cable| names.get(*cable).copied()).collect();
        (!cables.is_empty()).then(|| Lack { cause: cause(listed.join(", ")), advice, instead: None, cables })
    };
    let silent = without(&|of| of.signalled == 0);
    let pushing = without(&|of| of.tension.is_turned());
    let pushing = pushing.into_iter().filter(|cable| !silent.contains(cable)).collect();
    [
        lack(silent, &|names| format!("the log has no signal of {names}"), SILENT_ADVICE),
        lack(pushing, &|names| format!("{NEGATIVE_FORCE} of {names}"), NEGATIVE_ADVICE),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Returns the names of the cables, unless it is all of them.
pub(crate) fn of_cables(names: &[&str], cables: &[usize]) -> String {
    if cables.len() == names.len() {
        return String::new();
    }
    let listed: Vec<&str> = cables.iter().filter_map(|cable| names.get(*cable).copied()).collect();
    format!(" of {}", listed.join(", "))
}
