//! Every row of the table of [`CableStatus`]: when the flag stands, what the output is, how it clears.

use fric_core::robot::{CableOptions, FrictionOptions, MonitorOptions, Presliding, ValidatedRange};
use fric_core::{CableInput, CableOutput, CableStatus, Compensator, CycleInput, Pose};

use crate::support::{FRICTION, GUIDE_90, SENSOR_180, assert_near, compensator, corner_cable};

const FORMS: [Presliding; 2] = [Presliding::Lumped, Presliding::PerPulley];
const PULLEYS: [fric_core::robot::PulleyOptions; 2] = [SENSOR_180, GUIDE_90];
const MONITOR: MonitorOptions =
    MonitorOptions { frozen_cycles: 10, length_jump_m: 0.01, length_noise_m: 0.0, sensor_jump_n: None };

type Change = fn(&mut CableInput);

/// A winch on a test bench that pays out at 0.1 m/s, its force rising a little every cycle.
#[derive(Clone)]
struct Bench {
    compensator: Compensator<1>,
    cycle: i32,
}

impl Bench {
    fn new(presliding: Presliding) -> Self {
        Self::with(&CableOptions { presliding, friction: FRICTION, ..CableOptions::new(&PULLEYS) })
    }

    fn with(options: &CableOptions<'_>) -> Self {
        Self { compensator: compensator(&[*options], MONITOR), cycle: 0 }
    }

    fn signals(&self) -> CableInput {
        let cycle = f64::from(self.cycle);
        CableInput { sensor_force_n: 20.0 + 1e-3 * cycle, length_m: 1e-4 * cycle, speed_m_per_s: 0.1 }
    }

    fn step(&mut self, change: impl Fn(&mut CableInput)) -> CableOutput {
        self.cycle += 1;
        let mut signals = self.signals();
        change(&mut signals);
        self.compensator.step(&CycleInput { cables: [signals], ..CycleInput::default() }).cables[0]
    }

    fn run(&mut self, cycles: usize) -> CableOutput {
        (0..cycles).map(|_| self.step(|_| ())).last().unwrap()
    }

    fn stored_n(&self) -> f64 {
        self.compensator.pulley_friction_n(0).iter().map(|friction_n| friction_n.abs()).sum()
    }
}

#[test]
fn flags_meet_if_they_share_one() {
    let (one, other) = (CableStatus::SLACK | CableStatus::SLIP, CableStatus::SLIP | CableStatus::OUT_OF_RANGE);
    assert!(one.intersects(other) && !one.contains(other));
    assert!(!CableStatus::SLACK.intersects(other) && !CableStatus::from_bits(0).intersects(one));
}

#[test]
fn good_signals_have_no_flag() {
    for presliding in FORMS {
        let mut bench = Bench::new(presliding);
        for _ in 0..500 {
            assert_eq!(bench.run(1).status, CableStatus::OK);
        }
    }
}

#[test]
fn a_slack_cable_does_not_push_and_releases_the_friction() {
    for presliding in FORMS {
        for force_n in [0.0, -0.0, -3.0] {
            let mut bench = Bench::new(presliding);
            assert!(bench.run(300).friction_n > 0.1);
            let output = bench.step(|signals| signals.sensor_force_n = force_n);
            assert_eq!(output.status, CableStatus::SLACK | CableStatus::SENSOR_JUMP | CableStatus::UNSETTLED);
            // What the sensor shows of it is told beside.
            assert_near(output.force_at_platform_n, FRICTION.offset_n, 1e-15);
            assert_near(output.frictionless_n, 0.5 * force_n, 1e-15);
            // Nothing rubs in it.
            assert_eq!(output.friction_n, 0.0);
            assert_eq!(bench.stored_n(), 0.0);
            // Nor does one whose sensor then falls silent.
            let mut silent = bench.clone();
            let output = silent.step(|signals| signals.sensor_force_n = f64::NAN);
            assert!(output.status.contains(CableStatus::SENSOR_NOT_FINITE));
            assert_near(output.force_at_platform_n, FRICTION.offset_n, 1e-15);
            assert_eq!(output.friction_n, 0.0);
            // Tension comes back: flagged until friction has built up anew over the presliding distance.
            let output = bench.step(|_| ());
            assert_eq!(output.status, CableStatus::SENSOR_JUMP | CableStatus::UNSETTLED);
            let viscous_n = FRICTION.viscous_n_s_per_m * 0.1 * 1.5;
            assert!(output.friction_n > 0.0 && output.friction_n - viscous_n < 0.12, "{output:?}");
        }
    }
}

