//! What is hidden in a simulated run is named, and nothing else.

mod intervals;
mod marker_faults;
mod markers;
mod pairs;

use fric_lab::fit::Progress;
use fric_tendon::edit::{GratingLine, ManipulatorEdit, rewrite};
use fric_tendon::file::ManipulatorFile;
use fric_tendon_lab::discover::{TendonDiscovery, discover};
use fric_tendon_lab::fbg::Calibration;
use fric_tendon_lab::simulate::{Experiment, TendonSimulationOptions, simulate};
use fric_tendon_lab::{ContinuumError, Run, RunSample};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

pub(super) const PROTOTYPE: &str = include_str!("../../../examples/tendon-prototype.toml");

/// The text of the calibrated prototype, and a run of it with these μ.
fn measured(experiment: Experiment, seed: u64, mu: &[f64]) -> (String, Vec<RunSample>) {
    let options = TendonSimulationOptions { experiment, seed, ..TendonSimulationOptions::default() };
    let edit = ManipulatorEdit { mu: mu.to_vec(), ..ManipulatorEdit::default() };
    measured_of(&rewrite(PROTOTYPE, "truth", &edit).unwrap(), &options)
}

/// The text of the calibrated prototype, and a run of another manipulator.
pub(super) fn measured_of(truth: &str, options: &TendonSimulationOptions) -> (String, Vec<RunSample>) {
    calibrated(PROTOTYPE, truth, options)
}

/// The same for another given file.
pub(super) fn calibrated(given: &str, truth: &str, options: &TendonSimulationOptions) -> (String, Vec<RunSample>) {
    let run = simulate(ManipulatorFile::parse(truth, "truth").unwrap().params(), options).unwrap();
    let lines = Calibration::fit_all(&run.calibration).unwrap();
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
    let edit = ManipulatorEdit { lines: lines.iter().map(line).collect(), ..ManipulatorEdit::default() };
    (rewrite(given, "arm", &edit).unwrap(), run.samples)
}

fn found(text: &str, samples: &[RunSample]) -> TendonDiscovery {
    let run = Run::new(samples.to_vec(), 8).unwrap();
    discover(&ManipulatorFile::parse(text, "arm").unwrap(), &run, "run", &Progress::new()).unwrap()
}

/// The verdict and the names of what was found.
fn told(discovery: &TendonDiscovery) -> (&'static str, Vec<&'static str>) {
    let tendon = &discovery.result.cables[0];
    (tendon.verdict.name(), tendon.effects.iter().map(|effect| effect.kind).collect())
}

/// The same without the holes whose μ is their own: those of simulated manipulators differ by ±10 %, and a run with both directions tells some of them.
fn told_but_holes(discovery: &TendonDiscovery) -> (&'static str, Vec<&'static str>) {
    let (verdict, mut kinds) = told(discovery);
    kinds.retain(|kind| *kind != "hole_friction");
    (verdict, kinds)
}

fn without_sigma(text: &str) -> String {
    text.lines().filter(|line| !line.starts_with("sigma_n_per_m")).map(|line| line.to_owned() + "\n").collect()
}

#[test]
fn a_spread_of_friction_is_told_hole_by_hole_or_not_at_all() {
    let (text, samples) = measured(Experiment::OneWay, 1, &[0.1753]);
    assert_eq!(told(&found(&text, &samples)), ("complete", Vec::new()));
    for seed in [2, 3] {
        let (text, samples) = measured(Experiment::Mixed, seed, &[0.1753]);
        let discovery = found(&text, &samples);
        let (verdict, kinds) = told(&discovery);
        assert_eq!(verdict, if kinds.is_empty() { "complete" } else { "extended" }, "{seed}");
        assert!(kinds.iter().all(|kind| *kind == "hole_friction"), "{seed} {kinds:?}");
        let written = rewrite(&text, "arm", &discovery.edit).unwrap();
        assert_eq!(told(&found(&written, &samples)), ("complete", Vec::new()), "{seed}");
    }
    // Pulled one way, nothing tells the history from Coulomb's friction.
    let (text, samples) = measured(Experiment::OneWay, 4, &[0.1753]);
    assert_eq!(told(&found(&without_sigma(&text), &samples)), ("complete", Vec::new()));
}

