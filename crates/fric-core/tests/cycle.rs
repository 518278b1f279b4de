//! The cycle's lanes against the slow oracle, and its state as a value.

use fric_core::effects::Effect;
use fric_core::robot::{CableOptions, FrictionOptions, GeometryOptions, Presliding, PulleyOptions};
use fric_core::{CableInput, Compensator, CycleInput, CycleOutput, Pose};

use crate::bits::bits;
use crate::oracle::{Cable, Effects, Geometry, Memory, outside_wrench};
use crate::random::Random;
use crate::support::{UNMONITORED, assert_near, compensator, corner_cable, corner_robot, smooth_input};

/// A cable with drawn parameters, as options and as oracle.
fn draw(
    random: &mut Random,
    presliding: Presliding,
    pulleys: &mut [PulleyOptions; 3],
) -> (CableOptions<'static>, Cable) {
    let sensor_pulley = random.below(4) != 0;
    let sensor_wrap_rad =
        [std::f64::consts::PI, std::f64::consts::FRAC_PI_2, 1.0, 4.0][usize::try_from(random.below(4)).unwrap()];
    let guide_rad = random.range(0.2, 5.0);
    let (radius_m, axis) = (random.range(0.0, 0.03), random.unit_vector());
    *pulleys = [
        PulleyOptions::Fixed { wrap_rad: sensor_wrap_rad, sensor: sensor_pulley },
        PulleyOptions::Fixed { wrap_rad: guide_rad, sensor: false },
        PulleyOptions::Swivel { radius_m, axis },
    ];
    let friction = FrictionOptions {
        mu: random.range(0.0, 0.1),
        sigma_n_per_m: Some(10_f64.powf(random.range(2.0, 4.0))),
        viscous_n_s_per_m: random.range(0.0, 2.0),
        offset_n: random.range(-0.5, 0.5),
    };
    let base_m = [0.6, 0.5, 0.7].map(|size| size * [-1.0, 1.0][usize::from(random.below(2) == 1)]);
    let platform_m = random.vector(0.08);
    let stribeck = (random.below(3) == 0).then(|| (random.range(-0.5, 1.0), random.range(0.01, 0.1)));
    let mut options = CableOptions {
        presliding,
        friction,
        geometry: Some(GeometryOptions { base_m, platform_m }),
        ..CableOptions::new(&[])
    };
    if let Some((ratio, velocity_m_per_s)) = stribeck {
        options.effects.set(Effect::Stribeck, "ratio", ratio).unwrap();
        options.effects.set(Effect::Stribeck, "velocity_m_per_s", velocity_m_per_s).unwrap();
    }
    let effects = if random.below(2) == 0 { draw_effects(random, presliding, &mut options) } else { Effects::NONE };
    let oracle = Cable {
        lumped: presliding == Presliding::Lumped,
        wraps_rad: vec![Some(sensor_wrap_rad), Some(guide_rad), None],
        sensor_pulley,
        mu: friction.mu,
        sigma_n_per_m: friction.sigma_n_per_m.unwrap(),
        viscous: friction.viscous_n_s_per_m,
        offset_n: friction.offset_n,
        stribeck,
        effects,
        memory: Memory::default(),
        geometry: Geometry { base_m, platform_m, axis, radius_m },
        length_m: None,
        stored_n: vec![0.0; 3],
    };
    (options, oracle)
}

