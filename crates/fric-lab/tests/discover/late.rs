//! A sensor that follows late and a motion that is known too early are the same to first order.

use fric_core::effects::Effect;
use fric_lab::discover::{Finding, RunnerUp};
use fric_lab::simulate::sweep::{Case, Group};
use fric_lab::simulate::{Simulation, SimulationOptions};

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
