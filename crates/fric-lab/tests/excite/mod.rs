//! The identification run as set points: derivatives, limits, box, forces, lengths, and what cannot be run.

mod designed;

use fric_core::platform::structure_matrix;
use fric_lab::excite::{CableMotion, Excitation, ExcitationError, ExcitationOptions};
use fric_lab::trajectory::SetPoint;
use miette::Diagnostic as _;
use nalgebra::{SVector, Vector3, Vector6};

use crate::simulate::robots::{bench, eight_cables, hung};

fn options(box_m: [f64; 6]) -> ExcitationOptions {
    let [x0, y0, z0, x1, y1, z1] = box_m;
    ExcitationOptions {
        box_m: Some([[x0, y0, z0], [x1, y1, z1]]),
        max_speed_m_per_s: Some(0.4),
        max_acceleration_m_per_s2: Some(5.0),
        min_tension_n: Some(2.0),
        max_tension_n: Some(30.0),
    }
}

const BOX_M: [f64; 6] = [-0.1, -0.08, -0.12, 0.12, 0.06, 0.08];

#[test]
fn derivatives_limits_box_forces_and_lengths_hold() {
    let robot = eight_cables();
    let params = robot.params();
    let mut run = Excitation::new(&robot, &options(BOX_M)).unwrap();
    assert_eq!(run.tension_bounds_n(), Some((2.0, Some(30.0))));
    let mut last: Option<(SetPoint, Vec<CableMotion>)> = None;
    let (mut extent_m, mut fastest, mut strongest) = ([Vector3::repeat(1.0), Vector3::repeat(-1.0)], 0.0_f64, 0.0_f64);
    let mut done = 0;
    while let Some(cycle) = run.next_cycle().unwrap() {
        let set_point = cycle.platform.unwrap();
        let (place_m, velocity, acceleration) =
            (set_point.position_m, set_point.velocity_m_per_s, set_point.acceleration_m_per_s2);
        extent_m = [extent_m[0].inf(&place_m), extent_m[1].sup(&place_m)];
        fastest = fastest.max(velocity.norm());
        strongest = strongest.max(acceleration.norm());
        let forces_n = cycle.tensions_n.unwrap();
        assert!(forces_n.iter().all(|force_n| (2.0..=30.0).contains(force_n)), "{forces_n:?}");
        let weight = (Vector3::new(0.0, 0.0, -9.80665) - acceleration) * 0.41;
        let outside = Vector6::new(weight.x, weight.y, weight.z, 0.0, 0.0, 0.0);
        let pull =
            structure_matrix::<8>(&params, &set_point.pose()).unwrap() * SVector::<f64, 8>::from_row_slice(forces_n);
        assert!((pull + outside).amax() < 1e-9, "{}", cycle.time_s);
        for (cable, params) in cycle.cables.iter().zip(params.cables()) {
            assert!((cable.length_m - params.length_m(&set_point.pose()).unwrap()).abs() < 1e-12);
        }
        if let Some((last, last_cables)) = &last {
            let mean = (place_m - last.position_m) / 0.001;
            assert!((mean - (velocity + last.velocity_m_per_s) / 2.0).norm() < 3e-4, "{}", cycle.time_s);
            for (cable, last) in cycle.cables.iter().zip(last_cables) {
                let mean = (cable.length_m - last.length_m) / 0.001;
                assert!((mean - 0.5 * (cable.speed_m_per_s + last.speed_m_per_s)).abs() < 3e-4, "{}", cycle.time_s);
            }
        }
        last = Some((set_point, cycle.cables.to_vec()));
        done += 1;
    }
    assert_eq!(done, run.total_cycles());
    let [x0, y0, z0, x1, y1, z1] = BOX_M;
    assert!(
        (extent_m[0] - Vector3::new(x0, y0, z0)).amax() < 1e-9
            && (extent_m[1] - Vector3::new(x1, y1, z1)).amax() < 1e-9
    );
    assert!(
        (0.399..=0.4 + 1e-12).contains(&fastest) && (4.99..=5.0 + 1e-12).contains(&strongest),
        "{fastest} {strongest}"
    );
}

/// Forces change from cycle to cycle no more than the movement does, also where bounds are met.
#[test]
fn forces_do_not_jump() {
    let mut run = Excitation::new(&eight_cables(), &options(BOX_M)).unwrap();
    let mut last: Option<Vec<f64>> = None;
    while let Some(cycle) = run.next_cycle().unwrap() {
        let forces_n = cycle.tensions_n.unwrap();
        for (force_n, last_n) in forces_n.iter().zip(last.iter().flatten()) {
            assert!((force_n - last_n).abs() < 0.5, "{}: {last_n} N, then {force_n} N", cycle.time_s);
        }
        last = Some(forces_n.to_vec());
    }
}

