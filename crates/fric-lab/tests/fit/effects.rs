//! Effects that a cable has in its file are fitted with the rest; what is not asked for is not touched.

use fric_lab::fit::{CableFit, FitOptions};
use fric_lab::simulate::{HiddenEffect, SimulationOptions};

use super::logs::{FRICTION, Log, assert_near, parameter, value};
use super::oracle::PULLEYS;
use crate::simulate::robots::{bench, bench_with};

const TRUTH: [f64; 4] = [0.02, 1000.0, 0.2, 0.1];
const TRUE_FRICTION: &str = "mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.2, offset_n = 0.1";
const GIVEN_FRICTION: &str = "mu = 0.03, sigma_n_per_m = 500.0";
const FLOOR_N: f64 = 0.014_142_135_623_730_95;

fn log(effects: &[&str]) -> Log {
    let effects = effects.iter().map(|text| HiddenEffect::parse(text).unwrap()).collect();
    Log::record(&bench(PULLEYS, TRUE_FRICTION), &SimulationOptions { effects, ..SimulationOptions::default() })
}

/// Each within about four standard errors, the delay within a tenth of a cycle.
fn check(fit: &CableFit, truths: &[(&str, f64, f64)]) {
    for (name, truth, tolerance) in truths {
        let value = value(fit, name);
        println!("{name}: {value} ± {:?}, truth {truth}", fit.standard_error(&parameter(name)));
        assert!((value - truth).abs() < *tolerance, "{name}: {value}");
    }
    let rms_n = fit.errors.after_n.rms().unwrap();
    println!("rms {:.4} of the noise", rms_n / FLOOR_N);
    assert!(fit.undetermined.is_empty() && rms_n < 1.03 * FLOOR_N, "{rms_n}");
}

#[test]
fn stribeck_is_recovered() {
    let log = log(&["stribeck:ratio=0.5,velocity_m_per_s=0.03"]);
    let robot = bench_with(PULLEYS, GIVEN_FRICTION, "effects = [{ kind = \"stribeck\", ratio = 0.2 }]");
    let fit = log.fit(&robot, &FitOptions::default()).remove(0);
    assert_eq!(fit.fitted.len(), 6);
    check(
        &fit,
        &[
            ("mu", 0.02, 2e-5),
            ("sigma_n_per_m", 1000.0, 5.0),
            ("stribeck.ratio", 0.5, 0.04),
            ("stribeck.velocity_m_per_s", 0.03, 2e-3),
        ],
    );
}

#[test]
fn time_delay_is_recovered() {
    let log = log(&["time_delay:delay_s=0.0085"]);
    let robot = bench_with(PULLEYS, GIVEN_FRICTION, "effects = [{ kind = \"time_delay\", delay_s = 0.002 }]");
    let fit = log.fit(&robot, &FitOptions::default()).remove(0);
    assert_eq!(fit.fitted.len(), 5);
    check(&fit, &[("mu", 0.02, 2e-5), ("sigma_n_per_m", 1000.0, 5.0), ("time_delay.delay_s", 0.0085, 1e-4)]);
}

/// One component of a ripple is near 0 where the phase has it so. It is known all the same: keeping it would fix the phase, and with it the period.
#[test]
fn a_ripple_with_a_component_near_0_has_a_true_interval() {
    let log = log(&["friction_ripple:sin_ratio=0.3,period_m=0.08"]);
    let effects = "effects = [{ kind = \"friction_ripple\", sin_ratio = 0.25, cos_ratio = 0.05, period_m = 0.0802 }]";
    let fit = log.fit(&bench_with(PULLEYS, GIVEN_FRICTION, effects), &FitOptions::default()).remove(0);
    let error = |key: &str| fit.standard_error(&parameter(&format!("friction_ripple.{key}"))).unwrap();
    check(
        &fit,
        &[
            ("friction_ripple.sin_ratio", 0.3, 4.0 * error("sin_ratio")),
            ("friction_ripple.cos_ratio", 0.0, 4.0 * error("cos_ratio")),
            ("friction_ripple.period_m", 0.08, 4.0 * error("period_m")),
        ],
    );
    assert!(error("period_m") < 1e-3 * 0.08, "{}", error("period_m"));
}

