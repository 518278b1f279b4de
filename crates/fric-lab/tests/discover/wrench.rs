//! Discovery with no sensor on the platform: what is hidden on one cable, or in the description of the robot.
//!
//! At a quarter of the usual rate, for the time it takes: the presliding of a cycle is coarser there than the white noise of six equations, so that
//! names and values are looked at, and the verdict where nothing moves fast.

use fric_core::Wrench;
use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_lab::discover::{Geometry, Verdict, WrenchDiscovery, discover_wrench};
use fric_lab::fit::{Progress, Reference};
use fric_lab::recording_fault::Fault;
use fric_lab::simulate::SimulationOptions;

use crate::fit::logs::Log;

const EXAMPLE: &str = include_str!("../../../../examples/mini-ipanema.toml");

/// The robot of the example at 250 Hz, with its text changed.
fn robot(change: impl FnOnce(String) -> String) -> RobotFile {
    RobotFile::parse(&change(EXAMPLE.replace("cycle_s = 0.001", "cycle_s = 0.004")), "example").unwrap()
}

fn record(truth: &RobotFile, seed: u64, duration_s: f64) -> Log {
    Log::record(truth, &SimulationOptions { duration_s: Some(duration_s), seed, ..SimulationOptions::default() })
}

/// What is found on a log of the one robot with the file of the other.
fn look(truth: &RobotFile, given: &RobotFile, seed: u64, by_mass: bool) -> WrenchDiscovery {
    let mut log = record(truth, seed, 16.0);
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

/// Load cells that are all wrong, by the weight alone. The friction of the given model makes up for that, and no single sensor explains much.
#[test]
fn a_gain_of_each_sensor_is_found_by_the_weight() {
    const GAINS: [f64; 8] = [1.10, 0.93, 1.12, 1.06, 0.91, 1.14, 1.08, 0.95];
    let mut gains = GAINS.iter();
    let with_gain = |text: String| {
        let mut parts = text.split("\nfriction =");
        let first = parts.next().unwrap_or_default().to_owned();
        parts.zip(gains.by_ref()).fold(first, |text, (part, gain)| {
            format!("{text}\neffects = [{{ kind = \"sensor_gain\", gain = {gain} }}]\nfriction ={part}")
        })
    };
    let truth = robot(with_gain);
    let found = look(&truth, &robot(|text| text), 5, true);
    assert!(found.geometry.is_empty(), "{:?}", found.geometry);
    assert_eq!(names(&found), vec![vec![Effect::SensorGain]; GAINS.len()]);
    assert_eq!(found.verdict, Verdict::Extended);
    // The tensions hardly vary, so that their common factor is the least certain.
    for (cable, gain) in found.cables.iter().zip(GAINS) {
        let of = cable.after.values[Effect::SensorGain.places().start];
        assert!((of / gain - 1.0).abs() < 0.01, "{of} {gain}");
    }
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

/// The gains of all sensors together would explain both.
#[test]
#[ignore = "minutes; `make soak` runs it"]
fn a_wrong_mass_is_told_beside_a_wrong_gain() {
    let truth = robot(|text| {
        text.replacen("\nfriction =", "\neffects = [{ kind = \"sensor_gain\", gain = 1.06 }]\nfriction =", 1)
    });
    let heavy = robot(|text| text.replace("mass_kg = 0.41", "mass_kg = 0.45"));
    let found = look(&truth, &heavy, 9, true);
    assert_eq!(found.geometry.iter().map(|of| of.geometry).collect::<Vec<_>>(), [Geometry::Mass]);
    let mut expected = vec![Vec::new(); names(&found).len()];
    expected[0] = vec![Effect::SensorGain];
    assert_eq!((names(&found), found.verdict), (expected, Verdict::Extended));
    assert!((found.geometry[0].numbers[0] - 0.41).abs() < 0.002, "{:?}", found.geometry);
}

/// A sine of 0.2 N and 50 Hz, cycle by cycle at 250 Hz.
fn sine_n() -> impl Iterator<Item = f64> {
    (0..).map(|cycle| 0.2 * (core::f64::consts::TAU * 50.0 * f64::from(cycle) * 0.004 + 0.3).sin())
}

#[test]
fn hum_of_a_sensor_is_a_fault_of_the_recording() {
    let truth = robot(|text| text);
    // Longer than a stretch of the spectrum.
    let mut log = record(&truth, 9, 18.0);
    let search = |log: &Log| discover_wrench(&log.measured(&truth, Reference::Wrench), &Progress::new()).unwrap();
    let clean = search(&log);
    for (cycle, hum_n) in log.0.iter_mut().zip(sine_n()) {
        cycle.cables[2].sensor_force_n += hum_n;
    }
    let found = search(&log);
    assert!(found.geometry.is_empty() && names(&found).iter().all(Vec::is_empty), "{:?}", names(&found));
    // Nothing of it is left.
    assert_eq!(found.verdict, clean.verdict);
    for (with, without) in found.after.components.iter().zip(&clean.after.components) {
        assert!((with / without - 1.0).abs() < 0.02, "{with} {without}");
    }
    for (cable, of) in found.cables.iter().enumerate() {
        let faults: Vec<_> = of.faults.iter().map(|fault| (fault.fault, fault.parameters.clone())).collect();
        if cable != 2 {
            assert_eq!(faults, [], "cable {}", cable + 1);
            continue;
        }
        let [(Fault::Hum, parameters)] = faults.as_slice() else { panic!("{faults:?}") };
        let [(_, frequency_hz), (_, amplitude_n)] = parameters[..] else { panic!("{parameters:?}") };
        // The noise leaves the amplitude to √(2/N) of it: 0.0004 N.
        assert!((frequency_hz - 50.0).abs() < 0.01 && (amplitude_n - 0.2).abs() < 0.002, "{parameters:?}");
    }
}

/// A cable that trembles pulls at the platform, which the wrench tells.
#[test]
fn a_trembling_cable_is_no_hum() {
    let truth = robot(|text| text);
    // Longer than a stretch of the spectrum.
    let mut log = record(&truth, 9, 18.0);
    for (cycle, force_n) in log.0.iter_mut().zip(sine_n()) {
        cycle.cables[2].sensor_force_n += force_n;
        let column = truth.params().cables()[2].structure_column(&cycle.pose.unwrap()).unwrap();
        // A sensor at 180° feels its cable twice.
        let wrench = cycle.outside_wrench.unwrap().to_vector() - column * (0.5 * force_n);
        cycle.outside_wrench = Some(Wrench {
            force_n: wrench.fixed_rows::<3>(0).into_owned(),
            torque_nm: wrench.fixed_rows::<3>(3).into_owned(),
        });
    }
    let found = discover_wrench(&log.measured(&truth, Reference::Wrench), &Progress::new()).unwrap();
    assert!(found.cables.iter().all(|cable| cable.faults.is_empty()));
}

/// A zero that jumps has no name, and neither a drift nor a wrong zero stands in for it.
#[test]
#[ignore = "minutes; `make soak` runs it"]
fn a_zero_that_jumps_is_not_named() {
    let truth = robot(|text| text);
    let mut log = record(&truth, 23, 16.0);
    for cycle in log.0.iter_mut().skip(2500) {
        cycle.cables[2].sensor_force_n += 0.3;
    }
    let found = discover_wrench(&log.measured(&truth, Reference::Wrench), &Progress::new()).unwrap();
    assert!(found.geometry.is_empty() && names(&found).iter().all(Vec::is_empty), "{:?}", names(&found));
    assert_eq!((found.verdict, found.cables[2].verdict), (Verdict::Unexplained, Verdict::Unexplained));
}

/// Returns what is found where a force from outside is not in the log. It is given in each cycle, N, by its time, s, and the platform's position, m.
fn look_under(force_n: impl Fn(f64, [f64; 3]) -> [f64; 3], seed: u64) -> WrenchDiscovery {
    const CYCLE_S: f64 = 0.004;
    let truth = robot(|text| text);
    let mut log = record(&truth, seed, 10.0);
    let mut time_s = 0.0;
    for cycle in &mut log.0 {
        let mut wrench = cycle.outside_wrench.unwrap();
        let force_n = force_n(time_s, cycle.pose.unwrap().position_m.into());
        wrench.force_n.iter_mut().zip(force_n).for_each(|(known_n, force_n)| *known_n -= force_n);
        cycle.outside_wrench = Some(wrench);
        time_s += CYCLE_S;
    }
    discover_wrench(&log.measured(&truth, Reference::Wrench), &Progress::new()).unwrap()
}

/// A force that comes and goes looks like noise to the whitening.
#[test]
#[ignore = "minutes; `make soak` runs it"]
fn a_gust_that_the_log_lacks_is_no_noise() {
    let gusts = |time_s: f64, _: [f64; 3]| {
        let blows = (3.0..5.0).contains(&time_s) || (7.0..8.5).contains(&time_s);
        if blows { [1.5, 0.5, -0.3] } else { [0.0; 3] }
    };
    let found = look_under(gusts, 21);
    assert!(found.geometry.is_empty() && names(&found).iter().all(Vec::is_empty), "{:?}", names(&found));
    assert_eq!(found.verdict, Verdict::Unexplained);
}

/// A force that goes with the position looks like a wrong point of a cable, which the lengths contradict.
#[test]
#[ignore = "minutes; `make soak` runs it"]
fn a_hose_that_the_log_lacks_is_no_wrong_point() {
    let found = look_under(|_, [x_m, y_m, z_m]| [-8.0 * x_m, -8.0 * y_m, -2.0 - 8.0 * z_m], 22);
    assert!(found.geometry.iter().all(|of| of.geometry.cable().is_none()), "{:?}", found.geometry);
    assert_eq!(found.verdict, Verdict::Unexplained);
}
