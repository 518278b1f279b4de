//! The derivatives that the fit takes, against differences of the residuals.
//!
//! Residuals are smooth in the parameters but for a few kinks: a delay at a whole cycle, a displacement that the delay
//! brings through zero, a cable about to slacken. At a kink the differences to both sides disagree by what does not
//! vanish with the step; such points are left out, and counted.

use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_lab::fit::{CableRecord, FitOptions, KeptFunction, Measurements, Parameter, Reference, ResidualFunction};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};

const SAMPLES: u32 = 160;
/// Agreement of central difference and derivative, relative to the parameter's greatest derivative in the record.
const AGREEMENT: f64 = 1e-6;
/// The differences to both sides part by this share of the greatest derivative at a kink. Without one they part by
/// the step times the curvature, some 1e-5.
const KINK: f64 = 3e-4;
/// Share of the effects that act beside one. All at once, their kinks leave hardly a point without.
const COMPANY: f64 = 0.3;
/// Rounding of the forces as a share of the greatest: differences know no less.
const ROUNDING: f64 = 2e-15;

fn uniform(random: &mut ChaCha8Rng, min: f64, max: f64) -> f64 {
    Uniform::new(min, max).unwrap().sample(random)
}

fn log_uniform(random: &mut ChaCha8Rng, min: f64, max: f64) -> f64 {
    uniform(random, min.ln(), max.ln()).exp()
}

/// One cable with effects, of which all parameters vary.
fn robot(presliding: &str, pulleys: &str, effects: &str) -> RobotFile {
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = 0.001\n[[cable]]\nname = \"winch\"\n\
         presliding = \"{presliding}\"\npulleys = [{pulleys}]\n\
         friction = {{ mu = 0.02, sigma_n_per_m = 1000.0 }}\n\
         effects = [{effects}]\n"
    );
    RobotFile::parse(&text, "bench").unwrap()
}

/// Random tension and motion with rests and reversals; faults and gaps in the reference, which is `gain` times the sensor
/// force with some friction.
fn random_record<'a>(robot: &'a RobotFile, gain: f64, random: &mut ChaCha8Rng) -> Measurements<'a> {
    let mut measurements = Measurements::new(&robot.params(), Reference::Forces);
    let (mut length_m, mut speed_m_per_s) = (1.0, uniform(random, -0.5, 0.5));
    let tension_n = log_uniform(random, 3.0, 300.0);
    for cycle in 0..SAMPLES {
        if uniform(random, 0.0, 1.0) < 0.04 {
            speed_m_per_s = if uniform(random, 0.0, 1.0) < 0.2 { 0.0 } else { uniform(random, -0.6, 0.6) };
        }
        let noise: f64 = StandardNormal.sample(random);
        length_m += 0.001 * speed_m_per_s;
        let sensor_force_n = match uniform(random, 0.0, 1.0) {
            chance if chance < 0.02 => f64::NAN,
            _ => tension_n * (1.0 + 0.3 * (0.05 * f64::from(cycle)).sin() + 0.02 * noise),
        };
        let reference_n = match uniform(random, 0.0, 1.0) {
            chance if chance < 0.03 => f64::NAN,
            _ => gain * tension_n * (1.0 + 0.04 * speed_m_per_s.signum() + 0.01 * noise),
        };
        measurements.add(&Sample {
            stamp_nanos: 1_000_000 * i64::from(cycle),
            cables: &[CableInput { sensor_force_n, length_m, speed_m_per_s }],
            reference_force_n: &[reference_n],
            pose: None,
            outside_wrench: None,
        });
    }
    measurements
}

