//! A compensator whose number of cables is known at run time is the one of that number, in everything that it shows.

use fric_core::robot::{CableOptions, FrictionOptions, Presliding};
use fric_core::{AnyCompensator, CableInput, CableOutput, CableStatus, Compensator, Pose, RobotParams};

use crate::support::{
    FRICTION, GUIDE_90, SENSOR_180, SWIVEL, UNMONITORED, checked, corner_cable, platform, smooth_input,
};

fn cables(count: usize) -> Vec<CableOptions<'static>> {
    let presliding = |index: usize| if index.is_multiple_of(2) { Presliding::PerPulley } else { Presliding::Lumped };
    (0..count).map(|index| corner_cable(index, presliding(index))).collect()
}

fn any(options: &[CableOptions<'_>]) -> AnyCompensator {
    let cables = checked(options);
    AnyCompensator::new(&RobotParams::new(0.001, &platform(), UNMONITORED, &cables).unwrap()).unwrap()
}

/// One number of cables of each size that it chooses among.
#[test]
fn it_shows_what_the_compensator_of_its_number_shows() {
    agrees::<3>();
    agrees::<7>();
    agrees::<10>();
    agrees::<17>();
}

fn agrees<const CABLES: usize>() {
    let options = cables(CABLES);
    let mut one: Compensator<CABLES> = crate::support::compensator(&options, UNMONITORED);
    let mut other = any(&options);
    assert_eq!(other.cable_count(), CABLES);
    for cycle in 0..120 {
        let mut input = smooth_input::<CABLES>(cycle);
        if cycle == 50 {
            input.cables[1].sensor_force_n = f64::NAN;
        }
        if cycle < 3 {
            input.pose = None;
        }
        if cycle == 80 {
            one.reset();
            other.reset();
            assert!(other.outputs().iter().all(|output| *output == CableOutput::default()));
        }
        let output = one.step(&input);
        other.set_input(&input.cables, input.pose, input.elapsed_cycles);
        assert_eq!(other.step(), output.outside_wrench, "cycle {cycle}");
        assert_eq!(other.outputs(), output.cables, "cycle {cycle}");
        assert_eq!(other.applied_wrench(), output.applied_wrench, "cycle {cycle}");
        assert_eq!(other.wrench_status(), output.wrench_status, "cycle {cycle}");
        assert_eq!(output.wrench_status.contains(CableStatus::SENSOR_NOT_FINITE), cycle == 50);
        for cable in 0..=CABLES {
            assert_eq!(other.pulley_friction_n(cable), one.pulley_friction_n(cable), "cycle {cycle}, cable {cable}");
        }
        // −Aᵀf by hand.
        let forces_n: [f64; CABLES] = core::array::from_fn(|cable| 1.0 + 0.3 * output.cables[cable].frictionless_n);
        let by_hand = one.structure_matrix().map(|matrix| -matrix * nalgebra::SVector::from(forces_n));
        let wrench = other.outside_wrench_of(forces_n.into_iter());
        let parts =
            wrench.map(|it| [it.force_n.x, it.force_n.y, it.force_n.z, it.torque_nm.x, it.torque_nm.y, it.torque_nm.z]);
        assert_eq!(parts.is_some(), by_hand.is_some(), "cycle {cycle}");
        for (part, by_hand) in parts.iter().flatten().zip(by_hand.iter().flat_map(|it| it.iter())) {
            assert!((part - by_hand).abs() < 1e-12 * (1.0 + by_hand.abs()), "cycle {cycle}: {part} and {by_hand}");
        }
    }
}

#[test]
fn cables_without_signals_have_none() {
    let mut compensator = any(&cables(3));
    let input = smooth_input::<3>(0);
    compensator.set_input(&input.cables[..2], input.pose, 1.0);
    compensator.step();
    let silent = CableStatus::SENSOR_NOT_FINITE | CableStatus::MOTION_NOT_FINITE;
    let bad = |cable: usize| compensator.outputs()[cable].status.intersects(silent);
    assert_eq!([bad(0), bad(1), bad(2)], [false, false, true]);
    // What comes beyond the robot's cables is nobody's.
    let more: Vec<CableInput> = smooth_input::<4>(1).cables.to_vec();
    compensator.set_input(&more, None::<Pose>, 1.0);
    compensator.step();
    assert_eq!(compensator.outputs().len(), 3);
}

#[test]
fn only_parameters_of_the_same_robot_may_take_over() {
    let running = any(&cables(3));
    let with = |cable: CableOptions<'static>| {
        let mut options = cables(3);
        options[2] = cable;
        any(&options)
    };
    let fitted = with(CableOptions { friction: FrictionOptions { mu: 0.03, ..FRICTION }, ..cables(3)[2] });
    assert_eq!(running.check_exchange(&fitted), Ok(()));
    // Another number in the same size, in another size, and other pulleys.
    for (other, key) in [
        (any(&cables(4)), "cable"),
        (any(&cables(9)), "cable"),
        (with(CableOptions { pulleys: &[SENSOR_180, GUIDE_90, GUIDE_90, SWIVEL], ..cables(3)[2] }), "pulleys"),
        (with(CableOptions { pulleys: &[SENSOR_180, GUIDE_90, GUIDE_90], ..cables(3)[2] }), "pulleys"),
    ] {
        assert_eq!(running.check_exchange(&other).unwrap_err().key, key);
    }
}
