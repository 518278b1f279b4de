//! `continuum simulate`: the run of a simulated manipulator.

use std::io::Write as _;
use std::path::Path;

use fric_log::output::{CompleteFile, OutputError, OutputFile};
use fric_log::write::LogWriter;
use fric_tendon_lab::simulate::{Experiment, SimulatedRun, TendonSimulationOptions, simulate};
use fric_tendon_lab::{ContinuumError, as_measured, columns};
use serde::Serialize;

use super::Model;
use crate::arguments::continuum::{ExperimentName, TendonSimulateArguments};
use crate::failure::{Failure, Outcome};
use crate::output::{self, Written};

/// The topic of a run in MCAP.
const TOPIC: &str = "/tendon_run";
const MESSAGE: &str = "fric_msgs/msg/TendonRun";

/// The true state: `fric-continuum-truth/1`.
#[derive(Debug, Serialize)]
struct Truth<'a> {
    format: &'static str,
    manipulator: &'a str,
    mu: &'a [f64],
    time_s: Vec<f64>,
    bend_rad: Vec<f64>,
    tension_n: Vec<&'a [f64]>,
    friction_n: Vec<&'a [f64]>,
    bound_n: Vec<&'a [f64]>,
}

/// Runs the command.
pub fn run(arguments: &TendonSimulateArguments) -> Outcome {
    let TendonSimulateArguments { output, calibration, truth, force, .. } = arguments;
    output::check_distinct(&[Some(output), calibration.as_deref(), truth.as_deref()])?;
    let inputs = [arguments.model.clone()];
    let model = Model::read(&arguments.model)?;
    let options = TendonSimulationOptions {
        experiment: match arguments.run {
            ExperimentName::OneWay => Experiment::OneWay,
            ExperimentName::Mixed => Experiment::Mixed,
        },
        greatest_tension_n: arguments.greatest_tension_n,
        seed: arguments.seed,
        mu_spread_ratio: arguments.mu_spread_ratio,
        grating_noise_nm: arguments.grating_noise_nm,
        marker_noise_m: arguments.marker_noise_m,
        ..TendonSimulationOptions::default()
    };
    let is_mcap = output.extension().is_some_and(|ending| ending == "mcap");
    let target = if is_mcap {
        Target::Log(Box::new(LogWriter::create(output, &inputs, *force)?))
    } else {
        Target::Text(OutputFile::create(output, &inputs, *force)?)
    };
    let create = |path: &Option<std::path::PathBuf>| {
        path.as_ref().map(|path| OutputFile::create(path, &inputs, *force)).transpose()
    };
    let (calibration, truth) = (create(calibration)?, create(truth)?);
    let mut run = simulate(model.file.params(), &options).map_err(refused)?;
    run.samples = as_measured(&run.samples, &model.file);
    let last_deg = run.truth.last().map_or(0.0, |truth| truth.bend_rad.to_degrees());
    let told = format!(
        "{} samples, {} of them with friction of both directions, bent by {last_deg:.1}° at the end; seed {}",
        run.samples.len(),
        run.truth.iter().filter(|truth| truth.is_mixed()).count(),
        options.seed,
    );
    let mut files = vec![Written::new(target.write(&run, model.disk_count())?, told)];
    if let Some(file) = calibration {
        let told = format!("{} load steps on the same gratings", run.calibration.len());
        files.push(Written::new(write_calibration(file, &run, model.disk_count())?, told));
    }
    if let Some(file) = truth {
        let text = output::as_json(&truth_of(model.name(), &run), &output::provenance(&inputs))?;
        files.push(Written::new(file.complete_with(&text)?, "the true friction, tension and bend"));
    }
    output::show_with("", files, "")
}

/// Converts an error to a failure; a wrong number is a mistake on the command line.
fn refused(error: ContinuumError) -> Failure {
    match error {
        ContinuumError::OptionOutOfRange { key, value, min, max } => {
            Failure::usage(format!("--{} is {value:?}; allowed is {min} to {max}", key.replace('_', "-")))
        }
        ContinuumError::TooGreatTension { greatest_tension_n, capacity_n } => Failure::usage(format!(
            "--greatest-tension-n is {greatest_tension_n}, above the tendon's capacity of {capacity_n} N in the manipulator file"
        ))
        .advise("Pull less, or state another `capacity_n` in the manipulator file."),
        error => error.into(),
    }
}

fn truth_of<'a>(manipulator: &'a str, run: &'a SimulatedRun) -> Truth<'a> {
    let each = |of: fn(&fric_tendon_lab::simulate::TendonTruth) -> &[f64]| run.truth.iter().map(of).collect();
    Truth {
        format: "fric-continuum-truth/1",
        manipulator,
        mu: &run.mu,
        time_s: run.samples.iter().map(|sample| sample.time_s).collect(),
        bend_rad: run.truth.iter().map(|truth| truth.bend_rad).collect(),
        tension_n: each(|truth| &truth.tension_n),
        friction_n: each(|truth| &truth.friction_n),
        bound_n: each(|truth| &truth.bound_n),
    }
}

/// The destination of the run.
enum Target {
    Log(Box<LogWriter>),
    Text(OutputFile),
}

impl Target {
    fn write(self, run: &SimulatedRun, disk_count: usize) -> Outcome<CompleteFile> {
        let mut names = vec![columns::TENSION_BASE.to_owned()];
        names.extend(columns::shifts(disk_count).into_iter().chain(columns::markers(disk_count)));
        let rows = run.samples.iter().map(|sample| {
            let markers = sample.marker_m.iter().flatten();
            let numbers = std::iter::once(&sample.tension_base_n).chain(&sample.shift_nm).chain(markers);
            (sample.time_s, numbers.copied().collect::<Vec<f64>>())
        });
        match self {
            Self::Log(mut writer) => {
                let channel = writer.add_numbers(TOPIC, MESSAGE, &names)?;
                for (time_s, numbers) in rows {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "seconds of a short run"
                    )]
                    let stamp_nanos = (time_s * 1e9).round() as u64;
                    writer.write_numbers(&channel, stamp_nanos, &numbers)?;
                }
                Ok(writer.complete()?)
            }
            Self::Text(file) => {
                names.insert(0, columns::TIME.to_owned());
                let rows = rows.map(|(time_s, mut numbers)| {
                    numbers.insert(0, time_s);
                    numbers
                });
                write_text(file, &names, rows)
            }
        }
    }
}

fn write_calibration(file: OutputFile, run: &SimulatedRun, disk_count: usize) -> Outcome<CompleteFile> {
    let mut names = vec![columns::LOADS[1].to_owned()];
    names.extend(columns::shifts(disk_count));
    let rows = run.calibration.iter().map(|step| std::iter::once(step.load_n).chain(step.shift_nm.clone()).collect());
    write_text(file, &names, rows)
}

/// Writes all digits, so that the reader gets the exact numbers.
fn write_text(file: OutputFile, names: &[String], rows: impl Iterator<Item = Vec<f64>>) -> Outcome<CompleteFile> {
    let path = file.path().to_owned();
    let mut writer = csv::Writer::from_writer(file);
    let failed = |error: csv::Error| written(&path, error.into());
    writer.write_record(names).map_err(failed)?;
    for row in rows {
        writer.write_record(row.iter().map(f64::to_string)).map_err(failed)?;
    }
    let mut file = writer.into_inner().map_err(|error| written(&path, error.into_error()))?;
    file.flush().map_err(|error| written(&path, error))?;
    Ok(file.complete()?)
}

fn written(path: &Path, source: std::io::Error) -> Failure {
    OutputError::File { path: path.to_owned(), source }.into()
}
