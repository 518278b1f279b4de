//! Numbers of a manipulator are found again from runs of an independent elastica, and what a run cannot tell is said.

use fric_lab::fit::Progress;
use fric_tendon::edit::rewrite;
use fric_tendon::file::ManipulatorFile;
use fric_tendon_lab::identify::{Identification, Quantity, TendonFitOptions, identify};
use fric_tendon_lab::shape_errors::{ShapeErrors, Way, shapes};
use fric_tendon_lab::simulate::{Experiment, TendonSimulationOptions};
use fric_tendon_lab::{ContinuumError, Run, RunSample, as_measured, corrected};

use super::discover::{PROTOTYPE, calibrated};

/// The prototype upright in gravity, with light disks.
fn standing() -> String {
    PROTOTYPE.replace("[0.0, 0.0]", "[-9.80665, 0.0]").replace("disk_mass_kg = 0.003 ", "disk_mass_kg = 0.0003 ")
}

/// The text of the calibrated file that is given, and a run of the truth.
fn run_of(given: &str, truth: &str, experiment: Experiment, seed: u64) -> (String, Vec<RunSample>) {
    let options = TendonSimulationOptions { experiment, seed, ..TendonSimulationOptions::default() };
    let (text, samples) = calibrated(given, truth, &options);
    let truth = ManipulatorFile::parse(truth, "truth").unwrap();
    (text, as_measured(&samples, &truth))
}

fn identified(text: &str, samples: &[RunSample], names: &[&str]) -> Identification {
    let file = ManipulatorFile::parse(text, "arm").unwrap();
    let quantities = Quantity::all_named(names.iter().copied()).unwrap();
    let options = TendonFitOptions { quantities: Some(quantities) };
    identify(&file, &[Run::new(samples.to_vec(), 8).unwrap()], &["run".to_owned()], &options, &Progress::new()).unwrap()
}

/// Value found less truth, in half 95 % intervals.
fn off(found: &Identification, key: &str, truth: f64) -> f64 {
    let error = found.result.standard_errors.get(key).unwrap();
    (found.result.parameters.get(key).unwrap() - truth) / (1.96 * error)
}

/// Mean distance of the disks from their markers by the history with the file that was written, mm.
fn shape_mm(text: &str, found: &Identification, samples: &[RunSample]) -> f64 {
    let file = ManipulatorFile::parse(&rewrite(text, "arm", &found.edit).unwrap(), "fitted").unwrap();
    let run = corrected(&Run::new(samples.to_vec(), 8).unwrap(), &file).unwrap();
    let mut errors = ShapeErrors::default();
    let computed = shapes(file.params(), run.samples(), Way::History, &[]).unwrap();
    computed.iter().zip(run.samples()).for_each(|(shape, sample)| errors.add(shape, &sample.marker_m));
    errors.mean_mm().unwrap()
}

#[test]
fn stiffness_friction_and_the_markers_frame_are_found_together() {
    let truth = PROTOTYPE.replace("200e9", "220e9") + "\n[markers]\noffset_m = [0.005, -0.002]\nangle_rad = 0.0524\n";
    let (text, samples) = run_of(PROTOTYPE, &truth, Experiment::OneWay, 41);
    let found = identified(&text, &samples, &["backbone_stiffness", "tendon_offset", "marker_frame", "mu"]);
    for (key, truth) in [
        ("bending_stiffness_n_m2", 2.97e-3),
        ("marker_offset_x_m", 0.005),
        ("marker_offset_y_m", -0.002),
        ("marker_angle_rad", 0.0524),
    ] {
        // Two half intervals: one run of a few is further off than one.
        assert!(off(&found, key, truth).abs() < 2.0, "{key} {}", off(&found, key, truth));
    }
    assert!((found.result.parameters.get("bending_stiffness_n_m2").unwrap() / 2.97e-3 - 1.0).abs() < 0.01);
    // Lying flat, a tendon further out does what a softer backbone does.
    let open = &found.result.undetermined[0];
    assert_eq!(open.parameters[..2], ["hole_radius_m", "bending_stiffness_n_m2"]);
    assert!(found.edit.hole_radius_m.is_none() && found.result.parameters.get("hole_radius_m").is_none());
    assert!(found.result.before.marker_mean_mm.unwrap() > 4.0);
    assert!(shape_mm(&text, &found, &samples) < 0.35);
}

#[test]
fn a_load_on_the_tip_is_told_from_the_stiffness_by_weight() {
    let truth = standing() + "\n[tip]\nmass_kg = 0.001\n";
    let (text, samples) = run_of(&standing(), &truth, Experiment::OneWay, 42);
    let found = identified(&text, &samples, &["backbone_stiffness", "tip_load", "mu"]);
    assert!((found.result.parameters.get("tip_mass_kg").unwrap() / 0.001 - 1.0).abs() < 0.05);
    assert!(off(&found, "tip_mass_kg", 0.001).abs() < 2.0 && off(&found, "bending_stiffness_n_m2", 2.7e-3).abs() < 2.0);
    assert!(shape_mm(&text, &found, &samples) < 0.35);
}

