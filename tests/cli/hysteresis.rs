//! `hysteresis`: the table of a simulated crossing run, and logs that do not show any.

use std::sync::OnceLock;

use serde_json::Value;

use super::logs::without;
use super::simulate::bench_robot;
use super::support::{Place, short_log, slow_robot};

/// The log of a crossing run, made once.
fn crossing_log() -> &'static [u8] {
    static LOG: OnceLock<Vec<u8>> = OnceLock::new();
    LOG.get_or_init(|| {
        let place = Place::empty();
        place.write("robot.toml", slow_robot());
        let arguments = ["simulate", "--model", "robot.toml", "-o", "log.mcap", "--run", "crossing", "--seed", "3"];
        place.run(&[&arguments[..], &["--mu-spread-ratio", "0.1"]].concat()).succeeds();
        place.read("log.mcap")
    })
}

fn place_with(log: &[u8]) -> Place {
    let place = Place::empty();
    place.write("log.mcap", log);
    place
}

fn axis<'a>(result: &'a Value, name: &str) -> &'a Value {
    result["axes"].as_array().unwrap().iter().find(|axis| axis["axis"] == name).unwrap()
}

#[test]
fn the_table_is_that_of_the_paper() {
    let place = place_with(crossing_log());
    let run = place.run(&["hysteresis", "log.mcap", "--json", "j.json"]).succeeds();
    let result = place.json("j.json");
    assert_eq!((&result["format"], &result["robot"]), (&"fric-hysteresis/1".into(), &"mini-ipanema".into()));
    let names: Vec<&str> =
        result["axes"].as_array().unwrap().iter().map(|axis| axis["axis"].as_str().unwrap()).collect();
    assert_eq!(names, ["x", "y", "z", "a", "b", "c"]);
    for name in names {
        let axis = axis(&result, name);
        println!("{axis}");
        assert_eq!(axis["unit"], if "xyz".contains(name) { "N" } else { "Nm" });
        assert_eq!((&axis["passes"], &axis["applied_subtracted"]), (&8.into(), &true.into()));
        let width = |when: &str| axis[when]["width"].as_f64().unwrap();
        let lasting_ratio = axis["lasting_ratio"].as_f64().unwrap();
        assert!((lasting_ratio - width("with") / width("without")).abs() < 1e-12);
        assert!(lasting_ratio < 0.15, "{axis}");
        assert!(axis["without"]["standard_error"].as_f64().unwrap() < 0.1 * width("without"), "{axis}");
        let row = run.stdout.lines().find(|line| line.trim_start().starts_with(&format!("{name} ["))).unwrap();
        assert!(row.contains(&format!("{:.4}", width("without"))) && row.contains(" %"), "{row}");
    }
    assert!(run.stdout.contains("at (0.000, 0.000, 0.000) m"), "{run:#?}");
    assert!(run.stdout.contains("outside wrench is taken off") && !run.stdout.contains("Not crossed"), "{run:#?}");
}

#[test]
fn without_the_wrench_of_the_log_gravity_does_not_count_either() {
    let place = place_with(&without(crossing_log(), &["/platform_wrench", "/reference_forces"]));
    let run = place.run(&["hysteresis", "log.mcap", "--json", "j.json"]).succeeds();
    assert!(run.stdout.contains("outside wrench is not known"), "{run:#?}");
    let result = place.json("j.json");
    for name in ["x", "y", "z"] {
        assert!(axis(&result, name)["lasting_ratio"].as_f64().unwrap() < 0.15, "{result}");
        assert_eq!(axis(&result, name)["applied_subtracted"], false);
    }
}

#[test]
fn axes_that_are_not_crossed_are_named() {
    let place = Place::empty();
    place.write("robot.toml", slow_robot());
    let simulate = ["simulate", "--model", "robot.toml", "-o", "log.mcap", "--run", "crossing", "--duration", "32"];
    place.run(&simulate).succeeds();
    let run = place.run(&["hysteresis", "log.mcap", "--json", "-"]);
    assert_eq!(run.code, Some(0), "{run:#?}");
    assert!(run.stderr.contains("Not crossed: z, a, b, c. Record"), "{run:#?}");
    let result: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((&axis(&result, "z")["passes"], axis(&result, "z").get("without")), (&0.into(), None));
    assert!(axis(&result, "x")["passes"].as_u64() > Some(4) && axis(&result, "y")["passes"].as_u64() > Some(4));
}

#[test]
fn logs_without_a_hysteresis_are_told() {
    let refused = |log: &[u8]| place_with(log).run_in_vain(&["hysteresis", "log.mcap", "--json", "j.json"]);
    refused(&without(crossing_log(), &["/platform_pose"])).fails(1, &["no pose"]).advises(&["`pose`"]);
    refused(short_log()).fails(1, &["does not move"]).advises(&["to and fro"]);
    let place = Place::empty();
    place.write("robot.toml", bench_robot());
    place.run(&["simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "0.1"]).succeeds();
    place.run_in_vain(&["hysteresis", "log.mcap"]).fails(1, &["winch", "`base_m`"]).advises(&["both"]);
    let crossing = ["simulate", "--model", "robot.toml", "-o", "new.mcap", "--run", "crossing"];
    place.run_in_vain(&crossing).fails(1, &["crossing run needs a platform", "winch"]).advises(&["identification"]);
}

#[test]
fn outputs_and_command_lines_are_checked() {
    let place = place_with(crossing_log());
    place.write("old", "kept");
    place.run_in_vain(&["hysteresis"]).fails(2, &["required arguments"]);
    place.run_in_vain(&["hysteresis", "log.mcap", "--json", "old"]).fails(1, &["old exists"]).advises(&["--force"]);
    place.run_in_vain(&["hysteresis", "log.mcap", "--json", "log.mcap", "--force"]).fails(1, &["log.mcap is an input"]);
    place.run_in_vain(&["hysteresis", "none.mcap"]).fails(1, &["none.mcap"]);
    let simulate = ["simulate", "--model", "robot.toml", "-o", "new.mcap", "--run", "idling"];
    place.run_in_vain(&simulate).fails(2, &["idling", "crossing"]);
}
