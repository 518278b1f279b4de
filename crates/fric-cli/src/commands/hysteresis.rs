//! `hysteresis`: table II of \[P\] for a log in which the platform crosses a position.

use fric_log::log::Log;
use fric_log::output::OutputFile;
use fric_work::{hysteresis, report};

use crate::arguments::HysteresisArguments;
use crate::failure::Outcome;
use crate::model::{self, Model};
use crate::output::{self, JsonTarget, Written};
use crate::supervision::Watch;

/// Runs the command.
pub fn run(arguments: &HysteresisArguments) -> Outcome {
    let HysteresisArguments { log, report, result } = arguments;
    let json_file = result.json.as_deref().filter(|path| !output::is_stdout(path));
    output::check_distinct(&[report.as_deref(), json_file])?;
    let part = log.part.part()?;
    let source = Log::open(&log.logs)?;
    let model = Model::find(log.model.as_deref(), &source)?.ok_or_else(model::missing)?;
    let mut inputs = log.logs.clone();
    inputs.extend(log.model.clone());
    let json = JsonTarget::prepare(result.json.as_deref(), &inputs, result.force)?;
    let report = report.as_ref().map(|path| OutputFile::create(path, &inputs, result.force)).transpose()?;

    let mut reader = model.reader(source, part, None)?;
    let again = |_: &mut Watch| model.reader(Log::open(&log.logs)?, part, None);
    let (outcome, loops) = hysteresis::run(&model.robot, &mut reader, &mut Watch::default(), again)?;
    let page = || report::hysteresis::page(&outcome, &loops, &json.provenance());
    let page =
        report.map(|report| report.complete_with(&page())).transpose()?.map(|page| Written::new(page, "the report"));
    json.finish(&outcome, &outcome.summary(), page.into_iter().collect())
}