#[test]
fn viscous_friction_beyond_the_tension_is_slack_too() {
    for presliding in FORMS {
        let friction = FrictionOptions { viscous_n_s_per_m: 100.0, ..FRICTION };
        let mut bench = Bench::with(&CableOptions { presliding, friction, ..CableOptions::new(&PULLEYS) });
        bench.run(100);
        let output = bench.step(|signals| signals.speed_m_per_s = -1.0);
        assert_eq!(output.status, CableStatus::SLACK);
        // A cable cannot push: no force but the offset.
        assert_near(output.force_at_platform_n, FRICTION.offset_n, 1e-15);
        assert_near(output.friction_n, -output.frictionless_n, 1e-12);
        assert_eq!(bench.run(1).status, CableStatus::OK);
    }
}

#[test]
fn a_silent_sensor_holds_the_output_while_the_stored_friction_follows_the_motion() {
    for presliding in FORMS {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.001e9, -1e300] {
            let (mut bench, mut other) = (Bench::new(presliding), Bench::new(presliding));
            let last = bench.run(20);
            other.run(20);
            let silent_n = other.signals().sensor_force_n;
            // Out and back: what the net way would not tell.
            for step in 1..=60 {
                let way_m = 1e-4 * f64::from(if step <= 30 { step } else { 60 - step });
                let speed_m_per_s = if step <= 30 { 0.1 } else { -0.1 };
                let signals = |sensor_force_n| CableInput { sensor_force_n, length_m: 2e-3 + way_m, speed_m_per_s };
                let output = bench.step(|place| *place = signals(value));
                other.step(|place| *place = signals(silent_n));
                assert_eq!(output.status, CableStatus::SENSOR_NOT_FINITE);
                assert_eq!(output.frictionless_n.to_bits(), last.frictionless_n.to_bits());
                assert_eq!(output.friction_n.to_bits(), last.friction_n.to_bits());
                assert_near(output.force_at_platform_n, last.force_at_platform_n, 1e-15);
            }
            // As if the sensor had shown its last good force all the time.
            let rest = CableInput { sensor_force_n: 20.0, length_m: 2e-3, speed_m_per_s: 0.0 };
            let (output, expected) = (bench.step(|place| *place = rest), other.step(|place| *place = rest));
            assert_eq!(output.status, CableStatus::OK);
            assert!(output.friction_n < 0.0);
            assert_near(output.force_at_platform_n, expected.force_at_platform_n, 1e-12);
        }
    }
}

#[test]
fn a_slack_sensor_at_zero_is_slack_not_frozen_and_leaves_no_friction_behind() {
    for presliding in FORMS {
        let mut bench = Bench::new(presliding);
        bench.run(30);
        for cycle in 0..60 {
            let output = bench.step(|place| {
                *place =
                    CableInput { sensor_force_n: 0.0, length_m: 3e-3 - 1e-4 * f64::from(cycle), speed_m_per_s: -0.1 };
            });
            assert!(output.status.contains(CableStatus::SLACK | CableStatus::SENSOR_JUMP));
        }
        let tight = CableInput { sensor_force_n: 20.0, length_m: 3e-3 - 1e-4 * 59.0, speed_m_per_s: 0.0 };
        let output = bench.step(|place| *place = tight);
        assert_eq!((output.status.contains(CableStatus::SLACK), output.friction_n), (false, 0.0));
    }
}

