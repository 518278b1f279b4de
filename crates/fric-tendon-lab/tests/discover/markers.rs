//! Markers take part in the verdict, and the file written makes no shape worse.

use fric_lab::discover::Verdict;
use fric_tendon::edit::rewrite;
use fric_tendon::file::ManipulatorFile;
use fric_tendon_lab::discover::TendonDiscovery;
use fric_tendon_lab::shape_errors::{Way, shapes};
use fric_tendon_lab::simulate::{Experiment, TendonSimulationOptions};
use fric_tendon_lab::{Run, RunSample};

use super::{PROTOTYPE, found, measured, measured_of, told, told_but_holes};

fn options(experiment: Experiment, seed: u64) -> TendonSimulationOptions {
    TendonSimulationOptions { experiment, seed, ..TendonSimulationOptions::default() }
}

/// A run of the prototype with another bending stiffness and with tendons at another distance.
fn off(stiffness_ratio: f64, offset_ratio: f64, options: &TendonSimulationOptions) -> (String, Vec<RunSample>) {
    let truth = PROTOTYPE
        .replace("youngs_modulus_pa = 200e9", &format!("youngs_modulus_pa = {}", 200e9 * stiffness_ratio))
        .replace("hole_radius_m = 0.015 ", &format!("hole_radius_m = {} ", 0.015 * offset_ratio));
    measured_of(&truth, options)
}

/// Distance of each disk from its marker by the history, root mean square over the run, m: computed here, not by the discovery.
fn distances_m(text: &str, samples: &[RunSample]) -> Vec<f64> {
    let file = ManipulatorFile::parse(text, "arm").unwrap();
    let computed = shapes(file.params(), samples, Way::History, &[]).unwrap();
    let square = |disk: usize| -> f64 {
        let pairs = computed.iter().zip(samples);
        let squares = pairs.map(|(shape, sample)| {
            let ([x, y], [marker_x, marker_y]) = (shape.disk_position_m[disk], sample.marker_m[disk]);
            (x - marker_x).powi(2) + (y - marker_y).powi(2)
        });
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = samples.len() as f64;
        squares.sum::<f64>() / count
    };
    (0..8).map(|disk| square(disk).sqrt()).collect()
}

/// No disk is further from its marker with the written file than with the given one, but for a tenth of the markers' noise.
fn assert_nothing_worse(text: &str, samples: &[RunSample], discovery: &TendonDiscovery) {
    let written = rewrite(text, "arm", &discovery.edit).unwrap();
    let (before, after) = (distances_m(text, samples), distances_m(&written, samples));
    for (disk, (before_m, after_m)) in before.iter().zip(&after).enumerate() {
        assert!(after_m <= &(before_m + 25e-6), "disk {}: {before_m} {after_m}", disk + 1);
    }
}

/// Lying flat, a tendon further out bends the arm as a softer backbone does: the ratio of both is what counts.
#[test]
fn a_bending_that_is_not_the_models_is_named() {
    for (stiffness_ratio, offset_ratio, experiment) in
        [(0.9, 1.0, Experiment::OneWay), (1.2, 1.0, Experiment::Mixed), (1.0, 0.95, Experiment::OneWay)]
    {
        let (text, samples) = off(stiffness_ratio, offset_ratio, &options(experiment, 21));
        let discovery = found(&text, &samples);
        let effect = &discovery.result.cables[0].effects[0];
        assert_eq!(told(&discovery), ("extended", vec![effect.kind]), "{stiffness_ratio} {offset_ratio}");
        let ratio = match effect.kind {
            "backbone_stiffness" => effect.parameters.get("stiffness_ratio").unwrap(),
            "tendon_offset" => 0.015 / effect.parameters.get("hole_radius_m").unwrap(),
            other => panic!("{other}"),
        };
        assert!((ratio / (stiffness_ratio / offset_ratio) - 1.0).abs() < 0.02, "{ratio}");
        if offset_ratio < 1.0 {
            let names = [&[effect.kind][..], &effect.alike].concat();
            assert!(names.contains(&"tendon_offset"), "{names:?}");
        }
        assert_nothing_worse(&text, &samples, &discovery);
        let written = rewrite(&text, "arm", &discovery.edit).unwrap();
        assert_eq!(told(&found(&written, &samples)), ("complete", Vec::new()));
    }
}

