//! Logs that are none, and robot files that do not fit the log.

use super::logs::{Storage, rewrite, with_data, without};
use super::support::{Place, Run, example_robot, short_log};

const COMMANDS: [&str; 2] = ["replay", "info"];

#[test]
fn what_is_no_log_is_told() {
    let place = Place::with_log();
    std::fs::create_dir(place.path("folder")).unwrap();
    place.write("notes.txt", "run 1 was good\nrun 2 was not\n");
    place.write("empty.mcap", "");
    place.write("zeros.mcap", [0; 5000]);
    for command in COMMANDS {
        let run = |log| place.run_in_vain(&[command, log]);
        run("nowhere.mcap").fails(1, &["no file", "`nowhere.mcap`"]);
        run("no/where.mcap").fails(1, &["`no/where.mcap`"]);
        run("folder").fails(1, &["`folder` is a directory"]);
        run("notes.txt").fails(1, &["`notes.txt` is not an MCAP recording", "text file"]);
        run("robot.toml").fails(1, &["`robot.toml` is not an MCAP recording"]);
        run("empty.mcap").fails(1, &["`empty.mcap` is empty"]);
        run("zeros.mcap").fails(1, &["`zeros.mcap` is not an MCAP recording"]);
        place.run_in_vain(&[command, "log.mcap", "nowhere.mcap"]).fails(1, &["`nowhere.mcap`"]);
    }
    place.run_in_vain(&["replay", "notes.txt", "-o", "out.mcap", "--json", "j.json"]).fails(1, &["`notes.txt`"]);
}

#[test]
fn a_semicolon_is_not_the_end_of_a_cause() {
    let place = Place::with_log();
    place.write("my; notes.txt", "run 1 was good; run 2 was not\n");
    for (log, lines) in [
        ("no; where.mcap", ["error: there is no file `no; where.mcap`", "  Check the path."]),
        (
            "my; notes.txt",
            [
                "error: `my; notes.txt` is not an MCAP recording, and no CSV table or rosbag2 either: it is a text file without a table",
                "  Name a recording (`.mcap`), a CSV table with a header and rows of numbers, or the folder of a bag.",
            ],
        ),
    ] {
        let run = place.run_in_vain(&["replay", log]).fails(1, &[]);
        assert_eq!(run.stderr.lines().collect::<Vec<_>>(), lines);
    }
    place.write("my; robot.toml", example_robot().replacen("mu = 0.016", "mu = 1.6", 1));
    let run = place.run_in_vain(&["replay", "log.mcap", "--model", "my; robot.toml"]).fails(1, &[]);
    let lines: Vec<&str> = run.stderr.lines().collect();
    assert!(lines[0].starts_with("error: my; robot.toml, line "), "{run:#?}");
    assert!(lines[0].ends_with("`mu` is 1.6; allowed is 0 to 0.9"), "{run:#?}");
    assert_eq!(lines[1..], ["  Correct the robot file, or name another one with --model."]);
}

#[test]
fn a_log_without_a_robot_needs_one() {
    let place = Place::with_log();
    let bare = rewrite(short_log(), Storage::Zstd, None, |_, _| true);
    place.write("bare.mcap", bare);
    place
        .run_in_vain(&["replay", "bare.mcap", "-o", "out.mcap"])
        .fails(1, &["no robot file attached", "fric-robot.toml"])
        .advises(&["--model", "fric-cli init LOG -o robot.toml"]);
    let info = place.run_in_vain(&["info", "bare.mcap"]).succeeds();
    assert!(info.stdout.contains("/cable_states") && info.stdout.contains("--model"), "{info:#?}");
    // With the file named, it is the log it was.
    let named = place.run(&["replay", "bare.mcap", "--model", "robot.toml", "-o", "named.mcap"]).succeeds();
    let attached = place.run(&["replay", "log.mcap", "-o", "attached.mcap"]).succeeds();
    assert!(place.read("named.mcap") == place.read("attached.mcap"));
    let table = |run: &Run| {
        let is_same = |line: &&str| !line.contains("one takes") && !line.starts_with("wrote ");
        run.stdout.lines().filter(is_same).collect::<String>()
    };
    assert_eq!(table(&named), table(&attached));
}

#[test]
fn a_robot_file_that_is_not_there_is_told() {
    let place = Place::with_log();
    for start in [&["replay", "log.mcap"][..], &["info", "log.mcap"], &["simulate", "-o", "new.mcap"]] {
        let run = |model| place.run_in_vain(&[start, &["--model", model]].concat());
        run("nowhere.toml").fails(1, &["robot file nowhere.toml"]).advises(&["--model"]);
        run(".").fails(1, &["robot file ."]).advises(&["--model"]);
        run("log.mcap").fails(1, &["robot file log.mcap"]).advises(&["--model"]);
    }
}

#[test]
fn a_robot_with_other_cables_is_told_both_lists() {
    let place = Place::with_log();
    place.write("ropes.toml", example_robot().replace("\"cable", "\"rope"));
    let arguments = ["replay", "log.mcap", "--model", "ropes.toml", "-o", "out.mcap"];
    place.run_in_vain(&arguments).fails(1, &["`/cable_states`", "rope1, rope2", "cable1, cable2"]);
    let info = place.run_in_vain(&["info", "log.mcap", "--model", "ropes.toml"]);
    assert!(info.stdout.contains("impossible") && info.stdout.contains("rope1"), "{info:#?}");
    // One cable of eight: the others are compensated, and the one is named.
    place.write("rope.toml", example_robot().replace("\"cable3\"", "\"rope3\""));
    let one = place.run(&["replay", "log.mcap", "--model", "rope.toml"]).warns(&["no signal of rope3"]);
    assert!(one.stdout.lines().any(|line| line.trim_start().starts_with("rope3") && line.contains('–')), "{one:#?}");
}

