//! The pulley chain in steady sliding, \[P\] 4–14.

use std::f64::consts::{FRAC_PI_2, PI};

use fric_core::pulley::{
    limit_traction, sensor_gains, sliding_friction, sliding_gains, slipping_sensor, traction_ratio, wrap_factor,
};
use fric_core::robot::{CableOptions, FrictionOptions, MAX_PULLEYS, Presliding, PulleyOptions};
use fric_core::{CableInput, CableStatus, Compensator, CycleInput};

use crate::random::Random;
use crate::support::{GUIDE_90, SENSOR_180, UNMONITORED, assert_near, bisect, checked, compensator, corner_cable};

/// \[P\] 5, 6, 8: what the tension behind a pulley lacks to be the one before it plus bearing friction.
fn imbalance(downstream_n: f64, upstream_n: f64, mu: f64, wrap_rad: f64, viscous: f64, speed: f64) -> f64 {
    let normal_n = 0.5 * (upstream_n + downstream_n) * (2.0 * (1.0 - wrap_rad.cos())).sqrt();
    let friction_n = mu * normal_n + viscous * speed.abs();
    downstream_n - (upstream_n + speed.signum() * friction_n)
}

#[test]
fn wrap_factor_is_paper_equation_8() {
    for degrees in 0..=360 {
        let wrap_rad = f64::from(degrees).to_radians();
        assert_near(wrap_factor(wrap_rad).powi(2), 2.0 * (1.0 - wrap_rad.cos()), 1e-14);
    }
}

#[test]
fn one_pulley_solves_equations_5_6_8() {
    let mut random = Random::new(1);
    for _ in 0..10_000 {
        let (mu, wrap_rad) = (random.range(0.0, 0.9), random.range(0.0, 2.0 * PI));
        let (viscous, upstream_n) = (random.range(0.0, 80.0), random.range(0.1, 500.0));
        let speed = random.range(-1.0, 1.0);
        let (gain, viscous_gain) = sliding_gains(speed.signum(), mu, wrap_factor(wrap_rad));
        let ours_n = gain * upstream_n + viscous_gain * viscous * speed;
        // Relations of the paper hold for tensions of either sign as long as the equations are taken as they stand.
        let theirs_n =
            bisect(-1e5, 1e5, |downstream_n| imbalance(downstream_n, upstream_n, mu, wrap_rad, viscous, speed));
        assert_near(ours_n, theirs_n, 1e-12);
    }
}

#[test]
fn at_rest_the_pulley_passes_the_tension_on() {
    assert_eq!(sliding_gains(0.0, 0.3, 1.4), (1.0, 1.0));
    assert_eq!(sensor_gains(0.0, 0.3, 2.0, -1.0), (0.5, 0.5));
}

#[test]
fn sensor_pulley_has_the_papers_special_cases() {
    let mut random = Random::new(2);
    for _ in 0..1000 {
        let (mu, force_n) = (random.range(0.0, 0.5), random.range(0.0, 300.0));
        let (viscous, speed) = (random.range(0.0, 5.0), random.range(-1.0, 1.0));
        let direction = speed.signum();
        // [P] 12: at 90° the sensor feels the tension behind the pulley alone.
        let (gain, viscous_gain) = sensor_gains(direction, mu, wrap_factor(FRAC_PI_2), FRAC_PI_2.cos());
        assert_near(gain * force_n + viscous_gain * viscous * speed, force_n, 1e-12);
        // [P] 14: at 180° it feels both: F_1 = F_s(1 + sμ)/2 + F_pv v/2.
        let (gain, viscous_gain) = sensor_gains(direction, mu, wrap_factor(PI), PI.cos());
        let expected_n = 0.5 * force_n * (1.0 + direction * mu) + 0.5 * viscous * speed;
        assert_near(gain * force_n + viscous_gain * viscous * speed, expected_n, 1e-12);
    }
}

#[test]
fn sensor_pulley_at_any_angle_solves_equations_10_and_11() {
    let mut random = Random::new(3);
    for _ in 0..500 {
        let wrap_rad = random.range(0.7, 2.0 * PI - 0.7);
        let (mu, viscous) = (random.range(0.0, 0.2), random.range(0.0, 5.0));
        let (force_n, speed) = (random.range(0.0, 300.0), random.range(-1.0, 1.0));
        let (gain, viscous_gain) = sensor_gains(speed.signum(), mu, wrap_factor(wrap_rad), wrap_rad.cos());
        let ours_n = gain * force_n + viscous_gain * viscous * speed;
        // For a tension F_0 on the winch side [P] 10 gives F_1; [P] 11 says what the sensor then shows.
        let behind_n = |before_n: f64| {
            bisect(-1e6, 1e6, |downstream_n| imbalance(downstream_n, before_n, mu, wrap_rad, viscous, speed))
        };
        let before_n = bisect(-1e5, 1e5, |before_n| behind_n(before_n) - before_n * wrap_rad.cos() - force_n);
        assert_near(ours_n, behind_n(before_n), 1e-10);
    }
}

