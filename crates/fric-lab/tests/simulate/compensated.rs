//! The simulated robot against the compensator: two computations of the same friction that share no code.

use fric_core::effects::Effect;
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

/// A bench under the usual noise with a hand that pushes: before, and with effects in the robot file that the model knows.
fn known_to_both(effects: &str) -> (f64, f64) {
    let with = |effects: &str| bench_with(BENCH_PULLEYS, BENCH_FRICTION, &format!("effects = [{effects}]"));
    rms_n(&with(effects), &SimulationOptions { hand_n: 1.0, ..SimulationOptions::default() })[0]
}

#[test]
fn every_effect_is_the_same_physics_to_both() {
    // Elasticity has tests of its own: a loop knows the stretch only through the noise of its sensor.
    let catalogue = Effect::kinds().filter(|effect| *effect != Effect::CableElasticity).map(|effect| {
        let values = effect.row().parameters.iter().zip(effect.row().example);
        // Set points bear no noise: nothing has to be smoothed.
        let values =
            values.map(|(parameter, value)| (parameter.key, if parameter.key == "window_s" { 0.0 } else { *value }));
        let values = values.map(|(key, value)| format!(", {key} = {value:?}"));
        format!("kind = \"{}\"{}", effect.kind(), values.collect::<String>())
    });
    let others = [
        "kind = \"load_nonlinearity\", exponent = 1.3, reference_n = 8.0",
        "kind = \"friction_drift\", rate_per_s = -0.006",
        "kind = \"presliding_shape\", exponent = 0.6",
        "kind = \"time_delay\", delay_s = -0.002",
    ];
    for effect in catalogue.chain(others.map(str::to_owned)) {
        let (before_n, after_n) = known_to_both(&format!("{{ {effect} }}"));
        println!("{effect}: {before_n:.4} N -> {after_n:.5} N, {:.4} of the noise", after_n / FLOOR_N);
        assert!(after_n < 1.05 * FLOOR_N, "{effect}: {after_n} N");
    }
}

/// Motion that is known too late cannot be made up for altogether; but led by the true time it is better than as it comes.
#[test]
fn a_lead_does_no_harm_however_long() {
    for delay_s in [-0.002, -0.004, -0.008, -0.012, -0.02] {
        let hidden = HiddenEffect::parse(&format!("time_delay:delay_s={delay_s}")).unwrap();
        let late = SimulationOptions { effects: vec![hidden], hand_n: 1.0, ..SimulationOptions::default() };
        let (_, late_n) = rms_n(&bench(BENCH_PULLEYS, BENCH_FRICTION), &late)[0];
        let (_, led_n) = known_to_both(&format!("{{ kind = \"time_delay\", delay_s = {delay_s:?} }}"));
        println!("{delay_s} s: {late_n:.5} N late, {led_n:.5} N led");
        assert!(led_n < late_n, "{delay_s} s: {led_n} N led, {late_n} N late");
    }
}

/// A loop only knows the tension of the past, and a play keeps its noise out: the little that both are late is what is left.
#[test]
fn the_stretch_of_a_cable_under_a_slow_load_is_the_same_to_both() {
    let stretching = "{ kind = \"cable_elasticity\", compliance_m_per_n = 0.00025, play_n = 0.02 }";
    let robot = bench_with(BENCH_PULLEYS, BENCH_FRICTION, &format!("effects = [{stretching}]"));
    let effects = vec![HiddenEffect::parse("cable_elasticity:compliance_m_per_n=0.00025").unwrap()];
    let pushed = SimulationOptions { hand_n: 1.5, ..SimulationOptions::default() };
    let (_, after_n) = rms_n(&robot, &pushed)[0];
    let without = SimulationOptions { effects, ..pushed };
    let (_, without_n) = rms_n(&bench(BENCH_PULLEYS, BENCH_FRICTION), &without)[0];
    println!("{:.4} of the noise, {:.4} without the effect", after_n / FLOOR_N, without_n / FLOOR_N);
    assert!(after_n < 1.2 * FLOOR_N && without_n > 3.0 * FLOOR_N);
}

#[test]
fn effects_act_together_as_they_do_alone() {
    for effects in [
        "{ kind = \"stribeck\", ratio = 0.6, velocity_m_per_s = 0.03 }, { kind = \"time_delay\", delay_s = 0.0065 }, \
         { kind = \"bearing_drag\", drag_n = 0.04 }, { kind = \"presliding_shape\", exponent = 1.5 }",
        "{ kind = \"sensor_gain\", gain = 0.98 }, { kind = \"sensor_offset\", offset_n = -0.2 }, \
         { kind = \"sensor_drift\", rate_n_per_s = 0.005 }, { kind = \"friction_drift\", rate_per_s = 0.004 }",
        "{ kind = \"direction_asymmetry\", coulomb_ratio = -0.2 }, { kind = \"load_nonlinearity\", exponent = 1.2 }, \
         { kind = \"pulley_eccentricity\", sin_ratio = 0.02, period_m = 0.1 }, { kind = \"bearing_drag\", drag_n = 0.03 }",
    ] {
        let (before_n, after_n) = known_to_both(effects);
        println!("{before_n:.4} N -> {after_n:.5} N, {:.4} of the noise", after_n / FLOOR_N);
        assert!(after_n < 1.05 * FLOOR_N, "{effects}: {after_n} N");
    }
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
