//! `discover`: what it finds, what it gives people, machines and the next command, and what it refuses.

use std::sync::OnceLock;

use serde_json::Value;

use super::cdr::joint_state;
use super::logs::{on_topic, with_data, without, without_reference_of};
use super::replay::shape;
use super::report::{assert_self_contained, without_scripts};
use super::simulate::bench_robot;
use super::support::{Place, Run, rms};

/// A bench of two cables; their friction is near what a simulation with it has.
pub fn two_cables() -> String {
    let second = bench_robot().split_once("[[cable]]").unwrap().1.replace("'winch'", "'other'");
    format!("# The bench in the cellar.\n{}\n[[cable]]{second}", bench_robot())
}

/// A log of the two cables, whose friction falls with speed, which the robot file does not say.
pub fn hidden_stribeck() -> &'static [u8] {
    static LOG: OnceLock<Vec<u8>> = OnceLock::new();
    LOG.get_or_init(|| {
        let effect = ["--duration", "25", "--seed", "3", "--effect", "stribeck:ratio=0.6,velocity_m_per_s=0.03"];
        simulated(&two_cables(), &effect)
    })
}

fn simulated(robot: &str, options: &[&str]) -> Vec<u8> {
    let place = Place::empty();
    place.write("robot.toml", robot);
    place.run(&[&["simulate", "--model", "robot.toml", "-o", "log.mcap"], options].concat()).succeeds();
    place.read("log.mcap")
}

/// A place with this log.
fn with(log: impl AsRef<[u8]>) -> Place {
    let place = Place::empty();
    place.write("log.mcap", log);
    place
}

fn discover(place: &Place, arguments: &[&str]) -> Run {
    place.run(
        &[&["discover", "log.mcap"], arguments, &["-o", "extended.toml", "--json", "found.json", "--force"]].concat(),
    )
}

/// What is found on the two cables, looked at once.
fn found() -> &'static (Place, Run, Value) {
    static FOUND: OnceLock<(Place, Run, Value)> = OnceLock::new();
    FOUND.get_or_init(|| {
        let place = with(hidden_stribeck());
        let run = discover(&place, &["--report", "report.html"]).succeeds();
        let result = place.json("found.json");
        (place, run, result)
    })
}

fn cables(result: &Value) -> &[Value] {
    result["cables"].as_array().unwrap()
}

#[test]
fn the_hidden_effect_is_named_and_added() {
    let (place, run, result) = found();
    for cable in cables(result) {
        assert_eq!(cable["verdict"], "extended", "{cable}");
        let [effect] = cable["effects"].as_array().unwrap().as_slice() else { panic!("{cable}") };
        assert_eq!(effect["kind"], "stribeck");
        for (key, truth) in [("ratio", 0.6), ("velocity_m_per_s", 0.03)] {
            let (value, error) = (effect["parameters"][key].as_f64().unwrap(), &effect["standard_errors"][key]);
            assert!((value - truth).abs() < 4.0 * error.as_f64().unwrap(), "{effect}");
        }
        assert!(effect["evidence"]["delta_bic"].as_f64().unwrap() < -100.0, "{effect}");
        let rms_n = |when: &str| cable[when]["rms_n"].as_f64().unwrap();
        let floor_n = cable["noise_floor_n"].as_f64().unwrap();
        assert!(rms_n("after") < 1.05 * floor_n && rms_n("before") > 1.2 * floor_n, "{cable}");
        let closed = 1.0 - (rms_n("after") - floor_n) / (rms_n("before") - floor_n);
        assert!((cable["gap_closed"].as_f64().unwrap() - closed).abs() < 1e-12, "{cable}");
        assert_eq!(effect["gap_closed"], cable["gap_closed"]);
        assert_eq!(effect["evidence"]["held_out_rms_n"], cable["after"]["rms_n"]);
        let name = cable["name"].as_str().unwrap();
        let row: Vec<&str> =
            run.stdout.lines().map(str::trim).find(|line| line.starts_with(name)).unwrap().split_whitespace().collect();
        assert_eq!(row[1..3], ["extended", "stribeck"], "{run:#?}");
        assert_eq!(row[3..6], [floor_n, rms_n("before"), rms_n("after")].map(|number| format!("{number:.4}")));
    }
    let common = &result["common_effects"][0];
    assert_eq!((&common["kind"], common["cables"].as_array().unwrap().len()), (&Value::from("stribeck"), 2));
    assert!(run.stdout.contains("stribeck on both cables: ratio 0."), "{run:#?}");
    for words in ["lubricant film", "check the grease", "next best would be"] {
        assert!(run.stdout.contains(words), "{words} {run:#?}");
    }
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 80), "too wide for a terminal: {run:#?}");
    let extended = String::from_utf8(place.read("extended.toml")).unwrap();
    assert!(extended.starts_with("# The bench in the cellar.\n"), "{extended}");
    assert_eq!(extended.matches("effects = [ { kind = \"stribeck\", ratio = 0.").count(), 2, "{extended}");
}

