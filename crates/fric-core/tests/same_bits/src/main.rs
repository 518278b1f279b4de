//! Random robots through random cycles: a hash of the bits of all that comes out, a line a robot.
//!
//! Every effect, both forms of presliding, slip limits, poses that are missing or out of reach, faulty signals, skipped
//! cycles, new parameters while it runs; then the admittance. Set-up is part of it. Ends with the flags
//! that have been raised.

use fric_core::admittance::{Admittance, AdmittanceOptions};
use fric_core::effects::Effect;
use fric_core::robot::{
    CableOptions, FrictionOptions, GeometryOptions, MonitorOptions, PlatformOptions, Presliding, PulleyOptions,
    ValidatedRange,
};
use fric_core::{CableParams, Compensator, CycleInput, CycleOutput, Pose, RobotParams, TunableCompensator, Wrench};

const CYCLE_S: f64 = 0.001;
const CYCLES: usize = 1500;

/// A reproducible stream of numbers (`SplitMix64`).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn range(&mut self, least: f64, greatest: f64) -> f64 {
        least + (greatest - least) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn one_in(&mut self, count: u64) -> bool {
        self.bits() % count == 0
    }

    fn vector(&mut self, size: f64) -> [f64; 3] {
        [(); 3].map(|()| self.range(-size, size))
    }
}

/// FNV-1a over bits.
struct Hash(u64);

impl Hash {
    const START: Self = Self(0xcbf2_9ce4_8422_2325);

    fn bits(&mut self, bits: u64) {
        self.0 = (self.0 ^ bits).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23);
    }

    fn numbers<'a>(&mut self, numbers: impl IntoIterator<Item = &'a f64>) {
        for number in numbers {
            assert!(number.is_finite());
            self.bits(number.to_bits());
        }
    }

    fn wrench(&mut self, wrench: Option<&Wrench>) {
        self.bits(u64::from(wrench.is_some()));
        self.numbers(wrench.into_iter().flat_map(|wrench| wrench.force_n.iter().chain(wrench.torque_nm.iter())));
    }

    fn output<const CABLES: usize>(&mut self, output: &CycleOutput<CABLES>) {
        for cable in &output.cables {
            self.numbers(&[cable.force_at_platform_n, cable.friction_n, cable.frictionless_n]);
            self.bits(u64::from(cable.status.bits()));
        }
        self.wrench(output.outside_wrench.as_ref());
        self.wrench(output.applied_wrench.as_ref());
        self.bits(u64::from(output.wrench_status.bits()));
    }
}

/// A cable of any build; `effects` of them at most.
fn cable(random: &mut Random, pulleys: &[PulleyOptions], index: usize, effects: usize) -> CableParams {
    let side = |bit: usize| if index >> bit & 1 == 0 { 1.0 } else { -1.0 };
    let mut options = CableOptions {
        presliding: if random.one_in(2) { Presliding::Lumped } else { Presliding::PerPulley },
        friction: FrictionOptions {
            mu: random.range(0.0, 0.05),
            sigma_n_per_m: (!random.one_in(5)).then_some(random.range(200.0, 2000.0)),
            viscous_n_s_per_m: random.range(0.0, 2.0),
            offset_n: random.range(-0.1, 0.1),
        },
        geometry: Some(GeometryOptions {
            base_m: [0.55 * side(0), 0.4 * side(1), -0.5 * side(2)],
            platform_m: [0.06 * side(0), 0.05 * side(1), 0.05 * side(2)],
        }),
        traction_mu: random.one_in(3).then_some(random.range(0.01, 0.1)),
        validated: if random.one_in(2) {
            ValidatedRange { force_n: [2.0, 30.0], speed_m_per_s: 0.5 }
        } else {
            ValidatedRange::ANY
        },
        ..CableOptions::new(pulleys)
    };
    for _ in 0..effects {
        let effect = Effect::CATALOGUE[random.bits() as usize % Effect::CATALOGUE.len()];
        for parameter in effect.row().parameters {
            let value = match parameter.key {
                "delay_s" => random.range(-0.005, 0.02),
                _ => parameter.neutral + random.range(0.0, 0.02),
            };
            // Some are out of range by themselves; then the neutral value stays.
            let _ = options.effects.set(effect, parameter.key, value);
        }
    }
    CableParams::new(&options)
        .or_else(|_| CableParams::new(&CableOptions { effects: Default::default(), ..options }))
        .unwrap()
}

fn robot<const CABLES: usize>(
    random: &mut Random,
    effects: usize,
    builds: &[Vec<PulleyOptions>],
) -> Compensator<CABLES> {
    let cables: Vec<CableParams> =
        builds.iter().enumerate().map(|(index, pulleys)| cable(random, pulleys, index, effects)).collect();
    let platform =
        PlatformOptions { mass_kg: 0.41, center_of_mass_m: random.vector(0.02), ..PlatformOptions::default() };
    let length_noise_m = if effects > 2 { 2e-6 } else { 0.0 };
    let monitor = MonitorOptions { frozen_cycles: 20, length_jump_m: 0.01, length_noise_m, sensor_jump_n: None };
    Compensator::new(&RobotParams::new(CYCLE_S, &platform, monitor, &cables).unwrap()).unwrap()
}

