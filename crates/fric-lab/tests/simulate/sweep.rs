//! The logs that a search for missing effects is tried on.

use std::collections::BTreeSet;

use fric_core::effects::Effect;
use fric_lab::replay::WrenchReference;
use fric_lab::simulate::sweep::{Case, Group, SweepError, WrenchCase, WrenchGroup, cases, wrench_cases};
use fric_lab::simulate::{DISTURBANCES, HiddenError};

fn bits(case: &Case, cycles: usize) -> Vec<u64> {
    let mut log = case.log().unwrap();
    let mut bits = Vec::new();
    for _ in 0..cycles {
        let sample = log.simulation.next_cycle().unwrap();
        let cable = sample.cables[0];
        bits.extend(
            [cable.sensor_force_n, cable.length_m, cable.speed_m_per_s, sample.reference_force_n[0]].map(f64::to_bits),
        );
    }
    bits
}

#[test]
fn there_are_enough_of_each_kind() {
    let cases = cases();
    assert!(cases.len() >= 300, "{}", cases.len());
    let names: BTreeSet<String> = cases.iter().map(Case::name).collect();
    assert_eq!(names.len(), cases.len());
    for effect in Effect::kinds().filter(|effect| *effect != Effect::Empirical) {
        let single = |case: &&Case| case.group == Group::Single && case.effects == [effect];
        assert_eq!(cases.iter().filter(single).count(), 9, "{effect:?}");
    }
    for row in DISTURBANCES {
        let with =
            |group| cases.iter().filter(|case| case.group == group && case.disturbance == Some(row.kind)).count();
        assert!(with(Group::Outside) >= 4 && with(Group::Mixed) >= 4, "{}", row.kind);
    }
    for case in &cases {
        let expected = match case.group {
            Group::Pair => 2,
            Group::Triple => 3,
            Group::Many => case.effects.len().clamp(4, 5),
            Group::Single | Group::Law | Group::Mixed => 1,
            Group::Bench => case.effects.len().min(1),
            _ => 0,
        };
        assert_eq!(case.effects.len(), expected, "{}", case.name());
        assert!(case.effects.iter().collect::<BTreeSet<_>>().len() == expected, "{}", case.name());
    }
}

#[test]
fn every_case_has_a_log_and_a_robot_that_does_not_know() {
    for case in cases() {
        let log = case.log().unwrap_or_else(|error| panic!("{}: {error}", case.name()));
        let kinds: Vec<_> = log.truth.effects.iter().map(fric_lab::simulate::HiddenEffect::effect).collect();
        assert_eq!(kinds, case.effects);
        let [guess, truth] = [&log.robot, &log.truth.robot].map(|robot| robot.options().cable.clone());
        assert_eq!((guess.len(), truth.len()), (1, 1));
        assert!(guess[0].effects.is_empty() && guess[0].friction != truth[0].friction);
        assert_eq!((&guess[0].pulleys, guess[0].base_m), (&truth[0].pulleys, truth[0].base_m));
        // Drawn from 0.011 to 0.025, and each pulley's within a tenth of it; a pulley with a friction of its own is left out.
        assert!((0.0099..=0.0275).contains(&truth[0].friction.mu));
        assert!(log.simulation.is_balanced() != (case.group == Group::Bench), "{}", case.name());
        assert_eq!(guess[0].base_m.is_none(), case.group == Group::Bench);
    }
}

#[test]
fn the_seed_decides_every_bit() {
    let case = Case { seed: 5, ..Case::hiding(Group::Pair, &[Effect::Stribeck, Effect::CableElasticity]) };
    let other = Case { seed: 6, ..case.clone() };
    assert_eq!(bits(&case, 300), bits(&case, 300));
    assert_ne!(bits(&case, 300), bits(&other, 300));
}