/// Segments of constant curvature miss the disks of an arm of four by millimetres. That is no effect of the machine.
#[test]
fn the_models_own_error_gets_no_name() {
    let coarse = PROTOTYPE.replace("disk_count = 8", "disk_count = 4").replace("pitch_m = 0.037", "pitch_m = 0.074");
    for (experiment, seed) in [(Experiment::OneWay, 1), (Experiment::Mixed, 2), (Experiment::Mixed, 3)] {
        let options = TendonSimulationOptions { experiment, seed, ..TendonSimulationOptions::default() };
        let (text, samples) = calibrated(&coarse, &coarse, &options);
        let run = Run::new(samples, 4).unwrap();
        let discovery =
            discover(&ManipulatorFile::parse(&text, "arm").unwrap(), &run, "run", &Progress::new()).unwrap();
        assert_eq!(told_but_holes(&discovery).1, Vec::<&str>::new(), "{seed}");
        let off_mm = discovery.result.cables[0].markers.as_ref().unwrap().after.rms_mm;
        assert!(off_mm > 0.5, "{seed}: the disks are off by {off_mm} mm only");
    }
}

/// The noise is that of the same run without gaps.
#[test]
fn samples_that_gratings_lack_do_not_hide_their_noise() {
    let (text, mut samples) = measured(Experiment::Mixed, 2, &[0.1753]);
    let whole = found(&text, &samples).result.cables[0].noise_floor_n.unwrap();
    for shift_nm in samples.iter_mut().step_by(20).flat_map(|sample| &mut sample.shift_nm) {
        *shift_nm = f64::NAN;
    }
    let discovery = found(&text, &samples);
    assert_ne!(told(&discovery).0, "unexplained");
    let noise_n = discovery.result.cables[0].noise_floor_n.unwrap();
    assert!((noise_n / whole - 1.0).abs() < 0.1, "{noise_n} {whole}");
    for (place, sample) in samples.iter_mut().enumerate() {
        if place % 4 == 0 {
            sample.shift_nm.fill(f64::NAN);
        }
    }
    let file = ManipulatorFile::parse(&text, "arm").unwrap();
    let refused = discover(&file, &Run::new(samples, 8).unwrap(), "run", &Progress::new()).unwrap_err();
    assert_eq!(refused, ContinuumError::UntoldNoise);
}

/// A search that is stopped ends, and tells nothing.
#[test]
fn a_stopped_search_tells_nothing() {
    let (text, samples) = measured(Experiment::OneWay, 5, &[0.1753]);
    let progress = Progress::new();
    progress.stop();
    let file = ManipulatorFile::parse(&text, "arm").unwrap();
    let stopped = discover(&file, &Run::new(samples, 8).unwrap(), "run", &progress).unwrap_err();
    assert_eq!(stopped, ContinuumError::NotIdentified);
}

#[test]
fn friction_and_its_memory_are_named() {
    let none = |text: &str| text.replace("mu = 0.1753 ", "mu = 0.0 ");
    let (text, samples) = measured(Experiment::OneWay, 5, &[0.1753]);
    let discovery = found(&none(&text), &samples);
    assert_eq!(told(&discovery), ("extended", vec!["coulomb"]));
    let mu = discovery.result.cables[0].effects[0].parameters.get("mu").unwrap();
    assert!((mu / 0.1753 - 1.0).abs() < 0.1, "{mu}");
    assert!(discovery.result.cables[0].gap_closed.unwrap() > 0.95);

    let (text, samples) = measured(Experiment::Mixed, 6, &[0.1753]);
    assert_eq!(told_but_holes(&found(&none(&text), &samples)), ("extended", vec!["coulomb", "presliding"]));
    let discovery = found(&without_sigma(&text), &samples);
    assert_eq!(told_but_holes(&discovery), ("extended", vec!["presliding"]));
    // With what was found in the file nothing is missing.
    let extended = rewrite(&without_sigma(&text), "arm", &discovery.edit).unwrap();
    assert_eq!(told(&found(&extended, &samples)), ("complete", Vec::new()));
}

#[test]
fn a_hole_of_its_own_is_named() {
    let mut mu = [0.1753; 8];
    mu[3] = 0.35;
    for experiment in [Experiment::OneWay, Experiment::Mixed] {
        let (text, samples) = measured(experiment, 1, &mu);
        let discovery = found(&text, &samples);
        assert_eq!(told_but_holes(&discovery), ("extended", Vec::new()), "{experiment:?}");
        let effect = &discovery.result.cables[0].effects[0];
        assert_eq!(effect.parameters.get("hole"), Some(4.0), "the roughest comes first");
        assert!((effect.parameters.get("mu").unwrap() / 0.35 - 1.0).abs() < 0.15);
        assert_eq!(discovery.edit.mu.len(), 8);
    }
}