#[test]
fn a_dip_of_the_sensor_does_not_wear_the_held_friction_down() {
    for presliding in FORMS {
        let mut bench = Bench::new(presliding);
        for cycle in 0..40 {
            bench.step(|place| {
                *place = CableInput { sensor_force_n: 20.0, length_m: -1e-4 * f64::from(cycle), speed_m_per_s: -0.1 };
            });
        }
        let blind = |sensor_force_n| CableInput { sensor_force_n, length_m: f64::NAN, speed_m_per_s: -0.1 };
        let held = bench.step(|place| *place = blind(20.1));
        let dip = bench.step(|place| *place = blind(0.1));
        assert!(dip.friction_n > held.friction_n && dip.force_at_platform_n >= FRICTION.offset_n);
        let after = bench.step(|place| *place = blind(20.2));
        assert_eq!(after.friction_n.to_bits(), held.friction_n.to_bits());
    }
}

#[test]
fn noise_of_the_length_within_its_play_moves_nothing() {
    for presliding in FORMS {
        let friction = FrictionOptions { viscous_n_s_per_m: 0.0, ..FRICTION };
        let options = CableOptions { presliding, friction, ..CableOptions::new(&PULLEYS) };
        let monitor = MonitorOptions { frozen_cycles: 0, length_noise_m: 1e-5, ..MONITOR };
        let mut bench = Bench { compensator: compensator(&[options], monitor), cycle: 0 };
        let slid = bench.run(40);
        for cycle in 0..1000 {
            let dither_m = if cycle % 2 == 0 { -1e-5 } else { 1e-5 };
            let output = bench.step(|place| {
                *place = CableInput { sensor_force_n: 20.04, length_m: 4e-3 - 1e-5 + dither_m, speed_m_per_s: 0.0 };
            });
            assert_near(output.friction_n, slid.friction_n, 1e-3);
        }
    }
}

#[test]
fn a_rotation_that_is_none_is_no_pose() {
    let options = [fric_core::robot::CableOptions { ..crate::support::corner_cable(0, Presliding::PerPulley) }];
    let mut compensator = compensator::<1>(&options, MONITOR);
    let zero = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(0.0, 0.0, 0.0, 0.0));
    let pose = Pose { orientation: zero, ..Pose::identity() };
    let cables = [CableInput { sensor_force_n: 20.0, length_m: 1.0, speed_m_per_s: 0.0 }];
    let output = compensator.step(&CycleInput { cables, pose: Some(pose), ..CycleInput::default() });
    assert_eq!((output.cables[0].status, output.outside_wrench), (CableStatus::POSE_MISSING, None));
    let output = compensator.step(&CycleInput { cables, pose: Some(Pose::identity()), ..CycleInput::default() });
    assert!(output.wrench_status.is_ok() && output.outside_wrench.is_some());
}

#[test]
fn a_frozen_sensor_is_one_that_repeats_itself_while_the_cable_moves() {
    for presliding in FORMS {
        let mut bench = Bench::new(presliding);
        bench.run(20);
        let first = bench.step(|signals| signals.sensor_force_n = 20.5);
        assert!(first.status.is_ok());
        let mut last = first;
        for repeat in 1..40 {
            let output = bench.step(|signals| signals.sensor_force_n = 20.5);
            if repeat < 10 {
                assert!(output.status.is_ok(), "repeat {repeat}");
                last = output;
            } else {
                assert_eq!(output.status, CableStatus::SENSOR_FROZEN, "repeat {repeat}");
                assert_eq!(output.friction_n.to_bits(), last.friction_n.to_bits());
                assert_near(output.force_at_platform_n, last.force_at_platform_n, 1e-15);
            }
        }
        assert_eq!(bench.run(1).status, CableStatus::OK);
        // At rest a quiet sensor is no fault.
        let mut still = Bench::new(presliding);
        still.run(5);
        for _ in 0..100 {
            let output = still
                .step(|signals| *signals = CableInput { sensor_force_n: 20.5, length_m: 5e-4, speed_m_per_s: 0.0 });
            assert_eq!(output.status, CableStatus::OK);
        }
    }
}

#[test]
fn no_check_for_a_frozen_sensor_where_it_is_switched_off() {
    let monitor = MonitorOptions { frozen_cycles: 0, ..MONITOR };
    let mut compensator = compensator::<1>(&[CableOptions::new(&PULLEYS)], monitor);
    for cycle in 0..5000 {
        let cables = [CableInput { sensor_force_n: 20.5, length_m: 1e-4 * f64::from(cycle), speed_m_per_s: 0.1 }];
        assert!(compensator.step(&CycleInput { cables, ..CycleInput::default() }).cables[0].status.is_ok());
    }
}