fn pose(random: &mut Random, t: f64) -> Option<Pose> {
    if random.one_in(40) {
        return None;
    }
    if random.one_in(40) {
        // Within the first cable's last pulley.
        let [x, y, z] = random.vector(0.002);
        return Pose::from_parts([0.49 + x, 0.35 + y, -0.55 + z], [0.0, 0.0, 0.0, 1.0]);
    }
    let reach = [0.1, 0.08, 0.06];
    // Triangles: a sine would be the platform's.
    let wave = |rate: f64| 4.0 * ((rate * t).rem_euclid(1.0) - 0.5).abs() - 1.0;
    let turn = 0.1 * wave(0.31);
    let place = [reach[0] * wave(0.73), reach[1] * wave(1.22), reach[2] * wave(0.49)];
    Pose::from_parts(place, [0.3 * turn, -0.2 * turn, turn, 1.0 - 0.5 * turn * turn])
}

fn run<const CABLES: usize>(random: &mut Random, effects: usize, cables: usize) -> u32 {
    let builds: Vec<Vec<PulleyOptions>> = (0..cables)
        .map(|_| {
            let wrap_rad = random.range(1.0, 3.2);
            let mut pulleys = vec![PulleyOptions::Fixed { wrap_rad: random.range(1.6, 3.2), sensor: random.one_in(2) }];
            pulleys.extend((0..random.bits() % 3).map(|_| PulleyOptions::Fixed { wrap_rad, sensor: false }));
            let axis = random.vector(0.2);
            pulleys.push(PulleyOptions::Swivel { radius_m: 0.01, axis: [axis[0], axis[1], 1.0] });
            pulleys
        })
        .collect();
    let mut next = robot::<CABLES>(random, effects, &builds);
    let mut compensator = TunableCompensator::new(next.clone());
    let mut hash = Hash::START;
    let mut flags = 0;
    let mut output = CycleOutput::default();
    let mut input = CycleInput::<CABLES>::default();
    for cycle in 0..CYCLES {
        let t = cycle as f64 * CYCLE_S;
        input.pose = pose(random, t);
        input.elapsed_cycles = if random.one_in(100) { random.range(0.0, 5.0) } else { 1.0 };
        let holds = random.one_in(3);
        for (index, cable) in input.cables.iter_mut().enumerate() {
            let wave = |rate: f64| 4.0 * ((rate * t + 0.1 * index as f64).rem_euclid(1.0) - 0.5).abs() - 1.0;
            let stands = holds || (300..400).contains(&(cycle % 500));
            cable.speed_m_per_s = if stands { 0.0 } else { 0.1 * wave(2.7) };
            let length_m = if cable.length_m.abs() <= 10.0 { cable.length_m } else { 1.0 };
            cable.length_m = length_m + CYCLE_S * cable.speed_m_per_s;
            let frozen = (700..850).contains(&cycle) && index % 3 == 0;
            if !frozen {
                cable.sensor_force_n = 12.0 + 8.0 * wave(0.9) + random.range(-0.01, 0.01);
            }
            match random.bits() % 2000 {
                0 => cable.sensor_force_n = f64::NAN,
                1 => cable.sensor_force_n = f64::INFINITY,
                2 => cable.sensor_force_n = -random.range(0.0, 2.0),
                3 => cable.length_m = f64::NAN,
                4 => cable.length_m += 0.1,
                5 => cable.speed_m_per_s = f64::NEG_INFINITY,
                6 => cable.speed_m_per_s = 3.0,
                7 => cable.sensor_force_n = 1e-300,
                _ => {}
            }
        }
        if cycle % 400 == 399 {
            next = robot(random, effects, &builds);
            compensator.change(&next, 50).unwrap();
        }
        compensator.step_into(&input, &mut output);
        flags |= output.cables.iter().fold(0, |flags, cable| flags | cable.status.bits());
        hash.output(&output);
    }
    println!("{CABLES} places, {cables} cables, {effects} effects: {:016x}", hash.0);
    flags
}

fn admittance() {
    let body = AdmittanceOptions {
        mass_kg: [2.0, 3.0, 4.0],
        damping_n_s_per_m: [40.0; 3],
        stiffness_n_per_m: [100.0, 0.0, 50.0],
        reach_m: 0.2,
        inertia_kg_m2: [0.01; 3],
        damping_nm_s_per_rad: [0.2; 3],
        stiffness_nm_per_rad: [0.5; 3],
        reach_rad: 0.3,
    };
    let mut admittance = Admittance::new(&body, CYCLE_S, &Pose::identity()).unwrap();
    let mut random = Random(5);
    let mut hash = Hash::START;
    for _ in 0..1000 {
        let wrench = Wrench { force_n: random.vector(5.0).into(), torque_nm: random.vector(0.2).into() };
        let point = admittance.step((!random.one_in(9)).then_some(&wrench));
        hash.numbers(point.pose.position_m.iter().chain(point.pose.orientation.coords.iter()));
    }
    println!("admittance: {:016x}", hash.0);
}

fn main() {
    let mut random = Random(20);
    let mut flags = 0;
    for effects in [0, 1, 5] {
        flags |= run::<1>(&mut random, effects, 1);
        flags |= run::<4>(&mut random, effects, 4);
        flags |= run::<6>(&mut random, effects, 6);
        flags |= run::<8>(&mut random, effects, 8);
        flags |= run::<8>(&mut random, effects, 5);
        flags |= run::<12>(&mut random, effects, 12);
        flags |= run::<19>(&mut random, effects, 19);
    }
    admittance();
    println!("flags: {flags:#x}");
}
