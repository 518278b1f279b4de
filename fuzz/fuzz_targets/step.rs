//! Cycles of a few robots with any numbers: finite, flagged where a signal is none, and no cable hears of another's.
#![no_main]

use std::sync::LazyLock;

use arbitrary::Arbitrary;
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, CableOutput, CableStatus, Compensator, CycleInput, Pose};
use libfuzzer_sys::fuzz_target;
use nalgebra::{Quaternion, UnitQuaternion};

const CABLES: usize = 8;
static ROBOTS: LazyLock<[Compensator<CABLES>; 4]> = LazyLock::new(|| {
    [
        include_str!("../../examples/mini-ipanema.toml"),
        include_str!("../seeds/robot_file/effects.toml"),
        include_str!("../seeds/robot_file/lumped.toml"),
        include_str!("../seeds/robot_file/slip.toml"),
    ]
    .map(|text| {
        let robot = RobotFile::parse(text, "robot").unwrap_or_else(|error| panic!("{error}"));
        Compensator::new(&robot.params()).expect("no more cables than there is room for")
    })
});

#[derive(Arbitrary, Clone, Copy, Debug)]
enum Number {
    Bits(u64),
    /// In thousandths.
    Small(i16),
    /// In micrometres beside 1.
    Near(i16),
    Special(u8),
}

impl Number {
    fn value(self) -> f64 {
        const SPECIAL: [f64; 12] = [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE,
            5e-324,
            -0.0,
            1e9,
            -1e9,
            1e6,
            -1e6,
            1e300,
        ];
        match self {
            Self::Bits(bits) => f64::from_bits(bits),
            Self::Small(thousandths) => f64::from(thousandths) / 1000.0,
            Self::Near(micrometres) => 1.0 + f64::from(micrometres) / 1e6,
            Self::Special(which) => SPECIAL[usize::from(which) % SPECIAL.len()],
        }
    }
}

#[derive(Arbitrary, Debug)]
struct Signals {
    sensor_force: Number,
    length: Number,
    speed: Number,
}

impl Signals {
    fn input(&self) -> CableInput {
        let Self { sensor_force, length, speed } = self;
        CableInput {
            sensor_force_n: 10.0 + sensor_force.value(),
            length_m: length.value(),
            speed_m_per_s: speed.value(),
        }
    }
}

#[derive(Arbitrary, Debug)]
struct Cycle {
    cable: u8,
    signals: Signals,
    pose: Option<([Number; 3], Option<[Number; 4]>)>,
    elapsed: Option<Number>,
}

#[derive(Arbitrary, Debug)]
struct Input {
    robot: u8,
    cycles: Vec<Cycle>,
}

fuzz_target!(|input: Input| {
    let mut compensator = ROBOTS[usize::from(input.robot) % ROBOTS.len()].clone();
    let count = compensator.cable_count();
    let good = CableInput { sensor_force_n: 10.0, length_m: 1.0, speed_m_per_s: 0.0 };
    let mut signals = CycleInput { cables: [good; CABLES], ..CycleInput::default() };
    for cycle in &input.cycles {
        let cable = usize::from(cycle.cable) % count;
        let mut without = compensator.clone();
        signals.pose = pose(cycle);
        signals.elapsed_cycles = cycle.elapsed.map_or(1.0, Number::value);
        let expected = without.step(&signals);
        signals.cables[cable] = cycle.signals.input();
        let snapshot = compensator.snapshot();
        let output = compensator.step(&signals);
        for (place, (one, other)) in output.cables.iter().zip(&expected.cables).enumerate().take(count) {
            assert!(place == cable || bits(one) == bits(other), "cable {place}: {one:?} beside {other:?}");
            check(&signals.cables[place], one);
        }
        for wrench in [output.outside_wrench, output.applied_wrench].into_iter().flatten() {
            assert!(wrench.to_vector().iter().all(|part| part.is_finite()), "{wrench:?}");
        }
        compensator.restore(&snapshot);
        assert_eq!(compensator.step(&signals), output);
    }
});

fn pose(cycle: &Cycle) -> Option<Pose> {
    let (position, rotation) = cycle.pose?;
    let [x, y, z, w] = rotation.map_or([0.0, 0.0, 0.0, 1.0], |parts| parts.map(Number::value));
    let orientation = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Some(Pose { position_m: position.map(Number::value).into(), orientation })
}

fn bits(output: &CableOutput) -> ([u64; 3], u32) {
    let CableOutput { force_at_platform_n, friction_n, frictionless_n, status } = *output;
    ([force_at_platform_n, friction_n, frictionless_n].map(f64::to_bits), status.bits())
}

fn check(input: &CableInput, output: &CableOutput) {
    let numbers = [output.force_at_platform_n, output.friction_n, output.frictionless_n];
    assert!(numbers.iter().all(|number| number.is_finite()), "{output:?}");
    let known = CableStatus::NAMES.iter().fold(CableStatus::OK, |all, (_, flag)| all | *flag);
    assert!(known.contains(output.status));
    let no_force = input.sensor_force_n.is_nan() || input.sensor_force_n.abs() > 1e9;
    assert_eq!(output.status.contains(CableStatus::SENSOR_NOT_FINITE), no_force, "{input:?} {output:?}");
    let no_motion = !(input.length_m.abs() <= 1e6 && input.speed_m_per_s.abs() <= 1e6);
    assert_eq!(output.status.contains(CableStatus::MOTION_NOT_FINITE), no_motion, "{input:?} {output:?}");
}
