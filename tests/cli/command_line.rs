//! Command lines that are wrong: exit code 2, and nothing is touched.

use super::support::Place;

#[test]
fn the_discovery_of_a_manipulator_is_found_where_one_looks_for_it() {
    let place = Place::empty();
    let run = place.run(&["continuum", "discover", "pull.csv"]);
    assert!(
        run.code == Some(2) && run.stderr.contains("tip: ") && run.stderr.contains("fric-cli discover RUN --model"),
        "{run:#?}"
    );
    assert!(!place.run(&["continuum", "discovr"]).stderr.contains("fric-cli discover RUN"));
}

#[test]
fn what_is_no_command_line_is_told() {
    let place = Place::with_log();
    place.run_in_vain(&["replai", "log.mcap"]).fails(2, &["replai"]);
    place.run_in_vain(&["replay"]).fails(2, &["required arguments"]);
    place.run_in_vain(&["replay", "log.mcap", "--wrong"]).fails(2, &["--wrong"]);
    place.run_in_vain(&["replay", "log.mcap", "--model"]).fails(2, &["--model"]);
    place.run_in_vain(&["replay", "log.mcap", "-o", ""]).fails(2, &["--output"]);
    place.run_in_vain(&["info"]).fails(2, &["required arguments"]);
    place.run_in_vain(&["simulate", "-o", "new.mcap"]).fails(2, &["required arguments"]);
    place.run_in_vain(&["simulate", "--model", "robot.toml"]).fails(2, &["required arguments"]);
    place.run_in_vain(&["simulate", "--model", "robot.toml", "--model", "robot.toml"]).fails(2, &["--model"]);
    let help = place.run_in_vain(&[]);
    assert_eq!((help.code, help.stdout.as_str()), (Some(2), ""));
    assert!(help.stderr.contains("replay"), "{help:#?}");
}

/// `simulate` with one more option.
fn simulate(place: &Place, option: &str, value: &str) -> super::support::Run {
    place.run_in_vain(&["simulate", "--model", "robot.toml", "-o", "new.mcap", option, value])
}

#[test]
fn effects_that_are_none_are_told() {
    let place = Place::with_log();
    for (effect, words) in [
        ("stribek:ratio=0.5", &["`stribek`; did you mean `stribeck`?", "`time_delay`"][..]),
        ("", &["--effect"]),
        ("stribeck", &["stribeck", "`ratio`"]),
        ("stribeck:", &["stribeck", "`ratio`"]),
        ("stribeck:ratio", &["`ratio`", "key=value"]),
        ("stribeck:ratio=x", &["`ratio=x`"]),
        ("stribeck:rati=0.5", &["`rati`; did you mean `ratio`?", "`velocity_m_per_s`"]),
        ("stribeck:ratio=nan", &["`ratio`", "NaN"]),
        ("stribeck:ratio=-1", &["`ratio`", "-1"]),
        ("stribeck:ratio=1e999", &["`ratio`", "inf"]),
        ("stribeck:ratio=0.5,ratio=0.6", &["`ratio`", "twice"]),
        ("time_delay:delay_s=-1.5", &["`delay_s`", "-1.5"]),
    ] {
        let run = simulate(&place, "--effect", effect).fails(2, &["--effect"]);
        run.fails(2, words);
    }
    let twice = ["--effect", "time_delay:delay_s=0.001", "--effect", "time_delay:delay_s=0.002"];
    let start = ["simulate", "--model", "robot.toml", "-o", "new.mcap"];
    let run = place.run_in_vain(&[&start[..], &twice].concat());
    run.fails(2, &["--effect", "`time_delay`", "too often"]).advises(&["twice"]);
}

#[test]
fn disturbances_that_are_none_are_told() {
    let place = Place::with_log();
    for (disturbance, words) in [
        ("hmu:amplitude_n=0.1", &["`hmu`; did you mean `hum`?", "`local_defect`"][..]),
        ("hum", &["hum", "`amplitude_n`"]),
        ("hum:amplitude=0.1", &["`amplitude`; did you mean `amplitude_n`?", "`frequency_hz`"]),
        ("hum:amplitude_n=-1", &["`amplitude_n`", "-1", "0 to 1000 N"]),
    ] {
        let run = simulate(&place, "--disturbance", disturbance).fails(2, &["--disturbance"]);
        run.fails(2, words);
    }
    let twice = ["--disturbance", "hum:amplitude_n=0.1", "--disturbance", "hum:amplitude_n=0.2"];
    let start = ["simulate", "--model", "robot.toml", "-o", "new.mcap"];
    place.run_in_vain(&[&start[..], &twice].concat()).fails(2, &["--disturbance", "`hum`", "twice"]);
}

#[test]
fn numbers_out_of_range_are_told() {
    let place = Place::with_log();
    for value in ["-1", "0", "nan", "inf", "1e300", "1e-9"] {
        simulate(&place, "--duration", value).fails(2, &["--duration", "allowed is 0.001 to"]);
    }
    let joined = ["simulate", "--model", "robot.toml", "-o", "new.mcap", "--duration=-inf"];
    place.run_in_vain(&joined).fails(2, &["--duration is -inf"]);
    for option in [
        "--sensor-noise-n",
        "--reference-noise-n",
        "--mu-spread-ratio",
        "--sensor-wander-n",
        "--reference-wander-n",
        "--hand-n",
        "--length-noise-m",
        "--length-resolution-m",
    ] {
        for value in ["-1", "nan", "inf"] {
            simulate(&place, option, value).fails(2, &[option, "allowed is 0 to"]);
        }
    }
    simulate(&place, "--wander-s", "0").fails(2, &["--wander-s is 0.0", "allowed is 0.001 to"]);
    simulate(&place, "--mu-spread-ratio", "1.01").fails(2, &["--mu-spread-ratio", "1.01"]);
    for option in ["--duration", "--sensor-noise-n", "--reference-noise-n", "--mu-spread-ratio"] {
        for value in ["1s", "1,5", "", "x"] {
            simulate(&place, option, value).fails(2, &[option, value, "a number in digits, such as 0 or 1.5"]);
        }
    }
    for value in ["-1", "1.5", "x", "18446744073709551616"] {
        simulate(&place, "--seed", value).fails(2, &["--seed", value, "a whole number, 0 to 18446744073709551615"]);
    }
}

#[test]
fn what_cannot_go_to_stdout_is_refused() {
    let place = Place::with_log();
    for force in [&[][..], &["--force"]] {
        for option in ["-o", "--report"] {
            let run = place.run_in_vain(&[&["replay", "log.mcap", option, "-"], force].concat());
            run.fails(2, &["'-'", "stdout", "name a file"]);
        }
        for command in ["simulate", "excite"] {
            let run = place.run_in_vain(&[&[command, "--model", "robot.toml", "-o", "-"], force].concat());
            run.fails(2, &["'-'", "stdout", "name a file"]);
        }
    }
}

#[test]
fn one_file_for_two_outputs_is_refused() {
    let place = Place::with_log();
    for force in [&[][..], &["--force"]] {
        let replay = |rest: &[&str]| place.run_in_vain(&[&["replay", "log.mcap"], rest, force].concat());
        replay(&["-o", "a", "--json", "a"]).fails(2, &["a is named for two outputs"]).advises(&["of its own"]);
        replay(&["-o", "a", "--report", "./a"]).fails(2, &["a is named for two outputs"]);
    }
}
