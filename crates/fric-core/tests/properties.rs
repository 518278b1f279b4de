//! What holds for every input there is.

use fric_core::effects::{Effect, EffectParams};
use fric_core::parameters::ParameterRow;
use fric_core::robot::{CableOptions, FrictionOptions, MonitorOptions, Presliding, PulleyOptions};
use fric_core::scalar::Scalar as _;
use fric_core::signals::{BEFORE_FIRST, RawSignals, SignalState, condition, next_cycle};
use fric_core::{
    CableCycle, CableGroup, CableInput, CableParams, CableStatus, Compensator, CycleInput, CycleOutput, Lanes, Pose,
    PoseWrap,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::bits::bits;
use crate::random::Random;
use crate::support::{UNMONITORED, WINCH, compensator, corner_cable, smooth_input};

/// The same cases every time, and nothing written beside the sources.
pub fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(0x00f2_1c00),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

const FORMS: [Presliding; 2] = [Presliding::Lumped, Presliding::PerPulley];

/// Everything switched on, and parameters at the ends of their ranges.
fn demanding(random: &mut Random, pulleys: &'static [PulleyOptions]) -> CableOptions<'static> {
    let index = usize::try_from(random.below(8)).unwrap();
    let mut ends = |least: f64, greatest: f64| match random.below(3) {
        0 => least,
        1 => greatest,
        _ => random.range(least, greatest),
    };
    let friction = FrictionOptions {
        mu: ends(0.0, 0.3),
        sigma_n_per_m: Some(ends(1e-3, 1e12)),
        viscous_n_s_per_m: ends(0.0, 1e6),
        offset_n: ends(-1e6, 1e6),
    };
    let traction_mu = Some(ends(0.01, 2.0));
    let sensor_below_90 = matches!(pulleys[0], PulleyOptions::Fixed { wrap_rad, sensor: true } if wrap_rad < 1.5);
    let friction = FrictionOptions { mu: if sensor_below_90 { 0.1 * friction.mu } else { friction.mu }, ..friction };
    let mut options =
        CableOptions { friction, pulleys, ..corner_cable(index, FORMS[usize::try_from(random.below(2)).unwrap()]) };
    options.traction_mu = traction_mu.filter(|_| random.below(2) == 0);
    for effect in Effect::CATALOGUE.iter().filter(|_| random.below(2) == 0).collect::<Vec<_>>() {
        let without = options.effects;
        for parameter in effect.row().parameters {
            options.effects.set(*effect, parameter.key, any_in_range(random, parameter)).unwrap();
        }
        // Friction that no cable can have is refused.
        if CableParams::new(&options).is_err() {
            options.effects = without;
        }
    }
    options
}

/// A parameter of an effect, at an end of its range or within, that a cable with any μ up to 0.3 can have.
fn any_in_range(random: &mut Random, row: &ParameterRow) -> f64 {
    let (least, greatest) = match row.key {
        // A number, which the first pulley has.
        "pulley" => return 1.0,
        "ratio" => (row.min, 1.0),
        "coulomb_ratio" => (-0.45, 0.45),
        // In a cycle of a millisecond.
        "delay_s" => (-0.02, 0.063),
        _ => (row.min, row.max),
    };
    match random.below(4) {
        0 => least,
        1 => greatest,
        2 if least > 0.0 => least * (greatest / least).powf(random.unit()),
        _ => random.range(least, greatest),
    }
}

fn assert_finite<const CABLES: usize>(output: &CycleOutput<CABLES>) {
    for cable in &output.cables {
        for value in [cable.force_at_platform_n, cable.friction_n, cable.frictionless_n] {
            assert!(value.is_finite(), "{cable:?}");
        }
    }
    for wrench in [output.outside_wrench, output.applied_wrench].into_iter().flatten() {
        assert!(wrench.to_vector().iter().all(|part| part.is_finite()), "{wrench:?}");
    }
}

/// A number of any bits, of a size that occurs, or one that is special.
fn any_number(random: &mut Random) -> f64 {
    match random.below(8) {
        0..=1 => f64::from_bits(random.bits()),
        2 => [0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN_POSITIVE, 5e-324]
            [usize::try_from(random.below(8)).unwrap()],
        3 => 10_f64.powf(random.range(-12.0, 10.0)),
        4 => -(10_f64.powf(random.range(-12.0, 10.0))),
        5 => [1e9, -1e9, 1e6, -1e6][usize::try_from(random.below(4)).unwrap()],
        _ => random.range(-20.0, 20.0),
    }
}

fn any_pose(random: &mut Random) -> Option<Pose> {
    match random.below(4) {
        0 => None,
        1 => Some(random.pose(0.3)),
        2 => Some(Pose { position_m: [(); 3].map(|()| any_number(random)).into(), ..random.pose(0.3) }),
        _ => {
            let [x, y, z, w] = [(); 4].map(|()| any_number(random));
            let orientation = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z));
            Some(Pose { orientation, ..random.pose(0.3) })
        }
    }
}

