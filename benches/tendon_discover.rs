//! What the discovery makes of simulated manipulators, for the tables of docs/manipulators.md:
//! `cargo run --release -p fric-lab --example tendon_discover [RUNS] [SEED] [WORDS]`; words choose rows.
#![allow(
    missing_docs,
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::too_many_lines,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a measurement that may fail by panicking; all counts are small"
)]

use std::collections::BTreeMap;

use fric_core::continuum::edit::{GratingLine, ManipulatorEdit, rewrite};
use fric_core::continuum::file::ManipulatorFile;
use fric_lab::continuum::discover::{TendonDiscovery, TendonResult, discover};
use fric_lab::continuum::fbg::Calibration;
use fric_lab::continuum::simulate::{Experiment, SimulatedRun, TendonSimulationOptions, simulate};
use fric_lab::continuum::{Run, RunSample};

const PROTOTYPE: &str = include_str!("../examples/tendon-prototype.toml");
/// Half a 95 % interval in standard errors.
const HALF_INTERVAL: f64 = 1.96;

/// A manipulator, how it is simulated, and what its file and its run have that it has not.
struct Case {
    name: &'static str,
    experiment: Experiment,
    noise_ratio: f64,
    mu_spread_ratio: f64,
    truth: fn(String) -> String,
    given: fn(String) -> String,
    spoil: fn(&mut [RunSample]),
}

fn edited(text: &str, mu: &[f64], lines: Vec<GratingLine>) -> String {
    rewrite(text, "arm", &ManipulatorEdit { mu: mu.to_vec(), lines, ..ManipulatorEdit::default() }).unwrap()
}

fn parsed(text: &str) -> ManipulatorFile {
    ManipulatorFile::parse(text, "arm").unwrap()
}

/// The run and the text of the file given.
fn simulated(case: &Case, seed: u64) -> (SimulatedRun, String) {
    let usual = TendonSimulationOptions::default();
    let options = TendonSimulationOptions {
        experiment: case.experiment,
        seed,
        mu_spread_ratio: case.mu_spread_ratio,
        grating_noise_nm: case.noise_ratio * usual.grating_noise_nm,
        marker_noise_m: case.noise_ratio * usual.marker_noise_m,
        ..usual
    };
    let mut run = simulate(parsed(&(case.truth)(PROTOTYPE.to_owned())).params(), &options).unwrap();
    (case.spoil)(&mut run.samples);
    let line = |line: &Calibration| {
        let error = line.line_error();
        GratingLine {
            newton_per_nm: line.newton_per_nm,
            offset_n: line.offset_n,
            standard_error_n: line.largest_standard_error_n(),
            line_error_n: error.line_error_n,
            slope_error_n_per_nm: error.slope_error_n_per_nm,
            mean_shift_nm: error.mean_shift_nm,
        }
    };
    let lines = Calibration::fit_all(&run.calibration).unwrap().iter().map(line).collect();
    let text = (case.given)(edited(PROTOTYPE, &[], lines));
    (run, text)
}

fn found(text: &str, run: &SimulatedRun) -> TendonDiscovery {
    discover(&parsed(text), &Run::new(run.samples.clone(), 8).unwrap(), "run").unwrap()
}

fn told(tendon: &TendonResult) -> String {
    let mut kinds: Vec<&str> = tendon.effects.iter().map(|effect| effect.kind).collect();
    kinds.dedup();
    format!("{} {}", tendon.verdict, kinds.join(" "))
}

/// What the model's μ is where the simulated hole presses with the whole vector sum of both tensions, friction included.
fn of_model(mu: f64) -> f64 {
    mu / (1.0 - mu * mu).sqrt()
}

/// What is true of each number that was found: its name, the value and its standard error, and the truth.
fn compared(discovery: &TendonDiscovery, run: &SimulatedRun) -> Vec<(&'static str, f64, f64, f64)> {
    let tendon = &discovery.result.cables[0];
    let named: Vec<usize> = tendon.effects.iter().filter_map(|effect| hole(effect.parameters.get("hole"))).collect();
    let others = || (0..8).filter(|hole| !named.contains(hole));
    let found_mu = |hole: usize| discovery.edit.mu.get(hole).map(|mu| mu.to_bits());
    // Beside a named hole each may have its own: then it is the mean of all.
    let is_one = others().all(|hole| found_mu(hole) == others().next().and_then(found_mu));
    let shared: Vec<f64> =
        (0..8).filter(|hole| !is_one || !named.contains(hole)).map(|hole| of_model(run.mu[hole])).collect();
    let mean = shared.iter().sum::<f64>() / shared.len() as f64;
    let number = |effect: &fric_lab::continuum::discover::TendonEffect| {
        let (name, key, truth) = match effect.kind {
            "coulomb" => ("shared mu", "mu", mean),
            "hole_friction" => ("mu of a hole", "mu", of_model(run.mu[hole(effect.parameters.get("hole"))?])),
            "sensor_drift" => {
                ("drift", "drift_nm_per_s", if effect.parameters.get("grating") == Some(3.0) { 0.002 } else { 0.0 })
            }
            _ => return None,
        };
        Some((name, effect.parameters.get(key)?, effect.standard_errors.get(key).unwrap_or(f64::NAN), truth))
    };
    tendon.effects.iter().filter_map(number).collect()
}