#[test]
fn sliding_friction_is_never_negative() {
    assert_near(sliding_friction(0.1, 2.0, 10.0, 12.0), 0.1 * 2.0 * 11.0, 1e-15);
    assert_eq!(sliding_friction(0.1, 2.0, -10.0, 2.0).to_bits(), 0.0_f64.to_bits());
}

#[test]
fn traction_holds_the_ratio_at_its_bound() {
    let ratio = (0.2 * PI).exp();
    assert_eq!(limit_traction(10.0, 11.0, ratio), (11.0, false));
    let (held_n, slips) = limit_traction(10.0, 30.0, ratio);
    assert!(slips);
    assert_near(held_n, 10.0 * ratio, 1e-15);
    let (held_n, slips) = limit_traction(10.0, 1.0, ratio);
    assert!(slips);
    assert_near(held_n, 10.0 / ratio, 1e-15);
}

/// \[P\] 4: along the wrap the tension that a slipping cable can hold grows by `dT = μ_p·T·dα`, here in a hundred thousand steps of the midpoint rule.
#[test]
fn the_slip_limit_grows_along_the_wrap() {
    for (traction_mu, wrap_rad) in [(0.3, PI), (0.05, 6.0), (1.4, 0.7), (0.0, 2.0), (0.7, 0.0)] {
        let half_step = 0.5e-5 * traction_mu * wrap_rad;
        let ratio = (0..100_000).fold(1.0, |tension: f64, _| tension * (1.0 + half_step) / (1.0 - half_step));
        assert_near(traction_ratio(traction_mu, wrap_rad), ratio, 1e-9);
    }
}

/// The tensions before and behind have the ratio of the bound that was passed, and the sensor shows its force by \[P\] 11.
#[test]
fn a_slipping_sensor_pulley_still_shows_its_force() {
    let mut random = Random::new(5);
    for _ in 0..1000 {
        let (wrap_rad, traction_mu) = (random.range(0.7, 2.0 * PI - 0.7), random.range(0.05, 0.5));
        let (force_n, ratio) = (random.range(0.1, 300.0), traction_ratio(traction_mu, wrap_rad));
        let rises = random.below(2) == 1;
        let cos = wrap_rad.cos();
        let unlimited = if rises { (1.0, 1.1 * ratio) } else { (1.1 * ratio, 1.0) };
        let (before_n, behind_n) = slipping_sensor(force_n, cos, unlimited, ratio);
        let expected_ratio = if rises { ratio } else { 1.0 / ratio };
        // Where friction would take all of the sensor's force there are no such tensions.
        if expected_ratio > cos + 1e-3 {
            assert_near(behind_n / before_n, expected_ratio, 1e-12);
            assert_near(behind_n - cos * before_n, force_n, 1e-9);
        }
    }
}

/// Drives one cable in one direction until its presliding is over; gives the output.
fn slide(
    options: &CableOptions<'_>,
    sensor_force_n: f64,
    speed_m_per_s: f64,
) -> (fric_core::CableOutput, Compensator<1>) {
    let mut compensator = compensator::<1>(std::slice::from_ref(options), UNMONITORED);
    let mut output = fric_core::CycleOutput::default();
    for cycle in 0..1500 {
        let length_m = f64::from(cycle) * 0.001 * speed_m_per_s;
        let cables = [CableInput { sensor_force_n, length_m, speed_m_per_s }];
        output = compensator.step(&CycleInput { cables, ..CycleInput::default() });
    }
    (output.cables[0], compensator)
}

/// As many pulleys as there may be, each by equation 10 with `F_pv = 0`: `F_1 = F_0·(2 + sμk)/(2 − sμk)`.
#[test]
fn the_longest_chain_slides_as_its_pulleys_do() {
    let pulleys = [PulleyOptions::Fixed { wrap_rad: std::f64::consts::FRAC_PI_2, sensor: false }; MAX_PULLEYS];
    let friction = FrictionOptions { mu: 0.03, sigma_n_per_m: Some(5000.0), viscous_n_s_per_m: 0.0, offset_n: 0.0 };
    for count in 1..=MAX_PULLEYS {
        for (sense, presliding) in
            [1.0, -1.0].into_iter().flat_map(|sense| [(sense, Presliding::PerPulley), (sense, Presliding::Lumped)])
        {
            let options = CableOptions { presliding, friction, ..CableOptions::new(&pulleys[..count]) };
            let (output, _) = slide(&options, 20.0, sense * 0.5);
            let rubs = sense * 0.03 * std::f64::consts::SQRT_2;
            let expected_n = 20.0 * ((2.0 + rubs) / (2.0 - rubs)).powi(i32::try_from(count).unwrap());
            assert_near(output.force_at_platform_n, expected_n, 1e-9);
        }
    }
}

