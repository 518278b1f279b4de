//! Robots to simulate.

use std::fmt::Write as _;

use fric_core::robot::file::RobotFile;
use fric_lab::simulate::{Simulation, SimulationOptions};

/// μ and σ of the published robot's cables (\[P\] table I), `F_pv` of each pulley a third of the cable's in a like robot.
const PUBLISHED: [(f64, f64, f64); 8] = [
    (0.016, 1000.0, 0.17),
    (0.011, 1003.0, 0.35),
    (0.014, 999.0, 0.155),
    (0.017, 602.0, 0.138),
    (0.024, 1000.0, 0.175),
    (0.023, 999.0, 0.208),
    (0.024, 1001.0, 0.118),
    (0.025, 998.0, 0.129),
];

/// Eight cables in a frame of 1.1 × 0.8 × 1.0 m, sensor at 180°, a fixed pulley, a swivelling one.
pub fn eight_cables() -> RobotFile {
    eight_cables_with(&PUBLISHED, 0.001)
}

/// The same with a cycle of 4 ms.
pub fn slow_eight() -> RobotFile {
    eight_cables_with(&PUBLISHED, 0.004)
}

/// The same with nothing that rubs.
pub fn frictionless_eight() -> RobotFile {
    eight_cables_with(&[(0.0, 1000.0, 0.0); 8], 0.001)
}

fn eight_cables_with(friction: &[(f64, f64, f64); 8], cycle_s: f64) -> RobotFile {
    let mut text =
        format!("format = \"fric-robot/1\"\nname = \"eight\"\ncycle_s = {cycle_s}\n[platform]\nmass_kg = 0.41\n");
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let places = [1.0, -1.0].into_iter().flat_map(|height| corners.map(|(x, y)| (x, y, height)));
    for (cable, ((x, y, height), (mu, sigma, viscous))) in places.zip(*friction).enumerate() {
        write!(
            text,
            "[[cable]]\nname = \"cable{}\"\nbase_m = [{}, {}, {}]\nplatform_m = [{}, {}, {}]\n\
             pulleys = [{{ wrap_deg = 180.0, sensor = true }}, {{ wrap_deg = 90.0 }}, \
             {{ wrap = \"pose\", radius_m = 0.01, axis = [0.0, 0.0, {height:?}] }}]\n\
             friction = {{ mu = {mu:?}, sigma_n_per_m = {sigma:?}, viscous_n_s_per_m = {viscous:?} }}\n",
            cable + 1,
            0.55 * x,
            0.4 * y,
            0.5 * height,
            0.06 * x,
            0.05 * y,
            -0.05 * height,
        )
        .unwrap();
    }
    RobotFile::parse(&text, "eight cables").unwrap()
}

/// A winch on a test bench: pulleys as given, no geometry.
pub fn bench(pulleys: &str, friction: &str) -> RobotFile {
    bench_with(pulleys, friction, "")
}

/// The same with a line more for the cable.
pub fn bench_with(pulleys: &str, friction: &str, line: &str) -> RobotFile {
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = 0.001\n[[cable]]\nname = \"winch\"\n\
         pulleys = [{pulleys}]\nfriction = {{ {friction} }}\n{line}\n"
    );
    RobotFile::parse(&text, "bench").unwrap()
}

/// Three cables from a ceiling to one point of a platform of 2 kg.
pub fn hung() -> RobotFile {
    let mut text =
        "format = \"fric-robot/1\"\nname = \"hung\"\ncycle_s = 0.001\n[platform]\nmass_kg = 2.0\n".to_owned();
    for (cable, (x, y)) in [(1.0, 0.0), (-0.5, 0.8), (-0.5, -0.8)].into_iter().enumerate() {
        write!(
            text,
            "[[cable]]\nname = \"cable{cable}\"\nbase_m = [{x:?}, {y:?}, 2.0]\nplatform_m = [0.0, 0.0, 0.0]\n\
             pulleys = [{{ wrap_deg = 90.0, sensor = true }}]\nfriction = {{ mu = 0.02, sigma_n_per_m = 2000.0 }}\n"
        )
        .unwrap();
    }
    RobotFile::parse(&text, "hung").unwrap()
}

pub fn noiseless() -> SimulationOptions {
    SimulationOptions { sensor_noise_n: 0.0, reference_noise_n: 0.0, ..SimulationOptions::default() }
}

pub fn simulate(robot: &RobotFile, options: &SimulationOptions) -> Simulation {
    Simulation::new(robot, options).unwrap()
}
