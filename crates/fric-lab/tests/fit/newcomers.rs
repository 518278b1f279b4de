//! Effects that the file has not got, parameters at the end of their range, and a reference that is known.

use fric_core::robot::file::RobotFile;
use fric_lab::fit::{CableFit, FitOptions, rewritten};
use fric_lab::simulate::{HiddenEffect, SimulationOptions};

use super::logs::{FRICTION, Log, assert_near, parameter, value};
use super::oracle::PULLEYS;
use crate::simulate::robots::{bench, bench_with};

const TRUE_FRICTION: &str = "mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.2, offset_n = 0.1";
const GIVEN: &str = "mu = 0.03, sigma_n_per_m = 500.0";

fn log(effects: &[&str]) -> Log {
    let effects = effects.iter().map(|text| HiddenEffect::parse(text).unwrap()).collect();
    Log::record(&bench(PULLEYS, TRUE_FRICTION), &SimulationOptions { effects, ..SimulationOptions::default() })
}

fn options(more: &[&str]) -> FitOptions {
    let parameters = FRICTION.iter().chain(more).map(|name| parameter(name)).collect();
    FitOptions { parameters: Some(parameters), ..FitOptions::default() }
}

/// What a fit without a guess finds is what it finds with a good one.
#[test]
fn an_effect_without_a_guess_starts_from_data() {
    for (hidden, kind, guess, truths) in [
        (
            "stribeck:ratio=0.5,velocity_m_per_s=0.03",
            "stribeck",
            "ratio = 0.4, velocity_m_per_s = 0.02",
            &[("stribeck.ratio", 0.5, 0.04), ("stribeck.velocity_m_per_s", 0.03, 2e-3)][..],
        ),
        ("time_delay:delay_s=0.0085", "time_delay", "delay_s = 0.007", &[("time_delay.delay_s", 0.0085, 1e-4)][..]),
    ] {
        let log = log(&[hidden]);
        let names: Vec<&str> = truths.iter().map(|(name, ..)| *name).collect();
        let found = log.fit(&bench(PULLEYS, GIVEN), &options(&names)).remove(0);
        let guessed = bench_with(PULLEYS, GIVEN, &format!("effects = [{{ kind = \"{kind}\", {guess} }}]"));
        let with_guess = log.fit(&guessed, &options(&names)).remove(0);
        for (name, truth, tolerance) in truths {
            println!("{name}: {} with a guess {}", value(&found, name), value(&with_guess, name));
            assert!((value(&found, name) - truth).abs() < *tolerance, "{name}: {}", value(&found, name));
            let error = found.standard_error(&parameter(name)).unwrap();
            assert!((value(&found, name) - value(&with_guess, name)).abs() < 0.1 * error, "{name}");
        }
        assert!(found.undetermined.is_empty());
    }
}

/// A setting that is taken from the data is in the file that is written.
#[test]
fn what_an_effect_needs_is_written() {
    let text = bench(PULLEYS, GIVEN).to_toml().unwrap();
    let log = log(&["load_nonlinearity:exponent=0.8,reference_n=8.0"]);
    let fits = log.fit(&RobotFile::parse(&text, "bench").unwrap(), &options(&["load_nonlinearity.exponent"]));
    let written = RobotFile::parse(&rewritten(&text, "bench", &fits, &[]).unwrap(), "written").unwrap();
    let values = written.params().cables()[0].values();
    assert!(values.iter().zip(&fits[0].values).all(|(written, fitted)| written.to_bits() == fitted.to_bits()));
    assert!((value(&fits[0], "load_nonlinearity.exponent") - 0.8).abs() < 0.02);
}

/// Friction that falls with speed, in a model that knows only friction that grows with it.
#[test]
fn a_parameter_at_its_bound_is_the_bound_and_said_to_be() {
    let log = log(&["stribeck:ratio=2.0,velocity_m_per_s=0.5"]);
    let given = "mu = 0.03, sigma_n_per_m = 500.0, viscous_n_s_per_m = 0.7";
    let fit = log.fit(&bench(PULLEYS, given), &options(&[])).remove(0);
    println!("{:?} {:?}", fit.values[..4].to_vec(), fit.at_bound);
    assert_eq!(fit.at_bound, [parameter("viscous_n_s_per_m")]);
    assert_eq!(value(&fit, "viscous_n_s_per_m").to_bits(), 0.0_f64.to_bits());
    let free = self::log(&[]).fit(&bench(PULLEYS, GIVEN), &options(&[])).remove(0);
    assert!(free.at_bound.is_empty());
}