#[test]
fn the_keys_are_those_of_the_format() {
    const KEYS: [&str; 40] = [
        ".cables[].after.mae_n",
        ".cables[].after.rms_n",
        ".cables[].before.mae_n",
        ".cables[].before.rms_n",
        ".cables[].candidates[].delta_bic",
        ".cables[].candidates[].held_out_rms_n",
        ".cables[].candidates[].kind",
        ".cables[].effects[].evidence.delta_bic",
        ".cables[].effects[].evidence.held_out_rms_n",
        ".cables[].effects[].gap_closed",
        ".cables[].effects[].kind",
        ".cables[].effects[].parameters.ratio",
        ".cables[].effects[].parameters.velocity_m_per_s",
        ".cables[].effects[].runner_up.as_good",
        ".cables[].effects[].runner_up.delta_bic",
        ".cables[].effects[].runner_up.held_out_rms_n",
        ".cables[].effects[].runner_up.kind",
        ".cables[].effects[].standard_errors.ratio",
        ".cables[].effects[].standard_errors.velocity_m_per_s",
        ".cables[].gap_closed",
        ".cables[].held_out_s[][]",
        ".cables[].held_out_samples[][]",
        ".cables[].left_out.flagged",
        ".cables[].left_out.outliers",
        ".cables[].left_out.warm_up",
        ".cables[].left_out.without_reference",
        ".cables[].missing",
        ".cables[].name",
        ".cables[].noise_floor_n",
        ".cables[].parameters.mu",
        ".cables[].parameters.stribeck.ratio",
        ".cables[].samples",
        ".cables[].unexplained",
        ".cables[].verdict",
        ".cables[].wander_n",
        ".format",
        ".log[]",
        ".log_start_s[]",
        ".robot",
        ".common_effects[].kind",
    ];
    let (_, _, result) = found();
    let shape = shape(result);
    for key in KEYS {
        assert!(shape.iter().any(|of| of == key), "no {key} in {shape:#?}");
    }
    assert_eq!((&result["format"], &result["robot"]), (&"fric-discover/1".into(), &"bench".into()));
    assert_eq!(result["log"], serde_json::json!(["log.mcap"]));
    for cable in cables(result) {
        for place in cable["where"].as_array().unwrap() {
            for key in ["signal", "from", "to", "unit", "share_of_excess", "intervals_s"] {
                assert!(!place[key].is_null(), "{key} {place}");
            }
        }
    }
}

/// The figures belong to the file: its forces, less the references, over the samples held out.
#[test]
fn a_replay_with_the_extended_file_has_the_errors_after_to_the_last_digit() {
    let (place, _, result) = found();
    place.run(&["replay", "log.mcap", "--model", "extended.toml", "-o", "replayed.mcap", "--force"]).succeeds();
    let forces = on_topic(&place.read("replayed.mcap"), "/fric/cable_forces", joint_state);
    let references = on_topic(hidden_stribeck(), "/reference_forces", joint_state);
    for (index, cable) in cables(result).iter().enumerate() {
        let ranges: Vec<[usize; 2]> = serde_json::from_value(cable["held_out_samples"].clone()).unwrap();
        let deviations = ranges.iter().flat_map(|[from, to]| *from..*to).map(|sample| {
            assert_eq!(forces[sample].stamp_nanos, references[sample].stamp_nanos);
            forces[sample].effort[index] - references[sample].effort[index]
        });
        assert_eq!(rms(deviations).to_bits(), cable["after"]["rms_n"].as_f64().unwrap().to_bits(), "{}", cable["name"]);
    }
}

/// Position of the winch, and friction between winch and platform, in each cycle of one cable.
fn hysteresis_loop(log: &[u8], cable: usize) -> Vec<[f64; 2]> {
    let states = on_topic(log, "/cable_states", joint_state);
    let references = on_topic(log, "/reference_forces", joint_state);
    let points = states.iter().zip(&references);
    points.map(|(state, reference)| [state.position[cable], state.effort[cable] - reference.effort[cable]]).collect()
}

