//! Runs the cycle so many times: for callgrind, for timing against a peer, and to write the peer's input.
//!
//! `cycle_instructions run lumped|per_pulley ROUNDS` · `… input FILE` · `… output lumped|per_pulley FILE`
//! · `… time lumped|per_pulley ROUNDS`

#![allow(missing_docs, clippy::print_stdout, clippy::expect_used, clippy::cast_precision_loss)]
#![allow(clippy::panic, reason = "a tool for developers: a wrong command line stops it")]

#[path = "support/mod.rs"]
mod support;

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Instant;

use fric_core::robot::Presliding;
use support::{CABLES, CYCLES, cable_options, compensator, inputs};

fn presliding(name: &str) -> Presliding {
    match name {
        "lumped" => Presliding::Lumped,
        "per_pulley" => Presliding::PerPulley,
        other => panic!("`{other}` is neither `lumped` nor `per_pulley`"),
    }
}

/// `ROUNDS` times the whole motion; gives nanoseconds per cycle.
fn run(presliding: Presliding, rounds: usize) -> f64 {
    let inputs = inputs();
    let mut compensator = compensator(presliding);
    let start = Instant::now();
    for _ in 0..rounds {
        for input in &inputs {
            black_box(compensator.step(black_box(input)));
        }
    }
    start.elapsed().as_secs_f64() * 1e9 / (rounds * CYCLES).max(1) as f64
}

/// Parameters, then the signals of every cycle, as text that any language reads back to the last bit.
fn input_text() -> String {
    let mut text = format!("{CABLES} {CYCLES}\n");
    for options in cable_options(Presliding::Lumped) {
        let friction = options.friction;
        let geometry = options.geometry.expect("has geometry");
        let sigma_n_per_m = friction.sigma_n_per_m.expect("has presliding");
        let numbers = [friction.mu, sigma_n_per_m, friction.viscous_n_s_per_m, friction.offset_n];
        for number in numbers.into_iter().chain(geometry.base_m).chain(geometry.platform_m) {
            write!(text, "{number:?} ").expect("text grows");
        }
        text.push('\n');
    }
    for input in inputs() {
        let pose = input.pose.expect("has a pose");
        for number in pose.position_m.iter().chain(pose.orientation.coords.iter()) {
            write!(text, "{number:?} ").expect("text grows");
        }
        for cable in input.cables {
            write!(text, "{:?} {:?} {:?} ", cable.sensor_force_n, cable.length_m, cable.speed_m_per_s)
                .expect("text grows");
        }
        text.push('\n');
    }
    text
}

/// Forces at the platform and outside wrench of every cycle.
fn output_text(presliding: Presliding) -> String {
    let mut text = String::new();
    let mut compensator = compensator(presliding);
    for input in inputs() {
        let output = compensator.step(&input);
        assert!(output.cables.iter().all(|cable| cable.status.is_ok()), "the motion must be free of faults");
        let wrench = output.outside_wrench.expect("has a pose").to_vector();
        for number in output.cables.iter().map(|cable| cable.force_at_platform_n).chain(wrench.iter().copied()) {
            write!(text, "{number:?} ").expect("text grows");
        }
        text.push('\n');
    }
    text
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let rounds = |text: &str| text.parse::<usize>().expect("a number of rounds");
    match arguments.as_slice() {
        ["run", form, count] => {
            run(presliding(form), rounds(count));
        }
        ["time", form, count] => println!("{}", run(presliding(form), rounds(count))),
        ["input", file] => std::fs::write(file, input_text()).expect("the file can be written"),
        ["output", form, file] => std::fs::write(file, output_text(presliding(form))).expect("the file can be written"),
        _ => panic!("see the head of benches/cycle_instructions.rs for the four ways to call this"),
    }
}
