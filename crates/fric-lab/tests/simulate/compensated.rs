//! The simulated robot against the compensator: two computations of the same friction that share no code.

use fric_core::robot::file::RobotFile;
use fric_core::{Compensator, CycleInput};
use fric_lab::simulate::{HiddenEffect, SimulationOptions};

use super::robots::{bench, bench_with, eight_cables, noiseless, simulate};

/// Rms error of each cable before and after compensation with the robot file's parameters, N.
fn rms_n(robot: &RobotFile, options: &SimulationOptions) -> Vec<(f64, f64)> {
    let mut simulation = simulate(robot, options);
    let mut compensator = Compensator::<8>::new(&robot.params()).unwrap();
    let count = robot.options().cable.len();
    let mut squares = vec![(0.0, 0.0); count];
    let mut cycles = 0.0;
    while let Some(cycle) = simulation.next_cycle() {
        let mut input = CycleInput { pose: cycle.pose, ..CycleInput::default() };
        input.cables[..count].copy_from_slice(cycle.cables);
        let output = compensator.step(&input);
        for ((square, cable), reference_n) in squares.iter_mut().zip(output.cables).zip(cycle.reference_force_n) {
            assert!(cable.status.is_ok(), "{} at cycle {cycles}", cable.status);
            square.0 += (cable.frictionless_n - reference_n).powi(2);
            square.1 += (cable.force_at_platform_n - reference_n).powi(2);
        }
        cycles += 1.0;
    }
    squares.into_iter().map(|(before, after)| ((before / cycles).sqrt(), (after / cycles).sqrt())).collect()
}

/// Noise of the reference and of a sensor at 180°, whose force is halved on the way to the platform.
const FLOOR_N: f64 = 0.014_142_135_623_730_95;

#[test]
fn true_parameters_leave_the_noise() {
    for (cable, (before_n, after_n)) in rms_n(&eight_cables(), &SimulationOptions::default()).into_iter().enumerate() {
        println!("cable {}: {before_n:.4} N -> {after_n:.5} N, {:.4} of the noise", cable + 1, after_n / FLOOR_N);
        assert!(before_n > 0.1);
        assert!(after_n < 1.05 * FLOOR_N, "cable {}: {after_n} N", cable + 1);
    }
}

#[test]
fn without_noise_only_the_discretisation_remains() {
    let options = SimulationOptions { duration_s: Some(12.0), ..noiseless() };
    for (cable, (before_n, after_n)) in rms_n(&eight_cables(), &options).into_iter().enumerate() {
        println!("cable {}: {before_n:.4} N -> {after_n:.6} N", cable + 1);
        assert!(after_n < 1.5e-3, "cable {}: {after_n} N", cable + 1);
    }
}

const BENCH_PULLEYS: &str = "{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }";
const BENCH_FRICTION: &str = "mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.2";

#[test]
fn effects_of_the_file_are_known_to_both() {
    let effects = "effects = [{ kind = \"stribeck\", ratio = 0.5, velocity_m_per_s = 0.03 }, \
                   { kind = \"time_delay\", delay_s = 0.0065 }]";
    let robot = bench_with(BENCH_PULLEYS, BENCH_FRICTION, effects);
    let (before_n, after_n) = rms_n(&robot, &noiseless())[0];
    println!("{before_n:.4} N -> {after_n:.6} N");
    assert!(after_n < 2e-3, "{after_n} N");
}

#[test]
fn hidden_effects_are_not() {
    let robot = bench(BENCH_PULLEYS, BENCH_FRICTION);
    let (_, plain_n) = rms_n(&robot, &noiseless())[0];
    for text in ["stribeck:ratio=0.5,velocity_m_per_s=0.02", "time_delay:delay_s=0.008"] {
        let options = SimulationOptions { effects: vec![HiddenEffect::parse(text).unwrap()], ..noiseless() };
        let (_, after_n) = rms_n(&robot, &options)[0];
        println!("{text}: {after_n:.5} N instead of {plain_n:.5} N");
        assert!(after_n > 100.0 * plain_n && after_n > 0.01);
    }
}

#[test]
fn sensors_at_any_angle_and_in_line() {
    let friction = "mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.1, offset_n = 0.3";
    for pulleys in [
        BENCH_PULLEYS,
        "{ wrap_deg = 90.0, sensor = true }, { wrap_deg = 90.0 }, { wrap_deg = 60.0 }",
        "{ wrap_deg = 125.0, sensor = true }, { wrap_deg = 30.0 }",
        "{ wrap_deg = 90.0 }, { wrap_deg = 120.0 }",
    ] {
        let (before_n, after_n) = rms_n(&bench(pulleys, friction), &noiseless())[0];
        println!("{pulleys}: {before_n:.4} N -> {after_n:.6} N");
        assert!(after_n < 2e-3 && before_n > 0.1, "{pulleys}: {before_n} N -> {after_n} N");
    }
}

#[test]
fn without_presliding_friction_reverses_at_once() {
    let robot = bench(BENCH_PULLEYS, "mu = 0.02");
    let (before_n, after_n) = rms_n(&robot, &noiseless())[0];
    println!("{before_n:.4} N -> {after_n:.6} N");
    // In the cycle of a reversal the whole friction may have the sign of the cycle's displacement or of its last speed.
    assert!(after_n < 0.03 && before_n > 0.2, "{before_n} N -> {after_n} N");
}
