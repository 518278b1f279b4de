//! Two numbers that are wrong at once, and two effects that a run cannot tell apart.

use fric_tendon_lab::discover::TendonDiscovery;
use fric_tendon_lab::simulate::{Experiment, TendonSimulationOptions};

use super::{PROTOTYPE, calibrated, found, measured, measured_of, told};

fn options(experiment: Experiment, seed: u64) -> TendonSimulationOptions {
    TendonSimulationOptions { experiment, seed, ..TendonSimulationOptions::default() }
}

/// Names of each effect with those that may be present instead.
fn named(discovery: &TendonDiscovery) -> Vec<Vec<&'static str>> {
    let effects = discovery.result.cables[0].effects.iter();
    effects.map(|effect| [&[effect.kind][..], &effect.alike].concat()).collect()
}

/// Upright in gravity, where weight tells them apart: only the ratio of stiffness and offset counts for the tension. The values are within 2 %.
#[test]
fn a_stiffness_and_an_offset_are_both_named() {
    let upright =
        PROTOTYPE.replace("[0.0, 0.0]", "[-9.80665, 0.0]").replace("disk_mass_kg = 0.003 ", "disk_mass_kg = 0.0003 ");
    for (stiffness_ratio, offset_ratio) in [(0.9, 1.05), (1.1, 0.95)] {
        let truth = upright
            .replace("youngs_modulus_pa = 200e9", &format!("youngs_modulus_pa = {}", 200e9 * stiffness_ratio))
            .replace("hole_radius_m = 0.015 ", &format!("hole_radius_m = {} ", 0.015 * offset_ratio));
        let (text, samples) = calibrated(&upright, &truth, &options(Experiment::Mixed, 51));
        let discovery = found(&text, &samples);
        let effects = &discovery.result.cables[0].effects;
        assert_eq!(told(&discovery), ("extended", vec!["backbone_stiffness", "tendon_offset"]));
        let ratio = effects[0].parameters.get("stiffness_ratio").unwrap();
        let offset_m = effects[1].parameters.get("hole_radius_m").unwrap();
        assert!((ratio / stiffness_ratio - 1.0).abs() < 0.02, "{ratio}");
        assert!((offset_m / (0.015 * offset_ratio) - 1.0).abs() < 0.02, "{offset_m}");
    }
}

/// A soft segment turns the tendon more at both its ends, as rough holes there would hold it. Gratings alone cannot tell; markers can.
#[test]
fn without_markers_a_soft_segment_and_rough_holes_are_both_told() {
    for (experiment, segment) in [(Experiment::OneWay, 4), (Experiment::Mixed, 2), (Experiment::Mixed, 8)] {
        let mut ratio = [1.0; 8];
        ratio[segment - 1] = 0.5;
        let truth = PROTOTYPE.replace(
            "youngs_modulus_pa = 200e9",
            &format!("youngs_modulus_pa = 200e9\nsegment_stiffness_ratio = {ratio:?}"),
        );
        let (text, mut samples) = measured_of(&truth, &options(experiment, 52));
        for sample in &mut samples {
            sample.marker_m.clear();
        }
        let discovery = found(&text, &samples);
        assert_eq!(told(&discovery).0, "extended");
        let named = named(&discovery);
        assert!(!named.is_empty());
        for names in named {
            assert!(names.contains(&"backbone_stiffness") && names.contains(&"hole_friction"), "{segment} {names:?}");
        }
    }
}

/// No segment has more friction at one end alone.
#[test]
fn without_markers_a_rough_hole_between_others_is_a_hole() {
    let mut mu = [0.1753; 8];
    mu[3] = 0.35;
    for experiment in [Experiment::OneWay, Experiment::Mixed] {
        let (text, mut samples) = measured(experiment, 53, &mu);
        for sample in &mut samples {
            sample.marker_m.clear();
        }
        let discovery = found(&text, &samples);
        assert_eq!(named(&discovery), [["hole_friction"]], "{experiment:?}");
        assert_eq!(discovery.result.cables[0].effects[0].parameters.get("hole"), Some(4.0));
    }
}