#[test]
fn a_log_is_as_long_as_a_run_and_loaded_as_a_small_robot() {
    for (case, cycles) in [(Case::of(Group::Nothing), 50_000..55_000), (Case::of(Group::Bench), 25_000..25_001)] {
        let mut log = case.log().unwrap();
        assert!(cycles.contains(&log.simulation.total_cycles()));
        let mut mean_n = 0.0;
        let mut count = 0.0;
        while let Some(sample) = log.simulation.next_cycle() {
            assert_eq!((sample.cables.len(), sample.reference_force_n.len()), (1, 1));
            assert_eq!(sample.pose.is_some(), case.group != Group::Bench);
            assert!(sample.outside_wrench.is_none());
            assert!(sample.reference_force_n[0] > 0.3 && sample.reference_force_n[0] < 25.0);
            mean_n += sample.reference_force_n[0];
            count += 1.0;
        }
        assert!((3.0..10.0).contains(&(mean_n / count)), "{}", mean_n / count);
    }
}

#[test]
fn a_case_that_names_nothing_is_refused() {
    let error = Case { disturbance: Some("rust"), ..Case::of(Group::Outside) }.log().unwrap_err();
    assert!(matches!(error, SweepError::Hidden(HiddenError::UnknownKind { noun: "disturbance", .. })), "{error}");
}

#[test]
fn there_are_logs_of_whole_robots_of_each_kind() {
    let cases = wrench_cases();
    assert!(cases.len() >= 60, "{}", cases.len());
    let names: BTreeSet<String> = cases.iter().map(WrenchCase::name).collect();
    let seeds: BTreeSet<u64> = cases.iter().map(|case| case.seed).collect();
    assert_eq!((names.len(), seeds.len()), (cases.len(), cases.len()));
    let groups: BTreeSet<WrenchGroup> = cases.iter().map(|case| case.group).collect();
    for group in groups {
        let of_group = cases.iter().filter(|case| case.group == group).count();
        assert!(of_group >= 3, "{}: {of_group}", group.name());
    }
}

/// `A^T f + w = 0` (\[P\] 3): the true forces hold the measured wrench to its noise, through the file's geometry.
#[test]
fn the_wrench_of_a_log_is_that_of_its_true_forces() {
    let case = wrench_cases().into_iter().find(|case| case.group == WrenchGroup::Stribeck).unwrap();
    assert_eq!((case.reference, case.wrench_every), (WrenchReference::Measured, 4));
    let log = case.log().unwrap();
    let with_effect: Vec<usize> = (0..8).filter(|cable| !log.truth.effects[*cable].is_empty()).collect();
    assert_eq!(with_effect.len(), 2);
    let [given, truth] = [&log.robot, &log.truth.robot].map(|robot| robot.options().cable.clone());
    for cable in 0..8 {
        assert!(given[cable].effects.is_empty() && given[cable].friction != truth[cable].friction);
        assert_eq!(truth[cable].effects.len(), usize::from(with_effect.contains(&cable)));
    }
    let params = log.robot.params();
    let (mut squares, mut count) = ([0.0; 2], 0.0);
    for cycle in log.cycles.iter().step_by(case.wrench_every) {
        let wrench = cycle.wrench.unwrap().to_vector();
        let pulls = params.cables().iter().zip(&cycle.true_force_n);
        let sum =
            pulls.fold(wrench, |sum, (cable, force_n)| sum + cable.structure_column(&cycle.pose).unwrap() * *force_n);
        squares[0] += sum.fixed_rows::<3>(0).norm_squared();
        squares[1] += sum.fixed_rows::<3>(3).norm_squared();
        count += 3.0;
    }
    let [force_n, torque_nm] = squares.map(|squares: f64| (squares / count).sqrt());
    assert!((force_n / (0.01 * case.noise_ratio) - 1.0).abs() < 0.05, "{force_n}");
    assert!((torque_nm / (0.0005 * case.noise_ratio) - 1.0).abs() < 0.05, "{torque_nm}");
}