/// Its friction does not explain what a segment does that is half as stiff as the others.
#[test]
fn a_soft_segment_is_no_hole() {
    let truth = PROTOTYPE.replace(
        "youngs_modulus_pa = 200e9",
        "youngs_modulus_pa = 200e9\nsegment_stiffness_ratio = [1, 1, 1, 0.5, 1, 1, 1, 1]",
    );
    let (text, samples) = measured_of(&truth, &options(Experiment::OneWay, 29));
    let discovery = found(&text, &samples);
    assert_eq!(told(&discovery), ("extended", vec!["backbone_stiffness"]));
    let effect = &discovery.result.cables[0].effects[0];
    assert_eq!(effect.parameters.get("segment"), Some(4.0));
    assert!((effect.parameters.get("stiffness_ratio").unwrap() / 0.5 - 1.0).abs() < 0.02);
}

/// Disks that have slid along the backbone: the distances are those of the truth, within a twentieth of the displacement.
#[test]
fn disks_that_are_not_evenly_spaced_are_named() {
    let pitch_m = [0.039, 0.037, 0.035, 0.037, 0.037, 0.041, 0.033, 0.037];
    let truth = PROTOTYPE.replace("pitch_m = 0.037 ", &format!("pitch_m = {pitch_m:?} "));
    for experiment in [Experiment::OneWay, Experiment::Mixed] {
        let (text, samples) = measured_of(&truth, &options(experiment, 32));
        let discovery = found(&text, &samples);
        assert_eq!(told(&discovery), ("extended", vec!["uneven_pitch"]), "{experiment:?}");
        let parameters = &discovery.result.cables[0].effects[0].parameters;
        for (segment, truth_m) in pitch_m.iter().enumerate() {
            let found_m = parameters.get(&format!("pitch_{}_m", segment + 1)).unwrap();
            assert!((found_m - truth_m).abs() < 1e-4, "{} {found_m}", segment + 1);
        }
        assert_nothing_worse(&text, &samples, &discovery);
        let written = rewrite(&text, "arm", &discovery.edit).unwrap();
        assert_eq!(told(&found(&written, &samples)), ("complete", Vec::new()));
    }
}

/// Upright in gravity, a load on the tip and a base that leans are two things.
#[test]
fn loads_are_named() {
    let upright = |text: &str| {
        text.replace("[0.0, 0.0]", "[-9.80665, 0.0]").replace("disk_mass_kg = 0.003 ", "disk_mass_kg = 0.0003 ")
    };
    let leaning = |text: &str| text.replace("[-9.80665, 0.0]", "[-9.4725, -2.5382]");
    let loaded = |text: &str| text.to_owned() + "\n[tip]\nmass_kg = 0.001\n";
    let of = |truth: &str| {
        let (text, samples) = measured_of(truth, &options(Experiment::OneWay, 30));
        found(&upright(&text), &samples)
    };
    let discovery = of(&loaded(&upright(PROTOTYPE)));
    assert_eq!(told(&discovery), ("extended", vec!["tip_load"]));
    assert!((discovery.edit.tip_mass_kg.unwrap() / 0.001 - 1.0).abs() < 0.05);
    let discovery = of(&leaning(&upright(PROTOTYPE)));
    assert_eq!(told(&discovery), ("extended", vec!["gravity_direction"]));
    let [x, y] = discovery.edit.gravity_m_per_s2.unwrap();
    assert!(((y / x).atan().to_degrees() / 15.0 - 1.0).abs() < 0.05);
}

/// A sensor at the base that shows 5 % too much.
#[test]
fn a_gain_of_the_sensor_at_the_base_is_named() {
    let (text, mut samples) = measured(Experiment::Mixed, 31, &[0.1753]);
    for sample in &mut samples {
        sample.tension_base_n *= 1.05;
    }
    let discovery = found(&text, &samples);
    assert_eq!(told(&discovery), ("extended", vec!["base_gain"]));
    assert!((discovery.edit.base_sensor.unwrap().gain / 1.05 - 1.0).abs() < 0.005);
}

#[test]
fn without_markers_the_bending_is_not_told() {
    let (text, mut samples) = off(0.9, 1.0, &options(Experiment::Mixed, 22));
    for sample in &mut samples {
        sample.marker_m.clear();
    }
    let discovery = found(&text, &samples);
    assert!(discovery.result.cables[0].markers.is_none());
    assert_ne!(discovery.result.cables[0].verdict, Verdict::Unexplained);
}

