//! Robot files with mistakes in them: the message names file, line and key, and what is right.

use super::logs::{Storage, rewrite};
use super::support::{Place, example_robot, root, short_log};

const FRICTION: &str = "friction = { mu = 0.016, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.17 }";

/// The example's robot file with one change, and the line, from 1, where it is.
fn changed(from: &str, to: &str) -> (String, String) {
    let text = example_robot();
    let at = text.find(from).unwrap_or_else(|| panic!("{from} is not in the example"));
    let line = text[..at].lines().count() + usize::from(text[..at].ends_with('\n'));
    (text.replacen(from, to, 1), format!("bad.toml, line {line}"))
}

/// All commands have to refuse the changed file with these words.
#[track_caller]
fn refuses(from: &str, to: &str, words: &[&str]) {
    let place = Place::with_log();
    let (text, line) = changed(from, to);
    place.write("bad.toml", text);
    for start in [&["replay", "log.mcap", "-o", "o.mcap"][..], &["info", "log.mcap"], &["simulate", "-o", "o.mcap"]] {
        let run = place.run_in_vain(&[start, &["--model", "bad.toml"]].concat()).fails(1, words);
        run.fails(1, &[&line]);
    }
}

#[test]
fn misspelt_keys_are_told_with_the_nearest() {
    refuses("mass_kg", "mass_gk", &["`mass_gk`", "did you mean `mass_kg`"]);
    refuses("cycle_s", "cycles_s", &["`cycles_s`", "did you mean `cycle_s`"]);
    refuses(FRICTION, &FRICTION.replace("mu", "nu"), &["`nu`", "did you mean `mu`"]);
    refuses(FRICTION, &FRICTION.replace("viscous_n_s_per_m", "viscous"), &["`viscous`", "`viscous_n_s_per_m`"]);
    refuses("{ wrap_deg = 180.0", "{ wrap_dge = 180.0", &["`wrap_dge`", "did you mean `wrap_deg`"]);
}

#[test]
fn numbers_that_are_none_or_out_of_range_are_told_with_the_range() {
    for (value, shown) in [("nan", "NaN"), ("inf", "inf"), ("-0.1", "-0.1"), ("7.0", "7")] {
        let to = FRICTION.replace("0.016", value);
        refuses(FRICTION, &to, &["cable1", "`mu`", shown, "allowed is 0 to"]);
    }
    refuses("cycle_s = 0.001", "cycle_s = 0.0", &["`cycle_s`", "allowed is"]);
    refuses("cycle_s = 0.001", "cycle_s = nan", &["`cycle_s`", "NaN"]);
    refuses("mass_kg = 0.41", "mass_kg = -1.0", &["`mass_kg`", "-1"]);
}

#[test]
fn values_of_a_wrong_type_are_told() {
    refuses(FRICTION, &FRICTION.replace("0.016", "'much'"), &["much"]);
    refuses("cycle_s = 0.001", "cycle_s = 'often'", &["often"]);
    refuses("name = \"mini-ipanema\"", "name = 5", &["5"]);
    refuses("name = \"mini-ipanema\"", "name = mini-ipanema", &[]);
    refuses("format = \"fric-robot/1\"", "format = \"fric-robot/9\"", &["fric-robot/9", "fric-robot/1"]);
}

#[test]
fn effects_that_are_none_are_told() {
    let with = |effect: &str| format!("{FRICTION}\neffects = [ {{ {effect} }} ]");
    let place = Place::with_log();
    let line = changed(FRICTION, "").1.replace("bad.toml, line ", "").parse::<usize>().unwrap() + 1;
    for (effect, words) in [
        ("kind = 'stribek', ratio = 0.5, velocity_m_per_s = 0.02", &["`stribek`", "did you mean `stribeck`"][..]),
        ("kind = 'stribeck', ratio = nan, velocity_m_per_s = 0.02", &["`ratio`", "NaN"]),
        ("kind = 'stribeck', rati = 0.5, velocity_m_per_s = 0.02", &["`rati`", "`ratio`"]),
    ] {
        place.write("bad.toml", changed(FRICTION, &with(effect)).0);
        let run = place.run_in_vain(&["replay", "log.mcap", "--model", "bad.toml", "-o", "o.mcap"]);
        run.fails(1, &["bad.toml", &format!("line {line}")]).fails(1, words);
    }
}

#[test]
fn a_bad_robot_file_in_the_log_is_told_as_such() {
    let place = Place::with_log();
    let robot = example_robot().replacen("mu = 0.016", "mu = nan", 1);
    place.write("bad.mcap", rewrite(short_log(), Storage::Zstd, Some(&robot), |_, _| true));
    let run = place.run_in_vain(&["replay", "bad.mcap", "-o", "o.mcap"]);
    run.fails(1, &["fric-robot.toml attached to the log, line ", "`mu`", "NaN"]);
    // A good one beside it takes its place.
    place.run(&["replay", "bad.mcap", "--model", "robot.toml"]).succeeds();
}

