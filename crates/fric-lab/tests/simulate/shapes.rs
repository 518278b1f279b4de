//! Robots of other shapes and sizes: whatever a robot file may hold runs, with finite numbers and positive tensions.

use std::fmt::Write as _;

use fric_core::robot::file::RobotFile;
use fric_lab::simulate::{Simulation, SimulationError};
use miette::Diagnostic as _;

use super::robots::{noiseless, simulate};

/// A robot from base points and attachments, one fixed sensor pulley each.
fn robot(mass_kg: f64, places: &[([f64; 3], [f64; 3])], friction: &str) -> RobotFile {
    let mut text =
        format!("format = \"fric-robot/1\"\nname = \"shape\"\ncycle_s = 0.01\n[platform]\nmass_kg = {mass_kg:?}\n");
    for (cable, (base_m, platform_m)) in places.iter().enumerate() {
        write!(
            text,
            "[[cable]]\nname = \"c{cable}\"\nbase_m = {base_m:?}\nplatform_m = {platform_m:?}\n\
             pulleys = [{{ wrap_deg = 90.0, sensor = true }}, {{ wrap_deg = 60.0 }}]\nfriction = {{ {friction} }}\n"
        )
        .unwrap();
    }
    RobotFile::parse(&text, "shape").unwrap()
}

fn box_of(half_m: [f64; 3], platform: [f64; 3]) -> Vec<([f64; 3], [f64; 3])> {
    let signs = [1.0, -1.0];
    let corners = signs.into_iter().flat_map(|x| signs.into_iter().flat_map(move |y| signs.map(|z| [x, y, z])));
    corners
        .map(|[x, y, z]| {
            let at = |[half_x, half_y, half_z]: [f64; 3], up: f64| [half_x * x, half_y * y, up * half_z * z];
            (at(half_m, 1.0), at(platform, -1.0))
        })
        .collect()
}

/// Runs to the end; whether it was in balance, and the least and greatest tension.
fn run(robot: &RobotFile) -> (bool, [f64; 2]) {
    let mut simulation = simulate(robot, &noiseless());
    let mut bounds_n = [f64::INFINITY, f64::NEG_INFINITY];
    while let Some(cycle) = simulation.next_cycle() {
        for (cable, force_n) in cycle.cables.iter().zip(cycle.reference_force_n) {
            assert!(cable.sensor_force_n.is_finite() && cable.length_m.is_finite());
            assert!(cable.speed_m_per_s.abs() <= 1.001);
            bounds_n = [bounds_n[0].min(*force_n), bounds_n[1].max(*force_n)];
        }
    }
    (simulation.is_balanced(), bounds_n)
}

#[test]
fn a_large_robot_with_a_heavy_platform() {
    let large = robot(
        210.0,
        &box_of([8.0, 5.5, 2.5], [0.7, 0.5, 0.4]),
        "mu = 0.013, sigma_n_per_m = 36600.0, viscous_n_s_per_m = 74.5",
    );
    let (balanced, bounds_n) = run(&large);
    println!("{bounds_n:?}");
    assert!(balanced && bounds_n[0] > 150.0 && bounds_n[1] < 10_000.0);
}

#[test]
fn a_robot_of_a_hands_breadth() {
    let (balanced, bounds_n) = run(&robot(0.01, &box_of([0.05, 0.05, 0.05], [0.005, 0.004, 0.005]), "mu = 0.02"));
    assert!(balanced && bounds_n[0] > 0.3, "{bounds_n:?}");
}

#[test]
fn four_cables_in_a_plane() {
    let corners = [[0.5, 0.5, 0.0], [-0.5, 0.5, 0.0], [-0.5, -0.5, 0.0], [0.5, -0.5, 0.0]];
    let places = corners.map(|base_m| (base_m, base_m.map(|part| -0.1 * part)));
    let (balanced, bounds_n) = run(&robot(0.0, &places, "mu = 0.02, sigma_n_per_m = 1000.0"));
    assert!(balanced && bounds_n[0] > 0.3, "{bounds_n:?}");
}

#[test]
fn six_cables_from_a_ceiling_and_one_alone() {
    let hung: Vec<_> = (0..6_u32)
        .map(|cable| {
            let angle = f64::from(cable) * 1.047;
            let twisted = angle + if cable % 2 == 0 { 0.8 } else { -0.8 };
            ([angle.cos(), angle.sin(), 2.0], [0.2 * twisted.cos(), 0.2 * twisted.sin(), 0.0])
        })
        .collect();
    let (_, bounds_n) = run(&robot(5.0, &hung, "mu = 0.02"));
    assert!(bounds_n[0] > 0.0, "{bounds_n:?}");
    let (_, bounds_n) = run(&robot(1.0, &[([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])], "mu = 0.02"));
    assert!(bounds_n[0] > 0.0, "{bounds_n:?}");
}

