//! What hides the friction that a model lacks, or that it has wrong: a zero and a slope of the sensor, one speed, and the law by which friction depends on the
//! tension.

use std::f64::consts::TAU;

use fric_core::effects::Effect;
use fric_core::parameters::{MU, VISCOUS};
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_lab::discover::{CableDiscovery, DiscoverOptions, Refusal, Verdict, discover};
use fric_lab::fit::{Measurements, Progress, Reference};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const TRUE_MU: f64 = 0.025;
const SIGMA_N_PER_M: f64 = 1200.0;
const TRUE_VISCOUS_N_S_PER_M: f64 = 0.8;
const CYCLE_S: f64 = 0.01;

/// A place that goes there and back at these speeds between small steps, m, as on a bench.
fn places_m(speeds_m_per_s: [f64; 4]) -> Vec<f64> {
    let mut places_m = vec![0.0];
    let mut go = |to_m: f64, speed_m_per_s: f64| {
        let mut at_m = places_m.last().copied().unwrap_or(0.0);
        while (to_m - at_m).abs() > 1e-9 {
            at_m += (to_m - at_m).clamp(-speed_m_per_s * CYCLE_S, speed_m_per_s * CYCLE_S);
            places_m.push(at_m);
        }
        places_m.extend([at_m; 30]);
    };
    for _ in 0..2 {
        for step_m in [0.0005, 0.0015, 0.0035, 0.0085, 0.0185, 0.0085, 0.0045, 0.0035] {
            go(step_m, 0.05);
        }
        for speed_m_per_s in speeds_m_per_s {
            go(0.4, speed_m_per_s);
            go(0.05, speed_m_per_s);
        }
    }
    places_m
}

/// A bench whose cable wraps two bearings by a quarter turn each. Given is a wrong μ and another viscous friction than the true one, or none.
struct Bench {
    /// Forces are so many times as large as usual here.
    size: f64,
    zero_n: f64,
    gain: f64,
    given_viscous_n_s_per_m: f64,
    speeds_m_per_s: [f64; 4],
    /// The part of the friction by which the tension that a bearing carries is less than the one on the platform's side.
    carried_ratio: f64,
}

impl Default for Bench {
    fn default() -> Self {
        Self {
            size: 1.0,
            zero_n: 0.0,
            gain: 1.0,
            given_viscous_n_s_per_m: 0.0,
            speeds_m_per_s: [0.02, 0.08, 0.2, 0.3],
            carried_ratio: 0.5,
        }
    }
}

impl Bench {
    /// Adds a log of the bench.
    fn run(&self, measurements: &mut Measurements<'_>, mut normal: impl FnMut() -> f64) {
        let Self { size, zero_n, gain, speeds_m_per_s, carried_ratio, .. } = *self;
        let (mut held_n, mut last_m) = ([0.0_f64; 2], 0.0);
        for (cycle, length_m) in (0_i32..).zip(places_m(speeds_m_per_s)) {
            let time_s = CYCLE_S * f64::from(cycle);
            let way_m = length_m - std::mem::replace(&mut last_m, length_m);
            let load_n = size * (13.0 + 5.0 * (TAU * time_s / 17.0).sin() + 0.8 * (TAU * time_s / 5.1).sin());
            let mut force_n = load_n;
            for held_n in &mut held_n {
                let greatest_n = TRUE_MU * 2.0_f64.sqrt() * (force_n - carried_ratio * *held_n);
                if way_m.abs() > 0.0 {
                    let end_n = greatest_n * way_m.signum();
                    *held_n =
                        end_n + (*held_n - end_n) * (-size * SIGMA_N_PER_M / 2.0 * way_m.abs() / greatest_n).exp();
                }
                force_n -= *held_n + size * TRUE_VISCOUS_N_S_PER_M * way_m / CYCLE_S;
            }
            let shown_n = gain * force_n + zero_n + 0.03 * normal();
            measurements.add(&Sample {
                stamp_nanos: i64::from(cycle) * 10_000_000,
                cables: &[CableInput { sensor_force_n: shown_n, length_m, speed_m_per_s: way_m / CYCLE_S }],
                reference_force_n: &[load_n + 0.015 * normal()],
                pose: None,
                outside_wrench: None,
            });
        }
    }
}

/// Looks at a log of a bench.
fn look(bench: &Bench) -> CableDiscovery {
    look_at_all(std::slice::from_ref(bench))
}

/// Looks at several logs, of which each is of one bench; what is given is that of the first.
fn look_at_all(benches: &[Bench]) -> CableDiscovery {
    let given_viscous_n_s_per_m = benches[0].given_viscous_n_s_per_m;
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = {CYCLE_S}\n[[cable]]\nname = \"w\"\n\
         pulleys = [{{ wrap_deg = 90.0 }}, {{ wrap_deg = 90.0 }}]\n\
         friction = {{ mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = {given_viscous_n_s_per_m} }}\n"
    );
    let robot = RobotFile::parse(&text, "bench").unwrap();
    let mut measurements = Measurements::new(&robot.params(), Reference::Forces);
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for bench in benches {
        measurements.start_log();
        bench.run(&mut measurements, || StandardNormal.sample(&mut random));
    }
    discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0)
}

