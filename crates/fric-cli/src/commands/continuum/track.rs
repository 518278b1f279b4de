//! `continuum track`: the tensions at the base that follow a path, through what the holes remember.

use std::path::PathBuf;

use fric_log::output::CompleteFile;
use fric_tendon::{Drive, DriveOptions, GoalStatus, Tendon};
use fric_tendon_lab::follow::{FollowedGoal, Follower, GoalPath, Goals};
use fric_tendon_lab::result::{TrackResult, TrackSimulation};
use fric_tendon_lab::shape_errors::Way;
use fric_tendon_lab::simulate::track::{TrackOptions, track};
use fric_tendon_lab::{ContinuumError, columns, steadied};

use super::rows::{Channel, RowsFile, is_mcap};
use super::{Model, about, read_run, read_table};
use crate::arguments::continuum::{CompensationName, RunArguments, TrackArguments};
use crate::failure::{Failure, Outcome};
use crate::output::Outputs;
use crate::warnings::{warn, warn_all};

/// Commands in MCAP.
const CHANNEL: Channel = Channel { topic: "/tendon_command", message: "fric_msgs/msg/TendonCommand" };

/// The flags of a command that are columns, 0 or 1.
const FLAGS: [(&str, GoalStatus); 5] = [
    ("out_of_reach", GoalStatus::OUT_OF_REACH),
    ("not_converged", GoalStatus::NOT_CONVERGED),
    ("held", GoalStatus::HELD),
    ("reversal", GoalStatus::REVERSAL),
    ("dead_band", GoalStatus::DEAD_BAND),
];

/// Runs the command.
pub fn run(arguments: &TrackArguments) -> Outcome {
    let TrackArguments { path: path_file, output, after, result, .. } = arguments;
    Outputs::check(result, &[output.as_deref()])?;
    let inputs: Vec<PathBuf> =
        [Some(path_file), Some(&arguments.model), after.as_ref()].into_iter().flatten().cloned().collect();
    let model = Model::read(&arguments.model)?;
    let drive = drive(arguments, &model)?;
    let mut outputs = Outputs::create(result, None, inputs.clone())?;
    let rows_file = output.as_ref().map(|path| RowsFile::create(path, &inputs, result.force)).transpose()?;
    let path = GoalPath::from_columns(&read_table(path_file, &columns::of_path())?)
        .map_err(|error| about(path_file, error))?;
    let starts_before_zero = path.time_s().and_then(<[f64]>::first).is_some_and(|time_s| *time_s < 0.0);
    if starts_before_zero && output.as_deref().is_some_and(is_mcap) {
        return Err(Failure::new(format!(
            "{}: the path begins before 0 s, which MCAP cannot state",
            path_file.display()
        ))
        .advise("Move its times, or write CSV."));
    }

    let way = match arguments.friction {
        CompensationName::None => Way::None,
        CompensationName::Coulomb => Way::Coulomb,
        CompensationName::History => Way::History,
    };
    let params = model.file.params();
    let goals = path.goals().in_base_frame(&model.file);
    let mut follower = Follower::new(params, &drive, way).map_err(ContinuumError::from)?;
    if let Some(after) = after {
        let arguments = RunArguments { run: after.clone(), model: arguments.model.clone() };
        let (_, run) = read_run(&arguments)?;
        if !run.has_tension() {
            return Err(about(
                after,
                ContinuumError::MissingGroup {
                    what: "`tension_base_n`",
                    consequence: "nothing tells what the holes remember",
                    remedy: "the tension at the base",
                },
            ));
        }
        run.check_sizes(params).map_err(|error| about(after, error))?;
        warn_all(
            &run.begin_warning().map(|text| format!("{}: {text}", after.display())).into_iter().collect::<Vec<_>>(),
        );
        let (run, noise) = steadied(&run);
        warn_all(
            &noise.map(|noise| format!("{}: {}", after.display(), noise.warning())).into_iter().collect::<Vec<_>>(),
        );
        let missing = follower.advance(run.samples().iter().map(|sample| [sample.tension_base_n, 0.0]));
        if missing > 0 {
            warn(&format!(
                "{}: the model has no shape for {missing} samples, and the holes remember nothing of them; check stiffness and \
                 weight in the manipulator file",
                after.display()
            ));
        }
    }
    let answers: Vec<FollowedGoal> =
        goals.each().map(|goal| FollowedGoal::as_measured(&follower.next(goal), &model.file)).collect();
    let simulation = if arguments.simulate { Some(simulated(arguments, &model, goals)?) } else { None };
    let outcome = TrackResult::new(model.name(), way, path.time_s(), path.goals(), &answers, simulation);
    warn_all(&outcome.warnings());
    if let Some(file) = rows_file {
        outputs.add(write(file, &path, &answers)?, format!("the tensions for {} goals", outcome.goals));
    }
    outputs.finish(&outcome, &outcome.summary(), "")
}

