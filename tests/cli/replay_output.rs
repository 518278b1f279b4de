//! `replay -o`: the log that is written, against the input and against a plain loop over the library.

use fric_core::robot::file::RobotFile;
use fric_core::{Compensator, CycleInput};
use fric_log::recording::Recording;
use fric_log::signals::{Role, SignalPaths, SignalReader};

use super::cdr::{JointState, cable_status, joint_state, wrench};
use super::logs::{attached_robot, on_topic};
use super::support::{Place, assert_close, example_robot, rms, short_log};

/// The input's cable states, the output, and the result.
fn replayed() -> (Place, Vec<JointState>, Vec<u8>, serde_json::Value) {
    let place = Place::with_log();
    place.run(&["replay", "log.mcap", "-o", "out.mcap", "--json", "j.json"]).succeeds();
    let (output, result) = (place.read("out.mcap"), place.json("j.json"));
    (place, on_topic(short_log(), "/cable_states", joint_state), output, result)
}

#[test]
fn the_same_log_gives_the_same_bytes() {
    let (place, _, output, result) = replayed();
    place.run(&["replay", "log.mcap", "-o", "again.mcap", "--json", "again.json"]).succeeds();
    assert!(place.read("again.mcap") == output);
    let again = place.json("again.json");
    for key in ["robot", "cables", "wrench"] {
        assert_eq!(again[key], result[key]);
    }
}

#[test]
fn the_output_stands_at_the_times_of_the_input() {
    let (_, input, output, result) = replayed();
    let stamps: Vec<u64> = input.iter().map(|state| state.stamp_nanos).collect();
    assert_eq!(stamps.len(), 400);
    let names: Vec<String> = (1..=8).map(|number| format!("cable{number}")).collect();
    for topic in ["/fric/cable_forces", "/fric/friction"] {
        let states = on_topic(&output, topic, joint_state);
        assert_eq!(states.iter().map(|state| state.stamp_nanos).collect::<Vec<_>>(), stamps, "{topic}");
        assert!(states.iter().all(|state| state.names == names && state.effort.len() == 8), "{topic}");
        assert!(states.iter().all(|state| state.position.is_empty() && state.velocity.is_empty()), "{topic}");
    }
    let wrenches = on_topic(&output, "/fric/wrench", wrench);
    assert_eq!(wrenches.iter().map(|(stamp, _)| *stamp).collect::<Vec<_>>(), stamps);
    let status = on_topic(&output, "/fric/status", cable_status);
    assert_eq!(status.iter().map(|(stamp, ..)| *stamp).collect::<Vec<_>>(), stamps);
    assert!(status.iter().all(|(_, all, flags)| *all == names && flags.len() == 8));
    for (index, cable) in result["cables"].as_array().unwrap().iter().enumerate() {
        let flagged = status.iter().filter(|(.., flags)| flags[index] != 0).count();
        assert_eq!((cable["flagged"].as_u64(), cable["samples"].as_u64()), (Some(flagged as u64), Some(400)));
    }
    assert_eq!(attached_robot(&output), example_robot());
}

