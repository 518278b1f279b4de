//! A reader that goes away, as `head` does, is no failure.

use super::support::Place;

fn assert_quiet(place: &Place, arguments: &[&str]) {
    let mut program = place.start(arguments);
    // Before it says anything.
    program.close_stdout();
    let output = program.end();
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