#[test]
fn both_at_once_are_recovered() {
    let log = log(&["stribeck:ratio=0.5,velocity_m_per_s=0.03", "time_delay:delay_s=0.004"]);
    let effects = "effects = [{ kind = \"stribeck\", ratio = 0.2 }, { kind = \"time_delay\", delay_s = 0.001 }]";
    let fit = log.fit(&bench_with(PULLEYS, GIVEN_FRICTION, effects), &FitOptions::default()).remove(0);
    check(&fit, &[("mu", 0.02, 3e-5), ("stribeck.ratio", 0.5, 0.04), ("time_delay.delay_s", 0.004, 1e-4)]);
}

/// The search ends at the minimum, not on the way: from wherever it starts it comes to the same values, to a hundredth of
/// what can be known of them.
#[test]
fn the_values_given_do_not_matter() {
    let log = log(&["stribeck:ratio=0.5,velocity_m_per_s=0.03", "time_delay:delay_s=0.0085"]);
    let fit = |ratio: f64, velocity: f64, delay: f64| {
        let effects = format!(
            "effects = [{{ kind = \"stribeck\", ratio = {ratio}, velocity_m_per_s = {velocity} }}, \
             {{ kind = \"time_delay\", delay_s = {delay} }}]"
        );
        log.fit(&bench_with(PULLEYS, GIVEN_FRICTION, &effects), &FitOptions::default()).remove(0)
    };
    let [one, other] = [fit(0.5, 0.03, 0.0084), fit(0.2, 0.08, 0.006)];
    assert_eq!((&one.undetermined, &other.undetermined), (&Vec::new(), &Vec::new()));
    // The starts differ a little, and with them how long the cable is taken to remember.
    assert!(one.samples.used.abs_diff(other.samples.used) < 20, "{:?} {:?}", one.samples, other.samples);
    for parameter in &one.fitted {
        let apart = (one.values[parameter.place()] - other.values[parameter.place()]).abs();
        assert!(apart < 0.01 * one.standard_error(parameter).unwrap(), "{parameter}: {apart}");
    }
}

/// An effect that is not there comes out as none, to its error.
#[test]
fn an_effect_that_is_not_there_is_none() {
    let robot = bench_with(PULLEYS, GIVEN_FRICTION, "effects = [{ kind = \"stribeck\", ratio = 0.4 }]");
    let fit = log(&[]).fit(&robot, &FitOptions::default()).remove(0);
    assert_eq!(super::logs::undetermined(&fit), ["stribeck.velocity_m_per_s"]);
    let ratio = value(&fit, "stribeck.ratio");
    assert!(ratio.abs() < 3.5 * fit.standard_error(&parameter("stribeck.ratio")).unwrap(), "{ratio}");
    assert_near(&fit, &["mu", "viscous_n_s_per_m", "offset_n"], &TRUTH);
    assert!(fit.errors.after_n.rms().unwrap() < 1.02 * FLOOR_N);
}

#[test]
fn a_subset_leaves_the_others_untouched() {
    let given = "mu = 0.03, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.2, offset_n = -0.4";
    let options =
        FitOptions { parameters: Some(vec![parameter("offset_n"), parameter("mu")]), ..FitOptions::default() };
    let robot = bench(PULLEYS, given);
    let fit = log(&[]).fit(&robot, &options).remove(0);
    assert_eq!(fit.fitted, [parameter("offset_n"), parameter("mu")]);
    assert_eq!(fit.covariance.shape(), (2, 2));
    let before = robot.params().cables()[0].values();
    let changed: Vec<usize> =
        (0..before.len()).filter(|place| before[*place].to_bits() != fit.values[*place].to_bits()).collect();
    assert_eq!(changed, [parameter("mu").place(), parameter("offset_n").place()]);
    assert_near(&fit, &["mu", "offset_n"], &TRUTH);
    let none = FitOptions { parameters: Some(Vec::new()), ..FitOptions::default() };
    let fit = log(&[]).fit(&robot, &none).remove(0);
    assert_eq!(fit.values.map(f64::to_bits), before.map(f64::to_bits));
    assert!(fit.fitted.is_empty() && FRICTION.iter().all(|name| fit.standard_error(&parameter(name)).is_none()));
}