#[test]
fn what_hardly_holds_is_said() {
    // Two cables cannot hold a platform in space.
    let two = [([1.0, 0.0, 1.0], [0.1, 0.0, 0.0]), ([-1.0, 0.5, 1.0], [-0.1, 0.0, 0.1])];
    let (balanced, bounds_n) = run(&robot(1.0, &two, "mu = 0.02, sigma_n_per_m = 1000.0"));
    assert!(!balanced && bounds_n[0] > 0.0, "{bounds_n:?}");
    let mut simulation = simulate(&robot(1.0, &two, "mu = 0.02"), &noiseless());
    assert_eq!(simulation.imbalance(), None);
    let mut run = Vec::new();
    while let Some(cycle) = simulation.next_cycle() {
        let weight = nalgebra::Vector3::new(0.0, 0.0, -9.80665);
        run.push((cycle.pose.unwrap().position_m, (cycle.outside_wrench.unwrap().force_n - weight).amax()));
    }
    let imbalance = simulation.imbalance().unwrap();
    // What is missing at rest, at the first moment, is at most what is missing ever.
    assert!(imbalance.missing_n >= run[0].1 && imbalance.cycle_count <= simulation.total_cycles());
    assert!(run.iter().any(|(position_m, _)| *position_m == imbalance.position_m));
    assert!(!simulation.is_among_anchors());
}

#[test]
fn a_platform_among_its_anchors_is_said() {
    // Two winches at each corner of a ceiling, one for the top of the platform and one for its bottom.
    let corner = |[x, y]: [f64; 2]| {
        let top = ([x, 0.8 * y, 2.0], [0.05 * x, 0.1 * y, 0.05]);
        [top, ([x + 0.1, 0.8 * y - 0.1, 2.0], [0.1 * x, 0.05 * y, -0.05])]
    };
    let level = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(corner).concat();
    let at = |mass_kg| simulate(&robot(mass_kg, &level, "mu = 0.02"), &noiseless()).is_among_anchors();
    assert!(at(5.0) && !at(0.0));
    let boxed = box_of([1.0, 0.8, 0.7], [0.1, 0.08, 0.05]);
    let simulation = simulate(&robot(5.0, &boxed, "mu = 0.02"), &noiseless());
    assert!(!simulation.is_among_anchors() && simulation.imbalance().is_none());
}

#[test]
fn friction_of_the_greatest_kind_stays_finite() {
    let places = box_of([0.55, 0.4, 0.5], [0.06, 0.05, 0.05]);
    for friction in
        ["mu = 0.5, sigma_n_per_m = 1e-3, viscous_n_s_per_m = 0.0", "mu = 0.5", "mu = 0.0, viscous_n_s_per_m = 50.0"]
    {
        let (_, bounds_n) = run(&robot(0.41, &places, friction));
        assert!(bounds_n[0] > 0.0, "{friction}: {bounds_n:?}");
    }
}

#[test]
fn one_cable_on_the_platform_and_one_by_itself() {
    let text = "format = \"fric-robot/1\"\nname = \"mixed\"\ncycle_s = 0.001\n\
        [[cable]]\nname = \"a\"\nbase_m = [0.0, 0.0, 1.0]\nplatform_m = [0.0, 0.0, 0.0]\n\
        pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap = \"pose\", radius_m = 0.02, axis = [0.0, 0.0, 1.0] }]\n\
        friction = { mu = 0.02 }\n\
        [[cable]]\nname = \"b\"\npulleys = [{ wrap_deg = 180.0, sensor = true }]\nfriction = { mu = 0.02 }\n";
    let mut simulation = simulate(&RobotFile::parse(text, "mixed").unwrap(), &noiseless());
    assert!(!simulation.is_balanced());
    while let Some(cycle) = simulation.next_cycle() {
        assert!(cycle.pose.is_some() && cycle.outside_wrench.is_none());
        assert!(cycle.reference_force_n.iter().all(|force_n| *force_n > 1.0));
    }
}

#[test]
fn a_platform_inside_its_pulleys_has_no_place_to_run() {
    let text = "format = \"fric-robot/1\"\nname = \"wrong\"\ncycle_s = 0.001\n\
        [[cable]]\nname = \"a\"\nbase_m = [0.0, 0.0, 0.0]\nplatform_m = [40.0, 0.0, 0.0]\n\
        pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap = \"pose\", radius_m = 40.0, axis = [0.0, 0.0, 1.0] }]\n\
        friction = { mu = 0.02 }\n";
    let error = Simulation::new(&RobotFile::parse(text, "wrong").unwrap(), &noiseless()).unwrap_err();
    assert_eq!(error, SimulationError::NoWorkspace);
    assert!(error.help().is_some_and(|advice| advice.to_string().contains("unit m")));
}

#[test]
fn a_simulation_can_change_threads() {
    fn can_move<T: Send + Sync>() {}
    can_move::<Simulation>();
}
