//! Markers take part in the verdict, and the file written makes no shape worse.

use fric_core::continuum::edit::{ManipulatorEdit, rewrite};
use fric_core::continuum::file::ManipulatorFile;
use fric_lab::continuum::discover::TendonDiscovery;
use fric_lab::continuum::shape_errors::{Way, shapes};
use fric_lab::continuum::simulate::{Experiment, TendonSimulationOptions};
use fric_lab::continuum::{Run, RunSample};

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

#[test]
fn a_bending_that_is_not_the_models_is_not_called_complete() {
    let off_by = [
        (0.9, 1.0, Experiment::OneWay),
        (1.1, 1.0, Experiment::Mixed),
        (1.0, 0.95, Experiment::Mixed),
        (1.0, 1.05, Experiment::OneWay),
    ];
    for (stiffness_ratio, offset_ratio, experiment) in off_by {
        let (text, samples) = off(stiffness_ratio, offset_ratio, &options(experiment, 21));
        let discovery = found(&text, &samples);
        assert_eq!(told_but_holes(&discovery), ("unexplained", Vec::new()), "{stiffness_ratio} {offset_ratio}");
        let rest = discovery.result.cables[0].unexplained.as_ref().unwrap();
        assert!(rest.rms_mm.unwrap() > 2.0);
        assert_eq!((rest.places[0].signal, rest.places[0].from), ("marker", 8), "the tip is furthest off");
        let goes_with = &rest.goes_with[0];
        assert_eq!((goes_with.signal, goes_with.with), ("marker", "bending"));
        // The bend is that of the moment T·r over EI.
        let ratio = goes_with.parameters.get("stiffness_ratio").unwrap();
        assert!((ratio - stiffness_ratio / offset_ratio).abs() < 0.02, "{ratio}");
        assert_nothing_worse(&text, &samples, &discovery);
        // What was written, given again, says the same.
        let written = rewrite(&text, "arm", &discovery.edit).unwrap();
        assert_eq!(told_but_holes(&found(&written, &samples)), ("unexplained", Vec::new()));
    }
}

/// Friction that is too great hides a part of a backbone that is stiffer than stated: with the μ of the run the disks bend further beyond their markers.
#[test]
fn a_mu_that_stays_for_the_shapes_sake_says_why() {
    let truth = PROTOTYPE.replace("mu = 0.1753 ", "mu = 0.15 ");
    let (text, samples) = {
        let stiffer = truth.replace("youngs_modulus_pa = 200e9", "youngs_modulus_pa = 220e9");
        measured_of(&stiffer, &options(Experiment::OneWay, 27))
    };
    let discovery = found(&text, &samples);
    assert!(discovery.edit.mu.is_empty(), "the file keeps its μ");
    let kept = discovery.result.cables[0].kept.clone().unwrap();
    assert!(discovery.result.summary().contains("\nkept: "));
    let number_after = |words: &str| -> f64 {
        let number = kept.split(words).nth(1).unwrap().trim_start().split([' ', ',']).next().unwrap();
        number.parse().unwrap()
    };
    let mu = number_after("fitted to the run it is");
    assert!((mu / 0.15 - 1.0).abs() < 0.1, "{kept}");
    let disk = format!("{}", number_after("disk")).parse::<usize>().unwrap() - 1;
    let refitted = rewrite(&text, "arm", &ManipulatorEdit { mu: vec![mu], ..ManipulatorEdit::default() }).unwrap();
    let [before_m, after_m] = [&text, &refitted].map(|text| distances_m(text, &samples)[disk]);
    // Written to a hundredth of a millimetre.
    assert!((number_after("is then") - 1e3 * after_m).abs() < 0.02, "{kept} {after_m}");
    assert!((number_after("instead of") - 1e3 * before_m).abs() < 0.02, "{kept} {before_m}");
    assert!(after_m > before_m);
    // A right bending keeps nothing back.
    let (text, samples) = measured_of(&truth, &options(Experiment::OneWay, 27));
    let discovery = found(&text, &samples);
    assert!(discovery.result.cables[0].kept.is_none());
    assert!((discovery.edit.mu[0] / 0.15 - 1.0).abs() < 0.1);
}

#[test]
fn without_markers_the_bending_is_not_told() {
    let (text, mut samples) = off(0.9, 1.0, &options(Experiment::Mixed, 22));
    for sample in &mut samples {
        sample.marker_m.clear();
    }
    let discovery = found(&text, &samples);
    assert!(discovery.result.cables[0].markers.is_none());
    assert_ne!(discovery.result.cables[0].verdict, "unexplained");
}

#[test]
fn a_frame_of_the_markers_that_is_off_is_told() {
    let (text, mut samples) = measured(Experiment::Mixed, 23, &[0.1753]);
    for marker_m in samples.iter_mut().flat_map(|sample| &mut sample.marker_m) {
        *marker_m = [marker_m[0] + 0.001, marker_m[1] - 0.002];
    }
    let discovery = found(&text, &samples);
    assert_eq!(told_but_holes(&discovery), ("unexplained", Vec::new()));
    let goes_with = &discovery.result.cables[0].unexplained.as_ref().unwrap().goes_with[0];
    assert_eq!(goes_with.with, "frame");
    let of = |name: &str| goes_with.parameters.get(name).unwrap();
    assert!((of("x_m") - 0.001).abs() < 2e-4 && (of("y_m") + 0.002).abs() < 2e-4, "{goes_with:?}");
}

/// `α_Λ + α_n` of silica is 0.55e-6 + 6.3e-6 per K; the wavelengths are those of the C band.
#[test]
fn a_temperature_without_reference_is_told_and_no_friction() {
    for (experiment, from_s, kelvin) in
        [(Experiment::OneWay, 3.35, 5.0), (Experiment::Mixed, 8.05, -5.0), (Experiment::Mixed, -1.0, 5.0)]
    {
        let (text, mut samples) = measured(experiment, 24, &[0.1753]);
        for sample in samples.iter_mut().filter(|sample| sample.time_s > from_s) {
            sample.shift_nm.iter_mut().for_each(|shift_nm| *shift_nm += 1550.0 * 6.85e-6 * kelvin);
        }
        let discovery = found(&text, &samples);
        assert_eq!(told(&discovery), ("unexplained", Vec::new()), "{experiment:?} {kelvin}");
        let goes_with = &discovery.result.cables[0].unexplained.as_ref().unwrap().goes_with[0];
        assert_eq!(goes_with.with, if from_s < 0.0 { "temperature" } else { "temperature_step" });
        let told_kelvin = goes_with.parameters.get("temperature_k").unwrap();
        assert!((told_kelvin / kelvin - 1.0).abs() < 0.05, "{told_kelvin}");
        assert!(goes_with.parameters.get("from_s").is_none_or(|told_s| (told_s - from_s).abs() < 0.1));
        assert_eq!(discovery.edit, ManipulatorEdit::default(), "nothing is written");
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

/// With friction to find in a backbone that is too soft, friction is found and the bending left.
#[test]
fn what_is_found_beside_a_wrong_bending_makes_no_shape_worse() {
    let (text, samples) = off(1.1, 1.0, &options(Experiment::Mixed, 25));
    let smooth = text.replace("mu = 0.1753 ", "mu = 0.0 ");
    let discovery = found(&smooth, &samples);
    assert_eq!(told_but_holes(&discovery), ("unexplained", vec!["coulomb", "presliding"]));
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
