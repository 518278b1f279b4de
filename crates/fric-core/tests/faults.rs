//! Every fault of a robot's signals: in which cycle it is flagged, what the output does meanwhile, and how it returns, beside a twin
//! without the fault. ASSURANCE.md has the table.

use fric_core::effects::Effect;
use fric_core::robot::{CableOptions, MonitorOptions, Presliding, ValidatedRange};
use fric_core::{CableOutput, CableStatus, Compensator, CycleInput};

use crate::bits::bits;
use crate::support::{FRICTION, assert_near, compensator, corner_cable, smooth_input};

const FORMS: [Presliding; 2] = [Presliding::Lumped, Presliding::PerPulley];
const MONITOR: MonitorOptions =
    MonitorOptions { frozen_cycles: 10, length_jump_m: 0.01, length_noise_m: 0.0, sensor_jump_n: None };
/// The sensor's range, as the robot file's `validated` states it.
const RANGE_N: [f64; 2] = [5.0, 18.0];
/// First cycle with a fault: at some 0.08 m/s, everything in steady sliding.
const FIRST: usize = 200;
/// The way on which a cable comes back to 1e-9 N: it forgets over `f_c/σ`, some half a millimetre.
const RETURN_M: f64 = 0.03;
/// Cycles in which it has moved as far, whenever a fault ends.
const RETURN_CYCLES: usize = 1500;
/// More than friction can be here, viscous friction included, N.
const GREATEST_FRICTION_N: f64 = 0.8;

type Input = CycleInput<1>;

/// What came out with the fault and without it, cycle by cycle.
struct Run {
    spoilt: Vec<CableOutput>,
    good: Vec<CableOutput>,
    wrench_status: Vec<CableStatus>,
}

fn robot(presliding: Presliding) -> Compensator<1> {
    let validated = ValidatedRange { force_n: RANGE_N, ..ValidatedRange::ANY };
    compensator(&[CableOptions { validated, ..corner_cable(0, presliding) }], MONITOR)
}

impl Run {
    /// Runs two compensators; `spoil` gets the cycle's number and gives what the one of them sees, `None` if it does not run.
    fn new(presliding: Presliding, cycles: usize, mut spoil: impl FnMut(usize, Input) -> Option<Input>) -> Self {
        let (mut with, mut without) = (robot(presliding), robot(presliding));
        let mut run = Self { spoilt: Vec::new(), good: Vec::new(), wrench_status: Vec::new() };
        for cycle in 0..FIRST + cycles + RETURN_CYCLES {
            let input = smooth_input::<1>(cycle);
            run.good.push(without.step(&input).cables[0]);
            let last = run.spoilt.last().copied().unwrap_or_default();
            let output = spoil(cycle, input).map(|input| with.step(&input));
            run.spoilt.push(output.as_ref().map_or(last, |output| output.cables[0]));
            run.wrench_status.push(output.map_or(CableStatus::OK, |output| output.wrench_status));
        }
        for cycle in 0..FIRST {
            assert_eq!(bits(&run.spoilt[cycle]), bits(&run.good[cycle]));
            assert!(run.good[cycle].status.is_ok());
        }
        run
    }

    /// A fault of these many cycles.
    fn with(presliding: Presliding, cycles: usize, fault: impl Fn(&mut Input)) -> Self {
        Self::new(presliding, cycles, |cycle, mut input| {
            if (FIRST..FIRST + cycles).contains(&cycle) {
                fault(&mut input);
            }
            Some(input)
        })
    }

    /// The flag stands in every cycle of a lie of the sensor, with `SENSOR_JUMP`; after it nothing but that and `UNSETTLED`, until what
    /// it has left is forgotten, and in every cycle in which the force is off by 5 % + 0.1 N.
    fn assert_told(&self, cycles: usize, flag: CableStatus) {
        for cycle in FIRST..FIRST + cycles {
            assert!(self.spoilt[cycle].status.contains(flag | CableStatus::SENSOR_JUMP), "cycle {cycle}");
        }
        self.assert_settles(FIRST + cycles);
    }

