//! Contacts that yield one after the other (Maxwell slip), with equations of their own.

use std::f64::consts::TAU;

use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_lab::discover::{DiscoverOptions, Verdict, discover};
use fric_lab::fit::{Measurements, Progress, Reference};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const MU: f64 = 0.03;
const NOISE_N: f64 = 0.05;
/// Displacement at which each contact slides, m, and its share of the friction.
const CONTACTS: [(f64, f64); 5] = [(5e-5, 0.25), (1.5e-4, 0.25), (3e-4, 0.2), (6e-4, 0.15), (1.2e-3, 0.15)];

/// No effect of the catalogue has such contacts. A late motion, a seized pulley, or another law of presliding would explain much of them, and the rest
/// goes on at rest as a wander does.
#[test]
fn contacts_in_parallel_get_no_name() {
    let text = "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = 0.001\n[[cable]]\nname = \"w\"\n\
                pulleys = [{ wrap_deg = 180.0 }, { wrap_deg = 90.0 }]\n\
                friction = { mu = 0.025, sigma_n_per_m = 1.0e4, viscous_n_s_per_m = 1.0, offset_n = 0.0 }\n";
    let robot = RobotFile::parse(text, "bench").unwrap();
    let mut measurements = Measurements::new(&robot.params(), Reference::Forces);
    measurements.start_log();
    let mut random = ChaCha8Rng::seed_from_u64(12);
    let mut deflections = [[0.0_f64; CONTACTS.len()]; 2];
    let mut last_m = 1.0;
    for cycle in 0..30_000_i32 {
        let time_s = 1e-3 * f64::from(cycle);
        // Strokes that shrink and grow, with rests between them.
        let (stroke, part) = ((time_s / 1.5).floor(), (time_s / 1.5).fract());
        let size_m = 0.1 * (0.5 * TAU * stroke * 0.618).sin().powi(3);
        let moved = (part / 0.7).min(1.0);
        let length_m = 1.0 + size_m * (0.5 - 0.5 * (TAU * moved).cos()) + 2e-4 * (TAU * 3.0 * moved).sin();
        let way_m = length_m - std::mem::replace(&mut last_m, length_m);
        let load_n = 50.0 + 15.0 * (TAU * time_s / 5.7).sin() + 5.0 * (TAU * time_s / 1.9).sin();
        let mut force_n = load_n;
        // From the platform to the winch: the cable presses with 2·sin(wrap/2) of its force.
        for (pulley, pressing) in deflections.iter_mut().zip([2.0_f64.sqrt(), 2.0]) {
            let mut held = 0.0;
            for (deflection, (slides_m, share)) in pulley.iter_mut().zip(CONTACTS) {
                *deflection = (*deflection + way_m / slides_m).clamp(-1.0, 1.0);
                held += share * *deflection;
            }
            // Paying out, the friction holds the cable back: the winch needs less.
            force_n -= MU * pressing * force_n * held + 0.5 * way_m / 1e-3;
        }
        let mut noisy_n = |of_n: f64| -> f64 {
            let number: f64 = StandardNormal.sample(&mut random);
            of_n + NOISE_N * number
        };
        let cable = CableInput { sensor_force_n: noisy_n(force_n), length_m, speed_m_per_s: way_m / 1e-3 };
        measurements.add(&Sample {
            stamp_nanos: i64::from(cycle) * 1_000_000,
            cables: &[cable],
            reference_force_n: &[noisy_n(load_n)],
            pose: None,
            outside_wrench: None,
        });
    }
    let found = discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0);
    let names: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
    assert_eq!((names, found.verdict), (Vec::new(), Verdict::Unexplained));
}
