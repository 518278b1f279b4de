//! `simulate`: the log of a simulated robot.

use std::path::PathBuf;

use fric_core::Sample;
use fric_lab::simulate::{Disturbance, HiddenEffect, Run, Simulation, SimulationError, SimulationOptions};
use fric_log::path::MessagePath;
use fric_log::signals::{Role, SignalPaths};
use fric_log::write::{JointState, JointStateChannel, LogWriter, PoseChannel, WrenchChannel};

use crate::arguments::{RunName, SimulateArguments};
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::model::Model;
use crate::output;
use crate::progress::{self, STRIDE};
use crate::warnings::warn_all;

/// Pose and wrench come at 250 Hz, as a slower controller would publish them.
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
    let mut log = SimulatedLog::create(arguments, &model)?;
    let total_cycles = simulation.total_cycles();
    let bar = progress::cycles(total_cycles);
    let mut done_cycles = 0_u64;
    while let Some(sample) = simulation.next_cycle() {
        if done_cycles.is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(done_cycles);
        }
        done_cycles += 1;
        // The last cycle has a pose too: nothing is extrapolated past it.
        let with_platform = (done_cycles - 1).is_multiple_of(log.platform_stride) || done_cycles == total_cycles;
        log.write(&sample, with_platform)?;
    }
    bar.finish_and_clear();
    warn_all(&simulation.warnings());
    log.writer.finish()?;
    let effects = options.effects.iter().map(ToString::to_string);
    let hidden: Vec<String> = effects.chain(options.disturbances.iter().map(ToString::to_string)).collect();
    output::show(&format!(
        "{}: {done_cycles} cycles, seed {}, {}\n",
        arguments.output.display(),
        options.seed,
        if hidden.is_empty() { "no effect hidden".to_owned() } else { format!("hidden: {}", hidden.join(", ")) }
    ))
}

/// A number or an effect on the command line is the command line's fault, the rest the robot file's.
fn refused(error: SimulationError) -> Failure {
    match error {
        SimulationError::OptionOutOfRange { key, value, min, max } => {
            let option = if key == "duration_s" { "duration".to_owned() } else { key.replace('_', "-") };
            Failure::usage(format!("--{option} is {value:?}; allowed is {min} to {max}"))
        }
        SimulationError::RepeatedEffect { .. } => Failure::usage(format!("--effect: {error}")),
        SimulationError::RepeatedDisturbance { .. } => Failure::usage(format!("--disturbance: {error}")),
        error => Failure::from(error),
    }
}

struct SimulatedLog {
    writer: LogWriter,
    cables: JointStateChannel,
    /// None where the reference is known and not measured.
    reference: Option<JointStateChannel>,
    pose: Option<PoseChannel>,
    wrench: Option<WrenchChannel>,
    /// Cycles from one pose to the next.
    platform_stride: u64,
    numbers: [Vec<f64>; 3],
}

impl SimulatedLog {
    fn create(arguments: &SimulateArguments, model: &Model) -> Outcome<Self> {
        let paths = model.signal_paths()?;
        let topic = |role| bare_topic(&paths, role, &model.origin);
        let inputs: [PathBuf; 1] = [arguments.model.clone()];
        let mut writer = LogWriter::create(&arguments.output, &inputs, arguments.force)?;
        writer.attach_robot_file(&model.text)?;
        let names = model.robot.cable_names();
        let cables = writer.add_joint_state(&topic(Role::Cable)?, "base", &names)?;
        let is_measured = paths.known_reference().is_none();
        let reference = is_measured
            .then(|| Outcome::Ok(writer.add_joint_state(&topic(Role::Reference)?, "platform", &names)?))
            .transpose()?;
        let params = model.robot.params();
        let any_geometry = params.cables().iter().any(fric_core::CableParams::has_geometry);
        let all_geometry = params.cables().iter().all(fric_core::CableParams::has_geometry);
        let pose = any_geometry.then(|| Outcome::Ok(writer.add_pose(&topic(Role::Pose)?, "base")?)).transpose()?;
        let wrench =
            all_geometry.then(|| Outcome::Ok(writer.add_wrench(&topic(Role::Wrench)?, "base")?)).transpose()?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 or a small number")]
        let platform_stride = (PLATFORM_INTERVAL_S / params.cycle_s()).round().max(1.0) as u64;
        Ok(Self { writer, cables, reference, pose, wrench, platform_stride, numbers: Default::default() })
    }

    fn write(&mut self, sample: &Sample<'_>, with_platform: bool) -> Outcome {
        let Self { writer, cables, reference, pose, wrench, numbers, .. } = self;
        let stamp_nanos = u64::try_from(sample.stamp_nanos).map_err(Failure::new)?;
        let [position, velocity, effort] = numbers;
        for column in [&mut *position, velocity, effort] {
            column.clear();
        }
        position.extend(sample.cables.iter().map(|cable| cable.length_m));
        velocity.extend(sample.cables.iter().map(|cable| cable.speed_m_per_s));
        effort.extend(sample.cables.iter().map(|cable| cable.sensor_force_n));
        writer.write_joint_state(cables, stamp_nanos, JointState { position, velocity, effort })?;
        if let Some(reference) = reference {
            let measured = JointState { effort: sample.reference_force_n, ..JointState::default() };
            writer.write_joint_state(reference, stamp_nanos, measured)?;
        }
        if !with_platform {
            return Ok(());
        }
        if let (Some(channel), Some(truth)) = (&pose, &sample.pose) {
            writer.write_pose(channel, stamp_nanos, truth)?;
        }
        if let (Some(channel), Some(truth)) = (&wrench, &sample.outside_wrench) {
            writer.write_wrench(channel, stamp_nanos, truth)?;
        }
        Ok(())
    }
}

/// The topic of a signal that is to be written, which has to be a topic alone.
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
