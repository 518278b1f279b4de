//! Tests of effects on the chain of bristles, each against a closed form or another method.

use super::*;
use core::f64::consts::{FRAC_PI_2, PI};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::simulate::HiddenEffect;
use crate::simulate::truth::CableCause;

type Outcome = Result<(), Box<dyn core::error::Error>>;
/// Sliding friction, N, as a function of the normal force, N.
type Law = Box<dyn Fn(f64) -> f64>;

const MU: f64 = 0.03;
const VISCOUS: f64 = 0.2;
const FORCE_N: f64 = 9.0;

fn with(texts: &[&str]) -> Result<TruthEffects, Box<dyn core::error::Error>> {
    let hidden = texts.iter().map(|text| HiddenEffect::parse(text)).collect::<Result<Vec<_>, _>>()?;
    let cable = CableCause { start_length_m: 1.0, sensor_ratio: 0.5, random: &|_| ChaCha8Rng::seed_from_u64(0) };
    Ok(TruthEffects::new(&[], &hidden, &[], &cable)?)
}

fn pulley(mu: f64, wrap_rad: f64, viscous_n_s_per_m: f64) -> PulleyTruth {
    PulleyTruth { mu, cos_wrap: Some(wrap_rad.cos()), viscous_n_s_per_m }
}

fn moment(force_n: f64, length_m: f64, speed_m_per_s: f64, time_s: f64) -> Moment {
    Moment { force_n, length_m, speed_m_per_s, acceleration_m_per_s2: 0.0, force_n_per_s: 0.0, pose_cos: 1.0, time_s }
}

/// Returns the friction of one pulley with a wrap of 180° at constant speed and tension, after a long distance, at a time since the start.
fn steady_n(texts: &[&str], speed_m_per_s: f64, start_s: f64) -> Result<f64, Box<dyn core::error::Error>> {
    let mut chain = BristleChain::new(&[pulley(MU, PI, VISCOUS)], 5000.0, true, with(texts)?);
    // The number of cycles covers 40 mm in a short time.
    let cycle_s = 0.04 / 400.0 / speed_m_per_s.abs();
    let at = |cycle: u32| {
        let since_s = cycle_s * f64::from(cycle);
        moment(FORCE_N, speed_m_per_s * since_s, speed_m_per_s, start_s)
    };
    for cycle in 0..400 {
        chain.advance(&at(cycle), &at(cycle + 1), cycle_s, SUBSTEPS);
    }
    Ok(chain.friction_n()[0])
}

/// Solves for the friction by bisection. At 180° the normal force is exactly `F_0 + F_1 = 2F_1 − f − F_pv v`.
fn balanced_n(sliding_n: impl Fn(f64) -> f64, speed_m_per_s: f64, viscous: f64) -> f64 {
    let miss_n = |f: f64| f - speed_m_per_s.signum() * sliding_n(2.0 * FORCE_N - f - viscous * speed_m_per_s);
    let (mut low, mut high) = (-FORCE_N, FORCE_N);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if miss_n(middle) > 0.0 { high = middle } else { low = middle }
    }
    low
}

#[test]
fn steady_sliding_has_its_closed_form_under_every_effect() -> Outcome {
    for speed_m_per_s in [0.02, -0.02, 0.3, -0.3] {
        let sign = f64::signum(speed_m_per_s);
        let film = 1.0 + 0.6 * f64::exp(-(speed_m_per_s / 0.03).powi(2));
        let asymmetry = 1.0 + 0.25 * sign;
        let cases: [(&[&str], Law, f64); 8] = [
            (&[], Box::new(|normal_n| MU * normal_n), VISCOUS),
            (&["stribeck:ratio=0.6,velocity_m_per_s=0.03"], Box::new(move |normal_n| film * MU * normal_n), VISCOUS),
            (
                &["direction_asymmetry:coulomb_ratio=0.25,viscous_ratio=0.1"],
                Box::new(move |normal_n| asymmetry * MU * normal_n),
                VISCOUS * (1.0 + 0.1 * sign),
            ),
            (&["bearing_drag:drag_n=0.15"], Box::new(|normal_n| MU * normal_n + 0.15), VISCOUS),
            (
                &["load_nonlinearity:exponent=0.7,reference_n=6"],
                Box::new(|normal_n: f64| MU * 6.0 * (normal_n / 6.0).powf(0.7)),
                VISCOUS,
            ),
            (&["friction_drift:rate_per_s=-0.01"], Box::new(|normal_n| MU * 0.75 * normal_n), VISCOUS),
            (&["presliding_shape:exponent=0.6"], Box::new(|normal_n| MU * normal_n), VISCOUS),
            (
                &[
                    "bearing_drag:drag_n=0.1",
                    "direction_asymmetry:coulomb_ratio=0.25",
                    "friction_drift:rate_per_s=0.01",
                ],
                Box::new(move |normal_n| asymmetry * 1.25 * MU * normal_n + 0.1),
                VISCOUS,
            ),
        ];
        for (texts, law, viscous) in cases {
            let expected_n = balanced_n(law, speed_m_per_s, viscous);
            let is_n = steady_n(texts, speed_m_per_s, 25.0)?;
            assert!((is_n - expected_n).abs() < 1e-7, "{texts:?} at {speed_m_per_s}: {is_n} {expected_n}");
        }
    }
    Ok(())
}