/// Effects of every kind at once, sometimes a few of them; so that no bound of the cycle is met.
fn draw_effects(random: &mut Random, presliding: Presliding, options: &mut CableOptions<'_>) -> Effects {
    let mut effects = Effects::NONE;
    let all = random.below(2) == 0;
    let mut set = |effect: Effect, random: &mut Random, parameters: &mut [(&str, &mut f64, f64, f64)]| {
        if !all && random.below(2) == 0 {
            return;
        }
        for (key, value, least, greatest) in parameters {
            **value = random.range(*least, *greatest);
            options.effects.set(effect, key, **value).unwrap();
        }
    };
    let of = &mut effects;
    let direction =
        &mut [("coulomb_ratio", &mut of.coulomb_ratio, -0.2, 0.2), ("viscous_ratio", &mut of.viscous_ratio, -0.9, 0.9)];
    set(Effect::DirectionAsymmetry, random, direction);
    set(Effect::BearingDrag, random, &mut [("drag_n", &mut of.drag_n, 0.0, 0.3)]);
    if presliding == Presliding::PerPulley {
        let load = &mut [
            ("exponent", &mut of.load_exponent, 0.85, 1.15),
            ("reference_n", &mut of.load_reference_n, 5.0, 30.0),
        ];
        set(Effect::LoadNonlinearity, random, load);
    }
    set(Effect::FrictionDrift, random, &mut [("rate_per_s", &mut of.drift_per_s, -0.3, 0.3)]);
    set(Effect::PreslidingShape, random, &mut [("exponent", &mut of.dahl_exponent, 0.3, 3.0)]);
    set(Effect::SensorGain, random, &mut [("gain", &mut of.gain, 0.9, 1.1)]);
    set(Effect::SensorOffset, random, &mut [("offset_n", &mut of.sensor_offset_n, -0.5, 0.5)]);
    set(Effect::SensorDrift, random, &mut [("rate_n_per_s", &mut of.sensor_drift_n_per_s, -0.5, 0.5)]);
    let inertia = &mut [("mass_kg", &mut of.mass_kg, 0.0, 0.01), ("window_s", &mut of.mass_window_s, 0.002, 0.01)];
    set(Effect::PulleyInertia, random, inertia);
    let [one, other] = &mut of.ripples;
    for (effect, [sin, cos, period_m], longest_m) in
        [(Effect::PulleyEccentricity, one, 0.3), (Effect::PulleyEccentricity2, other, 0.025)]
    {
        let periods = ("period_m", period_m, 0.1 * longest_m, longest_m);
        set(effect, random, &mut [("sin_ratio", sin, -0.05, 0.05), ("cos_ratio", cos, -0.05, 0.05), periods]);
    }
    let stretch = &mut [
        ("compliance_m_per_n", &mut of.compliance_m_per_n, 0.0, 1e-4),
        ("play_n", &mut of.stretch_play_n, 0.0, 0.1),
    ];
    set(Effect::CableElasticity, random, stretch);
    effects
}

/// `forms`: presliding of cable `i` is `forms[i % forms.len()]`.
fn compare<const CABLES: usize>(seed: u64, forms: &[Presliding]) {
    let mut random = Random::new(seed);
    let mut lists = [[PulleyOptions::Fixed { wrap_rad: 0.0, sensor: false }; 3]; CABLES];
    let drawn: Vec<_> =
        lists.iter_mut().enumerate().map(|(index, list)| draw(&mut random, forms[index % forms.len()], list)).collect();
    let options: Vec<_> =
        drawn.iter().zip(&lists).map(|((options, _), list)| CableOptions { pulleys: list, ..*options }).collect();
    let mut oracles: Vec<Cable> = drawn.into_iter().map(|(_, oracle)| oracle).collect();
    let mut compensator = compensator::<CABLES>(&options, UNMONITORED);
    let phases: [f64; CABLES] = core::array::from_fn(|_| random.range(0.0, 6.0));
    for cycle in 0..800 {
        let t = f64::from(cycle) * 0.001;
        let pose = Pose::from_parts(
            [0.1 * (5.0 * t).sin(), 0.1 * (7.0 * t).cos(), 0.1 * (3.0 * t).sin()],
            [0.1 * t, -0.2 * t, 0.0, (1.0 - 0.05 * t * t).sqrt()],
        )
        .unwrap();
        let cables = core::array::from_fn(|cable| {
            let angle = 11.0 * t + phases[cable];
            // Rests now and then, to see that rest keeps the state.
            let still = cycle % 50 < 5;
            let held_angle = if still { 11.0 * (f64::from(cycle - cycle % 50) * 0.001) + phases[cable] } else { angle };
            CableInput {
                sensor_force_n: 20.0 + 5.0 * (9.0 * t + phases[cable]).cos(),
                length_m: 1.0 + 0.02 * held_angle.sin(),
                speed_m_per_s: if still { 0.0 } else { 0.22 * angle.cos() },
            }
        });
        let output = compensator.step(&CycleInput { cables, pose: Some(pose), ..CycleInput::default() });
        let mut columns = Vec::new();
        let mut forces_n = Vec::new();
        for ((oracle, input), ours) in oracles.iter_mut().zip(&cables).zip(&output.cables) {
            let arm_m: [f64; 3] = (pose.orientation * nalgebra::Vector3::from(oracle.geometry.platform_m)).into();
            let position_m: [f64; 3] = pose.position_m.into();
            let attachment_m = crate::support::add(position_m, arm_m);
            let expected_n = oracle.step(input.sensor_force_n, input.length_m, input.speed_m_per_s, attachment_m);
            assert!(ours.status.is_ok(), "{}", ours.status);
            assert_near(ours.force_at_platform_n, expected_n, 1e-10);
            let friction_n = expected_n - oracle.offset_n - ours.frictionless_n;
            assert_near(ours.friction_n, friction_n, 1e-10);
            columns.push((oracle.geometry.exit(attachment_m).direction, arm_m));
            forces_n.push(expected_n);
        }
        let (force, torque) = outside_wrench(&columns, &forces_n);
        let outside = output.outside_wrench.unwrap();
        for (one, other) in outside.to_vector().iter().zip(force.into_iter().chain(torque)) {
            assert_near(*one, other, 1e-10);
        }
    }
}