#[test]
fn a_pause_beyond_all_bounds_hides_no_jump() {
    for presliding in FORMS {
        for elapsed_cycles in [f64::INFINITY, f64::MAX, 1.1e6, f64::NAN, f64::NEG_INFINITY, 0.0] {
            let bench = Bench::new(presliding);
            let jump = |length_m: f64, force_n: f64| {
                let mut bench = bench.clone();
                let last = bench.run(50);
                bench.cycle += 1;
                let mut signals = bench.signals();
                signals.length_m += length_m;
                signals.sensor_force_n += force_n;
                let output =
                    bench.compensator.step(&CycleInput { cables: [signals], elapsed_cycles, ..CycleInput::default() });
                (last, output.cables[0])
            };
            let (last, output) = jump(5.0, 0.0);
            assert_eq!(output.status, CableStatus::LENGTH_JUMP, "{elapsed_cycles}");
            assert_eq!(output.friction_n.to_bits(), last.friction_n.to_bits());
            assert!(jump(0.0, 40.0).1.status.contains(CableStatus::SENSOR_JUMP), "{elapsed_cycles}");
            // What is possible in one cycle is no jump.
            assert_eq!(jump(0.005, 0.1).1.status, CableStatus::OK, "{elapsed_cycles}");
        }
    }
}

#[test]
fn a_jump_of_length_is_no_motion() {
    for presliding in FORMS {
        for jump_m in [0.02, -0.02, 5.0, -900.0] {
            let mut bench = Bench::new(presliding);
            let last = bench.run(50);
            let stored_n = bench.stored_n();
            let output = bench.step(|signals| signals.length_m += jump_m);
            assert_eq!(output.status, CableStatus::LENGTH_JUMP);
            assert_eq!(output.friction_n.to_bits(), last.friction_n.to_bits());
            // The force follows the sensor.
            assert_near(output.frictionless_n, 0.5 * bench.signals().sensor_force_n, 1e-15);
            assert_near(output.force_at_platform_n, output.frictionless_n + last.friction_n + FRICTION.offset_n, 1e-12);
            assert_eq!(bench.stored_n(), stored_n);
            // Going on from the new length is motion again.
            let output = bench.step(|signals| signals.length_m += jump_m);
            assert_eq!(output.status, CableStatus::OK);
        }
    }
}

#[test]
fn motion_that_is_no_number_holds_the_friction() {
    for presliding in FORMS {
        for value in [f64::NAN, f64::INFINITY, -1.001e6, 1e300] {
            for of_length in [true, false] {
                let (mut bench, mut other) = (Bench::new(presliding), Bench::new(presliding));
                let last = bench.run(50);
                other.run(50);
                for _ in 0..5 {
                    let output = bench.step(|signals| {
                        *(if of_length { &mut signals.length_m } else { &mut signals.speed_m_per_s }) = value;
                    });
                    assert_eq!(output.status, CableStatus::MOTION_NOT_FINITE);
                    assert_eq!(output.friction_n.to_bits(), last.friction_n.to_bits());
                    assert_near(output.frictionless_n, 0.5 * bench.signals().sensor_force_n, 1e-15);
                }
                // The length tells afterwards how far the cable has moved.
                other.cycle += 5;
                let (output, expected) = (bench.run(1), other.run(1));
                assert_eq!(output.status, CableStatus::OK);
                assert_near(output.force_at_platform_n, expected.force_at_platform_n, 1e-12);
            }
        }
    }
}

#[test]
fn outside_the_range_of_identification_it_is_computed_as_usual() {
    for presliding in FORMS {
        let validated = ValidatedRange { force_n: [5.0, 21.0], speed_m_per_s: 0.15 };
        let mut bench =
            Bench::with(&CableOptions { presliding, friction: FRICTION, validated, ..CableOptions::new(&PULLEYS) });
        let mut plain = Bench::new(presliding);
        let changes: [(Change, bool); 6] = [
            (|_| (), false),
            (|signals| signals.sensor_force_n = 4.9, true),
            (|signals| signals.sensor_force_n = 21.1, true),
            (|signals| signals.speed_m_per_s = 0.16, true),
            (|signals| signals.speed_m_per_s = -0.16, true),
            (|_| (), false),
        ];
        for (change, flagged) in changes {
            let (output, expected) = (bench.step(change), plain.step(change));
            assert_eq!(output.status.contains(CableStatus::OUT_OF_RANGE), flagged);
            assert_eq!(output.force_at_platform_n.to_bits(), expected.force_at_platform_n.to_bits());
        }
    }
}

