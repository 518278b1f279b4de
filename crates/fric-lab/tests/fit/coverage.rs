//! Whether the standard errors are what they say: 95 % intervals cover the truth in 95 of 100 logs, whose pulleys are not alike.
//!
//! ±1.96 standard errors, without Student's t: with thousands of samples its quantile is the normal one; what is left of
//! the scatter of the block sums makes intervals some per cent too wide rather than too narrow (see the module
//! `scores`).

use std::ops::RangeInclusive;

use fric_core::robot::file::RobotFile;
use fric_lab::fit::{FitOptions, HALF_INTERVAL, Reference, ResidualFunction};
use fric_lab::simulate::{HiddenEffect, SimulationOptions};
use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};
use rayon::prelude::*;

use super::logs::{FRICTION, Log, deviation, parameter, value};
use super::oracle::{Bench, PULLEYS, strokes, wandering};
use crate::simulate::robots::bench;

/// What it is to be found by in a log: each pulley's μ lies anywhere within ±10 % of 0.02.
fn truth(seed: u64) -> Bench {
    let mut random = ChaCha8Rng::seed_from_u64(2_000_000 + seed);
    let mut ratio = || Uniform::new(0.9, 1.1).unwrap().sample(&mut random);
    Bench { seed, mu_ratios: vec![ratio(), ratio()], ..Bench::default() }
}

/// A log of 6 s; its reference wanders by itself by `wander_n` with a memory of 20 ms, a
/// three-hundredth of the log.
fn log(seed: u64, wander_n: f64) -> Log {
    let mut log = truth(seed).run(6.0, strokes(0.05, 1.0), wandering(8.0));
    let mut random = ChaCha8Rng::seed_from_u64(1_000_000 + seed);
    let memory = (-0.05_f64).exp();
    let mut wandered_n = 0.0;
    for cycle in &mut log.0 {
        let fresh: f64 = StandardNormal.sample(&mut random);
        wandered_n = memory * wandered_n + wander_n * (1.0 - memory * memory).sqrt() * fresh;
        cycle.reference_force_n[0] += wandered_n;
    }
    log
}

/// The textbook's standard errors, which take residuals for independent: `s²(JᵀJ)⁻¹`.
fn naive_standard_errors(log: &Log, robot: &RobotFile, values: &[f64; 4]) -> [f64; 4] {
    let measurements = log.measured(robot, Reference::Forces);
    let function = ResidualFunction::new(&measurements.cable(0).unwrap(), &FitOptions::default());
    let jacobian = DMatrix::from_row_slice(function.count(), 4, &function.jacobian(values));
    let residuals = function.residuals(values);
    let variance = residuals.iter().map(|residual| residual * residual).sum::<f64>()
        / f64::from(u32::try_from(residuals.len() - 4).unwrap());
    let inverse = (jacobian.transpose() * jacobian).try_inverse().unwrap();
    std::array::from_fn(|place| (variance * inverse[(place, place)]).sqrt())
}

const LOGS: u64 = 200;
/// 90 to 99 of 100.
const COVERED: RangeInclusive<u32> = 180..=198;
/// With a wander the intervals are promised to cover 90 (see the module `scores`), less what chance takes from 200 logs in one of
/// twenty cases.
const COVERED_WITH_WANDER: RangeInclusive<u32> = 172..=198;

