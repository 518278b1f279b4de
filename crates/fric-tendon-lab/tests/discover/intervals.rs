//! 95 % intervals hold the truth although the simulator is not the model: μ differs from hole to hole, and gratings are calibrated by ten loads.
//! `benches/tendon_discover.rs` measures the same on hundreds of runs (docs/manipulators.md).

use fric_lab::discover::result::EffectResult;
use fric_tendon_lab::discover::Manipulator;
use fric_tendon_lab::simulate::{Experiment, TendonSimulationOptions, simulate};

use super::{PROTOTYPE, found, measured};
use fric_tendon::edit::{ManipulatorEdit, rewrite};
use fric_tendon::file::ManipulatorFile;

const RUNS: u64 = 10;

/// The μ of each simulated hole as the model means it: a simulated hole presses with the whole vector sum of both tensions, its own friction
/// included, which is `1/√(1 − μ²)` times as much.
fn true_mu(mu: &[f64], seed: u64) -> Vec<f64> {
    let edit = ManipulatorEdit { mu: mu.to_vec(), ..ManipulatorEdit::default() };
    let file = ManipulatorFile::parse(&rewrite(PROTOTYPE, "truth", &edit).unwrap(), "truth").unwrap();
    let options = TendonSimulationOptions { seed, ..TendonSimulationOptions::default() };
    simulate(file.params(), &options).unwrap().mu.iter().map(|mu| mu / (1.0 - mu * mu).sqrt()).collect()
}

/// How far a number of an effect is from the truth, in standard errors.
fn off(effect: &EffectResult<Manipulator>, key: &str, truth: f64) -> f64 {
    (effect.parameters.get(key).unwrap() - truth) / effect.standard_errors.get(key).unwrap()
}

/// Of ten at 95 %, all but two are within with a chance of 99 %; errors that were three times too large would leave a mean square below 0.12.
fn assert_covered(offs: &[f64]) {
    let within = offs.iter().filter(|off| off.abs() <= 1.96).count();
    let mean_square = offs.iter().map(|off| off * off).sum::<f64>() / f64::from(u32::try_from(offs.len()).unwrap());
    assert!(within + 2 >= offs.len() && mean_square > 0.12, "{offs:.2?}");
}

#[test]
fn the_mu_of_all_holes_is_within_its_interval() {
    let of_seed = |seed: u64| {
        let (text, samples) = measured(Experiment::OneWay, seed, &[0.1753]);
        let discovery = found(&text.replace("mu = 0.1753 ", "mu = 0.0 "), &samples);
        let mu = true_mu(&[0.1753], seed);
        off(&discovery.result.cables[0].effects[0], "mu", mu.iter().sum::<f64>() / 8.0)
    };
    assert_covered(&(100..100 + RUNS).map(of_seed).collect::<Vec<_>>());
}

#[test]
fn the_mu_of_a_rough_hole_is_within_its_interval() {
    let mut mu = [0.1753; 8];
    mu[3] = 0.35;
    let of_seed = |seed: u64| {
        let (text, samples) = measured(Experiment::OneWay, seed, &mu);
        let discovery = found(&text, &samples);
        let effect = &discovery.result.cables[0].effects[0];
        assert_eq!((effect.kind, effect.parameters.get("hole")), ("hole_friction", Some(4.0)));
        off(effect, "mu", true_mu(&mu, seed)[3])
    };
    assert_covered(&(200..200 + RUNS).map(of_seed).collect::<Vec<_>>());
}