/// The same motion and the same noise, once more with the extended file and once with the given one.
#[test]
fn a_simulation_with_the_extended_file_goes_through_the_hysteresis_loop_of_the_log() {
    let (place, _, result) = found();
    let motion = ["--duration", "25", "--seed", "3"];
    let extended = simulated(&String::from_utf8(place.read("extended.toml")).unwrap(), &motion);
    let given = simulated(&two_cables(), &motion);
    for (index, cable) in cables(result).iter().enumerate() {
        let points = hysteresis_loop(hidden_stribeck(), index);
        let off_n = |log: &[u8]| {
            let others = hysteresis_loop(log, index);
            rms(points.iter().zip(&others).map(|([position_m, friction_n], [other_m, other_n])| {
                assert_eq!(position_m.to_bits(), other_m.to_bits());
                other_n - friction_n
            }))
        };
        let (extended_n, given_n) = (off_n(&extended), off_n(&given));
        let floor_n = cable["noise_floor_n"].as_f64().unwrap();
        assert!(extended_n < 0.3 * floor_n && given_n > 2.0 * floor_n, "{extended_n} {given_n} {floor_n}");
    }
}

#[test]
fn the_page_is_self_contained() {
    let (place, _, result) = found();
    let page = String::from_utf8(place.read("report.html")).unwrap();
    assert_self_contained(&page.replace("href=\"#", ""));
    assert!(page.len() < 3_000_000);
    for cable in cables(result) {
        assert!(page.contains(cable["name"].as_str().unwrap()));
        for when in ["before", "after"] {
            assert!(page.contains(&format!("{:.4} N", cable[when]["rms_n"].as_f64().unwrap())));
        }
        for candidate in cable["candidates"].as_array().unwrap() {
            assert!(page.contains(candidate["kind"].as_str().unwrap()), "{candidate}");
        }
    }
    assert!(page.contains("prefers-color-scheme: dark") && page.contains("@media print"));
}