fn posed(compensator: &mut Compensator<1>, cycle: i32, pose: Option<Pose>) -> fric_core::CycleOutput<1> {
    let cycle = f64::from(cycle);
    let cables = [CableInput { sensor_force_n: 20.0 + 1e-3 * cycle, length_m: 1e-4 * cycle, speed_m_per_s: 0.1 }];
    compensator.step(&CycleInput { cables, pose, ..CycleInput::default() })
}

fn somewhere(x_m: f64) -> Pose {
    Pose::from_parts([x_m, 0.05, -0.1], [0.0, 0.0, 0.0, 1.0]).unwrap()
}

#[test]
fn without_a_pose_wrap_and_direction_are_held() {
    for presliding in FORMS {
        let options = [corner_cable(0, presliding)];
        let mut compensator = compensator::<1>(&options, MONITOR);
        // Before the first pose: 90° and no wrench.
        let output = posed(&mut compensator, 0, None);
        assert_eq!(output.cables[0].status, CableStatus::POSE_MISSING);
        assert_eq!(output.outside_wrench, None);
        let with_90 = [SENSOR_180, GUIDE_90, GUIDE_90];
        let mut fixed = crate::support::compensator::<1>(&[CableOptions { pulleys: &with_90, ..options[0] }], MONITOR);
        posed(&mut fixed, 0, None);
        for cycle in 1..100 {
            let (one, other) = (posed(&mut compensator, cycle, None), posed(&mut fixed, cycle, None));
            assert_eq!(other.cables[0].status, CableStatus::OK);
            assert_near(one.cables[0].force_at_platform_n, other.cables[0].force_at_platform_n, 1e-12);
        }
        // A pose, and gone again: as if the platform stood still.
        let mut still = compensator.clone();
        posed(&mut compensator, 100, Some(somewhere(0.1)));
        posed(&mut still, 100, Some(somewhere(0.1)));
        let broken = Pose { position_m: [f64::NAN, 0.0, 0.0].into(), ..somewhere(0.1) };
        for (cycle, pose) in [(101, None), (102, Some(broken)), (103, None)] {
            let output = posed(&mut compensator, cycle, pose);
            assert_eq!(output.cables[0].status, CableStatus::POSE_MISSING);
            let expected = posed(&mut still, cycle, Some(somewhere(0.1)));
            assert_eq!(
                output.cables[0].force_at_platform_n.to_bits(),
                expected.cables[0].force_at_platform_n.to_bits()
            );
            assert_eq!(output.outside_wrench, expected.outside_wrench);
            assert_eq!(output.applied_wrench, expected.applied_wrench);
        }
        assert_eq!(posed(&mut compensator, 104, Some(somewhere(0.1))).cables[0].status, CableStatus::OK);
    }
}

#[test]
fn an_attachment_inside_the_pulley_holds_wrap_and_direction() {
    for presliding in FORMS {
        let options = [corner_cable(0, presliding)];
        let mut compensator = compensator::<1>(&options, MONITOR);
        posed(&mut compensator, 0, Some(somewhere(0.1)));
        let mut still = compensator.clone();
        // The attachment onto the centre of the pulley: radius beside the entry point.
        let geometry = options[0].geometry.unwrap();
        let centre: [f64; 3] =
            core::array::from_fn(|axis| geometry.base_m[axis] - geometry.platform_m[axis] + [0.01, 0.0, 0.0][axis]);
        let inside = Pose::from_parts(centre, [0.0, 0.0, 0.0, 1.0]).unwrap();
        for cycle in 1..5 {
            let (output, expected) =
                (posed(&mut compensator, cycle, Some(inside)), posed(&mut still, cycle, Some(somewhere(0.1))));
            assert_eq!(output.cables[0].status, CableStatus::POSE_UNREACHABLE);
            assert_eq!(
                output.cables[0].force_at_platform_n.to_bits(),
                expected.cables[0].force_at_platform_n.to_bits()
            );
            assert_eq!(output.outside_wrench.unwrap().force_n, expected.outside_wrench.unwrap().force_n);
        }
        assert_eq!(posed(&mut compensator, 5, Some(somewhere(0.1))).cables[0].status, CableStatus::OK);
    }
}

