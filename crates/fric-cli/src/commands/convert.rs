//! `convert`: any readable log as MCAP with the signals on the default topics.

use fric_core::robot::file::{LogTable, ReferenceTable, RobotFile};
use fric_log::log::Log;
use fric_log::robot::ROBOT_FILE;
use fric_log::write::{LogWriter, SampledLog};
use fric_work::source::read_and_warn;
use fric_work::verdict::counted;

use crate::arguments::ConvertArguments;
use crate::failure::{Failure, Outcome};
use crate::model::{self, Model};
use crate::output::{self, Written};
use crate::supervision::Watch;

/// Runs the command.
pub fn run(arguments: &ConvertArguments) -> Outcome {
    let ConvertArguments { log, output, force } = arguments;
    let part = log.part.part()?;
    let source = Log::open(&log.logs)?;
    let model = Model::find(log.model.as_deref(), &source)?.ok_or_else(model::missing)?;
    let mut inputs = log.logs.clone();
    inputs.extend(log.model.clone());
    let names = model.robot.cable_names();
    let LogTable { cable, reference, pose, wrench, .. } = LogTable::default();
    let reference = match (reference, model.robot.params().known_reference()) {
        (ReferenceTable::Signal(topic), None) => Some(topic),
        // A known reference stays in the robot file.
        _ => None,
    };

    let mut writer = LogWriter::create(output, &inputs, *force)?;
    writer.attach_robot_file(&with_default_topics(&model)?)?;
    let mut converted = SampledLog::new(writer, &cable, &names)?;
    let mut count = 0_u64;
    read_and_warn(&mut model.reader(source, part, None)?, &model.robot, &mut Watch::default(), |sample| {
        count += 1;
        if let Some(topic) = reference.as_ref().filter(|_| sample.reference_force_n.iter().any(|it| !it.is_nan())) {
            converted.add_reference(topic, &names)?;
        }
        if sample.pose.is_some() {
            converted.add_pose(&pose)?;
        }
        if sample.outside_wrench.is_some() {
            converted.add_wrench(&wrench)?;
        }
        Ok(converted.write(sample, true)?)
    })?;
    let told = format!("{count} samples of {}, {ROBOT_FILE} attached", counted(names.len(), "cable"));
    output::show_with("", vec![Written::new(converted.complete()?, told)], "")
}

/// Returns the robot file for a log with the default topics: unchanged if it names no others, else without its `[log]`.
fn with_default_topics(model: &Model) -> Outcome<String> {
    let mut options = model.robot.options().clone();
    let standard = LogTable::default();
    let reference = match &options.log.reference {
        known @ ReferenceTable::Known(_) => known.clone(),
        ReferenceTable::Signal(_) => standard.reference.clone(),
    };
    let log = LogTable { reference, ..standard };
    if options.log == log {
        return Ok(model.text.clone());
    }
    options.log = log;
    let refused = |error: &dyn std::error::Error| Failure::new(format!("{}: {error}", model.origin));
    let robot = RobotFile::check(options).map_err(|error| refused(&error))?;
    robot.to_toml().map_err(|error| refused(&error))
}