#[test]
fn steady_sliding_of_both_forms_is_equation_10_down_the_chain() {
    let mut random = Random::new(4);
    for _ in 0..15 {
        let wraps_rad = [random.range(0.8, 5.0), random.range(0.1, 6.0), random.range(0.1, 6.0)];
        let pulleys = wraps_rad.map(|wrap_rad| PulleyOptions::Fixed { wrap_rad, sensor: false });
        let sensor = [PulleyOptions::Fixed { wrap_rad: wraps_rad[0], sensor: true }, pulleys[1], pulleys[2]];
        let (mu, viscous) = (random.range(0.0, 0.15), random.range(0.0, 2.0));
        let (force_n, speed) =
            (random.range(5.0, 100.0), random.range(0.05, 1.0) * [-1.0, 1.0][usize::from(random.below(2) == 1)]);
        for (list, sensor_wrap_rad) in [(&sensor, Some(wraps_rad[0])), (&pulleys, None)] {
            let mut expected_n = force_n;
            for (place, wrap_rad) in wraps_rad.into_iter().enumerate() {
                let before_n = if let (0, Some(wrap_rad)) = (place, sensor_wrap_rad) {
                    let shows_n = |before_n: f64| {
                        let behind_n = bisect(-1e6, 1e6, |downstream_n| {
                            imbalance(downstream_n, before_n, mu, wrap_rad, viscous, speed)
                        });
                        behind_n - before_n * wrap_rad.cos() - force_n
                    };
                    bisect(-1e5, 1e5, shows_n)
                } else {
                    expected_n
                };
                expected_n =
                    bisect(-1e6, 1e6, |downstream_n| imbalance(downstream_n, before_n, mu, wrap_rad, viscous, speed));
            }
            if expected_n < 0.1 {
                continue;
            }
            for presliding in [Presliding::PerPulley, Presliding::Lumped] {
                let friction =
                    FrictionOptions { mu, sigma_n_per_m: Some(5000.0), viscous_n_s_per_m: viscous, offset_n: 0.0 };
                let options = CableOptions { presliding, friction, ..CableOptions::new(list) };
                let (output, _) = slide(&options, force_n, speed);
                assert!(output.status.is_ok(), "{}", output.status);
                assert_near(output.force_at_platform_n, expected_n, 1e-9);
            }
        }
    }
}

/// Friction that exceeds what the cable can pass on to the pulley by its own friction.
fn slipping(pulleys: &[PulleyOptions], presliding: Presliding) -> CableOptions<'_> {
    let friction = FrictionOptions { mu: 0.5, sigma_n_per_m: Some(5000.0), viscous_n_s_per_m: 1.0, offset_n: 0.0 };
    CableOptions { presliding, friction, traction_mu: Some(0.05), ..CableOptions::new(pulleys) }
}

#[test]
fn slip_at_a_guide_pulley_is_equation_4() {
    let pulleys = [GUIDE_90];
    for presliding in [Presliding::PerPulley, Presliding::Lumped] {
        for speed in [-0.2, 0.2] {
            let (output, _) = slide(&slipping(&pulleys, presliding), 20.0, speed);
            assert_eq!(output.status, CableStatus::SLIP, "{presliding:?}");
            let expected_n = 20.0 * (speed.signum() * 0.05 * FRAC_PI_2).exp();
            match presliding {
                Presliding::PerPulley => assert_near(output.force_at_platform_n, expected_n, 1e-12),
                Presliding::Lumped => assert_near(output.force_at_platform_n, expected_n, 1e-9),
            }
        }
    }
}

