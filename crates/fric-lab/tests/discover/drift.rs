//! What is no drift of the sensors, with equations of its own, beside what is one.

use std::f64::consts::{PI, TAU};

use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_lab::discover::{CableDiscovery, DiscoverOptions, Verdict, discover};
use fric_lab::fit::{Measurements, Progress, Reference};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const MU: f64 = 0.03;
const SIGMA_N_PER_M: f64 = 1e4;
const NOISE_N: f64 = 0.05;
const CYCLE_S: f64 = 0.002;
const FILTER_S: f64 = 0.006;

/// The moment of a log.
struct Moment {
    time_s: f64,
    /// From −1 to 1.
    place: f64,
    /// What a drift of standard deviation 1 and a correlation time of 1 s has come to.
    drift: f64,
    /// Noise of standard deviation 1 behind a filter of [`FILTER_S`].
    smoothed: f64,
}

/// Looks at a log in which friction is greater by a factor, and the reference by a force, N, and measured in some of the cycles.
fn look(factor: fn(&Moment) -> f64, added_n: fn(&Moment) -> f64, is_measured: fn(i32) -> bool) -> CableDiscovery {
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = {CYCLE_S}\n[[cable]]\nname = \"w\"\n\
         pulleys = [{{ wrap_deg = 180.0 }}]\n\
         friction = {{ mu = 0.025, sigma_n_per_m = 8.0e3, viscous_n_s_per_m = 1.0, offset_n = 0.0 }}\n"
    );
    let robot = RobotFile::parse(&text, "bench").unwrap();
    let mut measurements = Measurements::new(&robot.params(), Reference::Forces);
    measurements.start_log();
    let mut random = ChaCha8Rng::seed_from_u64(31);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let mut smooth = ChaCha8Rng::seed_from_u64(32);
    let (mut held_n, mut force_n, mut drift, mut smoothed, mut last_m) = (0.0_f64, 50.0_f64, 0.0_f64, 0.0_f64, 1.0);
    for cycle in 0..20_000_i32 {
        let time_s = CYCLE_S * f64::from(cycle);
        let place = (TAU * time_s / 3.1).sin() * (0.6 + 0.4 * (TAU * time_s / 17.0).cos());
        let length_m = 1.0 + 0.1 * place;
        let way_m = length_m - std::mem::replace(&mut last_m, length_m);
        let load_n = 50.0 + 12.0 * (TAU * time_s / 5.7).sin() + 4.0 * (TAU * time_s / 1.9).sin();
        drift += -drift * CYCLE_S + (2.0 * CYCLE_S).sqrt() * normal();
        let (kept, fresh): (f64, f64) = ((-CYCLE_S / FILTER_S).exp(), StandardNormal.sample(&mut smooth));
        smoothed = kept * smoothed + (1.0 - kept * kept).sqrt() * fresh;
        let moment = Moment { time_s, place, drift, smoothed };
        // Over half a turn the cable presses with the sum of both forces; a bristle deflects with the way until it holds as much as friction can.
        let greatest_n = MU * factor(&moment) * (load_n + force_n);
        held_n = greatest_n * way_m.signum()
            + (held_n - greatest_n * way_m.signum()) * (-SIGMA_N_PER_M * way_m.abs() / greatest_n).exp();
        // Paying out, friction holds the cable back: the winch needs less.
        force_n = load_n - held_n - 0.5 * way_m / CYCLE_S;
        let cable =
            CableInput { sensor_force_n: force_n + NOISE_N * normal(), length_m, speed_m_per_s: way_m / CYCLE_S };
        let reference_n = load_n + added_n(&moment) + NOISE_N * normal();
        measurements.add(&Sample {
            stamp_nanos: i64::from(cycle) * 2_000_000,
            cables: &[cable],
            reference_force_n: &[if is_measured(cycle) { reference_n } else { f64::NAN }],
            pose: None,
            outside_wrench: None,
        });
    }
    discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0)
}

fn assert_told(factor: fn(&Moment) -> f64, added_n: fn(&Moment) -> f64, verdict: Verdict) {
    assert_verdict(&look(factor, added_n, |_| true), verdict);
}

fn assert_verdict(found: &CableDiscovery, verdict: Verdict) {
    // A table is no name.
    let named: Vec<Effect> =
        found.findings.iter().map(|finding| finding.effect).filter(|effect| *effect != Effect::Empirical).collect();
    assert_eq!((named, found.verdict), (Vec::new(), verdict), "wander {} N", found.wander_n);
}

#[test]
fn a_drift_is_noise() {
    assert_told(|_| 1.0, |moment| 0.1 * moment.drift, Verdict::Complete);
}

/// Four times the white noise of both sensors.
#[test]
fn noise_that_an_amplifier_smooths_is_noise() {
    let found = look(|_| 1.0, |moment| 0.3 * moment.smoothed, |_| true);
    assert_verdict(&found, Verdict::Complete);
    assert!((found.noise_floor_n.hypot(found.wander_n) / 0.3_f64.hypot(2.0_f64.sqrt() * NOISE_N) - 1.0).abs() < 0.05);
}

/// A chatter of the same spectrum, in the quick half of the strokes.
#[test]
fn what_is_loud_in_motion_is_no_noise() {
    let chatter_n = |moment: &Moment| if moment.place.abs() < 0.4 { 0.4 * moment.smoothed } else { 0.0 };
    assert_told(|_| 1.0, chatter_n, Verdict::Unexplained);
}

/// Where nothing is measured, nothing is known; that is no silence.
#[test]
fn a_drift_is_noise_with_gaps() {
    for is_measured in [|cycle: i32| cycle % 1_500 >= 500, |cycle: i32| !(6_000..13_000).contains(&cycle)] {
        assert_verdict(&look(|_| 1.0, |moment| 0.1 * moment.drift, is_measured), Verdict::Complete);
    }
}

/// At reversals such a friction jumps by more or less than the model says, and changes slowly between them.
#[test]
fn friction_that_depends_on_the_place_is_no_drift() {
    assert_told(|moment| 1.0 + 0.12 * moment.place, |_| 0.0, Verdict::Unexplained);
}

#[test]
fn friction_that_jumps_now_and_then_is_no_drift() {
    assert_told(|moment| if (moment.time_s / 3.7).fract() < 0.4 { 1.12 } else { 1.0 }, |_| 0.0, Verdict::Unexplained);
}

/// A ringing platform, every five seconds: as large as a drift, but not at any time.
#[test]
fn hits_are_no_drift() {
    let ringing_n = |moment: &Moment| {
        let since_s = moment.time_s % 5.0;
        0.8 * (-since_s / 0.15).exp() * (11.0 * TAU * since_s + PI / 2.0).sin() * (0.4 * moment.time_s.floor()).cos()
    };
    assert_told(|_| 1.0, ringing_n, Verdict::Unexplained);
}
