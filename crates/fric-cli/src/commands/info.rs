//! `info`: the content of a log, its signals, and which steps are impossible and why.

mod columns;
mod overview;
mod pace;
mod storage;

use std::collections::BTreeMap;
use std::fmt::Write as _;

use fric_core::robot::file::FROM_LENGTHS;
use fric_core::text_file::printable;
use fric_lab::discover;
use fric_lab::fit::readiness::{self, Holdings, Readiness};
use fric_lab::text::{table, table_with_text};
use fric_log::log::Log;
use fric_log::signals::{Part, Role, SignalError, SignalReader};
use fric_log::{CsvError, with_advice};
use fric_work::report::SignalSeries;
use fric_work::source::read;
use serde::Serialize;

use super::continuum;
use crate::arguments::InfoArguments;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::model::Model;
use crate::output::Outputs;
use crate::progress::{self, STRIDE};
use crate::steps::{StepResult, step_table};
use crate::supervision::Watch;
use crate::warnings::warn_all;
use columns::ColumnResult;
use pace::{Pace, Times, seconds_between};
use storage::StorageResult;

/// `fric-info/1`.
#[derive(Debug, Serialize)]
struct InfoResult {
    format: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    robot: Option<String>,
    storage: StorageResult,
    topics: Vec<TopicResult>,
    /// Columns of a log of rows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    columns: Vec<ColumnResult>,
    signals: Vec<SignalResult>,
    steps: Vec<StepResult>,
}

#[derive(Debug, Serialize)]
struct TopicResult {
    topic: String,
    schema: String,
    encoding: String,
    messages: u64,
    #[serde(flatten)]
    pace: Pace,
    /// First log time, relative to the first message of the log.
    from_s: f64,
    to_s: f64,
}

#[derive(Debug, Serialize)]
struct SignalResult {
    signal: &'static str,
    path: String,
    messages: u64,
    gaps: u64,
    /// For a pose from the cable lengths: the error of the lengths, rms over cables and samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    residual_rms_m: Option<f64>,
    remarks: Vec<String>,
}

/// What was read of a topic.
#[derive(Debug, Default)]
struct Topic {
    schema: String,
    encoding: String,
    times: Times,
}

#[expect(clippy::cast_precision_loss, reason = "for people")]
fn seconds(nanos: u64) -> f64 {
    nanos as f64 * 1e-9
}

/// Runs the command.
pub fn run(arguments: &InfoArguments) -> Outcome {
    let InfoArguments { log, report, wide, result } = arguments;
    Outputs::check(result, &[report.as_deref()])?;
    let mut inputs = log.logs.clone();
    inputs.extend(log.model.clone());
    let mut outputs = Outputs::create(result, report.as_deref(), inputs)?;
    if let [only] = log.logs.as_slice()
        && (continuum::is_manipulator(log.model.as_deref()) || log.model.is_none() && continuum::is_text_run(only))
    {
        log.part.check_none()?;
        return continuum::info::run(only, log.model.as_deref(), outputs);
    }
    let part = log.part.part()?;
    let mut source = Log::open(&log.logs)?;
    let model = Model::find(log.model.as_deref(), &source)?;
    let (topics, first_nanos) = read_topics(&mut source, part)?;
    let columns = columns::results(&source, model.as_ref());
    warn_all(&source.warnings());
    if let Some(model) = &model {
        warn_all(&model.robot.warnings());
    }
    let attachments = source.attachment_names();
    if topics.is_empty() && columns.is_empty() && attachments.is_empty() && source.beheaded().is_none() {
        return Err(Failure::new("the log holds no topic, no message and no robot file, complete at least")
            .advise("Name a complete copy of it, or record again."));
    }
    let mut storage = StorageResult::new(&source.storage(), &topics, first_nanos);
    let cables = model.as_ref().map_or_else(Vec::new, |model| model.robot.cable_names());
    let mut series = (outputs.has_report() && model.is_some()).then(|| SignalSeries::new(cables.len()));
    let (signals, steps) = match &model {
        Some(model) => {
            let read = read_signals(model, Log::open(&log.logs)?, part, series.as_mut())?;
            storage.set_rows(&read.times);
            (read.signals, read.steps)
        }
        None => (Vec::new(), Vec::new()),
    };
    let outcome = InfoResult {
        format: "fric-info/1",
        robot: model.as_ref().map(|model| model.robot.options().name.clone()),
        storage,
        topics,
        columns,
        signals,
        steps,
    };
    outputs.write_report(|provenance| overview::page(&outcome, &cables, series, provenance))?;
    outputs.finish(&outcome, &describe(&outcome, model.as_ref(), &attachments, *wide), "")
}