/// Replays with something put under `[log]`, which has to fail.
#[track_caller]
fn refuses(log_table: &str, words: &[&str]) {
    let place = Place::with_log();
    place.write("other.toml", example_robot() + "\n[log]\n" + log_table);
    let arguments = ["replay", "log.mcap", "--model", "other.toml", "-o", "out.mcap", "--json", "j.json"];
    place.run_in_vain(&arguments).fails(1, words);
}

#[test]
fn a_cable_signal_that_is_not_there_is_told() {
    refuses("cable = '/winch'", &["`/winch`", "/cable_states", "/platform_pose"]);
    refuses("cable = '/cable_states.efort[:]'", &["`/cable_states`", "`efort", "effort"]);
    refuses("cable = '/platform_pose'", &["`/platform_pose`"]);
    refuses("cable = '/cable_states.effort[:'", &["other.toml", "`cable`", "character 23", "`]`"]);
    refuses("reference = 'reference forces'", &["other.toml", "`reference`", "character"]);
    refuses("cabel = '/cable_states'", &["other.toml", "line ", "`cabel`", "`cable`"]);
}

#[test]
fn other_signals_that_are_not_there_are_warned_of() {
    let place = Place::with_log();
    place.write("other.toml", example_robot() + "\n[log]\nreference = '/reference_forces.nix'\n");
    let run = place.run(&["replay", "log.mcap", "--model", "other.toml"]);
    run.warns(&["reference signal `/reference_forces.nix`", "no member `nix`"])
        .warns(&["no reference forces on /reference_forces.nix"]);
    place.write("bare.mcap", without(short_log(), &["/reference_forces"]));
    let run = place.run(&["replay", "bare.mcap"]);
    run.warns(&[
        "no reference forces on /reference_forces for these cables",
        "columns of errors",
        "`reference` under `[log]`",
    ]);
    place.write("poseless.mcap", without(short_log(), &["/platform_pose"]));
    place.run(&["replay", "poseless.mcap"]).warns(&["no pose", "`pose`"]);
    place.write("cableless.mcap", without(short_log(), &["/cable_states"]));
    place.run_in_vain(&["replay", "cableless.mcap", "-o", "o.mcap"]).fails(1, &["`/cable_states`", "/platform_pose"]);
}

#[test]
fn a_log_without_messages_is_told() {
    let place = Place::empty();
    place.write("log.mcap", rewrite(short_log(), Storage::Zstd, Some(&example_robot()), |_, _| false));
    place.run_in_vain(&["replay", "log.mcap", "-o", "out.mcap"]).fails(1, &["no messages"]);
    let info = place.run_in_vain(&["info", "log.mcap"]);
    assert_eq!(info.code, Some(0), "{info:#?}");
    assert!(info.stdout.contains("impossible"), "{info:#?}");
}

/// The log with the stamps of a topic taken from a clock that began with the controller.
fn with_another_clock(topic: &str) -> Vec<u8> {
    with_data(short_log(), topic, |data| {
        // Behind the four bytes that say how it is encoded: seconds.
        let mut data = data.to_vec();
        data[4..8].copy_from_slice(&12_i32.to_le_bytes());
        data
    })
}

#[test]
fn a_signal_on_another_clock_is_told_and_no_other_topic_is_advised() {
    let place = Place::with_log();
    place.write("log.mcap", with_another_clock("/reference_forces"));
    let told = ["reference signal `/reference_forces`: none of its", "stamped 12.000 … 12.", "one clock"];
    let run = place.run(&["replay", "log.mcap"]).warns(&told);
    assert!(!run.stderr.contains("under `[log]`"), "{run:#?}");
    for command in ["fit", "discover"] {
        let run = place.run_in_vain(&[command, "log.mcap", "-o", "out.toml"]);
        assert!(run.stderr.starts_with(&format!("warning: {}", told[0])), "{run:#?}");
        let run = run.fails(1, &["no message of the reference signal is of a time of the cable signal"]);
        assert!(!run.advises(&["one clock", "stamp of zero"]).stderr.contains("under `[log]`"));
    }
    place.run(&["info", "log.mcap", "--json", "j.json"]).succeeds();
    let signals = place.json("j.json")["signals"].clone();
    let signal = signals.as_array().unwrap().iter().find(|signal| signal["signal"] == "reference").unwrap();
    assert_eq!(signal["messages"], 0, "{signal}");
    assert!(signal["remarks"][0].as_str().unwrap().starts_with("none of its 400 messages"), "{signal}");

    place.write("log.mcap", with_another_clock("/platform_pose"));
    let run = place.run(&["replay", "log.mcap"]).warns(&["pose signal `/platform_pose`: none of its"]);
    assert!(!run.warns(&["no row has a pose", "90°"]).stderr.contains("under `[log]`"));
    let run = place.run_in_vain(&["fit", "log.mcap", "--reference", "wrench", "-o", "out.toml"]);
    run.fails(1, &["no message of the pose signal"]).advises(&["one clock"]);
}