#[test]
fn every_output_is_finite_whatever_goes_in() {
    static GUIDE_AND_SWIVEL: [PulleyOptions; 2] = [WINCH[1], WINCH[2]];
    static SMALL_SENSOR: [PulleyOptions; 3] =
        [PulleyOptions::Fixed { wrap_rad: 1.0, sensor: true }, WINCH[1], WINCH[2]];
    for seed in 0..30 {
        let mut random = Random::new(seed);
        let options: Vec<_> = (0..6)
            .map(|cable| demanding(&mut random, [&WINCH as &[_], &GUIDE_AND_SWIVEL, &SMALL_SENSOR][cable % 3]))
            .collect();
        let length_jump_m = [1e-9, 0.01, 1e3][usize::try_from(seed % 3).unwrap()];
        let length_noise_m = [0.0, f64::min(1e-5, 0.1 * length_jump_m)][usize::try_from(seed % 2).unwrap()];
        let monitor = MonitorOptions { frozen_cycles: 3, length_jump_m, length_noise_m, sensor_jump_n: Some(1e10) };
        let mut compensator = compensator::<7>(&options, monitor);
        for cycle in 0..600 {
            let mut input = smooth_input::<7>(cycle);
            if random.below(3) > 0 {
                for cable in &mut input.cables {
                    for value in [&mut cable.sensor_force_n, &mut cable.length_m, &mut cable.speed_m_per_s] {
                        if random.below(3) == 0 {
                            *value = any_number(&mut random);
                        }
                    }
                }
                input.pose = any_pose(&mut random);
            }
            assert_finite(&compensator.step(&input));
            for cable in 0..7 {
                assert!(
                    compensator.pulley_friction_n(cable).iter().all(|friction_n| friction_n.is_finite()),
                    "seed {seed}, cycle {cycle}"
                );
            }
        }
        // And it comes back by itself: good signals, and the friction is a friction again.
        for cycle in 0..3000 {
            let output = compensator.step(&smooth_input::<7>(cycle));
            assert_finite(&output);
            if cycle > 2500 {
                for (cable, options) in output.cables.iter().zip(&options) {
                    let allowed =
                        CableStatus::SLACK | CableStatus::SLIP | CableStatus::LENGTH_JUMP | CableStatus::UNSETTLED;
                    assert!(allowed.contains(cable.status), "{}", cable.status);
                    // What is added at the ends of these ranges is beyond any friction.
                    let added =
                        |effect: &Effect| effect.kind().starts_with("sensor_") || *effect == Effect::PulleyInertia;
                    let acts = |effect: &&Effect| {
                        let mut parameters = effect.row().parameters.iter();
                        parameters.any(|of| options.effects.get(**effect, of.key) != Some(of.neutral))
                    };
                    if Effect::CATALOGUE.iter().filter(acts).any(added) {
                        continue;
                    }
                    let drag_n = 3.0 * options.effects.get(Effect::BearingDrag, "drag_n").unwrap();
                    let viscous_n = 3.0 * options.friction.viscous_n_s_per_m * 0.1;
                    assert!(cable.friction_n.abs() < 1e3 + 1e2 * (viscous_n + drag_n), "seed {seed}: {cable:?}");
                }
            }
        }
    }
}

