//! `replay`: runs the compensator over a log, as the control loop would.

use std::path::PathBuf;

use fric_log::log::Log;
use fric_log::signals::Role;
use fric_log::write::ReplayedLog;
use fric_work::replay::{self, Replayed};
use fric_work::report::{self, Series};

use crate::arguments::ReplayArguments;
use crate::failure::Outcome;
use crate::model::{self, Model};
use crate::output::Outputs;
use crate::supervision::Watch;

/// Runs the command.
pub fn run(arguments: &ReplayArguments) -> Outcome {
    let ReplayArguments { log, output, report, correct, wide, result } = arguments;
    Outputs::check(result, &[output.as_deref(), report.as_deref()])?;
    let part = log.part.part()?;
    let source = Log::open(&log.logs)?;
    let model = Model::find(log.model.as_deref(), &source)?.ok_or_else(model::missing)?;
    let mut inputs = log.logs.clone();
    inputs.extend(log.model.clone());
    let mut outputs = Outputs::create(result, report.as_deref(), inputs.clone())?;

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
    let mut series = outputs.has_report().then(|| Series::new(names.len()));
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
    if let Some(writer) = writer {
        outputs.add(writer.complete()?, "forces, friction, wrench and status");
    }
    if let Some(series) = series {
        outputs.write_report(|provenance| report::errors::page(&outcome, &series, provenance))?;
    }
    outputs.finish(&outcome, &outcome.table(*wide), &outcome.verdict().steps())
}