/// The first error of a run, at set-up or later.
fn refused(options: &ExcitationOptions) -> ExcitationError {
    let mut run = match Excitation::new(&eight_cables(), options) {
        Ok(run) => run,
        Err(error) => return error,
    };
    loop {
        match run.next_cycle() {
            Ok(Some(_)) => {}
            Ok(None) => panic!("the run is possible"),
            Err(error) => return error,
        }
    }
}

#[test]
fn the_defaults_of_known_robots_are_possible() {
    for robot in [eight_cables(), hung(), bench("{ wrap_deg = 90.0, sensor = true }", "mu = 0.02")] {
        let mut run = Excitation::new(&robot, &ExcitationOptions::default()).unwrap();
        while run.next_cycle().unwrap().is_some() {}
    }
}

fn advice(error: &ExcitationError) -> String {
    error.help().unwrap().to_string()
}

#[test]
fn forces_that_there_are_not_are_told_with_place_cable_and_remedy() {
    // 0.41 kg cannot be moved with 16 m/s² by cables that pull 2 to 4 N.
    let narrow =
        ExcitationOptions { min_tension_n: Some(2.0), max_tension_n: Some(4.0), ..ExcitationOptions::default() };
    let error = refused(&narrow);
    let ExcitationError::NotHeld { worst: Some((cable, force_n)), holds_at_rest: true, .. } = &error else {
        panic!("{error:?}")
    };
    assert!(cable.starts_with("cable") && !(2.0..=4.0).contains(force_n), "{error}");
    assert!(advice(&error).contains("lower acceleration"), "{error}");

    // Above its base points nothing pulls a platform up.
    let error =
        refused(&ExcitationOptions { max_speed_m_per_s: Some(1.0), ..options([-0.1, -0.1, 0.6, 0.1, 0.1, 0.8]) });
    assert!(matches!(error, ExcitationError::NotHeld { holds_at_rest: false, .. }), "{error:?}");
    assert!(advice(&error).contains("cannot even rest"), "{error}");
}

#[test]
fn what_a_robot_cannot_do_is_told() {
    let winch = bench("{ wrap_deg = 90.0, sensor = true }", "mu = 0.02");
    let error = Excitation::new(&winch, &options(BOX_M)).unwrap_err();
    assert_eq!(error, ExcitationError::NeedsPlatform { key: "box_m", cable: "winch".to_owned() });
    let slow = ExcitationOptions { max_speed_m_per_s: Some(0.002), ..ExcitationOptions::default() };
    assert!(matches!(refused(&slow), ExcitationError::TooLong { .. }));
    let mixed_up = refused(&options([0.1, 0.0, 0.0, -0.1, 0.1, 0.1]));
    assert_eq!(mixed_up, ExcitationError::BadBox { axis: "x", from: 0.1, to: -0.1 });
    assert!(matches!(refused(&options([0.1; 6])), ExcitationError::BadBox { .. }));
    for (key, bad) in [
        ("max_speed_m_per_s", ExcitationOptions { max_speed_m_per_s: Some(f64::NAN), ..ExcitationOptions::default() }),
        ("max_acceleration_m_per_s2", ExcitationOptions { max_acceleration_m_per_s2: Some(0.0), ..Default::default() }),
        ("min_tension_n", ExcitationOptions { min_tension_n: Some(0.0), ..ExcitationOptions::default() }),
        ("max_tension_n", ExcitationOptions { max_tension_n: Some(f64::INFINITY), ..ExcitationOptions::default() }),
        ("max_tension_n", ExcitationOptions { max_tension_n: Some(1.0), ..options(BOX_M) }),
        ("box_m", options([0.0, 0.0, 0.0, f64::NAN, 0.1, 0.1])),
    ] {
        let error = refused(&bad);
        assert!(matches!(error, ExcitationError::OptionOutOfRange { key: told, .. } if told == key), "{error:?}");
    }
}

#[test]
fn a_bench_changes_its_length_alone() {
    let robot = bench("{ wrap_deg = 90.0, sensor = true }", "mu = 0.02");
    let limits = ExcitationOptions { max_speed_m_per_s: Some(0.5), ..ExcitationOptions::default() };
    let mut run = Excitation::new(&robot, &limits).unwrap();
    let (mut shortest_m, mut longest_m) = (f64::INFINITY, 0.0_f64);
    while let Some(cycle) = run.next_cycle().unwrap() {
        assert!(cycle.platform.is_none() && cycle.tensions_n.is_none());
        let cable = cycle.cables[0];
        assert!(cable.speed_m_per_s.abs() <= 0.5 + 1e-12);
        (shortest_m, longest_m) = (shortest_m.min(cable.length_m), longest_m.max(cable.length_m));
    }
    assert!((shortest_m - 0.8).abs() < 1e-9 && (longest_m - 1.2).abs() < 1e-9, "{shortest_m} {longest_m}");
}