#[test]
fn names_are_text_and_no_markup() {
    let place = Place::empty();
    let robot =
        two_cables().replace("'winch'", r#"'<b>&"w<script>alert(1)</script>'"#).replace("'bench'", "'<i>rig</i>'");
    place.write("robot.toml", robot);
    place.run(&["simulate", "--model", "robot.toml", "-o", "<u>&.mcap", "--duration", "12"]).succeeds();
    place.run(&["discover", "<u>&.mcap", "-o", "extended.toml", "--report", "report.html"]).succeeds();
    let page = String::from_utf8(place.read("report.html")).unwrap();
    assert_self_contained(&page.replace("href=\"#", ""));
    let (page, _) = without_scripts(&page);
    for markup in ["<b>", "<i>", "<u>", "alert(1)<", "&\""] {
        assert!(!page.contains(markup), "{markup}");
    }
    assert!(page.contains("&lt;b&gt;&amp;&quot;w") && page.contains("&lt;u&gt;&amp;.mcap"), "the names are there");
}

#[test]
fn a_log_that_lacks_nothing_is_complete() {
    let place = with(simulated(&bench_robot(), &["--duration", "20", "--seed", "5"]));
    let run = discover(&place, &[]).succeeds();
    let cable = &place.json("found.json")["cables"][0];
    assert_eq!(cable["verdict"], "complete", "{cable}");
    assert_eq!(
        (&cable["effects"], &cable["unexplained"], &cable["gap_closed"]),
        (&serde_json::json!([]), &Value::Null, &Value::Null)
    );
    assert!(run.stdout.contains("Nothing is missing"), "{run:#?}");
    assert!(!String::from_utf8(place.read("extended.toml")).unwrap().contains("effects"));
}

/// The log with what is made of the effort of the first entry in each message of a topic: the last numbers of the message.
fn with_first_effort(log: &[u8], topic: &str, change: impl Fn(usize, f64) -> f64) -> Vec<u8> {
    let count = std::cell::Cell::new(0);
    with_data(log, topic, |data| {
        let mut data = data.to_vec();
        let entries = joint_state(&data).effort.len();
        let at = data.len() - 8 * entries;
        let number = f64::from_le_bytes(data[at..at + 8].try_into().unwrap());
        data[at..at + 8].copy_from_slice(&change(count.get(), number).to_le_bytes());
        count.set(count.get() + 1);
        data
    })
}

#[test]
fn a_sensor_that_stood_still_is_placed_in_time() {
    let log = simulated(&bench_robot(), &["--duration", "20", "--seed", "6"]);
    let held = std::cell::Cell::new(0.0);
    let place = with(with_first_effort(&log, "/cable_states", |sample, force_n| {
        if !(12_000..12_800).contains(&sample) {
            held.set(force_n);
        }
        held.get()
    }));
    let run = discover(&place, &[]).succeeds();
    let cable = &place.json("found.json")["cables"][0];
    assert_eq!((&cable["verdict"], &cable["effects"]), (&"complete".into(), &serde_json::json!([])), "{cable}");
    let fault = &cable["faults"][0];
    assert_eq!((&fault["kind"], &fault["parameters"]), (&"frozen".into(), &serde_json::json!({})));
    let interval_s = &fault["intervals_s"][0];
    assert!((interval_s[0].as_f64().unwrap() - 12.0).abs() < 0.01, "{fault}");
    assert!((interval_s[1].as_f64().unwrap() - 12.8).abs() < 0.01, "{fault}");
    assert!(run.stdout.contains("the force sensor stands still at 12.0…12.8 s"), "{run:#?}");
}

#[test]
fn hum_is_given_its_frequency() {
    let log = simulated(&bench_robot(), &["--duration", "20", "--seed", "7"]);
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let hum_n = |sample: usize| 0.05 * (std::f64::consts::TAU * 50.0 * sample as f64 * 1e-3).sin();
    let place = with(with_first_effort(&log, "/reference_forces", |sample, force_n| force_n + hum_n(sample)));
    let run = discover(&place, &[]).succeeds();
    let cable = &place.json("found.json")["cables"][0];
    assert_eq!((&cable["verdict"], &cable["effects"]), (&"complete".into(), &serde_json::json!([])), "{cable}");
    let fault = &cable["faults"][0];
    assert_eq!((&fault["kind"], &fault["intervals_s"]), (&"hum".into(), &serde_json::json!([])));
    assert!((fault["parameters"]["frequency_hz"].as_f64().unwrap() - 50.0).abs() < 0.05, "{cable}");
    assert!((fault["parameters"]["amplitude_n"].as_f64().unwrap() - 0.05).abs() < 0.002, "{cable}");
    assert_eq!(cable["where"][0]["signal"], "frequency");
    assert!(run.stdout.contains("hums at 50.0"), "{run:#?}");
}

/// Looks in vain.
fn refused(place: &Place, arguments: &[&str]) -> Run {
    let outputs = ["-o", "extended.toml", "--json", "found.json", "--report", "report.html"];
    place.run_in_vain(&[&["discover", "log.mcap"], arguments, &outputs].concat())
}

#[test]
fn what_a_log_lacks_is_told_and_no_name_made_up() {
    let log = hidden_stribeck();
    let run = refused(&with(without(log, &["/reference_forces"])), &[]);
    // A bench of one cable has no wrench to compare with.
    run.fails(1, &["no reference forces on /reference_forces"])
        .advises(&["`reference` under `[log]`", "force sensors at the platform"]);
    let bench = simulated(&bench_robot(), &["--duration", "10", "--seed", "4"]);
    let place = with(with_first_effort(&bench, "/reference_forces", |_, _| f64::NAN));
    refused(&place, &[]).fails(1, &["no reference force"]).advises(&["force sensors at the platform"]);
    let short = simulated(&bench_robot(), &["--duration", "2"]);
    refused(&with(short), &[]).fails(1, &["2.0 s", "8 s are needed"]).advises(&["longer", "fric-cli excite"]);
}

/// Positions and speeds of another motion in place of those of a log.
fn moved(log: &[u8], position_and_speed: impl Fn(usize) -> [f64; 2]) -> Vec<u8> {
    let count = std::cell::Cell::new(0);
    with_data(log, "/cable_states", |data| {
        let mut data = data.to_vec();
        // Three lists of one number each, with a length before each and padding to eight bytes.
        let effort = data.len() - 8;
        let [position, speed] = position_and_speed(count.get());
        for (at, number) in [(effort - 32, position), (effort - 16, speed)] {
            data[at..at + 8].copy_from_slice(&number.to_le_bytes());
        }
        count.set(count.get() + 1);
        let state = joint_state(&data);
        assert_eq!((state.position[0], state.velocity[0]), (position, speed));
        data
    })
}

#[test]
#[expect(clippy::cast_precision_loss, reason = "a count of samples")]
fn motion_that_tells_nothing_is_told() {
    let log = simulated(&bench_robot(), &["--duration", "12", "--seed", "4"]);
    let place = with(moved(&log, |sample| [1.0 + 1e-5 * sample as f64, 0.01]));
    refused(&place, &[]).fails(1, &["winch", "never reverses"]).advises(&["both directions", "fric-cli excite"]);
    refused(&with(moved(&log, |_| [1.0, 0.0])), &[]).fails(1, &["winch never changes"]).advises(&["both directions"]);
    let trembling = |sample: usize| [1.0 + 1e-7 * (sample % 2) as f64, 0.0];
    refused(&with(moved(&log, trembling)), &[]).fails(1, &["it rests"]).advises(&["longer strokes"]);
}

#[test]
fn a_cable_that_cannot_be_told_keeps_its_values() {
    let place = with(without_reference_of(hidden_stribeck(), "other"));
    let run = discover(&place, &["--report", "report.html"]).succeeds();
    let result = place.json("found.json");
    let [winch, other] = cables(&result) else { panic!("{result}") };
    assert_eq!(winch["effects"], cables(&found().2)[0]["effects"]);
    assert_eq!(
        (&other["verdict"], &other["before"], &other["effects"]),
        (&Value::Null, &Value::Null, &serde_json::json!([]))
    );
    assert!(other["missing"]["cause"].as_str().unwrap().contains("no reference forces"), "{other}");
    assert!(run.stdout.contains("other: Nothing can be told: the log has no reference forces"), "{run:#?}");
    let extended = String::from_utf8(place.read("extended.toml")).unwrap();
    let (_, rest) = extended.split_once("'other'").unwrap();
    assert_eq!(rest, two_cables().split_once("'other'").unwrap().1);
}

#[test]
fn without_an_output_it_only_tells_and_with_one_says_what_is_next() {
    let place = with(hidden_stribeck());
    place.write("robot.toml", two_cables());
    let run = place.run(&["discover", "log.mcap"]).succeeds();
    assert!(run.stdout.contains("lacks stribeck") && run.stdout.contains("Nothing is written"), "{run:#?}");
    let run = place.run(&["discover", "log.mcap", "-o", "extended.toml"]).succeeds();
    assert!(run.stdout.contains("Next: fric-cli replay log.mcap --model extended.toml"), "{run:#?}");
}

#[test]
fn command_lines_and_outputs_that_are_wrong_are_told() {
    let place = with(hidden_stribeck());
    place.write("robot.toml", two_cables());
    place.write("old", "kept");
    place.run_in_vain(&["discover", "log.mcap", "-o", "x", "--raport", "r.html"]).fails(2, &["--raport", "--report"]);
    place.run_in_vain(&["discover", "log.mcap", "./log.mcap", "-o", "x"]).fails(2, &["./log.mcap is named twice"]);
    place.run_in_vain(&["discover", "log.mcap", "-o", "x", "--report", "x"]).fails(2, &["named for two outputs"]);
    let over = |option: &str, output: &str| {
        let output = if option == "-o" { vec!["-o", output] } else { vec!["-o", "new", option, output] };
        place.run_in_vain(&[&["discover", "log.mcap", "--model", "robot.toml"], &output[..]].concat())
    };
    for option in ["-o", "--report", "--json"] {
        over(option, "old").fails(1, &["old exists already"]).advises(&["--force"]);
        over(option, "log.mcap").fails(1, &["log.mcap is an input"]);
        over(option, "./robot.toml").fails(1, &["./robot.toml is an input"]);
    }
    place.run_in_vain(&["discover", "robot.toml", "-o", "x"]).fails(1, &["not an MCAP recording"]);
}

#[test]
fn several_logs_are_looked_at_together() {
    let effect = ["--duration", "10", "--seed", "8", "--effect", "stribeck:ratio=0.6,velocity_m_per_s=0.03"];
    let place = with(simulated(&bench_robot(), &effect));
    place.write("more.mcap", simulated(&bench_robot(), &[&effect[..3], &["9"], &effect[4..]].concat()));
    discover(&place, &["more.mcap"]).succeeds();
    let result = place.json("found.json");
    assert_eq!(result["log"], serde_json::json!(["log.mcap", "more.mcap"]));
    assert_eq!(result["log_start_s"], serde_json::json!([0.0, 10.0]));
    assert_eq!(result["cables"][0]["effects"][0]["kind"], "stribeck", "{result}");
    let last = result["cables"][0]["held_out_s"].as_array().unwrap().last().unwrap()[1].as_f64().unwrap();
    assert!((10.0..20.01).contains(&last), "{last}");
}

/// A payload that nobody wrote down, seen by the weight alone: no sensor at the platform, no wrench in the log.
#[test]
fn a_wrong_mass_is_found_by_the_weight_and_written() {
    let robot = include_str!("../../examples/mini-ipanema.toml").replace("cycle_s = 0.001", "cycle_s = 0.004");
    let place = with(simulated(&robot, &["--duration", "16", "--seed", "7"]));
    let given = robot.replace("mass_kg = 0.41", "mass_kg = 0.45") + "\n[log]\nwrench = '/nothing'\n";
    place.write("robot.toml", &given);
    let run =
        discover(&place, &["--model", "robot.toml", "--reference", "wrench", "--report", "report.html"]).succeeds();
    let result = place.json("found.json");
    let gap = &result["wrench"];
    assert_eq!((gap["reference"].as_str(), gap["verdict"].as_str()), (Some("mass"), Some("extended")), "{gap}");
    let [wrong] = gap["geometry"].as_array().unwrap().as_slice() else { panic!("{gap}") };
    let mass_kg = wrong["parameters"]["mass_kg"].as_f64().unwrap();
    assert!(wrong["kind"] == "mass_kg" && (mass_kg - 0.41).abs() < 0.002, "{wrong}");
    assert!(gap["before"]["force_rms_n"].as_f64() > gap["after"]["force_rms_n"].as_f64(), "{gap}");
    for cable in cables(&result) {
        assert!(cable["effects"].as_array().unwrap().is_empty() && cable.get("before").is_none(), "{cable}");
    }
    assert!(run.stdout.contains("The robot file's mass_kg is wrong: mass_kg = 0.4"), "{}", run.stdout);
    assert!(String::from_utf8(place.read("extended.toml")).unwrap().contains(&format!("mass_kg = {mass_kg}")));
    let page = String::from_utf8(place.read("report.html")).unwrap();
    assert!(page.contains("The robot file's mass_kg is wrong"));
}

#[test]
fn what_hides_in_the_noise_of_a_short_log_is_told() {
    let effect = ["--duration", "15", "--seed", "2", "--effect", "stribeck:ratio=0.5,velocity_m_per_s=0.02"];
    let slow = bench_robot().replace("0.001", "0.004");
    let place = with(simulated(&slow, &effect));
    place.write("robot.toml", slow);
    let run = place.run(&["discover", "log.mcap", "--model", "robot.toml", "--json", "found.json"]).succeeds();
    let cable = place.json("found.json")["cables"][0].clone();
    assert_eq!((cable["verdict"].as_str(), cable["tried"][0]["kind"].as_str()), (Some("complete"), Some("stribeck")));
    assert!(cable["tried"][0]["evidence"]["delta_bic"].as_f64().unwrap() < -30.0, "{cable}");
    assert!(run.stdout.contains("A longer log would") && !run.stdout.contains("Nothing is missing"), "{}", run.stdout);
}

/// A sensor that nobody tared is named also where something else is left that has no name. A free function of the time holds a zero too, and a piece of cable
/// that rubs keeps the search busy.
#[test]
fn a_wrong_zero_is_named_beside_something_unknown() {
    for disturbance in
        ["warming:amplitude_n=0.08,period_s=17", "local_defect:drag_n=0.3,from_start_m=0.02,width_m=0.02"]
    {
        let place = Place::empty();
        place.write("robot.toml", include_str!("../../examples/winch.toml"));
        let simulate = ["simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "40", "--seed", "3"];
        let hidden = ["--effect", "sensor_offset:offset_n=1", "--disturbance", disturbance];
        place.run(&[&simulate[..], &hidden].concat()).succeeds();
        place.run(&["discover", "log.mcap", "--model", "robot.toml", "--json", "found.json"]).succeeds();
        let cable = &place.json("found.json")["cables"][0];
        let kinds: Vec<&str> =
            cable["effects"].as_array().unwrap().iter().map(|of| of["kind"].as_str().unwrap()).collect();
        assert_eq!(
            (kinds.first().copied(), cable["verdict"].as_str()),
            (Some("sensor_offset"), Some("unexplained")),
            "{cable}"
        );
        let offset_n = cable["effects"][0]["parameters"]["offset_n"].as_f64().unwrap();
        assert!((offset_n - 1.0).abs() < 0.1, "{disturbance}: {offset_n} N");
    }
}
