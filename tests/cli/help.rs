//! `--help`: each command has an example, and the example runs.

use super::fit::platform_robot;
use super::support::{Place, slow_robot};

/// The commands that the program names.
fn commands(place: &Place) -> Vec<String> {
    let help = place.run(&["--help"]).succeeds().stdout;
    let list = help.split_once("Commands:\n").unwrap().1.split("\n\n").next().unwrap();
    let names = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.map(|line| line.split_whitespace().next().unwrap().to_owned()).filter(|name| name != "help").collect()
}

/// The examples of a command as they are to be typed.
fn examples(help: &str) -> Vec<Vec<String>> {
    let (_, text) = help.split_once("Example:\n").or_else(|| help.split_once("Examples:\n")).unwrap_or_default();
    // A long line is wrapped; the program's name begins a new one.
    let joined = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let lines = joined.split("fric-cli ").skip(1);
    lines.map(|line| line.split_whitespace().map(ToOwned::to_owned).collect()).collect()
}

#[test]
fn each_command_has_an_example_that_runs() {
    let place = Place::empty();
    // What stands in examples/, but at a slow pace, to keep the tests short.
    std::fs::create_dir(place.path("examples")).unwrap();
    place.write("examples/mini-ipanema.toml", slow_robot());
    let manipulator = std::fs::read(super::support::root().join("examples/tendon-prototype.toml")).unwrap();
    place.write("examples/tendon-prototype.toml", manipulator);
    // Long enough for a discovery.
    place.write("examples/platform.toml", platform_robot());
    let log = ["-o", "examples/mini-ipanema.mcap", "--duration", "14", "--seed", "3"];
    place.run(&[&["simulate", "--model", "examples/platform.toml"], &log[..]].concat()).succeeds();
    let commands = commands(&place);
    for expected in
        ["replay", "fit", "completions", "man", "discover", "info", "simulate", "excite", "hysteresis", "continuum"]
    {
        assert!(commands.iter().any(|command| command == expected), "{commands:?}");
    }
    for command in commands {
        let help = place.run(&[&command, "--help"]).succeeds().stdout;
        let examples = examples(&help);
        assert!(!examples.is_empty(), "{help}");
        for example in examples {
            assert_eq!(example[0], command);
            let mut arguments: Vec<&str> = example.iter().map(String::as_str).collect();
            // The crossing run is whole, for `hysteresis` needs it.
            if command == "simulate" && !arguments.contains(&"crossing") {
                arguments.extend(["--duration", "0.1"]);
            }
            place.run(&arguments).succeeds();
        }
    }
    assert_eq!(
        place.names(),
        [
            "by-wrench.toml",
            "calibrated.toml",
            "compensated.mcap",
            "converted.mcap",
            "crossing.mcap",
            "discovery.html",
            "draft.toml",
            "examples",
            "extended.toml",
            "fitted.toml",
            "gentle.csv",
            "loads.csv",
            "man1",
            "pull.csv",
            "run.csv",
            "run.html",
            "shapes.html",
            "simulated.mcap",
            "spoilt.mcap",
            "tell.csv"
        ]
    );
}

#[test]
fn the_examples_name_files_that_are_there() {
    let root = super::support::root();
    for name in ["examples/mini-ipanema.mcap", "examples/mini-ipanema.toml", "examples/tendon-prototype.toml"] {
        assert!(root.join(name).is_file(), "{name}");
    }
}
