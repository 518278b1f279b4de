//! References under a load that goes with the length, where viscous friction and inertia leave what a late reference leaves.

use std::f64::consts::TAU;

use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_lab::discover::{CableDiscovery, DiscoverOptions, discover};
use fric_lab::fit::{Measurements, Progress, Reference};
use fric_lab::recording_fault::Fault;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const CYCLE_S: f64 = 0.02;
const NOISE_N: f64 = 0.05;
const MU: f64 = 0.02;

/// What the load goes with.
#[derive(Clone, Copy, Debug)]
enum Load {
    /// A weight on a lever that a drum turns.
    Lever,
    /// A spring.
    Spring,
    /// A spring, and something that has nothing to do with the motion.
    Both,
}

impl Load {
    fn force_n(self, time_s: f64, out_m: f64) -> f64 {
        match self {
            Self::Lever => 50.0 + 20.0 * (out_m / 0.1).sin(),
            Self::Spring => 50.0 - 100.0 * out_m,
            Self::Both => 50.0 - 60.0 * out_m + 8.0 * (TAU * time_s / 7.3).sin(),
        }
    }
}

/// Returns way, speed and acceleration.
fn motion(time_s: f64) -> [f64; 3] {
    let parts = [(0.15, TAU / 3.1), (0.06, TAU / 1.3)];
    let sum = |of: &dyn Fn(f64, f64) -> f64| parts.iter().map(|(size_m, rate)| size_m * of(*rate, rate * time_s)).sum();
    [
        sum(&|_, angle| angle.sin()),
        sum(&|rate, angle| rate * angle.cos()),
        sum(&|rate, angle| -rate * rate * angle.sin()),
    ]
}

/// Looks at a winch with a drum of this mass and viscous friction, which the robot file lacks.
fn look(load: Load, delay_s: f64, mass_kg: f64, viscous_n_s_per_m: f64) -> CableDiscovery {
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"axis\"\ncycle_s = {CYCLE_S}\n[[cable]]\nname = \"a\"\npulleys = [{{ wrap_deg = 180.0 }}]\n\
         friction = {{ mu = 0.015, sigma_n_per_m = 1e8, viscous_n_s_per_m = 0.0 }}\n"
    );
    let robot = RobotFile::parse(&text, "axis").unwrap();
    let params = robot.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    measurements.start_log();
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut noise_n = move || {
        let deviate: f64 = StandardNormal.sample(&mut random);
        NOISE_N * deviate
    };
    for cycle in 0_i32..3000 {
        let time_s = CYCLE_S * f64::from(cycle);
        let [out_m, speed_m_per_s, acceleration_m_per_s2] = motion(time_s);
        // Over half a turn the bearing carries the sum of both forces; paying out, all of this holds the cable back: the winch needs less.
        let ratio = MU * speed_m_per_s.signum();
        let rest_n = load.force_n(time_s, out_m) - viscous_n_s_per_m * speed_m_per_s - mass_kg * acceleration_m_per_s2;
        let [late_m, ..] = motion(time_s - delay_s);
        measurements.add(&Sample {
            stamp_nanos: i64::from(cycle) * 20_000_000,
            cables: &[CableInput {
                sensor_force_n: rest_n * (1.0 - ratio) / (1.0 + ratio) + noise_n(),
                length_m: 1.0 + out_m,
                speed_m_per_s,
            }],
            reference_force_n: &[load.force_n(time_s - delay_s, late_m) + noise_n()],
            pose: None,
            outside_wrench: None,
        });
    }
    discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0)
}

/// Makes sure that the reference is told late by so much, or in time, and that nothing has a name but what is hidden.
fn assert_late(load: Load, delay_s: f64, mass_kg: f64, viscous_n_s_per_m: f64) {
    let found = look(load, delay_s, mass_kg, viscous_n_s_per_m);
    let of_time: Vec<(Fault, f64)> = found
        .faults
        .iter()
        .filter(|fault| matches!(fault.fault, Fault::ReferenceDelay | Fault::ClockSkew))
        .map(|fault| (fault.fault, fault.parameters[0].1))
        .collect();
    let case = format!("{load:?}, {delay_s} s, {mass_kg} kg, {viscous_n_s_per_m} N s/m: {of_time:?}");
    if delay_s.abs() > 0.0 {
        assert!(
            matches!(of_time[..], [(Fault::ReferenceDelay, told_s)] if (told_s / delay_s - 1.0).abs() < 0.03),
            "{case}"
        );
    } else {
        assert!(of_time.is_empty(), "{case}");
    }
    let named: Vec<Effect> =
        found.findings.iter().map(|finding| finding.effect).filter(|effect| *effect != Effect::Empirical).collect();
    let is_hidden = |effect: &Effect| {
        *effect == Effect::Viscous && viscous_n_s_per_m > 0.0 || *effect == Effect::PulleyInertia && mass_kg > 0.0
    };
    assert!(named.iter().all(is_hidden), "{case}: {named:?}");
}

/// A weight on a lever, known from the angle in the same row, cannot be late.
#[test]
fn a_function_of_the_length_is_in_time() {
    for (mass_kg, viscous_n_s_per_m) in [(3.0, 0.0), (0.0, 5.0), (3.0, 5.0)] {
        assert_late(Load::Lever, 0.0, mass_kg, viscous_n_s_per_m);
    }
}

/// The loop over the length tells the delay, of which viscous friction would make another one, or inertia.
#[test]
fn what_was_a_function_of_the_length_is_late() {
    for (load, mass_kg, viscous_n_s_per_m) in
        [(Load::Spring, 0.0, 5.0), (Load::Spring, 3.0, 5.0), (Load::Lever, 3.0, 0.0)]
    {
        assert_late(load, 0.1, mass_kg, viscous_n_s_per_m);
    }
}

/// Where the length does not tell, the evidence is that beside viscous friction and inertia.
#[test]
fn inertia_is_no_delay_and_hides_none() {
    for delay_s in [0.0, 0.1, -0.1] {
        assert_late(Load::Both, delay_s, 3.0, 0.0);
    }
}
