//! `replay`: the table and the JSON.

use serde_json::Value;

use super::logs::without;
use super::support::{Place, command, example_robot, result_of, root, short_log};

/// All keys of a JSON value as paths, items of lists under `[]`.
fn keys(value: &Value, path: &str, all: &mut Vec<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| keys(value, &format!("{path}.{key}"), all)),
        Value::Array(list) => list.iter().for_each(|value| keys(value, &format!("{path}[]"), all)),
        _ => all.push(path.to_owned()),
    }
}

/// The same, each once.
pub fn shape(value: &Value) -> Vec<String> {
    let mut all = Vec::new();
    keys(value, "", &mut all);
    all.sort();
    all.dedup();
    all
}

const ERRORS: [&str; 4] =
    [".cables[].after.mae_n", ".cables[].after.rms_n", ".cables[].before.mae_n", ".cables[].before.rms_n"];
const ALWAYS: [&str; 9] = [
    ".cables[].flagged",
    ".cables[].name",
    ".cables[].samples",
    ".cycle.count",
    ".cycle.max_ns",
    ".cycle.median_ns",
    ".cycle.p999_ns",
    ".format",
    ".robot",
];
const WRENCH: [&str; 5] = [
    ".wrench.after.force_rms_n",
    ".wrench.after.torque_rms_nm",
    ".wrench.before.force_rms_n",
    ".wrench.before.torque_rms_nm",
    ".wrench.reference",
];

#[track_caller]
fn assert_shape(result: &Value, parts: &[&[&str]]) {
    let mut expected: Vec<&str> = parts.concat();
    expected.sort_unstable();
    assert_eq!(shape(result), expected);
    assert_eq!(result["format"], "fric-replay/1");
}

/// The command of the README, word for word but for `--json`.
#[test]
fn the_example_is_compensated() {
    let place = Place::empty();
    let json = place.path("result.json");
    let arguments = ["replay", "examples/mini-ipanema.mcap", "--json", json.to_str().unwrap()];
    let output = command(&root(), &arguments).output().unwrap();
    let table = String::from_utf8(output.stdout).unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]), "{table}");
    let result = place.json("result.json");
    assert_shape(&result, &[&ALWAYS, &ERRORS, &WRENCH]);
    assert_eq!(result["robot"], "mini-ipanema");
    let cables = result["cables"].as_array().unwrap();
    assert_eq!(cables.len(), 8);
    for (index, cable) in cables.iter().enumerate() {
        assert_eq!(cable["name"], format!("cable{}", index + 1));
        assert_eq!((cable["samples"].as_u64(), cable["flagged"].as_u64()), (Some(50_000), Some(0)));
        let number = |when: &str, what: &str| cable[when][what].as_f64().unwrap();
        for what in ["rms_n", "mae_n"] {
            assert!(number("after", what) < 0.1 * number("before", what), "{cable}");
        }
        // The table says the same.
        let row: Vec<&str> = table
            .lines()
            .find(|line| line.contains(&format!("cable{}", index + 1)))
            .unwrap()
            .split_whitespace()
            .collect();
        let shown = |when, what| format!("{:.4}", number(when, what));
        assert_eq!(row[1..3], [shown("before", "rms_n"), shown("after", "rms_n")]);
        assert_eq!(row[3], format!("{:.1}", number("after", "rms_n") / number("before", "rms_n") * 100.0));
        assert_eq!(row[5..], ["0"]);
    }
    for (line, key) in [("force", "force_rms_n"), ("torque", "torque_rms_nm")] {
        let row: Vec<&str> = table
            .lines()
            .map(|row| row.split_whitespace().collect::<Vec<_>>())
            .find(|row| row.first() == Some(&line))
            .unwrap();
        let number = |when: &str| result["wrench"][when][key].as_f64().unwrap();
        assert!(number("after") < 0.1 * number("before"), "{result}");
        assert_eq!(row[2..], [format!("{:.4}", number("before")), format!("{:.4}", number("after"))]);
    }
    let cycle = |key: &str| result["cycle"][key].as_u64().unwrap();
    assert_eq!(cycle("count"), 50_000);
    assert!(0 < cycle("median_ns") && cycle("median_ns") <= cycle("p999_ns") && cycle("p999_ns") <= cycle("max_ns"));
    let median_us = f64::from(u32::try_from(cycle("median_ns")).unwrap()) * 1e-3;
    let (median, digits) = (median_us, if median_us < 10.0 { 2 } else { 1 });
    assert!(table.contains(&format!("50000 cycles; one takes {median:.digits$} µs (median)")), "{table}");
}

