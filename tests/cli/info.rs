//! `info`: what is in a log, what maps to what, and which step is impossible and why.

use serde_json::Value;

use super::logs::{without, without_reference_of};
use super::support::{Place, example_robot, result_of, short_log, slow_robot, unwrapped};

/// Table and JSON of a log without some topics.
fn info(topics: &[&str]) -> (String, Value) {
    let place = Place::empty();
    place.write("log.mcap", without(short_log(), topics));
    let run = place.run(&["info", "log.mcap", "--json", "j.json"]).succeeds();
    let stdout = place.run_in_vain(&["info", "log.mcap", "--json", "-"]);
    let (file, piped): (_, Value) = (place.json("j.json"), result_of(stdout.stdout.as_bytes()));
    assert_eq!(file, piped);
    assert_eq!(file["format"], "fric-info/1");
    assert_eq!(Some(stdout.stderr.as_str()), run.stdout.split("\nwrote ").next());
    (run.stdout, file)
}

/// Whether a step is possible, and the reasons; table and JSON have to say the same, or the table the step above with the same reasons.
#[track_caller]
fn step((table, json): &(String, Value), name: &str) -> (bool, String) {
    let steps = json["steps"].as_array().unwrap();
    let step = steps.iter().find(|step| step["step"] == name).unwrap();
    let possible = step["possible"].as_bool().unwrap();
    let reasons: Vec<&str> =
        step["reasons"].as_array().unwrap().iter().map(|reason| reason.as_str().unwrap()).collect();
    let reasons = reasons.join("; ");
    let possible_word = if possible { "possible" } else { "impossible" };
    let above = steps.iter().find(|above| above["reasons"] == step["reasons"]).unwrap();
    let rows = [
        format!("{name} {possible_word} {reasons}"),
        format!("{name} {possible_word} as `{}`", above["step"].as_str().unwrap()),
    ];
    assert!(rows.iter().any(|row| unwrapped(table).contains(row.trim_end())), "{rows:?} {table}");
    (possible, reasons)
}

#[test]
fn a_complete_log_allows_everything() {
    let all = info(&[]);
    for name in ["replay: forces", "replay: wrench", "replay: errors", "fit: forces", "fit: wrench"] {
        assert_eq!(step(&all, name), (true, String::new()), "{name}");
    }
    let (table, json) = &all;
    assert_eq!(json["robot"], "mini-ipanema");
    assert!(unwrapped(table).contains("attached: fric-robot.toml"), "{table}");
    for (signal, path, messages) in [
        ("cable", "/cable_states", 400),
        ("reference", "/reference_forces", 400),
        ("pose", "/platform_pose", 101),
        ("wrench", "/platform_wrench", 101),
    ] {
        let found = json["signals"].as_array().unwrap().iter().find(|found| found["signal"] == signal).unwrap();
        assert_eq!((&found["path"], &found["messages"]), (&path.into(), &messages.into()));
        let topic = json["topics"].as_array().unwrap().iter().find(|topic| topic["topic"] == path).unwrap();
        assert_eq!((&topic["messages"], &topic["encoding"]), (&messages.into(), &"cdr".into()));
        let row: Vec<&str> = table
            .lines()
            .map(|line| line.split_whitespace().collect::<Vec<_>>())
            .find(|row| row[..] == [signal, path, &messages.to_string()])
            .unwrap();
        assert_eq!(row.len(), 3);
    }
    let cable = &json["topics"].as_array().unwrap()[0];
    assert_eq!(cable["topic"], "/cable_states");
    assert!((cable["rate_hz"].as_f64().unwrap() - 1000.0).abs() < 1e-6);
    assert!((cable["longest_interval_s"].as_f64().unwrap() - 0.001).abs() < 1e-9);
    assert!((cable["to_s"].as_f64().unwrap() - 0.399).abs() < 1e-9);
}

