use super::*;
use core::f64::consts::{FRAC_PI_2, PI};

fn no_effects() -> TruthEffects {
    TruthEffects::default()
}

fn pulley(mu: f64, wrap_rad: f64, viscous_n_s_per_m: f64) -> PulleyTruth {
    PulleyTruth { mu, cos_wrap: Some(wrap_rad.cos()), viscous_n_s_per_m }
}

fn moment(force_n: f64, length_m: f64, speed_m_per_s: f64) -> Moment {
    Moment {
        force_n,
        length_m,
        speed_m_per_s,
        acceleration_m_per_s2: 0.0,
        force_n_per_s: 0.0,
        pose_cos: 1.0,
        time_s: 0.0,
    }
}

/// Moves at constant speed and tension.
fn slide(chain: &mut BristleChain, force_n: f64, speed_m_per_s: f64, cycles: u32) -> Moment {
    let at = |cycle: u32| moment(force_n, speed_m_per_s * 0.001 * f64::from(cycle), speed_m_per_s);
    for cycle in 0..cycles {
        chain.advance(&at(cycle), &at(cycle + 1), 0.001, SUBSTEPS);
    }
    at(cycles)
}

/// Returns `F_s` from `F_n` by \[P\] 10 and 11, solved backwards with the paper's approximate normal force.
fn steady_sensor_n(pulleys: &[(f64, f64, f64)], force_n: f64, speed_m_per_s: f64) -> f64 {
    let sign = speed_m_per_s.signum();
    let mut downstream_n = force_n;
    let mut upstream_n = force_n;
    for &(mu, wrap_rad, viscous) in pulleys.iter().rev() {
        let k = (2.0 * (1.0 - wrap_rad.cos())).sqrt();
        downstream_n = upstream_n;
        upstream_n = (downstream_n * (2.0 - sign * mu * k) - 2.0 * viscous * speed_m_per_s) / (2.0 + sign * mu * k);
    }
    downstream_n - upstream_n * pulleys[0].1.cos()
}

/// With the mean m and the difference d of both tensions, \[P\] 7 is `√(k²m² + d² cos²(α/2))` and \[P\] 8 is `k·m`. The exact normal force is
/// therefore greater by the fraction `(d cos(α/2)/(k m))²/2` to second order. The friction of each pulley differs by this fraction, and so does the
/// sensor, summed over the chain.
#[test]
fn steady_sliding_is_the_papers_up_to_the_second_order_of_the_normal_force() {
    let force_n = 8.0;
    for angles in [[PI, FRAC_PI_2, 1.1], [FRAC_PI_2, 0.5, 2.8], [2.2, 1.0, 0.3]] {
        for (mu, viscous) in [(0.011, 0.0), (0.025, 0.35), (0.2, 0.1)] {
            for speed_m_per_s in [0.3, -0.3, 1.0, -1.0] {
                let pulleys = angles.map(|wrap_rad| (mu, wrap_rad, viscous));
                let truth = pulleys.map(|(mu, wrap_rad, viscous)| pulley(mu, wrap_rad, viscous));
                let mut chain = BristleChain::new(&truth, 1000.0, true, no_effects());
                let end = slide(&mut chain, force_n, speed_m_per_s, 400);
                let bound_n: f64 = pulleys
                    .iter()
                    .map(|(mu, wrap_rad, viscous)| {
                        let k = 2.0 * (wrap_rad / 2.0).sin();
                        // Every tension of the chain lies within a factor e^{Σμk} and the viscous drag of F_n.
                        let greatest_n = force_n * (3.0 * mu * 2.0).exp() + 3.0 * viscous;
                        let least_n = force_n * (-3.0 * mu * 2.0).exp() - 3.0 * viscous;
                        let difference_n = 1.1 * mu * k * greatest_n + viscous * speed_m_per_s.abs();
                        let share = (difference_n * (wrap_rad / 2.0).cos() / (k * least_n)).powi(2) / 2.0;
                        share * mu * k * greatest_n
                    })
                    .sum();
                let (is_n, said_n) = (chain.sensor_force_n(&end), steady_sensor_n(&pulleys, force_n, speed_m_per_s));
                // A sensor at 180° measures both sides.
                let difference_n = (is_n - said_n).abs();
                assert!(difference_n <= 2.5 * bound_n + 1e-9, "{difference_n} N, bound {bound_n} N");
            }
        }
    }
}