#[test]
fn the_wide_table_has_the_means_too() {
    let place = Place::with_log();
    let run = place.run(&["replay", "log.mcap", "--wide", "--json", "j.json"]).succeeds();
    let cable = &place.json("j.json")["cables"][0];
    let row: Vec<&str> = run.stdout.lines().find(|line| line.contains("cable1")).unwrap().split_whitespace().collect();
    let mean = |when: &str| format!("{:.4}", cable[when]["mae_n"].as_f64().unwrap());
    assert_eq!(row[5..], [&mean("before"), &mean("after"), "400", "0"]);
}

#[test]
fn stdout_is_nothing_but_json_where_it_is_asked_for() {
    let place = Place::with_log();
    let run = place.run(&["replay", "log.mcap", "--json", "-"]);
    assert_eq!(run.code, Some(0), "{run:#?}");
    assert_shape(&result_of(run.stdout.as_bytes()), &[&ALWAYS, &ERRORS, &WRENCH]);
    // The table is not lost.
    assert!(run.stderr.contains("cable8") && run.stderr.contains("cycles; one takes"), "{run:#?}");
    assert_eq!(place.names(), ["log.mcap", "robot.toml"]);
}

#[test]
fn what_the_log_cannot_tell_is_left_out() {
    let place = Place::with_log();
    let replayed = |topics: &[&str], warning: &str| {
        place.write("part.mcap", without(short_log(), topics));
        let run = place.run(&["replay", "part.mcap", "--json", "j.json", "-o", "o.mcap", "--force"]);
        let run = if warning.is_empty() { run.succeeds() } else { run.warns(&[warning]) };
        (run.stdout, place.json("j.json"))
    };
    let (_, whole) = replayed(&[], "");
    assert_shape(&whole, &[&ALWAYS, &ERRORS, &WRENCH]);
    let (table, no_reference) = replayed(&["/reference_forces"], "no reference");
    assert_shape(&no_reference, &[&ALWAYS, &WRENCH]);
    assert!(table.lines().any(|line| line.contains("cable1") && line.contains('–')), "{table}");
    // The weight of the platform takes its place, in quiet motion.
    let (table, no_wrench) = replayed(&["/platform_wrench"], "");
    assert_shape(&no_wrench, &[&ALWAYS, &ERRORS, &WRENCH]);
    assert!(table.contains("wrench, by mass") && no_wrench["wrench"]["reference"] == "mass", "{table}");
    assert_eq!(whole["wrench"]["reference"], "wrench");
    place.write("light.toml", example_robot().replace("mass_kg = 0.41", ""));
    place.run(&["replay", "part.mcap", "--model", "light.toml", "--json", "light.json"]).succeeds();
    assert_shape(&place.json("light.json"), &[&ALWAYS, &ERRORS]);
    let (_, no_pose) = replayed(&["/platform_pose"], "no pose");
    assert_shape(&no_pose, &[&ALWAYS, &ERRORS]);
    let (_, bare) = replayed(&["/reference_forces", "/platform_wrench", "/platform_pose"], "no reference");
    assert_shape(&bare, &[&ALWAYS]);
    // What is left out changes nothing of the rest.
    assert_eq!(no_wrench["cables"], whole["cables"]);
    assert_eq!(no_reference["wrench"], whole["wrench"]);
}