#[test]
fn friction_that_drifts_does_not_turn_round() -> Outcome {
    assert!(steady_n(&["friction_drift:rate_per_s=-0.5"], 0.1, 25.0)?.abs() < 1e-12);
    Ok(())
}

/// Compares with \[P\] 16, integrated by the classical Runge-Kutta method on the force with 2,000 steps per cycle, in both directions.
#[test]
fn the_exponent_of_presliding_bends_the_hysteresis() -> Outcome {
    for exponent in [0.6, 1.0, 1.5, 1.8, 2.5] {
        let (sigma, speed_m_per_s) = (1000.0, 0.05);
        let effects = with(&[&format!("presliding_shape:exponent={exponent}")])?;
        let mut chain = BristleChain::new(&[pulley(MU, PI, 0.0)], sigma, true, effects);
        let (mut travelled_m, mut friction_n, mut cycle) = (0.0, 0.0_f64, 0.0);
        for (sign, cycles) in [(1.0, 40), (-1.0, 12), (1.0, 7), (-1.0, 30)] {
            let slope = |friction_n: f64| {
                let u = 1.0 - sign * friction_n / (MU * (2.0 * FORCE_N - friction_n));
                sign * sigma * u.signum() * u.abs().powf(exponent)
            };
            for _ in 0..cycles {
                let next_m = travelled_m + sign * speed_m_per_s * 0.001;
                let at = |length_m| moment(FORCE_N, length_m, sign * speed_m_per_s, 0.001 * cycle);
                chain.advance(&at(travelled_m), &at(next_m), 0.001, SUBSTEPS);
                let step_m = speed_m_per_s * 0.001 / 2000.0;
                for _ in 0..2000 {
                    let first = slope(friction_n);
                    let second = slope(friction_n + 0.5 * step_m * first);
                    let third = slope(friction_n + 0.5 * step_m * second);
                    let fourth = slope(friction_n + step_m * third);
                    friction_n += step_m / 6.0 * (first + 2.0 * second + 2.0 * third + fourth);
                }
                let is_n = chain.friction_n()[0];
                assert!((is_n - friction_n).abs() < 2e-5, "exponent {exponent}: {is_n} {friction_n}");
                travelled_m = next_m;
                cycle += 1.0;
            }
        }
    }
    Ok(())
}

/// Returns a push at rest with a period of 0.4 s.
fn pushed(cycle: u32) -> Moment {
    let time_s = 0.001 * f64::from(cycle);
    let rate = 5.0 * PI;
    Moment {
        force_n_per_s: 3.0 * rate * (rate * time_s).cos(),
        ..moment(FORCE_N + 3.0 * (rate * time_s).sin(), 0.0, 0.0, time_s)
    }
}

#[test]
fn one_elastic_pulley_at_rest_is_one_that_the_winch_moves_as_the_stretch_would() -> Outcome {
    let compliance = 2e-4;
    let mut elastic = BristleChain::new(
        &[pulley(MU, PI, 0.0)],
        1000.0,
        true,
        with(&[&format!("cable_elasticity:compliance_m_per_n={compliance}")])?,
    );
    let mut wound = BristleChain::new(&[pulley(MU, PI, 0.0)], 1000.0, true, with(&[])?);
    // Within a cycle both change linearly.
    let as_wound = |cycle: u32, speed_m_per_s| {
        let at = pushed(cycle);
        Moment { length_m: compliance * at.force_n, speed_m_per_s, force_n_per_s: 0.0, ..at }
    };
    let mut greatest_n = 0.0_f64;
    for cycle in 0..1000 {
        let (from, to) = (pushed(cycle), pushed(cycle + 1));
        elastic.advance(&from, &to, 0.001, SUBSTEPS);
        let speed_m_per_s = compliance * (to.force_n - from.force_n) / 0.001;
        wound.advance(&as_wound(cycle, speed_m_per_s), &as_wound(cycle + 1, speed_m_per_s), 0.001, SUBSTEPS);
        let (is_n, expected_n) = (elastic.friction_n()[0], wound.friction_n()[0]);
        assert!((is_n - expected_n).abs() < 1e-9, "{is_n} {expected_n}");
        greatest_n = greatest_n.max(is_n.abs());
    }
    assert!(greatest_n > 0.3);
    Ok(())
}

