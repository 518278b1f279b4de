//! `fit`: what it identifies, and what it gives people, machines and the next command.

use std::sync::OnceLock;

use serde_json::Value;

use super::logs::{with_data, without, without_reference_of};
use super::replay::shape;
use super::simulate::bench_robot;
use super::support::{Place, Run, assert_close, example_robot, result_of, unwrapped};

/// A log of a robot, simulated; made once for each cell.
fn simulated(cell: &'static OnceLock<Vec<u8>>, robot: &str, options: &[&str]) -> &'static [u8] {
    cell.get_or_init(|| {
        let place = Place::empty();
        place.write("robot.toml", robot);
        place.run(&[&["simulate", "--model", "robot.toml", "-o", "log.mcap"], options].concat()).succeeds();
        place.read("log.mcap")
    })
}

/// Eight cables that hold a platform, at a lower rate than the example's: a fit to the wrench takes its time.
pub fn platform_robot() -> String {
    example_robot().replace("cycle_s = 0.001", "cycle_s = 0.004")
}

/// The start of its identification run, in which every parameter shows.
pub fn platform_log() -> &'static [u8] {
    static LOG: OnceLock<Vec<u8>> = OnceLock::new();
    simulated(&LOG, &platform_robot(), &["--duration", "10", "--seed", "3"])
}

/// One cable on a bench.
pub fn bench_log() -> &'static [u8] {
    static LOG: OnceLock<Vec<u8>> = OnceLock::new();
    simulated(&LOG, &bench_robot(), &["--duration", "10", "--seed", "4"])
}

/// The robot file as somebody would have it before the fit: guesses, remarks, a layout of its own.
const GUESSED: &str = "# The bench in the cellar.\nformat = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.001\n\n\
                       [[cable]]   # the only one\nname = 'winch'\npulleys = [{ wrap_deg = 180.0, sensor = true },\n    \
                       { wrap_deg = 90.0 }]  # as drawn\nfriction = { sigma_n_per_m = 300.0,   mu = 0.1 } # guessed\n\
                       # The end.\n";

/// A place with the bench's log, and the robot file of guesses.
fn bench() -> Place {
    let place = Place::empty();
    place.write("log.mcap", bench_log());
    place.write("guess.toml", GUESSED);
    place
}

/// Fits into `fitted.toml` and `fit.json`.
fn fit(place: &Place, arguments: &[&str]) -> Run {
    place.run(&[&["fit"], arguments, &["-o", "fitted.toml", "--json", "fit.json", "--force"]].concat())
}

const CABLE: [&str; 18] = [
    ".cables[].evaluations",
    ".cables[].left_out.flagged",
    ".cables[].left_out.outliers",
    ".cables[].left_out.warm_up",
    ".cables[].left_out.without_reference",
    ".cables[].name",
    ".cables[].parameters.mu",
    ".cables[].parameters.offset_n",
    ".cables[].parameters.sigma_n_per_m",
    ".cables[].parameters.viscous_n_s_per_m",
    ".cables[].samples",
    ".cables[].standard_errors.mu",
    ".cables[].standard_errors.offset_n",
    ".cables[].standard_errors.sigma_n_per_m",
    ".cables[].standard_errors.viscous_n_s_per_m",
    ".cables[].termination",
    ".format",
    ".reference",
];
const FORCES: [&str; 6] = [
    ".cables[].after.mae_n",
    ".cables[].after.rms_n",
    ".cables[].before.mae_n",
    ".cables[].before.rms_n",
    ".cables[].mean_reference_n",
    ".robot",
];
const WRENCH: [&str; 8] = [
    ".robot",
    ".wrench.after.force_rms_n",
    ".wrench.after.torque_rms_nm",
    ".wrench.before.force_rms_n",
    ".wrench.before.torque_rms_nm",
    ".wrench.held_out.force_rms_n",
    ".wrench.held_out.torque_rms_nm",
    ".wrench.reference",
];
/// Lists that are mostly empty, with what they hold.
const LISTS: [&str; 3] = [".cables[].undetermined[]", ".cables[].open[]", ".cables[].at_bound[]"];

