//! Discovery with no sensor on the platform: what is hidden on one cable, on all, or in the description of the robot.

use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_lab::discover::{Geometry, Verdict, WrenchDiscovery, discover_wrench};
use fric_lab::fit::{Progress, Reference};
use fric_lab::simulate::SimulationOptions;

use crate::fit::logs::Log;

const EXAMPLE: &str = include_str!("../../../../examples/mini-ipanema.toml");

/// The robot of the example at 250 Hz, with its text changed.
fn robot(change: impl Fn(String) -> String) -> RobotFile {
    RobotFile::parse(&change(EXAMPLE.replace("cycle_s = 0.001", "cycle_s = 0.004")), "example").unwrap()
}

/// Adds an effect to the cables of these places.
fn with_effect(text: &str, cables: &[usize], effect: &str) -> String {
    let mut count = 0;
    let lines = text.lines().map(|line| {
        if !line.starts_with("friction =") {
            return line.to_owned();
        }
        count += 1;
        if cables.contains(&(count - 1)) { format!("{line}\neffects = [{effect}]") } else { line.to_owned() }
    });
    lines.collect::<Vec<String>>().join("\n")
}

/// What is found on a log of the one robot with the file of the other.
fn look(truth: &RobotFile, given: &RobotFile, seed: u64, by_mass: bool) -> WrenchDiscovery {
    let options = SimulationOptions { duration_s: Some(30.0), seed, ..SimulationOptions::default() };
    let mut log = Log::record(truth, &options);
    if by_mass {
        log.0.iter_mut().for_each(|cycle| cycle.outside_wrench = None);
    }
    let found = discover_wrench(&log.measured(given, Reference::Wrench), &Progress::new()).unwrap();
    println!("{:?}, {:?} → {:?}, {:?}", found.verdict, found.before, found.after, names(&found));
    found
}

/// Names by cable.
fn names(found: &WrenchDiscovery) -> Vec<Vec<Effect>> {
    found.cables.iter().map(|cable| cable.findings.iter().map(|finding| finding.effect).collect()).collect()
}

#[test]
fn nothing_is_named_where_nothing_is_missing() {
    let truth = robot(|text| text);
    for by_mass in [false, true] {
        let found = look(&truth, &truth, 3, by_mass);
        assert!(found.geometry.is_empty() && names(&found).iter().all(Vec::is_empty), "{by_mass}");
        assert_eq!(found.verdict, Verdict::Complete, "{by_mass}");
    }
}

#[test]
fn a_gain_is_found_on_the_cable_that_has_it() {
    let truth = robot(|text| with_effect(&text, &[4], r#"{ kind = "sensor_gain", gain = 1.04 }"#));
    let found = look(&truth, &robot(|text| text), 4, false);
    let mut expected = vec![Vec::new(); names(&found).len()];
    expected[4] = vec![Effect::SensorGain];
    assert_eq!(names(&found), expected);
    assert_eq!(found.verdict, Verdict::Extended);
    let gain = found.cables[4].after.values[Effect::SensorGain.places().start];
    assert!((gain - 1.04).abs() < 0.002, "{gain}");
}

#[test]
fn what_all_cables_have_alike_is_one_number() {
    let effect = r#"{ kind = "bearing_drag", drag_n = 0.06 }"#;
    let truth = robot(|text| with_effect(&text, &[0, 1, 2, 3, 4, 5, 6, 7], effect));
    let found = look(&truth, &robot(|text| text), 5, false);
    assert_eq!(found.alike, [Effect::BearingDrag]);
    assert_eq!(found.verdict, Verdict::Extended);
    let drag_n = found.cables[0].after.values[Effect::BearingDrag.places().start];
    assert!((drag_n - 0.06).abs() < 0.003, "{drag_n}");
}

/// A cable that enters its pulley 15 mm beside where the file says, and a payload that the file has not got.
#[test]
fn what_the_file_has_wrong_is_no_friction() {
    let truth = robot(|text| text);
    let moved = robot(|text| text.replacen("base_m = [0.55, 0.4, 0.5]", "base_m = [0.55, 0.415, 0.5]", 1));
    let found = look(&truth, &moved, 6, false);
    assert_eq!(found.geometry.iter().map(|of| of.geometry).collect::<Vec<_>>(), [Geometry::Base(0)]);
    assert!(names(&found).iter().all(Vec::is_empty));
    assert!((found.geometry[0].numbers[1] - 0.4).abs() < 0.002, "{:?}", found.geometry);

    let heavy = robot(|text| text.replace("mass_kg = 0.41", "mass_kg = 0.45"));
    let found = look(&truth, &heavy, 7, true);
    assert_eq!(found.geometry.iter().map(|of| of.geometry).collect::<Vec<_>>(), [Geometry::Mass]);
    assert!(names(&found).iter().all(Vec::is_empty));
    assert!((found.geometry[0].numbers[0] - 0.41).abs() < 0.002, "{:?}", found.geometry);
}
