//! A reader that goes away, as `head` does, is no failure.

use std::process::Stdio;

use super::support::Place;

fn assert_quiet(place: &Place, arguments: &[&str]) {
    let mut child = place.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // The pipe's reading end: closed before the program says anything.
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "", "{arguments:?}");
    assert!(output.status.success(), "{arguments:?}");
}

#[test]
fn a_closed_stdout_is_silently_accepted() {
    let place = Place::with_log();
    assert_quiet(&place, &["replay", "log.mcap"]);
    assert_quiet(&place, &["info", "log.mcap"]);
    assert_quiet(&place, &["info", "log.mcap", "--json", "j.json"]);
    assert_quiet(&place, &["simulate", "--model", "robot.toml", "-o", "new.mcap", "--duration", "0.05"]);
    assert_quiet(&place, &["--help"]);
    assert_quiet(&place, &["replay", "--help"]);
    assert_quiet(&place, &["--version"]);
    // What was asked for is there all the same.
    assert_eq!(place.names(), ["j.json", "log.mcap", "new.mcap", "robot.toml"]);
}

#[test]
fn a_closed_stdout_does_not_stop_the_outputs() {
    let place = Place::with_log();
    assert_quiet(&place, &["replay", "log.mcap", "-o", "out.mcap", "--report", "r.html", "--json", "j.json"]);
    assert_eq!(place.names(), ["j.json", "log.mcap", "out.mcap", "r.html", "robot.toml"]);
}
