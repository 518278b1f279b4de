//! Logs in memory, and what the fits of this folder have in common.

use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Pose, Sample, Wrench};
use fric_lab::fit::{CableFit, FitOptions, Measurements, Parameter, Progress, Reference, fit_cables};
use fric_lab::replay::Replay;
use fric_lab::simulate::{Simulation, SimulationOptions};

/// One cycle with all its cables.
#[derive(Clone, Debug)]
pub struct Cycle {
    pub stamp_nanos: i64,
    pub cables: Vec<CableInput>,
    pub reference_force_n: Vec<f64>,
    pub pose: Option<Pose>,
    pub outside_wrench: Option<Wrench>,
}

/// A log to be spoilt at will.
#[derive(Clone, Debug)]
pub struct Log(pub Vec<Cycle>);

impl Log {
    /// Of a simulated robot.
    pub fn record(robot: &RobotFile, options: &SimulationOptions) -> Self {
        let mut simulation = Simulation::new(robot, options).unwrap();
        let mut cycles = Vec::new();
        while let Some(sample) = simulation.next_cycle() {
            cycles.push(Cycle {
                stamp_nanos: sample.stamp_nanos,
                cables: sample.cables.to_vec(),
                reference_force_n: sample.reference_force_n.to_vec(),
                pose: sample.pose,
                outside_wrench: sample.outside_wrench,
            });
        }
        Self(cycles)
    }

    /// Goes into measurements as a log of its own.
    pub fn add_to(&self, measurements: &mut Measurements<'_>) {
        measurements.start_log();
        self.samples().for_each(|sample| measurements.add(&sample));
    }

    /// Runs through a replay.
    pub fn replay(&self, replay: &mut Replay) {
        for sample in self.samples() {
            replay.step(&sample);
        }
    }

    /// Its samples in order.
    pub fn samples(&self) -> impl Iterator<Item = Sample<'_>> {
        self.0.iter().map(|cycle| Sample {
            stamp_nanos: cycle.stamp_nanos,
            cables: &cycle.cables,
            reference_force_n: &cycle.reference_force_n,
            pose: cycle.pose,
            outside_wrench: cycle.outside_wrench,
        })
    }

    /// By itself as what a fit takes.
    pub fn measured<'a>(&self, robot: &'a RobotFile, reference: Reference) -> Measurements<'a> {
        let mut measurements = Measurements::new(&robot.params(), reference);
        self.add_to(&mut measurements);
        measurements
    }

    /// The fit of every cable with a robot file's values as given.
    pub fn fit(&self, robot: &RobotFile, options: &FitOptions) -> Vec<CableFit> {
        fit_cables(&self.measured(robot, Reference::Forces), options, &Progress::new())
    }
}

/// The parameter of a name.
pub fn parameter(name: &str) -> Parameter {
    Parameter::named(name).unwrap()
}

/// The four of the robot file's `friction`.
pub const FRICTION: [&str; 4] = ["mu", "sigma_n_per_m", "viscous_n_s_per_m", "offset_n"];

/// A parameter's value in a fit.
pub fn value(fit: &CableFit, name: &str) -> f64 {
    fit.values[parameter(name).place()]
}

/// How far a fitted value is from the truth, in standard errors; infinite where it was not fitted.
pub fn deviation(fit: &CableFit, name: &str, truth: f64) -> f64 {
    let standard_error = fit.standard_error(&parameter(name)).unwrap_or(0.0);
    (value(fit, name) - truth) / standard_error
}

/// Names of what a fit could not determine.
pub fn undetermined(fit: &CableFit) -> Vec<String> {
    fit.undetermined.iter().map(ToString::to_string).collect()
}

/// Mini-IPAnema of the example file with other friction values, cable by cable.
pub fn mini_ipanema(friction: impl Fn(usize) -> String) -> RobotFile {
    let mut count = 0;
    let lines = include_str!("../../../../examples/mini-ipanema.toml").lines().map(|line| {
        if !line.starts_with("friction =") {
            return line.to_owned();
        }
        count += 1;
        format!("friction = {{ {} }}", friction(count - 1))
    });
    let text: Vec<String> = lines.collect();
    RobotFile::parse(&text.join("\n"), "mini-ipanema").unwrap()
}

/// Fitted values are within 3.5 standard errors of the truth: chance alone takes one of 2,000 further.
pub fn assert_near(fit: &CableFit, names: &[&str], truth: &[f64; 4]) {
    for (name, truth) in FRICTION.iter().zip(truth).filter(|(name, _)| names.contains(name)) {
        let deviation = deviation(fit, name, *truth);
        let standard_error = fit.standard_error(&parameter(name));
        println!("{name}: {} ± {standard_error:?}, {deviation:+.2} standard errors", value(fit, name));
        assert!(deviation.abs() < 3.5, "{name}: {} instead of {truth} ({standard_error:?})", value(fit, name));
    }
}
