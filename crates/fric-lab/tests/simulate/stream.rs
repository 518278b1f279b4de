//! The stream of cycles: reproducible, continuous, in balance.

use fric_core::CableInput;
use fric_core::platform::structure_matrix;
use fric_lab::simulate::{Run, START_NANOS, Simulation, SimulationError, SimulationOptions};
use nalgebra::{SVector, Vector3};

use super::robots::{bench, eight_cables, hung, noiseless, simulate};

#[test]
fn equal_seeds_give_equal_bits_and_others_differ() {
    let robot = eight_cables();
    let run = |seed| {
        let options = SimulationOptions { seed, duration_s: Some(0.8), mu_spread_ratio: 0.1, ..Default::default() };
        let mut simulation = simulate(&robot, &options);
        let mut bits = Vec::new();
        while let Some(cycle) = simulation.next_cycle() {
            for (CableInput { sensor_force_n, length_m, speed_m_per_s }, reference_n) in
                cycle.cables.iter().zip(cycle.reference_force_n)
            {
                bits.extend([sensor_force_n, length_m, speed_m_per_s, reference_n].map(|value| value.to_bits()));
            }
        }
        bits
    };
    assert_eq!(run(7), run(7));
    assert_ne!(run(7), run(8));
}

#[test]
fn stamps_are_the_cycle_times() {
    let options = SimulationOptions { duration_s: Some(0.25), ..noiseless() };
    let mut simulation = simulate(&bench("{ wrap_deg = 90.0, sensor = true }", "mu = 0.02"), &options);
    assert_eq!(simulation.total_cycles(), 250);
    let mut stamp_nanos = START_NANOS;
    while let Some(cycle) = simulation.next_cycle() {
        assert_eq!(cycle.stamp_nanos, stamp_nanos);
        assert_eq!((cycle.pose, cycle.outside_wrench), (None, None));
        stamp_nanos += 1_000_000;
    }
    assert_eq!(stamp_nanos, START_NANOS + 250_000_000);
    assert!(simulation.next_cycle().is_none());
}

/// A run and a bit: no jump where it repeats, speeds that belong to the lengths.
#[test]
fn lengths_are_continuous() {
    let robot = bench("{ wrap_deg = 180.0, sensor = true }", "mu = 0.02, sigma_n_per_m = 1000.0");
    let duration_s = simulate(&robot, &noiseless()).trajectory().duration_s();
    let options = SimulationOptions { duration_s: Some(duration_s + 3.0), ..noiseless() };
    let mut simulation = simulate(&robot, &options);
    let mut last: Option<CableInput> = None;
    while let Some(cycle) = simulation.next_cycle() {
        let now = cycle.cables[0];
        assert!(now.speed_m_per_s.abs() < 1.001);
        if let Some(before) = last {
            let mean_m_per_s = (now.length_m - before.length_m) / 0.001;
            let trapezoid_m_per_s = 0.5 * (now.speed_m_per_s + before.speed_m_per_s);
            assert!((mean_m_per_s - trapezoid_m_per_s).abs() < 1e-3, "{mean_m_per_s} {trapezoid_m_per_s}");
        }
        last = Some(now);
    }
}

