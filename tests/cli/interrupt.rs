//! Ctrl-C and its like: no half file, no temporary one.
#![cfg(unix)]

use std::thread::sleep;
use std::time::Duration;

use nix::sys::signal::Signal::{self, SIGINT, SIGTERM};

use super::support::{Place, root};

/// Starts the program, sends it the signal once its output is in the making, and looks at what is left.
fn interrupt(arguments: &[&str], signal: Signal) {
    interrupt_after(arguments, signal, Duration::ZERO);
}

/// The same some time later.
fn interrupt_after(arguments: &[&str], signal: Signal, delay: Duration) {
    let place = Place::empty();
    place.write("robot.toml", super::support::example_robot());
    let mut program = place.start(arguments);
    program.wait_until(|| place.names().iter().any(|name| name.starts_with(".fric-")));
    sleep(delay);
    program.signal(signal);
    let output = program.end();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?} {signal}: {stderr}");
    assert_eq!(stderr, "error: interrupted before the end: nothing was written\n");
    assert_eq!(output.stdout, b"");
    assert_eq!(place.names(), ["robot.toml"], "{arguments:?} {signal}");
}

#[test]
fn an_interrupted_simulation_leaves_nothing() {
    for signal in [SIGINT, SIGTERM] {
        interrupt(&["simulate", "--model", "robot.toml", "-o", "out.mcap", "--duration", "100000"], signal);
    }
}

#[test]
fn an_interrupted_replay_leaves_nothing() {
    let log = root().join("examples/mini-ipanema.mcap");
    for signal in [SIGINT, SIGTERM] {
        let outputs = ["-o", "out.mcap", "--report", "out.html", "--json", "out.json"];
        interrupt(&[&["replay", log.to_str().unwrap()], &outputs[..]].concat(), signal);
    }
}

#[test]
fn an_interrupted_fit_leaves_nothing() {
    let log = root().join("examples/mini-ipanema.mcap");
    for signal in [SIGINT, SIGTERM] {
        // At once: it reads the log.
        interrupt(&["fit", log.to_str().unwrap(), "-o", "out.toml", "--json", "out.json"], signal);
    }
}

/// Where nothing looks for the first signal, as while stdout takes nothing more, the second one ends the process.
#[test]
fn a_second_signal_ends_at_once() {
    let place = Place::empty();
    place.write("arm.toml", super::continuum::prototype());
    let simulate = ["continuum", "simulate", "--model", "arm.toml", "-o", "run.csv", "--calibration", "loads.csv"];
    place.run(&simulate).succeeds();
    place.run(&["continuum", "calibrate", "loads.csv", "--model", "arm.toml", "-o", "cal.toml"]).succeeds();
    // More than a pipe holds.
    let mut program = place.start(&["continuum", "shape", "run.csv", "--model", "cal.toml", "--json", "-"]);
    program.prints();
    program.signal(SIGTERM);
    sleep(Duration::from_millis(500));
    assert!(program.is_running());
    program.signal(SIGTERM);
    assert_eq!(program.end().status.code(), Some(1));
}

/// A second after the beginning it has read the log, and searches for several more.
#[test]
fn a_fit_interrupted_in_its_search_leaves_nothing() {
    let log = root().join("examples/mini-ipanema.mcap");
    let arguments = ["fit", log.to_str().unwrap(), "--reference", "wrench", "-o", "out.toml", "--json", "out.json"];
    interrupt_after(&arguments, SIGINT, Duration::from_secs(1));
}

/// The same, in the search for what is missing.
#[test]
fn an_interrupted_discovery_leaves_nothing() {
    let log = root().join("examples/mini-ipanema.mcap");
    let outputs = ["-o", "out.toml", "--report", "out.html", "--json", "out.json"];
    let arguments = [&["discover", log.to_str().unwrap()], &outputs[..]].concat();
    interrupt(&arguments, SIGINT);
    interrupt_after(&arguments, SIGTERM, Duration::from_secs(1));
}