#[test]
fn effects_that_do_nothing_are_warned_of() {
    let place = Place::with_log();
    let with = |effects: &str| {
        let text = example_robot();
        let (head, tail) = text.split_once("[[cable]]").unwrap();
        format!("{head}[[cable]]\neffects = [ {effects} ]{tail}")
    };
    for idle in ["{ kind = 'stribeck', ratio = 0.0 }", "{ kind = 'stribeck' }"] {
        place.write("idle.toml", with(&format!("{idle}, {{ kind = 'time_delay', delay_s = 0.002 }}")));
        for command in ["replay", "info"] {
            let run = place.run(&[command, "log.mcap", "--model", "idle.toml"]);
            let run = run.warns(&["`stribeck`", "of cable1 ", "neutral", "does nothing"]);
            assert!(!run.stderr.contains("time_delay"), "{run:#?}");
        }
    }
}

#[test]
fn a_cycle_time_that_no_controller_has_is_warned_of() {
    let place = Place::with_log();
    place.write("slow.toml", example_robot().replacen("cycle_s = 0.001", "cycle_s = 1.0", 1));
    for command in ["replay", "info"] {
        place.run(&[command, "log.mcap", "--model", "slow.toml"]).warns(&["`cycle_s`", "is 1 s", "0.001 at 1 kHz"]);
        assert!(!place.run(&[command, "log.mcap", "--model", "robot.toml"]).stderr.contains("`cycle_s`"));
    }
}

#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_not_waited_for() {
    let place = Place::with_log();
    let elsewhere = tempfile::Builder::new().prefix("elsewhere").tempdir().unwrap();
    let pipe = elsewhere.path().join("pipe");
    nix::unistd::mkfifo(&pipe, nix::sys::stat::Mode::S_IRWXU).unwrap();
    place.write("tendon.toml", std::fs::read(root().join("examples/tendon-prototype.toml")).unwrap());
    for file in [pipe.to_str().unwrap(), "/dev/zero"] {
        place.run_in_vain(&["replay", "log.mcap", "--model", file]).fails(1, &[file, "no regular file"]);
        place.run_in_vain(&["replay", file, "--model", "robot.toml"]).fails(1, &[file]);
        place
            .run_in_vain(&["excite", "--model", "robot.toml", "--for", file, "-o", "run.csv"])
            .fails(1, &[file, "regular"]);
        place.run_in_vain(&["continuum", "friction", file, "--model", "tendon.toml"]).fails(1, &[file, "regular"]);
    }
}

#[test]
fn what_a_file_says_never_commands_a_terminal() {
    refuses("name = \"mini-ipanema\"", "name = \"a\\u001b[2J\\nerror: forged\"", &["`name`", "control character"]);
    refuses("name = \"cable3\"", "name = \"c\\u0007\"", &["`name`", "control character"]);
    // An unknown key is quoted, and so is a text where a number should be.
    refuses("cycle_s = 0.001", "\"cy\\u001b[31m\" = 0.001", &["cy\\u{1b}[31m"]);
    refuses("cycle_s = 0.001", "cycle_s = \"\\u009b31m\"", &["u{9b}31m"]);
}

/// Nor does what a log says: U+009B begins a command as ESC [ does, and JSON leaves it as it is.
#[test]
fn what_a_log_says_never_commands_a_terminal() {
    let place = Place::with_log();
    let rows: String = (0..20).map(|row| format!("0.{row:03},1,2,3\n")).collect();
    place.write("run.csv", format!("time_s,\u{9b}31m,cable1.force_n,cable1.length_m\n{rows}"));
    let run = place.run(&["info", "run.csv", "--model", "robot.toml", "--json", "-", "--report", "page.html"]);
    assert_eq!(run.code, Some(0), "{run:#?}");
    let page = String::from_utf8(place.read("page.html")).unwrap();
    for text in [&run.stdout, &run.stderr, &page] {
        assert!(!text.contains('\u{9b}'), "{text}");
    }
    assert!(run.stdout.contains("\\u009b31m") && page.contains("u{9b}31m"), "{run:#?}");
}

#[test]
fn a_file_of_many_cables_or_bytes_is_refused_at_once() {
    let place = Place::with_log();
    place.write("huge.toml", example_robot() + &"#".repeat(2_000_000));
    place.run_in_vain(&["replay", "log.mcap", "--model", "huge.toml"]).fails(1, &["huge.toml", "1 MiB"]);
    let cable = |k: u32| format!("[[cable]]\nname = \"c{k}\"\n{FRICTION}\npulleys = []\n");
    let cables = (0..2_000).map(cable).collect::<Vec<_>>().concat();
    let head = "format = \"fric-robot/1\"\nname = \"many\"\ncycle_s = 0.001\n";
    place.write("many.toml", format!("{head}{cables}"));
    place.run_in_vain(&["replay", "log.mcap", "--model", "many.toml"]).fails(1, &["many.toml", "`cable`", "64"]);
    // What is quoted of a mistake is short.
    place.write("long.toml", format!("{head}{} = 1\n", "k".repeat(500_000)));
    let run = place.run_in_vain(&["replay", "log.mcap", "--model", "long.toml"]).fails(1, &["long.toml"]);
    assert!(run.stderr.len() < 5_000, "{}", run.stderr.len());
}