/// A sensor that has repeated itself, or has been silent, may show at once what has changed meanwhile.
#[test]
fn a_change_over_several_cycles_is_a_jump_only_beyond_as_many_limits() {
    let hold: Change = |signals| signals.sensor_force_n = 20.3;
    let silent: Change = |signals| signals.sensor_force_n = f64::NAN;
    for (meanwhile, cycles, limits) in [(hold, 4, 5.0), (silent, 4, 5.0), (silent, 1, 2.0)] {
        for (change, jumps) in [(limits - 0.2, false), (limits + 0.2, true)] {
            let monitor = MonitorOptions { sensor_jump_n: Some(2.0), ..MONITOR };
            let options = CableOptions { friction: FRICTION, ..CableOptions::new(&PULLEYS) };
            let mut bench = Bench { compensator: compensator(&[options], monitor), cycle: 0 };
            bench.run(299);
            bench.step(hold);
            for _ in 0..cycles {
                bench.step(meanwhile);
            }
            let output = bench.step(|signals| signals.sensor_force_n = 20.3 + 2.0 * change);
            assert_eq!(output.status.contains(CableStatus::SENSOR_JUMP), jumps, "{cycles} cycles, {change}");
        }
    }
}

/// A jump ends when jumps have cancelled, or the force is back where it was; one that is partly taken back does not, for 5 s.
#[test]
fn a_jump_ends_when_it_is_taken_back() {
    // What the sensor shows beyond the true force, and a change of the true force, each cycle; jumps are changes beyond 1 N.
    let steady = |lie_n: f64| vec![(lie_n, 0.0); 30];
    let wandering = |lie_n: f64, rate: f64| (0..30).map(|cycle| (lie_n + rate * f64::from(cycle), 0.0)).collect();
    let changing = |lie_n: f64| vec![(lie_n, 0.8); 30];
    let after = vec![(0.0, 0.0); 100];
    for (phases, ends) in [
        (vec![steady(60.0)], true),
        // The lie itself creeps, and the force comes back to what it was.
        (vec![wandering(60.0, 0.8)], true),
        // The true force creeps meanwhile, and the jumps cancel.
        (vec![changing(60.0)], true),
        (vec![steady(60.0), steady(90.0)], true),
        (vec![steady(60.0), steady(30.0)], false),
        (vec![steady(-9.0), steady(-5.0)], false),
    ] {
        let phases: Vec<Vec<(f64, f64)>> = phases;
        let monitor = MonitorOptions { sensor_jump_n: Some(1.0), ..MONITOR };
        let options = CableOptions { friction: FRICTION, ..CableOptions::new(&PULLEYS) };
        let mut bench = Bench { compensator: compensator(&[options], monitor), cycle: 0 };
        bench.run(300);
        let mut moved_n = 0.0;
        for (lie_n, change_n) in phases.concat() {
            moved_n += change_n;
            let output = bench.step(|signals| signals.sensor_force_n += lie_n + moved_n);
            assert!(output.status.contains(CableStatus::SENSOR_JUMP), "{phases:?}");
        }
        // In the cycle in which it is taken back it still stands.
        let flagged: Vec<bool> = after
            .iter()
            .map(|_| bench.step(|signals| signals.sensor_force_n += moved_n).status.contains(CableStatus::SENSOR_JUMP))
            .collect();
        let expected: Vec<bool> = (0..after.len()).map(|cycle| cycle == 0 || !ends).collect();
        assert_eq!(flagged, expected, "{phases:?}");
    }
}