/// For one pulley of 180°, the exact normal force is `F_0 + F_1`, without a second-order term. The tension is given on the platform side, so `f_c(f)
/// = μ(2F_1 − f)`, and `df/dl = σ(1 − f/f_c)` at constant `F_1`. For a small μ the solution is `f ≈ f_c(1 − e^{−σl/f_c})`; the full solution of the
/// separable equation is computed by quadrature here.
#[test]
fn the_hysteresis_of_one_pulley_is_dahls_exponential() {
    let (mu, sigma, force_n) = (0.02, 1000.0, 10.0);
    let mut chain = BristleChain::new(&[pulley(mu, PI, 0.0)], sigma, true, no_effects());
    let speed_m_per_s = 0.05;
    let mut travelled_m = 0.0;
    let mut friction_n = 0.0;
    for (sign, cycles) in [(1.0, 60), (-1.0, 25), (1.0, 12), (-1.0, 90)] {
        let steady_n = sign * 2.0 * mu * force_n / (1.0 + sign * mu);
        for _ in 0..cycles {
            let next_m = travelled_m + sign * speed_m_per_s * 0.001;
            let at = |length_m| moment(force_n, length_m, sign * speed_m_per_s);
            chain.advance(&at(travelled_m), &at(next_m), 0.001, SUBSTEPS);
            // Independent method: f_c = μ(2F_1 − f) with f at the middle of the step, in 100 exact exponential steps.
            for _ in 0..100 {
                let part_m = speed_m_per_s * 1e-5;
                let half = |f: f64, dl: f64, f_c: f64| sign * f_c + (f - sign * f_c) * (-sigma * dl / f_c).exp();
                let middle_n = half(friction_n, part_m / 2.0, mu * (2.0 * force_n - friction_n));
                friction_n = half(friction_n, part_m, mu * (2.0 * force_n - middle_n));
            }
            let is_n = chain.friction_n()[0];
            assert!((is_n - friction_n).abs() < 2e-6, "{is_n} {friction_n}");
            assert!(is_n.abs() <= 2.0 * mu * force_n / (1.0 - mu) + 1e-12);
            travelled_m = next_m;
        }
        if cycles >= 60 {
            assert!((friction_n - steady_n).abs() < 2e-3);
        }
    }
}

/// The exponential itself: a constant sliding limit, obtained with a tiny μ and a scaled σ.
#[test]
fn constant_sliding_limit_gives_the_closed_form() {
    let (mu, force_n) = (1e-6, 1e4);
    let (sigma, speed_m_per_s) = (50.0, 0.05);
    // f_c = μ·2F to one part in a million.
    let sliding_n = 2.0 * mu * force_n;
    let mut chain = BristleChain::new(&[pulley(mu, PI, 0.0)], sigma, true, no_effects());
    for cycle in 1..=40 {
        let at = |cycle: u32| moment(force_n, speed_m_per_s * 0.001 * f64::from(cycle), speed_m_per_s);
        chain.advance(&at(cycle - 1), &at(cycle), 0.001, 10);
        let path_m = speed_m_per_s * 0.001 * f64::from(cycle);
        let expected_n = sliding_n * (1.0 - (-sigma * path_m / sliding_n).exp());
        assert!((chain.friction_n()[0] - expected_n).abs() < 1e-5 * sliding_n);
    }
}