macro_rules! cable_counts {
    ($($count:literal),*) => {
        #[test]
        fn every_cable_count_agrees_with_the_oracle() {
            let (lumped, per_pulley) = (Presliding::Lumped, Presliding::PerPulley);
            $(
                compare::<$count>(100 + $count, &[lumped]);
                compare::<$count>(200 + $count, &[per_pulley]);
                compare::<$count>(300 + $count, &[per_pulley, lumped, lumped]);
            )*
        }
    };
}
cable_counts!(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17);

/// Runs a robot and gives all its output bits.
fn run<const CABLES: usize>(
    compensator: &mut Compensator<CABLES>,
    cycles: std::ops::Range<usize>,
) -> Vec<CycleOutput<CABLES>> {
    cycles.map(|cycle| compensator.step(&smooth_input(cycle))).collect()
}

#[test]
fn snapshots_of_a_robot_with_room_for_more_cables_compare() {
    let cables: Vec<_> = (0..3).map(|index| corner_cable(index, Presliding::PerPulley)).collect();
    let mut robot = compensator::<8>(&cables, UNMONITORED);
    let start = robot.snapshot();
    assert_eq!(robot.snapshot(), start);
    run(&mut robot, 0..100);
    let snapshot = robot.snapshot();
    assert_ne!(snapshot, start);
    run(&mut robot, 100..200);
    assert_ne!(robot.snapshot(), snapshot);
    robot.restore(&snapshot);
    assert_eq!(robot.snapshot(), snapshot);
    robot.reset();
    assert_eq!(robot.snapshot(), start);
}

#[test]
fn a_snapshot_goes_on_bit_for_bit_and_reset_is_new() {
    for presliding in [Presliding::Lumped, Presliding::PerPulley] {
        let mut compensator = corner_robot::<5>(presliding, UNMONITORED);
        let first = run(&mut compensator, 0..400);
        let snapshot = compensator.snapshot();
        let onward = run(&mut compensator, 400..800);
        compensator.restore(&snapshot);
        assert_eq!(compensator.snapshot(), snapshot);
        assert_eq!(run(&mut compensator, 400..800), onward);
        let mut other = corner_robot::<5>(presliding, UNMONITORED);
        other.restore(&snapshot);
        assert_eq!(run(&mut other, 400..800), onward);
        compensator.reset();
        assert_eq!(run(&mut compensator, 0..400), first);
    }
}

#[test]
fn replaying_gives_the_same_bits() {
    let outputs = [(); 2].map(|()| run(&mut corner_robot::<8>(Presliding::PerPulley, UNMONITORED), 0..1000));
    for (one, other) in outputs[0].iter().zip(&outputs[1]) {
        assert_eq!(one.cables.map(|cable| bits(&cable)), other.cables.map(|cable| bits(&cable)));
    }
}

#[test]
fn the_number_of_places_does_not_change_a_bit() {
    // The same five cables in a compensator of 5, 8 and 17: whole blocks, tails, and lanes without a cable.
    let options: Vec<_> = (0..5).map(|index| crate::support::corner_cable(index, Presliding::PerPulley)).collect();
    let (mut five, mut eight, mut more) = (
        compensator::<5>(&options, UNMONITORED),
        compensator::<8>(&options, UNMONITORED),
        compensator::<17>(&options, UNMONITORED),
    );
    for cycle in 0..500 {
        let (a, mut b) = (five.step(&smooth_input(cycle)), smooth_input::<8>(cycle));
        // Entries past the robot's cables are not looked at.
        b.cables[6].sensor_force_n = f64::NAN;
        b.cables[5].length_m = f64::INFINITY;
        let (b, c) = (eight.step(&b), more.step(&smooth_input(cycle)));
        for cable in 0..5 {
            assert_eq!(bits(&a.cables[cable]), bits(&b.cables[cable]));
            assert_eq!(bits(&a.cables[cable]), bits(&c.cables[cable]));
        }
        assert_eq!(a.outside_wrench, b.outside_wrench);
        assert_eq!(a.outside_wrench, c.outside_wrench);
    }
}

