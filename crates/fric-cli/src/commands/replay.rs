//! `replay`: runs the compensator over a log, as the control loop would.

use std::path::PathBuf;

use fric_lab::discover::Corrections;
use fric_lab::replay::Replay;
use fric_log::log::Log;
use fric_log::output::OutputFile;
use fric_log::signals::{Role, SignalReader};
use fric_log::write::ReplayedLog;
use fric_work::replay::{CycleTimes, ReplayResult};
use fric_work::report::{self, Series};

use crate::arguments::ReplayArguments;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::measurements;
use crate::model::{self, Model};
use crate::output::{self, JsonTarget, Written};
use crate::progress::{self, STRIDE};
use crate::warnings::warn_all;

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

    let paths = model.signal_paths()?;
    let corrections = correct.then(|| measurements::corrections(&log.logs, part, &model)).transpose()?;
    let params = match corrections.as_ref().and_then(Corrections::length_noise_m) {
        Some(length_noise_m) => model.robot.params().with_length_noise_m(length_noise_m)?,
        None => model.robot.params(),
    };
    let bar = progress::bytes(source.total_bytes());
    let mut reader = SignalReader::new(source, paths, &names).within(part);
    let mut replay = Replay::new(&params)?;
    let mut times = CycleTimes::new()
        .map_err(|error| Failure::new(format!("cannot set up the histogram of cycle times: {error}")))?;
    let mut series = report.as_ref().map(|_| Series::new(names.len()));
    let (mut room, mut number) = (Vec::new(), 0);
    let end = loop {
        if replay.cycle_count().is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(reader.log().bytes_read());
        }
        let sample = match reader.next_row() {
            Ok(Some(sample)) => sample,
            Ok(None) => break Ok(()),
            Err(error) => break Err(error),
        };
        let sample = match &corrections {
            Some(corrections) => corrections.corrected(number, &sample, &mut room),
            None => sample,
        };
        number += 1;
        let cycle = replay.step(&sample);
        times.add(cycle.cycle_ns);
        if let Some(writer) = &mut writer {
            writer.write(sample.stamp_nanos, cycle.cables, cycle.outside_wrench.as_ref())?;
        }
        if let Some(series) = &mut series {
            series.add(&sample, &cycle);
        }
    };
    progress::finish(&bar);
    // Damage may be the reason why the log cannot be used.
    warn_all(&reader.log().warnings());
    end?;
    warn_all(&reader.warnings());
    warn_all(&reader.robot_warnings(&model.robot));
    if reader.times_apart(Role::Reference).is_some() {
        // Missing reference forces have already been reported.
        warn_all(&model.robot.warnings());
        warn_all(&replay.cable_warnings(&model.robot));
    } else {
        warn_all(&replay.warnings(&model.robot, reader.log().column_names().is_some()));
    }

    let outcome = ReplayResult::new(&model.robot, &replay, &times)
        .with_poses(reader.length_poses().as_ref())
        .with_corrections(corrections.as_ref());
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
