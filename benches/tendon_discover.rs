//! What the discovery makes of simulated manipulators, for the tables of docs/manipulators.md:
//! `cargo run --release -p fric-tendon-lab --example tendon_discover [RUNS] [SEED] [WORDS]`; words choose rows.
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

use fric_lab::discover::Verdict;
use fric_lab::discover::result::{DiscoverCableResult, EffectResult};
use fric_lab::fit::Progress;
use fric_tendon::edit::{GratingLine, ManipulatorEdit, rewrite};
use fric_tendon::file::ManipulatorFile;
use fric_tendon_lab::discover::{Manipulator, TendonDiscovery, discover};
use fric_tendon_lab::fbg::Calibration;
use fric_tendon_lab::shape_errors::{ShapeErrors, Way, shapes};
use fric_tendon_lab::simulate::{Experiment, SimulatedRun, TendonSimulationOptions, simulate};
use fric_tendon_lab::{Run, RunSample, as_measured, corrected, steadied};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const PROTOTYPE: &str = include_str!("../examples/tendon-prototype.toml");
/// Half a 95 % interval in standard errors.
const HALF_INTERVAL: f64 = 1.96;

/// A manipulator, how it is simulated, and what its file and its run have that it has not.
struct Case {
    name: &'static str,
    experiment: Experiment,
    noise_ratio: f64,
    mu_spread_ratio: f64,
    /// Upright in gravity, with light disks; else it lies flat.
    stands: bool,
    truth: fn(String) -> String,
    given: fn(String) -> String,
    spoil: fn(&mut [RunSample]),
}

fn prototype(stands: bool) -> String {
    if stands {
        PROTOTYPE.replace("[0.0, 0.0]", "[-9.80665, 0.0]").replace("disk_mass_kg = 0.003 ", "disk_mass_kg = 0.0003 ")
    } else {
        PROTOTYPE.to_owned()
    }
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
    let truth = parsed(&(case.truth)(prototype(case.stands)));
    let mut run = simulate(truth.params(), &options).unwrap();
    run.samples = as_measured(&run.samples, &truth);
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
    let text = (case.given)(edited(&prototype(case.stands), &[], lines));
    (run, text)
}

fn found(text: &str, run: &SimulatedRun) -> TendonDiscovery {
    discover(&parsed(text), &Run::new(run.samples.clone(), 8).unwrap(), "run", &Progress::new()).unwrap()
}

fn told(tendon: &DiscoverCableResult<Manipulator>) -> String {
    let mut kinds: Vec<&str> = tendon.effects.iter().map(|effect| effect.kind).collect();
    kinds.dedup();
    format!("{} {}", tendon.verdict.name(), kinds.join(" "))
}

/// The same with segments and with what is not told apart.
fn told_in_full(tendon: &DiscoverCableResult<Manipulator>) -> String {
    let name = |effect: &EffectResult<Manipulator>| {
        let segment = effect.parameters.get("segment").map_or_else(String::new, |segment| format!(":{segment}"));
        let mut names = vec![format!("{}{segment}", effect.kind)];
        names.extend(effect.alike.iter().map(|other| (*other).to_owned()));
        names.join("~")
    };
    let mut names: Vec<String> = tendon.effects.iter().map(name).collect();
    names.dedup();
    format!("{} {}", tendon.verdict.name(), names.join(" "))
}

/// What a file states of bending, loads and measurement, by key of the results.
fn stated(text: &str, key: &str, segment: Option<f64>) -> Option<f64> {
    let file = parsed(text);
    let tables = file.tables();
    let (markers, sensor) = (tables.markers.unwrap_or_default(), tables.base_sensor.unwrap_or_default());
    let [x, y] = tables.gravity_m_per_s2;
    Some(match key {
        "bending_stiffness_n_m2" => file.params().bending_stiffness_n_m2(),
        "stiffness_ratio" => {
            let ratios = tables.backbone.segment_stiffness_ratio.as_ref()?;
            *ratios.as_slice().get(hole(segment)?)?
        }
        "hole_radius_m" => tables.hole_radius_m,
        "precurvature_per_m" => file.params().rest_bend_rad()[0] / file.params().pitch_m()[0],
        "marker_offset_x_m" => markers.offset_m[0],
        "marker_offset_y_m" => markers.offset_m[1],
        "marker_angle_rad" => markers.angle_rad,
        "tip_mass_kg" => tables.tip.mass_kg,
        "gravity_angle_rad" => y.atan2(x),
        "base_gain" => sensor.gain,
        "base_offset_n" => sensor.offset_n,
        "base_lag_s" => sensor.lag_s,
        _ => return None,
    })
}