/// Returns the topics, and the time of the first message.
fn read_topics(log: &mut Log, part: Part) -> Outcome<(Vec<TopicResult>, Option<u64>)> {
    let bar = progress::bytes(log.total_bytes());
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    for channel in log.channels() {
        topics.entry(channel.topic.clone()).or_default();
    }
    let mut start_nanos = None;
    for count in 0_u64.. {
        if count.is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(log.bytes_read());
        }
        let Some(message) = log.next_message()? else { break };
        let at_s = seconds(message.log_time_nanos.saturating_sub(*start_nanos.get_or_insert(message.log_time_nanos)));
        if part.end_s.is_some_and(|end_s| at_s >= end_s) {
            break;
        }
        if part.start_s.is_some_and(|start_s| at_s < start_s) {
            continue;
        }
        let at_nanos = i64::try_from(message.log_time_nanos).unwrap_or(i64::MAX);
        match topics.get_mut(&message.channel.topic) {
            Some(topic) => topic.times.add(at_nanos),
            None => topics.entry(message.channel.topic.clone()).or_default().times.add(at_nanos),
        }
    }
    for channel in log.channels() {
        let topic = topics.entry(channel.topic.clone()).or_default();
        topic.encoding.clone_from(&channel.message_encoding);
        topic.schema = channel.schema.as_ref().map_or_else(String::new, |schema| schema.name.clone());
    }
    progress::finish(&bar);
    let first_nanos = start_nanos;
    let start_nanos = i64::try_from(start_nanos.unwrap_or(0)).unwrap_or(i64::MAX);
    let topic = |(topic, Topic { schema, encoding, times }): (String, Topic)| {
        let [from_s, to_s] =
            times.range_nanos().map_or([0.0; 2], |range| range.map(|at_nanos| seconds_between(start_nanos, at_nanos)));
        TopicResult { topic, schema, encoding, messages: times.count, pace: times.pace(), from_s, to_s }
    };
    Ok((topics.into_iter().map(topic).collect(), first_nanos))
}

/// The signals that were read.
struct SignalsRead {
    signals: Vec<SignalResult>,
    steps: Vec<StepResult>,
    /// Stamps of the samples.
    times: Times,
}

/// Reads the signals and joins them as the other commands do.
fn read_signals(model: &Model, log: Log, part: Part, mut series: Option<&mut SignalSeries>) -> Outcome<SignalsRead> {
    let mut reader = model.reader(log, part, None)?;
    let mut holdings = Holdings::new(model.robot.cable_names().len()).of_columns(reader.log().column_names().is_some());
    let mut times = Times::default();
    let end = read(&mut reader, &mut Watch::default(), |row| {
        times.add(row.stamp_nanos);
        holdings.add(row);
        if let Some(series) = &mut series {
            series.add(row);
        }
        Ok(())
    })?;
    let problem = match end {
        Ok(()) => None,
        // A read error of the disk says nothing about the log.
        Err(SignalError::Recording(error)) => return Err(error.into()),
        // The robot file is wrong.
        Err(error @ SignalError::Csv(CsvError::Misnamed { .. })) => return Err(error.into()),
        Err(error) => Some(with_advice(&error)),
    };
    let mut signals = signal_results(&reader);
    if reader.log().column_names().is_some() {
        warn_all(&reader.log().warnings());
    }
    let reference = &model.robot.options().log.reference;
    signals.extend(reader.paths().known_reference().map(|_| SignalResult {
        signal: Role::Reference.key(),
        path: reference.to_string(),
        messages: 0,
        gaps: 0,
        residual_rms_m: None,
        remarks: vec!["known and not measured, the same for every cable".to_owned()],
    }));
    signals.extend(reader.paths().speed_is_from_lengths().then(|| SignalResult {
        signal: Role::Speed.key(),
        path: FROM_LENGTHS.to_owned(),
        messages: 0,
        gaps: 0,
        residual_rms_m: None,
        remarks: vec!["derived from the cable lengths".to_owned()],
    }));
    signals.extend(reader.length_poses().map(|poses| SignalResult {
        signal: Role::Pose.key(),
        path: model.robot.options().log.pose.clone(),
        messages: 0,
        gaps: 0,
        residual_rms_m: poses.residual_rms_m(),
        remarks: [vec!["computed from the cable lengths".to_owned()], poses.remarks()].concat(),
    }));
    Ok(SignalsRead { signals, steps: steps(model, &holdings, problem.as_deref()), times })
}

fn signal_results(reader: &SignalReader) -> Vec<SignalResult> {
    let signal = |role: Role| {
        let path = reader.place(role)?;
        let counts = reader.counts(role);
        let mut remarks = counts.remarks();
        remarks.extend(reader.first_problem(role).map(|problem| format!("cannot be used: {problem}")));
        let apart = reader.times_apart(role);
        remarks.extend(apart.map(|apart| apart.to_string()));
        if counts.message_count == 0 && remarks.is_empty() {
            remarks.push("not in the log".to_owned());
        }
        Some(SignalResult {
            signal: role.key(),
            path,
            messages: if apart.is_some() { 0 } else { counts.message_count },
            gaps: counts.gap_count,
            residual_rms_m: None,
            remarks,
        })
    };
    Role::ALL.into_iter().filter_map(signal).collect()
}

