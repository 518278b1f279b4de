//! Runs as benches have them: there and back at one speed, and lifts with short returns. The simulation is of its own, a bearing of half a turn whose friction
//! builds up over the way.

use std::f64::consts::TAU;

use fric_core::effects::Effect;
use fric_core::effects::empirical::{Over, RATIO, SHARE_PLACES};
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample, parameters};
use fric_lab::discover::{CableDiscovery, DiscoverOptions, Refusal, Verdict, discover};
use fric_lab::fit::{Measurements, Progress, Reference};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const CYCLE_S: f64 = 0.01;
const CYCLES: i32 = 6000;
const NOISE_N: f64 = 0.05;
const MU: f64 = 0.025;
const SIGMA_N_PER_M: f64 = 3000.0;
const PERIOD_M: f64 = 0.21;

/// A cable with a gain of its sensor, a ripple of its friction and viscous friction.
struct Bench {
    speed_m_per_s: fn(i32) -> f64,
    load_n: fn(f64) -> f64,
    gain: f64,
    ripple_ratio: f64,
    viscous_n_s_per_m: f64,
}

/// A cable that lacks nothing, there and back at one speed under one load.
const PLAIN: Bench =
    Bench { speed_m_per_s: triangle, load_n: constant_n, gain: 1.0, ripple_ratio: 0.0, viscous_n_s_per_m: 0.0 };

/// One and a half seconds each way.
fn triangle(cycle: i32) -> f64 {
    if cycle % 300 < 150 { 0.1 } else { -0.1 }
}

/// Out for 3.4 s, a rest, and back for 0.4 s.
fn lift(cycle: i32) -> f64 {
    match cycle % 400 {
        0..340 => 0.05,
        340..360 => 0.0,
        _ => -0.06,
    }
}

fn constant_n(_: f64) -> f64 {
    50.0
}

fn slow_n(time_s: f64) -> f64 {
    50.0 + 10.0 * (TAU * time_s / 23.0).sin() + 4.0 * (TAU * time_s / 5.3).sin()
}

fn two_n(time_s: f64) -> f64 {
    if time_s % 30.0 < 15.0 { 30.0 } else { 60.0 }
}

/// Discovers on a log of the bench with μ and σ wrong.
fn look(bench: &Bench) -> CableDiscovery {
    let text = "format = \"fric-robot/1\"\nname = \"axis\"\ncycle_s = 0.01\n[[cable]]\nname = \"a\"\npulleys = [{ wrap_deg = 180.0 }]\n\
                presliding = \"lumped\"\nfriction = { mu = 0.02, sigma_n_per_m = 2000.0, viscous_n_s_per_m = 0.0 }\n";
    let robot = RobotFile::parse(text, "axis").unwrap();
    let params = robot.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    measurements.start_log();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut noise_n = move || {
        let deviate: f64 = StandardNormal.sample(&mut random);
        NOISE_N * deviate
    };
    let (mut length_m, mut friction_n) = (1.5, 0.0);
    for cycle in 0..CYCLES {
        let (speed_m_per_s, load_n) = ((bench.speed_m_per_s)(cycle), (bench.load_n)(CYCLE_S * f64::from(cycle)));
        let way_m: f64 = CYCLE_S * speed_m_per_s;
        length_m += way_m;
        // Over half a turn the bearing carries the sum of the forces on both sides.
        let mu = MU * (1.0 + bench.ripple_ratio * (TAU * length_m / PERIOD_M).sin());
        let greatest_n = mu * (2.0 * load_n - friction_n);
        if way_m.abs() > 0.0 {
            let end_n = way_m.signum() * greatest_n;
            friction_n = end_n + (friction_n - end_n) * (-SIGMA_N_PER_M * way_m.abs() / greatest_n).exp();
        }
        let viscous_n = bench.viscous_n_s_per_m * speed_m_per_s;
        let sensor_force_n = bench.gain * (load_n - friction_n - viscous_n) + noise_n();
        measurements.add(&Sample {
            stamp_nanos: i64::from(cycle) * 10_000_000,
            cables: &[CableInput { sensor_force_n, length_m, speed_m_per_s }],
            reference_force_n: &[load_n + noise_n()],
            pose: None,
            outside_wrench: None,
        });
    }
    discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0)
}

