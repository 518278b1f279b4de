//! A change of parameters against two compensators that know nothing of it.

use fric_core::effects::{Effect, EffectParams};
use fric_core::robot::{
    CableOptions, FrictionOptions, GeometryOptions, MonitorOptions, PlatformOptions, Presliding, PulleyOptions,
};
use fric_core::{AnyCompensator, CableParams, CableStatus, RobotParams, SendError};
use fric_core::{
    CableInput, CableOutput, Compensator, CycleInput, CycleOutput, Pose, TunableCompensator, Wrench, parameter_exchange,
};

use crate::oracle::Geometry;
use crate::support::{FRICTION, compensator, corner_cable, smooth_input};

const CABLES: usize = 5;
const BLEND_CYCLES: u32 = 40;
const MONITOR: MonitorOptions =
    MonitorOptions { frozen_cycles: 10, length_jump_m: 0.01, length_noise_m: 0.0, sensor_jump_n: None };

fn options(mu: f64, sigma_n_per_m: f64, offset_n: f64) -> [CableOptions<'static>; CABLES] {
    core::array::from_fn(|index| CableOptions {
        friction: FrictionOptions { mu, sigma_n_per_m: Some(sigma_n_per_m), viscous_n_s_per_m: 0.3, offset_n },
        ..corner_cable(index, if index % 2 == 0 { Presliding::PerPulley } else { Presliding::Lumped })
    })
}

fn old() -> Compensator<CABLES> {
    compensator(&options(0.02, 1000.0, 0.0), MONITOR)
}

fn new() -> Compensator<CABLES> {
    compensator(&options(0.04, 700.0, 0.2), MONITOR)
}

/// To and fro by centimetres, each cable in its own rhythm; one cable's sensor is silent now and then.
fn input(cycle: u32) -> CycleInput<CABLES> {
    let t = f64::from(cycle) * 1e-3;
    let cables = core::array::from_fn(|cable| {
        let rate = [9.0, 11.0, 13.0, 15.0, 17.0][cable];
        let silent = cable == 3 && cycle % 50 < 5;
        CableInput {
            sensor_force_n: if silent { f64::NAN } else { 20.0 + (3.0 * rate * t).sin() },
            length_m: 0.02 * (rate * t).cos(),
            speed_m_per_s: -0.02 * rate * (rate * t).sin(),
        }
    });
    let pose = Pose::from_parts([0.1, 0.05 * t.sin(), -0.1], [0.0, 0.0, 0.0, 1.0]);
    CycleInput { cables, pose, ..CycleInput::default() }
}

/// Every number of an output.
fn numbers(output: &CycleOutput<CABLES>) -> Vec<f64> {
    let of_cable = |cable: &CableOutput| [cable.force_at_platform_n, cable.friction_n, cable.frictionless_n];
    let of_wrench =
        |wrench: &Option<Wrench>| wrench.unwrap_or_default().to_vector().iter().copied().collect::<Vec<_>>();
    let wrenches = [of_wrench(&output.outside_wrench), of_wrench(&output.applied_wrench)].concat();
    output.cables.iter().flat_map(of_cable).chain(wrenches).collect()
}

#[test]
fn the_output_goes_over_without_a_step() {
    for change_at in [1, 137, 300, 731] {
        let (mut tunable, mut old) = (TunableCompensator::new(old()), old());
        let mut output = CycleOutput::default();
        for cycle in 0..change_at {
            tunable.step_into(&input(cycle), &mut output);
            assert_eq!(output, old.step(&input(cycle)));
        }
        let mut new = new();
        tunable.change(&new, BLEND_CYCLES).unwrap();
        new.restore(&old.snapshot());
        let mut last = [numbers(&output), numbers(&output), numbers(&output)];
        let mut last_new = None;
        for done in 1..=BLEND_CYCLES {
            assert!(tunable.is_changing());
            let input = input(change_at + done - 1);
            tunable.step_into(&input, &mut output);
            let (of_old, of_new) = (old.step(&input), new.step(&input));
            let now = [numbers(&output), numbers(&of_old), numbers(&of_new)];
            for place in 0..now[0].len() {
                let [value, old, new] = [0, 1, 2].map(|which| now[which][place]);
                let share = f64::from(done) / f64::from(BLEND_CYCLES);
                assert!((value - (old + share * (new - old))).abs() < 1e-11, "cycle {done}: {value} of {old}, {new}");
                let change = |which: usize| (now[which][place] - last[which][place]).abs();
                // In the first cycle the new one has no cycle of its own before it.
                let steepest = change(1).max(if last_new.is_some() { change(2) } else { 0.0 });
                let bound = steepest + (new - old).abs() / f64::from(BLEND_CYCLES);
                assert!(change(0) <= bound + 1e-11, "cycle {done}: a step of {} where {bound} is allowed", change(0));
            }
            for ((cable, old), new) in output.cables.iter().zip(&of_old.cables).zip(&of_new.cables) {
                assert_eq!(cable.status, if done < BLEND_CYCLES { old.status | new.status } else { new.status });
            }
            last = now;
            last_new = Some(());
        }
        assert!(!tunable.is_changing());
        for cycle in change_at + BLEND_CYCLES..change_at + 1000 {
            tunable.step_into(&input(cycle), &mut output);
            assert_eq!(output, new.step(&input(cycle)));
        }
    }
}