#[test]
fn gratings_are_not_needed_nor_is_the_tension_at_the_base() {
    let truth = PROTOTYPE.replace("200e9", "180e9");
    let (text, samples) = run_of(PROTOTYPE, &truth, Experiment::OneWay, 43);
    let blind: Vec<RunSample> =
        samples.iter().map(|sample| RunSample { shift_nm: Vec::new(), ..sample.clone() }).collect();
    let found = identified(PROTOTYPE, &blind, &["backbone_stiffness", "mu"]);
    assert!((found.result.parameters.get("bending_stiffness_n_m2").unwrap() / 2.43e-3 - 1.0).abs() < 0.02);
    assert!(found.result.before.tension_rms_n.is_none());

    let loose: Vec<RunSample> =
        samples.iter().map(|sample| RunSample { tension_base_n: f64::NAN, ..sample.clone() }).collect();
    let found = identified(&text, &loose, &["backbone_stiffness", "mu"]);
    assert!((found.result.parameters.get("bending_stiffness_n_m2").unwrap() / 2.43e-3 - 1.0).abs() < 0.01);
    // Without it nothing tells the friction.
    assert_eq!(found.result.undetermined[0].parameters, ["mu"]);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let (text, samples) = run_of(PROTOTYPE, PROTOTYPE, Experiment::OneWay, 44);
    let refused = |text: &str, change: &dyn Fn(&mut RunSample)| {
        let mut samples = samples.clone();
        samples.iter_mut().for_each(change);
        let file = ManipulatorFile::parse(text, "arm").unwrap();
        let run = Run::new(samples, 8).unwrap();
        identify(&file, &[run], &["run".to_owned()], &TendonFitOptions::default(), &Progress::new()).unwrap_err()
    };
    let alone = refused(&text, &|sample| {
        sample.marker_m.clear();
        sample.shift_nm.clear();
    });
    assert!(alone.to_string().starts_with("the run has no marker or grating"), "{alone}");
    let only_markers = refused(&text, &|sample| {
        sample.tension_base_n = f64::NAN;
        sample.shift_nm.clear();
    });
    assert!(only_markers.to_string().starts_with("the run has no tension"), "{only_markers}");
    assert_eq!(refused(PROTOTYPE, &|sample| sample.marker_m.clear()), ContinuumError::NoGratings);
    let few = Run::new(samples[..10].to_vec(), 8).unwrap();
    let file = ManipulatorFile::parse(&text, "arm").unwrap();
    let few = identify(&file, &[few], &["run".to_owned()], &TendonFitOptions::default(), &Progress::new()).unwrap_err();
    assert_eq!(few, ContinuumError::TooShort { count: 10, needed: 20 });
    assert!(Quantity::all_named(["stifness"]).unwrap_err().contains("unknown quantity"));
    assert!(Quantity::all_named(["mu", "hole_mu"]).unwrap_err().contains("name one of them"));
}

/// What is found by default.
fn usual(text: &str, samples: &[RunSample]) -> Identification {
    let file = ManipulatorFile::parse(text, "arm").unwrap();
    let run = Run::new(samples.to_vec(), file.params().disk_count()).unwrap();
    identify(&file, &[run], &["run".to_owned()], &TendonFitOptions::default(), &Progress::new()).unwrap()
}

/// A soft arm of plastic, on its side.
const SIDEWAYS: &str = "format = 'fric-continuum/1'\nname = 'sideways'\ndisk_count = 9\npitch_m = 0.04\ndisk_thickness_m = 0.002\n\
                        hole_radius_m = 0.012\ndisk_mass_kg = 0.00015\ngravity_m_per_s2 = [0.0, -9.81]\n\
                        [backbone]\nwidth_m = 0.006\nthickness_m = 0.00115\nyoungs_modulus_pa = 3e9\nmass_kg_per_m = 0.008\n\
                        [tendon]\nmu = 0.15\nsigma_n_per_m = 15000.0\naxial_stiffness_n = 9000.0\ncapacity_n = 4.0\n";

/// The tendon's offset is held as long as a mass on the tip may do the same; once that would be below zero, the offset is found.
#[test]
fn what_was_held_for_a_mass_below_zero_is_found() {
    for seed in [1, 6] {
        let given = SIDEWAYS.replace("= 0.012", "= 0.01143");
        let (text, samples) = run_of(&given, SIDEWAYS, Experiment::Mixed, seed);
        let found = usual(&text, &samples);
        for (key, truth) in
            [("hole_radius_m", 0.012), ("bending_stiffness_n_m2", 2.2813e-3), ("precurvature_per_m", 0.0)]
        {
            assert!(off(&found, key, truth).abs() < 2.0, "{seed}: {key} {}", off(&found, key, truth));
        }
    }
}

