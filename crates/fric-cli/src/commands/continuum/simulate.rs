//! `continuum simulate`: the run of a simulated manipulator.

use fric_log::output::{CompleteFile, OutputFile};
use fric_tendon_lab::simulate::{Experiment, SimulatedRun, TendonSimulationOptions, simulate};
use fric_tendon_lab::{ContinuumError, as_measured, columns};
use serde::Serialize;

use super::Model;
use super::rows::{Channel, RowsFile, write_text};
use crate::arguments::continuum::{ExperimentName, TendonSimulateArguments};
use crate::failure::{Failure, Outcome};
use crate::output::{self, Written};

/// A run in MCAP.
const CHANNEL: Channel = Channel { topic: "/tendon_run", message: "fric_msgs/msg/TendonRun" };

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
    let target = RowsFile::create(output, &inputs, *force)?;
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
    let mut files = vec![Written::new(write_run(target, &run, model.disk_count())?, told)];
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

/// Writes the run with all its columns.
fn write_run(file: RowsFile, run: &SimulatedRun, disk_count: usize) -> Outcome<CompleteFile> {
    let mut names = vec![columns::TENSION_BASE.to_owned()];
    names.extend(columns::shifts(disk_count).into_iter().chain(columns::markers(disk_count)));
    let time_s: Vec<f64> = run.samples.iter().map(|sample| sample.time_s).collect();
    let rows = run.samples.iter().map(|sample| {
        let markers = sample.marker_m.iter().flatten();
        std::iter::once(&sample.tension_base_n).chain(&sample.shift_nm).chain(markers).copied().collect()
    });
    file.write(CHANNEL, &names, Some(&time_s), rows)
}

fn write_calibration(file: OutputFile, run: &SimulatedRun, disk_count: usize) -> Outcome<CompleteFile> {
    let mut names = vec![columns::LOADS[1].to_owned()];
    names.extend(columns::shifts(disk_count));
    let rows = run.calibration.iter().map(|step| std::iter::once(step.load_n).chain(step.shift_nm.clone()).collect());
    write_text(file, &names, rows)
}