#[test]
fn an_output_that_is_used_again_is_written_in_full() {
    let options: Vec<_> = (0..5).map(|index| crate::support::corner_cable(index, Presliding::PerPulley)).collect();
    let (mut one, mut other) = (compensator::<8>(&options, UNMONITORED), compensator::<8>(&options, UNMONITORED));
    let mut output = CycleOutput::<8>::default();
    for cable in &mut output.cables {
        cable.force_at_platform_n = f64::NAN;
    }
    other.step_into(&smooth_input(0), &mut output);
    assert_eq!(one.step(&smooth_input(0)), output);
}

#[test]
fn more_cables_than_places_are_refused() {
    let options: Vec<_> = (0..5).map(|index| crate::support::corner_cable(index, Presliding::PerPulley)).collect();
    let cables = crate::support::checked(&options);
    let robot = fric_core::RobotParams::new(0.001, &crate::support::platform(), UNMONITORED, &cables).unwrap();
    let error = Compensator::<4>::new(&robot).unwrap_err();
    assert_eq!(error.to_string(), "`cable` has 5 entries; allowed is 1 to 4");
    assert_eq!(Compensator::<8>::new(&robot).unwrap().cable_count(), 5);
}

#[test]
fn the_friction_distribution_adds_up_to_the_friction() {
    let mut compensator = corner_robot::<3>(Presliding::PerPulley, UNMONITORED);
    for cycle in 0..600 {
        let mut input = smooth_input::<3>(cycle);
        for cable in &mut input.cables {
            cable.speed_m_per_s = 0.0;
        }
        let output = compensator.step(&input);
        for (cable, output) in output.cables.iter().enumerate() {
            let stored_n = compensator.pulley_friction_n(cable);
            // Behind a sensor pulley of 180° only half of its friction shows: F_1 = (F_s + f_1)/2.
            assert_near(output.friction_n, 0.5 * stored_n[0] + stored_n[1..].iter().sum::<f64>(), 1e-12);
            assert!(stored_n[3..].iter().all(|friction_n| *friction_n == 0.0));
        }
    }
    assert!(compensator.pulley_friction_n(3).iter().all(|friction_n| *friction_n == 0.0));
}

#[test]
fn a_cable_is_the_same_alone_and_among_cables_of_other_lengths() {
    let (one, two, three) =
        ([crate::support::SWIVEL], [crate::support::SENSOR_180, crate::support::SWIVEL], crate::support::WINCH);
    let (fixed, many) = ([crate::support::SENSOR_180], [crate::support::GUIDE_90; 5]);
    let lists: [&[PulleyOptions]; 5] = [&one, &two, &three, &fixed, &many];
    for presliding in [Presliding::Lumped, Presliding::PerPulley] {
        for traction_mu in [None, Some(0.01)] {
            let corner = |cable: usize| crate::support::corner_cable(cable, presliding);
            let options: Vec<_> =
                (0..5).map(|cable| CableOptions { pulleys: lists[cable], traction_mu, ..corner(cable) }).collect();
            let mut together = compensator::<5>(&options, UNMONITORED);
            let mut alone: Vec<_> = options.iter().map(|options| compensator::<1>(&[*options], UNMONITORED)).collect();
            for cycle in 0..600 {
                let input = smooth_input::<5>(cycle);
                let output = together.step(&input);
                for (cable, alone) in alone.iter_mut().enumerate() {
                    let own = alone.step(&CycleInput {
                        cables: [input.cables[cable]],
                        pose: input.pose,
                        elapsed_cycles: 1.0,
                    });
                    assert_eq!(bits(&own.cables[0]), bits(&output.cables[cable]), "cable {cable}");
                    assert_eq!(alone.pulley_friction_n(0), together.pulley_friction_n(cable));
                    let used = alone.pulley_friction_n(0).iter().filter(|friction_n| **friction_n != 0.0).count();
                    assert!(cycle < 10 || presliding == Presliding::Lumped || used == lists[cable].len());
                }
            }
        }
    }
}
