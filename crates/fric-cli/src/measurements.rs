//! The logs of a fit or a discovery.

use std::path::{Path, PathBuf};

use fric_lab::fit::{LogZero, Reference};
use fric_log::log::Log;
use fric_log::signals::Part;
use fric_work::provenance::shown_path;
use fric_work::runs::{Runs, unread};

use crate::failure::{Failure, Outcome};
use crate::model::{self, Model};
use crate::supervision::Watch;

/// Checks that no sample counts twice.
pub fn check_named_once(logs: &[PathBuf]) -> Outcome {
    for (count, log) in logs.iter().enumerate() {
        let is_same =
            |other: &PathBuf| log.canonicalize().is_ok_and(|path| other.canonicalize().is_ok_and(|of| of == path));
        if logs.iter().take(count).any(is_same) {
            return Err(Failure::usage(format!("{} is named twice, and its samples would count twice", log.display()))
                .advise("Name each log once."));
        }
    }
    Ok(())
}

/// Returns the named robot file, or else the first that is attached to a log.
pub fn find_model(named: Option<&Path>, logs: &[PathBuf]) -> Outcome<Model> {
    for log in logs {
        if let Some(model) = Model::find(named, &Log::open(&[log])?)? {
            return Ok(model);
        }
    }
    Err(model::missing())
}

/// Reads the same part of all logs, each as a log of its own.
pub fn read<'a>(
    logs: &[PathBuf],
    part: Part,
    model: &'a Model,
    reference: Reference,
    per_log: Option<LogZero>,
    watch: &mut Watch,
) -> Outcome<Runs<'a>> {
    let names = logs.iter().map(|log| shown_path(log)).collect();
    let mut runs = Runs::new(&model.robot, &model.origin, reference, per_log, names, watch)?;
    for log in logs {
        // Signals that are not compared with are not read.
        let mut reader = model.reader(Log::open(&[log])?, part, Some(unread(reference)))?;
        runs.add(&format!("`{}`", log.display()), &mut reader, watch)?;
    }
    Ok(runs)
}