/// Exactly these keys and no others; what the log does not determine is listed by name.
#[track_caller]
fn assert_shape(result: &Value, parts: &[&[&str]]) {
    let mut expected: Vec<&str> = parts.concat();
    expected.sort_unstable();
    let is_listed = |path: &String| LISTS.iter().any(|list| path.starts_with(list));
    let found: Vec<String> = shape(result).into_iter().filter(|path| !is_listed(path)).collect();
    assert_eq!(found, expected);
    assert_eq!(result["format"], "fric-fit/1");
    for cable in result["cables"].as_array().unwrap() {
        assert!(["undetermined", "open", "at_bound"].iter().all(|list| cable[list].is_array()), "{cable}");
    }
}

/// The number behind `key` after `start`, as the text has it: to the bit.
#[track_caller]
fn number_in(text: &str, start: &str, key: &str) -> f64 {
    let (_, rest) = text.split_once(start).unwrap();
    let (_, rest) = rest.split_once(key).unwrap();
    let number: String = rest
        .trim_start_matches(['"', ' ', ':', '='])
        .chars()
        .take_while(|letter| letter.is_ascii_digit() || "+-.e".contains(*letter))
        .collect();
    number.parse().unwrap()
}

/// Cells of the first row of each table that starts with `name`.
fn rows<'a>(table: &'a str, name: &str) -> Vec<Vec<&'a str>> {
    let all = table.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    all.filter(|row| row.first() == Some(&name)).collect()
}

#[test]
fn the_robot_file_written_has_the_values_of_the_json_and_is_otherwise_untouched() {
    let place = bench();
    let run = fit(&place, &["log.mcap", "--model", "guess.toml"]).succeeds();
    assert_shape(&place.json("fit.json"), &[&CABLE, &FORCES]);
    let (fitted, json) =
        (String::from_utf8(place.read("fitted.toml")).unwrap(), String::from_utf8(place.read("fit.json")).unwrap());
    for (key, truth, tolerance) in
        [("mu", 0.02, 2e-4), ("sigma_n_per_m", 1000.0, 20.0), ("viscous_n_s_per_m", 0.2, 0.02), ("offset_n", 0.0, 2e-3)]
    {
        let value = number_in(&json, "\"parameters\"", key);
        assert_eq!(number_in(&fitted, "friction", key).to_bits(), value.to_bits(), "{key}: {fitted} {json}");
        assert!((value - truth).abs() < tolerance, "{key} is {value}");
        let error = number_in(&json, "\"standard_errors\"", key);
        assert!(error > 0.0 && (value - truth).abs() < 5.0 * error, "{key} is {value} ± {error}");
    }
    let is_friction = |line: &&str| line.starts_with("friction");
    let rest = |text: &str| text.lines().filter(|line| !is_friction(line)).collect::<Vec<_>>().join("\n");
    assert_eq!(rest(&fitted), rest(GUESSED));
    let line = fitted.lines().find(is_friction).unwrap();
    assert!(line.starts_with("friction = { sigma_n_per_m = ") && line.ends_with(" } # guessed"), "{line}");
    // What people see is what the file has, σ in the paper's unit.
    let table = rows(&run.stdout, "winch");
    let shown = |key, factor: f64, digits| format!("{:.digits$}", number_in(&fitted, "friction", key) * factor);
    assert_eq!(
        table[0][1..4],
        [shown("mu", 1.0, 5), shown("sigma_n_per_m", 1e-3, 4), shown("viscous_n_s_per_m", 1.0, 4)]
    );
    for unit in ["[N/mm]", "[Ns/m]", "[N]"] {
        assert!(run.stdout.contains(unit), "{run:#?}");
    }
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 80), "too wide for a terminal: {run:#?}");
    // The fit does not start from what the file says: from the fitted values it finds the same again.
    let again = place.run(&["fit", "log.mcap", "--model", "fitted.toml", "-o", "again.toml"]).succeeds();
    let table = |run: &Run| run.stdout.split_once("\nwrote ").unwrap().0.to_owned();
    assert_eq!(table(&again), table(&run));
}

/// `before` and `after` of each cable.
fn errors(result: &Value) -> Vec<(Value, Value)> {
    result["cables"].as_array().unwrap().iter().map(|cable| (cable["before"].clone(), cable["after"].clone())).collect()
}