/// All phases, and the rectangles as far as the fifth corner.
#[test]
fn the_platform_is_held_by_its_cables() {
    let robot = eight_cables();
    let params = robot.params();
    let duration_s = simulate(&robot, &noiseless()).trajectory().duration_s();
    assert!((50.0..60.0).contains(&duration_s), "{duration_s}");
    let mut simulation = simulate(&robot, &SimulationOptions { duration_s: Some(34.0), ..noiseless() });
    assert!(simulation.is_balanced());
    let trajectory = simulation.trajectory().clone();
    let mut forces_n = [[f64::INFINITY, f64::NEG_INFINITY]; 8];
    let mut sensors_n = [f64::INFINITY, f64::NEG_INFINITY];
    let mut cycles = 0.0;
    let mut last: Option<Vec<CableInput>> = None;
    while let Some(cycle) = simulation.next_cycle() {
        let (pose, wrench) = (cycle.pose.unwrap(), cycle.outside_wrench.unwrap());
        let set_point = trajectory.at(cycles * 0.001);
        let expected_n = (Vector3::new(0.0, 0.0, -9.80665) - set_point.acceleration_m_per_s2) * 0.41;
        assert!((wrench.force_n - expected_n).amax() < 1e-9, "{cycles}: {} {expected_n}", wrench.force_n);
        assert!(wrench.torque_nm.amax() < 1e-9);
        let references_n = SVector::<f64, 8>::from_column_slice(cycle.reference_force_n);
        let product = structure_matrix::<8>(&params, &pose).unwrap() * references_n;
        assert!((product + wrench.to_vector()).amax() < 1e-9);
        for (bounds, force_n) in forces_n.iter_mut().zip(cycle.reference_force_n) {
            *bounds = [bounds[0].min(*force_n), bounds[1].max(*force_n)];
        }
        for cable in cycle.cables {
            sensors_n = [sensors_n[0].min(cable.sensor_force_n), sensors_n[1].max(cable.sensor_force_n)];
        }
        // The speed by the structure matrix is the derivative of the length by the inverse kinematics.
        for (now, before) in cycle.cables.iter().zip(last.iter().flatten()) {
            let mean_m_per_s = (now.length_m - before.length_m) / 0.001;
            let trapezoid_m_per_s = 0.5 * (now.speed_m_per_s + before.speed_m_per_s);
            assert!((mean_m_per_s - trapezoid_m_per_s).abs() < 1e-3, "{mean_m_per_s} {trapezoid_m_per_s}");
        }
        last = Some(cycle.cables.to_vec());
        cycles += 1.0;
    }
    println!("run {duration_s:.2} s, tensions {forces_n:.2?}, sensors {sensors_n:.2?}");
    assert!(sensors_n[0] > 1.0 && sensors_n[1] < 30.0);
    for [least_n, greatest_n] in forces_n {
        assert!(least_n > 0.4 && greatest_n > 2.0 * least_n, "{forces_n:?}");
    }
}

#[test]
fn three_cables_from_a_ceiling_carry_a_point() {
    let mut simulation = simulate(&hung(), &SimulationOptions { duration_s: Some(25.0), ..noiseless() });
    assert!(simulation.is_balanced());
    while let Some(cycle) = simulation.next_cycle() {
        let pose = cycle.pose.unwrap();
        assert!(pose.position_m.z < 2.0);
        assert!(cycle.reference_force_n.iter().all(|force_n| *force_n > 1.0));
    }
}

#[test]
fn a_bench_runs_its_load_over_a_wide_range() {
    let friction = "mu = 0.02, sigma_n_per_m = 1000.0, offset_n = 100.0";
    let mut simulation = simulate(&bench("{ wrap_deg = 180.0, sensor = true }", friction), &noiseless());
    assert!(!simulation.is_balanced());
    let mut bounds_n = [f64::INFINITY, f64::NEG_INFINITY];
    while let Some(cycle) = simulation.next_cycle() {
        let force_n = cycle.reference_force_n[0] - 100.0;
        bounds_n = [bounds_n[0].min(force_n), bounds_n[1].max(force_n)];
        // 4 % of sliding friction, and more where the load has fallen since the last motion.
        assert!((cycle.cables[0].sensor_force_n - 2.0 * force_n).abs() < 0.15 * force_n);
    }
    println!("{bounds_n:?}");
    assert!(bounds_n[0] > 1.0 && bounds_n[1] > 2.0 * bounds_n[0] && bounds_n[1] < 10.0);
}

