//! A compensator of any size against one of a fixed size.

use fric_core::{AnyCompensator, CableOutput, Compensator, CycleInput, RobotParams};
use fric_lab::simulate::SimulationOptions;

use crate::simulate::robots::{bench, eight_cables, simulate};

const CYCLES: usize = 400;

/// Outcomes of the next cycles of a simulated run.
fn run(compensator: &mut AnyCompensator, inputs: &[CycleInput<8>]) -> Vec<Vec<CableOutput>> {
    let mut step = |input: &CycleInput<8>| {
        compensator.set_input(&input.cables, input.pose, input.elapsed_cycles);
        compensator.step();
        compensator.outputs().to_vec()
    };
    inputs.iter().map(&mut step).collect()
}

fn inputs() -> Vec<CycleInput<8>> {
    let options = SimulationOptions { duration_s: Some(4.0), ..SimulationOptions::default() };
    let mut simulation = simulate(&eight_cables(), &options);
    let mut inputs = Vec::new();
    while let Some(sample) = simulation.next_cycle() {
        inputs.push(CycleInput { cables: sample.cables.try_into().unwrap(), pose: sample.pose, elapsed_cycles: 1.0 });
    }
    inputs.split_off(inputs.len() - 2 * CYCLES)
}

fn compensator(params: &RobotParams<'_>) -> AnyCompensator {
    AnyCompensator::new(params).unwrap()
}

#[test]
fn it_goes_on_from_a_snapshot_as_if_nothing_had_happened() {
    let robot = eight_cables();
    let inputs = inputs();
    let (first, second) = inputs.split_at(CYCLES);
    let mut any = compensator(&robot.params());
    run(&mut any, first);
    let (snapshot, outputs) = (any.snapshot(), any.outputs().to_vec());
    let expected = run(&mut any, second);
    any.restore(&snapshot).unwrap();
    assert_eq!(any.outputs(), outputs);
    assert_eq!(run(&mut any, second), expected);

    any.reset();
    assert_eq!(any.outputs(), [CableOutput::default(); 8]);
    assert_eq!(run(&mut any, first), run(&mut compensator(&robot.params()), first));
}

#[test]
fn another_compensator_goes_on_from_the_words_of_its_state() {
    let robot = eight_cables();
    let inputs = inputs();
    let (first, second) = inputs.split_at(CYCLES);
    let mut any = compensator(&robot.params());
    run(&mut any, first);
    let mut other = compensator(&robot.params());
    other.restore_words(&any.state_words()).unwrap();
    assert_eq!((other.outputs(), other.state_words()), (any.outputs(), any.state_words()));
    assert_eq!(run(&mut other, second), run(&mut any, second));

    let before = other.state_words();
    let one = compensator(&bench("{ wrap_deg = 180.0, sensor = true }", "mu = 0.02").params()).state_words();
    let error = other.restore_words(&one).map_err(|error| error.to_string());
    assert_eq!(error, Err("the snapshot is of a robot with 1 cables, this one has 8".to_owned()));
    assert!(other.restore_words(&before[1..]).is_err() && other.restore_words(&before[..before.len() - 1]).is_err());
    assert_eq!(other.state_words(), before);
}

#[test]
fn a_snapshot_of_another_robot_is_refused() {
    let (eight, one) = (eight_cables(), bench("{ wrap_deg = 180.0, sensor = true }", "mu = 0.02"));
    let mut any = compensator(&eight.params());
    let before = run(&mut any, &inputs());
    let error = any.restore(&compensator(&one.params()).snapshot()).map_err(|error| error.to_string());
    assert_eq!(error, Err("the snapshot is of a robot with 1 cables, this one has 8".to_owned()));
    assert_eq!(any.outputs(), *before.last().unwrap());
}

#[test]
fn pulley_friction_is_that_of_the_core() {
    let robot = eight_cables();
    let params = robot.params();
    let (mut any, mut fixed) = (compensator(&params), Compensator::<8>::new(&params).unwrap());
    let inputs = inputs();
    run(&mut any, &inputs);
    for input in &inputs {
        fixed.step(input);
    }
    for cable in 0..9 {
        let [of_any, of_core] = [any.pulley_friction_n(cable), fixed.pulley_friction_n(cable)];
        assert_eq!(of_any.map(f64::to_bits), of_core.map(f64::to_bits));
    }
    assert!(any.pulley_friction_n(0)[0].abs() > 0.0);
}
