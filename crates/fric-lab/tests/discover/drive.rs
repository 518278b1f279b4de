//! A drive under a pretension that is known and not measured: its force by equations of its own.

use std::f64::consts::TAU;

use fric_core::effects::Effect;
use fric_core::effects::pulley_inertia::MASS;
use fric_core::parameters;
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_lab::discover::{CableDiscovery, DiscoverOptions, discover};
use fric_lab::fit::{Measurements, Progress, Reference};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const PRETENSION_N: f64 = 1000.0;
const MASS_KG: f64 = 95.0;
const MU: f64 = 0.01;
const NOISE_N: f64 = 1.0;

/// Discovers with the reference of one load.
fn look() -> CableDiscovery {
    let text = "format = \"fric-robot/1\"\nname = \"drive\"\ncycle_s = 0.001\n[platform]\nmass_kg = 1.0\n\
                 [log]\nreference = { constant_n = 1000.0 }\n[[cable]]\nname = \"drive\"\npulleys = [{ wrap_deg = 180.0 }]\n\
                 friction = { mu = 0.01, viscous_n_s_per_m = 100.0 }\n";
    let robot = RobotFile::parse(text, "drive").unwrap();
    let params = robot.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    measurements.start_log();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut last_m = 1.0;
    for cycle in 0..12_000_i32 {
        let time_s = 1e-3 * f64::from(cycle);
        // Three sines, the slowest of which turns round half a dozen times.
        let parts = [(0.3, 0.08), (0.9, 0.02), (2.3, 0.004)];
        let of = |shape: &dyn Fn(f64, f64) -> f64| -> f64 {
            parts.iter().map(|(hz, size_m)| size_m * shape(TAU * hz, TAU * hz * time_s)).sum()
        };
        let length_m = 1.0 - of(&|_, angle| angle.sin());
        // Dry friction is against the way of the cycle.
        let before_m = std::mem::replace(&mut last_m, length_m);
        let (reeling_in, accelerating) =
            (of(&|rate, angle| rate * angle.cos()), of(&|rate, angle| -rate * rate * angle.sin()));
        let viscous = if reeling_in > 0.0 { 240.0 } else { 167.0 };
        let moving_n = PRETENSION_N + MASS_KG * accelerating;
        // The cable presses on the pulley on both sides, before the inertia and behind it.
        let dry_n = MU * (moving_n + PRETENSION_N) * (before_m - length_m).signum();
        let force_n = moving_n + viscous * reeling_in + dry_n;
        let noise: f64 = StandardNormal.sample(&mut random);
        let cable = CableInput { sensor_force_n: force_n + NOISE_N * noise, length_m, speed_m_per_s: -reeling_in };
        measurements.add(&Sample {
            stamp_nanos: i64::from(cycle) * 1_000_000,
            cables: &[cable],
            reference_force_n: &[PRETENSION_N],
            pose: None,
            outside_wrench: None,
        });
    }
    discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0)
}

/// A curve of the sensor that shows the one load whatever the force, or a table over the load that does, agrees best with such a reference.
#[test]
fn one_load_tells_inertia_and_no_curve_of_the_sensor() {
    let found = look();
    let names: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
    assert_eq!(names, [Effect::PulleyInertia, Effect::DirectionAsymmetry]);
    // A gain of nearly nothing shows the one load too, whatever the force, and less noise than there is; it is no rival of a name.
    let rivals: Vec<Effect> =
        found.findings.iter().filter_map(|finding| Some(finding.runner_up.as_ref()?.effect)).collect();
    assert!(!rivals.contains(&Effect::SensorGain), "{rivals:?}");
    let mass_kg = found.after.values[MASS];
    assert!((mass_kg / MASS_KG - 1.0).abs() < 0.01, "{mass_kg} kg");
    let mu = found.after.values[parameters::MU];
    assert!((mu / MU - 1.0).abs() < 0.02, "{mu}");
    let rms_n = found.after.held_out_n.rms().unwrap();
    assert!(rms_n < 1.05 * NOISE_N, "{rms_n} N");
}
