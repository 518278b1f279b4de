//! Cycles on hostile signals, each a call of `one_cycle`, for callgrind to count one by one: `worst_case ROBOT CYCLES SEED`, or
//! `calm` for the seed: without anything hostile. By benches/worst-case.sh.

#![allow(missing_docs, clippy::expect_used)]
#![allow(clippy::panic, reason = "a tool for developers: a wrong command line stops it")]

#[path = "../crates/fric-core/tests/random.rs"]
#[allow(dead_code, clippy::unwrap_used, reason = "the tests' own")]
mod random;

use std::hint::black_box;
use std::path::Path;

use fric_core::robot::file::RobotFile;
use fric_core::{AnyCompensator, CableInput, Pose, Wrench};

use random::Random;

/// What a cable's signals do for a while.
#[derive(Clone, Copy)]
enum Way {
    Smooth,
    Rest,
    Slack,
    Spikes,
    Jumps,
    Frozen,
    ForceNotANumber,
    MotionNotANumber,
    /// Forces and ways so small that their products are below the normal numbers.
    Tiny,
    Anything,
}

const WAYS: [Way; 10] = [
    Way::Smooth,
    Way::Rest,
    Way::Slack,
    Way::Spikes,
    Way::Jumps,
    Way::Frozen,
    Way::ForceNotANumber,
    Way::MotionNotANumber,
    Way::Tiny,
    Way::Anything,
];

/// How long a way of signals lasts, cycles.
const WAY_CYCLES: usize = 40;

fn any_way(random: &mut Random) -> Way {
    WAYS[usize::try_from(random.below(WAYS.len() as u64)).expect("a handful")]
}

/// From 1e-12 to 1e9, both signs.
fn any_size(random: &mut Random) -> f64 {
    10_f64.powf(random.range(-12.0, 9.0)) * if random.below(2) == 0 { 1.0 } else { -1.0 }
}

fn advance(cable: &mut CableInput, way: Way, cycle_s: f64, random: &mut Random) {
    *cable = CableInput {
        sensor_force_n: if cable.sensor_force_n.is_finite() { cable.sensor_force_n } else { 20.0 },
        length_m: if cable.length_m.is_finite() { cable.length_m } else { 1.0 },
        speed_m_per_s: if cable.speed_m_per_s.is_finite() { cable.speed_m_per_s } else { 0.0 },
    };
    let force_n = (cable.sensor_force_n.clamp(5.0, 50.0) + random.range(-0.2, 0.2)).abs();
    let speed_m_per_s = (cable.speed_m_per_s + random.range(-0.02, 0.02)).clamp(-0.5, 0.5);
    *cable = CableInput { sensor_force_n: force_n, length_m: cable.length_m + speed_m_per_s * cycle_s, speed_m_per_s };
    let once_in = |times: u64, random: &mut Random| random.below(times) == 0;
    match way {
        Way::Rest => cable.speed_m_per_s = 0.0,
        Way::Slack => cable.sensor_force_n = if once_in(2, random) { 0.0 } else { -force_n },
        Way::Spikes if once_in(3, random) => cable.sensor_force_n += any_size(random),
        Way::Jumps if once_in(3, random) => cable.length_m += any_size(random),
        Way::Smooth | Way::Spikes | Way::Jumps => {}
        Way::Frozen => cable.sensor_force_n = 20.0,
        Way::ForceNotANumber => cable.sensor_force_n = f64::NAN,
        Way::MotionNotANumber if once_in(2, random) => cable.length_m = f64::INFINITY,
        Way::MotionNotANumber => cable.speed_m_per_s = f64::NAN,
        Way::Tiny => {
            cable.sensor_force_n = any_size(random).abs() * 1e-300;
            cable.speed_m_per_s = any_size(random) * 1e-300;
        }
        Way::Anything => {
            cable.sensor_force_n = any_size(random);
            cable.speed_m_per_s = any_size(random);
            cable.length_m = any_size(random);
        }
    }
}

/// What callgrind counts.
#[inline(never)]
fn one_cycle(
    compensator: &mut AnyCompensator,
    cables: &[CableInput],
    pose: Option<Pose>,
    elapsed_cycles: f64,
) -> Option<Wrench> {
    compensator.set_input(cables, pose, elapsed_cycles);
    compensator.step()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [robot, cycles, seed] = arguments.as_slice() else {
        panic!("usage: worst_case ROBOT CYCLES SEED|calm");
    };
    let robot = RobotFile::read(Path::new(robot)).expect("a robot file");
    let params = robot.params();
    let mut compensator = AnyCompensator::new(&params).expect("room for its cables");
    let is_calm = seed == "calm";
    let mut random = Random::new(if is_calm { 0 } else { seed.parse().expect("a seed") });
    let good = CableInput { sensor_force_n: 20.0, length_m: 1.0, speed_m_per_s: 0.0 };
    let mut cables = vec![good; robot.cable_names().len()];
    let mut ways = vec![Way::Smooth; cables.len()];
    let mut pose = is_calm.then(|| random.pose(0.1));
    for cycle in 0..cycles.parse().expect("a number of cycles") {
        if cycle % WAY_CYCLES == 0 && !is_calm {
            // All alike, so that all cost most at once, or each its own.
            let common = any_way(&mut random);
            let is_common = random.below(2) == 0;
            ways.fill_with(|| if is_common { common } else { any_way(&mut random) });
        }
        for (cable, way) in cables.iter_mut().zip(&ways) {
            advance(cable, *way, params.cycle_s(), &mut random);
        }
        if random.below(4) == 0 && !is_calm {
            let reach_m = 10_f64.powf(random.range(-3.0, 2.0));
            pose = (random.below(4) > 0).then(|| random.pose(reach_m));
        }
        let elapsed_cycles = if random.below(10) == 0 && !is_calm { random.range(1.0, 1000.0) } else { 1.0 };
        black_box(one_cycle(&mut compensator, &cables, pose, elapsed_cycles));
    }
}