/// Mean distance of the disks from their markers by the history with a file, mm.
fn shape_mm(text: &str, run: &SimulatedRun) -> f64 {
    let file = parsed(text);
    let (run, _) = steadied(&corrected(&Run::new(run.samples.clone(), 8).unwrap(), &file).unwrap());
    let mut errors = ShapeErrors::default();
    let computed = shapes(file.params(), run.samples(), Way::History, &[]).unwrap();
    computed.iter().zip(run.samples()).for_each(|(shape, sample)| errors.add(shape, &sample.marker_m));
    errors.mean_mm().unwrap_or(f64::NAN)
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
    let number = |effect: &EffectResult<Manipulator>| {
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
        stands: false,
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
                Case { name: "soft20", truth: |text| text.replace("= 200e9", "= 160e9"), ..usual() },
                Case { name: "stiff20", truth: |text| text.replace("= 200e9", "= 240e9"), ..usual() },
                Case {
                    name: "cracked",
                    truth: |text| {
                        text.replace("= 200e9", "= 200e9\nsegment_stiffness_ratio = [1, 1, 1, 0.5, 1, 1, 1, 1]")
                    },
                    ..usual()
                },
                Case {
                    name: "curved",
                    truth: |text| text.replace("= 200e9", "= 200e9\nprecurvature_per_m = 0.3"),
                    ..usual()
                },
                Case { name: "turned", truth: |text| text + "\n[markers]\nangle_rad = 0.0524\n", ..usual() },
                Case { name: "moved", truth: |text| text + "\n[markers]\noffset_m = [0.003, -0.004]\n", ..usual() },
                Case { name: "gain", truth: |text| text + "\n[base_sensor]\ngain = 1.05\n", ..usual() },
                Case { name: "tare", truth: |text| text + "\n[base_sensor]\noffset_n = 0.05\n", ..usual() },
                Case { name: "late", truth: |text| text + "\n[base_sensor]\nlag_s = 0.3\n", ..usual() },
                Case { name: "stands", stands: true, ..usual() },
                Case { name: "stands_soft", stands: true, truth: |text| text.replace("= 200e9", "= 180e9"), ..usual() },
                Case {
                    name: "stands_stiff20",
                    stands: true,
                    truth: |text| text.replace("= 200e9", "= 240e9"),
                    ..usual()
                },
                Case {
                    name: "stands_far",
                    stands: true,
                    truth: |text| text.replace("hole_radius_m = 0.015 ", "hole_radius_m = 0.01575 "),
                    ..usual()
                },
                Case { name: "loaded", stands: true, truth: |text| text + "\n[tip]\nmass_kg = 0.001\n", ..usual() },
                Case {
                    name: "tilted",
                    stands: true,
                    truth: |text| text.replace("[-9.80665, 0.0]", "[-9.4725, -2.5381]"),
                    ..usual()
                },
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
                Case {
                    name: "uneven",
                    truth: |text| {
                        text.replace(
                            "pitch_m = 0.037 ",
                            "pitch_m = [0.039, 0.037, 0.035, 0.037, 0.037, 0.041, 0.033, 0.037]",
                        )
                    },
                    ..usual()
                },
                Case { name: "shaky", spoil: |samples| shake(samples, 0.01), ..usual() },
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
        let (mut same, mut shapes_mm, mut values) = (0, Vec::new(), BTreeMap::<String, Vec<[f64; 3]>>::new());
        let mut slowest_s = 0.0_f64;
        let stated_truth = (case.truth)(prototype(case.stands));
        for seed in first_seed..first_seed + count {
            let (run, text) = simulated(case, seed);
            let began = std::time::Instant::now();
            let discovery = found(&text, &run);
            slowest_s = slowest_s.max(began.elapsed().as_secs_f64());
            if std::env::var("VERBOSE").is_ok() {
                println!("{}", discovery.result.summary());
            }
            let tendon = &discovery.result.cables[0];
            *verdicts.entry(told_in_full(tendon)).or_default() += 1;
            for (name, value, error, truth) in compared(&discovery, &run) {
                numbers.entry(name).or_default().push([(value - truth) / error, error / truth.abs()]);
            }
            let written = rewrite(&text, "arm", &discovery.edit).unwrap();
            shapes_mm.push(shape_mm(&written, &run));
            for effect in &tendon.effects {
                let segment = effect.parameters.get("segment");
                for (key, value) in &effect.parameters.0 {
                    if let Some(truth) = stated(&stated_truth, key, segment) {
                        let error = effect.standard_errors.get(key).unwrap_or(f64::NAN);
                        values.entry(key.clone()).or_default().push([*value, error, truth]);
                    } else if ["temperature_k", "from_s"].contains(&key.as_str()) {
                        values.entry(key.clone()).or_default().push([*value, f64::NAN, f64::NAN]);
                    }
                }
            }
            let again = found(&written, &run);
            let expected = if tendon.verdict == Verdict::Extended { "complete" } else { tendon.verdict.name() };
            same += u32::from(told(&again.result.cables[0]) == format!("{expected} "));
        }
        println!("{} {}: {verdicts:?}; given again as told: {same}", case.experiment.name(), case.name);
        println!(
            "    shapes {:.3} mm in the mean, {:.3} at most; {slowest_s:.1} s at most",
            shapes_mm.iter().sum::<f64>() / shapes_mm.len() as f64,
            shapes_mm.iter().copied().fold(0.0, f64::max)
        );
        for (key, all) in values {
            let mean = all.iter().map(|one| one[0]).sum::<f64>() / all.len() as f64;
            let most = all.iter().map(|[value, _, truth]| (value - truth).abs()).fold(0.0, f64::max);
            let within = all.iter().filter(|[value, error, truth]| (value - truth).abs() <= HALF_INTERVAL * error);
            println!(
                "    {key}: {mean:.5} in the mean of {}, truth {:.5}, off by {most:.5} at most, {} within 95 % interval",
                all.len(),
                all[0][2],
                within.count()
            );
        }
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
/// White noise on the tension at the base; every case has the same.
fn shake(samples: &mut [RunSample], noise_n: f64) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for sample in samples {
        let deviate: f64 = StandardNormal.sample(&mut random);
        sample.tension_base_n = (sample.tension_base_n + noise_n * deviate).max(0.0);
    }
}

fn step(samples: &mut [RunSample], kelvin: f64) {
    let middle = samples.len() / 2;
    for shift_nm in samples.iter_mut().skip(middle).flat_map(|sample| &mut sample.shift_nm) {
        *shift_nm += 1550.0 * 6.85e-6 * kelvin;
    }
}
