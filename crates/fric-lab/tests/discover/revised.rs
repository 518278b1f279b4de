//! Values of the robot file's effects that a log has otherwise.

use std::f64::consts::TAU;

use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_lab::discover::readiness::by_forces;
use fric_lab::discover::result::DiscoverResult;
use fric_lab::discover::{DiscoverOptions, Verdict, discover};
use fric_lab::fit::readiness::Holdings;
use fric_lab::fit::{Measurements, Progress, Reference};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const LOAD_N: f64 = 70.0;
const MU: f64 = 0.03;
const NOISE_N: f64 = 0.5;
const GAIN: f64 = 1.25;

/// Discovers on a log of a load that varies, moved there and back, with this gain in the file.
fn look(given_gain: f64) -> DiscoverResult {
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"axis\"\ncycle_s = 0.01\n[[cable]]\nname = \"a\"\npulleys = [{{ wrap_deg = 180.0 }}]\n\
         friction = {{ mu = 0.02, sigma_n_per_m = 1e8, viscous_n_s_per_m = 0.0 }}\n\
         effects = [{{ kind = \"sensor_gain\", gain = {given_gain} }}]\n"
    );
    let robot = RobotFile::parse(&text, "axis").unwrap();
    let params = robot.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    measurements.start_log();
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut noise_n = move || {
        let deviate: f64 = StandardNormal.sample(&mut random);
        NOISE_N * deviate
    };
    let mut length_m = 1.0;
    for cycle in 0_i32..6000 {
        let speed_m_per_s = if cycle % 400 < 200 { 0.2 } else { -0.2 };
        length_m += 0.01 * speed_m_per_s;
        let ratio = MU * f64::signum(speed_m_per_s);
        // Over half a turn the bearing carries the sum of both forces; paying out, friction holds the cable back.
        let load_n = LOAD_N + 20.0 * (TAU * f64::from(cycle) / 1900.0).sin();
        let held_n = load_n * (1.0 - ratio) / (1.0 + ratio);
        measurements.add(&Sample {
            stamp_nanos: i64::from(cycle) * 10_000_000,
            cables: &[CableInput { sensor_force_n: GAIN * held_n + noise_n(), length_m, speed_m_per_s }],
            reference_force_n: &[load_n + noise_n()],
            pose: None,
            outside_wrench: None,
        });
    }
    let found = discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap();
    let readiness = by_forces(&robot, &Holdings::new(1));
    DiscoverResult::new(&robot, &[("log".to_owned(), 0.0)], &readiness, &found)
}

/// What the file has wrong is fitted before anything is sought, so that it is no part of the gap, and the change is told.
#[test]
fn a_revised_gain_is_told() {
    for given_gain in [0.8, GAIN] {
        let result = look(given_gain);
        let (cable, case) = (&result.cables[0], format!("{given_gain}: {}", result.summary()));
        assert!(cable.effects.is_empty() && cable.verdict == Verdict::Complete, "{case}");
        // The noise of the reference, and that of the sensor by its gain.
        let noise_n = NOISE_N * (1.0 + GAIN.powi(-2)).sqrt();
        for error in [cable.before.unwrap(), cable.after.unwrap()] {
            assert!((error.rms_n / noise_n - 1.0).abs() < 0.05, "{} N, {case}", error.rms_n);
        }
        let value = cable.parameters.get("sensor_gain.gain").unwrap();
        assert!((value / GAIN - 1.0).abs() < 0.01, "{value}, {case}");
        let is_told = |words: &str| result.summary().split_whitespace().collect::<Vec<_>>().join(" ").contains(words);
        let revised: Vec<(&str, f64)> =
            cable.revised.iter().map(|revised| (revised.parameter.as_str(), revised.given)).collect();
        let is_revised = given_gain < GAIN;
        assert_eq!(revised, if is_revised { vec![("sensor_gain.gain", given_gain)] } else { Vec::new() }, "{case}");
        assert_eq!(is_told("sensor_gain.gain of the file is 0.8; the log has 1.2"), is_revised, "{case}");
    }
}