#[test]
fn a_frame_of_the_markers_that_is_off_is_named() {
    let (text, mut samples) = measured(Experiment::OneWay, 23, &[0.1753]);
    let (sin, cos) = 0.0524_f64.sin_cos();
    for marker_m in samples.iter_mut().flat_map(|sample| &mut sample.marker_m) {
        let [x, y] = *marker_m;
        *marker_m = [0.003 + cos * x - sin * y, -0.004 + sin * x + cos * y];
    }
    let discovery = found(&text, &samples);
    assert_eq!(told(&discovery), ("extended", vec!["marker_frame"]));
    let markers = discovery.edit.markers.unwrap();
    assert!((markers.offset_m[0] - 0.003).abs() < 1e-4 && (markers.offset_m[1] + 0.004).abs() < 1e-4, "{markers:?}");
    assert!((markers.angle_rad - 0.0524).abs() < 1e-3, "{markers:?}");
}

/// `α_Λ + α_n` of silica is 0.55e-6 + 6.3e-6 per K; the wavelengths are those of the C band.
#[test]
fn a_temperature_without_reference_is_named_and_no_friction() {
    for (experiment, from_s, kelvin) in
        [(Experiment::OneWay, 3.35, 5.0), (Experiment::Mixed, 8.05, -5.0), (Experiment::OneWay, -1.0, 5.0)]
    {
        let (text, mut samples) = measured(experiment, 24, &[0.1753]);
        for sample in samples.iter_mut().filter(|sample| sample.time_s > from_s) {
            sample.shift_nm.iter_mut().for_each(|shift_nm| *shift_nm += 1550.0 * 6.85e-6 * kelvin);
        }
        let discovery = found(&text, &samples);
        assert_eq!(told(&discovery), ("extended", vec!["temperature"]), "{experiment:?} {kelvin}");
        let parameters = &discovery.result.cables[0].effects[0].parameters;
        let told_kelvin = parameters.get("temperature_k").unwrap();
        assert!((told_kelvin / kelvin - 1.0).abs() < 0.05, "{told_kelvin}");
        assert!(parameters.get("from_s").is_none_or(|told_s| (told_s - from_s).abs() < 0.11 || from_s < 0.0));
        let written = rewrite(&text, "arm", &discovery.edit).unwrap();
        assert_eq!(told(&found(&written, &samples)), ("complete", Vec::new()));
    }
}

/// A right model is complete or extended, at a fifth, once and four times the usual noise; names are of holes, whose μ do differ.
#[test]
fn a_right_model_is_not_called_unexplained() {
    for (noise_ratio, seed) in [(0.2, 31), (1.0, 33), (4.0, 35)] {
        for experiment in [Experiment::OneWay, Experiment::Mixed] {
            let usual = TendonSimulationOptions::default();
            let options = TendonSimulationOptions {
                grating_noise_nm: noise_ratio * usual.grating_noise_nm,
                marker_noise_m: noise_ratio * usual.marker_noise_m,
                ..options(experiment, seed)
            };
            let (text, samples) = measured_of(PROTOTYPE, &options);
            let discovery = found(&text, &samples);
            let (verdict, kinds) = told(&discovery);
            assert!(
                verdict != "unexplained" && kinds.iter().all(|kind| *kind == "hole_friction"),
                "{experiment:?} {seed}"
            );
            assert_nothing_worse(&text, &samples, &discovery);
        }
    }
}

/// With friction to find in a backbone that is too soft, both are found.
#[test]
fn friction_is_found_beside_a_wrong_bending() {
    let (text, samples) = off(1.1, 1.0, &options(Experiment::Mixed, 25));
    let smooth = text.replace("mu = 0.1753 ", "mu = 0.0 ");
    let discovery = found(&smooth, &samples);
    let (verdict, kinds) = told_but_holes(&discovery);
    assert_eq!((verdict, &kinds[1..]), ("extended", &["coulomb", "presliding"][..]));
    assert!(["backbone_stiffness", "tendon_offset"].contains(&kinds[0]), "{kinds:?}");
    assert_nothing_worse(&smooth, &samples, &discovery);
}

#[test]
fn too_few_markers_take_no_part() {
    let (text, mut samples) = off(0.9, 1.0, &options(Experiment::OneWay, 26));
    for sample in samples.iter_mut().skip(8) {
        sample.marker_m.fill([f64::NAN; 2]);
    }
    assert!(Run::new(samples.clone(), 8).is_ok());
    assert!(found(&text, &samples).result.cables[0].markers.is_none());
}