#[test]
fn without_a_reference_the_wrench_is_left_to_fit() {
    let found = info(&["/reference_forces"]);
    for name in ["replay: errors", "fit: forces"] {
        let (possible, reasons) = step(&found, name);
        assert!(!possible && reasons.contains("no reference"), "{name}: {reasons}");
    }
    assert_eq!(step(&found, "fit: wrench"), (true, String::new()));
    assert!(step(&found, "replay: forces").0 && step(&found, "replay: wrench").0);
    assert!(found.0.lines().any(|line| line.contains("/reference_forces") && line.contains("not in the log")));
}

#[test]
fn without_a_pose_there_is_no_wrench() {
    let found = info(&["/platform_pose"]);
    let (possible, reasons) = step(&found, "replay: wrench");
    assert!(!possible && reasons.contains("no pose"), "{reasons}");
    // The forces are less exact then, which is said.
    let (possible, reasons) = step(&found, "replay: forces");
    assert!(possible && reasons.contains("no pose"), "{reasons}");
    // A fit takes no wrap for another.
    for name in ["fit: forces", "fit: wrench"] {
        let (possible, reasons) = step(&found, name);
        assert!(!possible && reasons.contains("no pose on /platform_pose"), "{name}: {reasons}");
    }
}

#[test]
fn without_a_wrench_the_mass_is_left_to_fit() {
    let found = info(&["/platform_wrench"]);
    let (possible, reasons) = step(&found, "fit: wrench");
    assert!(possible && reasons.contains("no wrench on /platform_wrench") && reasons.contains("0.41 kg"), "{reasons}");
    assert_eq!(step(&found, "fit: forces"), (true, String::new()));
    let place = Place::empty();
    place.write("log.mcap", without(short_log(), &["/platform_wrench", "/reference_forces"]));
    place.write("light.toml", example_robot().replace("mass_kg = 0.41", ""));
    place.run(&["info", "log.mcap", "--model", "light.toml", "--json", "j.json"]).succeeds();
    let steps = place.json("j.json")["steps"].clone();
    let fits: Vec<&Value> =
        steps.as_array().unwrap().iter().filter(|step| step["step"].as_str().unwrap().starts_with("fit")).collect();
    assert_eq!(fits.len(), 2);
    assert!(fits.iter().all(|step| step["possible"] == false), "{steps}");
    assert!(fits[1]["reasons"].to_string().contains("no mass"), "{steps}");
}

#[test]
fn the_cables_that_cannot_be_fitted_are_named() {
    let place = Place::empty();
    place.write("log.mcap", without_reference_of(short_log(), "cable3"));
    place.run(&["info", "log.mcap", "--json", "j.json"]).succeeds();
    let json = place.json("j.json");
    let step = json["steps"].as_array().unwrap().iter().find(|step| step["step"] == "fit: forces").unwrap();
    assert_eq!(step["possible"], true);
    assert_eq!(step["reasons"], serde_json::json!(["the log has no reference forces on /reference_forces of cable3"]));
}

#[test]
fn without_cables_there_is_nothing() {
    let found = info(&["/cable_states"]);
    for name in ["replay: forces", "replay: wrench", "replay: errors", "fit: forces", "fit: wrench"] {
        let (possible, reasons) = step(&found, name);
        assert!(!possible && !reasons.is_empty(), "{name}: {reasons}");
    }
    assert!(step(&found, "replay: forces").1.contains("/cable_states"));
}

#[test]
fn a_log_too_short_to_discover_is_told() {
    let place = Place::empty();
    place.write("robot.toml", slow_robot());
    for (duration, possible) in [("7.9", false), ("8.1", true)] {
        let simulate = ["simulate", "--model", "robot.toml", "-o", "log.mcap", "--force", "--duration", duration];
        place.run(&simulate).succeeds();
        place.run(&["info", "log.mcap", "--json", "j.json", "--force"]).succeeds();
        let json = place.json("j.json");
        for name in ["discover: forces", "discover: wrench"] {
            let step = json["steps"].as_array().unwrap().iter().find(|step| step["step"] == name).unwrap().clone();
            assert_eq!(step["possible"], possible, "{step}");
            assert_eq!(step["reasons"].to_string().contains("too few, 8 s are needed"), !possible, "{step}");
        }
    }
}

