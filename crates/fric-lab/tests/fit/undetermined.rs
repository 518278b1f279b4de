//! What a log cannot tell is named and left as it was given; the rest is right.

use fric_core::robot::file::RobotFile;
use fric_lab::fit::{CableFit, FitOptions, Termination};

use super::logs::{Log, assert_near, deviation, parameter, undetermined, value};
use super::oracle::{Bench, PULLEYS, strokes, wandering};
use crate::simulate::robots::{bench, bench_with};

/// The values given, all wrong.
const GIVEN: [(&str, f64); 4] =
    [("mu", 0.05), ("sigma_n_per_m", 300.0), ("viscous_n_s_per_m", 0.7), ("offset_n", -0.1)];

fn given() -> RobotFile {
    bench(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0, viscous_n_s_per_m = 0.7, offset_n = -0.1")
}

/// The fit of a log, of which exactly `names` are undetermined, and left at what was given.
fn fit(log: &Log, names: &[&str]) -> CableFit {
    let fit = log.fit(&given(), &FitOptions::default()).remove(0);
    let mut found = undetermined(&fit);
    found.sort();
    assert_eq!(found, names);
    for (name, given) in GIVEN.into_iter().filter(|(name, _)| names.contains(name)) {
        assert_eq!(value(&fit, name).to_bits(), given.to_bits(), "{name}");
        assert!(fit.standard_error(&parameter(name)).is_none());
    }
    fit
}

#[test]
fn slow_motion_leaves_the_viscous_friction() {
    let truth = Bench::default();
    // One stroke there and back in 40 s, at most 0.3 mm/s.
    for rad_per_s in [0.15, 0.2, 0.3] {
        let log = truth.run(40.0, |time_s| 1.0 + 0.002 * (rad_per_s * time_s).sin(), wandering(8.0));
        let fit = fit(&log, &["viscous_n_s_per_m"]);
        assert!(fit.samples.used > 15_000, "{:?}", fit.samples);
        assert_near(&fit, &["mu", "sigma_n_per_m", "offset_n"], &truth.truth());
        assert!(fit.errors.after_n.rms().unwrap() < 1.02 * truth.floor_n());
    }
}

#[test]
fn motion_one_way_leaves_the_presliding() {
    let truth = Bench::default();
    let log = truth.run(20.0, |time_s| 1.0 + 0.2 * time_s + 0.15 * time_s.sin(), wandering(8.0));
    let fit = fit(&log, &["sigma_n_per_m"]);
    assert_near(&fit, &["mu", "viscous_n_s_per_m", "offset_n"], &truth.truth());
}

/// Force at the platform per force without friction, of the pulleys of the bench without viscous friction: half a turn with the sensor, then a quarter
/// (\[P\] 10, 11).
fn gain(mu: f64) -> f64 {
    let quarter = std::f64::consts::FRAC_1_SQRT_2 * mu;
    (1.0 + mu) * (1.0 + quarter) / (1.0 - quarter)
}

/// Under a load that stays, Coulomb friction of one direction is an offset: the zero stays as given, and μ takes what it is wrong by.
#[test]
fn motion_one_way_under_a_constant_load_leaves_the_zero() {
    let truth = Bench::default();
    for load_n in [4.0, 8.0, 20.0, 50.0] {
        let log = truth.run(20.0, |time_s| 1.0 + 0.2 * time_s + 0.15 * time_s.sin(), |_| load_n);
        let fit = fit(&log, &["offset_n", "sigma_n_per_m"]);
        assert!(fit.at_bound.is_empty(), "{load_n} N");
        // The zero is given 0.3 N too low.
        let by_zero = (gain(value(&fit, "mu")) / gain(truth.mu) - 1.0) * load_n;
        assert!((by_zero / 0.3 - 1.0).abs() < 0.05, "{load_n} N: {by_zero} N");
        let ratio = value(&fit, "viscous_n_s_per_m") / truth.viscous_n_s_per_m;
        assert!((ratio - 1.0).abs() < 0.06, "{load_n} N: {ratio}");
        // What is told to be open: all friction, or a zero in its place.
        let open = fit.open.iter().find(|open| open.parts[0].parameter == parameter("offset_n")).unwrap();
        let [zero, friction] = open.parts[..] else { panic!("{open:?}") };
        assert_eq!((friction.parameter, friction.step.abs().to_bits()), (parameter("mu"), value(&fit, "mu").to_bits()));
        let friction_n = load_n * (1.0 - gain(truth.mu).recip()) + 0.3;
        assert!((zero.step / friction_n - 1.0).abs() < 0.05, "{load_n} N: {} N of {friction_n} N", zero.step);
    }
}

/// What varies under one load is the noise of the sensor. Least squares would keep it from the platform by friction as large as the load, with a zero as
/// large beside it.
#[test]
fn noise_of_the_sensor_is_no_load() {
    for (mu, way) in [(0.1, 1.0), (0.1, -1.0), (0.02, 1.0)] {
        let truth = Bench { mu, offset_n: -0.1, sensor_noise_n: 0.8, reference_noise_n: 1.0, ..Bench::default() };
        let log = truth.run(10.0, |time_s| 2.0 + way * 0.1 * time_s, |_| 60.0);
        let fit = log.fit(&given(), &FitOptions::default()).remove(0);
        assert!(undetermined(&fit).contains(&"offset_n".to_owned()), "{:?}", undetermined(&fit));
        // The given viscous friction stays: at one speed it is Coulomb friction too.
        let viscous_n = 1.5 * (value(&fit, "viscous_n_s_per_m") - truth.viscous_n_s_per_m) * 0.1;
        let found_n = (gain(value(&fit, "mu")) - gain(mu)) * 60.0 + viscous_n;
        assert!(found_n.abs() < 0.2, "{mu}, {way}: {found_n} N");
    }
}

/// Under one load a gain goes with any zero: the zero stays as given, and the gain takes what it is wrong by. What varies is noise.
#[test]
fn one_load_leaves_the_zero_beside_a_gain() {
    const LOAD_N: f64 = 60.0;
    let truth = Bench { sensor_noise_n: 0.8, reference_noise_n: 1.0, ..Bench::default() };
    let mut log = truth.run(20.0, strokes(0.05, 0.3), |_| LOAD_N);
    log.0.iter_mut().for_each(|cycle| cycle.cables[0].sensor_force_n *= 1.25);
    for given_gain in [0.9, 1.25] {
        let line = format!("effects = [{{ kind = \"sensor_gain\", gain = {given_gain} }}]");
        let robot =
            bench_with(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0, viscous_n_s_per_m = 0.7, offset_n = -0.1", &line);
        let fit = log.fit(&robot, &FitOptions::default()).remove(0);
        assert!(undetermined(&fit).contains(&"offset_n".to_owned()), "{:?}", undetermined(&fit));
        assert_eq!(value(&fit, "offset_n").to_bits(), (-0.1_f64).to_bits());
        let gain = value(&fit, "sensor_gain.gain");
        let agrees = 1.25 * (LOAD_N - truth.offset_n) / (LOAD_N + 0.1);
        assert!((gain / agrees - 1.0).abs() < 0.002, "{given_gain}: {gain} for {agrees}");
        assert!((value(&fit, "mu") / truth.mu - 1.0).abs() < 0.1, "{given_gain}: {}", value(&fit, "mu"));
        // What is told to be open: the whole gain, or a zero in its place.
        let open = fit.open.iter().find(|open| open.parts[0].parameter == parameter("offset_n")).unwrap();
        let of_gain = open.parts.iter().find(|part| part.parameter == parameter("sensor_gain.gain")).unwrap();
        assert!((of_gain.step.abs() / (gain - 1.0) - 1.0).abs() < 1e-9, "{given_gain}: {open:?}");
        let zero_per_gain_n = open.parts[0].step / of_gain.step;
        assert!((zero_per_gain_n / (LOAD_N + 0.1) - 1.0).abs() < 0.005, "{given_gain}: {zero_per_gain_n} N");
    }
}

/// A ripple that the model lacks makes every interval wide. Friction that falls with the speed takes F_pv to 0, whatever was given.
#[test]
fn what_is_at_its_bound_does_not_depend_on_the_start() {
    let truth = Bench { viscous_n_s_per_m: -0.3, ..Bench::default() };
    let length_m = strokes(0.05, 0.3);
    let mut log = truth.run(20.0, &length_m, wandering(8.0));
    for (cycle, time_s) in log.0.iter_mut().zip((0_u32..).map(|cycle| f64::from(cycle) * truth.cycle_s)) {
        cycle.cables[0].sensor_force_n += 0.1 * (length_m(time_s) / 0.01).sin();
    }
    let fits = [0.0, 0.05, 0.3, 2.0].map(|viscous| {
        let text = format!("mu = 0.05, sigma_n_per_m = 300.0, viscous_n_s_per_m = {viscous}, offset_n = -0.1");
        log.fit(&bench(PULLEYS, &text), &FitOptions::default()).remove(0)
    });
    for fit in &fits {
        assert_eq!((undetermined(fit), fit.at_bound.clone()), (Vec::new(), vec![parameter("viscous_n_s_per_m")]));
        assert_eq!(value(fit, "viscous_n_s_per_m").to_bits(), 0);
        for name in ["mu", "sigma_n_per_m", "offset_n"] {
            assert!((value(fit, name) / value(&fits[0], name) - 1.0).abs() < 0.01, "{name}");
        }
    }
}

/// The start of the search takes a slow rise of the force for contacts so soft that the whole log would be their warm-up. The robot file's values then say
/// where that ends.
#[test]
fn a_warm_up_as_long_as_the_log_is_that_of_the_file() {
    let truth = Bench { sigma_n_per_m: 6.0, ..Bench::default() };
    let speed_m_per_s = 0.02;
    let log = truth.run(10.0, |time_s| 1.0 + speed_m_per_s * time_s, |_| 8.0);
    let given = given();
    let fit = log.fit(&given, &FitOptions::default()).remove(0);
    // `exp(−σ|Δl|/f_c)` falls to a thousandth.
    let params = given.params();
    let memory_m = params.cables()[0].memory_m_per_n(0.05, 300.0) * log.0[5000].cables[0].sensor_force_n;
    let cycles = 1e3_f64.ln() * memory_m / (speed_m_per_s * truth.cycle_s);
    let warm_up = f64::from(u32::try_from(fit.samples.warm_up).unwrap());
    assert!((warm_up / cycles - 1.0).abs() < 0.05, "{warm_up} of {cycles}");
    assert!(fit.samples.used > 1000, "{:?}", fit.samples);
}

/// A model without the mass that moves explains little. The search then takes σ to the end of its range, where the forces no longer change with it. That
/// does not make the soft σ of the file as good.
#[test]
fn a_soft_stiffness_that_the_samples_contradict_is_not_kept() {
    let truth = Bench { sigma_n_per_m: 1e7, ..Bench::default() };
    let length_m = strokes(0.05, 0.3);
    let mut log = truth.run(30.0, &length_m, wandering(8.0));
    for (cycle, time_s) in log.0.iter_mut().zip((0_u32..).map(|cycle| f64::from(cycle) * truth.cycle_s)) {
        let acceleration_m_per_s2 = (length_m(time_s + 1e-3) - 2.0 * length_m(time_s) + length_m(time_s - 1e-3)) / 1e-6;
        cycle.cables[0].sensor_force_n -= 20.0 * acceleration_m_per_s2;
    }
    let fit = log.fit(&given(), &FitOptions::default()).remove(0);
    assert!(value(&fit, "sigma_n_per_m") > 1e5, "{}", value(&fit, "sigma_n_per_m"));
}

/// Whatever the pulleys had stored before the log began adds up with ε while nothing moves, so not even that is known.
#[test]
fn standstill_tells_nothing() {
    let log = Bench::default().run(10.0, |_| 1.0, wandering(8.0));
    let fit = fit(&log, &["mu", "offset_n", "sigma_n_per_m", "viscous_n_s_per_m"]);
    assert_eq!((fit.samples.used, fit.samples.warm_up), (0, 10_000));
    assert_eq!(fit.termination, Termination::NothingToFit);
}

/// Viscous friction at one speed is an offset: F_pv stays as given, and ε takes what it is wrong by. μ is told by the
/// tension, and right.
#[test]
fn one_speed_leaves_viscous_friction_and_offset_together() {
    let truth = Bench::default();
    let speed_m_per_s = 0.1;
    let log = truth.run(20.0, |time_s| 1.0 + speed_m_per_s * time_s, wandering(8.0));
    let fit = fit(&log, &["sigma_n_per_m", "viscous_n_s_per_m"]);
    assert_near(&fit, &["mu"], &truth.truth());
    // Half of the sensor pulley's at 180°, all of the other's.
    let drag_n = |viscous_n_s_per_m: f64| 1.5 * viscous_n_s_per_m * speed_m_per_s;
    let together_n = truth.offset_n + drag_n(truth.viscous_n_s_per_m) - drag_n(value(&fit, "viscous_n_s_per_m"));
    assert!(deviation(&fit, "offset_n", together_n).abs() < 3.5);
}

/// Movements far smaller than the presliding distance see the bristle alone.
#[test]
fn presliding_by_itself_tells_the_stiffness() {
    let truth = Bench::default();
    let log = truth.run(20.0, |time_s| 1.0 + 2e-5 * (3.0 * time_s).sin(), wandering(8.0));
    let fit = fit(&log, &["mu", "viscous_n_s_per_m"]);
    assert_near(&fit, &["sigma_n_per_m", "offset_n"], &truth.truth());
}

#[test]
fn everything_moving_leaves_nothing() {
    let truth = Bench::default();
    let fit = fit(&truth.run(10.0, strokes(0.05, 1.0), wandering(8.0)), &[]);
    assert_near(&fit, &["mu", "sigma_n_per_m", "viscous_n_s_per_m", "offset_n"], &truth.truth());
}
