//! A platform that turns, by its mass: the file states no inertia tensor. The truth is Newton's and Euler's own, from the angular momentum of a body in
//! continuous time; its cables have no friction, so that nothing else is to be found, unless the file states some.

use core::f64::consts::TAU;

use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, CableParams, Pose};
use fric_lab::discover::{Discoveries, Verdict, WrenchDiscovery, discover_wrench};
use fric_lab::fit::{Progress, Reference};
use nalgebra::{DMatrix, DVector, Matrix3, UnitQuaternion, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::fit::logs::{Cycle, Log};

const CYCLE_S: f64 = 0.004;
/// Moments and products, kg m².
const INERTIA_KG_M2: [f64; 6] = [0.004, 0.0008, -0.0005, 0.0052, 0.001, 0.0065];

/// The example at 250 Hz with a platform of 1 kg, and with its friction.
fn with_friction() -> String {
    let example = include_str!("../../../../examples/mini-ipanema.toml");
    example.replace("cycle_s = 0.001", "cycle_s = 0.004").replace("mass_kg = 0.41", "mass_kg = 1.0")
}

fn text() -> String {
    let line = |line: &str| {
        let is_friction = line.starts_with("friction =");
        let line = if is_friction { "friction = { mu = 0.0, sigma_n_per_m = 1000.0 }" } else { line };
        format!("{line}\n")
    };
    with_friction().lines().map(line).collect()
}

fn orientation(time_s: f64) -> UnitQuaternion<f64> {
    let [x, y, z] = [(0.83, 0.3), (0.79, 1.4), (0.95, 2.2)].map(|(hz, phase)| 0.03 * (TAU * hz * time_s + phase).sin());
    UnitQuaternion::from_scaled_axis(Vector3::new(x, y, z))
}

fn position_m(time_s: f64) -> Vector3<f64> {
    let [x, y, z] = [(0.23, 0.0), (0.31, 1.0), (0.19, 2.0)].map(|(hz, phase)| 0.04 * (TAU * hz * time_s + phase).sin());
    Vector3::new(x, y, z)
}

/// The second derivative of the position, by the differences of a time so short that its error is far below the noise.
fn acceleration_m_per_s2(time_s: f64) -> Vector3<f64> {
    let step_s = 1e-3;
    (position_m(time_s + step_s) - position_m(time_s) * 2.0 + position_m(time_s - step_s)) / (step_s * step_s)
}

fn angular_momentum(inertia_kg_m2: &Matrix3<f64>, time_s: f64) -> Vector3<f64> {
    let step_s = 1e-4;
    let turn = orientation(time_s + step_s) * orientation(time_s - step_s).inverse();
    let rotation = orientation(time_s).to_rotation_matrix().into_inner();
    rotation * inertia_kg_m2 * rotation.transpose() * (turn.scaled_axis() / (2.0 * step_s))
}

/// A log of 16 s whose poses have this noise in each axis of their orientation, rad.
fn record(robot: &RobotFile, noise_rad: f64) -> Log {
    let [xx, xy, xz, yy, yz, zz] = INERTIA_KG_M2;
    let inertia_kg_m2 = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let params = robot.params();
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut cycle = |count: u32| {
        let time_s = f64::from(count) * CYCLE_S;
        let pose = Pose { position_m: position_m(time_s), orientation: orientation(time_s) };
        let force_n = (params.gravity_m_per_s2() - acceleration_m_per_s2(time_s)) * params.mass_kg();
        let momentum = |time_s: f64| angular_momentum(&inertia_kg_m2, time_s);
        let torque_nm = -(momentum(time_s + 1e-3) - momentum(time_s - 1e-3)) / 2e-3;
        let columns: Vec<_> = params.cables().iter().filter_map(|cable| cable.structure_column(&pose)).collect();
        let structure = DMatrix::from_fn(6, columns.len(), |row, column| columns[column][row]);
        let outside = DVector::from_iterator(6, force_n.iter().chain(torque_nm.iter()).copied());
        // Forces that vary by themselves, moved to the nearest ones in balance.
        let wanted_n =
            |cable: u32| 24.0 + 2.0 * (TAU * (0.11 + 0.02 * f64::from(cable)) * time_s + f64::from(cable)).sin();
        let wanted = DVector::from_iterator(columns.len(), (0..).map(wanted_n).take(columns.len()));
        let missing = -(outside + &structure * &wanted);
        let tensions_n = wanted + structure.clone().pseudo_inverse(1e-9).unwrap() * missing;
        assert!(tensions_n.min() > 3.0, "a slack cable pulls at nothing");
        let length_m = |cable: &CableParams, time_s: f64| {
            let pose = Pose { position_m: position_m(time_s), orientation: orientation(time_s) };
            cable.length_m(&pose).unwrap()
        };
        let input = |(cable, force_n): (&CableParams, &f64)| {
            let noise_n: f64 = StandardNormal.sample(&mut random);
            CableInput {
                sensor_force_n: force_n / cable.frictionless_gain() + 0.005 * noise_n,
                length_m: length_m(cable, time_s),
                speed_m_per_s: (length_m(cable, time_s + 1e-4) - length_m(cable, time_s - 1e-4)) / 2e-4,
            }
        };
        let cables = params.cables().iter().zip(&tensions_n).map(input).collect();
        let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
        let turn_rad = Vector3::from_fn(|_, _| noise_rad * noise());
        let measured = Pose { orientation: pose.orientation * UnitQuaternion::from_scaled_axis(turn_rad), ..pose };
        Cycle {
            stamp_nanos: i64::from(count) * 4_000_000,
            cables,
            reference_force_n: Vec::new(),
            pose: Some(measured),
            outside_wrench: None,
        }
    };
    Log((0..4000).map(&mut cycle).collect())
}

fn look(log: &Log, given: &RobotFile) -> WrenchDiscovery {
    discover_wrench(&log.measured(given, Reference::Wrench), &Progress::new()).unwrap()
}

fn assert_complete(found: &WrenchDiscovery) {
    assert!(found.geometry.is_empty() && found.cables.iter().all(|cable| cable.findings.is_empty()));
    assert_eq!(found.verdict, Verdict::Complete);
}

fn assert_nothing_but_inertia(found: &WrenchDiscovery) {
    assert_complete(found);
    for (found, truth) in found.inertia_kg_m2.unwrap().into_iter().zip(INERTIA_KG_M2) {
        assert!((found - truth).abs() < 0.05 * INERTIA_KG_M2[0], "{found} {truth}");
    }
}

/// Without a tensor and with twice the true one: the torque of the inertia is neither friction nor an unknown force. The file's own tensor stays if it is right.
#[test]
fn an_inertia_tensor_that_the_file_lacks_is_no_friction() {
    let lacking = text();
    let log = record(&RobotFile::parse(&lacking, "lacking").unwrap(), 0.0);
    let look = |text: &str| look(&log, &RobotFile::parse(text, "given").unwrap());
    let found = look(&lacking);
    assert_nothing_but_inertia(&found);
    let extended = Discoveries::Wrench(Box::new(found)).extended(&lacking, "lacking").unwrap();
    let again = look(&extended);
    assert_complete(&again);
    assert_eq!(again.inertia_kg_m2, None);
    let twice = INERTIA_KG_M2.map(|entry| (2.0 * entry).to_string()).join(", ");
    let key = format!("mass_kg = 1.0\ninertia_kg_m2 = [{twice}]");
    assert_nothing_but_inertia(&look(&lacking.replace("mass_kg = 1.0", &key)));
}

/// Bearings without friction: the given values are taken back, although the log does not tell μ and σ apart where there is neither.
#[test]
fn friction_that_there_is_not_is_taken_back() {
    let given = RobotFile::parse(&with_friction(), "example").unwrap();
    let log = record(&given, 0.0);
    let found = look(&log, &given);
    assert_eq!(found.verdict, Verdict::Complete);
    // Of the wrench there is left what frictionless forces leave, the true ones.
    let without = look(&log, &RobotFile::parse(&text(), "example").unwrap());
    let [with_n, without_n] = [&found, &without].map(|of| of.after.errors.rms().unwrap().0);
    assert!((with_n / without_n - 1.0).abs() < 0.05, "{with_n} {without_n}");
}

/// Noise of the poses that is as large in the angular acceleration as the turns themselves makes the fitted moments too small.
#[test]
fn noise_of_the_poses_is_no_knowledge_of_the_tensor() {
    let given = RobotFile::parse(&text(), "given").unwrap();
    let found = look(&record(&given, 1e-4), &given);
    assert!(found.geometry.is_empty() && found.cables.iter().all(|cable| cable.findings.is_empty()));
    assert_eq!(found.inertia_kg_m2, None);
}
