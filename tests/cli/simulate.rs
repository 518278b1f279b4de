//! `simulate`: seeds, hidden effects, and robots of all sizes through all commands.

use std::fmt::Write as _;

use super::support::{Place, example_robot};

/// Simulates the robot in `robot.toml` for a moment; gives the log.
fn simulated(place: &Place, options: &[&str]) -> Vec<u8> {
    let start = ["simulate", "--model", "robot.toml", "-o", "log.mcap", "--force"];
    place.run(&[&start, options].concat()).succeeds();
    place.read("log.mcap")
}

/// Root mean square of the first cable's error after compensation with `robot.toml`, N.
fn error_after(place: &Place) -> f64 {
    place.run(&["replay", "log.mcap", "--model", "robot.toml", "--json", "j.json", "--force"]).succeeds();
    place.json("j.json")["cables"][0]["after"]["rms_n"].as_f64().unwrap()
}

#[test]
fn a_seed_is_a_log() {
    let place = Place::empty();
    place.write("robot.toml", example_robot());
    let log = |seed| simulated(&place, &["--duration", "0.05", "--seed", seed]);
    let first = log("1");
    assert!(log("1") == first);
    assert!(log("2") != first);
    assert!(simulated(&place, &["--duration", "0.05"]) == log("0"));
    assert!(simulated(&place, &["--duration", "0.05", "--seed", "1", "--sensor-noise-n", "0.1"]) != first);
    assert!(simulated(&place, &["--duration", "0.05", "--seed", "1", "--mu-spread-ratio", "0.1"]) != first);
}

#[test]
fn hidden_effects_are_in_the_log_and_not_in_its_robot() {
    let place = Place::empty();
    place.write("robot.toml", bench_robot());
    let options = ["--duration", "6", "--sensor-noise-n", "0", "--reference-noise-n", "0"];
    let plain = simulated(&place, &options);
    let plain_error_n = error_after(&place);
    for effect in ["stribeck:ratio=0.5,velocity_m_per_s=0.02", "time_delay:delay_s=0.02"] {
        let log = simulated(&place, &[&options[..], &["--effect", effect]].concat());
        assert!(log != plain, "{effect}");
        assert_eq!(super::logs::attached_robot(&log), bench_robot());
        let error_n = error_after(&place);
        assert!(error_n > 2.0 * plain_error_n, "{effect}: {error_n} N, without it {plain_error_n} N");
    }
    let run = place.run(&[
        "simulate",
        "--model",
        "robot.toml",
        "-o",
        "told.mcap",
        "--duration",
        "0.01",
        "--seed",
        "7",
        "--effect",
        "stribeck:ratio=0.5,velocity_m_per_s=0.02",
    ]);
    assert!(run.stdout.contains("10 cycles, seed 7") && run.stdout.contains("stribeck"), "{run:#?}");
}

#[test]
fn what_spoils_a_log_is_in_it_and_told() {
    let place = Place::empty();
    place.write("robot.toml", bench_robot());
    let options = ["--duration", "6", "--sensor-noise-n", "0", "--reference-noise-n", "0"];
    let plain = simulated(&place, &options);
    let plain_error_n = error_after(&place);
    for spoilt in [
        ["--disturbance", "hum:amplitude_n=0.12,frequency_hz=50"],
        ["--disturbance", "step:shift_n=0.2,interval_s=2,length_s=1"],
        ["--sensor-wander-n", "0.02"],
        ["--reference-wander-n", "0.02"],
        ["--length-noise-m", "1e-5"],
        ["--length-resolution-m", "1e-4"],
    ] {
        assert!(simulated(&place, &[&options[..], &spoilt].concat()) != plain, "{spoilt:?}");
        let error_n = error_after(&place);
        assert!(error_n > 2.0 * plain_error_n, "{spoilt:?}: {error_n} N, without it {plain_error_n} N");
    }
    // A hand alone is no disagreement of the model.
    assert!(simulated(&place, &[&options[..], &["--hand-n", "1"]].concat()) != plain);
    assert!(error_after(&place) < 2.0 * plain_error_n);
    let start = ["simulate", "--model", "robot.toml", "-o", "told.mcap", "--duration", "0.01"];
    let run = place.run(&[&start[..], &["--disturbance", "hum:amplitude_n=0.12"]].concat());
    assert!(run.stdout.contains("hidden: hum:amplitude_n=0.12"), "{run:#?}");
}

#[test]
fn simulated_noise_is_what_is_left() {
    let place = Place::empty();
    place.write("robot.toml", example_robot());
    simulated(&place, &["--duration", "1"]);
    // Half of the sensor's 0.02 N behind the pulley of 180°, and 0.01 N of the reference.
    let noise_n = 0.01_f64.hypot(0.01);
    let error_n = error_after(&place);
    assert!((0.9..1.2).contains(&(error_n / noise_n)), "{error_n} N");
}