    fn assert_settles(&self, from: usize) {
        let doubts = CableStatus::SENSOR_JUMP | CableStatus::UNSETTLED;
        for (cycle, (spoilt, good)) in self.spoilt.iter().zip(&self.good).enumerate().skip(from) {
            assert!(doubts.contains(spoilt.status), "cycle {cycle}: {}", spoilt.status);
            let is_off = self.distance_n(cycle) > 0.05 * good.force_at_platform_n + 0.1;
            assert!(!is_off || !spoilt.status.is_ok(), "cycle {cycle}: {} N", self.distance_n(cycle));
        }
    }

    /// The flag stands in every cycle of the fault, and in none after it.
    fn assert_flagged(&self, cycles: usize, flag: CableStatus) {
        for cycle in FIRST..FIRST + cycles {
            assert_eq!(self.spoilt[cycle].status, flag, "cycle {cycle}");
            assert!(self.wrench_status[cycle].contains(flag));
        }
        assert!(self.spoilt[FIRST + cycles..].iter().all(|output| output.status.is_ok()));
    }

    fn distance_n(&self, cycle: usize) -> f64 {
        (self.spoilt[cycle].force_at_platform_n - self.good[cycle].force_at_platform_n).abs()
    }

    /// From a cycle on the output is at most so far from the twin's, comes nearer in every cycle, and is there in the end: what it
    /// changes by in a cycle differs from the twin's change by no more than the distance that is left.
    fn assert_returns(&self, from: usize, at_most_n: f64) {
        assert!(self.distance_n(from) <= at_most_n, "{} N beyond {at_most_n} N", self.distance_n(from));
        let mut way_m = 0.0;
        for cycle in from + 1..self.spoilt.len() {
            way_m += (length_m(cycle) - length_m(cycle - 1)).abs();
            assert!(self.distance_n(cycle) <= self.distance_n(cycle - 1) + 1e-9, "cycle {cycle} goes away again");
            assert!(way_m < RETURN_M || self.distance_n(cycle) < 1e-9, "cycle {cycle}: {} N", self.distance_n(cycle));
        }
        assert!(way_m > RETURN_M);
    }
}

fn length_m(cycle: usize) -> f64 {
    smooth_input::<1>(cycle).cables[0].length_m
}

/// What one cycle's way can change friction by: Dahl's slope is at most 2σ, each pulley's of its share.
fn of_one_cycle_n() -> f64 {
    let way_m = 0.05 * 1.7 * 0.001;
    2.0 * FRICTION.sigma_n_per_m.unwrap() * way_m
}

#[test]
fn sensor_nan() {
    for presliding in FORMS {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let run = Run::with(presliding, 50, |input| input.cables[0].sensor_force_n = value);
            // In the very cycle.
            run.assert_flagged(50, CableStatus::SENSOR_NOT_FINITE);
            let last = run.spoilt[FIRST - 1];
            for held in &run.spoilt[FIRST..FIRST + 50] {
                assert_eq!(held.friction_n.to_bits(), last.friction_n.to_bits());
                assert_near(held.force_at_platform_n, last.force_at_platform_n, 1e-15);
            }
            // The force is back at once; of the friction is missing what the force has changed it by.
            run.assert_returns(FIRST + 50, 0.01);
        }
    }
}

#[test]
fn sensor_drops_out_for_n_cycles() {
    for presliding in FORMS {
        for cycles in [1, 7, 2000] {
            let run = Run::with(presliding, cycles, |input| input.cables[0].sensor_force_n = f64::NAN);
            run.assert_flagged(cycles, CableStatus::SENSOR_NOT_FINITE);
            // Through reversals too: the stored friction has followed the motion.
            run.assert_returns(FIRST + cycles, 0.15);
            // A bus that gives zero instead: as a slack cable, which stores nothing; friction builds up anew.
            let run = Run::with(presliding, cycles, |input| input.cables[0].sensor_force_n = 0.0);
            let range = CableStatus::OUT_OF_RANGE;
            run.assert_told(cycles, CableStatus::SLACK | range);
            for slack in &run.spoilt[FIRST..FIRST + cycles] {
                assert_near(slack.force_at_platform_n, FRICTION.offset_n, 1e-15);
                assert_eq!(slack.friction_n, 0.0);
            }
            run.assert_returns(FIRST + cycles, GREATEST_FRICTION_N);
        }
    }
}

