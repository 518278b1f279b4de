//! A single winch on a test bench: IPAnema 3 of \[P\], section IV D.

use fric_core::robot::file::RobotFile;
use fric_lab::fit::{CableFit, FitOptions, Reference};
use fric_lab::replay::Replay;
use fric_lab::simulate::SimulationOptions;

use super::logs::{FRICTION, Log, assert_near, value};
use fric_core::Sample;

/// μ, σ = 36.6 N/mm and F_pv = 74.5 Ns/m as published, the last that of the whole cable and shared by its pulleys.
const TRUTH: [f64; 4] = [0.013, 36_600.0, 74.5 / 3.0, 0.0];
const FLOOR_N: f64 = 2.828_427_124_746_19;

/// Noise of sensor and reference is 0.2 % of the load.
fn noisy() -> SimulationOptions {
    SimulationOptions { sensor_noise_n: 4.0, reference_noise_n: 2.0, ..SimulationOptions::default() }
}

/// The winch with a sensor pulley and two at the ceiling.
fn winch(load_kg: f64, [mu, sigma, viscous, offset]: [f64; 4]) -> RobotFile {
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"ipanema-3\"\ncycle_s = 0.001\n[platform]\nmass_kg = {load_kg:?}\n\
         [[cable]]\nname = \"winch\"\n\
         pulleys = [{{ wrap_deg = 180.0, sensor = true }}, {{ wrap_deg = 90.0 }}, {{ wrap_deg = 90.0 }}]\n\
         friction = {{ mu = {mu:?}, sigma_n_per_m = {sigma:?}, viscous_n_s_per_m = {viscous:?}, offset_n = {offset:?} }}\n"
    );
    RobotFile::parse(&text, "winch").unwrap()
}

fn fit(log: &Log, load_kg: f64) -> CableFit {
    let given = winch(load_kg, [0.05, 5_000.0, 1.0, 0.0]);
    assert_eq!(log.measured(&given, Reference::Forces).len(), log.0.len());
    log.fit(&given, &FitOptions::default()).remove(0)
}

/// Mean magnitude before and after compensation and rms after it, N, of the replay with fitted values.
fn verify(log: &Log, load_kg: f64, fit: &CableFit) -> (f64, f64, f64) {
    let robot = winch(load_kg, FRICTION.map(|name| value(fit, name)));
    let mut replay = Replay::new(&robot.params()).unwrap();
    for cycle in &log.0 {
        replay.step(&Sample {
            stamp_nanos: cycle.stamp_nanos,
            cables: &cycle.cables,
            reference_force_n: &cycle.reference_force_n,
            pose: None,
            outside_wrench: None,
        });
    }
    let errors = &replay.cables()[0];
    (errors.before_n.mean_magnitude().unwrap(), errors.after_n.mean_magnitude().unwrap(), errors.after_n.rms().unwrap())
}

#[test]
fn identified_under_one_load_and_verified_under_the_other() {
    let loads_kg = [210.0, 50.0];
    let logs = loads_kg.map(|load_kg| Log::record(&winch(load_kg, TRUTH), &noisy()));
    for (here, there) in [(0, 1), (1, 0)] {
        let fit = fit(&logs[here], loads_kg[here]);
        assert!(fit.undetermined.is_empty());
        assert_near(&fit, &FRICTION, &TRUTH);
        let (before_n, after_n, rms_n) = verify(&logs[there], loads_kg[there], &fit);
        println!(
            "identified at {} kg, at {} kg: {before_n:.2} N -> {after_n:.2} N, rms {:.4} of the noise",
            loads_kg[here],
            loads_kg[there],
            rms_n / FLOOR_N
        );
        // Published: 46.5 N -> 20.4 N.
        assert!(after_n / before_n < 20.4 / 46.5);
        assert!(rms_n < 1.05 * FLOOR_N);
    }
}