fn hole(number: Option<f64>) -> Option<usize> {
    number.map(|number| number as usize - 1)
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let count: u64 = arguments.first().map_or(100, |count| count.parse().unwrap());
    let first_seed: u64 = arguments.get(1).map_or(1000, |seed| seed.parse().unwrap());
    let words = arguments.get(2..).unwrap_or_default();
    let usual = || Case {
        name: "",
        experiment: Experiment::OneWay,
        noise_ratio: 1.0,
        mu_spread_ratio: 0.1,
        truth: |text| text,
        given: |text| text,
        spoil: |_| (),
    };
    let mut cases = Vec::new();
    for experiment in Experiment::ALL {
        cases.extend(
            [
                Case { name: "clean", ..usual() },
                Case { name: "quiet", noise_ratio: 0.2, ..usual() },
                Case { name: "loud", noise_ratio: 4.0, ..usual() },
                Case { name: "even", mu_spread_ratio: 0.0, ..usual() },
                Case { name: "soft", truth: |text| text.replace("= 200e9", "= 180e9"), ..usual() },
                Case { name: "stiff", truth: |text| text.replace("= 200e9", "= 220e9"), ..usual() },
                Case {
                    name: "near",
                    truth: |text| text.replace("hole_radius_m = 0.015 ", "hole_radius_m = 0.01425 "),
                    ..usual()
                },
                Case {
                    name: "far",
                    truth: |text| text.replace("hole_radius_m = 0.015 ", "hole_radius_m = 0.01575 "),
                    ..usual()
                },
                Case { name: "warm", spoil: |samples| step(samples, 5.0), ..usual() },
                Case { name: "cold", spoil: |samples| step(samples, -5.0), ..usual() },
                Case { name: "smooth", given: |text| text.replace("mu = 0.1753 ", "mu = 0.0 "), ..usual() },
                Case {
                    name: "rough",
                    truth: |text| {
                        edited(&text, &[0.1753, 0.1753, 0.1753, 0.35, 0.1753, 0.1753, 0.1753, 0.1753], Vec::new())
                    },
                    ..usual()
                },
                Case {
                    name: "drift",
                    spoil: |samples| samples.iter_mut().for_each(|sample| sample.shift_nm[2] += 0.002 * sample.time_s),
                    ..usual()
                },
            ]
            .map(|case| Case { experiment, ..case }),
        );
    }
    for case in cases.iter().filter(|case| words.is_empty() || words.iter().any(|word| word == case.name)) {
        let (mut verdicts, mut numbers) = (BTreeMap::<String, u32>::new(), BTreeMap::<&str, Vec<[f64; 2]>>::new());
        let mut same = 0;
        for seed in first_seed..first_seed + count {
            let (run, text) = simulated(case, seed);
            let discovery = found(&text, &run);
            let tendon = &discovery.result.cables[0];
            *verdicts.entry(told(tendon)).or_default() += 1;
            for (name, value, error, truth) in compared(&discovery, &run) {
                numbers.entry(name).or_default().push([(value - truth) / error, error / truth.abs()]);
            }
            let again = found(&rewrite(&text, "arm", &discovery.edit).unwrap(), &run);
            let expected = if tendon.verdict == "extended" { "complete" } else { tendon.verdict };
            same += u32::from(told(&again.result.cables[0]) == format!("{expected} "));
        }
        println!("{} {}: {verdicts:?}; given again as told: {same}", case.experiment.name(), case.name);
        for (name, all) in numbers {
            let of = |at: f64| 100.0 * all.iter().filter(|[off, _]| off.abs() <= at).count() as f64 / all.len() as f64;
            let mean = |place: usize| all.iter().map(|pair| pair[place]).sum::<f64>() / all.len() as f64;
            let square = (all.iter().map(|[off, _]| off * off).sum::<f64>() / all.len() as f64).sqrt();
            println!(
                "    {name}: {} found, {:.1} % within 95 % interval; off by {:.2} ± {square:.2} errors, error {:.1} %",
                all.len(),
                of(HALF_INTERVAL),
                mean(0),
                100.0 * mean(1)
            );
        }
    }
}

/// A step of the temperature in the middle of a run, of gratings in silica at 1550 nm.
fn step(samples: &mut [RunSample], kelvin: f64) {
    let middle = samples.len() / 2;
    for shift_nm in samples.iter_mut().skip(middle).flat_map(|sample| &mut sample.shift_nm) {
        *shift_nm += 1550.0 * 6.85e-6 * kelvin;
    }
}