/// In how many of [`LOGS`] each parameter's interval covers its truth: by the fit's standard errors, and by naive ones.
fn covered(wander_n: f64) -> ([u32; 4], [u32; 4]) {
    let robot = bench(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0");
    let of_log = |seed: u64| {
        let (log, truth) = (log(seed, wander_n), truth(seed).truth());
        let fit = log.fit(&robot, &FitOptions::default()).remove(0);
        let values = FRICTION.map(|name| value(&fit, name));
        let naive = naive_standard_errors(&log, &robot, &values);
        let by_fit: [u32; 4] = std::array::from_fn(|place| {
            u32::from(deviation(&fit, FRICTION[place], truth[place]).abs() <= HALF_INTERVAL)
        });
        let by_naive: [u32; 4] = std::array::from_fn(|place| {
            u32::from((values[place] - truth[place]).abs() <= HALF_INTERVAL * naive[place])
        });
        (by_fit, by_naive)
    };
    let add = |one: [u32; 4], other: [u32; 4]| std::array::from_fn(|place| one[place] + other[place]);
    let (by_fit, by_naive) = (0..LOGS)
        .into_par_iter()
        .map(of_log)
        .reduce(|| ([0; 4], [0; 4]), |one, other| (add(one.0, other.0), add(one.1, other.1)));
    println!("{LOGS} logs, wander {wander_n} N: {by_fit:?} covered, {by_naive:?} by naive errors");
    (by_fit, by_naive)
}

#[test]
fn white_noise() {
    let (by_fit, _) = covered(0.0);
    assert!(by_fit.iter().all(|count| COVERED.contains(count)), "{by_fit:?}");
}

#[test]
fn wandering_reference() {
    let (by_fit, by_naive) = covered(0.02);
    assert!(by_fit.iter().all(|count| COVERED_WITH_WANDER.contains(count)), "{by_fit:?}");
    // Errors that took the residuals for independent would be too small by several times.
    assert!(by_naive[0] < 150 && by_naive[3] < 150, "{by_naive:?}");
}

/// Fits of an effect to logs of the simulated bench with this noise of the sensor, and with a hand on the cable: how far each parameter is off, in
/// standard errors and as a share of its value.
fn deviations(effect: &str, names: &[&str], sensor_noise_n: f64, hand_n: f64, logs: u64) -> Vec<Vec<(f64, f64)>> {
    let truth = bench(PULLEYS, "mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.2");
    let given = bench(PULLEYS, "mu = 0.03, sigma_n_per_m = 500.0");
    let parameters = FRICTION.iter().chain(names).map(|name| parameter(name)).collect();
    let options = FitOptions { parameters: Some(parameters), ..FitOptions::default() };
    let hidden = HiddenEffect::parse(effect).unwrap();
    let of_log = |seed: u64| {
        let simulation = SimulationOptions {
            seed,
            sensor_noise_n,
            reference_noise_n: 0.5 * sensor_noise_n,
            hand_n,
            effects: vec![hidden.clone()],
            ..SimulationOptions::default()
        };
        let fit = Log::record(&truth, &simulation).fit(&given, &options).remove(0);
        let of_name = |name: &&str| {
            let key = name.split('.').next_back().unwrap();
            let true_value = hidden.values().iter().find(|(of, _)| *of == key).unwrap().1;
            (deviation(&fit, name, true_value), value(&fit, name) / true_value - 1.0)
        };
        names.iter().map(of_name).collect()
    };
    (0..logs).into_par_iter().map(of_log).collect()
}

/// The correction of a lag contains the noise of the force in its rate; an elastic cable and a contact that slips back follow its peaks. The errors
/// by that are a multiple of those that a linear model would have.
#[test]
fn noise_that_the_model_passes_on() {
    for (effect, name, hand_n) in [
        ("sensor_lag:time_constant_s=0.006", "sensor_lag.time_constant_s", 0.0),
        ("cable_elasticity:compliance_m_per_n=0.00025", "cable_elasticity.compliance_m_per_n", 2.0),
        ("load_release:ratio=1.0", "load_release.ratio", 2.0),
    ] {
        let found = deviations(effect, &[name], 0.02, hand_n, 12);
        println!("{effect}: {found:?}");
        let covered = found.iter().flatten().filter(|(of_errors, _)| of_errors.abs() <= HALF_INTERVAL).count();
        assert!(covered >= 11, "{effect}: {covered} of {found:?}");
    }
}

/// Laws that change within a cycle: the simulation takes ten steps in each.
#[test]
fn friction_that_changes_while_a_cable_stops() {
    for (effect, names) in [
        ("stribeck:ratio=0.6,velocity_m_per_s=0.03", &["stribeck.ratio", "stribeck.velocity_m_per_s"][..]),
        (
            "dwell_stiction:ratio=0.8,time_s=0.6,distance_m=0.001",
            &["dwell_stiction.ratio", "dwell_stiction.distance_m"],
        ),
    ] {
        let found = deviations(effect, names, 0.0004, 0.0, 2);
        println!("{effect}: {found:?}");
        assert!(found.iter().flatten().all(|(_, of_value)| of_value.abs() < 0.01), "{effect}: {found:?}");
    }
}