#[test]
fn a_replay_with_the_fitted_file_has_the_very_errors_of_the_fit() {
    let place = Place::empty();
    place.write("log.mcap", platform_log());
    let replayed = |place: &Place| {
        let arguments = ["replay", "log.mcap", "--model", "fitted.toml", "--json", "replay.json", "--force"];
        place.run(&arguments).succeeds();
        place.json("replay.json")
    };
    let run = fit(&place, &["log.mcap"]).succeeds();
    assert_shape(&place.json("fit.json"), &[&CABLE, &FORCES]);
    assert_eq!(errors(&place.json("fit.json")), errors(&replayed(&place)));
    for cable in place.json("fit.json")["cables"].as_array().unwrap() {
        let row = &rows(&run.stdout, cable["name"].as_str().unwrap())[0];
        let shown = |number: &Value| format!("{:.4}", number.as_f64().unwrap());
        assert_eq!(row[4..6], [shown(&cable["before"]["mae_n"]), shown(&cable["after"]["mae_n"])]);
        assert_eq!(row[6], format!("{:.2}", cable["mean_reference_n"].as_f64().unwrap()));
    }
    // Against the wrench it sums in another order.
    let run = fit(&place, &["log.mcap", "--reference", "wrench"]).succeeds();
    // So short a log tells nothing of the offsets by the wrench.
    let told: Vec<&str> = CABLE.iter().copied().filter(|key| *key != ".cables[].standard_errors.offset_n").collect();
    assert_shape(&place.json("fit.json"), &[&told, &WRENCH]);
    let force = rows(&run.stdout, "force").into_iter().next().unwrap();
    let after = |key: &str| place.json("fit.json")["wrench"]["after"][key].as_f64().unwrap();
    assert_eq!(force[3], format!("{:.4}", after("force_rms_n")));
    let (fitted, replayed) = (place.json("fit.json"), replayed(&place));
    for when in ["before", "after"] {
        for key in ["force_rms_n", "torque_rms_nm"] {
            let number = |result: &Value| result["wrench"][when][key].as_f64().unwrap();
            assert_close(number(&fitted), number(&replayed));
        }
    }
    // So do effects that only the fit brings in.
    let place = bench();
    place.write("log.mcap", hidden_stribeck());
    let names = "mu,sigma_n_per_m,viscous_n_s_per_m,stribeck.ratio,stribeck.velocity_m_per_s";
    place.run(&["fit", "log.mcap", "-o", "fitted.toml", "--json", "fit.json", "--parameters", names]).succeeds();
    let arguments = ["replay", "log.mcap", "--model", "fitted.toml", "--json", "replay.json"];
    place.run(&arguments).succeeds();
    assert_eq!(errors(&place.json("fit.json")), errors(&place.json("replay.json")));
}

/// A bench whose friction falls with speed, which its robot file does not say.
fn hidden_stribeck() -> &'static [u8] {
    static LOG: OnceLock<Vec<u8>> = OnceLock::new();
    let effect = ["--duration", "20", "--effect", "stribeck:ratio=0.5,velocity_m_per_s=0.02"];
    simulated(&LOG, &bench_robot(), &effect)
}

#[test]
fn effects_are_identified_where_the_cable_has_them_or_they_are_named() {
    let place = Place::empty();
    place.write("log.mcap", hidden_stribeck());
    let with_effect = bench_robot() + "effects = [ { kind = 'stribeck', ratio = 0.1, velocity_m_per_s = 0.05 } ]\n";
    place.write("effect.toml", with_effect);
    fit(&place, &["log.mcap"]).succeeds();
    let without = place.json("fit.json");
    assert!(without["cables"][0]["parameters"].get("stribeck.ratio").is_none(), "{without}");
    let run = fit(&place, &["log.mcap", "--model", "effect.toml"]).succeeds();
    let result = place.json("fit.json");
    let number = |table: &str, key: &str| result["cables"][0][table][key].as_f64().unwrap();
    assert!((number("parameters", "stribeck.ratio") - 0.5).abs() < 0.1, "{result}");
    assert!((number("parameters", "stribeck.velocity_m_per_s") - 0.02).abs() < 0.002, "{result}");
    let rms_n = |result: &Value| result["cables"][0]["after"]["rms_n"].as_f64().unwrap();
    assert!(rms_n(&result) < 0.95 * rms_n(&without), "{result} {without}");
    let fitted = String::from_utf8(place.read("fitted.toml")).unwrap();
    let written = number_in(&fitted, "effects", "ratio");
    assert_close(written, number("parameters", "stribeck.ratio"));
    let row = rows(&run.stdout, "winch").into_iter().nth(2).unwrap();
    assert!((row[1].parse::<f64>().unwrap() - written).abs() < 0.001, "{run:#?}");
    assert!(run.stdout.contains(" stribeck ") && run.stdout.contains("velocity_m_per_s"), "{run:#?}");

    place.run(&["fit", "log.mcap", "-o", "added.toml", "--parameters", "mu,stribeck.ratio"]).succeeds();
    assert!(String::from_utf8(place.read("added.toml")).unwrap().contains("kind = \"stribeck\", ratio = 0."));
}

