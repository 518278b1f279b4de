//! `replay`: the compensator over a log, as the control loop would run it.

use std::path::PathBuf;

use fric_lab::errors::{ForceError, WrenchResult};
use fric_lab::replay::{CableErrors, Replay};
use fric_lab::text::table;
use fric_log::log::Log;
use fric_log::output::OutputFile;
use fric_log::signals::{Role, SignalReader};
use fric_log::write::ReplayedLog;
use hdrhistogram::Histogram;

use crate::arguments::ReplayArguments;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::model::{self, Model};
use crate::output::{self, JsonTarget};
use crate::progress::{self, STRIDE};
use crate::report::{self, Series};
use crate::result::{CableResult, CycleResult, ReplayResult};
use crate::warnings::warn_all;

/// Runs the command.
pub fn run(arguments: &ReplayArguments) -> Outcome {
    let ReplayArguments { log, output, report, result } = arguments;
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
    let params = model.robot.params();
    let bar = progress::bytes(source.total_bytes());
    let mut reader = SignalReader::new(source, paths, &names).within(part);
    let mut replay = Replay::new(&params)?;
    // Three digits; durations beyond 2^40 ns (18 minutes) count as that.
    let mut durations = Histogram::<u64>::new_with_max(1 << 40, 3)
        .map_err(|error| Failure::new(format!("cannot set up the histogram of cycle times: {error}")))?;
    let mut series = report.as_ref().map(|_| Series::new(names.len()));
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
        let cycle = replay.step(&sample);
        durations.saturating_record(cycle.cycle_ns);
        if let Some(writer) = &mut writer {
            writer.write(sample.stamp_nanos, cycle.cables, cycle.outside_wrench.as_ref())?;
        }
        if let Some(series) = &mut series {
            series.add(&sample, cycle.cables);
        }
    };
    bar.finish_and_clear();
    // Damage may be why there is nothing to go on with.
    warn_all(&reader.log().warnings());
    end?;
    warn_all(&reader.warnings());
    warn_all(&reader.robot_warnings(&model.robot));
    if reader.times_apart(Role::Reference).is_some() {
        // That there are no reference forces has been told, and why.
        warn_all(&model.robot.warnings());
        warn_all(&replay.cable_warnings(&model.robot));
    } else {
        warn_all(&replay.warnings(&model.robot));
    }

    let outcome = summarize(&model, &names, &replay, &durations);
    let mut files = Vec::new();
    if let Some(writer) = writer {
        files.push(writer.complete()?);
    }
    if let (Some(report), Some(series)) = (report, series) {
        files.push(report.complete_with(&report::errors::page(&outcome, &series, &log.logs))?);
    }
    json.finish(&outcome, &describe(&outcome), files)
}

fn summarize(model: &Model, names: &[&str], replay: &Replay, durations: &Histogram<u64>) -> ReplayResult {
    let cable = |(name, errors): (&&str, &CableErrors)| CableResult {
        name: (*name).to_owned(),
        samples: replay.cycle_count(),
        flagged: errors.flagged_count,
        before: ForceError::of(&errors.before_n),
        after: ForceError::of(&errors.after_n),
    };
    let (before, after) = replay.wrench();
    ReplayResult {
        format: ReplayResult::FORMAT,
        robot: model.robot.options().name.clone(),
        cables: names.iter().zip(replay.cables()).map(cable).collect(),
        wrench: WrenchResult::of(replay.wrench_reference(), before, after),
        cycle: CycleResult {
            count: replay.cycle_count(),
            median_ns: durations.value_at_quantile(0.5),
            p999_ns: durations.value_at_quantile(0.999),
            max_ns: durations.max(),
        },
    }
}

/// The result as a table.
fn describe(result: &ReplayResult) -> String {
    let rows: Vec<_> = result
        .cables
        .iter()
        .map(|cable| {
            let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
            let (before, after) = (cable.before.as_ref(), cable.after.as_ref());
            let left = before.zip(after).map(|(before, after)| after.rms_n / before.rms_n * 100.0);
            [
                cable.name.clone(),
                cable.samples.to_string(),
                cable.flagged.to_string(),
                number(before.map(|error| error.rms_n)),
                number(after.map(|error| error.rms_n)),
                left.filter(|left| left.is_finite()).map_or_else(|| "–".to_owned(), |left| format!("{left:.1} %")),
                number(before.map(|error| error.mae_n)),
                number(after.map(|error| error.mae_n)),
            ]
        })
        .collect();
    let header =
        ["cable", "samples", "flagged", "rms before [N]", "after [N]", "left", "mean |error| before [N]", "after [N]"];
    let mut text = format!("{}: force at the platform against the reference\n\n", result.robot);
    text += &table(&header, 1, &rows);
    if let Some(wrench) = &result.wrench {
        text += "\n";
        text += &wrench.table();
    }
    let CycleResult { count, median_ns, p999_ns, max_ns } = result.cycle;
    text + &format!(
        "\n{count} cycles; one takes {median_ns} ns (median), {p999_ns} ns (99.9 %), {max_ns} ns (longest)\n"
    )
}
