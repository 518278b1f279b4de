//! `simulate`: the log of a simulated robot.

use std::fmt::Display;
use std::path::PathBuf;

use fric_lab::simulate::{Disturbance, HiddenEffect, Run, Simulation, SimulationError, SimulationOptions};
use fric_log::path::MessagePath;
use fric_log::signals::{Role, SignalPaths};
use fric_log::write::{LogWriter, SampledLog};

use crate::arguments::{RunName, SimulateArguments};
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::model::Model;
use crate::output::{self, Written};
use crate::progress::{self, STRIDE};
use crate::warnings::warn_all;

/// Pose and wrench come at 250 Hz, as from a slower controller.
const PLATFORM_INTERVAL_S: f64 = 0.004;

/// Runs the command.
pub fn run(arguments: &SimulateArguments) -> Outcome {
    let effects = arguments
        .effects
        .iter()
        .map(|text| HiddenEffect::parse(text))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| Failure::usage(format!("--effect: {error}")))?;
    let disturbances = arguments
        .disturbances
        .iter()
        .map(|text| Disturbance::parse(text))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| Failure::usage(format!("--disturbance: {error}")))?;
    let model = Model::read(&arguments.model)?;
    let options = SimulationOptions {
        run: match arguments.run {
            RunName::Identification => Run::Identification,
            RunName::Crossing => Run::Crossing,
        },
        seed: arguments.seed,
        duration_s: arguments.duration,
        sensor_noise_n: arguments.sensor_noise_n,
        reference_noise_n: arguments.reference_noise_n,
        mu_spread_ratio: arguments.mu_spread_ratio,
        sensor_wander_n: arguments.sensor_wander_n,
        reference_wander_n: arguments.reference_wander_n,
        wander_s: arguments.wander_s,
        hand_n: arguments.hand_n,
        length_noise_m: arguments.length_noise_m,
        length_resolution_m: arguments.length_resolution_m,
        effects,
        disturbances,
    };
    let mut simulation = Simulation::new(&model.robot, &options).map_err(refused)?;
    let mut simulated = SimulatedLog::create(arguments, &model)?;
    let total_cycles = simulation.total_cycles();
    let bar = progress::cycles(total_cycles);
    let mut done_cycles = 0_u64;
    while let Some(sample) = simulation.next_cycle() {
        if done_cycles.is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(done_cycles);
        }
        done_cycles += 1;
        // The last cycle has a pose too, because poses are not extrapolated.
        let with_platform = (done_cycles - 1).is_multiple_of(simulated.platform_stride) || done_cycles == total_cycles;
        simulated.log.write(&sample, with_platform)?;
    }
    progress::finish(&bar);
    warn_all(&simulation.warnings());
    let effects = options.effects.iter().map(|effect| hidden(effect, &effect.defaults()));
    let disturbances = options.disturbances.iter().map(|one| hidden(one, &one.defaults()));
    let all: Vec<String> = effects.chain(disturbances).collect();
    let all = if all.is_empty() { "no effect hidden".to_owned() } else { format!("hidden: {}", all.join(", ")) };
    let told = format!("{done_cycles} cycles, seed {}, {all}", options.seed);
    output::show_with("", vec![Written::new(simulated.log.complete()?, told)], "")
}

/// Returns the hidden effect or disturbance, with the default values that were used.
fn hidden(given: &impl Display, defaults: &[(&'static str, f64)]) -> String {
    if defaults.is_empty() {
        return given.to_string();
    }
    let defaults: Vec<String> = defaults.iter().map(|(key, value)| format!("{key}={value}")).collect();
    format!("{given} (by default {})", defaults.join(", "))
}

/// Converts an error to a failure; a wrong number or effect is a mistake on the command line, the rest concerns the robot file.
fn refused(error: SimulationError) -> Failure {
    match error {
        SimulationError::OptionOutOfRange { key, value, min, max } => {
            let option = if key == "duration_s" { "duration".to_owned() } else { key.replace('_', "-") };
            Failure::usage(format!("--{option} is {value:?}; allowed is {min} to {max}"))
        }
        SimulationError::RepeatedEffect { .. } => Failure::from(error).of_option("--effect"),
        SimulationError::RepeatedDisturbance { .. } => Failure::from(error).of_option("--disturbance"),
        error => Failure::from(error),
    }
}

struct SimulatedLog {
    log: SampledLog,
    /// Number of cycles from one pose to the next.
    platform_stride: u64,
}

impl SimulatedLog {
    fn create(arguments: &SimulateArguments, model: &Model) -> Outcome<Self> {
        let paths = model.signal_paths()?;
        let topic = |role| bare_topic(&paths, role, &model.origin);
        let inputs: [PathBuf; 1] = [arguments.model.clone()];
        let mut writer = LogWriter::create(&arguments.output, &inputs, arguments.force)?;
        writer.attach_robot_file(&model.text)?;
        let names = model.robot.cable_names();
        let mut log = SampledLog::new(writer, &topic(Role::Cable)?, &names)?;
        // A known reference is not measured.
        if paths.known_reference().is_none() {
            log.add_reference(&topic(Role::Reference)?, &names)?;
        }
        let params = model.robot.params();
        // A pose from the lengths is not measured either.
        if paths.pose_robot().is_none() && params.cables().iter().any(fric_core::CableParams::has_geometry) {
            log.add_pose(&topic(Role::Pose)?)?;
        }
        if params.cables().iter().all(fric_core::CableParams::has_geometry) {
            log.add_wrench(&topic(Role::Wrench)?)?;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 or a small number")]
        let platform_stride = (PLATFORM_INTERVAL_S / params.cycle_s()).round().max(1.0) as u64;
        Ok(Self { log, platform_stride })
    }
}

/// Returns the topic of a signal to write, which must be a bare topic.
fn bare_topic(paths: &SignalPaths, role: Role, origin: &str) -> Outcome<String> {
    match paths.get(role) {
        Some(MessagePath { topic, field }) if field.is_empty() => Ok(topic.clone()),
        path => {
            let shown = path.map(ToString::to_string).unwrap_or_default();
            Err(Failure::new(format!(
                "{origin}: `{}` under [log] is the field {shown}, but a simulated log has whole messages only",
                role.key()
            ))
            .advise("Give a topic alone, such as /cable_states, to simulate."))
        }
    }
}
