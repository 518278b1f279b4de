//! What the terminal sees: colours, how much is said, width of the tables, completions and manual pages.

use super::logs::{Storage, messages, rewrite};
use super::simulate::bench_robot;
use super::support::{Place, Run, command, example_robot, unwrapped};

/// What begins a colour.
const ESCAPE: char = '\u{1b}';

/// The program with a variable set in its environment.
fn run_with(place: &Place, variable: (&str, &str), arguments: &[&str]) -> Run {
    Run::new(command(&place.path(""), arguments).env(variable.0, variable.1).output().unwrap())
}

#[test]
fn colours_come_where_they_are_asked_for() {
    let place = Place::with_log();
    for (arguments, is_colored) in [
        (&["replay", "no.mcap"][..], false),
        (&["replay", "no.mcap", "--color", "auto"], false),
        (&["replay", "no.mcap", "--color", "never"], false),
        (&["replay", "no.mcap", "--color", "always"], true),
        (&["--color=always", "replay", "no.mcap"], true),
        // The parser's own errors too.
        (&["replay", "--color=always", "--nonsense"], true),
        (&["replay", "--nonsense"], false),
    ] {
        let run = place.run_in_vain(arguments);
        assert_eq!(run.stderr.contains(ESCAPE), is_colored, "{run:#?}");
        assert!(run.stderr.contains("error:"), "{run:#?}");
    }
    // What is asked for stands above the environment.
    assert!(run_with(&place, ("NO_COLOR", "1"), &["replay", "no.mcap", "--color", "always"]).stderr.contains(ESCAPE));
    let forced = run_with(&place, ("CLICOLOR_FORCE", "1"), &["replay", "no.mcap", "--color", "never"]);
    assert!(!forced.stderr.contains(ESCAPE), "{forced:#?}");
    place.run_in_vain(&["info", "log.mcap", "--color", "pink"]).fails(2, &["pink", "auto", "always", "never"]);
}

#[test]
fn quiet_leaves_the_result_and_errors() {
    let place = Place::with_log();
    let log = place.read("log.mcap");
    place.write("cut.mcap", &log[..log.len() * 2 / 3]);
    let loud = place.run(&["replay", "cut.mcap", "--model", "robot.toml", "--json", "j.json"]);
    assert!(loud.stderr.contains("warning:") && loud.stdout.contains("wrote j.json: the result as JSON"), "{loud:#?}");
    let quiet =
        place.run(&["replay", "cut.mcap", "--model", "robot.toml", "--json", "j.json", "--force", "-q"]).succeeds();
    assert!(quiet.stdout.contains("cable8") && !quiet.stdout.contains("wrote"), "{quiet:#?}");
    place.run_in_vain(&["replay", "no.mcap", "-q"]).fails(1, &["no.mcap"]);
    let json = place.run(&["replay", "cut.mcap", "--model", "robot.toml", "--json", "-", "--quiet"]).succeeds();
    assert!(json.stdout.starts_with('{'), "{json:#?}");
    place.run_in_vain(&["replay", "log.mcap", "-q", "-v"]).fails(2, &["--quiet", "--verbose"]);
}

#[test]
fn verbose_says_which_model_and_how_long() {
    let place = Place::with_log();
    let run = place.run(&["replay", "log.mcap", "-v"]);
    assert!(run.stderr.lines().all(|line| line.starts_with("note: ")), "{run:#?}");
    for words in ["robot: mini-ipanema from fric-robot.toml", "reading took", "done in"] {
        assert!(run.stderr.contains(words), "{words}: {run:#?}");
    }
}

#[test]
fn each_output_is_told_after_the_table() {
    let place = Place::with_log();
    let run = place.run(&["replay", "log.mcap", "-o", "o.mcap", "--report", "r.html", "--json", "j.json"]).succeeds();
    let told = run.stdout.split_once("\n\nwrote ").unwrap().1;
    assert_eq!(
        told,
        "o.mcap: forces, friction, wrench and status\nwrote r.html: the report\nwrote j.json: the result as JSON\n\n\
         What to do:\n- See what the model lacks: fric-cli discover with the same log and model.\n"
    );
}

