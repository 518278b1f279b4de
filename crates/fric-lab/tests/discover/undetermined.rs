//! Values that a log contradicts without determining others.

use std::f64::consts::TAU;

use fric_core::robot::file::RobotFile;
use fric_core::{AnyCompensator, CableInput, Sample};
use fric_lab::discover::readiness::by_forces;
use fric_lab::discover::result::DiscoverResult;
use fric_lab::discover::{CableDiscovery, DiscoverOptions, discover, extended};
use fric_lab::fit::readiness::Holdings;
use fric_lab::fit::{Measurements, Progress, Reference};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const MU: f64 = 0.01;
const NOISE_N: f64 = 0.2;
const COUNT: usize = 8000;

fn load_n(cycle: usize) -> f64 {
    500.0 + 5.0 * (TAU * 4e-3 * f64::from(u32::try_from(cycle).unwrap()) / 7.0).sin()
}

/// A cable with Coulomb friction without presliding, on a pulley that it wraps by half a turn: in motion the winch holds `(1 ∓ μ)/(1 ± μ)` of the load
/// (\[P\] 10).
fn log() -> Vec<CableInput> {
    let mut random = ChaCha8Rng::seed_from_u64(31);
    let at = |cycle: usize| {
        let time_s = 4e-3 * f64::from(u32::try_from(cycle).unwrap());
        (1.0 + 0.3 * (TAU * time_s / 4.0).sin(), 0.3 * TAU / 4.0 * (TAU * time_s / 4.0).cos())
    };
    let mut input = |cycle| {
        let (length_m, speed_m_per_s) = at(cycle);
        let noise: f64 = StandardNormal.sample(&mut random);
        let friction = MU * f64::signum(speed_m_per_s);
        let held_n = load_n(cycle) * (1.0 - friction) / (1.0 + friction);
        CableInput { sensor_force_n: held_n + NOISE_N * noise, length_m, speed_m_per_s }
    };
    (0..COUNT).map(&mut input).collect()
}

fn robot(sigma_n_per_m: f64) -> String {
    format!(
        "format = \"fric-robot/1\"\nname = \"axis\"\ncycle_s = 0.004\n[[cable]]\nname = \"a\"\npulleys = [{{ wrap_deg = 180.0 }}]\n\
         friction = {{ mu = 0.008, sigma_n_per_m = {sigma_n_per_m}, viscous_n_s_per_m = 1.0 }}\n"
    )
}

fn samples(log: &[CableInput], mut each: impl FnMut(&Sample<'_>)) {
    for ((cycle, stamp_nanos), cable) in (0..).step_by(4_000_000).enumerate().zip(log) {
        each(&Sample {
            stamp_nanos,
            cables: std::slice::from_ref(cable),
            reference_force_n: &[load_n(cycle)],
            pose: None,
            outside_wrench: None,
        });
    }
}

/// The error of a robot file on the held-out samples by the cycle itself, N.
fn replayed_n(text: &str, log: &[CableInput], found: &CableDiscovery) -> f64 {
    let mut compensator = AnyCompensator::new(&RobotFile::parse(text, "written").unwrap().params()).unwrap();
    let mut residual_n = Vec::new();
    samples(log, |sample| {
        compensator.set_input(sample.cables, None, 1.0);
        compensator.step();
        residual_n.push(compensator.outputs()[0].force_at_platform_n - sample.reference_force_n[0]);
    });
    let held_out: Vec<f64> = found.held_out.iter().flat_map(|[from, to]| residual_n[*from..*to].to_vec()).collect();
    let count = f64::from(u32::try_from(held_out.len()).unwrap());
    (held_out.iter().map(|number| number * number).sum::<f64>() / count).sqrt()
}

/// In a log of long strokes every stiffness above some value agrees, and those below do not. Whichever is given, the file is the model that was judged.
#[test]
fn the_file_is_the_model_that_was_judged() {
    let log = log();
    for (sigma_n_per_m, is_contradicted) in [(3e3, true), (1e4, true), (1e8, false)] {
        let text = robot(sigma_n_per_m);
        let robot = RobotFile::parse(&text, "given").unwrap();
        let mut measurements = Measurements::new(&robot.params(), Reference::Forces);
        measurements.start_log();
        samples(&log, |sample| measurements.add(sample));
        let options = DiscoverOptions { empirical: false, ..DiscoverOptions::default() };
        let measurements = measurements.into();
        let found = discover(&measurements, &options, &Progress::new()).unwrap();
        assert!(found[0].lack.is_none(), "{:?}", found[0].lack);
        let judged_n = found[0].after.held_out_n.rms().unwrap();
        let written = extended(&text, "given", &found).unwrap();
        let replayed_n = replayed_n(&written, &log, &found[0]);
        assert!((replayed_n / judged_n - 1.0).abs() < 1e-9, "{sigma_n_per_m}: {judged_n} N, {replayed_n} N\n{written}");
        // Nothing is left but the noise of the sensor.
        assert!(judged_n < 1.1 * NOISE_N, "{sigma_n_per_m}: {judged_n} N");

        let readiness = by_forces(&robot, &Holdings::new(1));
        let result = DiscoverResult::new(&robot, &[("log".to_owned(), 0.0)], &readiness, &found);
        let cable = &result.cables[0];
        let expected: &[&str] = if is_contradicted { &["sigma_n_per_m"] } else { &[] };
        assert_eq!(cable.undetermined, expected, "{sigma_n_per_m}");
        assert!(cable.standard_errors.get("sigma_n_per_m").is_none());
        assert_eq!(cable.undetermined_in_words().is_some(), is_contradicted);
    }
}
