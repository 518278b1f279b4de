//! `replay`: runs the compensator over a log, as the control loop would.

use std::path::PathBuf;

use fric_log::log::Log;
use fric_log::output::OutputFile;
use fric_log::signals::Role;
use fric_log::write::ReplayedLog;
use fric_work::replay::{self, Replayed};
use fric_work::report::{self, Series};

use crate::arguments::ReplayArguments;
use crate::failure::Outcome;
use crate::model::{self, Model};
use crate::output::{self, JsonTarget, Written};
use crate::supervision::Watch;

/// Runs the command.
pub fn run(arguments: &ReplayArguments) -> Outcome {
    let ReplayArguments { log, output, report, correct, wide, result } = arguments;
    let json_file = result.json.as_deref().filter(|path| !output::is_stdout(path));
    output::check_distinct(&[output.as_deref(), report.as_deref(), json_file])?;
    let part = log.part.part()?;
    let source = Log::open(&log.logs)?;
    let model = Model::find(log.model.as_deref(), &source)?.ok_or_else(model::missing)?;
    let mut inputs = log.logs.clone();
    inputs.extend(log.model.clone());
    let json = JsonTarget::prepare(result.json.as_deref(), &inputs, result.force)?;
    let report = report.as_ref().map(|path| OutputFile::create(path, &inputs, result.force)).transpose()?;

    let names = model.robot.cable_names();
    let create = |path: &PathBuf| ReplayedLog::create(path, &inputs, result.force, &model.text, &names);
    let mut writer = output.as_ref().map(create).transpose()?;

    let mut watch = Watch::default();
    let mut reader = model.reader(source, part, None)?;
    let corrections = if *correct {
        let mut reader = model.reader(Log::open(&log.logs)?, part, Some(Role::Wrench))?;
        Some(replay::corrections(&model.robot, &mut reader, &mut watch)?)
    } else {
        None
    };
    let mut series = report.as_ref().map(|_| Series::new(names.len()));
    let replayed = replay::run(&model.robot, &mut reader, corrections.as_ref(), &mut watch, |sample, cycle| {
        if let Some(writer) = &mut writer {
            writer.write(sample.stamp_nanos, cycle.cables, cycle.outside_wrench.as_ref())?;
        }
        if let Some(series) = &mut series {
            series.add(sample, cycle);
        }
        Ok(())
    });
    let Replayed { result: outcome, .. } = replayed?;
    let mut files = Vec::new();
    if let Some(writer) = writer {
        files.push(Written::new(writer.complete()?, "forces, friction, wrench and status"));
    }
    if let (Some(report), Some(series)) = (report, series) {
        let page = report::errors::page(&outcome, &series, &json.provenance());
        files.push(Written::new(report.complete_with(&page)?, "the report"));
    }
    json.finish_then(&outcome, &outcome.table(*wide), files, &outcome.verdict().steps())
}