#[test]
fn a_log_with_only_the_wrench_can_be_searched_by_it() {
    let place = Place::empty();
    place.write("robot.toml", slow_robot());
    place.run(&["simulate", "--model", "robot.toml", "-o", "all.mcap", "--duration", "9"]).succeeds();
    place.write("log.mcap", without(&place.read("all.mcap"), &["/reference_forces"]));
    let table = place.run(&["info", "log.mcap", "--json", "j.json"]).succeeds().stdout;
    let found = (table, place.json("j.json"));
    assert_eq!(step(&found, "discover: wrench"), (true, String::new()));
    assert!(!step(&found, "discover: forces").0);
    let run = place.run_in_vain(&["discover", "log.mcap"]).fails(1, &["no reference forces on /reference_forces"]);
    run.advises(&["search without them: --reference wrench."]);
}

#[test]
fn how_the_log_is_kept_is_told() {
    let place = Place::with_log();
    let run = place.run(&["info", "log.mcap", "--json", "j.json"]).succeeds();
    let kept = place.json("j.json")["storage"].clone();
    let size_bytes = short_log().len();
    assert_eq!((&kept["kind"], &kept["size_bytes"]), (&"MCAP".into(), &size_bytes.into()));
    assert_eq!(kept["messages"], 400 + 400 + 101 + 101);
    // The summary of another reader.
    let summary = mcap::Summary::read(short_log()).unwrap().unwrap();
    let in_file: u64 = summary.chunk_indexes.iter().map(|chunk| chunk.compressed_size).sum();
    let unpacked: u64 = summary.chunk_indexes.iter().map(|chunk| chunk.uncompressed_size).sum();
    assert_eq!(kept["chunks"]["count"], summary.chunk_indexes.len());
    assert_eq!(
        (&kept["chunks"]["stored_bytes"], &kept["chunks"]["content_bytes"]),
        (&in_file.into(), &unpacked.into())
    );
    assert_eq!(kept["chunks"]["compression"], summary.chunk_indexes[0].compression.as_str());
    let counted = summary.stats.unwrap();
    let nanos = u32::try_from(counted.message_end_time - counted.message_start_time).unwrap();
    let duration_s = f64::from(nanos) * 1e-9;
    assert!((kept["duration_s"].as_f64().unwrap() - duration_s).abs() < 1e-9, "{kept}");
    assert!(run.stdout.contains(&format!("{duration_s:.3} s")) && run.stdout.contains("start:"), "{run:#?}");
}

/// As of a file without a byte, there is nothing to tell of it.
#[test]
fn a_log_with_nothing_in_it_is_refused() {
    let place = Place::with_log();
    // The magic bytes; a header that is cut off.
    for cut in [8, 9, 30] {
        place.write("log.mcap", &short_log()[..cut]);
        for more in [&[][..], &["--model", "robot.toml"]] {
            let run = place.run_in_vain(&[&["info", "log.mcap", "--json", "j.json"], more].concat());
            assert!(run.stderr.contains("warning: `log.mcap` is cut off"), "{run:#?}");
            run.fails(1, &["no topic, no message and no robot file"]).advises(&["complete copy"]);
        }
    }
}

#[test]
fn damage_is_told_here_too() {
    let place = Place::empty();
    let log = short_log();
    place.write("log.mcap", &log[..log.len() * 2 / 3]);
    let run = place.run(&["info", "log.mcap"]).warns(&["`log.mcap` is cut off"]);
    assert!(run.stdout.contains("/cable_states"), "{run:#?}");
}