#[test]
fn sensor_frozen() {
    for presliding in FORMS {
        let shown_n = smooth_input::<1>(FIRST - 1).cables[0].sensor_force_n;
        let run = Run::with(presliding, 60, |input| input.cables[0].sensor_force_n = shown_n);
        // After the cycles that the monitor states and 1 mm of way, whichever is later.
        let moved = |cycle: &usize| (length_m(*cycle) - length_m(FIRST - 1)).abs() >= 1e-3;
        let far = (FIRST..FIRST + 60).find(moved).unwrap();
        let flagged = far.max(FIRST - 1 + usize::try_from(MONITOR.frozen_cycles).unwrap());
        for cycle in FIRST..FIRST + 60 {
            let output = run.spoilt[cycle];
            if cycle < flagged {
                assert!(output.status.is_ok(), "cycle {cycle}");
            } else {
                assert_eq!(output.status, CableStatus::SENSOR_FROZEN, "cycle {cycle}");
                assert_eq!(output.friction_n.to_bits(), run.spoilt[flagged - 1].friction_n.to_bits());
                assert_near(output.force_at_platform_n, run.spoilt[flagged - 1].force_at_platform_n, 1e-15);
            }
        }
        // The first value that differs is believed.
        assert!(run.spoilt[FIRST + 60..].iter().all(|output| output.status.is_ok()));
        run.assert_returns(FIRST + 60, 0.01);
    }
}

#[test]
fn a_frozen_sensor_stays_so_where_the_cable_comes_back() {
    for presliding in FORMS {
        let mut compensator = robot(presliding);
        let mut held: Option<CableOutput> = None;
        for cycle in 0..8000 {
            let phase = std::f64::consts::TAU * 0.5 * f64::from(cycle) * 0.001;
            let mut input = smooth_input::<1>(0);
            let cable = &mut input.cables[0];
            cable.sensor_force_n = 14.0;
            (cable.length_m, cable.speed_m_per_s) =
                (2.0 + 0.05 * phase.sin(), 0.05 * 0.5 * std::f64::consts::TAU * phase.cos());
            let output = compensator.step(&input).cables[0];
            let is_far = (input.cables[0].length_m - 2.0).abs() >= 1e-3;
            let is_due = is_far && cycle >= MONITOR.frozen_cycles;
            assert_eq!(output.status.contains(CableStatus::SENSOR_FROZEN), is_due || held.is_some(), "cycle {cycle}");
            if let Some(held) = held {
                assert_eq!(bits(&output), bits(&held), "cycle {cycle}");
            } else if is_due {
                held = Some(output);
            }
        }
        let mut input = smooth_input::<1>(0);
        (input.cables[0].sensor_force_n, input.cables[0].length_m) = (14.1, 2.0);
        assert!(compensator.step(&input).cables[0].status.is_ok());
    }
}

#[test]
fn sensor_spike() {
    for presliding in FORMS {
        for more_n in [10.0, 500.0, 1e6] {
            let run = Run::with(presliding, 1, |input| input.cables[0].sensor_force_n += more_n);
            // Flagged by the range of the robot file, in the very cycle; a spike within the range cannot be told from a force.
            run.assert_told(1, CableStatus::OUT_OF_RANGE);
            // The output follows the sensor; friction, with the load, by no more than the cycle's way and the viscous part allow.
            let (spike, good) = (run.spoilt[FIRST], run.good[FIRST]);
            assert_near(spike.frictionless_n, good.frictionless_n + 0.5 * more_n, 1e-15);
            assert!((spike.friction_n - good.friction_n).abs() <= of_one_cycle_n() + 1e-9 * more_n);
            run.assert_returns(FIRST + 1, of_one_cycle_n());
        }
        // Downwards it is a cable without tension.
        let run = Run::with(presliding, 1, |input| input.cables[0].sensor_force_n -= 40.0);
        run.assert_told(1, CableStatus::SLACK | CableStatus::OUT_OF_RANGE);
        assert_near(run.spoilt[FIRST].force_at_platform_n, FRICTION.offset_n, 1e-15);
        run.assert_returns(FIRST + 1, GREATEST_FRICTION_N);
    }
}

