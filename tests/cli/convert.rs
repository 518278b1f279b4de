//! `convert`: any log as MCAP.

use super::cdr::joint_state;
use super::logs::{attached_robot, messages, on_topic};
use super::support::{Place, assert_close, example_robot, short_log};

/// A replay's messages.
fn replayed(place: &Place, log: &str) -> Vec<super::logs::Message> {
    place.run(&["replay", log, "-o", "out.mcap", "--force"]).succeeds();
    messages(&place.read("out.mcap"))
}

#[test]
fn a_converted_log_is_replayed_to_the_same_forces() {
    let place = Place::with_log();
    place.run(&["convert", "log.mcap", "-o", "converted.mcap"]).succeeds();
    assert_eq!(attached_robot(&place.read("converted.mcap")), example_robot());
    let cables = |log: &[u8]| on_topic(log, "/cable_states", joint_state);
    assert_eq!(cables(&place.read("converted.mcap")), cables(short_log()));
    let forces = |log: &str| -> Vec<f64> {
        let all = replayed(&place, log);
        all.iter().filter(|it| it.topic == "/fric/cable_forces").flat_map(|it| joint_state(&it.data).effort).collect()
    };
    let (converted, original) = (forces("converted.mcap"), forces("log.mcap"));
    assert_eq!(converted.len(), original.len());
    // The orientations between two poses are made unit once more.
    assert!(converted.iter().zip(&original).all(|(one, other)| (one - other).abs() < 1e-9));
}

#[test]
fn a_table_becomes_a_log_that_needs_no_columns() {
    let place = Place::empty();
    let rows: String = (0..200).map(|at| format!("{at};{};{}\n", at % 7, 800 - at)).collect();
    place.write("run.csv", format!("t [ms];F [kg];L [mm]\n{rows}"));
    place.write(
        "robot.toml",
        "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = 0.001\n[log]\nreference = { constant_n = 5.0 }\n[log.columns]\n\
         time_s = { column = \"t [ms]\", factor = 0.001 }\n\"winch.force_n\" = { column = \"F [kg]\", factor = 10.0 }\n\
         \"winch.length_m\" = { column = \"L [mm]\", factor = 0.001 }\n[[cable]]\nname = \"winch\"\npulleys = [{ wrap_deg = 90.0 }]\n",
    );
    place.run(&["convert", "run.csv", "--model", "robot.toml", "-o", "run.mcap", "--start", "0.1"]).succeeds();
    let log = place.read("run.mcap");
    let states = on_topic(&log, "/cable_states", joint_state);
    assert_eq!((states.len(), states[0].stamp_nanos), (100, 100_000_000));
    assert_close(states[0].effort[0], 20.0);
    assert_close(states[0].position[0], 0.7);
    let robot = attached_robot(&log);
    assert!(robot.contains("constant_n = 5.0") && !robot.contains("log.columns"), "{robot}");
    place.run(&["replay", "run.mcap"]).warns(&["no `friction` for winch"]);
}