#[test]
fn only_the_parameters_named_change() {
    let place = bench();
    let run = fit(&place, &["log.mcap", "--model", "guess.toml", "--parameters", "mu, viscous_n_s_per_m"]).succeeds();
    let result = place.json("fit.json");
    let keys: Vec<&String> = result["cables"][0]["standard_errors"].as_object().unwrap().keys().collect();
    assert_eq!(keys, ["mu", "viscous_n_s_per_m"]);
    assert_eq!(result["cables"][0]["parameters"]["sigma_n_per_m"], 300.0);
    let fitted = String::from_utf8(place.read("fitted.toml")).unwrap();
    assert!(fitted.contains("{ sigma_n_per_m = 300.0,   mu = 0.0"), "{fitted}");
    assert!(!fitted.contains("offset_n"), "{fitted}");
    // The table says which is which.
    assert!(run.stdout.contains("(0.3000)") && run.stdout.contains("(…) is not identified"), "{run:#?}");
}

#[test]
fn huber_finds_the_same_on_clean_data_in_its_own_way() {
    let place = bench();
    let result = |options: &[&str]| {
        fit(&place, &[&["log.mcap", "--model", "guess.toml"], options].concat()).succeeds();
        place.json("fit.json")["cables"][0].clone()
    };
    let (squares, huber) = (result(&[]), result(&["--huber"]));
    let number = |cable: &Value, table: &str| cable[table]["mu"].as_f64().unwrap();
    let far = (number(&squares, "parameters") - number(&huber, "parameters")).abs();
    assert!(far > 0.0 && far < 3.0 * number(&squares, "standard_errors"), "{squares} {huber}");
}

#[test]
fn the_attached_robot_file_is_the_one_that_is_rewritten() {
    let place = bench();
    place.write("robot.toml", bench_robot());
    fit(&place, &["log.mcap", "--model", "robot.toml"]).succeeds();
    let named = (place.read("fitted.toml"), place.json("fit.json"));
    fit(&place, &["log.mcap"]).succeeds();
    assert!((place.read("fitted.toml"), place.json("fit.json")) == named);
    // Whichever of several logs has it.
    place.write("bare.mcap", super::logs::rewrite(bench_log(), super::logs::Storage::Zstd, None, |_, _| true));
    let run = fit(&place, &["bare.mcap", "log.mcap"]).succeeds();
    assert!(run.stdout.contains("\nbench: "), "{run:#?}");
}

#[test]
fn a_forgotten_sensor_pulley_is_told_and_a_zero_is_not() {
    let place = Place::empty();
    place.write("log.mcap", platform_log());
    let robot = platform_robot();
    assert!(robot.contains(", sensor = true"), "{robot}");
    place.write("robot.toml", robot.replace(", sensor = true", ""));
    let words = ["cable1, cable2, cable3, cable4,", "the likely cause is a sensor that holds a pulley of 180°"];
    fit(&place, &["log.mcap", "--model", "robot.toml", "--parameters", "mu,offset_n"]).warns(&words);
    // A zero at the platform is what `fit` is there for.
    place.write("robot.toml", robot.replacen("mu = ", "offset_n = 3.0, mu = ", 1));
    place.run(&["simulate", "--model", "robot.toml", "-o", "zero.mcap", "--duration", "5"]).succeeds();
    let run = fit(&place, &["zero.mcap", "--model", "robot.toml"]);
    assert!(!run.stderr.contains("the force by the sensor is"), "{run:#?}");
}

