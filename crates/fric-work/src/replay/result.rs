//! The result of `replay`: for machines (`format = "fric-replay/1"`) and as a table.

use fric_core::robot::file::{FROM_LENGTHS, RobotFile};
use fric_lab::discover::Corrections;
use fric_lab::errors::{ForceError, WrenchResult};
use fric_lab::recording_fault::{FaultResult, recording_lines};
use fric_lab::replay::{CableErrors, Replay};
use fric_lab::text::{duration, table, wrapped};
use fric_log::signals::LengthPoses;
use hdrhistogram::{CreationError, Histogram};
use serde::Serialize;
use thiserror::Error;

use crate::verdict::{counted, left_in_words};

/// The error of bounds that a histogram does not accept.
#[derive(Debug, Error)]
#[error("cannot set up the histogram of cycle times: {0}")]
pub struct NoHistogram(#[from] CreationError);

/// Cycle times in bounded memory.
#[derive(Clone, Debug)]
pub(super) struct CycleTimes(Histogram<u64>);

impl CycleTimes {
    /// Creates an empty histogram. Three digits are kept; durations beyond 2^40 ns (18 minutes) count as that.
    ///
    /// # Errors
    /// Returns the errors of [`Histogram::new_with_max`], which accepts these bounds.
    pub fn new() -> Result<Self, NoHistogram> {
        Ok(Self(Histogram::new_with_max(1 << 40, 3)?))
    }

    /// Adds a cycle.
    pub fn add(&mut self, cycle_ns: u64) {
        self.0.saturating_record(cycle_ns);
    }
}

/// The result of a replay.
#[derive(Clone, Debug, Serialize)]
pub struct ReplayResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// Name of the robot.
    pub robot: String,
    /// The cables in the robot's order.
    pub cables: Vec<CableResult>,
    /// Errors of the wrench, if there is a reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrench: Option<WrenchResult>,
    /// Source of the poses, if not the log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pose: Option<PoseResult>,
    /// Cycle times.
    pub cycle: CycleResult,
}

/// Computed poses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoseResult {
    /// Their source: `lengths`.
    pub source: &'static str,
    /// Number of samples with a pose.
    pub samples: u64,
    /// Number of samples without a pose.
    pub missing: u64,
    /// Error of the lengths at the poses, rms over cables and samples, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_rms_m: Option<f64>,
}

impl PoseResult {
    /// Creates the result of poses from the cable lengths.
    #[must_use]
    pub fn of(poses: &LengthPoses) -> Self {
        Self {
            source: FROM_LENGTHS,
            samples: poses.posed_count,
            missing: poses.unposed_count(),
            residual_rms_m: poses.residual_rms_m(),
        }
    }

    /// Returns the same for a part of the log with `samples` rows, of which `missing` have no pose; the error of its lengths is not known.
    #[must_use]
    pub fn of_part(self, samples: u64, missing: u64) -> Self {
        Self { samples: samples - missing, missing, residual_rms_m: None, ..self }
    }

    /// Returns a line for people.
    fn line(&self) -> String {
        let residual =
            self.residual_rms_m.map_or_else(String::new, |rms_m| format!(", residual {:.3} mm rms", rms_m * 1e3));
        let missing = if self.missing > 0 { format!(", {} samples without", self.missing) } else { String::new() };
        format!("\npose from the cable lengths: {} samples{residual}{missing}\n", self.samples)
    }
}

/// One cable.
#[derive(Clone, Debug, Serialize)]
pub struct CableResult {
    /// Its name.
    pub name: String,
    /// Number of cycles.
    pub samples: u64,
    /// Number of cycles with any flag.
    pub flagged: u64,
    /// Whether its sensor has shown any force.
    #[serde(skip)]
    pub is_measured: bool,
    /// Error without friction compensation; `None` without a reference, or if the sensor has no value at all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<ForceError>,
    /// Error of the compensated force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<ForceError>,
    /// Faults of the recording that were corrected before the replay.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<FaultResult>,
}

/// Cycle times.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CycleResult {
    /// Number of cycles.
    pub count: u64,
    /// Median, ns.
    pub median_ns: u64,
    /// 99.9 % quantile, ns.
    pub p999_ns: u64,
    /// Maximum, ns.
    pub max_ns: u64,
}

