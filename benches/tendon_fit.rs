//! What the identification makes of simulated manipulators, for the tables of docs/manipulators.md:
//! `cargo run --release -p fric-tendon-lab --example tendon_fit [RUNS] [SEED] [WORDS]`; words choose rows.
#![allow(
    missing_docs,
    clippy::cast_precision_loss,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a measurement that may fail by panicking; all counts are small"
)]

use std::collections::BTreeMap;

use fric_lab::fit::Progress;
use fric_tendon::edit::{GratingLine, ManipulatorEdit, rewrite};
use fric_tendon::file::ManipulatorFile;
use fric_tendon_lab::fbg::Calibration;
use fric_tendon_lab::identify::{Identification, TendonFitOptions, identify};
use fric_tendon_lab::shape_errors::{ShapeErrors, Way, shapes};
use fric_tendon_lab::simulate::{Experiment, TendonSimulationOptions, simulate};
use fric_tendon_lab::{Run, RunSample, as_measured, corrected};

const PROTOTYPE: &str = include_str!("../examples/tendon-prototype.toml");
/// Half a 95 % interval in standard errors.
const HALF_INTERVAL: f64 = 1.96;

/// What the truth has that the file has not; hanging in gravity or not; with gratings or not.
struct Case {
    name: &'static str,
    experiment: Experiment,
    hangs: bool,
    has_gratings: bool,
    truth: fn(&str) -> String,
}

fn stiffer(text: &str) -> String {
    text.replace("youngs_modulus_pa = 200e9", "youngs_modulus_pa = 220e9")
}

fn wider(text: &str) -> String {
    text.replace("hole_radius_m = 0.015 ", "hole_radius_m = 0.01575 ")
}

fn turned(text: &str) -> String {
    text.to_owned() + "\n[markers]\noffset_m = [0.005, -0.002]\nangle_rad = 0.0524\n"
}

fn loaded(text: &str) -> String {
    text.to_owned() + "\n[tip]\nmass_kg = 0.001\n"
}

fn curved(text: &str) -> String {
    text.replace("mass_kg_per_m = 0.01413", "mass_kg_per_m = 0.01413\nprecurvature_per_m = 0.3")
}

fn tilted(text: &str) -> String {
    text.replace("[-9.80665, 0.0]", "[-9.4725, -2.5381]")
}

fn same(text: &str) -> String {
    text.to_owned()
}

const CASES: [Case; 9] = [
    Case { name: "flat nothing", experiment: Experiment::Mixed, hangs: false, has_gratings: true, truth: same },
    Case { name: "flat stiffer", experiment: Experiment::Mixed, hangs: false, has_gratings: true, truth: stiffer },
    Case { name: "flat wider", experiment: Experiment::OneWay, hangs: false, has_gratings: true, truth: wider },
    Case { name: "flat turned", experiment: Experiment::OneWay, hangs: false, has_gratings: true, truth: turned },
    Case { name: "flat curved", experiment: Experiment::Mixed, hangs: false, has_gratings: true, truth: curved },
    Case {
        name: "flat stiffer blind",
        experiment: Experiment::Mixed,
        hangs: false,
        has_gratings: false,
        truth: stiffer,
    },
    Case { name: "standing nothing", experiment: Experiment::Mixed, hangs: true, has_gratings: true, truth: same },
    Case { name: "standing loaded", experiment: Experiment::Mixed, hangs: true, has_gratings: true, truth: loaded },
    Case { name: "standing tilted", experiment: Experiment::OneWay, hangs: true, has_gratings: true, truth: tilted },
];

fn parsed(text: &str) -> ManipulatorFile {
    ManipulatorFile::parse(text, "arm").unwrap()
}

/// The prototype, flat or hanging from its base in gravity, with lighter disks.
fn prototype(hangs: bool) -> String {
    if hangs {
        PROTOTYPE.replace("[0.0, 0.0]", "[-9.80665, 0.0]").replace("disk_mass_kg = 0.003 ", "disk_mass_kg = 0.0003 ")
    } else {
        PROTOTYPE.to_owned()
    }
}