/// One winch on a bench: a cable with fixed wraps.
pub fn bench_robot() -> String {
    "format = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.001\n\n[[cable]]\nname = 'winch'\n\
     pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]\n\
     friction = { mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.2 }\n"
        .to_owned()
}

#[test]
fn a_bench_of_one_cable_without_geometry_works() {
    let place = Place::empty();
    place.write("robot.toml", bench_robot());
    simulated(&place, &["--duration", "0.5"]);
    let replay = place.run(&["replay", "log.mcap", "-o", "out.mcap", "--json", "j.json"]).succeeds();
    assert!(replay.stdout.contains("winch") && !replay.stdout.contains("torque"), "{replay:#?}");
    let result = place.json("j.json");
    assert!(result.get("wrench").is_none(), "{result}");
    assert_eq!(result["cables"][0]["flagged"], 0);
    let (before, after) = (&result["cables"][0]["before"]["rms_n"], &result["cables"][0]["after"]["rms_n"]);
    assert!(after.as_f64().unwrap() < before.as_f64().unwrap(), "{result}");
    let topics = |topic| super::logs::on_topic(&place.read("out.mcap"), topic, |_| ()).len();
    assert_eq!((topics("/fric/cable_forces"), topics("/fric/wrench"), topics("/fric/status")), (500, 0, 500));
    let info = place.run(&["info", "log.mcap"]).succeeds();
    let wrench = info.stdout.lines().find(|line| line.contains("replay: wrench")).unwrap();
    assert!(wrench.contains("impossible") && wrench.contains("no geometry"), "{info:#?}");
}

/// A robot with cables spread around an octagon, above and below in turn.
fn robot_with(cables: usize) -> String {
    let mut text = "format = 'fric-robot/1'\nname = 'many'\ncycle_s = 0.001\n[platform]\nmass_kg = 1.0\n".to_owned();
    for number in 0..cables {
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        let (sin, cos) = (2.4 * number as f64).sin_cos();
        let up = if number % 2 == 0 { 1.0 } else { -1.0 };
        write!(
            text,
            "[[cable]]\nname = 'c{number}'\nbase_m = [{:.4}, {:.4}, {:.4}]\nplatform_m = [{:.4}, {:.4}, {:.4}]\n\
             pulleys = [{{ wrap_deg = 180.0, sensor = true }}, {{ wrap = 'pose', radius_m = 0.01, axis = [0.0, 0.0, {up}] }}]\n\
             friction = {{ mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.1 }}\n",
            cos, sin, 0.7 * up, 0.08 * cos, 0.08 * sin, -0.05 * up,
        )
        .unwrap();
    }
    text
}

#[test]
fn robots_of_all_sizes_work() {
    for cables in [1, 3, 9, 17] {
        let place = Place::empty();
        place.write("robot.toml", robot_with(cables));
        let run = place.run(&["simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "0.2"]);
        if cables < 6 {
            run.warns(&["cannot hold the platform"])
        } else {
            run.succeeds()
        };
        let run = place.run(&["replay", "log.mcap", "-o", "out.mcap", "--json", "j.json"]).succeeds();
        let result = place.json("j.json");
        assert_eq!(result["cables"].as_array().unwrap().len(), cables, "{run:#?}");
        assert!(result.get("wrench").is_some(), "{cables} cables: {result}");
        let forces = super::logs::on_topic(&place.read("out.mcap"), "/fric/cable_forces", super::cdr::joint_state);
        assert!(forces.iter().all(|state| state.effort.len() == cables), "{cables} cables");
        place.run(&["info", "log.mcap"]).succeeds();
    }
}

#[test]
fn a_platform_that_its_cables_cannot_hold_is_warned_of() {
    let place = Place::empty();
    // Two cables of many; and all of them at one height.
    place.write("robot.toml", robot_with(2));
    let run = place.run(&["simulate", "--model", "robot.toml", "-o", "two.mcap", "--duration", "0.05"]);
    run.warns(&["cannot hold the platform in 50 of 50 cycles", " N at ", "] m", "guide", "`base_m`", "`mass_kg`"]);
    place.write("robot.toml", robot_with(8).replace(", 0.7000]", ", 2.0]").replace(", -0.7000]", ", 2.0]"));
    let run = place.run(&["simulate", "--model", "robot.toml", "-o", "level.mcap", "--duration", "0.05"]);
    run.warns(&["at one height", "`base_m`"]);
}

#[test]
fn more_cables_than_can_be_are_told() {
    let place = Place::empty();
    place.write("robot.toml", robot_with(65));
    let arguments = ["simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "0.1"];
    let run = place.run(&arguments);
    if run.code == Some(0) {
        place.run_in_vain(&["replay", "log.mcap", "-o", "out.mcap"]).fails(1, &["`cable`", "65", "64"]);
    } else {
        run.fails(1, &["65", "64"]);
    }
}
