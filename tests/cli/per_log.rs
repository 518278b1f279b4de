//! `--per-log`: the zero that each of several logs has of its own.

use std::sync::OnceLock;

use serde_json::Value;

use super::simulate::bench_robot;
use super::support::{Place, unwrapped};

const ZEROS_N: [(&str, f64); 3] = [("a.mcap", 0.3), ("b.mcap", -0.5), ("c.mcap", 0.1)];

/// The bench with an offset at the platform.
fn robot(offset_n: f64) -> String {
    bench_robot().replace("viscous_n_s_per_m = 0.2", &format!("viscous_n_s_per_m = 0.2, offset_n = {offset_n:?}"))
}

/// Three logs of the bench, before each of which the sensor at the platform was tared; made once.
fn place() -> Place {
    static LOGS: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    let logs = LOGS.get_or_init(|| {
        let place = Place::empty();
        let simulated = |(seed, (log, zero_n)): (usize, (&str, f64))| {
            place.write("tared.toml", robot(zero_n));
            let seed = (20 + seed).to_string();
            let options = ["--model", "tared.toml", "--duration", "10", "--seed", seed.as_str(), "-o", log];
            place.run(&[&["simulate"], &options[..]].concat()).succeeds();
            place.read(log)
        };
        ZEROS_N.into_iter().enumerate().map(simulated).collect()
    });
    let place = Place::empty();
    place.write("robot.toml", robot(0.0));
    for ((name, _), log) in ZEROS_N.iter().zip(logs) {
        place.write(name, log);
    }
    place
}

/// The values of the logs are those that were simulated, within their stated errors, and the file has the last.
fn assert_told(place: &Place, cable: &Value, file: &str, stdout: &str) {
    let logs = cable["per_log"].as_array().unwrap();
    assert_eq!(logs.len(), 3, "{cable}");
    for (log, (name, truth_n)) in logs.iter().zip(ZEROS_N) {
        let number = |key: &str| log[key]["offset_n"].as_f64().unwrap();
        let (value_n, error_n) = (number("parameters"), number("standard_errors"));
        assert_eq!(log["log"], name, "{log}");
        assert!((value_n - truth_n).abs() < 3.5 * error_n && error_n < 0.1, "{log} instead of {truth_n}");
    }
    assert_eq!(cable["parameters"]["offset_n"], logs[2]["parameters"]["offset_n"], "{cable}");
    assert_eq!(cable["standard_errors"]["offset_n"], logs[2]["standard_errors"]["offset_n"], "{cable}");
    let written = format!("offset_n = {}", cable["parameters"]["offset_n"]);
    assert!(String::from_utf8(place.read(file)).unwrap().contains(&written), "{written}");
    let stdout = unwrapped(stdout);
    assert!(stdout.contains("each log has its own value, and the robot file that of the last one"), "{stdout}");
    assert!(ZEROS_N.iter().all(|(name, _)| stdout.contains(name)), "{stdout}");
}

#[test]
fn a_fit_gives_each_log_its_own_zero() {
    let place = place();
    let fit = |options: &[&str]| {
        let all = ["fit", "a.mcap", "b.mcap", "c.mcap", "--model", "robot.toml", "-o", "fitted.toml", "--force"];
        let run = place.run(&[&all[..], &["--json", "fit.json", "--report", "fit.html"], options].concat()).succeeds();
        (place.json("fit.json")["cables"][0].clone(), run.stdout)
    };
    let (cable, stdout) = fit(&["--per-log", "offset_n"]);
    assert_told(&place, &cable, "fitted.toml", &stdout);
    let page = String::from_utf8(place.read("fit.html")).unwrap();
    assert!(ZEROS_N.iter().all(|(name, _)| page.contains(name)));
    let (common, stdout) = fit(&[]);
    assert!(common.get("per_log").is_none() && !stdout.contains("its own value"), "{common}");
    let rms_n = |cable: &Value| cable["after"]["rms_n"].as_f64().unwrap();
    assert!(rms_n(&common) > 5.0 * rms_n(&cable), "{common} {cable}");
}

#[test]
fn a_discovery_takes_zeros_for_no_effect() {
    let place = place();
    let run = place.run(&[
        "discover",
        "a.mcap",
        "b.mcap",
        "c.mcap",
        "--model",
        "robot.toml",
        "--per-log",
        "offset_n",
        "-o",
        "found.toml",
        "--json",
        "found.json",
    ]);
    let run = run.succeeds();
    let cable = place.json("found.json")["cables"][0].clone();
    assert_eq!(cable["verdict"], "complete", "{cable}");
    assert_eq!(cable["effects"].as_array().unwrap().len(), 0, "{cable}");
    assert_told(&place, &cable, "found.toml", &run.stdout);
}

#[test]
fn what_cannot_be_per_log_is_refused_before_anything_is_read() {
    let place = Place::empty();
    let refused = |logs: &[&str], name: &str| {
        let run = place.run_in_vain(&[&["fit"], logs, &["-o", "fitted.toml", "--per-log", name]].concat());
        let also = place.run_in_vain(&[&["discover"], logs, &["--per-log", name]].concat());
        assert_eq!(run.stderr, also.stderr);
        run
    };
    let two = ["a.mcap", "b.mcap"];
    refused(&two, "offset").fails(2, &["--per-log: there is no parameter `offset`"]).advises(&["`offset_n`"]);
    refused(&two, "offset_n,offset_n").fails(2, &["--per-log: `offset_n` is named twice"]);
    refused(&two, "mu").fails(2, &["--per-log: `mu` has one value for all logs"]).advises(&["`offset_n`"]);
    refused(&two, "sensor_drift.rate_n_per_s").fails(2, &["has one value for all logs"]).advises(&["`offset_n`"]);
    refused(&two, "offset_n,sensor_offset.offset_n").fails(2, &["cannot be told apart"]).advises(&["tared anew"]);
    refused(&two[..1], "offset_n").fails(2, &["there is one"]).advises(&["logs of all runs"]);
    let wrench = ["a.mcap", "b.mcap", "--reference", "wrench"];
    refused(&wrench, "offset_n").fails(2, &["wrench"]).advises(&["--reference forces"]);
}