#[test]
fn a_simulation_tells_the_defaults_that_it_took() {
    let place = Place::empty();
    place.write("robot.toml", bench_robot());
    let hidden = ["--effect", "stribeck:ratio=0.5", "--disturbance", "hum:amplitude_n=0.1"];
    let start = ["simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "0.1"];
    let run = place.run(&[&start[..], &hidden].concat()).succeeds();
    let told = unwrapped(&run.stdout);
    assert!(told.contains("stribeck:ratio=0.5 (by default velocity_m_per_s=0.02)"), "{run:#?}");
    assert!(told.contains("hum:amplitude_n=0.1 (by default frequency_hz=50)"), "{run:#?}");
}

/// Eight cables with names as they are usual.
#[test]
fn tables_fit_into_80_columns() {
    let place = Place::empty();
    let names = ["upper_fl", "upper_fr", "upper_bl", "upper_br", "lower_fl", "lower_fr", "lower_bl", "lower_br"];
    let robot = names.iter().enumerate().fold(example_robot(), |text, (index, name)| {
        text.replace(&format!("\"cable{}\"", index + 1), &format!("\"{name}\""))
    });
    place.write("robot.toml", robot.replacen("cycle_s = 0.001", "cycle_s = 0.01", 1));
    place.run(&["simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "14", "--seed", "3"]).succeeds();
    for arguments in [
        &["replay", "log.mcap"][..],
        &["info", "log.mcap"],
        &["fit", "log.mcap", "-o", "fitted.toml"],
        &["fit", "log.mcap", "-o", "by-wrench.toml", "--reference", "wrench"],
        &["init", "log.mcap", "-o", "draft.toml"],
    ] {
        let run = place.run(arguments);
        assert_eq!(run.code, Some(0), "{run:#?}");
        let widest = run.stdout.lines().max_by_key(|line| line.chars().count()).unwrap();
        assert!(widest.chars().count() <= 80, "{widest:?} of {}", run.stdout);
    }
}

#[test]
fn a_log_that_ends_between_two_poses_is_no_reason_to_warn() {
    let place = Place::empty();
    place.write("robot.toml", example_robot());
    place.run(&["simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "0.2"]).succeeds();
    // Poses come every four cycles; those of the last 10 ms are taken away.
    let log = place.read("log.mcap");
    let end_nanos = messages(&log)[0].log_time_nanos + 190_000_000;
    let is_kept = |topic: &str, time_nanos| topic != "/platform_pose" || time_nanos < end_nanos;
    place.write("cut.mcap", rewrite(&log, Storage::Zstd, Some(&example_robot()), is_kept));
    place.run(&["replay", "cut.mcap", "--json", "j.json"]).succeeds();
    // They are counted all the same.
    assert!(place.json("j.json")["cables"][0]["flagged"].as_u64().unwrap() > 0);
}

#[test]
fn every_shell_gets_its_completions() {
    let place = Place::empty();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let run = place.run(&["completions", shell]).succeeds();
        for word in ["fric-cli", "replay", "continuum", "--model"] {
            assert!(run.stdout.contains(word.trim_start_matches("--")), "{word} for {shell}");
        }
    }
    place.run(&["completions", "cmd"]).fails(2, &["cmd", "bash", "zsh", "fish"]);
}

#[test]
fn each_command_has_a_manual_page() {
    let place = Place::empty();
    place.run(&["man", "pages/man1"]).succeeds();
    for name in ["fric-cli", "fric-cli-replay", "fric-cli-continuum-shape", "fric-cli-man"] {
        let page = String::from_utf8(place.read(&format!("pages/man1/{name}.1"))).unwrap();
        assert!(page.contains(".TH") && page.contains(".SH OPTIONS"), "{name}: {page}");
    }
    place.run(&["man", "pages/man1"]).fails(1, &["exists already"]).advises(&["--force"]);
    place.run(&["man", "pages/man1", "--force"]).succeeds();
    place.write("file", "no directory");
    place.run(&["man", "file"]).fails(1, &["file is no directory"]).advises(&["Name a directory"]);
}