/// The blend goes by time, so that an overslept loop does not prolong it.
#[test]
fn skipped_cycles_count_in_the_blend() {
    for (elapsed_cycles, counted) in [(5.0, 5.0), (2.5, 2.5), (0.0, 1.0), (f64::NAN, 1.0), (f64::INFINITY, 1e6)] {
        let (mut tunable, mut old, mut new) = (TunableCompensator::new(old()), old(), new());
        let mut output = CycleOutput::default();
        for cycle in 0..100 {
            tunable.step_into(&input(cycle), &mut output);
            old.step(&input(cycle));
        }
        tunable.change(&new, BLEND_CYCLES).unwrap();
        new.restore(&old.snapshot());
        let mut done = 0.0;
        for cycle in 100.. {
            let input = CycleInput { elapsed_cycles, ..input(cycle) };
            tunable.step_into(&input, &mut output);
            done += counted;
            let share = (done / f64::from(BLEND_CYCLES)).min(1.0);
            let values = [&output, &old.step(&input), &new.step(&input)].map(numbers);
            for ((value, old), new) in values[0].iter().zip(&values[1]).zip(&values[2]) {
                let expected = (1.0 - share) * old + share * new;
                assert!((value - expected).abs() < 1e-11, "{elapsed_cycles}, {done}: {value} of {old}, {new}");
            }
            assert_eq!(tunable.is_changing(), share < 1.0);
            if share >= 1.0 {
                break;
            }
        }
    }
}

#[test]
fn it_arrives_where_a_compensator_of_the_new_parameters_is() {
    let (mut tunable, mut built) = (TunableCompensator::new(old()), new());
    let mut output = CycleOutput::default();
    for cycle in 0..1500 {
        if cycle == 400 {
            tunable.change(&new(), BLEND_CYCLES).unwrap();
        }
        tunable.step_into(&input(cycle), &mut output);
        let expected = built.step(&input(cycle));
        let (ours, theirs) = (numbers(&output), numbers(&expected));
        let farthest = ours.iter().zip(&theirs).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
        assert!(!(10..400).contains(&cycle) || farthest > 1e-2, "the parameters make no difference: {farthest}");
        assert!(cycle < 1000 || farthest < 1e-9, "cycle {cycle}: {farthest}");
    }
}

#[test]
fn a_change_of_the_robot_is_refused_and_changes_nothing() {
    let mut tunable = TunableCompensator::new(old());
    let fewer = compensator::<CABLES>(&options(0.02, 1000.0, 0.0)[..4], MONITOR);
    let mut others = options(0.02, 1000.0, 0.0);
    others[2].geometry = None;
    others[2].pulleys = &[PulleyOptions::Fixed { wrap_rad: 3.0, sensor: true }];
    let other_pulleys = compensator::<CABLES>(&others, MONITOR);
    for (next, word) in [(&fewer, "`cable`"), (&other_pulleys, "`pulleys`")] {
        let error = tunable.change(next, 5).unwrap_err().to_string();
        assert!(error.starts_with(word), "{error}");
        assert!(!tunable.is_changing());
    }
    tunable.change(&new(), 100).unwrap();
    tunable.reset();
    let (mut output, mut fresh) = (CycleOutput::default(), new());
    tunable.step_into(&input(0), &mut output);
    assert_eq!(output, fresh.step(&input(0)));
}

