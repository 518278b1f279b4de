//! `hysteresis`: table II of \[P\] for a log in which the platform crosses a position.

use fric_core::Sample;
use fric_lab::hysteresis::{Hysteresis, HysteresisResult, Survey};
use fric_log::log::Log;
use fric_log::output::OutputFile;
use fric_log::signals::{Part, SignalReader};
use fric_work::report;

use crate::arguments::HysteresisArguments;
use crate::failure::Outcome;
use crate::interrupt;
use crate::model::{self, Model};
use crate::output::{self, JsonTarget, Written};
use crate::progress::{self, STRIDE};
use crate::warnings::warn_all;

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

    // The first reading finds the position, the second runs the compensator; warnings about the log are printed once.
    let mut survey = Survey::new(&model.robot)?;
    let warn_about_log = |reader: &SignalReader| {
        warn_all(&reader.log().warnings());
        warn_all(&reader.warnings());
    };
    read(source, part, &model, |sample| survey.add(sample), warn_about_log)?;
    let crossed = survey.finish()?;
    let mut hysteresis = Hysteresis::new(&model.robot, &crossed)?;
    let warn_about_robot = |reader: &SignalReader| warn_all(&reader.robot_warnings(&model.robot));
    read(Log::open(&log.logs)?, part, &model, |sample| hysteresis.step(sample), warn_about_robot)?;
    warn_all(&model.robot.warnings());
    warn_all(&hysteresis.replay().cable_warnings(&model.robot));

    let axes = hysteresis.axes()?;
    let outcome = HysteresisResult::new(&model.robot, &crossed, &axes);
    let page = || report::hysteresis::page(&outcome, &hysteresis.loops(), &json.provenance());
    let page =
        report.map(|report| report.complete_with(&page())).transpose()?.map(|page| Written::new(page, "the report"));
    json.finish(&outcome, &outcome.summary(), page.into_iter().collect())
}

/// Reads all samples of the log in order.
fn read(
    log: Log,
    part: Part,
    model: &Model,
    mut take: impl FnMut(&Sample<'_>),
    warn: impl FnOnce(&SignalReader),
) -> Outcome {
    let paths = model.signal_paths()?;
    let bar = progress::bytes(log.total_bytes());
    let mut reader = SignalReader::new(log, paths, &model.robot.cable_names()).within(part);
    let mut count = 0_u64;
    let end = loop {
        if count.is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(reader.log().bytes_read());
        }
        count += 1;
        match reader.next_row() {
            Ok(Some(sample)) => take(&sample),
            Ok(None) => break Ok(()),
            Err(error) => break Err(error),
        }
    };
    progress::finish(&bar);
    // Damage may be the reason why the log cannot be used.
    warn(&reader);
    Ok(end?)
}