/// A hand pushes the platform while the winch rests. This reverses the friction of the far pulleys first. Of the work done on each pulley, the part
/// that the bristle does not store is dissipated, never gained.
#[test]
fn pushes_at_rest_reverse_friction_from_the_platform_on() -> Outcome {
    let pulleys = [pulley(MU, PI, 0.1), pulley(MU, FRAC_PI_2, 0.1), pulley(MU, FRAC_PI_2, 0.1)];
    let compliance = 1e-4;
    let chain = |text: &[&str]| -> Result<BristleChain, Box<dyn core::error::Error>> {
        let mut chain = BristleChain::new(&pulleys, 1000.0, true, with(text)?);
        // The cable pays out and then rests, so friction is at its positive limit.
        for cycle in 0..200 {
            let at = |cycle: u32| moment(FORCE_N, 1e-4 * f64::from(cycle), 0.1, 0.0);
            chain.advance(&at(cycle), &at(cycle + 1), 0.001, SUBSTEPS);
        }
        Ok(chain)
    };
    let mut elastic = chain(&[&format!("cable_elasticity:compliance_m_per_n={compliance}")])?;
    let mut stiff = chain(&[])?;
    let start_n = stiff.friction_n();
    let mut least_n = elastic.friction_n();
    let mut work_j = [0.0; 3];
    for cycle in 0..1200 {
        let (from, to) = (pushed(cycle), pushed(cycle + 1));
        let before_n = elastic.friction_n();
        for chain in [&mut elastic, &mut stiff] {
            chain.advance(&from, &to, 0.001, SUBSTEPS);
        }
        let friction_n = elastic.friction_n();
        for (place, share) in [1.0, 2.0, 3.0].into_iter().enumerate() {
            least_n[place] = least_n[place].min(friction_n[place]);
            let way_m = share / 3.0 * compliance * (to.force_n - from.force_n);
            work_j[place] += 0.5 * (before_n[place] + friction_n[place]) * way_m;
        }
    }
    let stiffness = 1000.0 / 3.0;
    let kept_j = |friction_n: &[f64], place: usize| friction_n[place] * friction_n[place] / (2.0 * stiffness);
    let end_n = elastic.friction_n();
    let lost_j = [0, 1, 2].map(|place| work_j[place] - kept_j(&end_n, place) + kept_j(&start_n, place));
    assert_eq!(stiff.friction_n(), start_n);
    // Relative to the start values, the change increases with the distance from the winch.
    let turned = [0, 1, 2].map(|place| (start_n[place] - least_n[place]) / start_n[place]);
    assert!(turned[0] < turned[1] && turned[1] < turned[2] && turned[2] > 1.1, "{turned:?}");
    assert!(lost_j.iter().all(|lost_j| *lost_j > 1e-7), "{lost_j:?}");
    Ok(())
}

#[test]
fn the_stiffer_the_cable_the_closer_to_none_that_stretches() -> Outcome {
    let pulleys = [pulley(MU, PI, 0.1), pulley(MU, FRAC_PI_2, 0.1)];
    let run = |texts: &[&str]| -> Result<f64, Box<dyn core::error::Error>> {
        let mut chain = BristleChain::new(&pulleys, 1000.0, true, with(texts)?);
        let at = |cycle: u32| {
            let phase = 0.02 * f64::from(cycle);
            Moment { length_m: 1e-3 * phase.sin(), speed_m_per_s: 0.02 * phase.cos(), ..pushed(cycle) }
        };
        for cycle in 0..777 {
            chain.advance(&at(cycle), &at(cycle + 1), 0.001, SUBSTEPS);
        }
        Ok(chain.sensor_force_n(&at(777)))
    };
    let none_n = run(&[])?;
    let off_n = |compliance: f64| -> Result<f64, Box<dyn core::error::Error>> {
        Ok((run(&[&format!("cable_elasticity:compliance_m_per_n={compliance}")])? - none_n).abs())
    };
    let [soft_n, stiff_n, stiffer_n] = [off_n(1e-4)?, off_n(1e-6)?, off_n(1e-7)?];
    assert!(soft_n > 1e-3 && stiff_n < 2e-2 * soft_n, "{soft_n} {stiff_n}");
    assert!((stiff_n / stiffer_n - 10.0).abs() < 0.5, "{stiff_n} {stiffer_n}");
    assert!(off_n(0.0)?.abs() <= 0.0);
    Ok(())
}