impl ReplayResult {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-replay/1";

    /// Creates the result of a finished replay, with the poses that were computed and the corrections of the log.
    pub(super) fn new(
        robot: &RobotFile,
        replay: &Replay,
        times: &CycleTimes,
        pose: Option<PoseResult>,
        corrections: Option<&Corrections>,
    ) -> Self {
        let faults = |place: usize| corrections.map_or(&[][..], |corrections| corrections.faults(place));
        let cable = |(place, (name, errors)): (usize, (&str, &CableErrors))| CableResult {
            name: name.to_owned(),
            samples: replay.cycle_count(),
            flagged: errors.flagged_count,
            is_measured: errors.is_measured(),
            before: ForceError::of(&errors.before_n).filter(|_| errors.is_measured()),
            after: ForceError::of(&errors.after_n).filter(|_| errors.is_measured()),
            faults: faults(place).iter().map(FaultResult::of).collect(),
        };
        let (before, after) = replay.wrench();
        Self {
            format: Self::FORMAT,
            robot: robot.options().name.clone(),
            cables: robot.cable_names().into_iter().zip(replay.cables()).enumerate().map(cable).collect(),
            wrench: WrenchResult::of(replay.wrench_reference(), before, after),
            pose,
            cycle: CycleResult {
                count: replay.cycle_count(),
                median_ns: times.0.value_at_quantile(0.5),
                p999_ns: times.0.value_at_quantile(0.999),
                max_ns: times.0.max(),
            },
        }
    }

    /// Returns a table for people, at most 80 columns wide.
    #[must_use]
    pub fn summary(&self) -> String {
        self.table(false)
    }

    /// Returns the same table; `wide` adds the mean magnitude of the error and the number of samples.
    #[must_use]
    pub fn table(&self, wide: bool) -> String {
        let mut columns = vec![("rms error\nbefore [N]", 1), ("rms error\nafter [N]", 2), ("error\nleft", 3)];
        if wide {
            columns.extend([("mean |error|\nbefore [N]", 4), ("mean |error|\nafter [N]", 5), ("samples\n", 6)]);
        }
        columns.push(("flagged\nsamples", 7));
        let header: Vec<&str> = std::iter::once("cable").chain(columns.iter().map(|(head, _)| *head)).collect();
        let row = |cable: &CableResult| -> Vec<String> {
            let all = cable.cells();
            let picked = columns.iter().filter_map(|(_, place)| all.get(*place).cloned());
            std::iter::once(cable.name.clone()).chain(picked).collect()
        };
        let rows: Vec<_> = self.cables.iter().map(row).collect();
        let CycleResult { count, median_ns, p999_ns, max_ns } = self.cycle;
        let has_errors = self.cables.iter().any(|cable| cable.before.is_some());
        let what = if has_errors { "force at the platform against the reference" } else { "force at the platform" };
        let verdict = wrapped("", &self.verdict().sentence);
        let mut text = format!("{verdict}\n{}: {what}, {}\n\n", self.robot, counted(count, "sample"));
        text += &table(&header, 1, &rows);
        text += &recording_lines(self.cables.iter().map(|cable| (cable.name.as_str(), cable.faults.as_slice())));
        if let Some(wrench) = &self.wrench {
            text += "\n";
            text += &wrench.table();
        }
        text += &self.pose.as_ref().map_or_else(String::new, PoseResult::line);
        let [median, p999, max] = [median_ns, p999_ns, max_ns].map(duration);
        text + &format!(
            "\n{}; one takes {median} (median), {p999} (99.9 %), {max} (longest)\n\
             on this computer, which is not a real-time machine.\n",
            counted(count, "cycle")
        )
    }
}

impl CableResult {
    /// Returns all cells of the table: name, rms before and after, remaining fraction, mean before and after, samples, flagged.
    fn cells(&self) -> [String; 8] {
        let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
        let (before, after) = (self.before.as_ref(), self.after.as_ref());
        [
            self.name.clone(),
            number(before.map(|error| error.rms_n)),
            number(after.map(|error| error.rms_n)),
            self.left().map_or_else(|| "–".to_owned(), left_in_words),
            number(before.map(|error| error.mae_n)),
            number(after.map(|error| error.mae_n)),
            self.samples.to_string(),
            self.flagged.to_string(),
        ]
    }
}