fn names(found: &CableDiscovery) -> Vec<Effect> {
    found.findings.iter().map(|finding| finding.effect).collect()
}

/// At one speed the lengths are a grid, on which a ripple of a fraction of its step is a constant.
#[test]
fn a_gain_at_one_speed_is_no_ripple() {
    let found = look(&Bench { load_n: two_n, gain: 1.08, ..PLAIN });
    assert_eq!((names(&found), found.verdict), (vec![Effect::SensorGain], Verdict::Extended));
    let gain = found.after.values[Effect::SensorGain.places().start];
    assert!((gain / 1.08 - 1.0).abs() < 1e-3, "{gain}");
}

/// The gain outweighs the friction, so that the given model has none left.
#[test]
fn a_gain_that_hides_all_friction_is_named() {
    let found = look(&Bench { speed_m_per_s: lift, load_n: slow_n, gain: 1.08, ..PLAIN });
    assert_eq!((names(&found), found.verdict), (vec![Effect::SensorGain], Verdict::Extended));
    let gain = found.after.values[Effect::SensorGain.places().start];
    assert!((gain / 1.08 - 1.0).abs() < 1e-3, "{gain}");
}

/// In a motion that repeats itself a ripple of the length has lines at sums of both frequencies, which are no multiples of either.
#[test]
fn a_ripple_in_motion_that_repeats_itself_is_no_hum() {
    let found = look(&Bench { speed_m_per_s: lift, ripple_ratio: 0.35, ..PLAIN });
    assert_eq!((names(&found), found.verdict), (vec![Effect::FrictionRipple], Verdict::Extended));
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    let [sin, cos, period_m] =
        Effect::FrictionRipple.places().map(|place| found.after.values[place]).collect::<Vec<_>>()[..]
    else {
        unreachable!("a ripple has three parameters")
    };
    assert!(
        (period_m / PERIOD_M - 1.0).abs() < 1e-3 && (sin.hypot(cos) / 0.35 - 1.0).abs() < 0.02,
        "{period_m} {sin} {cos}"
    );
    let left_n = found.after.held_out_n.rms().unwrap();
    assert!(left_n < 1.05 * 2.0_f64.sqrt() * NOISE_N, "{left_n} N");
}

/// Of a ripple the run shows less than a turn, which is a friction that goes with the length. A table over the load would have both loads by heart: it shows
/// them whatever the sensor reads.
#[test]
fn friction_over_the_length_under_two_loads_is_no_table_over_the_load() {
    let found = look(&Bench { load_n: two_n, ripple_ratio: 0.35, ..PLAIN });
    assert_eq!((names(&found), found.verdict), (vec![Effect::Empirical], Verdict::Unexplained));
    let values = &found.after.values;
    assert_eq!(Over::of(|place| values[place]), Some(Over::Length));
    let (from_m, to_m) = (values[Over::Length.from()], values[Over::Length.to()]);
    for (share, place) in SHARE_PLACES.zip(0_u32..) {
        let length_m = from_m + (to_m - from_m) * f64::from(place) / 11.0;
        let truth = MU * (1.0 + 0.35 * (TAU * length_m / PERIOD_M).sin());
        let mu = values[parameters::MU] * (1.0 + values[RATIO] * values[share]);
        // Where the motion returns, friction has not built up yet.
        assert!((mu - truth).abs() < 0.1 * MU, "{length_m} m: {mu} for {truth}");
    }
}

/// At one speed each way viscous friction is a constant, which a wrong μ or a drag looks like, and others with it. Every robot has some.
#[test]
fn viscous_friction_that_the_log_cannot_tell_gets_no_other_name() {
    for speed_m_per_s in [triangle, lift] {
        let found = look(&Bench { speed_m_per_s, load_n: slow_n, viscous_n_s_per_m: 4.0, ..PLAIN });
        assert_eq!((names(&found), found.verdict), (vec![], Verdict::Unexplained));
        let viscous = found.tried.iter().find(|tried| tried.effect == Effect::Viscous).unwrap();
        assert!(matches!(viscous.refusal, Refusal::Open(_)) && viscous.takes_rest, "{:?}", viscous.refusal);
    }
}