#[test]
fn a_drifting_grating_is_named_and_another_fault_is_not() {
    let (text, samples) = measured(Experiment::Mixed, 7, &[0.1753]);
    let mut warm = samples.clone();
    for sample in &mut warm {
        sample.shift_nm[2] += 0.002 * sample.time_s;
    }
    let discovery = found(&text, &warm);
    assert_eq!(told_but_holes(&discovery), ("extended", vec!["sensor_drift"]));
    let effects = &discovery.result.cables[0].effects;
    let effect = effects.iter().find(|effect| effect.kind == "sensor_drift").unwrap();
    assert_eq!(effect.parameters.get("grating"), Some(3.0));
    assert!((effect.parameters.get("drift_nm_per_s").unwrap() / 0.002 - 1.0).abs() < 0.1);
    let extended = rewrite(&text, "arm", &discovery.edit).unwrap();
    assert_eq!(told(&found(&extended, &warm)), ("complete", Vec::new()));

    // Beside the fault of another grating it is still a drift.
    for sample in &mut warm {
        sample.shift_nm[6] += 0.01 * (5.0 * sample.time_s).sin();
    }
    assert_eq!(told_but_holes(&found(&text, &warm)), ("unexplained", vec!["sensor_drift"]));

    let mut humming = samples;
    for sample in &mut humming {
        sample.shift_nm[4] += 0.01 * (5.0 * sample.time_s).sin();
    }
    let discovery = found(&text, &humming);
    assert_eq!(told(&discovery), ("unexplained", Vec::new()));
    let rest = discovery.result.cables[0].unexplained.as_ref().unwrap();
    assert_eq!(rest.places[0].from, 5);
}

/// Holes of another law leave a few millinewtons at every grating, which contradict neither a drift nor a lag: both are named, and the rest is told.
#[test]
fn what_all_holes_leave_hides_neither_a_drift_nor_a_lag() {
    let (text, mut samples) = measured(Experiment::Mixed, 7, &[0.1753]);
    for sample in &mut samples {
        for (grating, shift_nm) in (0_u32..).zip(&mut sample.shift_nm) {
            *shift_nm += 0.0003 * (2.0 * sample.time_s + f64::from(grating)).sin();
        }
    }
    assert_eq!(told_but_holes(&found(&text, &samples)), ("unexplained", Vec::new()));

    let mut warm = samples.clone();
    for sample in &mut warm {
        sample.shift_nm[4] += 0.002 * sample.time_s;
    }
    let discovery = found(&text, &warm);
    assert_eq!(told_but_holes(&discovery), ("unexplained", vec!["sensor_drift"]));
    let effect = discovery.result.cables[0].effects.iter().find(|effect| effect.kind == "sensor_drift").unwrap();
    assert_eq!(effect.parameters.get("grating"), Some(5.0));
    assert!((effect.parameters.get("drift_nm_per_s").unwrap() / 0.002 - 1.0).abs() < 0.05);

    let mut late = samples.clone();
    for (sample, shown) in late.iter_mut().skip(3).zip(&samples) {
        sample.tension_base_n = shown.tension_base_n;
    }
    let discovery = found(&text, &late);
    assert_eq!(told_but_holes(&discovery), ("unexplained", vec!["tension_lag"]));
    let lag_s = discovery.result.cables[0].effects[0].parameters.get("base_lag_s").unwrap();
    assert!((lag_s / (samples[3].time_s - samples[0].time_s) - 1.0).abs() < 0.05, "{lag_s} s");
}

/// Pulled one way the last samples lack what comes after them; it is taken to go on.
#[test]
fn a_lag_is_found_also_pulled_one_way() {
    let (text, samples) = measured(Experiment::OneWay, 7, &[0.1753]);
    let mut late = samples.clone();
    for (sample, shown) in late.iter_mut().skip(3).zip(&samples) {
        sample.tension_base_n = shown.tension_base_n;
    }
    let discovery = found(&text, &late);
    assert_eq!(told_but_holes(&discovery), ("extended", vec!["tension_lag"]));
    let lag_s = discovery.result.cables[0].effects[0].parameters.get("base_lag_s").unwrap();
    assert!((lag_s / (samples[3].time_s - samples[0].time_s) - 1.0).abs() < 0.05, "{lag_s} s");
}

