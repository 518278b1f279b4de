//! The published robot (\[P\] table I) as truth.

use fric_core::robot::file::RobotFile;
use fric_lab::fit::FitOptions;
use fric_lab::simulate::SimulationOptions;

use super::logs::{FRICTION, Log, deviation, mini_ipanema, toml_of, value};

/// μ, σ in N/m and F_pv in N s/m of each cable (\[P\] table I), F_pv that of the whole cable.
const TABLE_I: [(f64, f64, f64); 8] = [
    (0.016, 1000.0, 1.70),
    (0.011, 1003.0, 3.50),
    (0.014, 999.0, 1.55),
    (0.017, 602.0, 1.38),
    (0.024, 1000.0, 1.75),
    (0.023, 999.0, 2.08),
    (0.024, 1001.0, 1.18),
    (0.025, 998.0, 1.29),
];

pub fn truth(cable: usize) -> [f64; 4] {
    let (mu, sigma_n_per_m, whole_n_s_per_m) = TABLE_I[cable];
    let offset_n = if cable % 2 == 0 { 0.12 } else { -0.3 };
    [mu, sigma_n_per_m, whole_n_s_per_m / 3.0, offset_n]
}

fn robot() -> RobotFile {
    mini_ipanema(|cable| {
        let [mu, sigma, viscous, offset] = truth(cable);
        format!("mu = {mu}, sigma_n_per_m = {sigma:?}, viscous_n_s_per_m = {viscous:?}, offset_n = {offset}")
    })
}

#[test]
fn scratch() {
    let truth_robot = robot();
    let given = mini_ipanema(|_| "mu = 0.05, sigma_n_per_m = 300.0".to_owned());
    for (what, sensor, reference, seeds) in [("clean", 0.0, 0.0, 1), ("both", 0.02, 0.01, 6)] {
        let mut sums = vec![[[0.0_f64; 3]; 4]; 8];
        let mut within = 0;
        for seed in 0..seeds {
            let log = Log::record(
                &truth_robot,
                &SimulationOptions {
                    seed,
                    sensor_noise_n: sensor,
                    reference_noise_n: reference,
                    ..SimulationOptions::default()
                },
            );
            let fits = log.fit(&given, &FitOptions::default());
            for (cable, fit) in fits.iter().enumerate() {
                for (k, (name, truth)) in FRICTION.iter().zip(truth(cable)).enumerate() {
                    let rel = value(fit, name) / truth - 1.0;
                    if deviation(fit, name, truth).abs() <= 2.0 {
                        within += 1;
                    }
                    sums[cable][k][0] += rel;
                    sums[cable][k][1] += rel * rel;
                    sums[cable][k][2] += (fit.standard_error(&super::logs::parameter(name)).unwrap() / truth).powi(2);
                }
            }
        }
        println!("{what}: within {} of {}; mean rel error % (sd %, se %)", within, 32 * seeds);
        for (cable, of) in sums.iter().enumerate() {
            let n = f64::from(seeds as u32);
            let t: Vec<String> = of
                .iter()
                .map(|[a, b, c]| {
                    let m = a / n;
                    format!(
                        "{:+.4} ({:.4} {:.4})",
                        100.0 * m,
                        100.0 * (b / n - m * m).max(0.0).sqrt() * (n / (n - 0.999)).sqrt(),
                        100.0 * (c / n).sqrt()
                    )
                })
                .collect();
            println!("{} {}", cable + 1, t.join("  "));
        }
    }
}
