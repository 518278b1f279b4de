//! Every function of the cycle under `no_panic`: a path to a panic is a link error.

use std::hint::black_box;

use fric_core::effects::Effect;
use fric_core::admittance::{Admittance, AdmittanceOptions, SetPoint};
use fric_core::robot::{
    CableOptions, FrictionOptions, GeometryOptions, MAX_PULLEYS, MonitorOptions, PlatformOptions, Presliding,
    PulleyOptions,
};
use fric_core::{CableParams, Compensator, CycleInput, CycleOutput, Pose, RobotParams, Snapshot, TunableCompensator, Wrench};
use no_panic::no_panic;

#[no_panic]
#[inline(never)]
fn admit(admittance: &mut Admittance, wrench: Option<&Wrench>) -> SetPoint {
    admittance.step(wrench)
}

macro_rules! cycle_of {
    ($module:ident, $cables:literal) => {
        mod $module {
            use super::*;

            #[no_panic]
            #[inline(never)]
            pub fn step(compensator: &mut Compensator<$cables>, input: &CycleInput<$cables>) -> CycleOutput<$cables> {
                #[cfg(feature = "deliberate-panic")]
                assert!(input.cables[0].sensor_force_n < 1e12);
                compensator.step(input)
            }

            #[no_panic]
            #[inline(never)]
            pub fn step_into(
                compensator: &mut Compensator<$cables>,
                input: &CycleInput<$cables>,
                output: &mut CycleOutput<$cables>,
            ) {
                compensator.step_into(input, output);
            }

            #[no_panic]
            #[inline(never)]
            pub fn snapshot(compensator: &Compensator<$cables>) -> Snapshot<$cables> {
                compensator.snapshot()
            }

            #[no_panic]
            #[inline(never)]
            pub fn restore(compensator: &mut Compensator<$cables>, snapshot: &Snapshot<$cables>) {
                compensator.reset();
                compensator.restore(snapshot);
            }

            #[no_panic]
            #[inline(never)]
            pub fn friction(compensator: &Compensator<$cables>, cable: usize) -> [f64; MAX_PULLEYS] {
                compensator.pulley_friction_n(cable)
            }

            #[no_panic]
            #[inline(never)]
            pub fn tunable_step(
                tunable: &mut TunableCompensator<$cables>,
                input: &CycleInput<$cables>,
                output: &mut CycleOutput<$cables>,
            ) {
                tunable.step_into(input, output);
            }

            #[no_panic]
            #[inline(never)]
            pub fn change(tunable: &mut TunableCompensator<$cables>, next: &Compensator<$cables>) -> bool {
                tunable.change(next, 7).is_ok()
            }

            /// Calls all of them with values that the optimiser does not know.
            pub fn run(robot: &RobotParams<'_>) {
                let Ok(mut compensator) = Compensator::<$cables>::new(robot) else { return };
                let mut input = CycleInput::default();
                input.pose = black_box(Some(Pose::identity()));
                let mut output = step(black_box(&mut compensator), black_box(&input));
                step_into(black_box(&mut compensator), black_box(&input), black_box(&mut output));
                let state = snapshot(black_box(&compensator));
                restore(black_box(&mut compensator), black_box(&state));
                black_box(friction(black_box(&compensator), black_box(2)));
                let mut tunable = TunableCompensator::new(compensator.clone());
                black_box(change(black_box(&mut tunable), black_box(&compensator)));
                tunable_step(black_box(&mut tunable), black_box(&input), black_box(&mut output));
            }
        }
    };
}

cycle_of!(one, 1);
cycle_of!(three, 3);
cycle_of!(eight, 8);
cycle_of!(seventeen, 17);

fn main() {
    let body = AdmittanceOptions {
        mass_kg: black_box([2.0; 3]),
        damping_n_s_per_m: [40.0; 3],
        stiffness_n_per_m: [100.0; 3],
        reach_m: 0.2,
        inertia_kg_m2: [0.01; 3],
        damping_nm_s_per_rad: [0.2; 3],
        stiffness_nm_per_rad: [0.5; 3],
        reach_rad: 0.3,
    };
    let mut admittance = Admittance::new(&body, 0.001, &Pose::identity()).unwrap();
    black_box(admit(black_box(&mut admittance), black_box(Some(&Wrench::default()))));
    let pulleys = [
        PulleyOptions::Fixed { wrap_rad: core::f64::consts::PI, sensor: true },
        PulleyOptions::Swivel { radius_m: 0.01, axis: [0.0, 0.0, 1.0] },
    ];
    for presliding in [Presliding::Lumped, Presliding::PerPulley] {
        let mut options = CableOptions {
            presliding,
            friction: FrictionOptions { mu: 0.02, sigma_n_per_m: Some(950.0), ..FrictionOptions::default() },
            geometry: Some(GeometryOptions { base_m: [0.5, 0.4, 0.3], platform_m: [0.05, 0.0, 0.02] }),
            traction_mu: black_box(Some(0.1)),
            ..CableOptions::new(&pulleys)
        };
        options.effects.set(Effect::TimeDelay, "delay_s", black_box(0.005)).unwrap();
        options.effects.set(Effect::Stribeck, "ratio", black_box(0.5)).unwrap();
        let cables = [CableParams::new(&options).unwrap()];
        let platform = PlatformOptions::default();
        let robot = RobotParams::new(0.001, &platform, MonitorOptions::for_cycle(0.001), &cables).unwrap();
        one::run(&robot);
        three::run(&robot);
        eight::run(&robot);
        seventeen::run(&robot);
    }
}