#[test]
fn several_logs_are_identified_together() {
    static OTHER: OnceLock<Vec<u8>> = OnceLock::new();
    let place = bench();
    place.write("other.mcap", simulated(&OTHER, &bench_robot(), &["--duration", "12", "--seed", "5"]));
    let result = |logs: &[&str]| {
        fit(&place, &[logs, &["--model", "guess.toml"]].concat()).succeeds();
        place.json("fit.json")["cables"][0].clone()
    };
    let (one, other) = (result(&["log.mcap"]), result(&["other.mcap"]));
    let (both, swapped) = (result(&["log.mcap", "other.mcap"]), result(&["other.mcap", "log.mcap"]));
    let count = |cable: &Value| cable["samples"].as_u64().unwrap() + cable["left_out"]["warm_up"].as_u64().unwrap();
    assert_eq!((count(&one), count(&other), count(&both)), (10_000, 12_000, 22_000));
    // Each log begins anew.
    assert!(both["left_out"]["warm_up"].as_u64().unwrap() > one["left_out"]["warm_up"].as_u64().unwrap(), "{both}");
    let error = |cable: &Value| cable["standard_errors"]["mu"].as_f64().unwrap();
    assert!(error(&both) < error(&one) && error(&both) < error(&other), "{one} {other} {both}");
    let mu = |cable: &Value| cable["parameters"]["mu"].as_f64().unwrap();
    assert!((mu(&both) - mu(&swapped)).abs() < 1e-6, "{both} {swapped}");
    // One that tells nothing is named.
    place.write("mute.mcap", without(bench_log(), &["/reference_forces"]));
    let run = fit(&place, &["mute.mcap", "other.mcap"]).warns(&["`mute.mcap`", "nothing to compare", "`reference`"]);
    assert!(run.stderr.lines().count() == 1, "{run:#?}");
    assert!((mu(&place.json("fit.json")["cables"][0]) - mu(&other)).abs() < 0.1 * error(&other));
}

#[test]
fn the_wrench_needs_no_reference_forces() {
    let place = Place::empty();
    let by_wrench = |log: &[u8]| {
        place.write("log.mcap", log);
        let run = fit(&place, &["log.mcap", "--reference", "wrench", "--parameters", "mu"]);
        (run, place.json("fit.json"), place.read("fitted.toml"))
    };
    let (run, whole, file) = by_wrench(platform_log());
    run.succeeds();
    assert_eq!(whole["reference"], "wrench");
    let after = |key: &str| whole["wrench"]["after"][key].as_f64().unwrap();
    assert!(after("force_rms_n") < 0.1 * whole["wrench"]["before"]["force_rms_n"].as_f64().unwrap(), "{whole}");
    // Nothing on the topic, or nothing that could be read: it is not looked at.
    for log in [
        without(platform_log(), &["/reference_forces"]),
        with_data(platform_log(), "/reference_forces", |data| data[..data.len() / 3].to_vec()),
    ] {
        let (run, result, same_file) = by_wrench(&log);
        run.succeeds();
        assert!(result == whole && same_file == file);
    }
}

