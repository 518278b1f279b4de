//! Runs the cycle so many times: for callgrind, for timing against a peer, and to write the peer's input.
//!
//! `cycle_instructions run lumped|per_pulley ROUNDS [CABLES]` · `… input FILE` · `… output lumped|per_pulley FILE`
//! · `… time lumped|per_pulley ROUNDS [CABLES]`: nanoseconds per cycle in the best round, which others on the machine have
//! disturbed least

#![allow(missing_docs, clippy::print_stdout, clippy::expect_used, clippy::cast_precision_loss)]
#![allow(clippy::panic, reason = "a tool for developers: a wrong command line stops it")]

#[path = "support/mod.rs"]
mod support;

use std::fmt::Write as _;

use fric_core::robot::Presliding;
use support::{CABLES, CYCLES, best_ns, cable_options, compensator, inputs};

fn presliding(name: &str) -> Presliding {
    match name {
        "lumped" => Presliding::Lumped,
        "per_pulley" => Presliding::PerPulley,
        other => panic!("`{other}` is neither `lumped` nor `per_pulley`"),
    }
}

fn run_cables(cables: &str, presliding: Presliding, rounds: usize) -> f64 {
    match cables {
        "4" => best_ns::<4>(presliding, rounds),
        "8" => best_ns::<CABLES>(presliding, rounds),
        "16" => best_ns::<16>(presliding, rounds),
        "32" => best_ns::<32>(presliding, rounds),
        "64" => best_ns::<64>(presliding, rounds),
        other => panic!("for {other} cables it is not compiled"),
    }
}

/// Parameters, then the signals of every cycle, as text that any language reads back to the last bit.
fn input_text() -> String {
    let mut text = format!("{CABLES} {CYCLES}\n");
    for options in cable_options::<CABLES>(Presliding::Lumped) {
        let friction = options.friction;
        let geometry = options.geometry.expect("has geometry");
        let sigma_n_per_m = friction.sigma_n_per_m.expect("has presliding");
        let numbers = [friction.mu, sigma_n_per_m, friction.viscous_n_s_per_m, friction.offset_n];
        for number in numbers.into_iter().chain(geometry.base_m).chain(geometry.platform_m) {
            write!(text, "{number:?} ").expect("text grows");
        }
        text.push('\n');
    }
    for input in inputs::<CABLES>() {
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
    let mut compensator = compensator::<CABLES>(presliding);
    for input in inputs::<CABLES>() {
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
        ["run", form, count, cables @ ..] => {
            run_cables(cables.first().unwrap_or(&"8"), presliding(form), rounds(count));
        }
        ["time", form, count, cables @ ..] => {
            println!("{}", run_cables(cables.first().unwrap_or(&"8"), presliding(form), rounds(count)));
        }
        ["input", file] => std::fs::write(file, input_text()).expect("the file can be written"),
        ["output", form, file] => std::fs::write(file, output_text(presliding(form))).expect("the file can be written"),
        _ => panic!("see the head of benches/cycle_instructions.rs for the four ways to call this"),
    }
}