#[test]
fn the_forces_are_those_of_the_library_to_the_bit() {
    let (place, _, output, _) = replayed();
    let robot = RobotFile::parse(&example_robot(), "robot").unwrap();
    let mut compensator = Compensator::<8>::new(&robot.params()).unwrap();
    let paths = SignalPaths::default()
        .with(Role::Cable, Some("/cable_states".parse().unwrap()))
        .with(Role::Pose, Some("/platform_pose".parse().unwrap()));
    let recording = Recording::open(&[place.path("log.mcap")]).unwrap();
    let mut reader = SignalReader::new(recording, paths, &robot.cable_names());
    let mut expected = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    while let Some(row) = reader.next_row().unwrap() {
        let mut input = CycleInput { pose: row.pose, ..CycleInput::default() };
        input.cables.copy_from_slice(row.cables);
        let cycle = compensator.step(&input);
        expected.0.push(cycle.cables.map(|cable| cable.force_at_platform_n.to_bits()).to_vec());
        expected.1.push(cycle.cables.map(|cable| cable.friction_n.to_bits()).to_vec());
        expected.2.push(cycle.cables.map(|cable| cable.status.bits()).to_vec());
        let outside = cycle.outside_wrench.unwrap();
        expected.3.push([outside.force_n, outside.torque_nm].map(|vector| <[f64; 3]>::from(vector).map(f64::to_bits)));
    }
    let bits = |topic| {
        on_topic(&output, topic, |data| joint_state(data).effort.into_iter().map(f64::to_bits).collect::<Vec<_>>())
    };
    assert!(bits("/fric/cable_forces") == expected.0);
    assert!(bits("/fric/friction") == expected.1);
    assert!(on_topic(&output, "/fric/status", |data| cable_status(data).2) == expected.2);
    let wrenches = on_topic(&output, "/fric/wrench", |data| {
        let [fx, fy, fz, tx, ty, tz] = wrench(data).1.map(f64::to_bits);
        [[fx, fy, fz], [tx, ty, tz]]
    });
    assert!(wrenches == expected.3);
}

#[test]
fn the_errors_told_are_those_of_the_files() {
    let (_, input, output, result) = replayed();
    let reference = on_topic(short_log(), "/reference_forces", joint_state);
    let forces = on_topic(&output, "/fric/cable_forces", joint_state);
    for (index, cable) in result["cables"].as_array().unwrap().iter().enumerate() {
        let told = |when: &str, what: &str| cable[when][what].as_f64().unwrap();
        let pairs = || forces.iter().zip(&reference);
        assert!(pairs().all(|(force, reference)| force.stamp_nanos == reference.stamp_nanos));
        let after: Vec<f64> = pairs().map(|(force, reference)| force.effort[index] - reference.effort[index]).collect();
        // The sensor is on a pulley of 180°: without friction it feels the cable twice.
        let before: Vec<f64> = input
            .iter()
            .zip(&reference)
            .map(|(sensor, reference)| 0.5 * sensor.effort[index] - reference.effort[index])
            .collect();
        for (when, deviations) in [("before", before), ("after", after)] {
            assert_close(rms(deviations.iter().copied()), told(when, "rms_n"));
            #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
            let mean = deviations.iter().map(|deviation| deviation.abs()).sum::<f64>() / deviations.len() as f64;
            assert_close(mean, told(when, "mae_n"));
        }
    }
}

#[test]
fn the_wrench_error_told_is_that_of_the_files() {
    let (_, _, output, result) = replayed();
    let slow = on_topic(short_log(), "/platform_wrench", wrench);
    let mut deviations = [Vec::new(), Vec::new()];
    for (stamp_nanos, found) in on_topic(&output, "/fric/wrench", wrench) {
        let after = slow.iter().position(|(slow, _)| *slow >= stamp_nanos).unwrap();
        let (start, end) = (&slow[after.saturating_sub(1)], &slow[after]);
        #[expect(clippy::cast_precision_loss, reason = "milliseconds")]
        let ratio = if stamp_nanos == end.0 { 1.0 } else { (stamp_nanos - start.0) as f64 / (end.0 - start.0) as f64 };
        let at = |index: usize| found[index] - (start.1[index] + ratio * (end.1[index] - start.1[index]));
        for (deviations, first) in deviations.iter_mut().zip([0, 3]) {
            let length = (first..first + 3).map(|index| at(index) * at(index)).sum::<f64>().sqrt();
            deviations.push(length);
        }
    }
    let [force, torque] = deviations.map(rms);
    assert_close(force, result["wrench"]["after"]["force_rms_n"].as_f64().unwrap());
    assert_close(torque, result["wrench"]["after"]["torque_rms_nm"].as_f64().unwrap());
}