#[test]
fn a_wrench_that_one_cable_bears_is_refused_in_one_sentence() {
    let place = Place::empty();
    let robot = "format = 'fric-robot/1'\nname = 'one'\ncycle_s = 0.004\n[platform]\nmass_kg = 2.0\n[[cable]]\nname = 'a'\n\
                 base_m = [0.0, 0.0, 2.0]\nplatform_m = [0.0, 0.0, 0.0]\npulleys = [{ wrap_deg = 90.0, sensor = true }]\n\
                 friction = { mu = 0.02, sigma_n_per_m = 700.0 }\n";
    place.write("robot.toml", robot);
    let simulate = ["simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "4"];
    assert_eq!(place.run(&simulate).code, Some(0));
    let run = fit(&place, &["log.mcap", "--reference", "wrench"]);
    run.fails(1, &["all pull along one line", "one of its six"]).advises(&["hanging_mass_kg"]);
    assert!(!place.names().contains(&"fitted.toml".to_owned()));
    assert_eq!(place.run(&["info", "log.mcap", "--json", "info.json"]).code, Some(0));
    let info = place.json("info.json");
    let step = info["steps"].as_array().unwrap().iter().find(|step| step["step"] == "fit: wrench").unwrap();
    assert!(step["possible"] == false && step["reasons"].to_string().contains("one line"), "{step}");
}

#[test]
fn without_a_wrench_the_mass_takes_its_place() {
    let place = Place::empty();
    place.write("log.mcap", without(platform_log(), &["/reference_forces", "/platform_wrench"]));
    let run = fit(&place, &["log.mcap", "--reference", "wrench"]);
    let run = run.warns(&["no wrench on /platform_wrench", "mass of 0.41 kg", "pose"]);
    assert!(run.stdout.contains("mass"), "{run:#?}");
    let result = place.json("fit.json");
    assert_eq!(result["reference"], "mass");
    for cable in result["cables"].as_array().unwrap() {
        assert!(cable["samples"].as_u64().unwrap() > 0 && cable.get("before").is_none(), "{cable}");
    }
    // A wrench by the mass of 4 N: friction shows, if not as sharply.
    let held_out = |key: &str| result["wrench"]["held_out"][key].as_f64().unwrap();
    let after = |key: &str| result["wrench"]["after"][key].as_f64().unwrap();
    assert_eq!(result["wrench"]["reference"], "mass");
    assert!(run.stdout.contains("held out") && held_out("force_rms_n") > 0.5 * after("force_rms_n"), "{result}");
    let mean = |table: &str| {
        let of = |cable: &Value| cable[table]["mu"].as_f64();
        let all: Vec<f64> = result["cables"].as_array().unwrap().iter().filter_map(of).collect();
        all.iter().sum::<f64>() / 8.0
    };
    assert!((mean("parameters") - 0.01925).abs() < 0.002, "{result}");
}

#[test]
fn what_the_log_does_not_determine_is_named_with_what_to_record() {
    static SHORT: OnceLock<Vec<u8>> = OnceLock::new();
    let place = Place::empty();
    // In three seconds the platform has moved for one; half of the cables have hardly begun.
    let log = simulated(&SHORT, &example_robot(), &["--duration", "3", "--seed", "3"]);
    place.write("log.mcap", log);
    let run = fit(&place, &["log.mcap"]).warns(&["no sample can be used, values kept", "move too little"]);
    let result = place.json("fit.json");
    let cables = result["cables"].as_array().unwrap();
    let undetermined =
        |cable: &Value| cable["undetermined"].as_array().unwrap().iter().any(|name| name == "sigma_n_per_m");
    let is_alone =
        |cable: &Value| cable["open"].as_array().unwrap().iter().all(|parts| parts[0]["parameter"] != "sigma_n_per_m");
    let names: Vec<&str> = cables
        .iter()
        .filter(|cable| cable["samples"] != 0 && undetermined(cable) && is_alone(cable))
        .map(|cable| cable["name"].as_str().unwrap())
        .collect();
    assert!(!names.is_empty(), "{result}");
    let told = unwrapped(&run.stdout);
    let said = format!(
        "The log does not determine σ (sigma_n_per_m) of {}: the given value is kept. Record small movements",
        names.join(", ")
    );
    assert!(told.contains(&said), "{said}: {run:#?}");
    // What only together with something else is open is said with it; the first part is kept.
    let open: Vec<&Value> = cables.iter().flat_map(|cable| cable["open"].as_array().unwrap()).collect();
    assert!(!open.is_empty() && run.stdout.matches("leaves a combination open").count() == open.len(), "{run:#?}");
    for parts in open {
        let (cable, parameter) = (parts[0]["cable"].as_str().unwrap(), parts[0]["parameter"].as_str().unwrap());
        assert!(parts.as_array().unwrap().len() > 1 && parts[0]["step"].as_f64().unwrap() > 0.0, "{parts}");
        assert!(run.stdout.contains(&format!("{parameter} of {cable} is kept as given")), "{run:#?}");
    }
    let fitted = String::from_utf8(place.read("fitted.toml")).unwrap();
    for (index, cable) in cables.iter().enumerate().filter(|(_, cable)| undetermined(cable)) {
        let start = format!("name = \"cable{}\"", index + 1);
        let given = number_in(&example_robot(), &start, "sigma_n_per_m");
        assert_eq!(cable["parameters"]["sigma_n_per_m"], given);
        assert!(cable["standard_errors"].get("sigma_n_per_m").is_none(), "{cable}");
        assert_close(number_in(&fitted, &start, "sigma_n_per_m"), given);
    }
}

#[test]
fn a_cable_without_a_reference_keeps_its_values() {
    let place = Place::empty();
    place.write("log.mcap", platform_log());
    fit(&place, &["log.mcap"]).succeeds();
    let whole = place.json("fit.json");
    place.write("log.mcap", without_reference_of(platform_log(), "cable3"));
    let run = fit(&place, &["log.mcap"]);
    let run = run.warns(&["no reference forces on /reference_forces of cable3", "its values are kept"]);
    assert!(run.stderr.lines().count() == 1 && !run.stdout.contains("does not determine"), "{run:#?}");
    let result = place.json("fit.json");
    for (index, (cable, before)) in
        result["cables"].as_array().unwrap().iter().zip(whole["cables"].as_array().unwrap()).enumerate()
    {
        if index != 2 {
            assert_eq!(cable, before);
            continue;
        }
        let keys: Vec<&String> = cable.as_object().unwrap().keys().collect();
        let expected = ["name", "samples", "left_out", "termination", "evaluations", "parameters", "standard_errors"];
        assert!(
            expected.iter().chain(&["undetermined", "open", "at_bound"]).all(|key| keys.contains(&&(*key).to_owned())),
            "{keys:?}"
        );
        assert_eq!(keys.len(), expected.len() + 3, "{keys:?}");
        assert_eq!((&cable["name"], &cable["samples"]), (&"cable3".into(), &0.into()));
        assert_eq!(cable["parameters"]["mu"], 0.014);
        assert_eq!(cable["standard_errors"], serde_json::json!({}));
    }
    assert_eq!(rows(&run.stdout, "cable3")[0][1..5], ["(0.01400)", "(0.9990)", "(0.1550)", "–"]);
}

#[test]
fn stdout_is_nothing_but_json_where_it_is_asked_for() {
    let place = bench();
    let run = place.run(&["fit", "log.mcap", "-o", "fitted.toml", "--json", "-"]);
    assert_eq!(run.code, Some(0), "{run:#?}");
    assert_shape(&result_of(run.stdout.as_bytes()), &[&CABLE, &FORCES]);
    assert!(run.stderr.contains("winch") && run.stderr.contains("F_pv"), "{run:#?}");
    assert_eq!(place.names(), ["fitted.toml", "guess.toml", "log.mcap"]);
}

/// The headline says what is fitted, friction or not.
#[test]
fn what_is_fitted_is_told() {
    let place = bench();
    place.write("bench.toml", bench_robot());
    let headline = |arguments: &[&str]| unwrapped(&fit(&place, &[&["log.mcap"], arguments].concat()).succeeds().stdout);
    let told = headline(&["--model", "guess.toml"]);
    assert!(told.contains("Friction is fitted on 1 cable"), "{told}");
    let told = headline(&["--model", "bench.toml", "--parameters", "sensor_gain.gain"]);
    assert!(told.contains("Only sensor_gain.gain is fitted; the model leaves"), "{told}");
}

/// Noise of the length that is a tenth of a per cent of the presliding wears friction away. The fit keeps it out, says so, and writes the play.
#[test]
fn a_trembling_length_is_kept_out_of_the_fit() {
    let place = Place::empty();
    place.write("robot.toml", bench_robot().replace("cycle_s = 0.001", "cycle_s = 0.004"));
    for (noise_m, name) in [("0", "exact"), ("0.000002", "noisy")] {
        let (log, file, json) = (format!("{name}.mcap"), format!("{name}.toml"), format!("{name}.json"));
        let simulate =
            ["simulate", "--model", "robot.toml", "-o", &log, "--duration", "40", "--length-noise-m", noise_m];
        place.run(&simulate).succeeds();
        place.run(&["fit", &log, "--model", "robot.toml", "-o", &file, "--json", &json]).succeeds();
        let sigma_n_per_m = |file: &str| place.json(file)["cables"][0]["parameters"]["sigma_n_per_m"].as_f64().unwrap();
        let ratio = sigma_n_per_m(&json) / sigma_n_per_m("exact.json");
        assert!((0.95..1.05).contains(&ratio), "{name}: {ratio}");
        let faults = &place.json(&json)["cables"][0]["faults"];
        let written = String::from_utf8(place.read(&file)).unwrap();
        assert_eq!(written.contains("length_noise_m = "), name == "noisy", "{written}");
        if name == "noisy" {
            let noise_m = faults[0]["parameters"]["noise_m"].as_f64().unwrap();
            assert!(faults[0]["kind"] == "noisy_length" && (1.8e-6..2.2e-6).contains(&noise_m), "{faults}");
            // With the written file it is known.
            place.run(&["fit", &log, "--model", &file, "-o", "again.toml", "--json", "again.json"]).succeeds();
            assert!(place.json("again.json")["cables"][0]["faults"].is_null());
        } else {
            assert!(faults.is_null(), "{faults}");
        }
    }
}