/// Returns the drive that the command line states.
fn drive(arguments: &TrackArguments, model: &Model) -> Outcome<Drive> {
    let params = model.file.params();
    let usual = DriveOptions::first_tendon(params);
    let pair = |key: &str, given: &[f64], second_n: f64| match given {
        [first_n] => Ok([*first_n, second_n]),
        [first_n, second_n] => Ok([*first_n, *second_n]),
        more => {
            Err(Failure::usage(format!("--{key} has {} numbers; give that of the first tendon, or two", more.len())))
        }
    };
    let least_tension_n = pair("least-tension-n", &arguments.least_tension_n, 0.0)?;
    // A second tendon that keeps a tension is not pulled beyond it unless the command line says so.
    let [_, second_n] = least_tension_n;
    let greatest_tension_n = match &arguments.greatest_tension_n {
        Some(given) => pair("greatest-tension-n", given, second_n)?,
        None => [usual.greatest_tension_n[0], second_n],
    };
    Drive::new(params, &DriveOptions { least_tension_n, greatest_tension_n, hold_rad: arguments.hold_rad }).map_err(
        |error| {
            let of = match error.tendon {
                Some(Tendon::Agonist) => " of the first tendon",
                Some(Tendon::Antagonist) => " of the second tendon",
                None => "",
            };
            Failure::usage(format!("--{}{of} {}", error.key.replace('_', "-"), error.problem))
        },
    )
}

/// Follows the path on the simulated manipulator.
fn simulated(arguments: &TrackArguments, model: &Model, goals: Goals) -> Outcome<TrackSimulation> {
    let TrackArguments { seed, mu_spread_ratio, .. } = *arguments;
    let options = TrackOptions { seed, mu_spread_ratio, ..TrackOptions::new(goals) };
    let tracks = track(model.file.params(), &options).map_err(|error| match error {
        ContinuumError::OptionOutOfRange { key, value, min, max } => {
            Failure::usage(format!("--{} is {value:?}; allowed is {min} to {max}", key.replace('_', "-")))
        }
        error => about(&arguments.path, error),
    })?;
    Ok(TrackSimulation::new(&options, &tracks))
}

/// Writes the goals as stated, the tensions, the prediction and the flags.
fn write(file: RowsFile, path: &GoalPath, answers: &[FollowedGoal]) -> Outcome<CompleteFile> {
    let has_second = answers.iter().any(|goal| goal.tension_base_n[1] > 0.0);
    let wanted: Vec<Vec<f64>> = match path.goals() {
        Goals::BendRad(bend_rad) => bend_rad.iter().map(|bend_rad| vec![*bend_rad]).collect(),
        Goals::TipM(tip_m) => tip_m.iter().map(|tip_m| tip_m.to_vec()).collect(),
    };
    let mut names: Vec<String> = match path.goals() {
        Goals::BendRad(_) => vec![columns::BEND.to_owned()],
        Goals::TipM(_) => columns::TIP.map(ToOwned::to_owned).to_vec(),
    };
    names.push(columns::TENSION_BASE.to_owned());
    if has_second {
        names.push(columns::SECOND_TENSION_BASE.to_owned());
    }
    names.extend(["predicted_bend_rad", "predicted_tip_x_m", "predicted_tip_y_m"].map(ToOwned::to_owned));
    names.extend(FLAGS.map(|(name, _)| name.to_owned()));
    let rows = wanted.into_iter().zip(answers).map(|(mut row, goal)| {
        row.extend(goal.tension_base_n.into_iter().take(if has_second { 2 } else { 1 }));
        row.push(goal.bend_rad);
        row.extend(goal.tip_m);
        row.extend(FLAGS.map(|(_, flag)| f64::from(u8::from(goal.status.contains(flag)))));
        row
    });
    file.write(CHANNEL, &names, path.time_s(), rows)
}