#[test]
fn noise_is_white_and_as_loud_as_asked() {
    let robot = bench("{ wrap_deg = 180.0, sensor = true }", "mu = 0.02, sigma_n_per_m = 1000.0");
    let options = SimulationOptions { duration_s: Some(20.0), ..SimulationOptions::default() };
    let mut noisy = simulate(&robot, &options);
    let mut quiet = simulate(&robot, &SimulationOptions { duration_s: Some(20.0), ..noiseless() });
    let mut noise_n = [const { Vec::new() }; 2];
    while let (Some(one), Some(other)) = (noisy.next_cycle(), quiet.next_cycle()) {
        noise_n[0].push(one.cables[0].sensor_force_n - other.cables[0].sensor_force_n);
        noise_n[1].push(one.reference_force_n[0] - other.reference_force_n[0]);
    }
    let product = |one: &[f64], other: &[f64]| {
        let sum: f64 = one.iter().zip(other).map(|(one, other)| one * other).sum();
        sum / f64::from(u32::try_from(one.len().min(other.len())).unwrap())
    };
    let [sensor_n, reference_n] = noise_n;
    for (noise_n, asked_n) in [(&sensor_n, 0.02), (&reference_n, 0.01)] {
        let square = product(noise_n, noise_n);
        assert!((square.sqrt() / asked_n - 1.0).abs() < 0.02);
        for shift in 1..4 {
            assert!((product(noise_n, &noise_n[shift..]) / square).abs() < 0.03);
        }
    }
    assert!((product(&sensor_n, &reference_n) / (0.02 * 0.01)).abs() < 0.03);
}

/// The run's turns: lengths, speeds and the structure matrix follow the orientation.
#[test]
fn the_platform_turns_in_a_crossing_run_and_is_held() {
    let robot = eight_cables();
    let params = robot.params();
    let mut simulation = simulate(&robot, &SimulationOptions { run: Run::Crossing, ..noiseless() });
    assert!(simulation.is_balanced());
    let mut greatest_rad = Vector3::zeros();
    let mut last: Option<Vec<CableInput>> = None;
    while let Some(cycle) = simulation.next_cycle() {
        let (pose, wrench) = (cycle.pose.unwrap(), cycle.outside_wrench.unwrap());
        greatest_rad = greatest_rad.sup(&pose.orientation.scaled_axis());
        let references_n = SVector::<f64, 8>::from_column_slice(cycle.reference_force_n);
        let product = structure_matrix::<8>(&params, &pose).unwrap() * references_n;
        assert!((product + wrench.to_vector()).amax() < 1e-9);
        for (cable, params) in cycle.cables.iter().zip(params.cables()) {
            // Micro motion of the winches is up to 20 µm.
            assert!((cable.length_m - params.length_m(&pose).unwrap()).abs() < 21e-6);
        }
        for (now, before) in cycle.cables.iter().zip(last.iter().flatten()) {
            let mean_m_per_s = (now.length_m - before.length_m) / 0.001;
            let trapezoid_m_per_s = 0.5 * (now.speed_m_per_s + before.speed_m_per_s);
            assert!((mean_m_per_s - trapezoid_m_per_s).abs() < 1e-4, "{mean_m_per_s} {trapezoid_m_per_s}");
        }
        last = Some(cycle.cables.to_vec());
    }
    // About z a cable would fall below the least tension at 5°, at the lowest prestress there can be.
    let expected_rad = Vector3::new(5.0, 5.0, 2.5).map(f64::to_radians);
    assert!((greatest_rad - expected_rad).amax() < 1e-12, "{greatest_rad}");
}

#[test]
fn a_bench_cannot_cross_anything() {
    let options = SimulationOptions { run: Run::Crossing, ..noiseless() };
    let error = Simulation::new(&bench("{ wrap_deg = 90.0, sensor = true }", "mu = 0.02"), &options).unwrap_err();
    assert_eq!(error, SimulationError::NoPlatform { cable: "winch".to_owned() });
}