#[test]
fn exact_zeros_of_tension_leave_no_trace() {
    // Viscous friction that cancels the tension to the last bit, with a slip limit: 0/0 lies in wait.
    for presliding in FORMS {
        let pulleys = [crate::support::GUIDE_90; 3];
        let friction = FrictionOptions { mu: 0.1, sigma_n_per_m: Some(1e3), viscous_n_s_per_m: 10.0, offset_n: 0.0 };
        let options = CableOptions { presliding, friction, traction_mu: Some(0.2), ..CableOptions::new(&pulleys) };
        let mut compensator = compensator::<1>(&[options], UNMONITORED);
        let mut step = |length_m: f64, speed_m_per_s: f64| {
            let cables = [CableInput { sensor_force_n: 10.0, length_m, speed_m_per_s }];
            compensator.step(&CycleInput { cables, ..CycleInput::default() })
        };
        for cycle in 0..100 {
            assert_finite(&step(0.0, -1.0));
            assert_finite(&step(f64::from(cycle) * 1e-3, -1.0));
        }
        for cycle in 0..100 {
            let output = step(f64::from(cycle) * 1e-3, 0.1);
            assert_finite(&output);
            if cycle > 50 {
                assert!(output.cables[0].force_at_platform_n > 10.0, "{presliding:?} {output:?}");
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Fault {
    Sensor(f64),
    Length(f64),
    Speed(f64),
    Jump,
    Frozen,
    Slack,
}

const FAULTS: [Fault; 11] = [
    Fault::Sensor(f64::NAN),
    Fault::Sensor(f64::INFINITY),
    Fault::Sensor(-1e300),
    Fault::Length(f64::NAN),
    Fault::Length(f64::NEG_INFINITY),
    Fault::Speed(f64::NAN),
    Fault::Speed(1e300),
    Fault::Jump,
    Fault::Frozen,
    Fault::Slack,
    Fault::Sensor(1e9),
];

fn spoil(input: &mut CableInput, fault: Fault) {
    match fault {
        Fault::Sensor(value) => input.sensor_force_n = value,
        Fault::Length(value) => input.length_m = value,
        Fault::Speed(value) => input.speed_m_per_s = value,
        Fault::Jump => input.length_m += 5.0,
        Fault::Frozen => input.sensor_force_n = 13.25,
        Fault::Slack => input.sensor_force_n = -0.5,
    }
}

#[test]
fn a_bad_cable_leaves_the_others_bit_for_bit() {
    for presliding in FORMS {
        for bad in [0, 2, 5] {
            for fault in FAULTS {
                let options: Vec<_> = (0..6)
                    .map(|index| CableOptions { traction_mu: Some(0.1), ..corner_cable(index, presliding) })
                    .collect();
                let monitor = MonitorOptions {
                    frozen_cycles: 10,
                    length_jump_m: 0.01,
                    length_noise_m: 0.0,
                    sensor_jump_n: Some(1e10),
                };
                let (mut good, mut spoilt) = (compensator::<6>(&options, monitor), compensator::<6>(&options, monitor));
                let mut differed = false;
                for cycle in 0..400 {
                    let mut input = smooth_input::<6>(cycle);
                    let one = good.step(&input);
                    if (100..200).contains(&cycle) || cycle == 300 {
                        spoil(&mut input.cables[bad], fault);
                    }
                    let other = spoilt.step(&input);
                    for cable in (0..6).filter(|cable| *cable != bad) {
                        assert_eq!(bits(&one.cables[cable]), bits(&other.cables[cable]), "{fault:?}");
                    }
                    differed |= bits(&one.cables[bad]) != bits(&other.cables[bad]);
                }
                assert!(differed, "{fault:?} did nothing");
            }
        }
    }
}

/// A closed path: reversals at drawn places, in fine steps, back to its start.
fn closed_path(turns_m: &[f64]) -> Vec<f64> {
    let mut path = Vec::new();
    let mut from = 0.0;
    for to in turns_m.iter().copied().chain([0.0]) {
        path.extend((1..=20).map(|step| from + (to - from) * f64::from(step) / 20.0));
        from = to;
    }
    path
}

fn drive(compensator: &mut Compensator<1>, length_m: f64, speed_m_per_s: f64) -> f64 {
    let cables = [CableInput { sensor_force_n: 20.0, length_m, speed_m_per_s }];
    let output = compensator.step(&CycleInput { cables, ..CycleInput::default() });
    assert!(output.cables[0].status.is_ok());
    output.cables[0].friction_n
}

proptest! {
    #![proptest_config(config(25))]

    #[test]
    fn friction_only_dissipates(
        turns in prop::collection::vec(-0.005..0.005_f64, 1..12), mu in 0.0..0.2_f64, sigma in 100.0..1e4_f64,
        viscous in 0.0..2.0_f64, lumped in any::<bool>(),
    ) {
        let pulleys = [crate::support::SENSOR_180, crate::support::GUIDE_90, crate::support::GUIDE_90];
        let friction = FrictionOptions { mu, sigma_n_per_m: Some(sigma), viscous_n_s_per_m: viscous, offset_n: 0.0 };
        let options = CableOptions { presliding: FORMS[usize::from(!lumped)], friction, ..CableOptions::new(&pulleys) };
        let mut compensator = compensator::<1>(&[options], UNMONITORED);
        let path = closed_path(&turns);
        let mut length_m = 0.0;
        drive(&mut compensator, 0.0, 0.0);
        for round in 0..60 {
            let before = compensator.pulley_friction_n(0);
            let mut work_j = 0.0;
            for next_m in &path {
                let moved_m = next_m - length_m;
                length_m = *next_m;
                work_j += drive(&mut compensator, length_m, moved_m / 0.001) * moved_m;
            }
            let start_n = drive(&mut compensator, length_m, 0.0);
            let again = compensator.pulley_friction_n(0);
            let settled = before.iter().zip(&again).all(|(one, other)| (one - other).abs() < 1e-13);
            if round > 5 && settled {
                prop_assert!(work_j >= -1e-12, "{work_j} J from {start_n} N");
            }
        }
    }

    #[test]
    fn the_two_directions_mirror_each_other_without_load_dependence(
        moves in prop::collection::vec(-1e-3..1e-3_f64, 1..100), sliding_n in 0.01..5.0_f64,
    ) {
        let (mut one, mut other) = (0.0, 0.0);
        for displacement_m in moves {
            one = fric_core::dahl::dahl_step(one, sliding_n, 950.0, displacement_m);
            other = fric_core::dahl::dahl_step(other, sliding_n, 950.0, -displacement_m);
            prop_assert_eq!(one, -other);
        }
    }

    #[test]
    fn stored_friction_never_exceeds_what_sliding_gives(
        moves in prop::collection::vec(-0.002..0.002_f64, 1..300), mu in 0.0..0.5_f64, lumped in any::<bool>(),
    ) {
        let pulleys = [crate::support::GUIDE_90];
        let friction = FrictionOptions { mu, sigma_n_per_m: Some(950.0), viscous_n_s_per_m: 0.0, offset_n: 0.0 };
        let options = CableOptions { presliding: FORMS[usize::from(!lumped)], friction, ..CableOptions::new(&pulleys) };
        let mut compensator = compensator::<1>(&[options], UNMONITORED);
        let mut length_m = 0.0;
        drive(&mut compensator, 0.0, 0.0);
        // [P] 10 both ways: the greater of the two frictions bounds whatever happens between.
        let half = 0.5 * mu * 2_f64.sqrt();
        let bound_n = 20.0 * ((1.0 + half) / (1.0 - half) - 1.0);
        for displacement_m in moves {
            length_m += displacement_m;
            prop_assert!(drive(&mut compensator, length_m, 0.0).abs() <= bound_n * (1.0 + 1e-12));
        }
    }

    #[test]
    fn any_bits_of_one_cycle_give_finite_numbers(numbers in prop::array::uniform32(any::<u64>()), lumped in any::<bool>(), posed in any::<bool>()) {
        let numbers = numbers.map(f64::from_bits);
        let options: Vec<_> = (0..8).map(|index| corner_cable(index, FORMS[usize::from(!lumped)])).collect();
        let mut compensator = compensator::<8>(&options, UNMONITORED);
        for cycle in 0..5 {
            let mut input = smooth_input::<8>(cycle);
            if cycle % 2 == 1 {
                for (cable, part) in input.cables.iter_mut().zip(numbers.as_chunks::<3>().0) {
                    *cable = CableInput { sensor_force_n: part[0], length_m: part[1], speed_m_per_s: part[2] };
                }
                let quaternion = nalgebra::Quaternion::new(numbers[24], numbers[25], numbers[26], numbers[27]);
                let orientation = nalgebra::UnitQuaternion::new_unchecked(quaternion);
                input.pose = posed.then(|| Pose { position_m: [numbers[28], numbers[29], numbers[30]].into(), orientation });
            }
            assert_finite(&compensator.step(&input));
        }
    }
}

/// A cable outside the compensator: its group, what its signals left, and the wrap of its last pulley.
type Outside<T> = (CableGroup<T>, SignalState<f64>, PoseWrap);

#[test]
fn cables_outside_the_compensator_have_its_bits_alone_and_in_lanes() {
    static GUIDE_AND_SWIVEL: [PulleyOptions; 2] = [WINCH[1], WINCH[2]];
    for seed in 0..30 {
        let mut random = Random::new(seed);
        let options: Vec<_> = (0..3)
            .map(|cable| demanding(&mut random, [&WINCH as &[_], &GUIDE_AND_SWIVEL, &WINCH][cable % 3]))
            .collect();
        let monitor =
            MonitorOptions { frozen_cycles: 3, length_jump_m: 0.01, length_noise_m: 1e-6, sensor_jump_n: Some(1e10) };
        let mut compensator = compensator::<3>(&options, monitor);
        let params: Vec<_> = options.iter().map(|options| CableParams::new(options).unwrap()).collect();
        // Cables that have their numbers from elsewhere, as a fit gives them: their own friction does not show.
        let frictionless = |options: &CableOptions<'static>| {
            let (friction, effects) = (FrictionOptions::default(), EffectParams::NEUTRAL);
            CableParams::new(&CableOptions { friction, effects, ..*options }).unwrap()
        };
        let frictionless: Vec<_> = options.iter().map(frictionless).collect();
        let outside = |(frictionless, params): (&CableParams, &CableParams)| -> Outside<f64> {
            let group = CableGroup::new(&[frictionless], &params.values(), 0.001, |_| false).unwrap();
            (group, SignalState::start(), PoseWrap::START)
        };
        let mut alone: Vec<_> = frictionless.iter().zip(&params).map(outside).collect();
        let values = std::array::from_fn(|place| Lanes::from_lanes(|lane| params[lane.min(2)].values()[place]));
        let all: Vec<&CableParams> = frictionless.iter().collect();
        let mut together = CableGroup::new(&all, &values, 0.001, |_| false).unwrap();
        let mut count = BEFORE_FIRST;
        for cycle in 0..400 {
            let mut input = smooth_input::<3>(cycle);
            count = next_cycle(count, input.elapsed_cycles);
            if random.below(4) == 0 {
                let cable = &mut input.cables[usize::try_from(random.below(3)).unwrap()];
                cable.sensor_force_n = any_number(&mut random);
                cable.length_m = any_number(&mut random);
            }
            input.pose = any_pose(&mut random);
            let output = compensator.step(&input);
            let pose = input.pose.filter(Pose::is_usable);
            let mut conditioned = Vec::new();
            for ((params, (group, signals, pose_wrap)), raw) in params.iter().zip(&mut alone).zip(&input.cables) {
                let CableInput { sensor_force_n, length_m, speed_m_per_s } = *raw;
                let raw = RawSignals { sensor_force_n, length_m, speed_m_per_s };
                let signals = condition(&monitor.limits(), signals, &raw, input.elapsed_cycles);
                *pose_wrap = pose.and_then(|pose| PoseWrap::at(params, &pose)).unwrap_or(*pose_wrap);
                let pose_wrap = *pose_wrap;
                let force_n =
                    group.step(|_| CableCycle { signals: &signals, pose_wrap, cycle: count }).platform_force_n;
                conditioned.push((signals, pose_wrap, force_n));
            }
            let lanes = together.step(|lane| {
                let (signals, pose_wrap, _) = &conditioned[lane.min(2)];
                CableCycle { signals, pose_wrap: *pose_wrap, cycle: count }
            });
            for (lane, (expected, (.., force_n))) in output.cables.iter().zip(&conditioned).enumerate() {
                assert_eq!(force_n.to_bits(), expected.force_at_platform_n.to_bits());
                assert_eq!(lanes.platform_force_n.lane(lane).to_bits(), expected.force_at_platform_n.to_bits());
                assert_eq!(lanes.friction_n.lane(lane).to_bits(), expected.friction_n.to_bits());
            }
        }
    }
}
