//! References and signals that are none are counted as what they are and leave the estimates unharmed.

use fric_lab::fit::{CableFit, FitOptions, Reference, Weighing, residuals_n};
use fric_lab::simulate::{HiddenEffect, SimulationOptions};

use super::logs::{FRICTION, Log, assert_near, parameter, value};
use super::oracle::{Bench, PULLEYS, strokes, wandering};
use crate::simulate::robots::bench;

fn log() -> Log {
    Bench::default().run(20.0, strokes(0.05, 1.0), wandering(8.0))
}

fn fit(log: &Log, weighing: Weighing) -> CableFit {
    let robot = bench(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0");
    log.fit(&robot, &FitOptions { weighing, ..FitOptions::default() }).remove(0)
}

/// Right, and no further from the fit of the clean log than the samples that are missing may take it.
fn assert_unharmed(fit: &CableFit, clean: &CableFit) {
    assert_near(fit, &FRICTION, &Bench::default().truth());
    for name in FRICTION {
        let standard_error = clean.standard_error(&parameter(name)).unwrap();
        let moved = (value(fit, name) - value(clean, name)).abs() / standard_error;
        assert!(moved < 2.0, "{name} moved by {moved} standard errors");
    }
}

#[test]
fn references_that_are_none() {
    let clean = fit(&log(), Weighing::LeastSquares);
    assert_eq!(clean.samples.used + clean.samples.warm_up, 20_000);
    let mut spoilt = log();
    for cycle in &mut spoilt.0[3_000..5_000] {
        cycle.reference_force_n[0] = f64::NAN;
    }
    let frozen_n = spoilt.0[7_999].reference_force_n[0];
    for cycle in &mut spoilt.0[8_000..11_000] {
        cycle.reference_force_n[0] = frozen_n;
    }
    for cycle in spoilt.0[12_000..].iter_mut().step_by(200) {
        cycle.reference_force_n[0] += 50.0;
    }
    let fit = fit(&spoilt, Weighing::LeastSquares);
    println!("{:?}", fit.samples);
    // The one before the frozen ones has their value, too.
    assert_eq!(fit.samples.without_reference, 5_001);
    assert_eq!(fit.samples.outliers, 40);
    assert_eq!(fit.samples.flagged, 0);
    assert_unharmed(&fit, &clean);
}

/// All samples of a sensor that hangs are left out, also those before the cycle in which that shows.
#[test]
fn forces_that_stand_still_while_the_cable_moves() {
    let clean = fit(&log(), Weighing::LeastSquares);
    let mut spoilt = log();
    let frozen_n = spoilt.0[7_999].cables[0].sensor_force_n;
    for cycle in &mut spoilt.0[8_000..9_000] {
        cycle.cables[0].sensor_force_n = frozen_n;
    }
    let fit = fit(&spoilt, Weighing::LeastSquares);
    // The one before has their value, too.
    assert_eq!(fit.samples.flagged, 1_001);
    assert_unharmed(&fit, &clean);
}

/// What the model misses is there for as long as the cable feels it, and stays in; spikes on top of it do not.
#[test]
fn a_delay_that_nobody_knows_of_is_no_outlier() {
    let truth = bench(PULLEYS, "mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.2, offset_n = 0.1");
    let effects = vec![HiddenEffect::parse("time_delay:delay_s=0.015").unwrap()];
    let mut log = Log::record(&truth, &SimulationOptions { effects, ..SimulationOptions::default() });
    let missed = fit(&log, Weighing::LeastSquares);
    let residuals_n = residuals_n(&log.measured(&truth, Reference::Forces), std::slice::from_ref(&missed)).remove(0);
    let mut magnitudes_n: Vec<f64> = residuals_n.iter().map(|residual_n| residual_n.abs()).collect();
    magnitudes_n.sort_by(f64::total_cmp);
    let deviation_n = 1.4826 * magnitudes_n[magnitudes_n.len() / 2];
    let far = magnitudes_n.iter().filter(|magnitude_n| **magnitude_n > 8.0 * deviation_n).count();
    println!("{:?}, {far} samples beyond 8 standard deviations of {deviation_n:.4} N", missed.samples);
    assert!(far > 100);
    assert_eq!(missed.samples.outliers, 0);
    for cycle in log.0[3_000..].iter_mut().step_by(500) {
        cycle.reference_force_n[0] += 20.0;
    }
    let spikes = log.0[3_000..].iter().step_by(500).count();
    let fit = fit(&log, Weighing::LeastSquares);
    println!("{:?}", fit.samples);
    assert_eq!(fit.samples.outliers, spikes);
}

/// Huber's loss leaves the spikes in and bounds what they can do.
#[test]
fn spikes_under_hubers_loss() {
    let clean = fit(&log(), Weighing::Huber);
    assert_near(&clean, &FRICTION, &Bench::default().truth());
    let mut spoilt = log();
    for cycle in spoilt.0[1_000..].iter_mut().step_by(200) {
        cycle.reference_force_n[0] += 50.0;
    }
    let fit = fit(&spoilt, Weighing::Huber);
    assert_eq!(fit.samples.outliers, 0);
    // Each of the 95 spikes pulls like one deviation of 1.345 σ: together the offset by 1.345 σ · 95/20000.
    let pull_n = 1.345 * Bench::default().floor_n() * 95.0 / 20_000.0;
    let moved_n = value(&fit, "offset_n") - value(&clean, "offset_n");
    println!("moved by {moved_n} N, expected {pull_n} N");
    assert!(moved_n > 0.0 && moved_n < 2.0 * pull_n);
    assert_near(&fit, &["mu", "sigma_n_per_m", "viscous_n_s_per_m"], &Bench::default().truth());
}

#[test]
fn flagged_samples_are_left_out() {
    let clean = fit(&log(), Weighing::LeastSquares);
    let mut spoilt = log();
    for cycle in &mut spoilt.0[4_000..4_300] {
        cycle.cables[0].sensor_force_n = f64::NAN;
    }
    for cycle in &mut spoilt.0[9_000..] {
        cycle.cables[0].length_m += 0.5;
    }
    for cycle in &mut spoilt.0[15_000..15_100] {
        cycle.cables[0].length_m = f64::NAN;
    }
    let fit = fit(&spoilt, Weighing::LeastSquares);
    println!("{:?}", fit.samples);
    assert!((401..=402).contains(&fit.samples.flagged), "{:?}", fit.samples);
    assert_near(&fit, &FRICTION, &Bench::default().truth());
    assert_unharmed(&fit, &clean);
}
