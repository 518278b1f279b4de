//! The one place that benches and peers take their robot and their signals from.

use std::hint::black_box;
use std::time::Instant;

use fric_core::robot::{
    CableOptions, CableParams, FrictionOptions, GeometryOptions, MonitorOptions, PlatformOptions, Presliding,
    PulleyOptions, RobotParams,
};
use fric_core::{CableInput, Compensator, CycleInput, CycleOutput, Pose};

/// Cables of the robot that is compared with others.
pub const CABLES: usize = 8;
/// Cycles of the motion before it repeats.
pub const CYCLES: usize = 4096;
/// Cycle time, s.
pub const CYCLE_S: f64 = 0.001;

const PULLEYS: [PulleyOptions; 3] = [
    PulleyOptions::Fixed { wrap_rad: core::f64::consts::PI, sensor: true },
    PulleyOptions::Fixed { wrap_rad: core::f64::consts::FRAC_PI_2, sensor: false },
    PulleyOptions::Swivel { radius_m: 0.01, axis: [0.0, 0.0, 1.0] },
];

/// A cable at each corner of a box, beyond eight of a larger one, friction of the size that the paper publishes, every cable a
/// little different.
pub fn cable_options<const COUNT: usize>(presliding: Presliding) -> [CableOptions<'static>; COUNT] {
    core::array::from_fn(|index| {
        let side = |bit: usize| if index >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let share = (index % CABLES) as f64 / CABLES as f64;
        let larger = 1.0 + 0.05 * (index / CABLES) as f64;
        CableOptions {
            presliding,
            friction: FrictionOptions {
                mu: 0.011 + 0.014 * share,
                sigma_n_per_m: Some(600.0 + 400.0 * share),
                viscous_n_s_per_m: 1.18 + share,
                offset_n: 0.02 * side(0),
            },
            geometry: Some(GeometryOptions {
                base_m: [0.55 * side(0), 0.4 * side(1), 0.5 * side(2)].map(|place| larger * place),
                platform_m: [0.06 * side(0), 0.05 * side(1), -0.05 * side(2)],
            }),
            ..CableOptions::new(&PULLEYS)
        }
    })
}

/// The compensator of that robot.
pub fn compensator<const COUNT: usize>(presliding: Presliding) -> Compensator<COUNT> {
    let cables: Vec<CableParams> = cable_options::<COUNT>(presliding)
        .iter()
        .map(|options| CableParams::new(options).expect("good options"))
        .collect();
    let platform = PlatformOptions { mass_kg: 0.41, center_of_mass_m: [0.01, -0.02, 0.005], ..Default::default() };
    let robot = RobotParams::new(CYCLE_S, &platform, MonitorOptions::for_cycle(CYCLE_S), &cables).expect("good robot");
    Compensator::new(&robot).expect("room for all cables")
}

/// Position of the platform and its derivative: three incommensurable swings, so that the cables reverse at different
/// times.
fn motion(t: f64) -> ([f64; 3], [f64; 3]) {
    let swing = |size: f64, rate: f64, phase: f64| {
        let angle = core::f64::consts::TAU * rate * t + phase;
        (size * angle.sin(), size * core::f64::consts::TAU * rate * angle.cos())
    };
    let parts = [swing(0.12, 0.73, 0.0), swing(0.10, 1.22, 1.0), swing(0.08, 0.49, 2.0)];
    (parts.map(|(place, _)| place), parts.map(|(_, speed)| speed))
}

/// Smooth motion with reversals; forces with a sensor's last bits in them, so that none repeats.
pub fn inputs<const COUNT: usize>() -> Vec<CycleInput<COUNT>> {
    let robot =
        cable_options::<COUNT>(Presliding::Lumped).map(|options| CableParams::new(&options).expect("good options"));
    let mut noise = 0x1234_5678_9abc_def0_u64;
    let mut draw = || {
        noise ^= noise << 13;
        noise ^= noise >> 7;
        noise ^= noise << 17;
        (noise >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    // There and back, so that nothing jumps where the motion repeats.
    (0..CYCLES)
        .map(|cycle| {
            let is_back = cycle >= CYCLES / 2;
            let t = if is_back { CYCLES - cycle } else { cycle } as f64 * CYCLE_S;
            let (place, speed) = motion(t);
            let speed = if is_back { speed.map(|part| -part) } else { speed };
            let turn = 0.15 * (2.0 * t).sin();
            let pose = Pose::from_parts(place, [0.3 * turn, -0.2 * turn, turn, (1.0 - 1.13 * turn * turn).sqrt()])
                .expect("a good pose");
            let cables = core::array::from_fn(|index| {
                let cable = &robot[index];
                let direction = cable.direction(&pose).expect("reachable");
                let along: f64 = direction.iter().zip(speed).map(|(part, speed)| part * speed).sum();
                CableInput {
                    sensor_force_n: 14.0 + 4.0 * (1.9 * t + index as f64).sin() + 0.02 * draw(),
                    length_m: cable.length_m(&pose).expect("reachable"),
                    speed_m_per_s: -along,
                }
            });
            CycleInput { cables, pose: Some(pose), ..CycleInput::default() }
        })
        .collect()
}

/// So many times the whole motion; ns per cycle in the best of them, which others on the machine have disturbed least.
pub fn best_ns<const COUNT: usize>(presliding: Presliding, rounds: usize) -> f64 {
    let inputs = inputs::<COUNT>();
    let mut compensator = compensator::<COUNT>(presliding);
    let mut output = CycleOutput::default();
    let mut best_s = f64::INFINITY;
    for _ in 0..rounds {
        let start = Instant::now();
        for input in &inputs {
            compensator.step_into(black_box(input), &mut output);
            black_box(&output);
        }
        best_s = best_s.min(start.elapsed().as_secs_f64());
    }
    best_s * 1e9 / CYCLES as f64
}
