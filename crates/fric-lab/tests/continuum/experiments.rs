//! The two experiments of the paper on its geometry, simulated: friction one way, and in mixed directions.

use fric_core::continuum::{ManipulatorOptions, ManipulatorParams, TendonOptions};
use fric_lab::continuum::fbg::Calibration;
use fric_lab::continuum::shape_errors::{ShapeErrors, Way, shape_errors, shapes};
use fric_lab::continuum::simulate::{Experiment, SimulatedRun, TendonSimulationOptions, simulate};

fn published() -> ManipulatorParams {
    ManipulatorParams::new(&ManipulatorOptions::published()).unwrap()
}

fn run(experiment: Experiment, seed: u64) -> SimulatedRun {
    simulate(&published(), &TendonSimulationOptions { experiment, seed, ..TendonSimulationOptions::default() }).unwrap()
}

/// So many samples of those that are right, spread evenly.
fn spread(run: &SimulatedRun, count: usize, is_right: impl Fn(usize) -> bool) -> Vec<usize> {
    let right: Vec<usize> = (0..run.samples.len()).filter(|&place| is_right(place)).collect();
    (1..=count).map(|part| right[part * (right.len() - 1) / count]).collect()
}

fn all_errors(params: &ManipulatorParams, run: &SimulatedRun, chosen: &[usize]) -> [ShapeErrors; 4] {
    let calibration = Calibration::fit_all(&run.calibration).unwrap();
    Way::ALL.map(|way| {
        let errors = shape_errors(params, &run.samples, way, &calibration, |place| chosen.contains(&place)).unwrap();
        assert_eq!(errors.missing_count, 0);
        errors
    })
}

/// Share of the holes with the right direction, among those whose friction exceeds a tenth of its bound.
fn right_directions(params: &ManipulatorParams, run: &SimulatedRun) -> f64 {
    let computed = shapes(params, &run.samples, Way::History, &[]).unwrap();
    let (mut right, mut all) = (0.0, 0.0);
    // The first sample has hardly any tension yet.
    for (shape, truth) in computed.iter().zip(&run.truth).skip(1) {
        for ((computed_n, true_n), bound_n) in shape.friction_n.iter().zip(&truth.friction_n).zip(&truth.bound_n) {
            if true_n.abs() > 0.1 * bound_n {
                all += 1.0;
                right += f64::from(computed_n * true_n > 0.0);
            }
        }
    }
    right / all
}

#[test]
fn one_way_the_order_is_the_papers() {
    for seed in 0..3 {
        let run = run(Experiment::OneWay, seed);
        let shapes = spread(&run, 6, |_| true);
        let [none, coulomb, measured, history] = all_errors(&published(), &run, &shapes).map(|e| e.mean_mm().unwrap());
        assert!(none > 3.0 * coulomb.max(measured));
        assert!(coulomb < 3.0 * measured);
        assert!(history <= 1.001 * coulomb);
        assert!(right_directions(&published(), &run) >= 0.95);
    }
}

#[test]
fn in_mixed_directions_only_the_history_does_without_gratings() {
    for seed in 0..3 {
        let run = run(Experiment::Mixed, seed);
        let mixed = spread(&run, 4, |place| run.truth[place].is_mixed() && run.samples[place].tension_base_n < 1.0);
        let [none, coulomb, measured, history] = all_errors(&published(), &run, &mixed).map(|e| e.mean_mm().unwrap());
        assert!(coulomb > none && none > measured, "coulomb {coulomb}, none {none}, measured {measured}");
        assert!(history <= coulomb / 5.0);
        let directions = right_directions(&published(), &run);
        assert!(directions >= 0.95, "{directions}");

        // With what the holes really have.
        let tendon = TendonOptions { mu: &run.mu, ..TendonOptions::published() };
        let options = ManipulatorOptions { tendons: [tendon; 2], ..ManipulatorOptions::published() };
        let known = ManipulatorParams::new(&options).unwrap();
        let calibration = Calibration::fit_all(&run.calibration).unwrap();
        let own =
            shape_errors(&known, &run.samples, Way::History, &calibration, |place| mixed.contains(&place)).unwrap();
        let own = own.mean_mm().unwrap();
        assert!(own <= 1.5 * measured, "{own} {measured}");
    }
}

#[test]
fn the_truth_is_an_equilibrium_of_sticking_and_slipping_holes() {
    let run = run(Experiment::Mixed, 7);
    for (sample, truth) in run.samples.iter().zip(&run.truth) {
        let sum: f64 = truth.friction_n.iter().sum();
        assert!((sum - (sample.tension_base_n - truth.tension_n[7])).abs() < 1e-12);
        for (friction_n, bound_n) in truth.friction_n.iter().zip(&truth.bound_n) {
            assert!(friction_n.abs() <= bound_n + 1e-8);
        }
    }
    assert!(run.truth.iter().filter(|truth| truth.is_mixed()).count() > 20);
    assert_eq!(run, self::run(Experiment::Mixed, 7));
}
