//! `init`: creates an initial robot file with every signal of a log that can be guessed.

mod columns;
mod draft;
mod topics;

use std::ops::Range;
use std::path::{Path, PathBuf};

use fric_core::robot::file::RobotFile;
use fric_log::log::Log;
use fric_log::output::OutputFile;
use fric_log::recording::RecordingError;
use fric_log::signals::{Role, SignalError, SignalPaths, SignalReader};
use fric_log::{CsvError, GREAT_INTERVAL_S};

use crate::arguments::InitArguments;
use crate::failure::{Failure, Outcome};
use crate::output::{self, Written};
use columns::Table;
use draft::Draft;

/// Greatest cycle time of a robot file, s.
const GREATEST_CYCLE_S: f64 = 10.0;
/// Times from 2001 to 2100, counted from 1970, s.
const SECONDS_SINCE_1970: Range<f64> = 1e9..4.1e9;

/// Number of samples that suffices to determine their interval and the size of the forces.
const MOST_ROWS: usize = 2000;

/// Runs the command.
pub fn run(arguments: &InitArguments) -> Outcome {
    let InitArguments { logs, output, force } = arguments;
    let mut log = Log::open(logs)?;
    let file = OutputFile::create(output, logs, *force)?;
    let first = logs.first().and_then(|path| path.file_stem()).map(|stem| stem.to_string_lossy().into_owned());
    let mut draft = Draft::new(first.unwrap_or_default());
    match log.column_names() {
        Some(names) => {
            let (dated, unchanging) = (log.dated_columns(), log.unchanging_columns()?);
            let table = Table { names, units: log.column_units(), dated: &dated, unchanging: &unchanging };
            columns::guess(&table, &mut draft);
        }
        None => topics::guess(&mut log, &mut draft)?,
    }
    look_at_beginning(logs, &mut draft, log.column_names().is_some())?;
    let text = draft.text();
    parsed(&text)?;
    let written = Written::new(file.complete_with(&text)?, "a robot file to start from");
    output::show_with(&draft.summary(), vec![written], &next_step(logs, output))
}

fn next_step(logs: &[PathBuf], output: &Path) -> String {
    let log = logs.first().map_or_else(String::new, |log| log.display().to_string());
    let output = output.display();
    format!("Next: check what is marked with `?` in {output}, then\n  fric-cli info {log} --model {output}\n")
}

fn parsed(text: &str) -> Outcome<RobotFile> {
    RobotFile::parse(text, "the robot file made of this log").map_err(|error| {
        Failure::new(error).advise("Write the robot file by hand; docs/robot-file.md shows the format.")
    })
}

/// Finds the interval of the samples and the size of the forces. Times of a CSV log that are likely no seconds get the factor of a smaller unit; of slow ones that are stated to be
/// seconds, or count them since 1970, only a note tells.
fn look_at_beginning(logs: &[PathBuf], draft: &mut Draft, has_columns: bool) -> Outcome {
    let is_usual = |of: &Beginning| of.interval_s < GREAT_INTERVAL_S;
    let beginning_of =
        |draft: &Draft| Outcome::Ok(Beginning::of(Log::open(logs)?, &parsed(&draft.with_stand_ins().text())?)?);
    let mut beginning = beginning_of(draft)?.filter(|of| of.interval_s < GREATEST_CYCLE_S);
    if let Some(slow) = beginning.as_ref().filter(|of| !is_usual(of))
        && (draft.time_states_its_unit() || SECONDS_SINCE_1970.contains(&slow.start_s))
    {
        let note = "time_s: the samples are slow for a recording of forces; is the time in milliseconds?";
        draft.notes.push(note.to_owned());
    } else if has_columns && !beginning.as_ref().is_some_and(is_usual) {
        for factor in [1e-3, 1e-6, 1e-9] {
            let scaled = draft.with_time_factor(factor);
            if let Some(found) = beginning_of(&scaled)?.filter(is_usual) {
                (*draft, beginning) = (scaled, Some(found));
                break;
            }
        }
    }
    draft.set_beginning(beginning.map(|of| (of.interval_s, of.mean_force_n)));
    Ok(())
}

/// The beginning of a log.
struct Beginning {
    /// Time of the first sample, s.
    start_s: f64,
    /// Usual interval of the samples, s.
    interval_s: f64,
    /// Mean magnitude of the forces of all cables, N; NaN if there are none.
    mean_force_n: f64,
}

impl Beginning {
    /// Reads it; `None` if it has no two samples, or none of this robot.
    ///
    /// # Errors
    ///
    /// Returns an error if the log cannot be read.
    fn of(log: Log, robot: &RobotFile) -> Result<Option<Self>, SignalError> {
        let Ok(paths) = SignalPaths::of_robot(robot) else { return Ok(None) };
        let mut reader = SignalReader::new(log, paths, &robot.cable_names());
        let mut start_nanos = None;
        let (mut sum_n, mut count) = (0.0, 0.0);
        for _ in 0..MOST_ROWS {
            let row = match reader.next_row() {
                Ok(Some(row)) => row,
                Err(
                    error @ (SignalError::Recording(RecordingError::Read { .. })
                    | SignalError::Csv(CsvError::Read { .. })),
                ) => return Err(error),
                Ok(None) | Err(_) => break,
            };
            start_nanos.get_or_insert(row.stamp_nanos);
            for force_n in row.cables.iter().map(|cable| cable.sensor_force_n).filter(|force_n| force_n.is_finite()) {
                sum_n += force_n.abs();
                count += 1.0;
            }
        }
        let interval_s = reader.counts(Role::Cable).interval_nanos * 1e-9;
        #[expect(clippy::cast_precision_loss, reason = "a time for comparison")]
        let start_s = start_nanos.map(|nanos| nanos as f64 * 1e-9);
        let beginning = |start_s| Self { start_s, interval_s, mean_force_n: sum_n / count };
        Ok(start_s.filter(|_| interval_s > 0.0).map(beginning))
    }
}
