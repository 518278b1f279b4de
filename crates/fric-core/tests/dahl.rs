//! Presliding, \[P\] 16–17.

use fric_core::dahl::dahl_step;
use proptest::prelude::*;

use crate::random::Random;
use crate::support::assert_near;

/// \[P\] 16 with exponent 1, integrated by the classical Runge-Kutta rule in fine steps.
fn integrated(friction_n: f64, sliding_n: f64, sigma_n_per_m: f64, displacement_m: f64) -> f64 {
    let slope = |f: f64| sigma_n_per_m * (1.0 - f / sliding_n * displacement_m.signum());
    let steps = 2000;
    let step_m = displacement_m / f64::from(steps);
    let mut f = friction_n;
    for _ in 0..steps {
        let k1 = slope(f);
        let k2 = slope(f + 0.5 * step_m * k1);
        let k3 = slope(f + 0.5 * step_m * k2);
        let k4 = slope(f + step_m * k3);
        f += step_m / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    f
}

#[test]
fn solves_the_differential_equation() {
    let mut random = Random::new(11);
    for _ in 0..300 {
        let sliding_n = random.range(0.01, 5.0);
        let sigma_n_per_m = random.range(10.0, 1e4);
        let friction_n = random.range(-1.5, 1.5) * sliding_n;
        let displacement_m = random.range(-8.0, 8.0) * sliding_n / sigma_n_per_m;
        let ours = dahl_step(friction_n, sliding_n, sigma_n_per_m, displacement_m);
        assert_near(ours, integrated(friction_n, sliding_n, sigma_n_per_m, displacement_m), 1e-12);
    }
}

#[test]
fn motion_without_load_releases_the_contact() {
    assert_eq!(dahl_step(0.3, 0.0, 1000.0, 1e-6).to_bits(), 0.0_f64.to_bits());
    assert_eq!(dahl_step(-0.3, 0.0, 1000.0, -1e-6).abs().to_bits(), 0.0_f64.to_bits());
    assert_eq!(dahl_step(0.3, 0.0, 1000.0, 0.0).to_bits(), 0.3_f64.to_bits());
}

#[test]
fn a_long_slide_ends_on_the_bound_itself() {
    for sliding_n in [1e-300, 1e-12, 0.3, 7.0, 1e9] {
        for friction_n in [0.0, -sliding_n, 3.0 * sliding_n] {
            assert_eq!(dahl_step(friction_n, sliding_n, 950.0, 1e12).to_bits(), sliding_n.to_bits());
            assert_eq!(dahl_step(friction_n, sliding_n, 950.0, -1e12).to_bits(), (-sliding_n).to_bits());
        }
    }
}

proptest! {
    #![proptest_config(crate::properties::config(2000))]

    #[test]
    fn any_split_of_a_step_is_the_whole_step(
        friction in -1.0..1.0_f64, sliding_n in 0.01..10.0_f64, sigma_n_per_m in 1.0..1e5_f64,
        relative in -5.0..5.0_f64, shares in prop::collection::vec(0.0..1.0_f64, 1..40),
    ) {
        let total: f64 = shares.iter().sum::<f64>().max(1e-9);
        let displacement_m = relative * sliding_n / sigma_n_per_m;
        let whole = dahl_step(friction * sliding_n, sliding_n, sigma_n_per_m, displacement_m * shares.iter().sum::<f64>() / total);
        let split = shares.iter().fold(friction * sliding_n, |f, share| {
            dahl_step(f, sliding_n, sigma_n_per_m, displacement_m * share / total)
        });
        prop_assert!((whole - split).abs() <= 1e-12 * sliding_n);
    }

    #[test]
    fn odd_bit_for_bit(friction in -2.0..2.0_f64, sliding_n in 0.0..10.0_f64, sigma in 1.0..1e5_f64, displacement in -1.0..1.0_f64) {
        let one = dahl_step(friction, sliding_n, sigma, displacement);
        let mirrored = dahl_step(-friction, sliding_n, sigma, -displacement);
        prop_assert_eq!(one, -mirrored);
    }

    #[test]
    fn rest_keeps_every_bit(friction in any::<f64>(), sliding_n in 0.0..1e9_f64, sigma in 1e-3..1e15_f64) {
        // The sign of a zero alone may go.
        let kept = (friction + 0.0).to_bits();
        prop_assert_eq!(dahl_step(friction, sliding_n, sigma, 0.0).to_bits(), kept);
        prop_assert_eq!(dahl_step(friction, sliding_n, sigma, -0.0).to_bits(), kept);
    }

    #[test]
    fn stored_friction_stays_within_a_constant_bound(
        sliding_n in 0.001..100.0_f64, sigma in 1.0..1e6_f64, moves in prop::collection::vec(-3.0..3.0_f64, 1..200),
    ) {
        let mut friction_n = 0.0;
        for relative in moves {
            friction_n = dahl_step(friction_n, sliding_n, sigma, relative * sliding_n / sigma);
            prop_assert!(friction_n.abs() <= sliding_n * (1.0 + 1e-15));
        }
    }

    #[test]
    fn a_bound_that_dropped_is_approached_not_jumped_to(
        excess in 1.0..5.0_f64, sliding_n in 0.01..10.0_f64, relative in 1e-6..3.0_f64,
    ) {
        let (before_n, sigma) = (excess * sliding_n, 950.0);
        let after_n = dahl_step(before_n, sliding_n, sigma, relative * sliding_n / sigma);
        prop_assert!(after_n <= before_n && after_n >= sliding_n * (1.0 - 1e-15));
    }

    #[test]
    fn sliding_the_same_way_is_monotone(friction in -1.0..1.0_f64, sliding_n in 0.01..10.0_f64, steps in prop::collection::vec(0.0..0.5_f64, 2..50)) {
        let mut friction_n = friction * sliding_n;
        for relative in steps {
            let next_n = dahl_step(friction_n, sliding_n, 950.0, relative * sliding_n / 950.0);
            prop_assert!(next_n >= friction_n - 1e-15 * sliding_n);
            friction_n = next_n;
        }
    }
}