/// A random value and the step of its differences.
fn value_and_step(parameter: &Parameter, random: &mut ChaCha8Rng) -> (f64, f64) {
    let relative = |value: f64| (value, 1e-5 * value);
    match parameter.to_string().as_str() {
        "mu" => relative(log_uniform(random, 0.002, 0.3)),
        "sigma_n_per_m" => relative(log_uniform(random, 30.0, 1e5)),
        "viscous_n_s_per_m" => (uniform(random, 0.0, 3.0), 1e-5),
        "offset_n" => (uniform(random, -10.0, 10.0), 1e-4),
        "stribeck.ratio" => (uniform(random, -0.7, 2.0), 1e-5),
        "stribeck.velocity_m_per_s" => relative(log_uniform(random, 0.01, 1.0)),
        "time_delay.delay_s" => {
            let sign = if uniform(random, 0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
            (sign * uniform(random, 1e-5, 0.02), 1e-9)
        }
        "direction_asymmetry.coulomb_ratio" | "direction_asymmetry.viscous_ratio" | "sensor_offset.offset_n" => {
            (uniform(random, -0.5, 0.5), 1e-5)
        }
        "bearing_drag.drag_n" => (uniform(random, 0.0, 2.0), 1e-6),
        "load_nonlinearity.exponent" => (uniform(random, 0.7, 1.3), 1e-5),
        "friction_drift.rate_per_s" => (uniform(random, -2.0, 2.0), 1e-5),
        // Within the record, or after it.
        "friction_drift.until_s" | "sensor_drift.until_s" => (uniform(random, 0.01, 0.3), 1e-7),
        "presliding_shape.exponent" => (uniform(random, 1.0, 2.5), 1e-5),
        "sensor_gain.gain" => (uniform(random, 0.8, 1.2), 1e-5),
        "sensor_drift.rate_n_per_s" => (uniform(random, -1.0, 1.0), 1e-5),
        "pulley_inertia.mass_kg" => (uniform(random, 0.0, 0.001), 1e-7),
        "pulley_eccentricity.sin_ratio" | "pulley_eccentricity.cos_ratio" => (uniform(random, -0.1, 0.1), 1e-6),
        "pulley_eccentricity.period_m" => (uniform(random, 0.05, 0.5), 1e-7),
        "cable_elasticity.compliance_m_per_n" => (log_uniform(random, 1e-8, 1e-6), 1e-10),
        "load_nonlinearity.reference_n" => relative(log_uniform(random, 3.0, 300.0)),
        // The table of the example is over the speed.
        "empirical.length_from_m" | "empirical.length_to_m" | "empirical.load_from_n" | "empirical.load_to_n" => {
            (0.0, 1e-7)
        }
        "pulley_inertia.window_s" => (uniform(random, 0.002, 0.01), 1e-7),
        // Wider than the noise of the record, so that stretch waits; edges that a step crosses are left out as kinks.
        "cable_elasticity.play_n" => (uniform(random, 0.01, 0.1), 1e-7),
        _ => {
            let effect = parameter.effect().unwrap();
            let place = effect.row().parameters.iter().position(|row| row.key == parameter.row().key).unwrap();
            let away = effect.row().example[place] - parameter.row().neutral;
            let away = if away == 0.0 { parameter.row().neutral } else { away };
            (parameter.row().neutral + away * uniform(random, 0.5, 1.5), 1e-5 * away.abs())
        }
    }
}

/// Of each parameter: whether it is at a kink, where the two one-sided differences part or central ones of two steps disagree, and how far the central one is from the derivative.
fn check(record: &CableRecord<'_>, function: &ResidualFunction, values: &[f64], steps: &[f64]) -> Vec<(bool, f64)> {
    let width = values.len();
    let jacobian = function.jacobian(values);
    let middle = function.residuals(values);
    assert_eq!(jacobian.len(), width * middle.len());
    // The sensor's force is near enough: residuals are far smaller than what they are differences of.
    let greatest_n = record.rows.iter().fold(0.0, |most: f64, row| most.max(row.signals.sensor_force_n));
    let of_parameter = |(column, step): (usize, &f64)| {
        let moved = |steps: f64| {
            let mut values = values.to_vec();
            values[column] += steps * step;
            function.residuals(&values)
        };
        let (plus, minus) = (moved(1.0), moved(-1.0));
        let derivatives: Vec<f64> = jacobian.iter().skip(column).step_by(width).copied().collect();
        let scale = derivatives.iter().fold(0.0, |most: f64, derivative| most.max(derivative.abs()));
        let rounding = ROUNDING * greatest_n / step;
        let (mut parting, mut error) = (0.0_f64, 0.0_f64);
        for (((plus, minus), middle), derivative) in plus.iter().zip(&minus).zip(&middle).zip(derivatives) {
            parting = parting.max((plus - 2.0 * middle + minus).abs() / step / (scale + rounding / KINK));
            error = error.max(((plus - minus) / (2.0 * step) - derivative).abs() / (scale + rounding / AGREEMENT));
        }
        // A kink of little weight shows where half the step gives another difference.
        let disagree = || {
            let halves = moved(0.5).into_iter().zip(moved(-0.5)).map(|(plus, minus)| (plus - minus) / step);
            let whole = plus.iter().zip(&minus).map(|(plus, minus)| (plus - minus) / (2.0 * step));
            halves.zip(whole).any(|(half, whole)| (half - whole).abs() > AGREEMENT * (scale + rounding / AGREEMENT))
        };
        (parting > KINK || error >= AGREEMENT && disagree(), error)
    };
    steps.iter().enumerate().map(of_parameter).collect()
}

const BOTH: &str = "{ kind = \"stribeck\", ratio = 0.3 }, { kind = \"time_delay\", delay_s = 0.004 }";

/// Checks the derivatives of four robots, each at so many random points.
fn check_at_random_points(of_each: u32) {
    let robots = [
        ("per_pulley", "{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }, { wrap_deg = 60.0 }", 0.5),
        ("per_pulley", "{ wrap_deg = 90.0 }, { wrap_deg = 120.0 }", 1.0),
        ("lumped", "{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }, { wrap_deg = 60.0 }", 0.5),
        ("lumped", "{ wrap_deg = 125.0, sensor = true }, { wrap_deg = 90.0 }", 0.64),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (mut points, mut left_out, mut worst) = (0, 0, 0.0_f64);
    for (presliding, pulleys, gain) in robots {
        let robot = robot(presliding, pulleys, BOTH);
        let mut of_robot = 0;
        while of_robot < of_each {
            let measurements = random_record(&robot, gain, &mut random);
            let record = measurements.cable(0).unwrap();
            let function = ResidualFunction::new(&record, &FitOptions::default());
            assert_eq!(function.parameters().len(), 7);
            // Too little motion to forget what was before: another one.
            if function.count() < 40 {
                continue;
            }
            let (values, steps): (Vec<f64>, Vec<f64>) =
                function.parameters().iter().map(|parameter| value_and_step(parameter, &mut random)).unzip();
            let checks = check(&record, &function, &values, &steps);
            (points, of_robot) = (points + 1, of_robot + 1);
            if checks.iter().any(|(kink, _)| *kink) {
                left_out += 1;
                continue;
            }
            for (parameter, (_, error)) in function.parameters().iter().zip(checks) {
                worst = worst.max(error);
                assert!(error < AGREEMENT, "{presliding} {pulleys} {parameter} at {values:?}: {error:e}");
            }
        }
    }
    println!("{points} points, {left_out} at a kink; worst of the others {worst:e}");
    assert!(100 * left_out <= 3 * points, "{left_out} of {points}");
}

#[test]
fn jacobian_is_the_central_difference() {
    check_at_random_points(50);
}

#[test]
#[ignore = "minutes; `make soak` runs it"]
fn jacobian_is_the_central_difference_at_a_thousand_points() {
    check_at_random_points(250);
}

/// Every parameter of the catalogue, the settings too, each effect among a third of the others; then each by itself at its neutral value, where a
/// search begins.
#[test]
fn every_effect_has_its_derivatives() {
    let robots = [
        ("per_pulley", "{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }, { wrap_deg = 60.0 }", 0.5),
        ("per_pulley", "{ wrap_deg = 90.0 }, { wrap_deg = 120.0 }", 1.0),
        ("lumped", "{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }, { wrap_deg = 60.0 }", 0.5),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let (mut points, mut left_out, mut worst) = (0, 0, 0.0_f64);
    let all: Vec<Parameter> = Parameter::all().collect();
    for (presliding, pulleys, gain) in robots {
        let robot = robot(presliding, pulleys, "");
        let mut round = 0;
        while round < 2 * Effect::CATALOGUE.len() {
            let measurements = random_record(&robot, gain, &mut random);
            let record = measurements.cable(0).unwrap();
            // Every other one an effect in the company of some others at drawn values; else it alone, neutral, beside drawn friction.
            let effect = Effect::CATALOGUE[round / 2 % Effect::CATALOGUE.len()];
            let is_company = |_: &&Effect| round % 2 == 0 && uniform(&mut random, 0.0, 1.0) < COMPANY;
            let company: Vec<Effect> = Effect::CATALOGUE.iter().filter(is_company).copied().collect();
            let takes_part = |of: Effect| of == effect || company.contains(&of);
            let chosen: Vec<Parameter> =
                all.iter().filter(|parameter| parameter.effect().is_none_or(takes_part)).copied().collect();
            // The samples that a fit of the friction alone uses: a fit of all would be of no use.
            let friction = all.iter().filter(|parameter| parameter.is_friction()).copied().collect();
            let options = FitOptions { parameters: Some(friction), ..FitOptions::default() };
            let kept = KeptFunction { free: chosen, ..ResidualFunction::new(&record, &options).kept() };
            let function = ResidualFunction::from_kept(record.params, kept).unwrap();
            if function.count() < 40 {
                continue;
            }
            let (mut values, mut steps) = (Vec::new(), Vec::new());
            for parameter in function.parameters() {
                let (drawn, step) = value_and_step(parameter, &mut random);
                let neutral = round % 2 == 1 && !parameter.is_friction();
                // At 0 a delay is at a kink: it interpolates above and extrapolates below (see the next test).
                // Without a play all of the stretch goes at once.
                let nearly = match parameter.to_string().as_str() {
                    "time_delay.delay_s" | "cable_elasticity.play_n" => 10.0 * step,
                    _ => 0.0,
                };
                values.push(if neutral { parameter.row().neutral + nearly } else { drawn });
                steps.push(step);
            }
            (points, round) = (points + 1, round + 1);
            for (parameter, (kink, error)) in
                function.parameters().iter().zip(check(&record, &function, &values, &steps))
            {
                if kink {
                    left_out += 1;
                    continue;
                }
                worst = worst.max(error);
                assert!(error < AGREEMENT, "{presliding} {effect:?} {parameter} at {values:?}: {error:e}");
            }
        }
    }
    println!("{points} points, {left_out} derivatives at a kink; worst of the others {worst:e}");
    assert_eq!(points, 3 * 2 * Effect::CATALOGUE.len());
    assert!(left_out <= points, "{left_out} of {points}");
}

/// At 0 the sign of a compliance, and that of a delay, decide which way a cable at rest moves: the derivative is that to the
/// side on which a search goes on, where there is a motion at all.
#[test]
fn derivatives_at_rest_are_those_of_growing_values() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let pulleys = "{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }";
    for (presliding, name, step) in [
        ("per_pulley", "cable_elasticity.compliance_m_per_n", 1e-9),
        ("lumped", "cable_elasticity.compliance_m_per_n", 1e-9),
        ("per_pulley", "time_delay.delay_s", 1e-8),
        ("lumped", "time_delay.delay_s", 1e-8),
    ] {
        let robot = robot(presliding, pulleys, "");
        let (mut checked, mut seen) = (0, 0.0_f64);
        while checked < 20 {
            let measurements = random_record(&robot, 0.5, &mut random);
            let record = measurements.cable(0).unwrap();
            let parameters = Some(vec![Parameter::named(name).unwrap()]);
            let function = ResidualFunction::new(&record, &FitOptions { parameters, ..FitOptions::default() });
            if function.count() < 40 {
                continue;
            }
            checked += 1;
            let (jacobian, at, beyond) =
                (function.jacobian(&[0.0]), function.residuals(&[0.0]), function.residuals(&[step]));
            let scale = jacobian.iter().fold(0.0, |most: f64, derivative| most.max(derivative.abs()));
            seen = seen.max(scale);
            for ((derivative, at), beyond) in jacobian.iter().zip(at).zip(beyond) {
                let difference = (beyond - at) / step;
                assert!(
                    (derivative - difference).abs() <= 2e-3 * scale,
                    "{presliding} {name}: {derivative} {difference}"
                );
            }
        }
        assert!(seen > 1.0, "{name} has no derivative");
    }
}
