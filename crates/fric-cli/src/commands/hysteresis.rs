//! `hysteresis`: table II of \[P\] for a log in which the platform crosses a position.

use std::fmt::Write as _;

use fric_core::Sample;
use fric_lab::CartesianAxis;
use fric_lab::hysteresis::{AxisHysteresis, CrossedPose, Hysteresis, Survey, Width};
use fric_log::recording::Recording;
use fric_log::signals::SignalReader;
use serde::Serialize;

use crate::arguments::HysteresisArguments;
use crate::failure::Outcome;
use crate::interrupt;
use crate::model::{self, Model};
use crate::output::{JsonTarget, table, to_millimetre};
use crate::progress::{self, STRIDE};
use crate::warnings::warn_all;

/// `fric-hysteresis/1`.
#[derive(Debug, Serialize)]
struct HysteresisResult {
    format: &'static str,
    robot: String,
    axes: Vec<AxisResult>,
}

/// An axis that is not crossed has 0 passes and no widths, one whose width without compensation is none but scatter no
/// ratio.
#[derive(Debug, Serialize)]
struct AxisResult {
    axis: &'static str,
    unit: &'static str,
    passes: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    without: Option<WidthResult>,
    #[serde(skip_serializing_if = "Option::is_none")]
    with: Option<WidthResult>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lasting_ratio: Option<f64>,
    /// Whether the log's own outside wrench was taken off.
    #[serde(skip_serializing_if = "Option::is_none")]
    applied_subtracted: Option<bool>,
}

#[derive(Debug, Serialize)]
struct WidthResult {
    width: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    standard_error: Option<f64>,
}

/// Runs the command.
pub fn run(arguments: &HysteresisArguments) -> Outcome {
    let HysteresisArguments { log, result } = arguments;
    let recording = Recording::open(&log.logs)?;
    let model = Model::find(log.model.as_deref(), &recording)?.ok_or_else(model::missing)?;
    let mut inputs = log.logs.clone();
    inputs.extend(log.model.clone());
    let json = JsonTarget::prepare(result.json.as_deref(), &inputs, result.force)?;

    // The first reading finds the position, the second runs the compensator; what the log is like is told once.
    let mut survey = Survey::new(&model.robot)?;
    let warn_about_log = |reader: &SignalReader| {
        warn_all(&reader.recording().warnings());
        warn_all(&reader.warnings());
    };
    read(recording, &model, |sample| survey.add(sample), warn_about_log)?;
    let crossed = survey.finish()?;
    let mut hysteresis = Hysteresis::new(&model.robot, &crossed)?;
    let warn_about_robot = |reader: &SignalReader| warn_all(&reader.robot_warnings(&model.robot));
    read(Recording::open(&log.logs)?, &model, |sample| hysteresis.step(sample), warn_about_robot)?;
    warn_all(&model.robot.warnings());
    warn_all(&hysteresis.replay().cable_warnings(&model.robot));

    let axes = hysteresis.axes()?;
    let outcome = HysteresisResult {
        format: "fric-hysteresis/1",
        robot: model.robot.options().name.clone(),
        axes: CartesianAxis::ALL.map(|axis| axis_result(axis, &axes)).into(),
    };
    json.show(&describe(&outcome, &crossed))?;
    json.write(&outcome)
}

/// All samples of the log one after the other.
fn read(
    recording: Recording,
    model: &Model,
    mut take: impl FnMut(&Sample<'_>),
    warn: impl FnOnce(&SignalReader),
) -> Outcome {
    let paths = model.signal_paths()?;
    let bar = progress::bytes(recording.total_bytes());
    let mut reader = SignalReader::new(recording, paths, &model.robot.cable_names());
    let mut count = 0_u64;
    let end = loop {
        if count.is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(reader.recording().bytes_read());
        }
        count += 1;
        match reader.next_row() {
            Ok(Some(sample)) => take(&sample),
            Ok(None) => break Ok(()),
            Err(error) => break Err(error),
        }
    };
    bar.finish_and_clear();
    // Damage may be why there is nothing to go on with.
    warn(&reader);
    Ok(end?)
}

fn axis_result(axis: CartesianAxis, all: &[AxisHysteresis]) -> AxisResult {
    let found = all.iter().find(|found| found.axis == axis);
    let width = |Width { width, standard_error }: Width| WidthResult { width, standard_error };
    AxisResult {
        axis: axis.name(),
        unit: axis.wrench_unit(),
        passes: found.map_or(0, |found| found.pass_count),
        without: found.map(|found| width(found.without)),
        with: found.map(|found| width(found.with)),
        lasting_ratio: found.and_then(AxisHysteresis::lasting_ratio),
        applied_subtracted: found.map(|found| found.is_applied_subtracted),
    }
}

/// The result as a table, as table II of \[P\] has it.
fn describe(result: &HysteresisResult, crossed: &CrossedPose) -> String {
    let [x_m, y_m, z_m] = <[f64; 3]>::from(crossed.pose().position_m.map(to_millimetre));
    let rows: Vec<_> = result
        .axes
        .iter()
        .map(|axis| {
            let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
            let (without, with) = (axis.without.as_ref(), axis.with.as_ref());
            [
                format!("{} [{}]", axis.axis, axis.unit),
                axis.passes.to_string(),
                number(without.map(|width| width.width)),
                number(without.and_then(|width| width.standard_error)),
                number(with.map(|width| width.width)),
                number(with.and_then(|width| width.standard_error)),
                axis.lasting_ratio.map_or_else(|| "–".to_owned(), |ratio| format!("{:.1} %", ratio * 100.0)),
            ]
        })
        .collect();
    let mut text =
        format!("{}: width of the wrench's hysteresis at ({x_m:.3}, {y_m:.3}, {z_m:.3}) m\n\n", result.robot);
    text += &table(&["axis", "passes", "without compensation", "±", "with", "±", "lasting"], 1, &rows);
    text += "\n";
    let named = |wanted: fn(&AxisResult) -> bool| {
        let names: Vec<&str> = result.axes.iter().filter(|axis| wanted(axis)).map(|axis| axis.axis).collect();
        Some(names.join(", ")).filter(|names| !names.is_empty())
    };
    // Writing to a String cannot fail.
    if let Some(names) = named(|axis| axis.applied_subtracted == Some(true)) {
        let _ = writeln!(
            text,
            "The log's outside wrench is taken off, so that what is really applied does not count: {names}."
        );
    }
    if let Some(names) = named(|axis| axis.applied_subtracted == Some(false)) {
        let _ =
            writeln!(text, "The log's outside wrench is not known, so that forces from outside count too: {names}.");
    }
    if let Some(names) = named(|axis| axis.passes == 0) {
        let _ = writeln!(
            text,
            "Not crossed: {names}. Record the platform going to and fro across this position along (x, y, z) or about \
             (a, b, c) these axes, several times, with nothing else moving."
        );
    }
    text
}