#[test]
fn a_change_before_the_last_one_is_over_is_refused() {
    let (mut tunable, mut undisturbed) = (TunableCompensator::new(old()), TunableCompensator::new(old()));
    let (mut output, mut expected) = (CycleOutput::default(), CycleOutput::default());
    for cycle in 0..300 {
        if cycle == 100 {
            tunable.change(&new(), 50).unwrap();
            undisturbed.change(&new(), 50).unwrap();
        }
        if (101..150).contains(&cycle) {
            let error = tunable.change(&old(), 1).unwrap_err().to_string();
            assert!(error.starts_with("`change` comes before the last one is over"), "{error}");
        }
        tunable.step_into(&input(cycle), &mut output);
        undisturbed.step_into(&input(cycle), &mut expected);
        assert_eq!(output, expected);
    }
    tunable.change(&old(), 1).unwrap();
}

/// A robot's parameters live as long as the closure.
#[expect(clippy::unwrap_used, reason = "a test")]
fn with_robot<T>(mu: f64, work: impl FnOnce(&RobotParams<'_>) -> T) -> T {
    let cables = options(mu, 1000.0, 0.0).map(|options| CableParams::new(&options).unwrap());
    work(&RobotParams::new(0.001, &PlatformOptions::default(), MONITOR, &cables).unwrap())
}

#[test]
fn parameters_arrive_from_another_thread() {
    let mut running = with_robot(0.02, AnyCompensator::new).unwrap();
    let (mut sender, mut receiver) = with_robot(0.02, parameter_exchange).unwrap();
    let mut step = |cycle: u32, running: &mut AnyCompensator| {
        let input = input(cycle);
        receiver.deliver_to(running).unwrap();
        running.set_input(&input.cables, input.pose, 1.0);
        running.step();
    };
    step(0, &mut running);
    std::thread::scope(|scope| {
        let sent = scope.spawn(|| {
            let sent = with_robot(0.05, |robot| sender.send(robot, 0.02));
            (sent, with_robot(0.06, |robot| sender.send(robot, 0.02)))
        });
        assert_eq!(sent.join().unwrap(), (Ok(()), Err(SendError::Busy)));
    });
    for cycle in 1..=20 {
        assert_eq!(running.is_changing(), cycle > 1);
        step(cycle, &mut running);
        assert_eq!(with_robot(0.06, |robot| sender.send(robot, 0.02)), Err(SendError::Busy), "cycle {cycle}");
    }
    assert!(!running.is_changing());
    let mut built = with_robot(0.05, AnyCompensator::new).unwrap();
    for cycle in 0..1000 {
        let input = input(cycle);
        built.set_input(&input.cables, input.pose, 1.0);
        built.step();
        if cycle > 20 {
            step(cycle, &mut running);
        }
    }
    for (ours, theirs) in running.outputs().iter().zip(built.outputs()) {
        assert!((ours.force_at_platform_n - theirs.force_at_platform_n).abs() < 1e-9);
    }
    for blend_s in [f64::NAN, -1.0, 1e4] {
        let refused = with_robot(0.06, |robot| sender.send(robot, blend_s)).unwrap_err();
        assert!(refused.to_string().starts_with("`blend_s` is "), "{refused}");
    }
    // One after the other, as often as one likes.
    for cycle in 1000..1010 {
        assert_eq!(with_robot(0.06, |robot| sender.send(robot, 0.0)), Ok(()), "cycle {cycle}");
        step(2 * cycle, &mut running);
        assert_eq!(with_robot(0.07, |robot| sender.send(robot, 0.0)), Err(SendError::Busy), "cycle {cycle}");
        step(2 * cycle + 1, &mut running);
    }
}

#[test]
fn parameters_for_another_robot_than_the_one_that_runs_are_told() {
    let one_cable = CableParams::new(&options(0.02, 1000.0, 0.0)[0]).unwrap();
    let robot =
        RobotParams::new(0.001, &PlatformOptions::default(), MONITOR, std::slice::from_ref(&one_cable)).unwrap();
    let mut running = AnyCompensator::new(&robot).unwrap();
    let (mut sender, mut receiver) = with_robot(0.02, parameter_exchange).unwrap();
    for _ in 0..3 {
        assert_eq!(with_robot(0.05, |robot| sender.send(robot, 0.02)), Ok(()));
        let refused = receiver.deliver_to(&mut running).unwrap_err().to_string();
        assert!(refused.starts_with("`cable`"), "{refused}");
        assert!(!running.is_changing());
        assert_eq!(receiver.deliver_to(&mut running), Ok(()));
    }
}

/// Of two cables with a slip limit the second loses its own.
#[test]
fn a_slip_limit_that_is_dropped_is_gone() {
    let robot = |limits: [Option<f64>; 2]| {
        let cables: Vec<_> = (0..2)
            .map(|index| CableOptions {
                traction_mu: limits[index],
                friction: FrictionOptions { mu: 0.05, sigma_n_per_m: Some(1e4), ..FRICTION },
                ..corner_cable(index, Presliding::PerPulley)
            })
            .collect();
        compensator::<2>(&cables, MONITOR)
    };
    let slipping = Some(0.01);
    for with_pose in [true, false] {
        let mut tunable = TunableCompensator::new(robot([slipping; 2]));
        let mut free = robot([slipping, None]);
        let mut output = CycleOutput::default();
        let mut slipped = false;
        for cycle in 0..2500 {
            let mut input = smooth_input::<2>(cycle);
            if cycle == 400 {
                tunable.change(&free, 10).unwrap();
            }
            if cycle >= 400 && !with_pose {
                input.pose = None;
            }
            tunable.step_into(&input, &mut output);
            let expected = free.step(&input).cables[1];
            slipped |= cycle < 400 && output.cables[1].status.contains(CableStatus::SLIP);
            let gap_n = (output.cables[1].force_at_platform_n - expected.force_at_platform_n).abs();
            assert!(cycle < 2300 || gap_n < 1e-9, "cycle {cycle}: {gap_n} N");
        }
        assert!(slipped);
    }
}

const FORMS: [Presliding; 2] = [Presliding::PerPulley, Presliding::Lumped];

/// Three cables with some effects, each `(effect, key, value)`.
#[expect(clippy::unwrap_used, reason = "a test")]
fn robot_with(presliding: Presliding, effects: &[(Effect, &str, f64)]) -> Compensator<3> {
    let mut params = EffectParams::NEUTRAL;
    for (effect, key, value) in effects {
        params.set(*effect, key, *value).unwrap();
    }
    let friction = FrictionOptions { sigma_n_per_m: Some(5000.0), ..FRICTION };
    let cables: Vec<_> =
        (0..3).map(|index| CableOptions { friction, effects: params, ..corner_cable(index, presliding) }).collect();
    compensator(&cables, MONITOR)
}

/// To and fro within a quarter of a second, so that what is stored is soon forgotten.
fn quick_input(cycle: u32) -> CycleInput<3> {
    let t = f64::from(cycle) * 1e-3;
    let cables = std::array::from_fn(|cable| {
        let rate = [21.0, 23.0, 26.0][cable];
        CableInput {
            sensor_force_n: 20.0 + (3.0 * t).sin(),
            length_m: 0.02 * (rate * t).cos(),
            speed_m_per_s: -0.02 * rate * (rate * t).sin(),
        }
    });
    CycleInput { cables, pose: Pose::from_parts([0.0; 3], [0.0, 0.0, 0.0, 1.0]), ..CycleInput::default() }
}

/// Greatest difference of a force at the platform, N.
fn gap_n(one: &CycleOutput<3>, other: &CycleOutput<3>) -> f64 {
    let forces = one.cables.iter().zip(&other.cables);
    forces.map(|(one, other)| (one.force_at_platform_n - other.force_at_platform_n).abs()).fold(0.0, f64::max)
}

/// Runs a robot whose parameters change at some cycles; gives the outputs.
#[expect(clippy::unwrap_used, reason = "a test")]
fn run_with_changes(
    start: Compensator<3>,
    changes: &[(u32, &Compensator<3>)],
    cycles: u32,
    blend_cycles: u32,
) -> Vec<CycleOutput<3>> {
    let mut tunable = TunableCompensator::new(start);
    (0..cycles)
        .map(|cycle| {
            if let Some((_, next)) = changes.iter().find(|(at, _)| *at == cycle) {
                tunable.change(next, blend_cycles).unwrap();
            }
            let mut output = CycleOutput::default();
            tunable.step_into(&quick_input(cycle), &mut output);
            output
        })
        .collect()
}

/// Parameters of some effects: effect, key, value.
type Effects = Vec<(Effect, &'static str, f64)>;

/// Each effect as its row's example has it; a lead; and some that remember together.
fn effects() -> Vec<Effects> {
    let example = |effect: &Effect| {
        let values = effect.row().parameters.iter().zip(effect.row().example);
        values.map(|(parameter, value)| (*effect, parameter.key, *value)).collect()
    };
    let together = vec![
        (Effect::TimeDelay, "delay_s", 0.02),
        (Effect::PulleyEccentricity, "sin_ratio", 0.02),
        (Effect::PulleyInertia, "mass_kg", 0.1),
    ];
    let others = [vec![(Effect::TimeDelay, "delay_s", -0.003)], together];
    Effect::CATALOGUE.iter().map(example).chain(others).collect()
}

/// On, off and on again is off and on: nothing of the first time comes back.
#[test]
fn each_effect_switched_on_again_knows_nothing_of_the_first_time() {
    for presliding in FORMS {
        for effects in effects() {
            let (without, with) = (robot_with(presliding, &[]), robot_with(presliding, &effects));
            let changes = [(333, &without), (2000, &with)];
            let again = run_with_changes(with.clone(), &changes, 2500, 10);
            let once = run_with_changes(without.clone(), &changes, 2500, 10);
            for cycle in 1900..2500 {
                let gap_n = gap_n(&again[cycle], &once[cycle]);
                assert!(gap_n < 1e-9, "{effects:?} {presliding:?}, cycle {cycle}: {gap_n} N");
            }
            assert!(gap_n(&again[300], &once[300]) > 1e-5, "{effects:?} makes no difference");
        }
    }
}

/// What goes with the time of a run begins with the change, not with a loop that has been running for long.
#[test]
fn a_drift_begins_where_it_is_switched_on() {
    let drift = [(Effect::SensorDrift, "rate_n_per_s", 0.5)];
    for presliding in FORMS {
        let (without, with) = (robot_with(presliding, &[]), robot_with(presliding, &drift));
        let changed = run_with_changes(without.clone(), &[(2000, &with)], 2100, 1);
        let unchanged = run_with_changes(without, &[], 2100, 1);
        for cycle in 2000..2100_u32 {
            // The sensor's newtons make as many of the cable, and some per cent of friction.
            let drifted_n = 0.5e-3 * f64::from(cycle - 2000);
            let gap_n = gap_n(&changed[cycle as usize], &unchanged[cycle as usize]);
            assert!(
                (0.3 * drifted_n..=1.5 * drifted_n + 0.001).contains(&gap_n),
                "{presliding:?}, cycle {cycle}: {gap_n} N"
            );
        }
    }
}

/// Its clock is that of the run, not of the last change.
#[test]
fn a_drift_goes_on_over_a_change() {
    let drift = [(Effect::SensorDrift, "rate_n_per_s", 0.5)];
    for presliding in FORMS {
        let with = robot_with(presliding, &drift);
        let changed = run_with_changes(with.clone(), &[(2000, &with)], 2100, 10);
        let unchanged = run_with_changes(with, &[], 2100, 1);
        for (cycle, (one, other)) in changed.iter().zip(&unchanged).enumerate() {
            assert!(gap_n(one, other) < 1e-9, "{presliding:?}, cycle {cycle}");
        }
    }
}

/// A blend of one cycle is a change at once: what then changes is what the effect is good for, and no leftover.
#[test]
fn inertia_switched_on_again_gives_no_jump() {
    for presliding in FORMS {
        let (without, with) =
            (robot_with(presliding, &[]), robot_with(presliding, &[(Effect::PulleyInertia, "mass_kg", 0.1)]));
        // Fast one way, then fast the other way.
        let outputs = run_with_changes(with.clone(), &[(200, &without), (350, &with)], 400, 1);
        let steepest_n = (1..400).filter(|at| ![200, 350].contains(at)).map(|at| gap_n(&outputs[at], &outputs[at - 1]));
        let steepest_n = steepest_n.fold(0.0, f64::max);
        let jump_n = gap_n(&outputs[350], &outputs[349]);
        assert!(jump_n < steepest_n, "{jump_n} N where else {steepest_n} N");
    }
}

/// The friction stored goes from one form to the other with the same force at the platform, and both ways back.
#[test]
fn the_form_of_presliding_changes_without_a_jump() {
    for (first, second) in [(FORMS[0], FORMS[1]), (FORMS[1], FORMS[0])] {
        let (start, other) = (robot_with(first, &[]), robot_with(second, &[]));
        for at in [300, 411, 666] {
            let (at_index, until) = (at as usize, at + 1500);
            let outputs = run_with_changes(start.clone(), &[(at, &other)], until, 1);
            let mut unchanged = start.clone();
            let expected: Vec<_> = (0..=at).map(|cycle| unchanged.step(&quick_input(cycle))).collect();
            let jump_n = gap_n(&outputs[at_index], &expected[at_index]);
            assert!(jump_n < 0.05, "{first:?}, cycle {at}: {jump_n} N");
            let mut built = other.clone();
            let mut last = CycleOutput::default();
            for cycle in 0..until {
                built.step_into(&quick_input(cycle), &mut last);
            }
            assert!(gap_n(&outputs[at_index + 1499], &last) < 1e-9);
        }
        // At rest not even that.
        let mut tunable = TunableCompensator::new(start.clone());
        let mut output = CycleOutput::default();
        let resting = |cycle: u32| {
            let mut input = quick_input(cycle.min(300));
            input.cables.iter_mut().for_each(|cable| cable.speed_m_per_s = 0.0);
            input
        };
        for cycle in 0..310 {
            tunable.step_into(&resting(cycle), &mut output);
        }
        for next in [&other, &start, &other] {
            tunable.change(next, 1).unwrap();
            let before = output;
            tunable.step_into(&resting(310), &mut output);
            assert!(gap_n(&output, &before) < 1e-12, "{} N", gap_n(&output, &before));
        }
    }
}

/// What a cable stores as a whole goes to its pulleys in proportion to 2 sin(α/2) of their wraps, with the same force at the platform: behind the sensor
/// pulley friction adds up, and at a wrap of 180° the sensor itself shows half of its own.
#[test]
fn friction_of_the_whole_cable_goes_to_the_pulleys_by_their_wraps() {
    let [lumped, per_pulley] = [Presliding::Lumped, Presliding::PerPulley].map(|form| robot_with(form, &[]));
    let mut tunable = TunableCompensator::new(lumped);
    let mut output = CycleOutput::default();
    for cycle in 0..300 {
        tunable.step_into(&quick_input(cycle), &mut output);
    }
    let mut resting = quick_input(299);
    resting.cables.iter_mut().for_each(|cable| cable.speed_m_per_s = 0.0);
    tunable.step_into(&resting, &mut output);
    tunable.change(&per_pulley, 1).unwrap();
    tunable.step_into(&resting, &mut output);
    let pose = resting.pose.unwrap();
    for (index, cable) in output.cables.iter().enumerate() {
        let options = corner_cable(index, Presliding::PerPulley);
        let GeometryOptions { base_m, platform_m } = options.geometry.unwrap();
        let attachment_m: [f64; 3] = (pose.position_m + pose.orientation * nalgebra::Vector3::from(platform_m)).into();
        let geometry = Geometry { base_m, platform_m, axis: [0.0, 0.0, 1.0], radius_m: 0.01 };
        let wraps_rad = [std::f64::consts::PI, std::f64::consts::FRAC_PI_2, geometry.exit(attachment_m).wrap_rad];
        let factors = wraps_rad.map(|wrap_rad| 2.0 * (0.5 * wrap_rad).sin());
        let shares: f64 = 0.5 * factors[0] + factors[1] + factors[2];
        let stored_n = tunable.compensator().pulley_friction_n(index);
        for (stored_n, factor) in stored_n.iter().zip(factors) {
            let by_hand_n = cable.friction_n / shares * factor;
            assert!(stored_n.abs() > 1e-3, "cable {index}: {stored_n}");
            assert!((stored_n - by_hand_n).abs() < 1e-12, "cable {index}: {stored_n} and {by_hand_n}");
        }
    }
}

/// A sensor pulley of less than 90° shows its friction the other way round. Where it cancels that of the others to less than a thousandth of their sizes,
/// or nothing bends the cable at all, no distribution has the force of the whole, and what is stored is released.
#[test]
fn friction_that_no_pulley_can_have_is_released() {
    let (sensor_rad, cancelling) = (0.25 * std::f64::consts::PI, 2.414_213_562_373_095 * 0.765_366_864_730_179_6);
    let part = cancelling * sensor_rad.cos() * std::f64::consts::SQRT_2;
    for (second, is_kept) in [(part, false), (part + 0.002, false), (part + 0.02, true), (1.2, true)] {
        let second_rad = 2.0 * (0.5 * second).asin();
        let pulleys = [
            PulleyOptions::Fixed { wrap_rad: sensor_rad, sensor: true },
            PulleyOptions::Fixed { wrap_rad: second_rad, sensor: false },
        ];
        assert_released(&pulleys, [0.765_366_864_730_179_6, second], is_kept);
    }
    let straight = PulleyOptions::Fixed { wrap_rad: 0.0, sensor: false };
    assert_released(&[straight, straight], [0.0; 2], false);
}

#[track_caller]
#[expect(clippy::unwrap_used, reason = "in a test")]
fn assert_released(pulleys: &[PulleyOptions], factors: [f64; 2], is_kept: bool) {
    let robot = |presliding| {
        compensator::<1>(&[CableOptions { presliding, friction: FRICTION, ..CableOptions::new(pulleys) }], MONITOR)
    };
    let mut tunable = TunableCompensator::new(robot(Presliding::Lumped));
    let mut output = CycleOutput::default();
    let mut step = |tunable: &mut TunableCompensator<1>, cycle: u32| {
        let time_s = f64::from(cycle) * 1e-3;
        // A sensor that repeats itself would be frozen.
        let cables = [CableInput { sensor_force_n: 20.0 + time_s, length_m: 0.1 * time_s, speed_m_per_s: 0.0 }];
        tunable.step_into(&CycleInput { cables, ..CycleInput::default() }, &mut output);
        output
    };
    for cycle in 0..300 {
        step(&mut tunable, cycle);
    }
    let whole_n = step(&mut tunable, 299).cables[0].friction_n;
    tunable.change(&robot(Presliding::PerPulley), 1).unwrap();
    let friction_n = step(&mut tunable, 299).cables[0].friction_n;
    let stored_n = tunable.compensator().pulley_friction_n(0);
    if is_kept {
        assert!((friction_n - whole_n).abs() < 1e-12, "{factors:?}: {friction_n} and {whole_n}");
        assert!((stored_n[0] * factors[1] - stored_n[1] * factors[0]).abs() < 1e-9, "{factors:?}: {stored_n:?}");
        assert!(stored_n[1].abs() > 1e-3, "{factors:?}: {stored_n:?}");
    } else {
        assert!(friction_n.abs() < 1e-12, "{factors:?}: {friction_n}");
        assert_eq!(stored_n, [0.0; fric_core::robot::MAX_PULLEYS], "{factors:?}");
    }
}

#[test]
fn a_state_that_is_restored_ends_a_change() {
    let mut tunable = TunableCompensator::new(old());
    let mut output = CycleOutput::default();
    for cycle in 0..200 {
        tunable.step_into(&input(cycle), &mut output);
    }
    let new = new();
    tunable.change(&new, BLEND_CYCLES).unwrap();
    tunable.step_into(&input(200), &mut output);
    assert!(tunable.is_changing());
    let mut expected = new.clone();
    for cycle in 0..50 {
        expected.step(&input(cycle));
    }
    tunable.restore(&expected.snapshot());
    assert!(!tunable.is_changing());
    tunable.step_into(&input(50), &mut output);
    assert_eq!(output, expected.step(&input(50)));
}

/// Where the motion is in its period does not depend on the delays that there were before.
#[test]
fn another_delay_leaves_no_lag_behind() {
    let ripple = |delay_s| {
        robot_with(
            Presliding::PerPulley,
            &[
                (Effect::TimeDelay, "delay_s", delay_s),
                (Effect::PulleyEccentricity, "sin_ratio", 0.02),
                (Effect::PulleyEccentricity, "period_m", 0.03),
            ],
        )
    };
    for [first_s, second_s, third_s] in [[0.01, 0.03, 0.03], [0.03, 0.01, 0.0105], [0.01, 0.0, 0.02], [0.0, 0.05, 0.01]]
    {
        let (second, third) = (ripple(second_s), ripple(third_s));
        let outputs = run_with_changes(ripple(first_s), &[(300, &second), (450, &third)], 2500, 10);
        let mut built = ripple(third_s);
        for cycle in 0..2500_u32 {
            let expected = built.step(&quick_input(cycle));
            let gap_n = gap_n(&outputs[cycle as usize], &expected);
            assert!(cycle < 2000 || gap_n < 1e-9, "{first_s} s to {third_s} s, cycle {cycle}: {gap_n} N");
        }
    }
}
