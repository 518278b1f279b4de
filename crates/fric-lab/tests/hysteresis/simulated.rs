//! The hysteresis of a simulated robot, with its own friction entered.

use fric_core::robot::file::RobotFile;
use fric_lab::CartesianAxis;
use fric_lab::hysteresis::{AxisHysteresis, Hysteresis, Survey};
use fric_lab::simulate::{Run, SimulationOptions};

use crate::simulate::robots::{frictionless_eight, simulate, slow_eight};

fn hysteresis(robot: &RobotFile, options: &SimulationOptions) -> Vec<AxisHysteresis> {
    let mut survey = Survey::new(robot).unwrap();
    let mut simulation = simulate(robot, options);
    while let Some(sample) = simulation.next_cycle() {
        survey.add(&sample);
    }
    let mut hysteresis = Hysteresis::new(robot, &survey.finish().unwrap()).unwrap();
    let mut simulation = simulate(robot, options);
    while let Some(sample) = simulation.next_cycle() {
        hysteresis.step(&sample);
    }
    hysteresis.axes().unwrap()
}

#[test]
fn compensation_takes_the_hysteresis_away() {
    let spread = SimulationOptions { run: Run::Crossing, mu_spread_ratio: 0.1, ..SimulationOptions::default() };
    for options in [SimulationOptions { run: Run::Crossing, ..SimulationOptions::default() }, spread] {
        let axes = hysteresis(&slow_eight(), &options);
        assert_eq!(axes.iter().map(|axis| axis.axis).collect::<Vec<_>>(), CartesianAxis::ALL);
        for axis in &axes {
            println!("{axis:?}");
            assert!(axis.is_applied_subtracted && axis.pass_count == 8);
            // \[P\] has 87 to 89 % on x, y and z of a real robot; here the parameters are the true ones, or 10 % off.
            assert!(axis.lasting_ratio().unwrap() < 0.15, "{axis:?}");
        }
        // Friction of some 8 % in eight cables of 5 N.
        assert!(axes.iter().take(3).all(|axis| (1.0..10.0).contains(&axis.without.width)), "{axes:?}");
    }
}

#[test]
fn scatter_has_no_lasting_share() {
    let options = SimulationOptions { run: Run::Crossing, duration_s: Some(16.0), ..SimulationOptions::default() };
    let axes = hysteresis(&frictionless_eight(), &options);
    assert_eq!(axes.len(), 1);
    let AxisHysteresis { without, with, .. } = axes[0];
    assert!((without.width - with.width).abs() < 1e-12, "{axes:?}");
    assert!(without.width < 2.0 * without.standard_error.unwrap(), "{axes:?}");
    assert_eq!(axes[0].lasting_ratio(), None);
}