/// Two causes do not hide each other, whichever they are.
#[test]
fn faults_that_come_together_are_all_told() {
    use CableStatus as Of;
    let validated = ValidatedRange { force_n: [5.0, 30.0], speed_m_per_s: 1.0 };
    let options = [CableOptions { validated, ..corner_cable(0, Presliding::PerPulley) }];
    let monitor = MonitorOptions { sensor_jump_n: Some(2.0), ..MONITOR };
    let geometry = options[0].geometry.unwrap();
    let centre: [f64; 3] =
        core::array::from_fn(|axis| geometry.base_m[axis] - geometry.platform_m[axis] + [0.01, 0.0, 0.0][axis]);
    let inside = Pose::from_parts(centre, [0.0, 0.0, 0.0, 1.0]);
    let silent: Change = |signals| signals.sensor_force_n = f64::NAN;
    let spike: Change = |signals| signals.sensor_force_n += 60.0;
    let small_spike: Change = |signals| signals.sensor_force_n += 8.0;
    for (change, pose, flags) in [
        (silent, None, Of::SENSOR_NOT_FINITE | Of::POSE_MISSING),
        (silent, inside, Of::SENSOR_NOT_FINITE | Of::POSE_UNREACHABLE),
        (spike, Some(somewhere(0.1)), Of::OUT_OF_RANGE | Of::SENSOR_JUMP | Of::UNSETTLED),
        (small_spike, None, Of::POSE_MISSING | Of::SENSOR_JUMP | Of::UNSETTLED),
        (small_spike, inside, Of::POSE_UNREACHABLE | Of::SENSOR_JUMP | Of::UNSETTLED),
    ] {
        // Four cables fill the lanes of a block, so that every bit of one cause meets that of another.
        let mut compensator = compensator::<4>(&[options[0]; 4], monitor);
        let mut step = |cycle: i32, pose: Option<Pose>, change: Change| {
            let cycle = f64::from(cycle);
            let mut cable =
                CableInput { sensor_force_n: 20.0 + 1e-3 * cycle, length_m: 1e-4 * cycle, speed_m_per_s: 0.1 };
            change(&mut cable);
            compensator.step(&CycleInput { cables: [cable; 4], pose, ..CycleInput::default() })
        };
        for cycle in 0..300 {
            step(cycle, Some(somewhere(0.1)), |_| ());
        }
        let output = step(300, pose, change);
        assert_eq!(output.cables.map(|cable| cable.status), [flags; 4]);
        assert_eq!(output.wrench_status, flags);
    }
}

/// A cable that has never left its last pulley has no direction, so that there is no wrench.
#[test]
fn no_wrench_before_every_cable_has_left_its_pulley() {
    let options = [corner_cable(0, Presliding::PerPulley), corner_cable(1, Presliding::PerPulley)];
    let mut compensator = compensator::<2>(&options, MONITOR);
    let geometry = options[0].geometry.unwrap();
    let centre: [f64; 3] =
        core::array::from_fn(|axis| geometry.base_m[axis] - geometry.platform_m[axis] + [0.01, 0.0, 0.0][axis]);
    let inside = Pose::from_parts(centre, [0.0, 0.0, 0.0, 1.0]).unwrap();
    let mut step = |pose| {
        let cables = [CableInput { sensor_force_n: 20.0, length_m: 1.0, speed_m_per_s: 0.0 }; 2];
        compensator.step(&CycleInput { cables, pose: Some(pose), ..CycleInput::default() })
    };
    for _ in 0..3 {
        let output = step(inside);
        assert_eq!(output.cables.map(|cable| cable.status), [CableStatus::POSE_UNREACHABLE, CableStatus::OK]);
        assert_eq!((output.outside_wrench, output.applied_wrench), (None, None));
    }
    assert!(step(somewhere(0.1)).outside_wrench.is_some());
    assert!(step(inside).outside_wrench.is_some());
}

#[test]
fn flags_have_names() {
    assert_eq!(CableStatus::OK.to_string(), "ok");
    assert_eq!((CableStatus::SLACK | CableStatus::POSE_MISSING).to_string(), "SLACK|POSE_MISSING");
    let all = CableStatus::NAMES.iter().fold(CableStatus::OK, |all, (_, flag)| all | *flag);
    assert_eq!(all.bits(), 0x7ff);
    assert_eq!(all.to_string().split('|').count(), 11);
}
