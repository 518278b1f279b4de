//! `hysteresis`: table II of \[P\] for a log in which the platform crosses a position.

use fric_log::log::Log;
use fric_work::{hysteresis, report};

use crate::arguments::HysteresisArguments;
use crate::failure::Outcome;
use crate::model::{self, Model};
use crate::output::Outputs;
use crate::supervision::Watch;

/// Runs the command.
pub fn run(arguments: &HysteresisArguments) -> Outcome {
    let HysteresisArguments { log, report, result } = arguments;
    Outputs::check(result, &[report.as_deref()])?;
    let part = log.part.part()?;
    let source = Log::open(&log.logs)?;
    let model = Model::find(log.model.as_deref(), &source)?.ok_or_else(model::missing)?;
    let mut inputs = log.logs.clone();
    inputs.extend(log.model.clone());
    let mut outputs = Outputs::create(result, report.as_deref(), inputs)?;

    let mut reader = model.reader(source, part, None)?;
    let again = |_: &mut Watch| model.reader(Log::open(&log.logs)?, part, None);
    let (outcome, loops) = hysteresis::run(&model.robot, &mut reader, &mut Watch::default(), again)?;
    outputs.write_report(|provenance| report::hysteresis::page(&outcome, &loops, provenance))?;
    outputs.finish(&outcome, &outcome.summary(), "")
}
