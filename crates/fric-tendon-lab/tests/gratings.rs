//! Shifts to tensions to frictions.

use fric_tendon::{ManipulatorOptions, ManipulatorParams};
use fric_tendon_lab::ContinuumError;
use fric_tendon_lab::fbg::{
    Calibration, GratingPlace, LoadStep, StrainForm, Tension, bridged, check_travel, without_temperature,
};
use fric_tendon_lab::friction::{FrictionDistribution, HoleLoad, hole_coefficient};
use fric_tendon_lab::simulate::{Experiment, TendonSimulationOptions, simulate};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const FULL_N: f64 = 0.2 * 9.80665;

/// Shifts of two gratings with noise of half a picometre; `temperature_k` above that of the calibration.
fn steps(seed: u64, mut temperature_k: impl FnMut(u32) -> f64) -> (Vec<LoadStep>, Vec<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noise = move || {
        let deviate: f64 = StandardNormal.sample(&mut random);
        0.0005 * deviate
    };
    let mut reference = Vec::new();
    let steps = (1..=10)
        .map(|step| {
            let load_n = 0.1 * f64::from(step) * FULL_N;
            // α_Λ + α_n of silica: 0.55e-6 + 6.3e-6 per K.
            let thermal = 6.85e-6 * temperature_k(step);
            reference.push(1560.0 * thermal + noise());
            let shift_nm =
                vec![load_n / 11.4 + 1540.0 * thermal + noise(), (load_n - 0.02) / 10.8 + 1545.0 * thermal + noise()];
            LoadStep { load_n, shift_nm }
        })
        .collect();
    (steps, reference)
}

#[test]
fn calibration_is_good_to_a_hundredth() {
    for seed in 0..50 {
        let (steps, _) = steps(seed, |_| 0.0);
        let lines = Calibration::fit_all(&steps).unwrap();
        for (line, (slope, offset)) in lines.iter().zip([(11.4, 0.0), (10.8, 0.02)]) {
            assert!(line.largest_residual_ratio() < 0.01);
            for percent in 0..=100 {
                let tension_n = 0.01 * f64::from(percent) * FULL_N;
                let found = line.tension((tension_n - offset) / slope);
                assert!((found.value_n - tension_n).abs() < 0.01 * FULL_N);
                assert!((found.value_n - tension_n).abs() < 6.0 * found.standard_error_n);
            }
        }
    }
}

#[test]
fn leaving_out_is_fitting_the_others() {
    let (steps, _) = steps(3, |_| 0.0);
    let line = &Calibration::fit_all(&steps).unwrap()[0];
    for (place, left_out) in line.left_out_ratio.iter().enumerate() {
        let mut others = steps.clone();
        let step = others.remove(place);
        let other = &Calibration::fit_all(&others).unwrap()[0];
        let error = (step.load_n - other.tension(step.shift_nm[0]).value_n) / FULL_N;
        assert!((error - left_out).abs() < 1e-12, "{error} {left_out}");
    }
}

#[test]
fn the_temperature_is_taken_off() {
    for seed in 0..50 {
        let lines = Calibration::fit_all(&steps(seed, |_| 0.0).0).unwrap();
        let (run, reference) = steps(seed + 100, |step| 5.0 * f64::from(step / 4));
        let mut with = 0.0_f64;
        for (step, reference_nm) in run.iter().zip(reference) {
            let shift_nm = without_temperature(&step.shift_nm, reference_nm, &[1540.0, 1545.0], 1560.0);
            for ((line, shift), raw) in lines.iter().zip(shift_nm).zip(&step.shift_nm) {
                let error = (line.tension(shift).value_n - step.load_n).abs() / FULL_N;
                assert!(error < 0.02, "{error}");
                with = with.max((line.tension(*raw).value_n - step.load_n).abs() / FULL_N);
            }
        }
        assert!(with > 0.5, "10 K do nothing without the reference: {with}");
    }
}

#[test]
fn the_strain_form_is_the_fibres() {
    // ⌀ 0.5 mm silica: 1 nm at 1550 nm is 827 microstrain.
    let fibre = StrainForm {
        wavelength_nm: 1550.0,
        photoelastic_ratio: 0.22,
        axial_stiffness_n: 70e9 * core::f64::consts::PI * 0.25e-3_f64.powi(2),
    };
    let line = fibre.calibration().unwrap();
    let strain = 1.0 / 1550.0 / 0.78;
    assert!((line.tension(1.0).value_n - strain * fibre.axial_stiffness_n).abs() < 1e-9);
    assert!((line.shift_nm(line.tension(0.3).value_n) - 0.3).abs() < 1e-15);
    let wrong = StrainForm { photoelastic_ratio: f64::NAN, ..fibre };
    assert!(wrong.calibration().unwrap_err().to_string().starts_with("`photoelastic_ratio` is NaN"));
}