/// Without `validated`: a lie over 88 cycles is told while it lasts, and what it leaves until it is forgotten.
#[test]
fn sensor_lies_without_a_range() {
    for presliding in FORMS {
        for more_n in [1e2, 1e3, 1e4, 1e5, -1e2, 3.0] {
            let robot = || compensator::<1>(&[corner_cable(0, presliding)], MONITOR);
            let (mut spoilt, mut good) = (robot(), robot());
            let mut off_count = 0;
            for cycle in 0..FIRST + 88 + 5000 + RETURN_CYCLES {
                let mut input = smooth_input::<1>(cycle);
                let expected = good.step(&input).cables[0];
                assert!(expected.status.is_ok(), "cycle {cycle}: {}", expected.status);
                let lies = (FIRST..FIRST + 88).contains(&cycle);
                input.cables[0].sensor_force_n += if lies { more_n } else { 0.0 };
                let output = spoilt.step(&input).cables[0];
                assert_eq!(
                    output.status.contains(CableStatus::SENSOR_JUMP),
                    lies || cycle == FIRST + 88,
                    "cycle {cycle}"
                );
                let off_n = (output.force_at_platform_n - expected.force_at_platform_n).abs();
                let is_off = off_n > 0.05 * expected.force_at_platform_n + 0.1;
                assert!(!is_off || !output.status.is_ok(), "{more_n} N, cycle {cycle}: {off_n} N");
                off_count += usize::from(is_off && !lies);
                // Forgotten, it is not flagged any more.
                assert!(
                    cycle < FIRST + 88 + RETURN_CYCLES || output.status.is_ok(),
                    "cycle {cycle}: {}",
                    output.status
                );
            }
            assert!(more_n < 1e4 || off_count > 0, "nothing was left to tell of");
        }
    }
}

/// However long a sensor has shown nothing new, at rest or dropped out, a change beyond what ten cycles can do is told.
#[test]
fn sensor_lies_after_a_rest_or_a_silence() {
    for presliding in FORMS {
        for is_silent in [false, true] {
            for more_n in [20.0, 1e2, 1e3, 1e5] {
                let mut compensator = compensator::<1>(&[corner_cable(0, presliding)], MONITOR);
                for cycle in 0..FIRST + 2000 + 88 {
                    let mut input = smooth_input::<1>(cycle.min(FIRST));
                    let cable = &mut input.cables[0];
                    if cycle > FIRST {
                        cable.speed_m_per_s = 0.0;
                    }
                    let (is_resting, lies) = (cycle > FIRST, cycle >= FIRST + 2000);
                    cable.sensor_force_n += if lies { more_n } else { 0.0 };
                    if is_silent && is_resting && !lies {
                        cable.sensor_force_n = f64::NAN;
                    }
                    let status = compensator.step(&input).cables[0].status;
                    assert_eq!(status.contains(CableStatus::SENSOR_JUMP), lies, "{more_n} N, cycle {cycle}: {status}");
                }
            }
        }
    }
}

/// A level that stays is taken for the load after 5 s.
#[test]
fn a_step_of_the_load_is_believed_in_the_end() {
    for presliding in FORMS {
        let mut compensator = compensator::<1>(&[corner_cable(0, presliding)], MONITOR);
        for cycle in 0..FIRST + 5000 + RETURN_CYCLES {
            let mut input = smooth_input::<1>(cycle);
            input.cables[0].sensor_force_n += if cycle < FIRST { 0.0 } else { 30.0 };
            let status = compensator.step(&input).cables[0].status;
            assert_eq!(
                status.contains(CableStatus::SENSOR_JUMP),
                (FIRST..FIRST + 5000).contains(&cycle),
                "cycle {cycle}"
            );
            assert!(status.is_ok() || cycle < FIRST + 5000 + RETURN_CYCLES - 1);
        }
    }
}

/// What is stored at rest while the load falls is beyond what the bearings bear then.
#[test]
fn a_load_that_falls_at_rest_is_unsettled_until_the_cable_moves() {
    for presliding in FORMS {
        let monitor = MonitorOptions { frozen_cycles: 0, ..MONITOR };
        let mut compensator = compensator::<1>(&[corner_cable(0, presliding)], monitor);
        let mut step = |force_n: f64, length_m: f64, speed_m_per_s: f64| {
            let mut input = smooth_input::<1>(0);
            input.cables[0] = fric_core::CableInput { sensor_force_n: force_n, length_m, speed_m_per_s };
            compensator.step(&input).cables[0]
        };
        for cycle in 0..1000 {
            assert!(step(30.0, 1e-4 * f64::from(cycle), 0.1).status.is_ok());
        }
        let mut output = CableOutput::default();
        for cycle in 0..1000 {
            output = step(30.0 - 0.027 * f64::from(cycle), 0.1, 0.0);
        }
        assert!(output.friction_n > 0.9 && output.frictionless_n < 1.6, "{output:?}");
        assert_eq!(output.status, CableStatus::UNSETTLED);
        for cycle in 1..=40 {
            output = step(3.0, 0.1 + 1e-4 * f64::from(cycle), 0.1);
        }
        assert_eq!(output.status, CableStatus::OK);
    }
}

