//! Discovery with no sensor on the platform: what is hidden on one cable, or in the description of the robot.
//!
//! At a quarter of the usual rate, for the time it takes: the presliding of a cycle is coarser there than the white noise of six equations, so that
//! names and values are looked at, and the verdict where nothing moves fast.

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

/// What is found on a log of the one robot with the file of the other.
fn look(truth: &RobotFile, given: &RobotFile, seed: u64, by_mass: bool) -> WrenchDiscovery {
    let options = SimulationOptions { duration_s: Some(16.0), seed, ..SimulationOptions::default() };
    let mut log = Log::record(truth, &options);
    if by_mass {
        log.0.iter_mut().for_each(|cycle| cycle.outside_wrench = None);
    }
    discover_wrench(&log.measured(given, Reference::Wrench), &Progress::new()).unwrap()
}

/// Names by cable.
fn names(found: &WrenchDiscovery) -> Vec<Vec<Effect>> {
    found.cables.iter().map(|cable| cable.findings.iter().map(|finding| finding.effect).collect()).collect()
}

#[test]
fn nothing_is_named_where_nothing_is_missing() {
    let truth = robot(|text| text);
    let found = look(&truth, &truth, 3, true);
    assert!(
        found.geometry.is_empty() && names(&found).iter().all(Vec::is_empty),
        "{:?} {:?}",
        found.geometry,
        names(&found)
    );
    assert_eq!(found.verdict, Verdict::Complete);
}

#[test]
fn a_gain_is_found_on_the_cable_that_has_it() {
    // The first of its friction lines.
    let truth = robot(|text| {
        text.replacen("\nfriction =", "\neffects = [{ kind = \"sensor_gain\", gain = 1.04 }]\nfriction =", 1)
    });
    let found = look(&truth, &robot(|text| text), 4, false);
    let mut expected = vec![Vec::new(); names(&found).len()];
    expected[0] = vec![Effect::SensorGain];
    assert_eq!(names(&found), expected);
    let gain = found.cables[0].after.values[Effect::SensorGain.places().start];
    assert!((gain - 1.04).abs() < 0.002, "{gain}");
}

/// A payload that the file has not got, by the weight alone.
#[test]
fn a_wrong_mass_is_no_friction() {
    let heavy = robot(|text| text.replace("mass_kg = 0.41", "mass_kg = 0.45"));
    let found = look(&robot(|text| text), &heavy, 7, true);
    assert_eq!(found.geometry.iter().map(|of| of.geometry).collect::<Vec<_>>(), [Geometry::Mass]);
    assert!(names(&found).iter().all(Vec::is_empty));
    assert!((found.geometry[0].numbers[0] - 0.41).abs() < 0.002, "{:?}", found.geometry);
}
