//! `init`: creates an initial robot file with every signal of a log that can be guessed.

mod columns;
mod draft;
mod topics;

use std::path::{Path, PathBuf};

use fric_core::robot::file::RobotFile;
use fric_log::GREAT_INTERVAL_S;
use fric_log::log::Log;
use fric_log::output::OutputFile;
use fric_log::signals::{Role, SignalPaths, SignalReader};

use crate::arguments::InitArguments;
use crate::failure::{Failure, Outcome};
use crate::output::{self, Written};
use draft::Draft;

/// Number of samples that suffices to determine their interval.
const MOST_ROWS: usize = 2000;

/// Runs the command.
pub fn run(arguments: &InitArguments) -> Outcome {
    let InitArguments { logs, output, force } = arguments;
    let mut log = Log::open(logs)?;
    let file = OutputFile::create(output, logs, *force)?;
    let first = logs.first().and_then(|path| path.file_stem()).map(|stem| stem.to_string_lossy().into_owned());
    let mut draft = Draft::new(first.unwrap_or_default());
    match log.column_names() {
        Some(names) => columns::guess(names, &mut draft),
        None => topics::guess(&mut log, &mut draft)?,
    }
    find_interval(logs, &mut draft, log.column_names().is_some())?;
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

/// Finds the interval of the samples. Times of a CSV log that cannot be seconds get the factor of a smaller unit; of slow ones whose column states
/// seconds only a note tells.
fn find_interval(logs: &[PathBuf], draft: &mut Draft, has_columns: bool) -> Outcome {
    let is_usual = |interval_s: &f64| *interval_s < GREAT_INTERVAL_S;
    let interval_of = |draft: &Draft| Outcome::Ok(interval_s(Log::open(logs)?, &parsed(&draft.text())?));
    let mut interval_s = interval_of(draft)?;
    let is_slow = interval_s.is_some_and(|interval_s| !is_usual(&interval_s));
    if is_slow && draft.time_states_its_unit() {
        draft
            .notes
            .push("time_s: the samples are slow for a recording of forces; is the time in milliseconds?".to_owned());
    } else if has_columns && (is_slow || interval_s.is_none()) {
        for factor in [1e-3, 1e-6, 1e-9] {
            let scaled = draft.with_time_factor(factor);
            if let Some(interval) = interval_of(&scaled)?.filter(is_usual) {
                (*draft, interval_s) = (scaled, Some(interval));
                break;
            }
        }
    }
    draft.set_interval_s(interval_s);
    Ok(())
}

/// Returns the usual interval of the samples; `None` if there are none.
fn interval_s(log: Log, robot: &RobotFile) -> Option<f64> {
    let paths = SignalPaths::of_robot(robot).ok()?;
    let mut reader = SignalReader::new(log, paths, &robot.cable_names());
    let mut count = 0;
    while count < MOST_ROWS && matches!(reader.next_row(), Ok(Some(_))) {
        count += 1;
    }
    Some(reader.counts(Role::Cable).interval_nanos * 1e-9).filter(|interval_s| *interval_s > 0.0)
}