#[test]
fn sensor_saturated() {
    for presliding in FORMS {
        // The amplifier stands at its end.
        let run = Run::with(presliding, 60, |input| input.cables[0].sensor_force_n = 20.0);
        for cycle in FIRST..FIRST + 60 {
            let output = run.spoilt[cycle];
            // Out of range at once; frozen as soon as that can be told.
            assert!(output.status.contains(CableStatus::OUT_OF_RANGE), "cycle {cycle}");
            let frozen = output.status.contains(CableStatus::SENSOR_FROZEN);
            assert!(frozen || cycle < FIRST + 14, "cycle {cycle}");
            // As if the force were the amplifier's end, then held.
            assert_near(output.frictionless_n, 10.0, 1e-15);
            assert!(output.friction_n.abs() < GREATEST_FRICTION_N);
            if frozen && run.spoilt[cycle - 1].status.contains(CableStatus::SENSOR_FROZEN) {
                assert_eq!(bits(&output), bits(&run.spoilt[cycle - 1]));
            }
        }
        run.assert_settles(FIRST + 60);
        run.assert_returns(FIRST + 60, GREATEST_FRICTION_N);
    }
}

#[test]
fn length_jump() {
    for presliding in FORMS {
        for jump_m in [0.02, -0.5, 900.0] {
            // The new zero stays.
            let run = Run::new(presliding, 1, |cycle, mut input| {
                input.cables[0].length_m += if cycle >= FIRST { jump_m } else { 0.0 };
                Some(input)
            });
            run.assert_flagged(1, CableStatus::LENGTH_JUMP);
            // Friction held, the force follows the sensor; the way of one cycle is lost.
            assert_eq!(run.spoilt[FIRST].friction_n.to_bits(), run.spoilt[FIRST - 1].friction_n.to_bits());
            assert_eq!(run.spoilt[FIRST].frictionless_n.to_bits(), run.good[FIRST].frictionless_n.to_bits());
            run.assert_returns(FIRST + 1, of_one_cycle_n());
        }
    }
}

#[test]
fn length_or_speed_lost() {
    for presliding in FORMS {
        for cycles in [1, 50] {
            for fault in [
                |input: &mut Input| input.cables[0].length_m = f64::NAN,
                |input: &mut Input| input.cables[0].speed_m_per_s = f64::INFINITY,
            ] {
                let run = Run::with(presliding, cycles, fault);
                run.assert_flagged(cycles, CableStatus::MOTION_NOT_FINITE);
                for cycle in FIRST..FIRST + cycles {
                    assert_eq!(run.spoilt[cycle].friction_n.to_bits(), run.spoilt[FIRST - 1].friction_n.to_bits());
                    assert_eq!(run.spoilt[cycle].frictionless_n.to_bits(), run.good[cycle].frictionless_n.to_bits());
                }
                // The length tells how far the cable has gone meanwhile.
                run.assert_returns(FIRST + cycles, 0.01);
            }
        }
        // Further than a jump: told as one, for one cycle.
        let run = Run::with(presliding, 400, |input| input.cables[0].length_m = f64::NAN);
        assert_eq!(run.spoilt[FIRST + 400].status, CableStatus::LENGTH_JUMP);
        assert!(run.spoilt[FIRST + 401..].iter().all(|output| output.status.is_ok()));
        run.assert_returns(FIRST + 401, 0.05);
    }
}

#[test]
fn pose_missing() {
    for presliding in FORMS {
        for cycles in [1, 500] {
            let pose = smooth_input::<1>(FIRST - 1).pose;
            let run = Run::with(presliding, cycles, |input| input.pose = None);
            let still = Run::with(presliding, cycles, |input| input.pose = pose);
            run.assert_flagged(cycles, CableStatus::POSE_MISSING);
            // As if the platform stood still.
            for cycle in FIRST..run.spoilt.len() {
                let forces_n = [&run, &still].map(|run| run.spoilt[cycle].force_at_platform_n.to_bits());
                assert_eq!(forces_n[0], forces_n[1]);
            }
            // A wrap that is off by some degrees rubs that much less or more.
            run.assert_returns(FIRST + cycles, 0.05);
        }
    }
}

