//! Shapes of segments with few unknowns against a finely divided elastica.

use fric_tendon::{Friction, ManipulatorOptions, ManipulatorParams, StaticModel, TendonOptions};
use fric_tendon_lab::simulate::elastica;

/// Greatest distance of a disk between model and elastica as a share of the length, and the bend in degrees.
fn deviation(options: &ManipulatorOptions<'_>, tension_n: [f64; 2], links: usize) -> (f64, f64) {
    let params = ManipulatorParams::new(options).unwrap();
    let mut model = StaticModel::<32>::new(&params).unwrap();
    assert!(model.solve(tension_n, Friction::None).is_ok());
    let of = |tension_n: f64| vec![tension_n; params.disk_count()];
    let (positions, bend_rad) = elastica(&params, links, [&of(tension_n[0]), &of(tension_n[1])]).unwrap();
    let distances =
        model.shape().disk_position_m().iter().zip(&positions).map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]));
    (distances.fold(0.0, f64::max) / params.length_m(), bend_rad.to_degrees())
}

#[test]
fn without_weight_the_shape_is_the_elasticas_to_two_thousandths() {
    for (tension_n, expected_deg) in [(0.3125, 30.0), (0.619, 60.0), (0.922, 90.0), (1.170, 115.0), (2.0, 200.0)] {
        let (share, bend_deg) = deviation(&ManipulatorOptions::published(), [tension_n, 0.0], 40);
        assert!((bend_deg - expected_deg).abs() < 3.0, "{bend_deg}");
        assert!(share < 0.002, "{share} at {bend_deg}°");
    }
}

#[test]
fn with_weight_and_load_to_five_thousandths() {
    for (gravity, tip_mass_kg) in [([0.0, -9.81], 0.005), ([9.81, 0.0], 0.01), ([-2.0, 0.0], 0.002)] {
        let options = ManipulatorOptions {
            gravity_m_per_s2: gravity,
            tip_mass_kg,
            tip_force_n: [0.0, 0.01],
            ..ManipulatorOptions::published()
        };
        for tension_n in [[0.3, 0.0], [0.62, 0.1], [0.9, 0.0], [1.4, 0.2]] {
            let (share, bend_deg) = deviation(&options, tension_n, 40);
            assert!(share < 0.005, "{share} at {bend_deg}°");
        }
    }
}

#[test]
fn segments_of_different_lengths_are_the_elasticas() {
    let flat = ManipulatorOptions {
        pitch_m: &[0.05, 0.03, 0.045, 0.035, 0.02, 0.046, 0.03, 0.04],
        ..ManipulatorOptions::published()
    };
    let standing = ManipulatorOptions {
        gravity_m_per_s2: [-9.81, 0.0],
        disk_mass_kg: 0.0003,
        precurvature_per_m: &[0.4],
        tip_force_n: [0.0, 0.01],
        ..flat
    };
    for tension_n in [[0.5, 0.0], [1.2, 0.0], [0.9, 0.2]] {
        let (share, bend_deg) = deviation(&flat, tension_n, 40);
        assert!(share < 0.003, "{share} at {bend_deg}°");
        let (share, bend_deg) = deviation(&standing, tension_n, 40);
        assert!(share < 0.006, "{share} at {bend_deg}°");
        // The mean pitch is another arm.
        let even = deviation(&ManipulatorOptions { pitch_m: &[0.037], ..flat }, tension_n, 40);
        assert!((even.1 - deviation(&flat, tension_n, 40).1).abs() > 0.05, "{even:?}");
    }
}

#[test]
fn refinement_converges_with_the_fourth_power() {
    // The same length and weight in more and more segments under a load on the tip: the curvature of a segment is right up to what is quadratic in its
    // length. The elastica's own error falls with the square of its links; it is 2e-7 here, and hides what 32 segments leave.
    let of = |disks: usize, links: usize| {
        let options = ManipulatorOptions {
            disk_count: disks,
            pitch_m: &[0.296 / f64::from(u32::try_from(disks).unwrap())],
            disk_mass_kg: 0.0,
            gravity_m_per_s2: [0.0, -9.81],
            tip_force_n: [0.0, -0.04],
            tendons: [TendonOptions::published(); 2],
            ..ManipulatorOptions::published()
        };
        deviation(&options, [0.8, 0.0], links).0
    };
    let errors = [(4, 200), (8, 200), (16, 100)].map(|(disks, links)| of(disks, links));
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((3.7..4.9).contains(&order), "order {order} of {errors:?}");
    }
}