/// The search looks at some 200 samples; a run of 350 samples has its lag exactly, and the step of all gratings where it is, between any two samples.
#[test]
fn a_lag_and_a_step_are_those_of_all_samples() {
    let (text, _) = measured(Experiment::Mixed, 7, &[0.1753]);
    let noise = TendonSimulationOptions::default();
    let options = TendonSimulationOptions {
        experiment: Experiment::Mixed,
        seed: 7,
        grating_noise_nm: 0.0,
        marker_noise_m: 0.0,
        ..noise
    };
    let samples = simulate(ManipulatorFile::parse(&text, "truth").unwrap().params(), &options).unwrap().samples;
    // Twice the samples, each second one halfway between two others, and noise of their own.
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let mut dense = Vec::new();
    for pair in samples.windows(2) {
        let halfway = |one: f64, other: f64| 0.5 * (one + other);
        let mut between = pair[0].clone();
        between.time_s = halfway(between.time_s, pair[1].time_s);
        between.tension_base_n = halfway(between.tension_base_n, pair[1].tension_base_n);
        for (shift_nm, next_nm) in between.shift_nm.iter_mut().zip(&pair[1].shift_nm) {
            *shift_nm = halfway(*shift_nm, *next_nm);
        }
        let markers = between.marker_m.iter_mut().flatten().zip(pair[1].marker_m.iter().flatten());
        markers.for_each(|(place_m, next_m)| *place_m = halfway(*place_m, *next_m));
        dense.extend([pair[0].clone(), between]);
    }
    for sample in &mut dense {
        sample.shift_nm.iter_mut().for_each(|shift_nm| *shift_nm += noise.grating_noise_nm * normal());
        sample.marker_m.iter_mut().flatten().for_each(|place_m| *place_m += noise.marker_noise_m * normal());
    }
    assert!((300..800).contains(&dense.len()), "{}", dense.len());
    for place in [dense.len() / 3, dense.len() / 2, dense.len() / 2 + 1] {
        let mut warmer = dense.clone();
        for shift_nm in warmer[place..].iter_mut().flat_map(|sample| &mut sample.shift_nm) {
            *shift_nm += 0.02;
        }
        let discovery = found(&text, &warmer);
        assert_eq!(told_but_holes(&discovery), ("extended", vec!["temperature"]));
        let effects = &discovery.result.cables[0].effects;
        let from_s =
            effects.iter().find(|effect| effect.kind == "temperature").and_then(|of| of.parameters.get("from_s"));
        let from_s = from_s.unwrap();
        assert!(
            dense[place - 1].time_s < from_s && from_s < dense[place].time_s,
            "{from_s} s, {} s",
            dense[place].time_s
        );
    }
    for count in [3, 5] {
        let mut late = dense.clone();
        for (sample, shown) in late.iter_mut().skip(count).zip(&dense) {
            sample.tension_base_n = shown.tension_base_n;
        }
        let discovery = found(&text, &late);
        assert_eq!(told_but_holes(&discovery), ("extended", vec!["tension_lag"]));
        let lag = &discovery.result.cables[0].effects[0];
        let truth_s = dense[count].time_s - dense[0].time_s;
        let (lag_s, error_s) =
            (lag.parameters.get("base_lag_s").unwrap(), lag.standard_errors.get("base_lag_s").unwrap());
        assert!(
            (lag_s - truth_s).abs() < 1.96 * error_s && error_s < 0.02 * truth_s,
            "{lag_s} ± {error_s} s, {truth_s} s"
        );
    }
}

/// Lines of other gratings are wrong in slope and offset, and pulled one way the tension rises with the time as a drift does.
#[test]
fn lines_of_other_gratings_are_no_drift() {
    for (experiment, seed, other) in
        [(Experiment::OneWay, 6, 7), (Experiment::OneWay, 9, 10), (Experiment::Mixed, 7, 5)]
    {
        let (_, samples) = measured(experiment, seed, &[0.1753]);
        let (text, _) = measured(experiment, other, &[0.1753]);
        assert_eq!(told(&found(&text, &samples)), ("unexplained", Vec::new()), "{experiment:?} {seed} {other}");
    }
    // One of them alone.
    let (text, mut samples) = measured(Experiment::OneWay, 11, &[0.1753]);
    for sample in &mut samples {
        sample.shift_nm[4] *= 1.15;
    }
    assert_eq!(told(&found(&text, &samples)), ("unexplained", Vec::new()));
}

#[test]
fn runs_that_tell_nothing_are_refused() {
    let (text, samples) = measured(Experiment::OneWay, 8, &[0.1753]);
    let file = ManipulatorFile::parse(&text, "arm").unwrap();
    let refused = |samples: Vec<RunSample>, file: &ManipulatorFile| {
        discover(file, &Run::new(samples, 8).unwrap(), "run", &Progress::new()).unwrap_err()
    };
    assert!(matches!(refused(samples[..20].to_vec(), &file), ContinuumError::TooShort { count: 20, .. }));
    let blind = samples.iter().map(|sample| RunSample { shift_nm: Vec::new(), ..sample.clone() }).collect();
    assert!(refused(blind, &file).to_string().starts_with("the run has no gratings"));
    assert_eq!(refused(samples, &ManipulatorFile::parse(PROTOTYPE, "arm").unwrap()), ContinuumError::NoGratings);
}