fn effects(found: &CableDiscovery) -> Vec<Effect> {
    let mut effects: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
    effects.sort_unstable();
    effects
}

fn assert_near(value: f64, truth: f64, tolerance: f64) {
    assert!((value / truth - 1.0).abs() < tolerance, "{value}, {truth}");
}

/// A zero leaves viscous friction no evidence as long as it is not named itself: both are named, however they compare in size.
#[test]
fn viscous_friction_keeps_no_zero_from_its_turn() {
    for zero_n in [0.1, 0.3, 0.45, 0.6, 1.0] {
        let found = look(&Bench { zero_n, ..Bench::default() });
        assert_eq!(
            (effects(&found), found.verdict),
            (vec![Effect::Viscous, Effect::SensorOffset], Verdict::Extended),
            "{zero_n} N"
        );
        assert_near(found.after.values[VISCOUS], TRUE_VISCOUS_N_S_PER_M, 0.1);
        assert_near(found.after.values[Effect::SensorOffset.places().start], zero_n, 0.1);
    }
}

/// A sensor that shows too little hides the friction, whose given values are kept then. Once the slope is known they are fitted, so that nothing else stands
/// for their errors.
#[test]
fn friction_that_a_wrong_slope_hides_is_fitted_beside_it() {
    for (gain, given_viscous_n_s_per_m, expected) in [
        (0.5, 1.5, vec![Effect::SensorGain]),
        (0.7, 1.5, vec![Effect::SensorGain]),
        (0.225, 0.0, vec![Effect::Viscous, Effect::SensorGain]),
    ] {
        let found = look(&Bench { size: 5.0, gain, given_viscous_n_s_per_m, ..Bench::default() });
        assert_eq!((effects(&found), found.verdict), (expected, Verdict::Extended), "{gain}");
        assert_near(found.after.values[Effect::SensorGain.places().start], gain, 0.005);
        assert_near(found.after.values[MU], TRUE_MU, 0.05);
        assert_near(found.after.values[VISCOUS], 5.0 * TRUE_VISCOUS_N_S_PER_M, 0.15);
    }
}

/// Returns the effects that have a name: all but a table.
fn names(found: &CableDiscovery) -> Vec<Effect> {
    effects(found).into_iter().filter(|effect| *effect != Effect::Empirical).collect()
}

/// At one speed viscous friction is a part of the bearings'. A zero is none.
#[test]
fn at_one_speed_what_depends_on_no_speed_is_named() {
    for zero_n in [0.6, -1.0] {
        let found = look(&Bench { zero_n, speeds_m_per_s: [0.05; 4], ..Bench::default() });
        assert_eq!(names(&found), [Effect::SensorOffset], "{zero_n} N");
        assert_near(found.after.values[Effect::SensorOffset.places().start], zero_n, 0.1);
        assert_near(found.after.values[VISCOUS] + 1.0, 1.0, 1e-9);
    }
}

/// Friction by the tension before or behind a bearing differs from friction by their mean by `a²/2` of the tension, `a` of it being friction: some 20 standard
/// errors here, but no zero and no slope of the sensor, and no friction that differs by direction. That such an asymmetry of a usual size accounts for it is told, and
/// no table stands in for it.
#[test]
fn another_law_of_the_same_friction_is_no_fault_of_the_sensor() {
    for carried_ratio in [0.0, 1.0] {
        let found = look(&Bench { carried_ratio, ..Bench::default() });
        assert_eq!((effects(&found), found.verdict), (vec![Effect::Viscous], Verdict::Unexplained), "{carried_ratio}");
        let told: Vec<Effect> =
            found.tried.iter().filter(|of| of.takes_rest && of.refusal == Refusal::Usual).map(|of| of.effect).collect();
        assert!(told.contains(&Effect::DirectionAsymmetry), "{carried_ratio}: {:?}", found.tried);
    }
}

/// Sensors are tared anew before a log. A zero of one size in all of them is none, and what is a mean of several logs is no drift in each.
#[test]
fn a_zero_that_differs_from_log_to_log_is_not_named_as_one() {
    let logs = [0.1, 1.2].map(|zero_n| Bench { zero_n, given_viscous_n_s_per_m: 0.8, ..Bench::default() });
    assert_eq!(names(&look_at_all(&logs)), []);
    let alike = [0.7, 0.7].map(|zero_n| Bench { zero_n, given_viscous_n_s_per_m: 0.8, ..Bench::default() });
    assert_eq!(names(&look_at_all(&alike)), [Effect::SensorOffset]);
}