/// A search that is stopped ends, and finds nothing.
#[test]
fn a_stopped_search_finds_nothing() {
    let (text, samples) = run_of(PROTOTYPE, PROTOTYPE, Experiment::OneWay, 40);
    let progress = Progress::new();
    progress.stop();
    let (file, run) = (ManipulatorFile::parse(&text, "arm").unwrap(), Run::new(samples, 8).unwrap());
    let stopped = identify(&file, &[run], &["run".to_owned()], &TendonFitOptions::default(), &progress);
    assert!(matches!(stopped, Err(ContinuumError::NotIdentified)));
}

#[test]
fn one_run_without_markers_hides_none_of_the_other() {
    let truth = PROTOTYPE.replace("200e9", "220e9");
    let (text, samples) = run_of(PROTOTYPE, &truth, Experiment::Mixed, 48);
    let dark = samples.iter().map(|sample| RunSample { marker_m: Vec::new(), ..sample.clone() }).collect();
    let file = ManipulatorFile::parse(&text, "arm").unwrap();
    let runs = [samples.clone(), dark].map(|samples| Run::new(samples, 8).unwrap());
    let names = ["light".to_owned(), "dark".to_owned()];
    let found = identify(&file, &runs, &names, &TendonFitOptions::default(), &Progress::new()).unwrap();
    assert!(off(&found, "bending_stiffness_n_m2", 2.97e-3).abs() < 2.0);
}

#[test]
fn a_mu_that_stands_for_a_stiffness_is_not_written() {
    let (text, samples) = run_of(PROTOTYPE, PROTOTYPE, Experiment::Mixed, 49);
    let stiff = text.replace("200e9", "206e9");
    let found = identified(&stiff, &samples, &["mu"]);
    assert_eq!(rewrite(&stiff, "arm", &found.edit).unwrap(), stiff);
    assert_eq!(found.result.undetermined[0].parameters, ["mu"]);
}

#[test]
fn without_markers_only_friction_is_looked_for() {
    let (text, samples) = run_of(PROTOTYPE, PROTOTYPE, Experiment::Mixed, 45);
    let dark: Vec<RunSample> =
        samples.iter().map(|sample| RunSample { marker_m: Vec::new(), ..sample.clone() }).collect();
    let found = usual(&text, &dark);
    let keys: Vec<&str> = found.result.parameters.0.iter().map(|(key, _)| key.as_str()).collect();
    assert!(keys.iter().all(|key| ["mu", "sigma_n_per_m"].contains(key)) && keys.contains(&"mu"), "{keys:?}");
    assert!(off(&found, "mu", 0.1753).abs() < 2.0);
    assert!(shape_mm(&text, &found, &samples) < 0.35);
}

#[test]
fn a_common_step_of_the_gratings_is_taken_off() {
    let (text, samples) = run_of(PROTOTYPE, PROTOTYPE, Experiment::Mixed, 46);
    let mut warm = samples.clone();
    for sample in warm.iter_mut().filter(|sample| sample.time_s >= 9.0) {
        sample.shift_nm.iter_mut().for_each(|shift_nm| *shift_nm += 0.056);
    }
    let [found, plain] = [&warm, &samples].map(|samples| usual(&text, samples));
    assert_eq!((found.result.common_steps[0].len(), plain.result.common_steps[0].len()), (1, 0));
    // What is left of the step is its error, of a grating's noise.
    let mu = |of: &Identification| of.result.parameters.get("mu").unwrap();
    assert!((mu(&found) / mu(&plain) - 1.0).abs() < 0.02, "{} {}", mu(&found), mu(&plain));
    assert!(!found.result.is_misfit && !plain.result.is_misfit);
    let [with_step, without] =
        [(&found, &warm), (&plain, &samples)].map(|(found, samples)| shape_mm(&text, found, samples));
    assert!(with_step < without + 0.05, "{with_step} {without}");
}

#[test]
fn nothing_is_written_that_moves_disks_off_their_markers() {
    let (text, mut samples) = run_of(PROTOTYPE, PROTOTYPE, Experiment::Mixed, 47);
    for sample in &mut samples {
        sample.tension_base_n *= 1.05;
    }
    let found = usual(&text, &samples);
    assert!(found.result.parameters.0.is_empty() && found.result.is_misfit);
    assert_eq!(rewrite(&text, "arm", &found.edit).unwrap(), text);
    assert!(
        found.result.undetermined[0].sentence.contains("off its marker"),
        "{}",
        found.result.undetermined[0].sentence
    );
    // With the gain among the numbers it is found.
    let found = identified(&text, &samples, &["base_gain", "mu"]);
    assert!(off(&found, "base_gain", 1.05).abs() < 2.0 && !found.result.is_misfit);
}
