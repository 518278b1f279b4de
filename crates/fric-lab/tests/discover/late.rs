//! A sensor that follows late and a motion that is known too early are the same to first order.

use std::f64::consts::TAU;

use fric_core::effects::Effect;
use fric_core::robot::RobotParams;
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_lab::discover::{DiscoverOptions, Finding, Refusal, RunnerUp, Verdict, discover};
use fric_lab::fit::{Measurements, Progress, Reference};
use fric_lab::recording_fault::Fault;
use fric_lab::simulate::sweep::{Case, Group};
use fric_lab::simulate::{Simulation, SimulationOptions};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};

use super::{look, look_by};

/// On 20 s of the identification run, a lag of half the usual strength leaves less noise as a delay. Where it is named so, the lag stands beside it.
#[test]
fn a_delay_that_may_be_a_lag_is_told_with_it() {
    for seed in [7000, 7001, 7002] {
        let case = Case { strength_ratio: 0.5, seed, ..Case::hiding(Group::Bench, &[Effect::SensorLag]) };
        let mut log = case.log().unwrap();
        let options = SimulationOptions {
            seed,
            duration_s: Some(20.0),
            mu_spread_ratio: 0.1,
            effects: log.truth.effects.clone(),
            ..SimulationOptions::default()
        };
        log.simulation = Simulation::new(&log.truth.robot, &options).unwrap();
        let robot = log.robot.clone();
        let (found, _) = look_by(log, &robot);
        let is_beside = |other: &RunnerUp| other.effect == Effect::SensorLag && other.is_as_good;
        let names_lag = |finding: &Finding| {
            finding.effect == Effect::SensorLag
                || finding.effect == Effect::TimeDelay && finding.runner_up.as_ref().is_some_and(is_beside)
        };
        assert!(!found.findings.is_empty() && found.findings.iter().all(names_lag), "{seed}");
    }
}

/// A delay of full strength at little noise is told from a lag.
#[test]
fn a_delay_is_told_from_a_lag() {
    let case = Case { noise_ratio: 0.5, seed: 70_301, ..Case::hiding(Group::Single, &[Effect::TimeDelay]) };
    let (found, _) = look(&case);
    let names: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
    assert_eq!(names, [Effect::TimeDelay]);
    assert!(found.findings[0].runner_up.as_ref().is_none_or(|other| !other.is_as_good));
}

const NOISE_N: f64 = 0.03;

/// Coulomb friction without presliding, in samples so many milliseconds apart. The reference is late by `delay_s`, and the sensor follows with the time
/// constant `lag_s`. The noise enters behind that.
fn sampled<'a>(
    robot: &'a RobotParams<'a>,
    [least_ms, below_ms]: [u32; 2],
    delay_s: f64,
    lag_s: f64,
    seed: u64,
) -> Measurements<'a> {
    const FINE_S: f64 = 1e-3;
    let load_n = |time_s: f64| 50.0 + 12.0 * (TAU * time_s / 5.7).sin() + 4.0 * (TAU * time_s / 1.9).sin();
    let mut measurements = Measurements::new(robot, Reference::Forces);
    measurements.start_log();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let intervals = Uniform::new(least_ms, below_ms).unwrap();
    let (mut shown_n, mut next, mut stamp_nanos) = (load_n(0.0), 0, 0);
    for fine in 0..120_000 {
        let time_s = FINE_S * f64::from(fine);
        let (phase, turn) = (TAU * time_s / 3.1, 0.1 * TAU / 3.1);
        // Over half a turn the bearing carries the sum of both forces; paying out, friction holds the cable back: the winch needs less.
        let friction_ratio = 0.015 * phase.cos().signum();
        let winch_n = load_n(time_s) * (1.0 - friction_ratio) / (1.0 + friction_ratio);
        shown_n += (winch_n - shown_n) * -(-FINE_S / lag_s).exp_m1();
        if fine == next {
            let mut noise_n = || {
                let deviate: f64 = StandardNormal.sample(&mut random);
                NOISE_N * deviate
            };
            measurements.add(&Sample {
                stamp_nanos,
                cables: &[CableInput {
                    sensor_force_n: shown_n + noise_n(),
                    length_m: 1.0 + 0.1 * phase.sin(),
                    speed_m_per_s: turn * phase.cos(),
                }],
                reference_force_n: &[load_n(time_s - delay_s) + noise_n()],
                pose: None,
                outside_wrench: None,
            });
            next += intervals.sample(&mut random);
        }
        stamp_nanos += 1_000_000;
    }
    measurements
}

const IRREGULAR_MS: [u32; 2] = [20, 60];

fn axis(cycle_s: f64) -> RobotFile {
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"axis\"\ncycle_s = {cycle_s}\n[[cable]]\nname = \"a\"\npulleys = [{{ wrap_deg = 180.0 }}]\n\
         friction = {{ mu = 0.02, sigma_n_per_m = 1e8, viscous_n_s_per_m = 0.0 }}\n"
    );
    RobotFile::parse(&text, "axis").unwrap()
}

/// The reference is put back by time, not by samples; an early one is told from a sensor that follows late.
#[test]
fn time_errors_among_irregular_samples() {
    let robot = axis(0.04);
    let robot = robot.params();
    for (delay_s, seed) in [(0.12, 5), (-0.12, 6), (-0.12, 7)] {
        let measurements = sampled(&robot, IRREGULAR_MS, delay_s, 0.0, seed);
        let found = discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0);
        let [fault] = found.faults.as_slice() else { panic!("{delay_s}: {:?}, {:?}", found.faults, found.findings) };
        let (_, found_s) = fault.parameters[0];
        assert!(fault.fault == Fault::ReferenceDelay && (found_s / delay_s - 1.0).abs() < 0.02, "{delay_s}: {fault:?}");
        assert!(found.findings.is_empty(), "{:?}", found.findings);
        // The noise of both sensors.
        let left_n = found.after.held_out_n.rms().unwrap();
        assert!(left_n < 1.1 * NOISE_N * 2.0_f64.sqrt(), "{delay_s}: {left_n} N");
    }
    for (lag_s, seed) in [(0.12, 8), (0.2, 9)] {
        let measurements = sampled(&robot, IRREGULAR_MS, 0.0, lag_s, seed);
        let found = discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0);
        let names: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
        assert!(names == [Effect::SensorLag] && found.faults.is_empty(), "{lag_s}: {names:?}, {:?}", found.faults);
    }
}

/// A lag of many samples makes the noise behind it louder than what it explains. It is told with its time constant all the same, and not without a lag.
#[test]
fn a_lag_that_noise_hides_is_told() {
    let robot = axis(0.004);
    let robot = robot.params();
    for (lag_s, seed) in [(0.05, 1), (0.1, 2), (0.0, 3)] {
        let measurements = sampled(&robot, [4, 5], 0.0, lag_s, seed);
        let found = discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0);
        assert!(found.findings.is_empty(), "{lag_s}: {:?}", found.findings);
        let told: Vec<f64> = found
            .tried
            .iter()
            .filter_map(|tried| match tried.refusal {
                Refusal::Louder { time_constant_s } => Some(time_constant_s),
                _ => None,
            })
            .collect();
        if lag_s > 0.0 {
            assert!(found.verdict == Verdict::Unexplained && told.len() == 1, "{lag_s}: {:?}", found.tried);
            assert!((told[0] / lag_s - 1.0).abs() < 0.15, "{lag_s}: {told:?}");
        } else {
            assert!(found.verdict == Verdict::Complete && told.is_empty(), "{:?}", found.tried);
        }
    }
}