fn identified(file: &ManipulatorFile, run: &Run) -> Identification {
    let options = TendonFitOptions::default();
    identify(file, std::slice::from_ref(run), &["run".to_owned()], &options, &Progress::new()).unwrap()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize, usual: u64| arguments.get(place).and_then(|one| one.parse().ok()).unwrap_or(usual);
    let (count, first) = (number(0, 5), number(1, 3000));
    let words: Vec<&String> = arguments.iter().skip(2).collect();
    for case in CASES.iter().filter(|case| words.iter().all(|word| case.name.contains(word.as_str()))) {
        let mut held: BTreeMap<String, usize> = BTreeMap::new();
        let mut within: BTreeMap<String, (usize, usize, f64, f64, f64)> = BTreeMap::new();
        let mut shape_mm = Vec::new();
        for seed in first..first + count {
            let given = prototype(case.hangs);
            let truth = parsed(&(case.truth)(&given));
            let options =
                TendonSimulationOptions { experiment: case.experiment, seed, ..TendonSimulationOptions::default() };
            let run = simulate(truth.params(), &options).unwrap();
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
            let text = rewrite(&given, "arm", &ManipulatorEdit { lines, ..ManipulatorEdit::default() }).unwrap();
            let file = parsed(&text);
            let mut samples: Vec<RunSample> = as_measured(&run.samples, &truth);
            if !case.has_gratings {
                for sample in &mut samples {
                    sample.shift_nm.clear();
                }
            }
            let measured = Run::new(samples, 8).unwrap();
            let began = std::time::Instant::now();
            let found = identified(&file, &measured);
            if std::env::var("VERBOSE").is_ok() {
                println!("{}\n{:.1} s", found.result.summary(), began.elapsed().as_secs_f64());
            }
            let fitted = parsed(&rewrite(&text, "arm", &found.edit).unwrap());
            let right = corrected(&measured, &fitted).unwrap();
            let mut errors = ShapeErrors::default();
            let computed = shapes(fitted.params(), right.samples(), Way::History, &[]).unwrap();
            computed.iter().zip(right.samples()).for_each(|(shape, sample)| errors.add(shape, &sample.marker_m));
            shape_mm.push(errors.mean_mm().unwrap());
            for open in &found.result.undetermined {
                *held.entry(open.parameters.join(" ~ ")).or_default() += 1;
            }
            let markers = truth.tables().markers.unwrap_or_default();
            for (key, value) in &found.result.parameters.0 {
                let tables = truth.tables();
                let [x, y] = tables.gravity_m_per_s2;
                let truth = match key.as_str() {
                    "bending_stiffness_n_m2" => truth.params().bending_stiffness_n_m2(),
                    "hole_radius_m" => tables.hole_radius_m,
                    "mu" => run.mu.iter().map(|mu| mu / (1.0 - mu * mu).sqrt()).sum::<f64>() / 8.0,
                    "marker_offset_x_m" => markers.offset_m[0],
                    "marker_offset_y_m" => markers.offset_m[1],
                    "marker_angle_rad" => markers.angle_rad,
                    "tip_mass_kg" => tables.tip.mass_kg,
                    "gravity_angle_rad" => y.atan2(x),
                    "precurvature_per_m" => truth.params().rest_bend_rad()[0] / truth.params().pitch_m()[0],
                    "tip_force_x_n" | "tip_force_y_n" => 0.0,
                    _ => continue,
                };
                let error = found.result.standard_errors.get(key).unwrap();
                let off = if key.contains("angle") {
                    let off = (value - truth).rem_euclid(std::f64::consts::TAU);
                    if off > std::f64::consts::PI { off - std::f64::consts::TAU } else { off }
                } else {
                    value - truth
                };
                let row = within.entry(key.clone()).or_default();
                row.0 += usize::from(off.abs() <= HALF_INTERVAL * error);
                row.1 += 1;
                row.2 += (off / error).powi(2);
                row.3 += off * off;
                row.4 = truth;
            }
        }
        println!(
            "\n{} ({count} runs): shapes {:.3} mm mean, {:.3} at most",
            case.name,
            shape_mm.iter().sum::<f64>() / shape_mm.len() as f64,
            shape_mm.iter().copied().fold(0.0, f64::max)
        );
        for (key, (inside, all, squares, error, truth)) in within {
            let (size, error) = ((squares / all as f64).sqrt(), (error / all as f64).sqrt());
            println!(
                "  {key}: {inside} of {all} within 95 %, {size:.2} standard errors, off by {error:.3e} of {truth:.3e} (rms)"
            );
        }
        for (what, times) in held {
            println!("  held {what}: {times}");
        }
    }
}