#[test]
fn slip_at_the_sensor_pulley_keeps_its_equilibrium() {
    // The Coulomb friction alone is beyond what the cable can pass on, or the viscous friction alone.
    for (mu, viscous, presliding) in [
        (0.5, 1.0, Presliding::PerPulley),
        (0.01, 20.0, Presliding::PerPulley),
        (0.5, 1.0, Presliding::Lumped),
        (0.01, 20.0, Presliding::Lumped),
    ] {
        for (speed, wrap_rad) in
            [(-0.2, PI), (0.2, PI), (0.2, 2.0), (-0.2, 2.0), (0.2, FRAC_PI_2), (-0.2, FRAC_PI_2), (0.2, 1.2)]
        {
            let pulleys = [PulleyOptions::Fixed { wrap_rad, sensor: true }];
            let mut options = slipping(&pulleys, presliding);
            (options.friction.mu, options.friction.viscous_n_s_per_m) = (mu, viscous);
            let (output, compensator) = slide(&options, 20.0, speed);
            assert_eq!(output.status, CableStatus::SLIP, "{presliding:?} {wrap_rad} {speed} {viscous}");
            // [P] 11 with F_1/F_0 at the bound of [P] 4.
            let ratio = (speed.signum() * 0.05 * wrap_rad).exp();
            let behind_n = 20.0 / (1.0 - wrap_rad.cos() / ratio);
            assert_near(output.force_at_platform_n, behind_n, 1e-9);
            let before_n = (behind_n - 20.0) / wrap_rad.cos();
            if wrap_rad.cos().abs() > 0.1 {
                assert_near(behind_n / before_n, ratio, 1e-9);
            }
            if presliding == Presliding::PerPulley {
                // The bearing stores what the viscous friction leaves of the difference.
                let stored_n = compensator.pulley_friction_n(0)[0];
                assert_near(stored_n, behind_n * (1.0 - 1.0 / ratio) - viscous * speed, 1e-9);
            }
        }
    }
}

#[test]
fn slip_at_the_pulley_that_follows_the_pose() {
    let options = CableOptions {
        friction: FrictionOptions { mu: 0.5, sigma_n_per_m: Some(5000.0), viscous_n_s_per_m: 0.0, offset_n: 0.0 },
        traction_mu: Some(0.05),
        ..crate::support::corner_cable(0, Presliding::PerPulley)
    };
    let pulleys = [crate::support::SWIVEL];
    let options = CableOptions { pulleys: &pulleys, ..options };
    let params = crate::support::checked(&[options]);
    let mut compensator = compensator::<1>(&[options], UNMONITORED);
    let pose = Random::new(9).pose(0.1);
    let wrap_rad = params[0].pose_wrap_rad(&pose).unwrap();
    for cycle in 0..3000 {
        let cables = [CableInput { sensor_force_n: 20.0, length_m: f64::from(cycle) * 1e-4, speed_m_per_s: 0.1 }];
        let output = compensator.step(&CycleInput { cables, pose: Some(pose), ..CycleInput::default() }).cables[0];
        if cycle > 100 {
            assert_eq!(output.status, CableStatus::SLIP);
            assert_near(output.force_at_platform_n, 20.0 * (0.05 * wrap_rad).exp(), 1e-12);
        }
    }
}

#[test]
fn a_slip_limit_does_not_touch_a_cable_without_one() {
    let pulleys = [SENSOR_180, GUIDE_90];
    // Reeling in fast enough that viscous friction eats the tension.
    for presliding in [Presliding::PerPulley, Presliding::Lumped] {
        let free = CableOptions { traction_mu: None, ..slipping(&pulleys, presliding) };
        let limited = slipping(&pulleys, presliding);
        let mut alone = compensator::<2>(&[free, free], UNMONITORED);
        let mut beside = compensator::<2>(&[free, limited], UNMONITORED);
        for cycle in 0..3000 {
            let speed_m_per_s = (f64::from(cycle) * 0.003).sin() * 4.0;
            let length_m = (f64::from(cycle) * 0.003).cos() * -4.0 / 3.0;
            let cables = [CableInput { sensor_force_n: 4.0, length_m, speed_m_per_s }; 2];
            let input = CycleInput { cables, ..CycleInput::default() };
            let (one, other) = (alone.step(&input).cables[0], beside.step(&input).cables[0]);
            assert_near(one.force_at_platform_n, other.force_at_platform_n, 1e-12);
            assert_eq!(one.status, other.status);
            let stored = [alone.pulley_friction_n(0), beside.pulley_friction_n(0)];
            for (one, other) in stored[0].into_iter().zip(stored[1]) {
                assert_near(one, other, 1e-12);
            }
        }
    }
}

/// `f_c/σ` of one Dahl state: the pulley with the greatest wrap of a chain, or all of them together; a wrap that follows the pose counts as 90°.
#[test]
fn the_longest_memory_is_that_of_the_greatest_wrap() {
    let factors = [2.0, std::f64::consts::SQRT_2, std::f64::consts::SQRT_2];
    let (mu, sigma_n_per_m) = (0.03, 700.0);
    let memory = |presliding| checked(&[corner_cable(0, presliding)])[0].memory_m_per_n(mu, sigma_n_per_m);
    // The sensor at 180° shows twice the tension; each of three contacts has a third of the stiffness.
    assert_near(memory(Presliding::PerPulley), 3.0 * 0.5 * mu * factors[0] / sigma_n_per_m, 1e-15);
    assert_near(memory(Presliding::Lumped), 0.5 * mu * factors.iter().sum::<f64>() / sigma_n_per_m, 1e-15);
}
