//! Numerically delicate places: parameters at their bounds, very stiff and very soft cables, large numbers.

use fric_lab::fit::{CableFit, FitOptions, Termination};

use super::logs::{FRICTION, assert_near, undetermined, value};
use super::oracle::{Bench, PULLEYS, strokes, wandering};
use crate::simulate::robots::bench;

/// The fit of 20 s of strokes under `tension_n`, and the rms after it per noise floor.
fn fit(truth: &Bench, amplitude_m: f64, tension_n: f64) -> (CableFit, f64) {
    let robot = bench(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0, viscous_n_s_per_m = 0.7, offset_n = -0.1");
    let robot = if truth.cycle_s > 0.001 { slower(truth.cycle_s) } else { robot };
    let fit = truth.run(20.0, strokes(amplitude_m, 1.0), wandering(tension_n)).fit(&robot, &FitOptions::default());
    let fit = fit.into_iter().next().unwrap();
    assert_eq!(fit.termination, Termination::Converged);
    let ratio = fit.errors.after_n.rms().unwrap() / truth.floor_n();
    println!("{truth:?}: {:?}, {ratio:.4} of the floor", FRICTION.map(|name| value(&fit, name)));
    (fit, ratio)
}

fn slower(cycle_s: f64) -> fric_core::robot::file::RobotFile {
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = {cycle_s}\n[[cable]]\nname = \"winch\"\n\
         pulleys = [{PULLEYS}]\nfriction = {{ mu = 0.05, sigma_n_per_m = 300.0 }}\n"
    );
    fric_core::robot::file::RobotFile::parse(&text, "slower").unwrap()
}

#[test]
fn no_viscous_friction() {
    let truth = Bench { viscous_n_s_per_m: 0.0, ..Bench::default() };
    let (fit, ratio) = fit(&truth, 0.05, 8.0);
    assert_near(&fit, &FRICTION, &truth.truth());
    assert!(undetermined(&fit).is_empty() && ratio < 1.02);
    assert!((0.0..0.005).contains(&value(&fit, "viscous_n_s_per_m")));
}

/// Without bearing friction μ ≈ 0 with any σ says the same as any μ with σ ≈ 0: one of the two is named, and all else is
/// right.
#[test]
fn no_bearing_friction() {
    for viscous_n_s_per_m in [0.3, 0.0] {
        let truth = Bench { mu: 0.0, viscous_n_s_per_m, ..Bench::default() };
        let (fit, ratio) = fit(&truth, 0.05, 8.0);
        let named = undetermined(&fit);
        assert!(named == ["sigma_n_per_m"] || named == ["mu"], "{named:?}");
        assert_near(&fit, &["viscous_n_s_per_m", "offset_n"], &truth.truth());
        assert!(ratio < 1.02);
    }
}

#[test]
fn soft_cables() {
    for sigma_n_per_m in [10.0, 100.0] {
        let truth = Bench { sigma_n_per_m, ..Bench::default() };
        let (fit, ratio) = fit(&truth, 0.05, 8.0);
        assert_near(&fit, &FRICTION, &truth.truth());
        assert!(ratio < 1.02);
    }
}

/// A presliding distance below the way of one cycle is seen in the cycles of a reversal only, and these the model takes as
/// a whole: σ by its order of magnitude, the rest undisturbed.
#[test]
fn stiff_cables() {
    for (sigma_n_per_m, within, ratio_bound) in [(1e5, 1.1, 1.05), (1e7, 10.0, 2.0)] {
        let truth = Bench { sigma_n_per_m, ..Bench::default() };
        let (fit, ratio) = fit(&truth, 0.05, 8.0);
        assert_near(&fit, &["mu", "viscous_n_s_per_m", "offset_n"], &truth.truth());
        let factor = value(&fit, "sigma_n_per_m") / sigma_n_per_m;
        assert!(factor > 1.0 / within && factor < within, "{factor}");
        assert!(ratio < ratio_bound, "{ratio}");
    }
}

#[test]
fn large_offsets() {
    for offset_n in [-100.0, 100.0] {
        let truth = Bench { offset_n, ..Bench::default() };
        let (fit, ratio) = fit(&truth, 0.05, 8.0);
        assert_near(&fit, &FRICTION, &truth.truth());
        assert!(ratio < 1.02);
    }
}

/// A crane's cable under 10 kN.
#[test]
fn large_forces() {
    let truth = Bench {
        mu: 0.013,
        sigma_n_per_m: 36_600.0,
        viscous_n_s_per_m: 74.5,
        offset_n: -15.0,
        sensor_noise_n: 20.0,
        reference_noise_n: 10.0,
        ..Bench::default()
    };
    let (fit, ratio) = fit(&truth, 0.1, 10_000.0);
    assert_near(&fit, &FRICTION, &truth.truth());
    assert!(ratio < 1.02);
}

#[test]
fn a_cycle_of_four_milliseconds() {
    let truth = Bench { cycle_s: 0.004, ..Bench::default() };
    let (fit, ratio) = fit(&truth, 0.05, 8.0);
    assert_near(&fit, &FRICTION, &truth.truth());
    assert!(ratio < 1.02);
}