#[test]
fn cycles_skipped() {
    for presliding in FORMS {
        for cycles in [1, 3, 100] {
            for told in [true, false] {
                let run = Run::new(presliding, cycles, |cycle, mut input| {
                    if (FIRST..FIRST + cycles).contains(&cycle) {
                        return None;
                    }
                    if told && cycle == FIRST + cycles {
                        input.elapsed_cycles += f64::from(u32::try_from(cycles).unwrap());
                    }
                    Some(input)
                });
                // Friction knows no time: half the way twice is the whole way, and nothing is the matter.
                run.assert_flagged(0, CableStatus::OK);
                run.assert_returns(FIRST + cycles, 0.01);
            }
        }
        // A way that is a jump in one cycle, and none in the cycles that have elapsed.
        for (told, status) in [(true, CableStatus::OK), (false, CableStatus::LENGTH_JUMP)] {
            let run = Run::new(presliding, 400, |cycle, mut input| {
                if (FIRST..FIRST + 400).contains(&cycle) {
                    return None;
                }
                if told && cycle == FIRST + 400 {
                    input.elapsed_cycles = 401.0;
                }
                Some(input)
            });
            assert_eq!(run.spoilt[FIRST + 400].status, status);
            assert!(run.spoilt[FIRST + 401..].iter().all(|output| output.status.is_ok()));
            run.assert_returns(FIRST + 400 + usize::from(!told), 0.05);
        }
    }
}

#[test]
fn signals_a_cycle_late() {
    for presliding in FORMS {
        let run = Run::new(presliding, 1, |cycle, input| {
            // The bus has nothing new: the signals of the cycle before once more, then two cycles' way at once.
            Some(if cycle == FIRST { smooth_input::<1>(cycle - 1) } else { input })
        });
        run.assert_flagged(0, CableStatus::OK);
        // The same signals have the same outcome; viscous friction of the lumped form goes by the direction too (\[P\] 10).
        let (again, last) = (run.spoilt[FIRST], run.spoilt[FIRST - 1]);
        match presliding {
            Presliding::PerPulley => assert_eq!(bits(&again), bits(&last)),
            Presliding::Lumped => assert!((again.force_at_platform_n - last.force_at_platform_n).abs() < 0.005),
        }
        run.assert_returns(FIRST + 1, 0.001);
        // Late from here on: the outcome is late by a cycle, and that is all.
        let run = Run::new(presliding, 1, |cycle, input| {
            Some(if cycle >= FIRST { smooth_input::<1>(cycle - 1) } else { input })
        });
        for cycle in FIRST + 1..run.spoilt.len() {
            assert_eq!(bits(&run.spoilt[cycle]), bits(&run.good[cycle - 1]));
        }
    }
}

/// The phase of a ripple along the cable is that of the led length: a fault does not move it for good.
#[test]
fn a_ripple_under_a_lead_comes_back() {
    for presliding in FORMS {
        let mut options = corner_cable(0, presliding);
        for (kind, key, value) in [
            ("time_delay", "delay_s", -0.007),
            ("pulley_eccentricity", "sin_ratio", 0.1),
            ("pulley_eccentricity", "period_m", 0.05),
        ] {
            options.effects.set(Effect::of_kind(kind).unwrap(), key, value).unwrap();
        }
        let (mut good, mut spoilt) = (compensator::<1>(&[options], MONITOR), compensator::<1>(&[options], MONITOR));
        for cycle in 0..FIRST + 50 + RETURN_CYCLES {
            let mut input = smooth_input::<1>(cycle);
            let expected = good.step(&input).cables[0].force_at_platform_n;
            if (FIRST..FIRST + 50).contains(&cycle) && cycle % 10 < 3 {
                input.cables[0].length_m = f64::NAN;
            }
            let force_n = spoilt.step(&input).cables[0].force_at_platform_n;
            assert!(
                cycle < FIRST + 1000 || (force_n - expected).abs() < 1e-9,
                "cycle {cycle}: {force_n} N, not {expected} N"
            );
        }
    }
}