/// Smooth motion with varying tension and wrap: twice the steps give a quarter of the error.
#[test]
fn integration_is_of_second_order() {
    let truth =
        [pulley(0.03, PI, 0.2), pulley(0.02, FRAC_PI_2, 0.1), PulleyTruth { cos_wrap: None, ..pulley(0.02, 0.0, 0.1) }];
    let at = |time_s: f64| Moment {
        pose_cos: 0.3 * (5.0 * time_s).cos(),
        ..moment(8.0 + 3.0 * (9.0 * time_s).sin(), 0.02 * time_s + 0.1 * time_s * time_s, 0.02 + 0.2 * time_s)
    };
    let run = |substeps| {
        let mut chain = BristleChain::new(&truth, 900.0, true, no_effects());
        for cycle in 0..4 {
            let [from, to] = [cycle, cycle + 1].map(|cycle| at(0.005 * f64::from(cycle)));
            chain.advance(&from, &to, 0.005, substeps);
        }
        chain.sensor_force_n(&at(0.02))
    };
    let best_n = run(640);
    let errors_n = [5, 10, 20, 40].map(|substeps| (run(substeps) - best_n).abs());
    for pair in errors_n.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.0..5.5).contains(&ratio), "{errors_n:?}");
    }
    assert!(errors_n[1] < 1e-5, "{errors_n:?}");
}

#[test]
fn rest_keeps_the_bristle_also_when_the_load_falls() {
    let mut chain = BristleChain::new(&[pulley(0.02, PI, 0.0)], 1000.0, true, no_effects());
    let end = slide(&mut chain, 10.0, 0.05, 100);
    let still = Moment { speed_m_per_s: 0.0, ..end };
    let before = chain.friction_n();
    chain.advance(&still, &Moment { force_n: 2.0, ..still }, 0.001, SUBSTEPS);
    assert_eq!(chain.friction_n(), before);
}

#[test]
fn a_stiff_bristle_reverses_at_once_and_a_bearing_without_friction_does_nothing() {
    let mut chain = BristleChain::new(&[pulley(0.02, PI, 0.0)], STIFF_N_PER_M, true, no_effects());
    slide(&mut chain, 10.0, 0.05, 3);
    let end = slide(&mut chain, 10.0, -0.05, 1);
    // F_1 = F_s(1 − μ)/2 reeling in ([P] 14).
    assert!((chain.sensor_force_n(&end) - 20.0 / 0.98).abs() < 1e-6);
    let mut smooth = BristleChain::new(&[pulley(0.0, PI, 0.0)], 1000.0, true, no_effects());
    let end = slide(&mut smooth, 10.0, 0.05, 5);
    assert!((smooth.sensor_force_n(&end) - 20.0).abs() < 1e-12);
}

#[test]
fn a_sensor_in_line_feels_the_winch_side() {
    let mut chain = BristleChain::new(&[pulley(0.02, PI, 0.0)], 1000.0, false, no_effects());
    let end = slide(&mut chain, 10.0, 0.05, 200);
    // F_0 = F_1(1 − μ)/(1 + μ) paying out at 180°.
    assert!((chain.sensor_force_n(&end) - 10.0 * 0.98 / 1.02).abs() < 1e-6);
}

/// Over a closed loop of displacement, friction dissipates energy and never supplies it.
#[test]
fn a_closed_loop_dissipates() {
    let mut chain = BristleChain::new(&[pulley(0.05, PI, 0.0), pulley(0.05, 1.0, 0.0)], 1000.0, true, no_effects());
    let at = |step: u32| {
        let phase = f64::from(step) * 0.01;
        moment(10.0, 5e-4 * phase.sin(), 5e-4 * 10.0 * phase.cos())
    };
    let mut work_j = 0.0;
    for step in 0..628 {
        chain.advance(&at(step), &at(step + 1), 0.001, SUBSTEPS);
        work_j += chain.friction_n().iter().sum::<f64>() * (at(step + 1).length_m - at(step).length_m);
    }
    assert!(work_j > 1e-5, "{work_j}");
}
