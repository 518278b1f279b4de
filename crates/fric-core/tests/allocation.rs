//! The cycle does not allocate: counted by an allocator of this binary's own.
#![allow(clippy::unwrap_used, reason = "a test")]

use allocation_counter::measure;
use fric_core::effects::Effect;
use fric_core::effects::ripple::PERIOD_KEY;
use fric_core::forward::PoseFollower;
use fric_core::robot::{
    CableOptions, FrictionOptions, GeometryOptions, MonitorOptions, PlatformOptions, Presliding, PulleyOptions,
};
use fric_core::{CableInput, CableParams, Compensator, CycleInput, CycleOutput, Pose, RobotParams, TunableCompensator};

const PULLEYS: [PulleyOptions; 3] = [
    PulleyOptions::Fixed { wrap_rad: std::f64::consts::PI, sensor: true },
    PulleyOptions::Fixed { wrap_rad: std::f64::consts::FRAC_PI_2, sensor: false },
    PulleyOptions::Swivel { radius_m: 0.01, axis: [0.0, 0.0, 1.0] },
];

fn everything_on() -> Compensator<8> {
    let cables: Vec<CableParams> = (0..7)
        .map(|index| {
            let mut options = CableOptions {
                presliding: if index % 2 == 0 { Presliding::PerPulley } else { Presliding::Lumped },
                friction: FrictionOptions {
                    mu: 0.02,
                    sigma_n_per_m: Some(950.0),
                    viscous_n_s_per_m: 0.5,
                    offset_n: 0.1,
                },
                geometry: Some(GeometryOptions {
                    base_m: [0.5, 0.1 * f64::from(index) - 0.3, 0.4],
                    platform_m: [0.05, 0.0, 0.02],
                }),
                traction_mu: Some(0.05),
                ..CableOptions::new(&PULLEYS)
            };
            for effect in Effect::CATALOGUE {
                for (parameter, example) in effect.row().parameters.iter().zip(effect.row().example) {
                    let value = match parameter.key {
                        "delay_s" => 0.0105,
                        // The second ripple has a period of its own.
                        PERIOD_KEY if effect.is_second() => 0.4 * example,
                        _ => *example,
                    };
                    options.effects.set(*effect, parameter.key, value).unwrap();
                }
            }
            CableParams::new(&options).unwrap()
        })
        .collect();
    let monitor = MonitorOptions { frozen_cycles: 10, length_jump_m: 0.01, length_noise_m: 0.0, sensor_jump_n: None };
    let robot = RobotParams::new(0.001, &PlatformOptions::default(), monitor, &cables).unwrap();
    Compensator::new(&robot).unwrap()
}

fn input(cycle: u32) -> CycleInput<8> {
    let t = f64::from(cycle) * 0.001;
    let mut cables =
        [CableInput { sensor_force_n: 10.0 + t.sin(), length_m: 1.0 + 0.1 * t.cos(), speed_m_per_s: -0.1 * t.sin() };
            8];
    if let Some(cable) = cables.get_mut((cycle % 11) as usize) {
        match cycle % 7 {
            0 => cable.sensor_force_n = f64::NAN,
            1 => cable.length_m = f64::INFINITY,
            2 => cable.speed_m_per_s = f64::NAN,
            3 => cable.length_m += 1.0,
            4 => cable.sensor_force_n = -1.0,
            _ => {}
        }
    }
    let pose = Pose::from_parts([0.0, 0.05 * t.sin(), -0.1], [0.0, 0.0, 0.0, 1.0]);
    CycleInput { cables, pose: pose.filter(|_| !cycle.is_multiple_of(13)), ..CycleInput::default() }
}

#[test]
fn the_cycle_does_not_allocate() {
    let mut compensator = everything_on();
    let mut output = CycleOutput::default();
    let mut flagged = 0_u32;
    let counted = measure(|| {
        for cycle in 0..5000 {
            let input = input(cycle);
            output = compensator.step(&input);
            compensator.step_into(&input, &mut output);
            flagged += u32::from(output.cables.iter().any(|cable| !cable.status.is_ok()));
            if cycle % 1000 == 0 {
                let snapshot = compensator.snapshot();
                compensator.reset();
                compensator.restore(&snapshot);
            }
        }
    });
    assert_eq!(counted.count_total, 0);
    let (mut tunable, next) = (TunableCompensator::new(compensator.clone()), everything_on());
    let counted = measure(|| {
        for cycle in 0..200 {
            if cycle % 40 == 0 {
                tunable.change(&next, 20).unwrap();
            }
            tunable.step_into(&input(cycle), &mut output);
        }
    });
    assert_eq!(counted.count_total, 0);
    assert!(flagged > 1000, "{flagged} flagged cycles are too few to mean anything");
    assert!(measure(|| drop(std::hint::black_box(vec![1.0, 2.0]))).count_total > 0, "the counter does not count");
}

#[test]
fn the_pose_from_lengths_does_not_allocate() {
    let corner = |index: u32| {
        let [x, y, z] = [0, 1, 2].map(|bit| if index >> bit & 1 == 0 { 1.0 } else { -1.0 });
        let platform_m = if z > 0.0 { [0.02 * x, 0.08 * y, -0.07] } else { [0.08 * x, 0.02 * y, 0.07] };
        let geometry = Some(GeometryOptions { base_m: [0.6 * x, 0.5 * y, 0.7 * z], platform_m });
        CableParams::new(&CableOptions { geometry, ..CableOptions::new(&PULLEYS) }).unwrap()
    };
    let cables: Vec<CableParams> = (0..8).map(corner).collect();
    let monitor = MonitorOptions::for_cycle(0.001);
    let robot = RobotParams::new(0.001, &PlatformOptions::default(), monitor, &cables).unwrap();
    let (mut follower, mut posed) = (PoseFollower::default(), 0);
    let counted = measure(|| {
        for cycle in 0..500 {
            let place = 0.1 * (0.01 * f64::from(cycle)).sin();
            let pose = Pose::from_parts([place, 0.0, -place], [0.0, 0.0, 0.0, 1.0]).unwrap();
            let mut inputs = [CableInput::default(); 8];
            for (input, cable) in inputs.iter_mut().zip(&cables) {
                input.length_m = if cycle % 9 == 0 { f64::NAN } else { cable.length_m(&pose).unwrap() };
            }
            posed += u32::from(follower.next_pose(&robot, &inputs).is_ok());
        }
    });
    assert_eq!((counted.count_total, posed), (0, 444));
}