/// Returns which steps the log allows.
fn steps(model: &Model, holdings: &Holdings, problem: Option<&str>) -> Vec<StepResult> {
    let params = model.robot.params();
    let cables = params.cables();
    let needs_pose = cables.iter().any(fric_core::CableParams::needs_pose);
    let all_geometry = cables.iter().all(fric_core::CableParams::has_geometry);
    let has_rows = holdings.rows > 0;
    let no_pose = || "no pose: the wrap of the last pulleys would be taken as 90°".to_owned();
    // Without a row there is nothing else to report.
    let nothing = || problem.unwrap_or("no samples").to_owned();
    let mut forces = Vec::new();
    forces.extend(problem.map(ToOwned::to_owned));
    if has_rows && needs_pose && holdings.posed == 0 {
        forces.push(no_pose());
    }
    let mut wrench = Vec::new();
    if !has_rows {
        wrench.push(nothing());
    } else if !all_geometry {
        wrench.push("no geometry: `base_m` and `platform_m` are needed for every cable".to_owned());
    }
    if has_rows && holdings.posed == 0 {
        wrench.push("no pose: the directions of the cables are not known".to_owned());
    }
    let has_wrench = has_rows && wrench.is_empty();
    if holdings.wrenched == 0 && wrench.is_empty() {
        let is_weighed = params.mass_kg() > 0.0;
        let instead = if is_weighed { "it is compared with the platform's weight" } else { "nothing to compare with" };
        wrench.push(format!("no outside wrench in the log: {instead}"));
    }
    let mut errors = Vec::new();
    if !has_rows {
        errors.push(nothing());
    } else if !holdings.has_reference() {
        errors.push(holdings.without_reference(&model.robot).0);
    } else if needs_pose && holdings.posed == 0 {
        errors.push(no_pose());
    }
    let step = StepResult::new;
    let fit = |name, readiness: Readiness| {
        let causes = || readiness.lacks.iter().map(|lack| lack.cause.clone()).collect();
        step(name, has_rows && readiness.is_possible(), if has_rows { causes() } else { vec![nothing()] })
    };
    vec![
        step("replay: forces", has_rows, forces),
        step("replay: wrench", has_wrench, wrench),
        step("replay: errors", has_rows && holdings.has_reference(), errors),
        fit("fit: forces", readiness::by_forces(&model.robot, holdings)),
        fit("fit: wrench", readiness::by_wrench(&model.robot, &model.origin, holdings)),
        fit("discover: forces", discover::readiness::by_forces(&model.robot, holdings)),
        fit("discover: wrench", discover::readiness::by_wrench(&model.robot, &model.origin, holdings)),
    ]
}

/// Formats the result as tables.
fn describe(result: &InfoResult, model: Option<&Model>, attachments: &[String], wide: bool) -> String {
    let mut text = result.storage.lines(attachments);
    text.push('\n');
    if !result.columns.is_empty() {
        text += &columns::table_of(&result.columns);
    }
    if !result.topics.is_empty() || result.columns.is_empty() {
        text += &topic_table(&result.topics, wide);
    }
    let Some(model) = model else {
        text += "\nWhich signal is which is in the robot file: none is attached to the log, name one\nwith --model, or make one to start from: fric-cli init.\n";
        return text;
    };
    // Writing to a String cannot fail.
    let _ = writeln!(text, "\nrobot: {} ({})\n", model.robot.options().name, model.origin);
    let row = |signal: &SignalResult| {
        [signal.signal.to_owned(), signal.path.clone(), signal.messages.to_string(), signal.remarks.join(", ")]
    };
    let rows: Vec<_> = result.signals.iter().map(row).collect();
    text += &table_with_text(&["signal", "path", "messages used", ""], 2, &rows);
    text += "\n";
    text += &step_table("the log allows", &result.steps);
    text
}

fn topic_table(topics: &[TopicResult], wide: bool) -> String {
    let number =
        |value: Option<f64>, digits: usize| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"));
    let milliseconds = |value: Option<f64>| number(value.map(|seconds| seconds * 1e3), 3);
    let row = |topic: &TopicResult| {
        // The last word of `sensor_msgs/msg/JointState` suffices.
        let schema = if wide { &topic.schema } else { topic.schema.rsplit(['/', '.']).next().unwrap_or_default() };
        let mut row = vec![printable(&topic.topic), printable(schema)];
        if wide {
            row.push(printable(&topic.encoding));
        }
        row.extend([
            topic.messages.to_string(),
            number(topic.pace.rate_hz, 1),
            milliseconds(topic.pace.longest_interval_s),
        ]);
        if wide {
            row.extend([milliseconds(topic.pace.jitter_s), format!("{:.3} … {:.3}", topic.from_s, topic.to_s)]);
        }
        row
    };
    let header: &[&str] = if wide {
        &["topic", "type", "encoding", "messages", "rate [Hz]", "longest gap [ms]", "jitter [ms]", "time [s]"]
    } else {
        &["topic", "type", "messages", "rate\n[Hz]", "longest\ngap [ms]"]
    };
    table(header, if wide { 3 } else { 2 }, &topics.iter().map(row).collect::<Vec<_>>())
}