/// A bench under a load of 8 N that is known.
fn known(friction: &str) -> RobotFile {
    let text = bench(PULLEYS, friction).to_toml().unwrap();
    let text = text.replace("reference = \"/reference_forces\"", "reference = { constant_n = 8.0 }");
    let robot = RobotFile::parse(&text, "known").unwrap();
    assert!(robot.params().known_reference().is_some());
    robot
}

/// Fits the friction to 40 s of it, with references that are off by `error_n` at each time.
fn fit_known(error_n: impl Fn(f64) -> f64) -> CableFit {
    let options = SimulationOptions { duration_s: Some(40.0), ..SimulationOptions::default() };
    let mut log = Log::record(&known(TRUE_FRICTION), &options);
    for (cycle, number) in log.0.iter_mut().zip(0_i32..) {
        cycle.reference_force_n = vec![8.0 + error_n(1e-3 * f64::from(number))];
    }
    let three: Vec<_> = FRICTION[..3].iter().map(|name| parameter(name)).collect();
    let free = FitOptions { parameters: Some(three), ..FitOptions::default() };
    log.fit(&known(&format!("{GIVEN}, offset_n = 0.1")), &free).remove(0)
}

/// The force `m·(g − a)` that someone has calculated stays the same at constant speed, half of every second here. A sensor that does so hangs.
#[test]
fn a_calculated_reference_does_not_stand_still() {
    let left_out = |noise_n: f64| {
        let mut log = log(&[]);
        for (cycle, number) in log.0.iter_mut().zip(0_i32..) {
            let phase = 1e-3 * f64::from(number % 1000);
            let accelerates = phase > 0.5;
            let wave_n = if accelerates { 0.3 * (4.0 * core::f64::consts::PI * phase).sin().powi(3) } else { 0.0 };
            // Of a sensor that hangs the noise is missing as well.
            let of_noise_n = if accelerates { noise_n * (f64::from(number) * f64::from(number)).sin() } else { 0.0 };
            cycle.reference_force_n = vec![8.0 + wave_n + of_noise_n];
        }
        log.fit(&bench(PULLEYS, GIVEN), &options(&[])).remove(0).samples.without_reference
    };
    assert_eq!(left_out(0.0), 0);
    assert!(left_out(0.02) > 1000);
}

/// Under a constant load that is known the reference never changes, and is no stuck sensor.
#[test]
fn a_constant_reference_is_learned_from() {
    let fit = fit_known(|_| 0.0);
    assert!(fit.samples.used > 30_000, "{:?}", fit.samples);
    assert_near(&fit, &FRICTION[..3], &[0.02, 1000.0, 0.2, 0.1]);
}

/// The mean of a step `s` of the acceleration over a triangular window of ±20 ms is off by `s·(1 − |t|/20 ms)²/2` at `t` from the step. A load of 0.5 kg that
/// starts and ends to accelerate by 4 m/s² once a second is off by up to 1 N.
#[test]
fn a_load_is_not_known_where_its_acceleration_jumps() {
    let jumping = |time_s: f64| {
        let at = (time_s - time_s.round()) / 0.02;
        if at.abs() < 1.0 { at.signum() * (1.0 - at.abs()).powi(2) } else { 0.0 }
    };
    let fit = fit_known(jumping);
    assert!((39 * 40..39 * 120).contains(&fit.samples.without_reference), "{:?}", fit.samples);
    assert_near(&fit, &FRICTION[..3], &[0.02, 1000.0, 0.2, 0.1]);
    // A smooth acceleration is known everywhere.
    let smooth = fit_known(|time_s| 0.2 * (3.0 * time_s).sin());
    assert_eq!(smooth.samples.without_reference, 0, "{:?}", smooth.samples);
}
