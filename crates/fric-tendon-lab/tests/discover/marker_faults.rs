//! Faults of the recording of markers are told, and what the machine has beside them is still found.

use fric_tendon_lab::RunSample;
use fric_tendon_lab::discover::{TendonDiscovery, rest_in_words};
use fric_tendon_lab::simulate::{Experiment, TendonSimulationOptions};

use super::{PROTOTYPE, found, measured, measured_of, told_but_holes};

/// Names of the faults with their numbers, and the report in words.
fn faults(discovery: &TendonDiscovery) -> (Vec<(&'static str, Vec<f64>)>, String) {
    let rest = discovery.result.cables[0].unexplained.as_ref().unwrap();
    let numbers = |numbers: &fric_lab::numbers::Numbers| numbers.0.iter().map(|(_, value)| *value).collect();
    (rest.goes_with.iter().map(|one| (one.with, numbers(&one.parameters))).collect(), rest_in_words(rest))
}

fn exchanged(samples: &mut [RunSample], [one, other]: [usize; 2]) {
    for sample in samples.iter_mut() {
        sample.marker_m.swap(one, other);
    }
}

/// Moves all markers some samples behind.
fn late(samples: &mut [RunSample], count: usize) {
    let shown: Vec<_> = samples.iter().map(|sample| sample.marker_m.clone()).collect();
    for (place, sample) in samples.iter_mut().enumerate() {
        sample.marker_m.clone_from(&shown[place.saturating_sub(count)]);
    }
}

/// A marker of the first disk, which hardly moves, and all of them together.
#[test]
fn markers_that_stand_still_are_told() {
    for markers in [0..1, 4..5, 0..8] {
        let (text, mut samples) = measured(Experiment::Mixed, 41, &[0.1753]);
        let [from_s, to_s] = [samples[60].time_s, samples[90].time_s];
        let shown = samples[60].marker_m.clone();
        for sample in &mut samples[61..=90] {
            sample.marker_m[markers.clone()].copy_from_slice(&shown[markers.clone()]);
        }
        let discovery = found(&text, &samples);
        assert_eq!(told_but_holes(&discovery), ("unexplained", Vec::new()), "{markers:?}");
        let numbers = markers.clone().map(|marker| f64::from(u32::try_from(marker + 1).unwrap())).chain([from_s, to_s]);
        assert_eq!(faults(&discovery).0, [("frozen", numbers.collect())]);
    }
}

#[test]
fn markers_that_are_exchanged_are_told() {
    for (pair, from) in [([2, 3], 0), ([6, 7], 0), ([0, 1], 0), ([1, 5], 100)] {
        let (text, mut samples) = measured(Experiment::Mixed, 42, &[0.1753]);
        exchanged(&mut samples[from..], pair);
        let discovery = found(&text, &samples);
        assert_eq!(told_but_holes(&discovery), ("unexplained", Vec::new()), "{pair:?}");
        let (found, words) = faults(&discovery);
        let [one, other] = pair.map(|marker| marker + 1);
        assert_eq!((found[0].0, found[0].1[2]), ("exchanged", samples[from].time_s), "{found:?}");
        assert!(words.contains(&format!("Markers {one} and {other} are exchanged")), "{words}");
    }
}

/// Late markers, of the right file and beside a backbone 10 % too soft.
#[test]
fn late_markers_are_told_and_what_is_wrong_beside_them() {
    for (experiment, count) in [(Experiment::OneWay, 1), (Experiment::OneWay, 4), (Experiment::Mixed, 3)] {
        let (text, mut samples) = measured(experiment, 43, &[0.1753]);
        let delay_s = samples[count].time_s - samples[0].time_s;
        late(&mut samples, count);
        let discovery = found(&text, &samples);
        assert_eq!(told_but_holes(&discovery), ("unexplained", Vec::new()), "{experiment:?} {count}");
        let (found, words) = faults(&discovery);
        // The first place, which is held that long, may be reported as frozen too.
        let delay = found.iter().find(|(with, _)| *with == "reference_delay").unwrap();
        assert!((delay.1[0] / delay_s - 1.0).abs() < 0.1, "{experiment:?} {count}: {words}");
    }
    let soft = PROTOTYPE.replace("youngs_modulus_pa = 200e9", "youngs_modulus_pa = 180e9");
    let options =
        TendonSimulationOptions { experiment: Experiment::Mixed, seed: 44, ..TendonSimulationOptions::default() };
    let (text, mut samples) = measured_of(&soft, &options);
    late(&mut samples, 3);
    let discovery = found(&text, &samples);
    assert_eq!(told_but_holes(&discovery), ("unexplained", vec!["backbone_stiffness"]));
    assert!((faults(&discovery).0.last().unwrap().1[0] / 0.3 - 1.0).abs() < 0.1);
    let ratio = discovery.result.cables[0].effects[0].parameters.get("stiffness_ratio").unwrap();
    assert!((ratio / 0.9 - 1.0).abs() < 0.01, "{ratio}");
}

/// A tracker that shows half millimetres repeats places without being frozen.
#[test]
fn coarse_markers_are_not_frozen() {
    let (text, mut samples) = measured(Experiment::Mixed, 45, &[0.1753]);
    for coordinate_m in samples.iter_mut().flat_map(|sample| &mut sample.marker_m).flatten() {
        *coordinate_m = (*coordinate_m * 2e3).round() / 2e3;
    }
    assert_ne!(told_but_holes(&found(&text, &samples)).0, "unexplained");
}
