//! `discover`: where the model and a log disagree, which effect is missing, and the robot file with that effect.

use std::path::{Path, PathBuf};

use fric_lab::discover::DiscoverOptions;
use fric_work::{discover, report};

use super::continuum;
use crate::arguments::DiscoverArguments;
use crate::failure::{Failure, Outcome};
use crate::measurements::{self, check_named_once, find_model};
use crate::output::Outputs;
use crate::supervision::Watch;

/// Runs the command.
pub fn run(arguments: &DiscoverArguments) -> Outcome {
    let DiscoverArguments { logs, model, part, output, reference, per_log, report, no_empirical, result } = arguments;
    if continuum::is_manipulator(model.as_deref()) {
        return continuum::discover::run(arguments);
    }
    if let (None, Some(run)) = (model, logs.iter().find(|log| continuum::is_text_run(log))) {
        return Err(Failure::usage(format!("{} is the run of a manipulator, whose file is not named", run.display()))
            .advise("Name it with --model, such as examples/tendon-prototype.toml with calibrated gratings."));
    }
    Outputs::check(result, &[output.as_deref(), report.as_deref()])?;
    check_named_once(logs)?;
    let part = part.part()?;
    let per_log = per_log.zero(logs.len(), *reference)?;
    let mut inputs = logs.clone();
    inputs.extend(model.clone());
    let model = find_model(model.as_deref(), logs)?;
    let mut outputs = Outputs::create(result, report.as_deref(), inputs)?;
    let extended_file = output.as_ref().map(|path| outputs.file(path)).transpose()?;

    let mut watch = Watch::default();
    let runs = measurements::read(logs, part, &model, (*reference).into(), per_log, &mut watch)?;
    let options = DiscoverOptions { empirical: !no_empirical, series: outputs.has_report() };
    let (outcome, found) = discover::run(&runs, &options, &mut watch)?;
    if let Some(file) = extended_file {
        let text = found.extended(&model.text, &model.origin)?;
        outputs.add(file.complete_with(&text)?, "the robot file with what was found, and values fitted to the log");
    }
    outputs.write_report(|provenance| report::discovery::page(&outcome, found.cables(), provenance))?;
    outputs.finish(&outcome, &outcome.summary(), &next_step(logs, output.as_deref()))
}

/// Returns the usual next step of a user.
fn next_step(logs: &[PathBuf], output: Option<&Path>) -> String {
    let log = logs.first().map_or_else(|| "LOG".to_owned(), |log| log.display().to_string());
    output.map_or_else(
        || "Nothing is written; `-o extended.toml` writes the robot file with it.\n".to_owned(),
        |path| format!("Next: fric-cli replay {log} --model {}\n", path.display()),
    )
}
