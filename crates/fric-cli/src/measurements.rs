//! The logs of a fit or a discovery.

use std::path::{Path, PathBuf};

use fric_lab::fit::{LogZero, Reference};
use fric_log::log::Log;
use fric_log::signals::Part;
use fric_work::provenance::shown_path;
use fric_work::runs::{Runs, unread};
use fric_work::supervisor::Supervisor;

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

/// Reads the same part of all logs, each as a log of its own. Where robot files are attached to the logs and none was named, each log's own one says where its
/// signals are and which load hangs on its cables.
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
        let (told, source) = (format!("`{}`", log.display()), Log::open(&[log])?);
        let own = if model.is_attached() { Model::attached(&source)? } else { None };
        match &own {
            Some(own) => watch.warn(&compare(&told, own, model)?)?,
            None if model.is_attached() && model.robot.params().known_reference().is_some() => {
                let cause = format!(
                    "{told} has no robot file attached, and the one of another log states the load of that log"
                );
                return Err(Failure::new(cause)
                    .advise("Attach one with its load (fric-cli convert), or name one for all logs with --model."));
            }
            None => {}
        }
        // Signals that are not compared with are not read.
        let mut reader = own.as_ref().unwrap_or(model).reader(source, part, Some(unread(reference)))?;
        runs.add(&told, &mut reader, watch)?;
    }
    Ok(runs)
}

/// Checks that the robot file attached to a log describes a recording like that of the first one. Returns a warning if its machine is another, because that of
/// the first one is used.
fn compare(told: &str, own: &Model, first: &Model) -> Outcome<Vec<String>> {
    let [of_own, of_first] = [own, first].map(|model| model.robot.options());
    let [own_is_known, first_is_known] = [own, first].map(|model| model.robot.params().known_reference().is_some());
    let has_same_cables = own.robot.cable_names() == first.robot.cable_names();
    let differs = match (has_same_cables, own_is_known, first_is_known) {
        (false, ..) => Some("has other cables than"),
        (true, true, false) => Some("states a load under `[log] reference`, unlike"),
        (true, false, true) => Some("states no load under `[log] reference`, unlike"),
        _ => None,
    };
    if let Some(differs) = differs {
        return Err(Failure::new(format!("{told}: the robot file attached to it {differs} that of the first log"))
            .advise("Name one robot file for all logs with --model."));
    }
    let is_same_machine = of_own.cable == of_first.cable && of_own.platform == of_first.platform;
    let warning =
        format!("{told}: the robot file attached to it has other values than that of the first log, which are used");
    Ok(if is_same_machine { Vec::new() } else { vec![warning] })
}