#[test]
fn frictions_have_the_truths_direction_and_error() {
    let params = ManipulatorParams::new(&ManipulatorOptions::published()).unwrap();
    let options = TendonSimulationOptions { experiment: Experiment::Mixed, seed: 4, ..Default::default() };
    let run = simulate(&params, &options).unwrap();
    let lines = Calibration::fit_all(&run.calibration).unwrap();
    let (mut within, mut all, mut flagged) = (0, 0, 0);
    for (sample, truth) in run.samples.iter().zip(&run.truth) {
        let segments: Vec<Tension> =
            lines.iter().zip(&sample.shift_nm).map(|(line, shift_nm)| line.tension(*shift_nm)).collect();
        let base = Tension { value_n: sample.tension_base_n, standard_error_n: 0.0 };
        let distribution = FrictionDistribution::new(base, &segments);
        for (hole, true_n) in distribution.holes.iter().zip(&truth.friction_n) {
            all += 1;
            within += i32::from((hole.friction_n - true_n).abs() < 2.0 * hole.standard_error_n);
        }
        if distribution.directions_differ {
            flagged += 1;
        }
    }
    assert!(f64::from(within) > 0.85 * f64::from(all), "{within} of {all}");
    assert!(flagged > 10);
}

#[test]
fn a_hole_gives_its_coefficient() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let angle = 1.1_f64;
    let loads: Vec<HoleLoad> = (1..=10)
        .map(|step| {
            let first_n = 0.2 * f64::from(step);
            let noise: f64 = StandardNormal.sample(&mut random);
            // F_1 − F_2 = μ(F_1 + F_2) cos θ
            let grip = 0.1753 * angle.cos();
            let second_n = first_n * (1.0 - grip) / (1.0 + grip) + 0.003 * noise;
            HoleLoad { first_n, second_n, first_rad: angle, second_rad: angle }
        })
        .collect();
    let found = hole_coefficient(&loads).unwrap();
    assert!((found.mu - 0.1753).abs() < 0.01);
    assert!(found.interval[0] < 0.1753 && 0.1753 < found.interval[1]);
    assert!(hole_coefficient(&loads[..2]).is_err());
}

#[test]
fn gratings_that_would_leave_their_segment_are_named() {
    let params = ManipulatorParams::new(&ManipulatorOptions::published()).unwrap();
    let places = [GratingPlace { from_base_side_m: 0.0302, length_m: 0.004 }; 8];
    let greatest = 114.6_f64.to_radians();
    assert!(check_travel(&params, &places, greatest).is_ok());
    let mut wrong = places;
    wrong[1].from_base_side_m = 0.02;
    let said = check_travel(&params, &wrong, greatest).unwrap_err();
    assert!(said.to_string().starts_with("grating 2 leaves its segment: it moves 26.3 mm"), "{said}");
    assert!(check_travel(&params, &places, 1.1 * greatest).is_err());
}

#[test]
fn what_is_dead_is_bridged_and_said() {
    let nan = f64::NAN;
    let (whole, dead) = bridged(2.0, &[nan, 1.6, nan, nan, 1.0, 0.9, nan, nan]);
    let expected = [1.8, 1.6, 1.4, 1.2, 1.0, 0.9, 0.9, 0.9];
    assert!(whole.iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-12), "{whole:?}");
    assert_eq!(dead, [true, false, true, true, false, false, true, true]);
    assert_eq!(bridged(2.0, &[nan; 3]).0, [2.0; 3]);
}

#[test]
fn bad_data_get_their_sentence() {
    let (mut good, _) = steps(0, |_| 0.0);
    assert!(matches!(Calibration::fit_all(&good[..2]), Err(ContinuumError::TooFewLoads { grating: 1, count: 2, .. })));
    for (place, step) in good.iter_mut().enumerate() {
        step.shift_nm[1] = if place % 2 == 0 { 0.001 } else { -0.001 };
    }
    assert_eq!(Calibration::fit_all(&good), Err(ContinuumError::DeadGrating { grating: 2 }));
}
